"""The picture of a search: how it went, the mechanism before and after,
and what the limits cost.
"""

from __future__ import annotations

from typing import BinaryIO

import numpy as np

from ..declare.scene import Scene
from ..shapes.pictures import one_at_a_time, save
from ..studies.evaluate import evaluate
from ..studies.optimise.optimum import Optimum
from .into import draw_into

_TEXT = 40


@one_at_a_time()
def draw_optimum(scene: Scene, optimum: Optimum, file: BinaryIO, ending: str) -> None:
    """Write the picture into a file; its kind follows from the ending of the name."""
    from matplotlib.figure import Figure
    from matplotlib.ticker import MaxNLocator

    figure = Figure(figsize=(12, 8), layout="constrained")
    grid = figure.add_gridspec(2, 2, height_ratios=(3, 2))
    before = dict(optimum.parameters) | dict(optimum.start.values)
    for column, (title, values) in enumerate((("start", before), ("optimum", optimum.parameters))):
        axes = figure.add_subplot(grid[0, column])
        draw_into(
            axes,
            evaluate(scene, parameters=values, wanted=["motion"], backend="vm", certificate=False),
        )
        values_text = ", ".join(f"{name} = {values[name]:.5g}" for name in optimum.values)
        axes.set_title(f"{title}: {values_text}", fontsize=10)
    axes = figure.add_subplot(grid[1, 0])
    history = optimum.history
    for number in np.unique(history[:, 0]):
        rows = history[(history[:, 0] == number) & (history[:, 3] > 0)]
        axes.plot(np.arange(len(rows)), rows[:, 1], "-", color="0.6", lw=1, zorder=1)
        holds = rows[:, 2] <= 1e-6
        axes.plot(np.flatnonzero(holds), rows[holds, 1], "o", color="tab:blue", ms=4)
        axes.plot(np.flatnonzero(~holds), rows[~holds, 1], "x", color="tab:red", ms=5)
    axes.axhline(optimum.objective, color="tab:blue", lw=0.8, ls=":")
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set(xlabel="program", ylabel=f"{optimum.minimised} [{optimum.unit}]")
    axes.set_title("each start: o within the limits, x beyond one", fontsize=10)
    axes.grid(True, color="0.93")
    table = figure.add_subplot(grid[1, 1])
    table.axis("off")
    lines = [f"{optimum.minimised} = {optimum.objective:.6g} {optimum.unit}", ""]
    for limit in optimum.limits:
        mark = "active" if limit.active else ""
        lines.append(
            f"{limit.constraint!s:<{_TEXT}} {limit.value:>11.5g} {mark:<6}"
            f" {limit.multiplier:>11.4g}"
        )
    for name, multiplier in optimum.bounds.items():
        lines.append(
            f"{'bounds of ' + name:<{_TEXT}} {optimum.values[name]:>11.5g}"
            f" {'active' * bool(multiplier):<6} {multiplier:>11.4g}"
        )
    table.text(0.0, 0.98, "\n".join(lines), va="top", fontsize=8, family="monospace")
    table.set_title("limits: value, whether active, multiplier", fontsize=10, loc="left")
    save(figure, file, ending)
