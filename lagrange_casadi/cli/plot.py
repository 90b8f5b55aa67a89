"""``lagrange-casadi plot``: the figures of a file."""

from __future__ import annotations

from pathlib import Path

import click

from ..figures import parse_specs
from ..publish import check_writable, filling
from ..store import figure_specs, load
from .drawing import draw_with_progress


@click.command()
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--out", type=click.Path(path_type=Path), required=True, help="The figures' folder.")
def plot(file: Path, out: Path) -> None:
    """Draw the figures of FILE.h5, as its case wants them."""
    check_writable(out, folder=True)
    solution, specs = load(file), parse_specs(figure_specs(file))
    with filling(out) as draft:
        draw_with_progress(solution, specs, draft)
    click.echo(f"wrote the figures in {out}/")
