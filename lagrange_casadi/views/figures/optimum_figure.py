"""Pictures of a search: how it went, the mechanism before and after, and what the limits cost; and
the front of two terms.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ...base.arrays import Array, Flags
from ...model.scene import Scene
from ...studies.evaluate import evaluate
from ...studies.optimise.front import Front
from ...studies.optimise.optimum import Optimum
from ..shapes.picture_files import one_at_a_time, put_figure
from .mechanism_figure import draw_into

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_TEXT = 40


@one_at_a_time({"axes.grid": True, "grid.color": "0.93"})
def draw_optimum(scene: Scene, optimum: Optimum, path: Path) -> None:
    """Write the picture into a file; its kind follows from the ending of the name."""
    from matplotlib.figure import Figure
    from matplotlib.ticker import MaxNLocator

    figure = Figure(figsize=(12, 8), layout="constrained")
    grid = figure.add_gridspec(2, 2, height_ratios=(3, 2))
    before = dict(optimum.parameters) | dict(optimum.start.values)
    for column, (title, values) in enumerate((("start", before), ("optimum", optimum.parameters))):
        axes = figure.add_subplot(grid[0, column])
        _draw_design(axes, scene, values, f"{title}: ", optimum, 10)
    axes = figure.add_subplot(grid[1, 0])
    history = optimum.history
    for number in np.unique(history[:, 0]):
        rows = history[(history[:, 0] == number) & (history[:, 3] > 0)]
        axes.plot(np.arange(len(rows)), rows[:, 1], "-", color="0.6", lw=1, zorder=1)
        _plot_dots(axes, np.arange(0.0, len(rows)), rows[:, 1], rows[:, 2] <= 1e-6, 4)
    axes.axhline(optimum.objective, color="tab:blue", lw=0.8, ls=":")
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set(
        xlabel="program",
        ylabel=f"{optimum.minimised} [{optimum.unit}]",
        title="each start: o within the limits, x beyond one",
    )
    table = figure.add_subplot(grid[1, 1])
    table.axis("off")
    lines = [f"{optimum.minimised} = {optimum.objective:.6g} {optimum.unit}", ""]
    limits = [
        (str(one.constraint), one.value, one.active, one.multiplier) for one in optimum.limits
    ]
    limits += [
        (f"bounds of {name}", optimum.values[name], multiplier != 0.0, multiplier)
        for name, multiplier in optimum.bounds.items()
    ]
    for what, value, active, multiplier in limits:
        words = "active" if active else ""
        lines.append(f"{what:<{_TEXT}} {value:>11.5g} {words:<6} {multiplier:>11.4g}")
    table.text(0.0, 0.98, "\n".join(lines), va="top", fontsize=8, family="monospace")
    table.set_title("limits: value, whether active, multiplier", loc="left")
    put_figure(figure, path)


@one_at_a_time({"axes.grid": True, "grid.color": "0.93"})
def draw_front(scene: Scene, front: Front, path: Path) -> None:
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
        _plot_dots(axes, x, y, feasible, 5)
        for k in shown:
            axes.annotate(
                f"{k + 1}", (x[k], y[k]), textcoords="offset points", xytext=(6, 6), fontsize=9
            )
        axes.set(
            xlabel=f"{front.minimised[number]} [{front.units[number]}]",
            ylabel=f"{front.minimised[0]} [{front.units[0]}]",
        )
    figure.suptitle(
        f"{front.case}: designs of which none is better in {'both' if len(others) == 1 else 'all'}"
    )
    for column, k in enumerate(shown):
        axes = figure.add_subplot(below[0, column])
        optimum = front.points[k].optimum
        _draw_design(axes, scene, optimum.parameters, f"{k + 1}: ", optimum, 9)
    put_figure(figure, path)


def _plot_dots(axes: Axes, x: Array, y: Array, holds: Flags, size: int) -> None:
    """Plot values whose limits hold as circles of a size [pt], others as crosses."""
    axes.plot(x[holds], y[holds], "o", color="tab:blue", ms=size)
    axes.plot(x[~holds], y[~holds], "x", color="tab:red", ms=size + 1)


def _draw_design(
    axes: Axes,
    scene: Scene,
    parameters: Mapping[str, float],
    title: str,
    optimum: Optimum,
    size: float,
) -> None:
    """The mechanism with some values of the parameters that an optimum has found, which the title
    names.
    """
    values = ", ".join(f"{name} = {parameters[name]:.5g}" for name in optimum.values)
    axes.set_title(title + values, fontsize=size)
    draw_into(
        axes,
        evaluate(scene, parameters=parameters, wanted=["motion"], backend="vm", certificate=False),
    )
