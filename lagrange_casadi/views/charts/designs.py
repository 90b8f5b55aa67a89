"""Figures for designers: peaks over one parameter or two, section forces over xi/l and a parameter,
the front of two columns.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from ...base.tables import table_of
from ...errors import NoDesignError
from ...studies.sweep.best import best, chosen, size
from ...studies.sweep.cut import DOTS, LINES, Cut, stays
from ...studies.sweep.meanings import STATUS
from ...studies.sweep.reading import Sweep
from ...studies.sweep.scale import Scale, edges, even_in_ratios, logarithmic, number
from ...studies.sweep.selection import near
from ...studies.sweep.sheet import STYLE, MissingDesigns, Sheet, fitted, label, value
from ..shapes.pictures import ending_of, one_at_a_time, save

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.collections import QuadMesh
    from matplotlib.figure import Figure
    from matplotlib.typing import ColorType

_KEYED, _NAMED, _OFTEN, _GOLDEN = 5, 3, 3, (5.0**0.5 - 1.0) / 2.0
_RING = 0.15
_BLUE, _RED = "#1f4e79", "#c1272d"
_OUTSIDE = {
    "viridis": {"over": "#fffbd0", "under": "#1a0022"},
    "RdBu_r": {"over": "#3d0010", "under": "#021a33"},
}
_STAR: dict[str, Any] = {
    "marker": "*",
    "color": _RED,
    "markersize": 9,
    "markeredgewidth": 0.7,
    "markeredgecolor": "white",
    "linestyle": "",
}


@dataclass(frozen=True)
class Peaks:
    """Columns of a grid over two parameters as maps, or over one as curves, one for each of some
    values of ``family``.

    Other parameters stay ``at`` values, or in the middle of their axes.
    """

    name: str
    columns: tuple[str, ...]
    over: tuple[str, ...]
    family: str = ""
    at: Mapping[str, float] = field(default_factory=dict)

    def draw(self, sweep: Sweep) -> Figure:
        """The figure.

        Raises :class:`NoDesignError` where no design that it shows has a result, or none differs
        from another.
        """
        cut = Cut.of(sweep, self.over, self.at, self.family)
        shown, same = _differing(self.columns, cut)
        gaps = MissingDesigns.of(sweep, cut[STATUS])
        sheet = Sheet.of(
            len(shown), share=("all", "all") if len(self.over) == 2 else ("all", False)
        )
        for axes, (column, values) in zip(sheet.plots, shown.items(), strict=True):
            scale = Scale.of(values)
            if len(self.over) == 2:
                sheet.bar(
                    axes,
                    _cells(axes, cut.axes, values, scale, gaps, sheet.legend),
                    scale,
                    label(sweep, column),
                )
            else:
                _curves(axes, cut, values, gaps, sheet.legend)
                scale.limit(axes, "y", foot=gaps.foot(values.size // len(values)))
                axes.set_ylabel(fitted(sheet.up, label(sweep, column), scale.note))
            for axis, x in zip("xy"[: len(self.over)], cut.axes, strict=False):
                sheet.tick(axes, axis, x)
            place = np.unravel_index(np.nanargmin(values), values.shape)
            spot = [x[k] for x, k in zip(cut.axes, place, strict=True)]
            _star(axes, spot[0], spot[1] if len(self.over) == 2 else values[place], sheet.legend)
            where = ", ".join(
                value(sweep, name, x, "") for name, x in zip(cut.names, spot, strict=True)
            ) + _ties(values)
            inches = (0.6 + 0.2 * len(self.over)) * sheet.across
            axes.set_title(
                fitted(inches, f"★ {number(values[place])} at {where}", points=7),
                loc="left",
                color=_RED,
            )
        sheet.name_axes(
            label(sweep, self.over[0]), label(sweep, self.over[1]) if len(self.over) == 2 else ""
        )
        return sheet.finish(f"{sweep.case}: peak over time of each design", *cut.notes, same)


@dataclass(frozen=True)
class Scatter:
    """Columns of a list's designs over each of some parameters; where ``at`` is given, of the
    designs with these values.
    """

    name: str
    columns: tuple[str, ...]
    over: tuple[str, ...]
    at: Mapping[str, float] = field(default_factory=dict)

    def draw(self, sweep: Sweep) -> Figure:
        """The figure. Raises what :meth:`Peaks.draw` does."""
        cut = Cut.listed(sweep, self.at)
        shown, same = _differing(self.columns, cut)
        gaps = MissingDesigns.of(sweep, cut[STATUS])
        sheet = Sheet.of(len(shown) * len(self.over), columns=len(self.over), share=("col", "row"))
        for k, axes in enumerate(sheet.plots):
            (column, values), name = (
                list(shown.items())[k // len(self.over)],
                self.over[k % len(self.over)],
            )
            scale, x = Scale.of(values), cut.sweep[name]
            axes.plot(x, values, "o", color=_BLUE, markersize=3, alpha=0.6, markeredgewidth=0.0)
            gaps.cross(axes, x, sheet.legend)
            if logarithmic(x):
                axes.set_xscale("log")
                even_in_ratios(axes.xaxis)
            scale.limit(axes, "y", foot=gaps.foot())
            sheet.tick(axes, "x", x)
            axes.grid(True, color="0.9")
            place = np.nanargmin(values)
            _star(axes, x[place], values[place], sheet.legend)
            if k % len(self.over) == 0:
                axes.set_ylabel(fitted(sheet.up, label(sweep, column), scale.note))
                axes.set_title(
                    f"★ {number(values[place])}, design {cut.numbers[place]}{_ties(values)}",
                    loc="left",
                    color=_RED,
                )
            if k + len(self.over) >= len(sheet.plots):
                axes.set_xlabel(fitted(0.9 * sheet.across, label(sweep, name)))
        return sheet.finish(
            f"{sweep.case}: peak over time of {cut.numbers.size} designs", *cut.notes, same
        )


@dataclass(frozen=True)
class Along:
    """The section forces of a link over xi/l and a parameter: at each ratio the largest in size
    over the instants, signed.

    A few values of the parameter are curves, more are a map. Where the sign alternates, as where
    the largest and the least of a force are alike, the size is drawn.
    """

    name: str
    link: str
    over: str
    at: Mapping[str, float] = field(default_factory=dict)

    def draw(self, sweep: Sweep) -> Figure:
        """The figure. Raises :class:`NoDesignError` where no design that it shows has a result."""
        cut = Cut.of(sweep, (self.over,), self.at)
        (there,), xi = cut.axes, sweep["xi"]
        mapped = there.size > LINES
        flips: dict[str, Any] = {}
        gaps = MissingDesigns.of(sweep, np.repeat(cut[STATUS][:, None], xi.size, axis=1))
        forces = table_of(sweep.description.space).forces
        sheet = Sheet.of(len(forces), share=("all", mapped))
        for axes, force in zip(sheet.plots, forces, strict=True):
            column = f"peak_at:section:{self.link}:{force}"
            values = cut[column]
            if np.isnan(values).all():
                raise NoDesignError(_none(cut.notes))
            sized = _alternates(values)
            values, words = np.abs(values) if sized else values, label(sweep, column, sized)
            if mapped:
                scale = Scale.of(values, sides=1 if sized else 2)
                colours = "viridis" if sized else "RdBu_r"
                sheet.bar(
                    axes,
                    _cells(axes, (there, xi), values, scale, gaps, sheet.legend, colours),
                    scale,
                    words,
                )
                sheet.tick(axes, "y", xi)
            else:
                for k, row in enumerate(values):
                    # Where the largest changes its sign, it mostly jumps from one instant to
                    # another.
                    jumps = np.flatnonzero(_flips(row))
                    colour = _colour(k, there.size)
                    for j in jumps:
                        (jump,) = axes.plot(
                            xi[j : j + 2], row[j : j + 2], ":", color=colour, linewidth=0.8
                        )
                        flips["where the largest in size changes its sign"] = jump
                    x, y = (np.insert(w, jumps + 1, np.nan) for w in (xi, row))
                    (line,) = axes.plot(x, y, color=colour, linewidth=1.1)
                    why = "" if np.isfinite(row).any() else f", {gaps.words[gaps.codes[k, 0] - 1]}"
                    sheet.legend[value(sweep, self.over, there[k]) + why] = line
                axes.axhline(0.0, color="0.6", linewidth=0.8, zorder=0)
                sheet.tick(axes, "x", xi)
                axes.grid(True, color="0.9")
                axes.set_ylabel(fitted(sheet.up, words))
        sheet.legend.update(flips)
        ratio = r"$\xi/l$"
        sheet.name_axes(*((label(sweep, self.over), ratio) if mapped else (ratio, "")))
        return sheet.finish(
            f"{sweep.case}: section forces of {self.link}, at each ratio the largest in size over"
            " time",
            *cut.notes,
        )


@dataclass(frozen=True)
class Front:
    """Two columns or parameters of all designs against each other, and the designs of which no
    other is less in both.

    Where ``at`` is given, of the designs with these values.
    """

    name: str
    first: str
    second: str
    at: Mapping[str, float] = field(default_factory=dict)

    def draw(self, sweep: Sweep) -> Figure:
        """The figure. Raises :class:`NoDesignError` where no design has a result."""
        pair, sweep = (self.first, self.second), sweep.select(**self.at)
        front = best(sweep, minimise=pair)
        if not front:
            raise NoDesignError(_none(stays(sweep, self.at)))
        stride = 1 + sweep.size // DOTS
        count, dots = 0, []
        for numbers, values in chosen(sweep, pair, ["status==0"]):
            count += numbers.size
            # By the golden ratio, since each n-th of a grid may be all that share a value, or none
            # of those chosen.
            few = numbers * _GOLDEN % 1.0 * stride < 1.0
            dots.append([size(name, values[name])[few] for name in pair])
        x, y = np.concatenate(dots, axis=1)
        u, v = (size(name, np.array([design.values[name] for design in front])) for name in pair)
        sheet = Sheet.of(1)
        (axes,) = sheet.plots
        if count > len(front):
            words = "designs with a result" + (f", 1 in {stride} drawn" if stride > 1 else "")
            (sheet.legend[words],) = axes.plot(
                x, y, "o", color="0.75", markersize=2.5, markeredgewidth=0.0
            )
        axes.step(u, v, where="post", color=_RED, linewidth=0.8)
        words = f"front: no other is less in both ({len(front)})"
        (sheet.legend[words],) = axes.plot(u, v, "o", color=_RED, markersize=2.5)
        scales = [Scale.of(both) for both in (np.append(x, u), np.append(y, v))]
        for axis, scale, held in zip("xy", scales, (u, v), strict=True):
            scale.limit(axes, axis, held)
        varied = [
            name
            for name in sweep.parameters
            if name not in self.at and sweep.dimensions.get(name) != 1
        ]
        screen = (axes.transScale + axes.transLimits).transform(np.column_stack([u, v])) * (
            sheet.across,
            sheet.up,
        )
        for n, k in enumerate(_apart(screen), 1):
            where = ", ".join(value(sweep, name, front[k].values[name]) for name in varied)
            style = {"color": _RED, "linestyle": "", "zorder": 4}
            sheet.legend[where] = (
                *axes.plot(
                    u[k],
                    v[k],
                    "o",
                    markersize=8.0,
                    markerfacecolor="white",
                    markeredgewidth=0.8,
                    clip_on=False,
                    **style,
                ),
                *axes.plot(
                    u[k],
                    v[k],
                    marker=f"${n}$",
                    markersize=4.5,
                    markeredgewidth=0.0,
                    clip_on=False,
                    **style,
                ),
            )
        for axis, name, scale in zip("xy", pair, scales, strict=True):
            axes.set(**{f"{axis}label": fitted(0.9 * sheet.up, label(sweep, name), scale.note)})
        axes.grid(True, color="0.9")
        return sheet.finish(f"{sweep.case}: designs and their front", *stays(sweep, self.at))


Spec = Peaks | Scatter | Along | Front


def draw_sweep(
    sweep: Sweep, specs: Sequence[Spec], folder: Path, svg: bool = False
) -> Iterator[tuple[Path, str]]:
    """Draw into an existing folder, one by one, as PNG or as SVG: the file, and where it is not
    drawn, why.
    """
    ending = ending_of(svg)
    for spec in specs:
        path = folder / f"{spec.name}{ending}"
        why = ""
        with one_at_a_time(STYLE):
            try:
                save(spec.draw(sweep), path, ending, dpi=200)
            except NoDesignError as error:
                why = str(error)
        yield path, why


def _none(notes: Sequence[str]) -> str:
    return " ".join(("no design", *notes, "has a result"))


def _differing(columns: Sequence[str], cut: Cut) -> tuple[dict[str, Array], str]:
    """The sizes of columns that are not the same for all designs drawn, and in words those that
    are.
    """
    shown, same = {}, []
    for column in columns:
        values = size(column, cut[column])
        found = values[np.isfinite(values)]
        if found.size and np.ptp(found) <= 1e-9 * found.max():
            same.append(f"{label(cut.sweep, column)} = {number(found[0])}")
        elif found.size:
            shown[column] = values
    more = f"; and {len(same) - _NAMED} more" if len(same) > _NAMED else ""
    words = f"{'; '.join(same[:_NAMED])}{more}"
    if not shown:
        raise NoDesignError(
            f"{', '.join(('the same for all drawn', *cut.notes))}: {words}"
            if same
            else _none(cut.notes)
        )
    return shown, f"the same for all drawn: {words}" if same else ""


def _cells(
    axes: Axes,
    over: tuple[Array, ...],
    values: Array,
    scale: Scale,
    gaps: MissingDesigns,
    legend: dict[str, Artist],
    colours: str = "viridis",
) -> QuadMesh:
    """A map of values over two axes, and of what has none."""
    from matplotlib import colormaps

    logs = [logarithmic(x) for x in over]
    sides = [edges(x, log) for x, log in zip(over, logs, strict=True)]
    shades = colormaps[colours].with_extremes(**_OUTSIDE.get(colours, {}))
    cells = axes.pcolormesh(*sides, values.T, cmap=shades, norm=scale.norm(), rasterized=True)
    gaps.shade(axes, sides[0], sides[1], legend)
    for axis, log in zip("xy", logs, strict=True):
        if log:
            axes.set(**{f"{axis}scale": "log"})
            even_in_ratios(getattr(axes, f"{axis}axis"))
    return cells


def _curves(
    axes: Axes, cut: Cut, values: Array, gaps: MissingDesigns, legend: dict[str, Artist]
) -> None:
    """Values over the first axis, a curve for each place along the second one if there is one."""
    x, rest = cut.axes[0], cut.axes[1:]
    many = values.reshape(x.size, -1).T
    codes = gaps.codes.reshape(x.size, -1).T
    style = ".-" if x.size <= 60 else "-"
    for k, row in enumerate(many):
        colour = _colour(k, len(many))
        (line,) = axes.plot(x, row, style, color=colour, linewidth=1.1, markersize=3.5)
        MissingDesigns(codes[k], gaps.words).cross(axes, x, legend, colour, k)
        if rest:
            legend[value(cut.sweep, cut.names[1], rest[0][k])] = line
    if logarithmic(x):
        axes.set_xscale("log")
        even_in_ratios(axes.xaxis)
    axes.grid(True, color="0.9")


def _flips(values: Array) -> npt.NDArray[np.bool_]:
    """Return where the next value has the other sign, and both are more than rounding."""
    small = 1e-6 * np.nanmax(np.abs(values), initial=0.0)
    screen = np.where(np.abs(values) > small, values, 0.0)
    return np.asarray(screen[1:] * screen[:-1] < 0.0)


def _alternates(values: Array) -> bool:
    """Return whether the sign changes more than three times along rows or columns, on average."""
    return any(float(_flips(each).sum(axis=0).mean()) > _OFTEN for each in (values, values.T))


def _ties(values: Array) -> str:
    """Number of others that are as small as the smallest, in words."""
    others = int(near(values, np.nanmin(values)).sum()) - 1
    return f" and\N{NO-BREAK SPACE}{others} more" if others else ""


def _star(axes: Axes, x: float, y: float, legend: dict[str, Artist]) -> None:
    (legend["smallest of those drawn"],) = axes.plot(x, y, clip_on=False, zorder=5, **_STAR)


def _colour(k: int, count: int) -> ColorType:
    """The colour of a curve among some in order."""
    from matplotlib import colormaps

    return _BLUE if count == 1 else colormaps["viridis"](0.88 * k / (count - 1))


def _apart(places: Array) -> list[int]:
    """Numbers of a few places (n, 2) in inches along a curve, its ends among them, that lie evenly
    and apart.
    """
    distance = np.abs(places - places[0]).sum(axis=1)
    count = min(_KEYED, 1 + int(distance[-1] / _RING))
    kept: list[int] = []
    for wanted in (0.0, *np.linspace(distance[-1], 0.0, count)[:-1]):
        k = int(np.argmin(np.abs(distance - wanted)))
        if all(np.hypot(*(places[k] - places[j])) > _RING for j in kept):
            kept.append(k)
    return sorted(kept)
