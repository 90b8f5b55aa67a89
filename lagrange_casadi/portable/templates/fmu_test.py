"""Compares $p.fmu with golden vectors that are in it: python ${p}_fmu_test.py, with FMPy."""

import csv
import math
import sys
from pathlib import Path

import fmpy

TURNING = $turning
"""Outputs that are the same after a whole turn."""

unit = Path(__file__).with_name("$p.fmu")
description = fmpy.read_model_description(str(unit))
folder = Path(fmpy.extract(str(unit)))
with (folder / "$file").open(newline="") as file:
    (_, *names), (_, *within), *rows = csv.reader(file)
places = {variable.name: variable.valueReference for variable in description.modelVariables}
references, first = [places[name] for name in names], within.count("")
fmu = fmpy.instantiate_fmu(str(folder), description, "ModelExchange")
fmu.setupExperiment(startTime=float(rows[0][0]))
fmu.enterInitializationMode()
fmu.exitInitializationMode()
failures = 0
for time, *values in rows:
    fmu.setTime(float(time))
    fmu.setReal(references[:first], [float(value) for value in values[:first]])
    found = fmu.getReal(references[first:])
    for name, value, expected, off in zip(names[first:], found, values[first:], within[first:]):
        gap = value - float(expected) if expected else 0.0
        gap = math.remainder(gap, 2 * math.pi) if name in TURNING else gap
        if not abs(gap) <= float(off):
            failures += 1
            print(f"{name} at {time} s is {value!r}, expected {expected} within {off}")
fmu.terminate()
fmu.freeInstance()
print(f"$p.fmu: {failures} failures")
sys.exit(failures > 0)
