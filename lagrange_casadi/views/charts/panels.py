"""Panels of a sweep's figures: the designs that they show, scales, words, and a figure of panels
with a title above and a legend below.
"""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array, Operand
from ...model.wanted_names import SENSITIVITY
from ...studies.sweep.axes import DESIGN
from ...studies.sweep.meanings import KINDS, STATUS, Kind
from ...studies.sweep.reading import Sweep
from ..shapes.picture_files import subplots

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

STYLE: dict[Any, Any] = {
    "font.size": 8,
    "axes.titlesize": 7,
    "legend.fontsize": 7.5,
    "hatch.linewidth": 0.5,
    "grid.color": "0.9",
    "axes.formatter.min_exponent": 3,
}
"""Settings for matplotlib's ``rc_context``: sizes for a report's column, in which figures have
their own size.
"""

DOTS, LINES = 20_000, 6
"""No more dots, or curves of a family, are drawn."""

BLUE, RED = "#1f4e79", "#c1272d"

_PIXELS = 800
_ALONE, _PAGE, _HEIGHT = (3.5, 2.9), 7.0, 2.3
_LETTERS = 52
"""Letters of 7.5 points in half the width of a page, with what stands beside them."""


@dataclass(frozen=True, eq=False)
class Cut:
    """The designs that are drawn: of a grid over axes ``names``, or of a list over its designs;
    ``orders`` are the numbers along each of these axes, by ascending values.
    """

    sweep: Sweep
    names: tuple[str, ...]
    orders: tuple[npt.NDArray[np.intp], ...]
    notes: str

    @classmethod
    def of(
        cls, sweep: Sweep, over: Sequence[str], at: Mapping[str, float], family: str = ""
    ) -> Cut:
        """Cut where other parameters of a grid than ``over`` and the ``family`` have the values
        ``at``, or those in the middle. No axis is finer than the picture.
        """
        most = dict.fromkeys(over, _PIXELS) | {family: LINES, DESIGN: DOTS}
        names = tuple(name for name in (*over, family, DESIGN) if name in sweep.dimensions)
        sweep, fixed, notes = sweep.select(**at), dict(at), list[str]()
        for name, length in zip(sweep.dimensions, sweep.shape, strict=True):
            if name not in names:
                sweep = sweep.part(name, slice((length - 1) // 2, (length + 1) // 2))
                fixed[name] = float(sweep[name][0])
            elif length > most[name]:
                stride = -(-length // most[name])
                sweep = sweep.part(name, slice(None, None, stride))
                what = "designs" if name == DESIGN else f"values of {name}"
                notes.append(f"1 in {stride} {what} drawn")
        orders = tuple(np.argsort(sweep[name], kind="stable") for name in names)
        return cls(sweep, names, orders, "; ".join([*stays(sweep, fixed), *notes]))

    def along(self, name: str) -> Array:
        """Values of a parameter, or numbers of a list's designs, in the order that is drawn."""
        axis = name if name in self.names else DESIGN
        return np.asarray(self.sweep[name][self.orders[self.names.index(axis)]])

    def __getitem__(self, column: str) -> Operand:
        """A column over the axes that are drawn, in their order, and its own."""
        values, dimensions = self.sweep[column], list(self.sweep.dimensions)
        kept = [dimensions.index(name) for name in self.names]
        values = np.moveaxis(values, kept, range(len(kept)))
        values = values.reshape(*values.shape[: len(kept)], *values.shape[len(dimensions) :])
        return np.asarray(values[np.ix_(*self.orders)])

    @cached_property
    def gaps(self) -> str:
        """Reasons for which numbers are missing, in words: designs have no result, or equilibrium
        leaves numbers open.
        """
        states = [state for state in np.unique(self[STATUS]).tolist() if state]
        reasons = (self.sweep.statuses.get(state, ("", "unknown"))[1] for state in states)
        words = "; ".join(reason.partition(":")[0] for reason in reasons)
        return f"no result: {words}" if words else "indeterminate"


@dataclass
class Panels:
    """A figure of panels, and the entries of the legend below them."""

    figure: Figure
    axes: list[Any]
    columns: int
    legend: dict[str, Any] = field(default_factory=dict)

    @classmethod
    def of(cls, count: int, columns: int = 0, **share: Any) -> Panels:
        """Panels row by row: one in a report's column, more over a page's width."""
        columns = columns or (count if count <= 3 else 2 if count == 4 else 3)
        rows = -(-count // columns)
        size = _ALONE if count == 1 else (_PAGE, _HEIGHT * rows)
        figure, axes = subplots(size, rows, columns, **share)
        for one in axes[count:]:
            one.set_axis_off()
        return cls(figure, axes[:count], columns)

    def map(
        self,
        axes: Axes,
        over: Sequence[Array],
        values: Array,
        text: str,
        gaps: str,
        signed: bool = False,
    ) -> None:
        """Values over two axes as colours; ``signed`` ones have zero in the middle of these."""
        from matplotlib.colors import AsinhNorm
        from matplotlib.patches import Patch
        from matplotlib.ticker import AsinhLocator

        sides = (cells(axes, axis, x) for axis, x in zip("xy", over, strict=True))
        norm, extend, note = scale(values, signed)
        mesh = axes.pcolormesh(
            *sides,
            values.T,
            cmap="RdBu_r" if signed else "viridis",
            norm=norm,
            rasterized=True,
        )
        few = AsinhLocator(norm.linear_width, numticks=5) if isinstance(norm, AsinhNorm) else None
        style: dict[str, Any] = {"location": "top", "extend": extend, "aspect": 25, "pad": 0.02}
        self.figure.colorbar(mesh, ax=axes, label=text + note, ticks=few, **style)
        if np.isnan(values).any():
            hatched: dict[str, Any] = {"hatch": "//////", "edgecolor": "0.45", "linewidth": 0.0}
            axes.patch.set(**hatched)
            self.legend[gaps] = Patch(facecolor="white", **hatched)

    def curves(
        self,
        axes: Axes,
        x: Array,
        rows: Array,
        names: Sequence[str],
        gaps: str,
        **style: Any,
    ) -> None:
        """A curve for each row of values, with its name, if it has one, in the legend; and crosses
        at the foot where numbers are missing.
        """
        from matplotlib import colormaps

        colours = colormaps["viridis"](np.linspace(0.0, 0.88, len(rows)))
        crosses: dict[str, Any] = {"marker": "x", "markersize": 3, "linestyle": ""}
        for row, name, colour in zip(
            rows, names, colours if len(rows) > 1 else [BLUE], strict=True
        ):
            (line,) = axes.plot(x, row, color=colour, **style)
            if name:
                self.legend[name] = line
            if (missing := x[np.isnan(row)]).size:
                foot, place = np.full(missing.size, 0.02), axes.get_xaxis_transform()
                (self.legend[gaps],) = axes.plot(
                    missing, foot, color=colour, transform=place, **crosses
                )
        axes.grid(True)

    def name_axes(self, x: Sequence[str], y: str = "") -> None:
        """Say below the lowest panels, of which each column may have its own, and left of the
        leftmost ones, what is along their axes.
        """
        for k, axes in enumerate(self.axes):
            if k + self.columns >= len(self.axes):
                axes.set_xlabel(x[k % len(x)])
                axes.tick_params(labelbottom=True)
            if y and k % self.columns == 0:
                axes.set_ylabel(y)

    def finish(self, *title: str) -> Figure:
        """The lines of a title and the legend, for which the figure grows."""
        halves = min(len(self.axes), 2)
        lines = (textwrap.fill(line, halves * _LETTERS) for line in title if line)
        around: list[Any] = [self.figure.suptitle("\n".join(lines), fontsize=8.5)]
        if self.legend:
            around.append(
                self.figure.legend(
                    [*self.legend.values()],
                    [textwrap.fill(text, _LETTERS) for text in self.legend],
                    loc="outside lower center",
                    ncols=min(len(self.legend), halves),
                )
            )
        heights = (artist.get_window_extent().height / self.figure.dpi for artist in around)
        self.figure.set_figheight(self.figure.get_figheight() + sum(heights))
        return self.figure


def cells(axes: Axes, axis: str, x: Array) -> Array:
    """The edges of cells whose middles are ``x``, ascending, along an axis, which is logarithmic
    where they are even in ratios.
    """
    log = along(axes, axis, x)
    place = np.log(x) if log else x
    half = np.diff(place) / 2.0 if x.size > 1 else np.array([0.5])
    between = place[:-1] + half[: place.size - 1]
    found = np.concatenate([place[:1] - half[:1], between, place[-1:] + half[-1:]])
    return np.asarray(np.exp(found) if log else found)


def along(axes: Axes, axis: str, x: Array) -> bool:
    """Let an axis of a panel be logarithmic where values along it are even in ratios rather than
    in steps: they span ten times, and half of them are below the mean of their geometric and their
    arithmetic middle. Return whether it is.
    """
    low, high = float(x.min()), float(x.max())
    if low <= 0.0 or high < 10.0 * low:
        return False
    log = bool(np.median(x) < np.sqrt(np.sqrt(low * high) * (low + high) / 2.0))
    if log:
        axes.set(**{f"{axis}scale": "log"})
    return log


def scaled(axes: Axes, axis: str, values: Array, text: str, held: Sequence[float] = ()) -> None:
    """Scale and name an axis of a panel, after values along it are drawn; those ``held`` are
    inside.
    """
    from matplotlib.colors import LogNorm

    norm, _, note = scale(values)
    limits = [norm.vmin, norm.vmax, *held]
    setattr(axes.dataLim, f"interval{axis}", (min(limits), max(limits)))
    if isinstance(norm, LogNorm) and min(limits) > 0.0:
        axes.set(**{f"{axis}scale": "log"})
    axes.set(**{f"{axis}label": text + note})
    axes.grid(True)


def scale(values: Array, signed: bool = False) -> tuple[Any, str, str]:
    """The scale of colours or of an axis; ends of it beyond which there are values, as matplotlib's
    ``extend``; and a note of the largest of these.

    A few designs near a dead centre do not set the scale: it ends where values are farther from the
    middle 90 % of them than these span, if some are farther than twice that. It is logarithmic, and
    spans are ratios, where half of the values would be in its lowest fifth otherwise, and the
    middle 90 % span more than five times. That of ``signed`` values is of their sizes, on both
    sides of zero.
    """
    from matplotlib.colors import AsinhNorm, LogNorm, Normalize

    there = values[np.isfinite(values)]
    sizes = np.sort(np.abs(there) if signed else there)
    # Of a few values, the least and the largest are never in the middle.
    ends = -(-sizes.size // 20) if sizes.size > 3 else 0
    near, middle, far = sizes[ends], np.median(sizes), sizes[-1 - ends]
    least, most = float(sizes[0]), float(sizes[-1])
    near = max(near, middle / 20.0) if signed else near  # some sizes are zero, or rounding
    log = far > 5.0 * near > 0.0 and middle - least < 0.2 * (most - least)
    turn, back = (np.log, np.exp) if log else (np.positive, np.positive)
    start, end = turn([near, far])
    reach = end - start or np.inf
    low = least if least >= back(start - 2.0 * reach) else float(back(start - reach))
    high = most if most <= back(end + 2.0 * reach) else float(back(end + reach))
    if signed:
        norm = AsinhNorm(near, -high, high) if log else Normalize(-high, high)
    else:
        norm = LogNorm(low, high) if log else Normalize(low, high)
    below, above = (there < (-high if signed else low)).any(), (there > high).any()
    note = f"\nbeyond: up to {most:.4g}" if most > high else ""
    return norm, ("neither", "min", "max", "both")[below + 2 * above], note


def varied(sweep: Sweep) -> list[str]:
    """The parameters that are not the same in all designs."""
    return [name for name in sweep.parameters if np.ptp(sweep[name]) > 0.0]


def stays(sweep: Sweep, at: Mapping[str, float]) -> list[str]:
    """Values of fixed parameters, in words; none where none is fixed."""
    return [f"at {', '.join(value(sweep, *item) for item in at.items())}"] if at else []


def value(sweep: Sweep, name: str, there: float) -> str:
    """A parameter's value in words, with its unit."""
    return f"{name} = {there:.4g}{_unit(sweep.parameters[name], ' {}')}"


def label(sweep: Sweep, name: str, sized: bool = False) -> str:
    """A parameter or a column with its unit, as axes say it; ``sized`` where the size is drawn of
    what has a sign.
    """
    if name in sweep.parameters:
        return name + _unit(sweep.parameters[name], " [{}]")
    kind, group, *parts = name.split(":")
    if kind == SENSITIVITY:
        kind, (group, *parts) = f"{parts[0]}, derivative by {group}", parts[1:]
    words = " ".join(part for part in parts if part != "resultant")
    words = words if group == "section" else f"{group} {words}"
    kind = "|peak|" if sized else KINDS.get(kind, Kind()).label or kind
    return f"{words}, {kind}{_unit(sweep.column(name).unit, ' [{}]')}"


def _unit(unit: str, pattern: str) -> str:
    return "" if unit == "1" else pattern.format(unit.replace("^2", "²").replace("$", r"\$"))
