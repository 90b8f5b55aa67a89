"""Random mechanisms as exported C: several in one program, compiled with every warning an error,
whose outputs hold NaN before.
"""

from __future__ import annotations

import json
import subprocess
from dataclasses import replace

import numpy as np
from internals import FORCES, Output

from lagrange_casadi import codegen, export

RATIOS = (0.0, 0.3, 0.5, 1.0)
FLAGS = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-Wno-error=long-long", "-O0"]
_MODEL = """
static void run_@(void) {
  @_model model;
  @_inputs inputs;
  @_outputs outputs;
  GIVEN
  int status = @_prepare(&model WHICH);
  static const double instants[] = {INSTANTS};
  size_t i;
  for (i = 0; i < sizeof instants / sizeof *instants; ++i) {
    memset(&inputs, 0xff, sizeof inputs);
    memset(&outputs, 0xff, sizeof outputs);
    if (!status) status = @_motion(&model, instants[i], &inputs);
    if (!status) status = @_evaluate(&model, &inputs, &outputs);
    printf("%d", status);
    OUTPUTS
    printf("\\n");
  }
}
"""
_FORCES = """
    { @_forces f; memset(&f, 0xff, sizeof f);
      if (!status) status = @_section(&model, &outputs, LINK, RATIO, &f);
      printf(" %a %a %a", f.axial, f.shear, f.bending); }
"""


def _program(told, drawn, t) -> str:
    """A function that prints all outputs at all instants."""
    name, values = told["prefix"], drawn.keywords.get("parameters", {})
    given = [f"given.{p} = {value!r};" for p, value in values.items()]
    printed = [f'printf(" %a", (double) outputs.{row["name"]});' for row in told["outputs"]]
    for link in told["links"]:
        for u in RATIOS:
            printed.append(_FORCES.replace("LINK", link["constant"]).replace("RATIO", repr(u)))
    text = _MODEL.replace("OUTPUTS", "\n    ".join(printed))
    text = text.replace("INSTANTS", ", ".join(map(repr, map(float, t))))
    held = f"@_parameters given = @_defaults; {' '.join(given)}" if given else ""
    text = text.replace("GIVEN", held).replace("WHICH", _which(told, given))
    return text.replace("@", name)


def _which(told, given) -> str:
    return ", &given" if given else ", 0" if told["parameters"] else ""


def by_exported_c(many, folder):
    """Solutions of what was drawn, as ``(drawn, scene, solution)``, with all outputs by exported C,
    and section forces there beside those of the solutions.
    """
    sources, functions, told = ["#include <stdio.h>", "#include <string.h>"], [], []
    for drawn, scene, solution in many:
        name = scene.mechanism.name
        export(scene, folder / name)
        told.append(json.loads((folder / name / "export.json").read_text()))
        sources.append(f'#include "{name}/{told[-1]["prefix"]}.h"')
        functions.append(_program(told[-1], drawn, solution.t))
    calls = "".join(f"  run_{one['prefix']}();\n" for one in told)
    main = folder / "main.c"
    main.write_text("\n".join([*sources, *functions, f"int main(void) {{\n{calls}  return 0;\n}}"]))
    files = [
        folder / scene.mechanism.name / f"{one['prefix']}.c"
        for (_, scene, _), one in zip(many, told, strict=True)
    ]
    compiler = codegen.find_compiler()
    command = [*compiler.command, *FLAGS, main, *files, "-o", folder / "main", "-lm"]
    subprocess.run(command, check=True)
    printed = subprocess.run([folder / "main"], capture_output=True, text=True, check=True).stdout
    lines = iter(printed.splitlines())
    for (drawn, _, solution), one in zip(many, told, strict=True):
        rows = [next(lines).split() for _ in solution.t]
        yield drawn, *_read(solution, one, rows)


def _read(solution, told, rows):
    """The solution with what was printed, and by how much section forces are off, in sizes of their
    terms.
    """
    assert {row[0] for row in rows} == {"0"}, rows[0][0]
    found = np.array([[float.fromhex(word) for word in row[1:]] for row in rows]).T
    outputs, off = dict(solution.outputs), 0.0
    for row, values in zip(told["outputs"], found, strict=False):
        outputs[Output.of(row["path"].replace("/", ":"))] = values
    rest = iter(found[len(told["outputs"]) :])
    for link in told["links"]:
        law = solution.section(link["name"]).law
        for k in range(len(RATIOS)):
            for force in FORCES:
                own, u = next(rest), np.array(RATIOS[k : k + 1])
                if solution.determined(f"section:{link['name']}:{force}"):
                    size = np.max(law.bound(force, u)) + 1e-300
                    off = max(off, np.max(np.abs(own - law.on_grid(force, u)[:, 0])) / size)
    return replace(solution, outputs=outputs), off
