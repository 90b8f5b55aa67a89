"""Values over time and along a link as a map."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ...base.arrays import Array
from ..shapes.readable import Scale

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PIXELS = 1600
"""Instants and ratios of a map at most."""


def draw_map(
    axes: Axes,
    sides: tuple[Array, Array],
    values: Array,
    ends: tuple[float, float | None],
    scale: Scale,
    what: str,
    title: str,
    peak: tuple[Any, Any] | None,
) -> None:
    """Draw values (t, xi) over both ``sides``, times or what instants are over, and ratios xi/l, in
    colours between their ``ends``, of which a negative one has signs; with a cross at a peak.
    """
    picture = axes.pcolormesh(
        *sides,
        values.T,
        cmap="RdBu_r" if ends[0] < 0.0 else "viridis",
        vmin=ends[0],
        vmax=ends[1],
        shading="nearest",
        rasterized=True,
    )
    if peak is not None:
        axes.plot(*peak, "k+", markersize=13, markeredgewidth=1.8, clip_on=False)
    axes.set_title(title, fontsize=10)
    axes.set_ylabel(r"$\xi/l$")
    bar = axes.figure.colorbar(picture, ax=axes, label=f"{what} [{scale.unit}]")
    scale.put(bar.ax.yaxis)
