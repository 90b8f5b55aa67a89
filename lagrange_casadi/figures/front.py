"""The picture of a front: its points, and the mechanism at its ends and between them."""

from __future__ import annotations

from typing import BinaryIO

import numpy as np

from ..declare.scene import Scene
from ..shapes.pictures import one_at_a_time, save
from ..studies.evaluate import evaluate
from ..studies.optimise.front import Front
from .into import draw_into


@one_at_a_time()
def draw_front(scene: Scene, front: Front, file: BinaryIO, ending: str) -> None:
    """Write the picture into a file; its kind follows from the ending of the name."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(12, 8), layout="constrained")
    shown = sorted({0, len(front.points) // 2, len(front.points) - 1})
    grid = figure.add_gridspec(2, 1, height_ratios=(3, 2))
    others = range(1, len(front.minimised))
    values = front.objectives
    feasible = np.array([point.optimum.feasible for point in front.points])
    above, below = grid[0].subgridspec(1, len(others)), grid[1].subgridspec(1, len(shown))
    for number in others:
        axes = figure.add_subplot(above[0, number - 1])
        x, y = values[:, number], values[:, 0]
        if len(others) == 1:
            axes.plot(x[feasible], y[feasible], "-", color="0.75", lw=1, zorder=1)
        axes.plot(x[feasible], y[feasible], "o", color="tab:blue", ms=5)
        axes.plot(x[~feasible], y[~feasible], "x", color="tab:red", ms=6)
        for k in shown:
            axes.annotate(
                f"{k + 1}", (x[k], y[k]), textcoords="offset points", xytext=(6, 6), fontsize=9
            )
        axes.set(
            xlabel=f"{front.minimised[number]} [{front.units[number]}]",
            ylabel=f"{front.minimised[0]} [{front.units[0]}]",
        )
        axes.grid(True, color="0.93")
    figure.suptitle(
        f"{front.case}: designs of which none is better in {'both' if len(others) == 1 else 'all'}",
        fontsize=11,
    )
    for column, k in enumerate(shown):
        axes = figure.add_subplot(below[0, column])
        optimum = front.points[k].optimum
        draw_into(
            axes,
            evaluate(
                scene,
                parameters=optimum.parameters,
                wanted=["motion"],
                backend="vm",
                certificate=False,
            ),
        )
        axes.set_title(
            f"{k + 1}:"
            f" {', '.join(f'{name} = {value:.5g}' for name, value in optimum.values.items())}",
            fontsize=9,
        )
    save(figure, file, ending)
