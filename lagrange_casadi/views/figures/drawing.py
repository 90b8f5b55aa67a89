"""The mechanism itself, drawn from a solution's poses and its description."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from ...base.arrays import Array
from ...model.description import JointNumbers, Place
from ...results.solution import Solution
from ..shapes.places import drawn_spots, placed
from ..shapes.readable import scale_for
from ..shapes.shapes import (
    Shape,
    named_spots,
    shapes,
)
from ..shapes.solid import COLOURS, PATH
from .labels import apart, label_bodies
from .labels import placed as labelled
from .stills import stills

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_POINTS = 8.0
"""The size of names [pt]."""

_TALL, _LARGE, _PAGE = 4.4, 6.4, 9.0
"""Largest sizes of one of several drawings, of one alone, and of all together [inch]."""

_SQUARE = 5.5 * np.array([(x, y) for x in (-1.0, 0.0, 1.0) for y in (-1.0, 0.0, 1.0)])
"""Points of a point mass's mark, against its middle [pt]."""

_FAINT = 0.2
_AXIS = 0.06
"""Extension of a sliding line beyond its used range, relative to the mechanism's size."""

Box = tuple[float, float, float, float]


def draw_mechanism(
    solution: Solution, count: int, overlay: bool = False, si: bool = False
) -> Figure:
    """The mechanism at ``count`` instants, with the ways of its declared points over the whole
    time.

    One beside the other, or with ``overlay`` all in one picture: the first strong, the others
    faint. Postures that are the same are drawn once.
    """
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    box, size = _extent(solution)
    chosen = stills(solution, count)
    titles = [_when(solution, i) for i in chosen]
    wide, high = box[1] - box[0], box[3] - box[2]
    if overlay:
        first, last = titles[0], titles[-1]
        words = (
            f"{len(chosen)} positions from {first.replace(chr(10), ', ')} (strong)\nto"
            f" {last.replace(chr(10), ', ')}"
        )
        titles = [words if len(chosen) > 1 else first]
    columns = 1 if overlay else min(len(chosen), 2 if wide > 0.7 * high else 4)
    rows = 1 if overlay else -(-len(chosen) // columns)
    capacity = _LARGE if rows * columns == 1 else _TALL
    scale = min(capacity / wide, capacity / high, (_PAGE - 0.6 * rows) / (rows * high))
    broad = max(
        scale * wide + 0.25,
        0.1 + max(_extent_of(line, 10.0) for title in titles for line in title.split("\n")) / 72.0,
    )
    lines = 1 + max(title.count("\n") for title in titles)
    names = [shape.name for shape in shapes(solution.description)]
    page = columns * broad + 0.75
    across = max(
        1, min(len(names), int(page / (0.55 + max(_extent_of(name, 9.0) for name in names) / 72.0)))
    )
    legend = 0.2 + 0.2 * -(-len(names) // across)
    tall = rows * (scale * high + 0.15 + 0.17 * lines) + 0.6 + legend
    figure = Figure(figsize=(page, tall), layout=ConstrainedLayoutEngine(h_pad=0.09))
    axes = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    for k, place in enumerate(axes.flat):
        if k >= len(titles):
            place.set_axis_off()
            continue
        for i in reversed(chosen[1:] if overlay else []):
            _draw_instant(place, solution, i, size, strong=False)
        _draw_instant(place, solution, chosen[k], size)
        _frame(place, box, si)
        place.set_title(titles[k], fontsize=10)
    for place in axes[-1]:
        place.set_xlabel(f"x [{scale_for('m', size, si).unit}]")
    for place in axes[:, 0]:
        place.set_ylabel(f"y [{scale_for('m', size, si).unit}]")
    handles = dict(zip(*reversed(axes[0, 0].get_legend_handles_labels()), strict=True))
    figure.legend(
        handles.values(),
        handles.keys(),
        loc="outside lower center",
        ncols=across,
        frameon=False,
        fontsize=9,
    )
    # Where everything is on the page is known when it is laid out.
    figure.draw_without_rendering()
    for place, i in zip(axes.flat, chosen[:1] if overlay else chosen, strict=False):
        now = solution.during(slice(i, i + 1))
        _name(place, now, named_spots(solution.description), size)
    return figure


def draw_into(axes: Axes, solution: Solution, named: Mapping[str, Place]) -> None:
    """The mechanism at its first instant, into axes of a figure, with the names of some places."""
    box, size = _extent(solution)
    _draw_instant(axes, solution, 0, size)
    _frame(axes, box, False)
    axes.set(xlabel=f"x [{scale_for('m', size).unit}]", ylabel=f"y [{scale_for('m', size).unit}]")
    label_bodies(axes.figure, *axes.get_legend_handles_labels())
    figure: Any = axes.figure
    if figure.get_layout_engine():
        figure.draw_without_rendering()
    else:
        axes.apply_aspect()
    _name(axes, solution.during(slice(0, 1)), named, size)


def _when(solution: Solution, i: int) -> str:
    """An instant in words, the drive's coordinate in a line of its own."""
    over = f"\n{solution.over.shown(solution.over.values[i])}" if solution.over else ""
    return f"t = {solution.t[i]:.4g} s{over}"


def _extent_of(words: str, points: float) -> float:
    """Width of words [pt]."""
    from matplotlib.textpath import TextPath

    return float(TextPath((0, 0), words, size=points).get_extents().width)


def _extent(solution: Solution) -> tuple[Box, float]:
    """The box that holds all at every instant, and its larger side [m]."""
    description = solution.description
    places = [placed(solution, spot) for spot in drawn_spots(description)]
    for shape in shapes(description):
        if shape.disc and shape.centre:
            middle = placed(solution, Place(shape.name, shape.centre))
            places += [middle - shape.disc, middle + shape.disc]
    x, y, _ = np.concatenate(places).T
    size = max(float(np.ptp(x)), float(np.ptp(y))) or 1.0
    return (
        x.min() - 0.12 * size,
        x.max() + 0.12 * size,
        y.min() - 0.12 * size,
        y.max() + 0.12 * size,
    ), size


def _frame(axes: Axes, box: Box, si: bool) -> None:
    scale = scale_for("m", max(box[1] - box[0], box[3] - box[2]) / 1.24, si)
    axes.set(xlim=box[:2], ylim=box[2:], aspect="equal")
    axes.grid(True, color="0.93")
    axes.set_axisbelow(True)
    scale.put(axes.xaxis)
    scale.put(axes.yaxis)


def _draw_instant(
    axes: Axes, solution: Solution, i: int, size: float, *, strong: bool = True
) -> None:
    """An instant; where it is not the ``strong`` one without the ground, and so that one sees
    through it.
    """
    now = solution.during(slice(i, i + 1))
    description = solution.description
    style: dict[str, Any] = {"alpha": 1.0 if strong else _FAINT, "zorder": 3 if strong else 2}

    def at(spot: Place) -> Array:
        place: Array = placed(now, spot)[0, :2]
        return place

    for number, shape in enumerate(shapes(description)):
        _draw_body(
            axes,
            shape,
            at,
            COLOURS[number % len(COLOURS)],
            style,
            label=shape.name if strong else "_",
        )
    for ends in description.springs.values():
        x, y = np.transpose([at(end) for end in ends])
        axes.plot(
            x, y, **style | {"color": "0.4", "linewidth": 1.4, "linestyle": ":", "label": "_"}
        )
    for joint in description.joints.values():
        x, y = at(joint.child)
        slides = joint.kind in ("prismatic", "slot")
        if strong and slides:
            _draw_axis(axes, solution, now, joint, size)
        if joint.kind != "prismatic":
            mark, width, fill = ("s", 4, "black") if joint.kind == "weld" else ("o", 7, "white")
            box = {
                "markersize": width,
                "markerfacecolor": fill,
                "markeredgecolor": "black",
                "zorder": style["zorder"] + 1,
            }
            axes.plot(x, y, mark, **style | box)
        if strong and not slides and "ground" in (joint.parent.body, joint.child.body):
            axes.plot(x, y - 0.035 * size, "^", markersize=12, color="0.55", zorder=2)
    for spot in description.paths.values():
        if strong:
            axes.plot(*placed(solution, spot)[:, :2].T, color=PATH, linewidth=1.4, zorder=2)
        axes.plot(
            *at(spot), "D", markersize=5, color=PATH, **style | {"zorder": style["zorder"] + 2}
        )


def _draw_body(
    axes: Axes,
    shape: Shape,
    at: Callable[[Place], Array],
    colour: str,
    style: dict[str, Any],
    label: str,
) -> None:
    """A link's axis, plates, and arms to what is beside it; of a rotor its disc, with a spoke by
    which one sees it turn.
    """

    def line(ends: Sequence[tuple[float, float, float]], width: float, label: str) -> None:
        x, y = np.transpose([at(Place(shape.name, end)) for end in ends])
        axes.plot(x, y, color=colour, linewidth=width, solid_capstyle="round", label=label, **style)

    if shape.kind == "point":
        axes.plot(
            *at(Place(shape.name, (0.0, 0.0, 0.0))),
            "s",
            color=colour,
            markersize=11,
            label=label,
            **style,
        )
        return
    for ends in (
        (shape.axis, 4.0),
        *((arm, 3.0 if shape.kind == "rigid" else 1.6) for arm in shape.arms),
    ):
        if ends[0]:
            line(ends[0], ends[1] if not shape.plates else 3.2, label)
            label = "_"
    for points in (*shape.plates, *([tuple(_circle(shape))] if shape.disc else ())):
        corners = np.array([at(Place(shape.name, point)) for point in points])
        face: dict[str, Any] = {
            "facecolor": colour,
            "linewidth": 0.0,
            **style,
            "alpha": 0.25 * style["alpha"],
        }
        axes.fill(*corners.T, **face)
        axes.plot(
            *np.vstack([corners, corners[:1]]).T,
            color=colour,
            linewidth=1.2,
            solid_joinstyle="round",
            label=label,
            **style,
        )
        label = "_"
    if shape.spoke and shape.centre:
        line((shape.centre, shape.spoke), 2.0, "_")


def _circle(shape: Shape) -> Iterator[tuple[float, float, float]]:
    assert shape.centre is not None
    x, y, z = shape.centre
    for angle in np.linspace(0.0, 2.0 * np.pi, 61)[:-1].tolist():
        yield x + shape.disc * float(np.cos(angle)), y + shape.disc * float(np.sin(angle)), z


def _draw_axis(
    axes: Axes, solution: Solution, now: Solution, joint: JointNumbers, size: float
) -> None:
    """The line on which something slides, as far as it ever does."""
    parent = placed(now, joint.parent)[0, :2]
    (x, y, z), (dx, dy, _) = joint.parent.at, joint.triad[0]
    ahead = Place(joint.parent.body, (x + dx, y + dy, z))
    direction = placed(now, ahead)[0, :2] - parent
    along = placed(solution, joint.child) - placed(solution, joint.parent)
    directions = placed(solution, ahead) - placed(solution, joint.parent)
    reach = np.concatenate(
        [np.sum(along * directions, axis=1), [0.0] if joint.kind == "slot" else []]
    )
    ends = (
        parent
        + np.array([reach.min() - _AXIS * size, reach.max() + _AXIS * size])[:, None] * direction
    )
    axes.plot(*ends.T, color="0.55", linewidth=1.0, linestyle=(0, (6, 4)), zorder=1, label="_")


def _name(axes: Axes, now: Solution, spots: Mapping[str, Place], size: float) -> None:
    """Write the names beside their points, where they hide neither each other nor more of the
    bodies than they must.
    """
    from matplotlib.patheffects import withStroke

    points = 72.0 / axes.figure.dpi
    if not spots:
        return
    named = _labels(now, spots, size)
    words = [", ".join(names) for names in named.values()]
    sizes = np.array([(_extent_of(word, _POINTS) + 1.0, 1.2 * _POINTS) for word in words])
    anchors = axes.transData.transform(np.array(list(named))) * points
    things = (
        axes.transData.transform(np.concatenate([*_lines(now), np.array(list(named))])) * points
    )
    blocks = [
        placed(now, Place(shape.name, (0.0, 0.0, 0.0)))[:, :2]
        for shape in shapes(now.description)
        if shape.kind == "point"
    ]
    things = np.concatenate(
        [things, *(axes.transData.transform(block) * points + _SQUARE for block in blocks)]
    )
    (left, bottom), (right, top) = axes.transAxes.transform([(0.0, 0.0), (1.0, 1.0)]) * points
    corners = labelled(anchors, sizes, things, (left, bottom, right, top))
    for word, spot, anchor, low, wide in zip(words, named, anchors, corners, sizes, strict=True):
        box = apart(low, wide, anchor)
        far = box > 10.0 or sum(apart(low, wide, other) < 2.0 * box for other in anchors) > 1
        line: dict[str, Any] = (
            {
                "arrowprops": {
                    "arrowstyle": "-",
                    "color": "0.5",
                    "linewidth": 0.5,
                    "shrinkA": 0.0,
                    "shrinkB": 0.0,
                }
            }
            if far
            else {}
        )
        words_at: dict[str, Any] = {
            "xytext": low - anchor,
            "textcoords": "offset points",
            "fontsize": _POINTS,
            "color": "0.2",
            "zorder": 6,
        }
        name = axes.annotate(word, spot, **words_at, **line)
        name.set_path_effects([withStroke(linewidth=2.0, foreground="white")])
        name.set_in_layout(False)


def _lines(now: Solution) -> Iterator[Array]:
    """Points (n, 2) along everything that a name might hide [m]."""
    share = np.linspace(0.0, 1.0, 40)[:, None]
    for shape in shapes(now.description):
        edges = [(plate[k - 1], plate[k]) for plate in shape.plates for k in range(len(plate))]
        rim = list(_circle(shape)) if shape.disc else []
        for start, stop in (
            *([shape.axis] if shape.axis else []),
            *shape.arms,
            *edges,
            *pairwise(rim),
        ):
            a, b = (placed(now, Place(shape.name, end))[0, :2] for end in (start, stop))
            yield a + share * (b - a)


def _labels(
    now: Solution, spots: Mapping[str, Place], size: float
) -> dict[tuple[float, float], list[str]]:
    """The names by place, those at one place together."""
    found: dict[tuple[float, float], list[str]] = {}
    for name, spot in spots.items():
        x, y = placed(now, spot)[0, :2].tolist()
        near = next(
            (at for at in found if max(abs(at[0] - x), abs(at[1] - y)) < 1e-3 * size), (x, y)
        )
        found.setdefault(near, []).append(name)
    return found
