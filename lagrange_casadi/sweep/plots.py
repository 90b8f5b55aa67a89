"""What a designer looks at: peaks over one parameter or two, section forces over xi/l and a parameter, the front of two peaks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import DeclarationError, UnknownNameError
from ..section_law import FORCES
from .axes import DESIGN
from .best import best, chosen, size
from .reading import Sweep

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_PIXELS = 800
_DOTS = 20_000


@dataclass(frozen=True)
class Peaks:
    """Columns over one parameter as curves, or over two as maps; other parameters stay ``at`` values, or in the middle."""

    name: str
    columns: tuple[str, ...]
    over: tuple[str, ...]
    at: Mapping[str, float] = field(default_factory=dict)

    def draw(self, sweep: Sweep) -> Figure:
        """The figure."""
        figure, rows = _figure(len(self.columns))
        cut, note = _cut(sweep, self.over, self.at)
        for axes, column in zip(rows, self.columns, strict=True):
            values = _over(cut, column, self.over)
            if len(self.over) == 2:
                _map(figure, axes, cut, column, self.over, values)
            else:
                x = cut[self.over[0]]
                style = "." if DESIGN in sweep.dimensions else ".-" if x.size <= 60 else "-"
                order = np.argsort(x, kind="stable")
                axes.plot(x[order], values[order], style, linewidth=1.2)
                axes.set_ylabel(_label(sweep, column))
                axes.grid(True, color="0.9")
        rows[-1].set_xlabel(_label(sweep, self.over[0]))
        _title(figure, sweep, "peaks, by size" + note)
        return figure


@dataclass(frozen=True)
class Along:
    """The section forces of a link over xi/l and a parameter: at each ratio the largest in size over the instants."""

    name: str
    link: str
    over: str
    at: Mapping[str, float] = field(default_factory=dict)

    def draw(self, sweep: Sweep) -> Figure:
        """The figure."""
        figure, rows = _figure(len(FORCES))
        cut, note = _cut(sweep, (self.over,), self.at)
        for axes, force in zip(rows, FORCES, strict=True):
            column = f"peak_at:section:{self.link}:{force}"
            values = np.squeeze(cut[column], tuple(k for k, n in enumerate(cut.dimensions) if n != self.over))
            bound = np.nanmax(np.abs(values), initial=0.0) or 1.0
            x, y = cut[self.over], sweep["xi"]
            order = np.argsort(x)
            picture = axes.pcolormesh(x[order], y, values[order].T, cmap="RdBu_r", vmin=-bound, vmax=bound, shading="nearest")
            axes.set_ylabel(r"$\xi/l$")
            figure.colorbar(picture, ax=axes, label=f"{force} [{sweep.column(column).unit}]")
        rows[-1].set_xlabel(_label(sweep, self.over))
        _title(figure, sweep, f"section forces of {self.link}, largest in size over time" + note)
        return figure


@dataclass(frozen=True)
class Front:
    """Two columns of all designs against each other, and those of which no other is less in both."""

    name: str
    first: str
    second: str

    def draw(self, sweep: Sweep) -> Figure:
        """The figure."""
        figure, (axes,) = _figure(1)
        pair = (self.first, self.second)
        stride = 1 + sweep.size // _DOTS
        dots = [np.stack([size(n, v[n])[numbers % stride == 0] for n in pair]) for numbers, v in chosen(sweep, pair)]
        axes.plot(*np.concatenate(dots, axis=1), ".", color="0.7", markersize=3, label="designs")
        front = best(sweep, minimise=pair)
        curve = [[abs(design.values[name]) for design in front] for name in pair]
        axes.plot(*curve, "o-", color="tab:red", markersize=4, label="none is less in both")
        axes.set_xlabel(_label(sweep, self.first))
        axes.set_ylabel(_label(sweep, self.second))
        axes.grid(True, color="0.9")
        axes.legend(frameon=False)
        _title(figure, sweep, "the front of two peaks")
        return figure


Spec = Peaks | Along | Front


def default_plots(
    sweep: Sweep, *, over: Sequence[str] = (), at: Mapping[str, float] | None = None, against: Sequence[tuple[str, str]] = ()
) -> tuple[Spec, ...]:
    """The usual drawings of a sweep: over the one or two parameters named, or the first ones, the others ``at`` values.

    Raises :class:`UnknownNameError` for what is not there, :class:`DeclarationError` for more than two parameters, or for two of a
    list.
    """
    at = dict(at or {})
    for name in (*over, *at):
        if name not in sweep.parameters:
            raise UnknownNameError("swept parameter", name, sweep.parameters)
    listed = DESIGN in sweep.dimensions
    free = [name for name in sweep.parameters if name not in at]
    names = tuple(over) or tuple(free[: 1 if listed else 2]) or tuple(list(sweep.parameters)[:1])
    if len(names) > (1 if listed else 2):
        raise DeclarationError(f"plots are over one parameter{' of a list' if listed else ' or two'}, got {', '.join(names)}")
    groups: dict[str, list[str]] = {}
    for name, kept in sweep.columns.items():
        kind, *parts = name.split(":")
        if kind == "peak" and not kept.axes:
            group = {"effort": "effort", "section": f"section_{parts[1]}"}.get(parts[0])
            group = group or ("reactions" if parts[-1] == "resultant" else None)
            if group:
                groups.setdefault(group, []).append(name)
    specs: list[Spec] = [Peaks(f"peak_{group}", tuple(columns), names, at) for group, columns in groups.items()]
    links = dict.fromkeys(name.split(":")[2] for name in sweep.columns if name.startswith("peak_at:"))
    specs += [Along(f"along_{link}", link, names[0], at) for link in links if not listed]
    pairs = list(against)
    if not pairs:
        effort = next((name for name in sweep.columns if name.startswith("peak:effort:")), None)
        bending = next((name for name in list(sweep.columns)[::-1] if name.startswith("peak:section:") and "bending" in name), None)
        pairs = [(effort, bending)] if effort and bending else []
    for first, second in pairs:
        sweep.column(first), sweep.column(second)
        specs.append(Front("front_" + "_".join(name.replace(":", "-") for name in (first, second)), first, second))
    return tuple(specs)


def draw_sweep(sweep: Sweep, specs: Sequence[Spec], folder: Path) -> Iterator[Path]:
    """Draw into an existing folder as PNG, one by one."""
    for spec in specs:
        path = folder / f"{spec.name}.png"
        # No program's name and no clock, so that the same sweep gives the same bytes.
        spec.draw(sweep).savefig(path, dpi=120, metadata={"Software": None})
        yield path


def _figure(count: int) -> tuple[Figure, Any]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, max(4.2, 2.8 * count)), layout="constrained")
    return figure, figure.subplots(count, 1, sharex=True, squeeze=False)[:, 0]


def _cut(sweep: Sweep, over: Sequence[str], at: Mapping[str, float]) -> tuple[Sweep, str]:
    """The part of a sweep that is drawn, no finer than the picture, and in words where the other parameters stay."""
    if DESIGN in sweep.dimensions:
        return sweep, ""
    words = []
    for name, length in sweep.dimensions.items():
        if name in over:
            sweep = sweep.thinned(name, 1 + (length - 1) // _PIXELS)
            continue
        sweep = sweep.select(**{name: at[name]}) if name in at else sweep.at_number(name, (length - 1) // 2)
        unit = sweep.parameters[name]
        words.append(f"{name} = {sweep[name][0]:.4g}" + ("" if unit == "1" else f" {unit}"))
    return sweep, f" at {', '.join(words)}" if words else ""


def _over(cut: Sweep, column: str, over: Sequence[str]) -> Any:
    """A column's sizes over the axes that are drawn, in their order."""
    values = size(column, cut[column])
    if DESIGN in cut.dimensions:
        return values
    kept = [name for name in cut.dimensions if name in over]
    values = np.squeeze(values, tuple(k for k, name in enumerate(cut.dimensions) if name not in over))
    return np.transpose(values, [kept.index(name) for name in over])


def _map(figure: Any, axes: Any, cut: Sweep, column: str, over: Sequence[str], values: Any) -> None:
    x, y = cut[over[0]], cut[over[1]]
    across, up = np.argsort(x), np.argsort(y)
    picture = axes.pcolormesh(x[across], y[up], values[np.ix_(across, up)].T, cmap="viridis", shading="nearest", rasterized=True)
    axes.set_ylabel(_label(cut, over[1]))
    figure.colorbar(picture, ax=axes, label=_label(cut, column))


def _label(sweep: Sweep, name: str) -> str:
    unit = sweep.parameters.get(name) or sweep.column(name).unit
    words = name.partition(":")[2].replace(":", " ") if ":" in name else name
    return words if unit == "1" else f"{words} [{unit}]"


def _title(figure: Any, sweep: Sweep, words: str) -> None:
    figure.suptitle(f"{sweep.case}: {words}", fontsize=11)
