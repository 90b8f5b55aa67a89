"""``lagrange-casadi export``: a case as C that stands alone."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path

import click

from ..base.vocabulary import Precision
from ..case import load_case
from ..exports import export as write
from .echo import echo
from .options import parameters


def export(
    case: Path,
    out: Path | None,
    model: Path | None,
    name: str | None,
    settings: Sequence[tuple[str, float | str]],
    want: Sequence[str],
    precision: Precision,
    newton: int | None,
    table: float | None,
    largest: int | None,
    fmu: bool,
    fmu_by: str | None,
    control: bool,
    structured_text: bool,
    wasm: bool,
    force: bool,
) -> None:
    """See :func:`.commands.export`."""
    if fmu_by and not fmu:
        raise click.UsageError("--fmu-by goes with --fmu")
    loaded = load_case(case)
    if model is not None:
        from ..formats import save_model

        save_model(loaded.scene, model, parameters(settings))
        echo(f"wrote {model}")
    if out is None:
        if model is None:
            raise click.UsageError("Missing option '--out' or '--model'.")
        return
    made = write(
        loaded.scene,
        out,
        name=name or loaded.name,
        parameters=parameters(settings),
        wanted=want or None,
        precision=precision,
        newton=newton,
        table=table,
        largest=largest,
        force=force,
        fmu=(fmu_by or True) if fmu else False,
        wasm=wasm,
        control=control,
        structured_text=structured_text,
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
    if control:
        echo(f"wrote {out / f'{p}_control.hpp'}: for controllers in C++, with {p}_control_test.cpp")
    if structured_text:
        echo(f"wrote {out / f'{p}.st'}: structured text of IEC 61131-3, with its test")
    if wasm:
        echo(f"wrote {out / f'{p}.wasm'} and {p}.js: README.wasm.md says how a web page uses them")
    echo(
        f"try it: cd {shlex.quote(str(out))} && cmake -B build && cmake --build build && ctest"
        " --test-dir build"
    )
