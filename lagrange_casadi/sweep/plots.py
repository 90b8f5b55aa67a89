"""What a designer looks at: peaks over one parameter or two, section forces over xi/l and a parameter, the front of two columns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ..density import Array
from ..errors import NoDesignError
from ..section_law import FORCES
from .best import best, chosen, size
from .columns import STATUS
from .cut import DOTS, LINES, Cut, stays
from .panels import STYLE, Gaps, Sheet, fitted, label, value
from .reading import Sweep
from .scale import Scale, edges, even_in_ratios, logarithmic, number

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_KEYED, _NAMED, _OFTEN = 5, 3, 3
_BLUE, _RED = "#1f4e79", "#c1272d"
_OUTSIDE = {"viridis": {"over": "#fffbd0", "under": "#1a0022"}, "RdBu_r": {"over": "#3d0010", "under": "#021a33"}}
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
    """Columns of a grid over two parameters as maps, or over one as curves, one for each of some values of ``family``.

    Other parameters stay ``at`` values, or in the middle of their axes.
    """

    name: str
    columns: tuple[str, ...]
    over: tuple[str, ...]
    family: str = ""
    at: Mapping[str, float] = field(default_factory=dict)

    def draw(self, sweep: Sweep) -> Figure:
        """The figure. Raises :class:`NoDesignError` where no design that it shows has a result, or none differs from another."""
        cut = Cut.of(sweep, self.over, self.at, self.family)
        shown, same = _differing(self.columns, cut)
        gaps = Gaps.of(sweep, cut[STATUS])
        sheet = Sheet.of(len(shown), share=("all", "all") if len(self.over) == 2 else ("all", False))
        for axes, (column, values) in zip(sheet.panels, shown.items(), strict=True):
            scale = Scale.of(values)
            if len(self.over) == 2:
                sheet.bar(axes, _cells(axes, cut.axes, values, scale, gaps, sheet.legend), scale, label(sweep, column))
            else:
                _curves(axes, cut, values, gaps, sheet.legend)
                scale.limit(axes, "y", foot=gaps.foot(values.size // len(values)))
                axes.set_ylabel(fitted(sheet.up, label(sweep, column), scale.note))
            place = np.unravel_index(np.nanargmin(values), values.shape)
            spot = [x[k] for x, k in zip(cut.axes, place, strict=True)]
            _star(axes, spot[0], spot[1] if len(self.over) == 2 else values[place], sheet.legend)
            where = ", ".join(value(sweep, name, x, "") for name, x in zip(cut.names, spot, strict=True))
            inches = (0.6 + 0.2 * len(self.over)) * sheet.across
            axes.set_title(fitted(inches, f"★ {number(values[place])} at {where}", points=7), loc="left", color=_RED)
        sheet.name_axes(label(sweep, self.over[0]), label(sweep, self.over[1]) if len(self.over) == 2 else "")
        return sheet.finish(f"{sweep.case}: peak over time of each design", *cut.notes, same)


@dataclass(frozen=True)
class Scatter:
    """Columns of a list's designs over each of some parameters; where ``at`` is given, of the designs with these values."""

    name: str
    columns: tuple[str, ...]
    over: tuple[str, ...]
    at: Mapping[str, float] = field(default_factory=dict)

    def draw(self, sweep: Sweep) -> Figure:
        """The figure. Raises what :meth:`Peaks.draw` does."""
        cut = Cut.listed(sweep, self.at)
        shown, same = _differing(self.columns, cut)
        gaps = Gaps.of(sweep, cut[STATUS])
        sheet = Sheet.of(len(shown) * len(self.over), columns=len(self.over), share=("col", "row"))
        for k, axes in enumerate(sheet.panels):
            (column, values), name = list(shown.items())[k // len(self.over)], self.over[k % len(self.over)]
            scale, x = Scale.of(values), cut.sweep[name]
            axes.plot(x, values, "o", color=_BLUE, markersize=3, alpha=0.6, markeredgewidth=0.0)
            gaps.cross(axes, x, sheet.legend)
            if logarithmic(x):
                axes.set_xscale("log")
                even_in_ratios(axes.xaxis)
            scale.limit(axes, "y", foot=gaps.foot())
            axes.grid(True, color="0.9")
            place = np.nanargmin(values)
            _star(axes, x[place], values[place], sheet.legend)
            if k % len(self.over) == 0:
                axes.set_ylabel(fitted(sheet.up, label(sweep, column), scale.note))
                axes.set_title(f"★ {number(values[place])}, design {cut.numbers[place]}", loc="left", color=_RED)
            if k + len(self.over) >= len(sheet.panels):
                axes.set_xlabel(fitted(0.9 * sheet.across, label(sweep, name)))
        return sheet.finish(f"{sweep.case}: peak over time of {cut.numbers.size} designs", *cut.notes, same)


@dataclass(frozen=True)
class Along:
    """The section forces of a link over xi/l and a parameter: at each ratio the largest in size over the instants, signed.

    A few values of the parameter are curves, more are a map. Where the sign alternates, as where the largest and the least of a
    force are alike, the size is drawn.
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
        gaps = Gaps.of(sweep, np.repeat(cut[STATUS][:, None], xi.size, axis=1))
        sheet = Sheet.of(len(FORCES), share=("all", mapped))
        for axes, force in zip(sheet.panels, FORCES, strict=True):
            column = f"peak_at:section:{self.link}:{force}"
            values = cut[column]
            if np.isnan(values).all():
                raise NoDesignError(_none(cut.notes))
            sized = _alternates(values)
            values, words = np.abs(values) if sized else values, label(sweep, column, sized)
            if mapped:
                scale = Scale.of(np.fmax.reduce(np.abs(values), axis=1), sides=1 if sized else 2)
                colours = "viridis" if sized else "RdBu_r"
                sheet.bar(axes, _cells(axes, (there, xi), values, scale, gaps, sheet.legend, colours), scale, words)
            else:
                for k, row in enumerate(values):
                    # Where the largest changes its sign, it jumps from one instant to another.
                    jumps = np.flatnonzero(_flips(row)) + 1
                    x, y = (np.insert(w, jumps, np.nan) for w in (xi, row))
                    (line,) = axes.plot(x, y, color=_colour(k, there.size), linewidth=1.1)
                    why = "" if np.isfinite(row).any() else f", {gaps.words[gaps.codes[k, 0] - 1]}"
                    sheet.legend[value(sweep, self.over, there[k]) + why] = line
                axes.axhline(0.0, color="0.6", linewidth=0.8, zorder=0)
                axes.grid(True, color="0.9")
                axes.set_ylabel(fitted(sheet.up, words))
        ratio = r"$\xi/l$"
        sheet.name_axes(*((label(sweep, self.over), ratio) if mapped else (ratio, "")))
        return sheet.finish(f"{sweep.case}: section forces of {self.link}, at each ratio the largest in size over time", *cut.notes)


@dataclass(frozen=True)
class Front:
    """Two columns or parameters of all designs against each other, and the designs of which no other is less in both.

    Where ``at`` is given, of the designs with these values.
    """

    name: str
    first: str
    second: str
    at: Mapping[str, float] = field(default_factory=dict)

    def draw(self, sweep: Sweep) -> Figure:
        """The figure. Raises :class:`NoDesignError` where no design has a result."""
        pair, sweep = (self.first, self.second), sweep.select(**self.at)
        stride = 1 + sweep.size // DOTS
        dots = [[size(n, v[n])[numbers % stride == 0] for n in pair] for numbers, v in chosen(sweep, pair, ["status==0"])]
        x, y = np.concatenate(dots, axis=1)
        front = best(sweep, minimise=pair)
        if not front:
            raise NoDesignError(_none(stays(sweep, self.at)))
        u, v = (size(name, np.array([design.values[name] for design in front])) for name in pair)
        sheet = Sheet.of(1)
        (axes,) = sheet.panels
        many = "" if stride == 1 else f", one of {stride} drawn"
        (sheet.legend[f"designs with a result{many}"],) = axes.plot(x, y, "o", color="0.75", markersize=2.5, markeredgewidth=0.0)
        axes.step(u, v, where="post", color=_RED, linewidth=0.8)
        words = f"front: no other is less in both ({len(front)})"
        (sheet.legend[words],) = axes.plot(u, v, "o", color=_RED, markersize=2.5)
        scales = [Scale.of(both) for both in (np.append(x, u), np.append(y, v))]
        for axis, scale, held in zip("xy", scales, (u, v), strict=True):
            scale.limit(axes, axis, held, 0.12)
        varied = [name for name in sweep.parameters if sweep.dimensions.get(name) != 1]
        for count, k in enumerate(_spread(*(np.log(w) if s.log else w for w, s in zip((u, v), scales, strict=True))), 1):
            axes.annotate(str(count), (u[k], v[k]), (-5, -5), textcoords="offset points", ha="right", va="top", color=_RED)
            where = ", ".join(value(sweep, name, front[k].values[name]) for name in varied)
            (sheet.legend[where],) = axes.plot([], [], linestyle="", marker=f"${count}$", color=_RED, markersize=5)
        for axis, name, scale in zip("xy", pair, scales, strict=True):
            axes.set(**{f"{axis}label": fitted(0.9 * sheet.up, label(sweep, name), scale.note)})
        axes.grid(True, color="0.9")
        return sheet.finish(f"{sweep.case}: designs of which no other is less in both", *stays(sweep, self.at))


Spec = Peaks | Scatter | Along | Front


def draw_sweep(sweep: Sweep, specs: Sequence[Spec], folder: Path) -> Iterator[tuple[Path, str]]:
    """Draw into an existing folder as PNG, one by one: the file, and where it is not drawn, why."""
    from matplotlib import rc_context

    for spec in specs:
        path = folder / f"{spec.name}.png"
        why = ""
        with rc_context(STYLE):
            try:
                # No program's name and no clock, so that the same sweep gives the same bytes.
                spec.draw(sweep).savefig(path, dpi=200, metadata={"Software": None})
            except NoDesignError as error:
                why = str(error)
        yield path, why


def _none(notes: Sequence[str]) -> str:
    return " ".join(("no design", *notes, "has a result"))


def _differing(columns: Sequence[str], cut: Cut) -> tuple[dict[str, Array], str]:
    """The sizes of columns that are not the same for all designs drawn, and in words those that are."""
    shown, same = {}, []
    for column in columns:
        values = size(column, cut[column])
        found = values[np.isfinite(values)]
        if found.size and np.ptp(found) <= 1e-9 * found.max():
            same.append(f"{label(cut.sweep, column)} = {number(found[0])}")
        elif found.size:
            shown[column] = values
    more = f"; and {len(same) - _NAMED} more" if len(same) > _NAMED else ""
    words = f"the same for all: {'; '.join(same[:_NAMED])}{more}" if same else ""
    if not shown:
        raise NoDesignError(words or _none(cut.notes))
    return shown, words


def _cells(
    axes: Any, over: tuple[Array, ...], values: Array, scale: Scale, gaps: Gaps, legend: dict[str, Any], colours: str = "viridis"
) -> Any:
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


def _curves(axes: Any, cut: Cut, values: Array, gaps: Gaps, legend: dict[str, Any]) -> None:
    """Values over the first axis, a curve for each place along the second one if there is one."""
    x, rest = cut.axes[0], cut.axes[1:]
    many = values.reshape(x.size, -1).T
    codes = gaps.codes.reshape(x.size, -1).T
    style = ".-" if x.size <= 60 else "-"
    for k, row in enumerate(many):
        colour = _colour(k, len(many))
        (line,) = axes.plot(x, row, style, color=colour, linewidth=1.1, markersize=3.5)
        Gaps(codes[k], gaps.words).cross(axes, x, legend, colour, k)
        if rest:
            legend[value(cut.sweep, cut.names[1], rest[0][k])] = line
    if logarithmic(x):
        axes.set_xscale("log")
        even_in_ratios(axes.xaxis)
    axes.grid(True, color="0.9")


def _flips(values: Array) -> npt.NDArray[np.bool_]:
    """Where the next value has the other sign, and both are more than rounding."""
    small = 1e-6 * np.nanmax(np.abs(values), initial=0.0)
    seen = np.where(np.abs(values) > small, values, 0.0)
    return np.asarray(seen[1:] * seen[:-1] < 0.0)


def _alternates(values: Array) -> bool:
    """Whether the sign changes more than three times along rows or columns, on average."""
    return any(float(_flips(each).sum(axis=0).mean()) > _OFTEN for each in (values, values.T))


def _star(axes: Any, x: Any, y: Any, legend: dict[str, Any]) -> None:
    (legend["smallest of those drawn"],) = axes.plot(x, y, clip_on=False, zorder=5, **_STAR)


def _colour(k: int, count: int) -> Any:
    """The colour of a curve among some in order."""
    from matplotlib import colormaps

    return _BLUE if count == 1 else colormaps["viridis"](0.88 * k / (count - 1))


def _spread(u: Array, v: Array) -> list[int]:
    """Numbers of a few points along a curve, its ends among them, as far from each other as they come."""
    way = np.sum([np.abs(w - w[0]) / (np.ptp(w) or 1.0) for w in (u, v)], axis=0)
    wanted = np.linspace(0.0, way[-1], _KEYED)
    return sorted({int(np.argmin(np.abs(way - place))) for place in wanted})
