"""Drawing with a progress bar, for the commands that draw."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click
from tqdm import tqdm

from ..draw.figures import Spec, default_figures, draw
from ..instants.solution import Solution


def draw_with_progress(solution: Solution, specs: Sequence[Spec], folder: Path) -> None:
    """Draw into a folder; what the solution lacks is said, the bar shows on a terminal only."""
    chosen = specs or default_figures(solution)
    skipped = []
    for spec, path in tqdm(draw(solution, chosen, folder), total=len(chosen), desc="figures", leave=False, disable=None):
        if path is None:
            skipped.append(spec.name)
    if skipped:
        click.echo(f"note: not drawn, for want of their outputs: {', '.join(skipped)}", err=True)
