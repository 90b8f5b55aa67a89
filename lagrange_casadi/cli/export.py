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
from .options import PATH, arithmetic, parameters, settings_by, wanted


@click.command()
@click.argument("case", type=PATH)
@click.option("--out", type=PATH, required=True, metavar="DIR", help="The folder to write.")
@click.option("--name", metavar="NAME", help="What it is called in C; default: the case's name.")
@settings_by("Give a parameter another default; repeatable.")
@wanted()
@arithmetic
@click.option(
    "--largest", type=click.IntRange(0), metavar="BYTES", help="Most bytes of a table; default: 16 MB, in single precision 64 kB."
)
@click.option(
    "--fmu", is_flag=True, help="Also write DIR/CASE.fmu, a unit of FMI 2.0 for simulation tools; needs FMPy and a C compiler."
)
@click.option("--wasm", is_flag=True, help="Also write DIR/CASE.wasm for web pages, with a wrapper in JavaScript; needs ziglang.")
@click.option("--force", is_flag=True, help="Write into a folder that holds other files too; these are not touched.")
def export(
    case: Path,
    out: Path,
    name: str | None,
    settings: Sequence[tuple[str, float | str]],
    want: Sequence[str],
    precision: Precision,
    newton: int | None,
    table: float | None,
    largest: int | None,
    fmu: bool,
    wasm: bool,
    force: bool,
) -> None:
    """Write CASE as C for other programs: a library, a self-test and an example, in a folder that stands alone."""
    loaded = load_case(case)
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
        fmu=fmu,
        wasm=wasm,
    )
    for own, called in made.mapped.items():
        echo(f"{own} is called {called} in C")
    p = made.prefix
    echo(f"wrote {out}: {p}.h, {p}.c and what goes with them; {len(made.inputs)} inputs, {len(made.outputs)} outputs")
    if fmu:
        echo(f"wrote {out / f'{p}.fmu'}: FMI 2.0, for Model Exchange and Co-Simulation")
    if wasm:
        echo(f"wrote {out / f'{p}.wasm'} and {p}.js: README.wasm.md says how a web page uses them")
    echo(f"try it: cd {shlex.quote(str(out))} && cmake -B build && cmake --build build && ctest --test-dir build")
