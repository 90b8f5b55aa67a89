"""``lagrange-casadi export``: a case as C that stands alone."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Any

import click

from ..interop.exports import export as write
from ..studies.case import load_case
from .echo import echo


def export(
    case: Path,
    out: Path | None,
    model: Path | None,
    name: str | None,
    fmu: bool,
    fmu_by: str | None,
    **given: Any,
) -> None:
    """See :func:`.commands.export`."""
    if fmu_by and not fmu:
        raise click.UsageError("--fmu-by goes with --fmu")
    loaded = load_case(case)
    if model is not None:
        from ..interop.formats import save_model

        save_model(loaded.scene, model, given["parameters"])
        echo(f"wrote {model}")
    if out is None:
        if model is None:
            raise click.UsageError("Missing option '--out' or '--model'.")
        return
    made = write(
        loaded.scene,
        out,
        name=name or loaded.name,
        fmu=(fmu_by or True) if fmu else False,
        **given,
    )
    for original, called in made.mapped.items():
        echo(f"{original} is called {called} in C")
    p = made.prefix
    echo(
        f"wrote {out}: {p}.h, {p}.c and what goes with them; {len(made.inputs)} inputs,"
        f" {len(made.outputs)} outputs"
    )
    if fmu:
        echo(f"wrote {out / f'{p}.fmu'}: FMI 2.0, for Model Exchange and Co-Simulation")
    if given["control"]:
        echo(f"wrote {out / f'{p}_control.hpp'}: for controllers in C++, with {p}_control_test.cpp")
    if given["structured_text"]:
        echo(f"wrote {out / f'{p}.st'}: structured text of IEC 61131-3, with its test")
    if given["wasm"]:
        echo(f"wrote {out / f'{p}.wasm'} and {p}.js: README.wasm.md says how a web page uses them")
    echo(
        f"try it: cd {shlex.quote(str(out))} && cmake -B build && cmake --build build && ctest"
        " --test-dir build"
    )
