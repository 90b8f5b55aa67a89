"""Parts of a sweep's figures: designs without a result, words, and a sheet of plots with a title
and a legend.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array, Operand
from ...model.wanted_names import SENSITIVITY
from .meanings import KINDS, Kind
from .reading import Sweep
from .scale import Scale, tick

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.collections import QuadMesh
    from matplotlib.figure import Figure
    from matplotlib.typing import ColorType

_Share: TypeAlias = bool | Literal["none", "all", "row", "col"]
"""Plots of a sheet that share an axis."""

STYLE: dict[Any, Any] = {
    "font.size": 8,
    "axes.titlesize": 7,
    "axes.labelsize": 8,
    "legend.fontsize": 7.5,
    "hatch.linewidth": 0.5,
}
"""Settings for matplotlib's ``rc_context``: sizes for a report's column, in which figures have
their own size.
"""

_COLUMN, _PAGE, _HEIGHT, _ALONE, _LINE, _TITLE = 3.5, 7.0, 2.3, 2.9, 0.17, 8.5
_STEPS = (1, 2, 5, 10)
_NAMED, _TICKED = 3, 6
_FOOT = 0.03
_TIED = re.compile(r" (?=[^\[\]]*\])| (?==)|(?<==) |(?<=\d) (?=[a-zA-Z])")
_SHADES = (0.12, 0.3, 0.48, 0.66)
_CROSSES = ("x", "+", "^", "s")


@dataclass(frozen=True)
class MissingDesigns:
    """Designs without a result: ``codes`` are 0 where there is one, else which of ``words`` says
    why there is none, from 1.
    """

    codes: npt.NDArray[np.int64]
    words: tuple[str, ...]

    @classmethod
    def of(cls, sweep: Sweep, status: Operand) -> MissingDesigns:
        """Make them from the statuses of the designs that are drawn; the most frequent reasons have
        marks of their own.
        """
        kinds, counts = np.unique(status[status != 0], return_counts=True)
        kinds = kinds[np.argsort(-counts, kind="stable")]
        named = kinds if kinds.size <= _NAMED + 1 else kinds[:_NAMED]
        words = [
            sweep.statuses.get(int(kind), ("", "unknown"))[1].partition(":")[0] for kind in named
        ]
        codes = np.where(status != 0, named.size + 1, 0)
        for code, kind in enumerate(named, 1):
            codes[status == kind] = code
        others = ["other reasons"] if named.size < kinds.size else []
        return cls(codes, tuple(f"no result: {text}" for text in words + others))

    def shade(self, axes: Axes, x: Array, y: Array, legend: dict[str, Artist]) -> None:
        """Cells of a map between edges ``x`` and ``y`` hatched, each reason in a grey of its own;
        codes are (x, y).
        """
        from matplotlib.colors import ListedColormap
        from matplotlib.patches import Patch

        if not self.words:
            return
        axes.patch.set(hatch="//////", edgecolor="0.45", linewidth=0.0)
        colours = [(0.0, 0.0, 0.0, shade) for shade in _SHADES[: len(self.words)]]
        cells = np.ma.masked_equal(self.codes, 0).T
        axes.pcolormesh(
            x,
            y,
            cells,
            cmap=ListedColormap(colours),
            vmin=0.5,
            vmax=len(colours) + 0.5,
            rasterized=True,
        )
        for text, colour in zip(self.words, colours, strict=True):
            legend[text] = Patch(facecolor=colour, edgecolor="0.45", hatch="//////", linewidth=0.0)

    def cross(
        self,
        axes: Axes,
        x: Array,
        legend: dict[str, Artist],
        colour: ColorType = "0.4",
        row: int = 0,
    ) -> None:
        """Marks in a row along the foot of curves or dots, at the ``x`` of each design without a
        result.
        """
        from matplotlib.lines import Line2D

        style: dict[str, Any] = {"linestyle": "", "markersize": 3.0, "markeredgewidth": 0.7}
        place = axes.get_xaxis_transform()
        for code, (text, marker) in enumerate(zip(self.words, _CROSSES, strict=False), 1):
            there = x[self.codes == code]
            axes.plot(
                there,
                np.full(there.size, _FOOT * (row + 0.7)),
                marker=marker,
                color=colour,
                transform=place,
                **style,
            )
            legend[text] = Line2D([], [], marker=marker, color="0.4", **style)

    def foot(self, rows: int = 1) -> float:
        """Fraction of an axis for rows of marks."""
        return max(0.05, 1.1 * _FOOT * rows) if self.words else 0.05


@dataclass
class Sheet:
    """A figure of plots, a legend's entries below them, and a title above."""

    figure: Figure
    plots: list[Any]
    width: float
    columns: int
    legend: dict[str, Any] = field(default_factory=dict)

    @classmethod
    def of(
        cls, count: int, *, columns: int = 0, share: tuple[_Share, _Share] = (False, False)
    ) -> Sheet:
        """Panels row by row, one in a report's column, more over a page's width."""
        from matplotlib.figure import Figure
        from matplotlib.ticker import MaxNLocator

        columns = columns or (count if count <= 3 else 2 if count == 4 else 3)
        rows = -(-count // columns)
        width = _COLUMN if count == 1 else _PAGE
        figure = Figure(
            figsize=(width, rows * (_ALONE if count == 1 else _HEIGHT)), layout="constrained"
        )
        grid = figure.subplots(
            rows, columns, squeeze=False, sharex=share[0], sharey=share[1]
        ).ravel()
        for axes in grid[count:]:
            axes.set_axis_off()
        for axes in grid[:count]:
            # Not as many ticks as there is room for: that depends on the layout, which depends on
            # the ticks.
            axes.xaxis.set_major_locator(MaxNLocator(8 if columns < 3 else 6, steps=_STEPS))
            axes.yaxis.set_major_locator(MaxNLocator(6, steps=_STEPS))
        return cls(figure, list(grid[:count]), width, columns)

    @property
    def across(self) -> float:
        """Width of a panel's text, in inches."""
        return 0.83 * self.width / self.columns

    @property
    def up(self) -> float:
        """Height of text beside a panel, in inches."""
        return 0.8 * (_ALONE if len(self.plots) == 1 else _HEIGHT)

    def bar(self, axes: Axes, cells: QuadMesh, scale: Scale, text: str) -> None:
        """A bar of colours above a panel."""
        bar = self.figure.colorbar(
            cells, ax=axes, location="top", extend=scale.extend, aspect=25, pad=0.02
        )
        scale.mark(bar)
        bar.set_label(fitted(0.97 * self.across, text, scale.note))

    def tick(self, axes: Axes, axis: str, values: Array) -> None:
        """Put ticks at the values of axis "x" or "y" of a panel, if these are few."""
        there = np.unique(values[np.isfinite(values)])
        if 0 < there.size <= _TICKED:
            tick(
                getattr(axes, f"{axis}axis"),
                there,
                0.9 * self.across if axis == "x" else 0.7 * self.up,
            )

    def name_axes(self, x: str, y: str = "") -> None:
        """Say below the lowest plots, and left of the leftmost ones, what is along their axes."""
        for k, axes in enumerate(self.plots):
            if k + self.columns >= len(self.plots):
                axes.set_xlabel(fitted(0.9 * self.across, x))
                axes.tick_params(labelbottom=True)
            if y and k % self.columns == 0:
                axes.set_ylabel(fitted(self.up, y))

    def finish(self, title: str, *notes: str) -> Figure:
        """The title, notes below it, and the legend; for these, and for long labels, the figure
        grows.
        """
        words = fitted(0.93 * self.width, title, "; ".join(filter(None, notes)), points=_TITLE)
        self.figure.suptitle(words, fontsize=_TITLE)
        lines = words.count("\n") + 1
        if self.legend:
            entries = [fitted(0.85 * self.width, text, points=7.5) for text in self.legend]
            longest = max(len(line) for text in entries for line in text.split("\n")) + 6
            columns = max(1, min(len(entries), int(17.0 * self.width / longest)))
            lines += -(-sum(text.count("\n") + 1 for text in entries) // columns)
            self.figure.legend(
                list(self.legend.values()),
                entries,
                loc="outside lower center",
                ncols=columns,
                frameon=False,
            )
        bars = [axes.get_xlabel() for axes in self.figure.axes if axes not in self.plots]
        for texts in (bars, [axes.get_title(loc="left") for axes in self.plots]):
            lines += -(-len(self.plots) // self.columns) * max(
                (text.count("\n") for text in texts), default=0
            )
        self.figure.set_figheight(self.figure.get_figheight() + _LINE * lines)
        return self.figure


def fitted(inches: float, *lines: str, points: float = 8.0) -> str:
    """Lines broken to a width, between words or at underscores, not before a unit; empty ones are
    left out.
    """
    most = max(10, int(inches * 132.0 / points))
    found = []
    for line in filter(None, lines):
        found.append("")
        for piece in re.findall(
            rf"[^ _]{{1,{most}}}[ _]?|[ _]", _TIED.sub("\N{NO-BREAK SPACE}", line)
        ):
            if found[-1] and len((found[-1] + piece).rstrip()) > most:
                found.append("")
            found[-1] += piece
    return "\n".join(line.rstrip(" ") for line in found)


def value(sweep: Sweep, name: str, there: float, pattern: str = " {}") -> str:
    """A parameter's value in words, with its unit or without."""
    return f"{name} = {there:.4g}".replace("-", "\N{MINUS SIGN}") + _unit(
        sweep.parameters[name], pattern
    )


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
    return f"{words}, {'|peak|' if sized else KINDS.get(kind, Kind()).label or kind}" + _unit(
        sweep.column(name).unit, " [{}]"
    )


def _unit(unit: str, pattern: str) -> str:
    return "" if unit == "1" else pattern.format(unit.replace("^2", "²").replace("$", r"\$"))
