"""``lagrange-casadi plot``: the figures of a file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click
from tqdm import tqdm

from ..figures import parse_specs
from ..publish import check_writable, filling
from ..store import figure_specs, load
from ..sweep import Sweep, is_sweep
from ..sweep.plots import default_plots, draw_sweep
from .drawing import draw_with_progress
from .options import parameters, setting


@click.command()
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--out", type=click.Path(path_type=Path), required=True, help="The figures' folder.")
@click.option("--over", multiple=True, metavar="NAME", help="Of a sweep: the parameter along the axis, or two for maps.")
@click.option("--at", type=setting, multiple=True, metavar="NAME=VALUE", help="Of a sweep: where another parameter stays.")
@click.option("--against", nargs=2, multiple=True, metavar="COLUMN COLUMN", help="Of a sweep: the front of these two.")
def plot(file: Path, out: Path, over: Sequence[str], at: Sequence[tuple[str, float]], against: Sequence[tuple[str, str]]) -> None:
    """Draw the figures of FILE.h5, as its case wants them, or peaks over parameters where it is a sweep."""
    check_writable(out, folder=True)
    if is_sweep(file):
        sweep = Sweep.open(file)
        specs = default_plots(sweep, over=over, at=parameters(at), against=against)
        with filling(out) as draft:
            for _ in tqdm(draw_sweep(sweep, specs, draft), total=len(specs), desc="figures", leave=False, disable=None):
                pass
    elif over or at or against:
        raise click.UsageError("--over, --at and --against go with a sweep's file")
    else:
        solution, drawn = load(file), parse_specs(figure_specs(file))
        with filling(out) as draft:
            draw_with_progress(solution, drawn, draft)
    click.echo(f"wrote the figures in {out}/")
