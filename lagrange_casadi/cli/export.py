"""``lagrange-casadi export``: a case as C that stands alone."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Any

from ..interop.exports import export as write
from ..studies.case import load_case
from .echo import echo
from .options import refuse


def export(
    case: Path,
    *,
    out: Path | None = None,
    model: Path | None = None,
    name: str | None = None,
    fmu: bool = False,
    fmu_by: str | None = None,
    **given: Any,
) -> None:
    """Write CASE as C for other programs.

    The folder stands alone: it has the library, a self-test and an example.

    Parameters
    ----------
    case : CASE
    out : DIR
        Write into this folder.
    model : FILE.json
        Write the mechanism as data for other programs: bodies, joints, motions.
    name : NAME
        As of :func:`.interop.exports.folder.export`.
    parameters, wanted, precision, newton, table
        As of :func:`.interop.exports.folder.export`.
    largest : BYTES
        As of :func:`.interop.exports.folder.export`.
    fmu
        Also write DIR/CASE.fmu, a unit of FMI 2.0 for simulation tools; needs FMPy and a C
        compiler.
    fmu_by : time|COORDINATE
        With --fmu, put the case's motion inside: the input is the time, or the place of this
        coordinate, as a crank's angle.
    control, structured_text, wasm, force
        As of :func:`.interop.exports.folder.export`.
    """
    refuse(
        (fmu_by and not fmu, "--fmu-by goes with --fmu"),
        (not (out or model), "Missing option '--out' or '--model'."),
    )
    loaded = load_case(case)
    if model is not None:
        from ..interop.formats import save_model

        save_model(loaded.scene, model, given["parameters"])
        echo(f"wrote {model}")
    if out is None:
        return
    made = write(
        loaded.scene,
        out,
        name=name or loaded.name,
        fmu=(fmu_by or True) if fmu else False,
        **given,
    )
    p = made.prefix
    others = (
        (fmu, f"{out / f'{p}.fmu'}: FMI 2.0, for Model Exchange and Co-Simulation"),
        (
            given["control"],
            f"{out / f'{p}_control.hpp'}: for controllers in C++, with {p}_control_test.cpp",
        ),
        (
            given["structured_text"],
            f"{out / f'{p}.st'}: structured text of IEC 61131-3, with its test",
        ),
        (
            given["wasm"],
            f"{out / f'{p}.wasm'} and {p}.js: README.wasm.md says how a web page uses them",
        ),
    )
    echo(
        *(f"{original} is called {called} in C" for original, called in made.mapped.items()),
        (
            f"wrote {out}: {p}.h, {p}.c and what goes with them; {len(made.inputs)} inputs,"
            f" {len(made.outputs)} outputs"
        ),
        *(f"wrote {what}" for asked, what in others if asked),
        (
            f"try it: cd {shlex.quote(str(out))} && cmake -B build && cmake --build build && ctest"
            " --test-dir build"
        ),
    )
