"""Golden vectors of a unit of FMI, and a script that compares the unit with them by FMPy."""

from __future__ import annotations

import numpy as np

from ...base.table_writers import csv_text
from ..portable.golden import motions_at
from ..portable.text import template
from .fmu_description import Description

FILE = "resources/golden.csv"
"""Path of the golden vectors in the unit."""


def golden_vectors(description: Description) -> str:
    """Return a table: times [s], inputs and outputs under the names of the unit's variables; first
    by how much an output may be off.

    Between two golden instants there are those over which iterated loops are followed, without
    outputs.
    """
    source, inputs = description.source, description.members("input")
    golden, program = source.golden, source.exported.program
    last = len(golden.times) - 1
    places = np.arange(last * golden.steps + 1) / golden.steps
    instants = np.interp(places, np.arange(last + 1), golden.times)
    moved = motions_at(program, instants, source.p)
    given = [moved[m.source].tolist() for m in inputs]
    heads = [m.path for m in (*inputs, *description.source.contract.outputs)]
    rows: list[list[object]] = [["time", *heads]]
    rows.append(["within", *("" for _ in inputs), *golden.outputs_off.tolist()])
    for k, t in enumerate(instants.tolist()):
        at, between = divmod(k, golden.steps)
        found = [""] * golden.outputs_off.size if between else golden.outputs[at].tolist()
        rows.append([t, *(values[k] for values in given), *found])
    return csv_text(rows)


def golden_script(description: Description) -> str:
    """Return the text of the script ``<prefix>_fmu_test.py``."""
    turning = [m.path for m in description.source.contract.outputs if m.wrapped]
    return template("fmu_test.py.in", **description.source.words, file=FILE, turning=turning)
