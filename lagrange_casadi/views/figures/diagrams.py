"""Pictures as textbooks draw them: axial force, shear force and bending moment along each link at
the instant that governs, and the load of each bearing as a polar plot.

All is drawn into one pair of axes in inches, without ticks: many small axes would take long.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...base.arrays import Array
from ...base.quantities import Output
from ...base.tables import SPACE
from ...engine.section_function import Side
from ...results.histories import Peak
from ...results.ordering import vanishes
from ...results.section_laws import SectionLaw
from ...results.solution import Solution
from ..shapes.picture_files import BLUE, RED
from ..shapes.readable import instant, number, scale_for

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_SYMBOLS = {
    "axial": "N",
    "shear": "V",
    "bending": "M",
    "shear_y": "V_y",
    "shear_z": "V_z",
    "torsion": "T",
    "bending_y": "M_y",
    "bending_z": "M_z",
}
_SIDES: tuple[Side, Side] = ("base", "tip")
_POINTS, _SAME = 121, 1e-9
_ROW, _PANEL, _LENGTH, _HEIGHT = 1.5, 3.1, 2.2, 0.42
"""Height of a row, and width of a panel; length of a link in it, and height of its largest value
[inch].
"""
_LABEL, _LINE = 0.62, 0.15
"""Room of a number along the link, and across it [inch]."""
_ACROSS, _POLAR, _RADIUS = 4, 2.7, 0.85
"""Polar plots in a row, side of each and its radius [inch]."""


class Mark(NamedTuple):
    """A value of a section force at a ratio xi/l, on one side of it."""

    xi: float
    side: Side
    value: float


def governing(solution: Solution, link: str) -> Peak:
    """The peak at whose instant the diagrams of a link are drawn.

    It is that of von Mises' stress if the solution has it, else of the bending moment, or of the
    axial force where nothing bends the link.
    """
    stress = Output("stress", link, "von_mises")
    if stress in solution.outputs and solution.determined(stress):
        return solution.peak(stress)
    bending = Output("section", link, "bending")
    if solution.determined(bending) and not vanishes(solution, bending):
        return solution.peak(bending)
    axial = Output("section", link, "axial")
    return solution.peak(axial if solution.determined(axial) else bending)


def marks(law: SectionLaw, force: str) -> list[Mark]:
    """Values of a section force at the only instant of a law: at both ends, on both sides of what
    acts between them, and where it turns.
    """
    places, _ = law.pieces(force).curves()
    found: list[Mark] = []
    # Nothing is to be seen where the density alone changes.
    for xi in sorted({round(float(x), 12) for x in places[:, 0]} - {*law.density.breaks[1:-1]}):
        base, tip = (float(law.at(force, np.array([[xi]]), side)[0, 0]) for side in _SIDES)
        found.append(Mark(xi, "base", base))
        if abs(tip - base) > _SAME * max(abs(base), abs(tip)):
            found.append(Mark(xi, "tip", tip))
    return found


def draw_section_diagrams(solution: Solution, links: Sequence[str], si: bool = False) -> Figure:
    """The section forces along links, each at the instant that governs it, with values at ends and
    peaks.
    """
    forces = list(solution.table.sections)
    rows = len(forces) // 3
    wide, high = 3 * _PANEL + 0.2, len(links) * (0.35 + rows * _ROW) + 0.75
    figure, axes = _sheet(
        wide,
        high,
        f"{solution.case}: section forces at the instants that govern",
        "action of the tip's side on the base's; N > 0 is tension; base left, tip right",
    )
    top = high - 0.45
    for link in links:
        peak = governing(solution, link)
        i = int(np.argmin(np.abs(solution.t - peak.t)))
        law = solution.section(link).law.during(slice(i, i + 1))
        what = Output.of(peak.name).meant(solution.table).long_name
        words = f"{link}, {law.length:.4g} m, at {instant(solution, i)}: largest {what}"
        axes.text(0.2, top, words, fontsize=10, fontweight="bold", va="top")
        top -= 0.3
        for k, force in enumerate(forces):
            x, y = 0.35 + k % 3 * _PANEL, top - (k // 3 + 0.5) * _ROW
            _panel(axes, solution, Output("section", link, force), law, (x, y), si)
        top -= rows * _ROW + 0.05
    return figure


def _panel(
    axes: Axes,
    solution: Solution,
    output: Output,
    law: SectionLaw,
    corner: tuple[float, float],
    si: bool,
) -> None:
    """One force along a link, from a ``corner`` on its base line [inch]."""
    from matplotlib.patheffects import withStroke

    x0, y0 = corner
    force, unit = output.member, solution.unit(output)
    symbol = f"${_SYMBOLS[force].replace('_', '_{') + ('}' if '_' in force else '')}$"
    axes.plot([x0, x0 + _LENGTH], [y0, y0], color="0.2", linewidth=1.6, solid_capstyle="butt")
    if not solution.determined(output):
        axes.text(x0, y0 + 0.6, f"{symbol}: indeterminate", fontsize=9, va="bottom")
        return
    found = [] if vanishes(solution, output) else marks(law, force)
    largest = max((abs(mark.value) for mark in found), default=0.0)
    scale = scale_for(unit, largest, si)
    axes.text(x0, y0 + 0.6, f"{symbol} [{scale.unit}]", fontsize=9, va="bottom")
    if not largest:
        axes.text(x0 + _LENGTH / 2, y0 + 0.05, "0", fontsize=8, ha="center")
        return
    ratios = np.unique([*np.linspace(0.0, 1.0, _POINTS), *(mark.xi for mark in found)])
    values = np.stack([law.at(force, ratios[None], side)[0] for side in _SIDES], axis=1).ravel()
    x, y = x0 + _LENGTH * np.repeat(ratios, 2), y0 + _HEIGHT / largest * values
    for sign, colour in ((1.0, RED), (-1.0, BLUE)):
        if (sign * values > 0.0).any():
            edge = y0 + sign * np.maximum(sign * (y - y0), 0.0)
            axes.fill_between(x, y0, edge, color=colour, alpha=0.25, linewidth=0.0)
    axes.plot([x0, *x, x0 + _LENGTH], [y0, *y, y0], color="0.2", linewidth=1.0)
    for mark in _labelled(found, largest):
        place, height = x0 + _LENGTH * mark.xi, y0 + _HEIGHT / largest * mark.value
        up = mark.value >= 0.0
        axes.text(
            place + {"left": 0.03, "right": -0.03, "center": 0.0}[_aligned(mark, found)],
            height + (0.04 if up else -0.04),
            number(scale.factor * mark.value),
            fontsize=8,
            ha=_aligned(mark, found),
            va="bottom" if up else "top",
            path_effects=[withStroke(linewidth=2.0, foreground="white")],
        )


def _aligned(mark: Mark, found: Sequence[Mark]) -> str:
    """Alignment of a number: away from a jump, on whose other side is another one."""
    jumps = sum(other.xi == mark.xi for other in found) > 1
    return ("left" if mark.side == "tip" else "right") if jumps else "center"


def _labelled(found: Sequence[Mark], largest: float) -> list[Mark]:
    """The marks whose numbers are written, where they have room: the largest one, those of the
    ends, and then others, the largest first. What is zero but for rounding is 0, at ends alone.
    """
    taken: list[Mark] = []
    zeros = [mark for mark in found if abs(mark.value) <= _SAME * largest]
    order = sorted((m for m in found if m not in zeros), key=lambda mark: -abs(mark.value))
    ends = [mark for mark in order if mark.xi in (0.0, 1.0)]
    none = [mark._replace(value=0.0) for mark in zeros if mark.xi in (0.0, 1.0)]
    for mark in dict.fromkeys([*order[:1], *ends, *order, *none]):
        hidden = (
            other
            for other in taken
            if _LENGTH * abs(other.xi - mark.xi) < (_LABEL if other.xi != mark.xi else 0.0)
            and (other.value >= 0.0) == (mark.value >= 0.0)
            and _HEIGHT * abs(other.value - mark.value) < _LINE * largest
        )
        if not any(hidden):
            taken.append(mark)
    return taken


def polar_members(solution: Solution, joint: str) -> tuple[str, str] | None:
    """The components of a joint's force across its axis, on axes that turn with the parent in
    space; None of one without.
    """
    pair = ("fv", "fw") if solution.table is SPACE else ("fx", "fy")
    outputs = [Output("reaction", joint, member) for member in pair]
    known = all(one in solution.outputs and solution.determined(one) for one in outputs)
    return pair if known else None


def draw_polar(solution: Solution, joints: Sequence[str], si: bool = False) -> Figure:
    """The force in each joint over all instants, by its components, with the largest marked."""
    across = min(_ACROSS, max(len(joints), 2))
    wide, high = across * _POLAR, -(-len(joints) // across) * (_POLAR + 0.25) + 0.55
    where = "on axes across the joint's" if solution.table is SPACE else "in ground axes"
    note = f"action of the joint's parent on its child, {where}"
    figure, axes = _sheet(wide, high, f"{solution.case}: bearing loads", note)
    for k, joint in enumerate(joints):
        x = (k % across + 0.5) * _POLAR
        y = high - 0.65 - (k // across) * (_POLAR + 0.25) - _POLAR / 2
        _polar(axes, solution, joint, (x, y), si)
    return figure


def _polar(
    axes: Axes, solution: Solution, joint: str, middle: tuple[float, float], si: bool
) -> None:
    (x0, y0), pair = middle, polar_members(solution, joint)
    axes.text(x0, y0 + _RADIUS + 0.3, joint, fontsize=10, fontweight="bold", ha="center")
    if pair is None:
        axes.text(x0, y0, "indeterminate", fontsize=9, ha="center", va="center")
        return
    outputs = [Output("reaction", joint, member) for member in pair]
    forces = [
        np.zeros_like(solution.t) if vanishes(solution, output) else solution.array(output)
        for output in outputs
    ]
    sizes = np.hypot(*forces)
    if np.isnan(sizes).all():
        axes.text(x0, y0, "not evaluated", fontsize=9, ha="center", va="center")
        return
    # Friction at rest leaves instants without a force.
    i = int(np.nanargmax(sizes))
    most = float(sizes[i])
    scale = scale_for("N", most, si)
    radius = _round_up(scale.factor * most or 1.0)
    turn = np.linspace(0.0, 2.0 * np.pi, 73)
    for share in (0.5, 1.0):
        r = share * _RADIUS
        axes.plot(x0 + r * np.cos(turn), y0 + r * np.sin(turn), color="0.85", linewidth=0.8)
        axes.text(x0 + 0.72 * r, y0 - 0.72 * r, f"{share * radius:g}", fontsize=7, color="0.4")
    for dx, dy in ((_RADIUS, 0.0), (0.0, _RADIUS)):
        axes.plot([x0 - dx, x0 + dx], [y0 - dy, y0 + dy], color="0.85", linewidth=0.8)
    for member, dx, dy in ((pair[0], _RADIUS + 0.15, 0.0), (pair[1], 0.0, _RADIUS + 0.1)):
        axes.text(
            x0 + dx, y0 + dy, f"${member[0]}_{member[1]}$", fontsize=9, ha="center", va="center"
        )
    points: Array = _RADIUS / radius * scale.factor * np.array(forces)
    axes.plot(x0 + points[0], y0 + points[1], color=BLUE, linewidth=1.4)
    axes.plot(
        x0 + np.array([0.0, points[0, i]]),
        y0 + np.array([0.0, points[1, i]]),
        color=RED,
        linewidth=1.2,
    )
    axes.plot(x0 + points[0, i], y0 + points[1, i], "o", color=RED, markersize=4)
    angle = math.degrees(math.atan2(points[1, i], points[0, i]))
    words = f"{scale.said(most)} at {number(angle, 3)}°" if most else "0"
    axes.text(x0, y0 - _RADIUS - 0.14, words, fontsize=8, ha="center", va="top")


def _round_up(value: float) -> float:
    """The next number of one digit, and whose half has two at most."""
    power = 10.0 ** math.floor(math.log10(value))
    return next(
        step * power for step in (1, 2, 3, 4, 5, 6, 8, 10) if step * power >= value * (1 - 1e-9)
    )


def _sheet(wide: float, high: float, title: str, note: str) -> tuple[Figure, Axes]:
    """A figure of a size with a title and a note at its foot, and axes over all of it in inches."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(wide, high))
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set(xlim=(0.0, wide), ylim=(0.0, high))
    axes.set_axis_off()
    axes.text(0.2, high - 0.12, title, fontsize=12, va="top")
    axes.text(0.2, 0.08, note, fontsize=8, color="0.35")
    return figure, axes
