"""Figures for designers: peaks over one parameter or two, section forces over xi/l and a parameter,
the front of two columns.
"""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...base.arrays import Array
from ...base.tables import table_of
from ...errors import NoDesignError, listed
from ...studies.sweep.axes import DESIGN
from ...studies.sweep.best import best, chosen, size
from ...studies.sweep.reading import Sweep
from ...studies.sweep.selection import near
from ..shapes.picture_files import one_at_a_time, save
from .panels import (
    DOTS,
    LINES,
    RED,
    STYLE,
    Cut,
    Panels,
    along,
    label,
    scaled,
    stays,
    value,
    varied,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_KEYED, _ROOM, _OFTEN, _GOLDEN = 5, 100, 3, (5.0**0.5 - 1.0) / 2.0
_LETTERS = 104
"""Letters of 7 points across a page."""

_KEY: dict[str, Any] = {
    "color": RED,
    "markeredgewidth": 0.8,
    "linestyle": "",
    "clip_on": False,
    "zorder": 4,
}
_STAR: dict[str, Any] = {
    "marker": "*",
    "color": RED,
    "markersize": 9,
    "markeredgewidth": 0.7,
    "markeredgecolor": "white",
    "linestyle": "",
    "clip_on": False,
    "zorder": 5,
}


def draw_peaks(
    sweep: Sweep,
    columns: Sequence[str],
    over: Sequence[str],
    family: str,
    at: Mapping[str, float],
) -> Figure:
    """Sizes of columns: of a grid over two parameters as maps, or over one as curves, one for each
    of some values of ``family``; of a list as dots over each parameter.

    Other parameters of a grid stay ``at`` values, or in the middle of their axes. Raises
    :class:`NoDesignError` where no design that it shows has a result, or none differs from another.
    """
    cut = Cut.of(sweep, over, at, family)
    shown, same = _differing(columns, cut)
    listed = DESIGN in cut.names
    each = [(name,) for name in over] if listed else [tuple(over)]
    mapped = len(each[0]) == 2
    panels = Panels.of(
        len(shown) * len(each),
        len(each) if listed else 0,
        sharex="col" if listed else "all",
        sharey="row" if listed else mapped,
    )
    style = {"linestyle": "", "alpha": 0.6} if listed else {"linewidth": 1.1}
    families = [value(sweep, family, one) for one in cut.along(family)] if family else [""]
    for axes, (column, names) in zip(panels.axes, product(shown, each), strict=True):
        values, x, words = shown[column], [*map(cut.along, names)], label(sweep, column)
        if mapped:
            panels.map(axes, x, values, words, cut.gaps)
        else:
            many = values.reshape(x[0].size, -1).T
            panels.curves(axes, x[0], many, families, cut.gaps, marker=".", markersize=4, **style)
            along(axes, "x", x[0])
            scaled(axes, "y", values, words)
        if listed:
            axes.label_outer()
        _star(panels, axes, cut, x, values)
    panels.name_axes(
        [label(sweep, name) for name in (over if listed else over[:1])],
        label(sweep, over[1]) if mapped else "",
    )
    what = f"{cut.sweep.size} designs" if listed else "each design"
    return panels.finish(f"{sweep.case}: peak over time of {what}", cut.notes, same)


def draw_along(sweep: Sweep, link: str, over: str, at: Mapping[str, float]) -> Figure:
    """The section forces of a link over xi/l and a parameter: at each ratio the largest in size
    over the instants, signed.

    A few values of the parameter are curves, more are a map. Where the sign alternates, as where
    the largest and the least of a force are alike, the size is drawn. Raises
    :class:`NoDesignError` where no design that it shows has a result.
    """
    cut, xi = Cut.of(sweep, (over,), at), sweep["xi"]
    there = cut.along(over)
    mapped = there.size > LINES
    forces = table_of(sweep.description.space).forces
    panels = Panels.of(len(forces), sharex="all", sharey=mapped)
    for axes, force in zip(panels.axes, forces, strict=True):
        column = f"peak_at:section:{link}:{force}"
        values = cut[column]
        if np.isnan(values).all():
            raise NoDesignError(_none(cut.notes))
        sized = _alternates(values)
        values, words = np.abs(values) if sized else values, label(sweep, column, sized)
        if mapped:
            panels.map(axes, (there, xi), values, words, cut.gaps, signed=not sized)
            continue
        names = [value(sweep, over, one) for one in there]
        panels.curves(axes, xi, values, names, cut.gaps, linewidth=1.1)
        axes.axhline(0.0, color="0.6", linewidth=0.8, zorder=0)
        axes.set_ylabel(words)
    ratio = r"$\xi/l$"
    panels.name_axes(*(([label(sweep, over)], ratio) if mapped else ([ratio],)))
    title = f"section forces of {link}, at each ratio the largest in size over time"
    return panels.finish(f"{sweep.case}: {title}", cut.notes)


def draw_front(sweep: Sweep, pair: tuple[str, str], at: Mapping[str, float]) -> Figure:
    """Two columns or parameters of the designs ``at`` these values against each other, and the
    designs of which no other is less in both.

    Raises :class:`NoDesignError` where no design has a result.
    """
    sweep = sweep.select(**at)
    notes = "".join(stays(sweep, at))
    front = best(sweep, minimise=pair)
    if not front:
        raise NoDesignError(_none(notes))
    stride = 1 + sweep.size // DOTS
    count, dots = 0, []
    for numbers, values in chosen(sweep, pair, ["status==0"]):
        count += numbers.size
        # By the golden ratio, since each n-th of a grid may be all that share a value, or none
        # of those chosen.
        few = numbers * _GOLDEN % 1.0 * stride < 1.0
        dots.append([size(name, values[name])[few] for name in pair])
    every = np.concatenate(dots, axis=1)
    u, v = (size(name, np.array([design.values[name] for design in front])) for name in pair)
    panels = Panels.of(1)
    (axes,) = panels.axes
    style = {"linestyle": "", "markersize": 3}
    if count > len(front):
        words = "designs with a result" + (f", 1 in {stride} drawn" if stride > 1 else "")
        (panels.legend[words],) = axes.plot(*every, marker=".", color="0.75", **style)
    axes.step(u, v, where="post", color=RED, linewidth=0.8)
    words = f"front: no other is less in both ({len(front)})"
    (panels.legend[words],) = axes.plot(u, v, marker=".", color=RED, **style)
    for axis, name, few, on in zip("xy", pair, every, (u, v), strict=True):
        scaled(axes, axis, np.append(few, on), label(sweep, name), on.tolist())
    names = varied(sweep)
    for n, k in enumerate(_apart(u, v), 1):
        where = ", ".join(value(sweep, name, front[k].values[name]) for name in names)
        ring, number = (
            axes.plot(u[k], v[k], marker=mark, markersize=points, mfc=fill, **_KEY)
            for mark, points, fill in (("o", 8.0, "white"), (f"${n}$", 4.5, RED))
        )
        panels.legend[where] = (*ring, *number)
    return panels.finish(f"{sweep.case}: designs and their front", notes)


def draw_sweep(
    sweep: Sweep,
    figures: Mapping[str, Callable[[Sweep], Figure]],
    folder: Path,
    svg: bool = False,
) -> Iterator[tuple[Path, str]]:
    """Draw figures by their names into an existing folder, one by one, as PNG or as SVG: the file,
    and where it is not drawn, why.
    """
    ending = ".svg" if svg else ".png"
    for name, figure in figures.items():
        path = folder / f"{name}{ending}"
        why = ""
        with one_at_a_time(STYLE):
            try:
                save(figure(sweep), path, ending, dpi=200)
            except NoDesignError as error:
                why = str(error)
        yield path, why


def _none(notes: str) -> str:
    return " ".join(filter(None, ("no design", notes, "has a result")))


def _differing(columns: Sequence[str], cut: Cut) -> tuple[dict[str, Array], str]:
    """The sizes of columns that are not the same for all designs drawn, and in words those that
    are.
    """
    shown, same = {}, []
    for column in columns:
        values = size(column, cut[column])
        found = values[np.isfinite(values)]
        if found.size and np.ptp(found) <= 1e-9 * found.max():
            same.append(f"{label(cut.sweep, column)} = {found[0]:.4g}")
        elif found.size:
            shown[column] = values
    words = f": {listed(same, room=_ROOM)}"
    if not shown:
        where = ", ".join(filter(None, ("the same for all drawn", cut.notes)))
        raise NoDesignError(where + words if same else _none(cut.notes))
    return shown, f"the same for all drawn{words}" if same else ""


def _star(panels: Panels, axes: Axes, cut: Cut, x: Sequence[Array], values: Array) -> None:
    """Mark the smallest of values, and say above the panel where it is."""
    place = np.unravel_index(np.nanargmin(values), values.shape)
    least = float(values[place])
    y = float(x[1][place[1]]) if len(x) > 1 else least
    (panels.legend["smallest of those drawn"],) = axes.plot(float(x[0][place[0]]), y, **_STAR)
    spot = {name: cut.along(name)[k] for name, k in zip(cut.names, place, strict=True)}
    where = ", ".join(f"{name} = {there:.4g}" for name, there in spot.items())
    if DESIGN in spot:
        where = f"design {spot[DESIGN]}"
    others = int(near(values, least).sum()) - 1
    words = f"★ {least:.4g} at {where}" + (f" and {others} more" if others else "")
    words = textwrap.fill(words, _LETTERS // max(panels.columns, 2))
    axes.set_title(words, loc="left", color=RED)


def _alternates(values: Array) -> bool:
    """Return whether the sign changes more than three times along rows or columns, on average;
    that of rounding is none.
    """
    signs = np.sign(np.where(np.abs(values) > 1e-6 * np.nanmax(np.abs(values)), values, 0.0))
    flips = ((each[1:] * each[:-1] < 0.0).sum(axis=0) for each in (signs, signs.T))
    return any(float(each.mean()) > _OFTEN for each in flips)


def _apart(u: Array, v: Array) -> list[int]:
    """Numbers of a few places of a front that lie apart, its ends among them."""
    distance = np.zeros(u.size)
    for one in (u, v):
        distance += np.abs(one - one[0]) / (np.ptp(one) or 1.0)
    wanted = np.linspace(0.0, distance[-1], _KEYED)
    return sorted({int(np.abs(distance - one).argmin()) for one in wanted})
