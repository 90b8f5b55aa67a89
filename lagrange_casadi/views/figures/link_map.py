"""Values over time and along a link as a map."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from ...base.arrays import Array, every
from ...results.strength.member import Member
from ..shapes.readable import Scale

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PIXELS = 1600
"""Instants and ratios of a map at most."""


def draw_along(
    axes: Axes,
    member: Member,
    along: Array,
    label: str,
    grid: Callable[[slice, Array], Array],
    peak: Any,
    title: str,
    **how: Any,
) -> None:
    """Draw what ``grid`` gives at instants and ratios of a member over places ``along`` its motion,
    whose axis has a ``label``, as :func:`draw_map` does; the title goes on with where the peak is.
    """
    instants, ratios = (every(size, PIXELS) for size in (member.t.size, member.xi.size))
    xi = member.xi[ratios]
    place = float(along[int(np.argmin(np.abs(member.t - peak.t)))])
    draw_map(
        axes,
        (along[instants], xi),
        grid(instants, xi),
        title=rf"{title}, $\xi/l$ = {peak.xi:.3f}",
        peak=(place, peak.xi),
        **how,
    )
    axes.set_xlabel(label)


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
    axes.set(title=title, ylabel=r"$\xi/l$")
    bar = axes.figure.colorbar(picture, ax=axes, label=f"{what} [{scale.unit}]")
    scale.put(bar.ax.yaxis)
