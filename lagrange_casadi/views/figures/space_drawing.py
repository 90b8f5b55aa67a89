"""A mechanism in space, drawn from a solution's poses and its description: four orthographic views
to one scale.
"""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ...base.arrays import Array
from ...model.description import Place
from ...results.solution import Solution
from ..shapes.places import placed as spot_at
from ..shapes.readable import Scale, scale_for
from ..shapes.shapes import named_spots
from ..shapes.solid import (
    BLOCK,
    MARKS,
    PATH,
    SPRING,
    Line,
    axes_of,
    cloud_of,
    colour_of,
    grounds_of,
    lines_of,
    marks_of,
    place_of,
    plates_of,
)
from ..shapes.views import AZIMUTH, ELEVATION, View, page, upright, view, views
from .labels import apart, label_bodies, placed
from .stills import stills

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

_THINNED = 2000
"""Largest number of instants at which paths are drawn."""

_FAINT = 0.22
_POINTS = 8.0
"""The size of names [pt]."""

_ROW = 0.21
"""The height of a row of the legend [inch]."""

_ARROW = 26.0
"""Length of the ground's axes [pt]."""

_RING = 4.5 * np.array(
    [
        (0.0, 0.0),
        *((np.cos(angle), np.sin(angle)) for angle in np.linspace(0.0, 2.0 * np.pi, 9)[:-1]),
    ]
)
"""Points of a joint's mark, against its middle [pt]."""

Box = tuple[float, float, float, float]
"""Range of a picture: left, right, bottom and top [m]."""


def draw_in_space(
    solution: Solution, count: int, azimuth: float, elevation: float, si: bool = False
) -> Figure:
    """The mechanism at ``count`` instants, the first strong and the others faint, from four sides,
    with declared points' ways.

    The views from above, from the front and from the right are in third-angle projection; that at
    the upper right is from ``azimuth`` and ``elevation`` [deg], as :func:`.view` counts them, and
    names the joints.
    """
    from matplotlib.figure import Figure

    chosen = stills(solution, count)
    thin = solution.during(slice(None, None, 1 + solution.t.size // _THINNED))
    four = views(solution.description.gravity, azimuth, elevation)
    cloud = cloud_of(thin)
    size = _size(cloud)
    entries = _entries(solution)
    widest = max(0.62 + 0.075 * len(name) for name, _ in entries)
    columns = max(1, min(len(entries), int(9.5 / widest)))
    lines = textwrap.wrap(
        f"{solution.case}: {_instants(solution, chosen)}; orthographic, all views to one scale", 110
    )
    foot = 0.1 + _ROW * -(-len(entries) // columns)
    sheet = page(
        four,
        cloud,
        (0.1 * size, 0.16 * size, 0.1 * size, 0.1 * size),
        0.15 + _ROW * len(lines),
        foot,
    )
    figure = Figure(figsize=sheet.size)
    for one, place, box in zip(four, sheet.places, sheet.boxes, strict=True):
        left, bottom, wide, high = (value / sheet.size[k % 2] for k, value in enumerate(place))
        axes = figure.add_axes((left, bottom, wide, high))
        _frame(axes, one, box, place[2:], scale_for("m", size, si))
        for k in reversed(chosen):
            _draw_instant(
                axes, one, solution.during(slice(k, k + 1)), thin, size, strong=k == chosen[0]
            )
        for point in thin.description.paths.values():
            x, y = one.on_page(place_of(thin, point)).T
            axes.plot(x, y, color=PATH, linewidth=1.4, zorder=2, label="_")
        if one is four[1]:
            named = named_spots(solution.description)
            _label(axes, one, (solution, thin), named, size, box, 72.0 * sheet.scale)
    handles, names = [handle for _, handle in entries], [name for name, _ in entries]
    figure.legend(
        handles,
        names,
        loc="lower center",
        ncols=columns,
        frameon=False,
        fontsize=9,
        labelspacing=0.35,
    )
    figure.suptitle("\n".join(lines), fontsize=11, y=1.0 - 0.12 / sheet.size[1], va="top")
    return figure


def draw_into(axes: Axes, solution: Solution, named: Mapping[str, Place]) -> None:
    """The mechanism at its first instant, into axes of a figure, from one side, with the names of
    some places.
    """
    one = view(upright(solution.description.gravity), AZIMUTH, ELEVATION)
    now, cloud = solution.during(slice(0, 1)), cloud_of(solution)
    size, flat = _size(cloud), one.on_page(cloud)
    low, high = flat.min(axis=0) - 0.14 * size, flat.max(axis=0) + 0.14 * size
    box = (low[0], high[0], low[1], high[1])
    _frame(axes, one, box, (4.6, 3.4), scale_for("m", size))
    axes.set_aspect("equal")
    axes.set_xlabel(one.title, fontsize=8)
    _draw_instant(axes, one, now, solution, size, strong=True)
    # Where a layout decides how large the axes will be, as if they were as large as they are drawn
    # in a column of two.
    wide, high = 4.6, 3.4
    if not axes.figure.get_layout_engine():
        figure: Any = axes.figure
        wide, high = axes.get_position().size * figure.get_size_inches()
    scale = 72.0 * min(wide / (box[1] - box[0]), high / (box[3] - box[2]))
    _label(axes, one, (solution, solution), named, size, box, scale)
    bodies = [
        (name, handle) for name, handle in _entries(solution) if name in solution.description.bodies
    ]
    label_bodies(axes.figure, [handle for _, handle in bodies], [name for name, _ in bodies])


def _size(cloud: Array) -> float:
    return float(np.ptp(cloud, axis=0).max()) or 1.0


def _instants(solution: Solution, chosen: list[int]) -> str:
    times = [
        f"{solution.t[i]:.4g} s"
        + (f" ({solution.over.shown(solution.over.values[i])})" if solution.over else "")
        for i in chosen
    ]
    return f"t = {times[0]}" + (f", and faint {', '.join(times[1:])}" if times[1:] else "")


def _frame(axes: Axes, one: View, box: Box, size: Sequence[float], scale: Scale) -> None:
    """Range of a picture, and its scales, with as many numbers as fit its ``size`` [inch]."""
    from matplotlib.ticker import FuncFormatter, MaxNLocator

    axes.set(xlim=box[:2], ylim=box[2:])
    axes.set_title(one.title, fontsize=10)
    axes.set_axisbelow(True)
    if one.coordinates is None:
        axes.set(xticks=[], yticks=[])
        return
    axes.grid(True, color="0.93")
    for axis, name, most in zip(
        (axes.xaxis, axes.yaxis), one.coordinates, (size[0] / 0.7, size[1] / 0.4), strict=True
    ):
        axis.set_major_locator(MaxNLocator(max(1, min(6, int(most)))))
        axis.set_label_text(f"{name[-1]} [{scale.unit}]")
        if name.startswith("-"):
            axis.set_major_formatter(FuncFormatter(lambda value, _: scale.label(0.0 - value)))
        else:
            scale.put(axis)
    axes.tick_params(labelsize=8)


def _draw_instant(
    axes: Axes, one: View, now: Solution, thin: Solution, size: float, *, strong: bool
) -> None:
    """A solution's first instant; axes of joints only where it is the ``strong`` one."""
    from matplotlib.markers import CARETUP

    alpha, behind = (1.0, 0) if strong else (_FAINT, -6)
    for body, corners in plates_of(now):
        x, y = one.on_page(corners).T
        axes.fill(
            x,
            y,
            facecolor=colour_of(now, body),
            alpha=0.25 * alpha,
            linewidth=0.0,
            zorder=12 + behind,
        )
    lines: list[Line] = [*lines_of(now), *(axes_of(now, thin, size) if strong else ())]
    for line in lines:
        x, y = one.on_page(line.points).T
        label = line.body or "_"
        axes.plot(
            x,
            y,
            color=line.colour,
            linewidth=line.width,
            linestyle=line.style,
            solid_capstyle="round",
            alpha=alpha,
            zorder=10 + line.order + behind,
            label=label if strong else "_",
        )
    for mark in marks_of(now):
        x, y = one.on_page(mark.place)
        axes.plot(
            x,
            y,
            mark.shape,
            markersize=mark.size,
            markerfacecolor=mark.fill,
            markeredgecolor=mark.edge,
            markeredgewidth=0.9,
            alpha=alpha,
            zorder=10 + mark.order + behind,
            label=mark.body if mark.body and strong else "_",
        )
    for place in grounds_of(now) if strong else ():
        x, y = one.on_page(place)
        axes.plot(
            x,
            y,
            marker=CARETUP,
            markersize=11,
            color="0.55",
            zorder=11,
            linestyle="none",
            label="_",
        )


def _label(
    axes: Axes,
    one: View,
    solutions: tuple[Solution, Solution],
    named: Mapping[str, Place],
    size: float,
    box: Box,
    scale: float,
) -> None:
    """The directions of the ground's axes, and the ``named`` places at the first instant.

    ``solutions`` are the solution, and that at fewer instants, along which nothing is to be hidden;
    ``box`` is what the picture shows [m], ``scale`` in points a metre [pt/m].
    """
    now, thin = solutions[0].during(slice(0, 1)), solutions[1]

    def spots(points: Array) -> Array:
        found: Array = scale * (one.on_page(points) - [box[0], box[2]])
        return found

    edge = (2.0, 2.0, scale * (box[1] - box[0]) - 2.0, scale * (box[3] - box[2]) - 2.0)
    triad = _triad_at(spots(cloud_of(thin)), edge)
    lines = [spots(_along(line.points)) for line in (*lines_of(now), *axes_of(now, now, size))]
    marks = spots(np.array([mark.place for mark in marks_of(now)]))[:, None] + _RING
    supports = [
        spots(place)[None] - [[-4.0, 6.0], [0.0, 6.0], [4.0, 6.0]] for place in grounds_of(now)
    ]
    things = np.concatenate(
        [
            *lines,
            marks.reshape(-1, 2),
            *supports,
            triad + _ARROW * np.array([[-1, -1], [0, 0], [1, 1]]),
        ]
    )
    _draw_triad(axes, one, triad, box, scale)
    _name(
        axes,
        {name: spots(spot_at(now, spot)[0]) for name, spot in named.items()},
        things,
        edge,
        box,
        scale,
    )


def _triad_at(cloud: Array, edge: Sequence[float]) -> Array:
    """Place of the ground's axes: the corner of a picture with least around it [pt]."""
    inside = 1.5 * _ARROW
    corners = [
        (x, y)
        for y in (edge[1] + inside, edge[3] - inside)
        for x in (edge[0] + inside, edge[2] - inside)
    ]
    return np.array(
        min(
            corners,
            key=lambda corner: np.sum(np.max(np.abs(cloud - corner), axis=1) < 1.7 * _ARROW),
        )
    )


def _draw_triad(axes: Axes, one: View, spot: Array, box: Box, scale: float) -> None:
    at = np.array([box[0], box[2]]) + spot / scale
    for name, axis in zip("xyz", np.eye(3), strict=True):
        end = at + _ARROW / scale * one.on_page(axis)
        axes.annotate(
            "",
            tuple(end),
            tuple(at),
            arrowprops={
                "arrowstyle": "->",
                "color": "0.3",
                "linewidth": 1.0,
                "shrinkA": 0,
                "shrinkB": 0,
            },
        )
        x, y = at + 1.28 * (end - at)
        axes.text(x, y, name, fontsize=8, color="0.3", ha="center", va="center")


def _name(
    axes: Axes,
    spots: Mapping[str, Array],
    things: Array,
    edge: Sequence[float],
    box: Box,
    scale: float,
) -> None:
    """Write names beside their spots [pt], those at one spot together, with a line to it where it
    may be taken for another's.
    """
    from matplotlib.patheffects import withStroke
    from matplotlib.textpath import TextPath

    at: list[Array] = []
    words: list[str] = []
    for name, spot in spots.items():
        near = [k for k, other in enumerate(at) if np.hypot(*(other - spot)) < 2.0]
        if near:
            words[near[0]] += f", {name}"
        else:
            at.append(spot)
            words.append(name)
    texts = ["\n".join(textwrap.wrap(word, 34)) for word in words]
    extents = [
        [TextPath((0, 0), line, size=_POINTS).get_extents() for line in text.split("\n")]
        for text in texts
    ]
    sizes = np.array(
        [(max(e.width for e in lines) + 1.0, 1.25 * _POINTS * len(lines)) for lines in extents]
    )
    anchors, corner = np.array(at), np.array([box[0], box[2]])
    for text, spot, low, size in zip(
        texts, anchors, placed(anchors, sizes, things, edge), sizes, strict=True
    ):
        x, y = corner + low / scale
        axes.text(
            x,
            y + 0.22 * _POINTS / scale,
            text,
            fontsize=_POINTS,
            color="0.15",
            zorder=30,
            va="bottom",
            path_effects=[withStroke(linewidth=2.0, foreground="white")],
        )
        distance = apart(low, size, spot)
        if distance > 9.0 or sum(apart(low, size, other) < 2.0 * distance for other in anchors) > 1:
            line = corner + np.array([np.clip(spot, low, low + size), spot]) / scale
            axes.plot(*line.T, color="0.5", linewidth=0.5, zorder=12, label="_")


def _along(points: Array) -> Array:
    """Points along a polyline of two, as things that a name may hide."""
    found: Array = points[0] + np.linspace(0.0, 1.0, 40)[:, None] * (points[-1] - points[0])
    return found


def _entries(solution: Solution) -> list[tuple[str, Line2D]]:
    """The legend: bodies by their colours, kinds of joints by their marks, and declared points."""
    from matplotlib.lines import Line2D

    description = solution.description
    blocks = {mark.body for mark in marks_of(solution) if mark.size == BLOCK}
    found: list[tuple[str, Any]] = []
    for name in description.bodies:
        block = name in blocks
        found.append(
            (
                name,
                Line2D(
                    [],
                    [],
                    color=colour_of(solution, name),
                    linewidth=0 if block else 3,
                    marker="s" if block else "",
                ),
            )
        )
    for kind in dict.fromkeys(joint.kind for joint in description.joints.values()):
        shape, fill, size = MARKS[kind]
        mark = Line2D(
            [],
            [],
            linestyle="none",
            marker=shape,
            markerfacecolor=fill,
            markeredgecolor="black",
            markersize=size,
        )
        found.append((f"{kind} joint", mark))
    if description.springs:
        found.append(("spring", Line2D([], [], color=SPRING, linewidth=1.3, linestyle=":")))
    if description.paths:
        found.append(
            (
                "declared point",
                Line2D([], [], color=PATH, marker="D", markersize=4.5, linewidth=1.4),
            )
        )
    return found
