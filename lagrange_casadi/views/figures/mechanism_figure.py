"""The mechanism itself, painted by matplotlib: a plane at several instants, space from four sides,
or into axes of a figure that shows other things too.
"""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ...base.arrays import Array, every
from ...results.solution import Solution
from ...results.store.specs import MechanismDrawing
from ..shapes.marks import ground_axes
from ..shapes.orthographic import View, page, views
from ..shapes.picture_sheet import LETTER, view_of, written
from ..shapes.poses import Poses
from ..shapes.primitives import cloud, drawing, seen, size_of
from ..shapes.readable import Scale, instant, scale_for
from ..shapes.symbols import GROUND, Line, Name, Primitive, Symbol, outlines
from .stills import THINNED, stills

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_UNIT = 0.55
"""Points of a figure for a point of symbols and lines."""

_POINTS, _LETTER = 8.0, 0.075
"""The size of names [pt], and the width of a letter of titles and legends [inch]."""

_FAINT, _MARGIN = 0.2, 0.12
"""The opacity of other instants, and the room around everything over the mechanism's size."""

_ROW, _IN_ROW = 0.21, 6
"""The height of a row of the legend [inch], and bodies in a row beside other pictures."""


def draw_mechanism(solution: Solution, spec: MechanismDrawing, si: bool = False) -> Figure:
    """The mechanism at some instants, with the ways of its declared points over the whole time.

    In the plane one picture beside the other, or if the spec asks for an overlay all in one: the
    first strong, the others faint. In space an overlay from above, from the front, from the right,
    and from the direction of the spec, which names the joints.
    """
    from matplotlib.figure import Figure

    chosen = stills(solution, spec.count)
    thin = Poses.of(solution.during(every(solution.t.size, THINNED)))
    everything, poses = drawing(thin), Poses.of(solution)
    size = size_of(everything)
    panels = _panels(solution, spec, chosen)
    space = solution.description.space
    words = f"{solution.case}: {_instants(solution, chosen)}; orthographic, all views to one scale"
    ends = [_ends(everything, view, size) for view, _ in panels]
    wide, high = ends[0][1] - ends[0][0]
    entries = _entries(poses)
    widest = max(0.62 + _LETTER * len(name) for name, _ in entries)
    titles = [view.title.split("\n") for view, _ in panels]
    across, tall, places, boxes = page(
        ends,
        min(len(panels), 2 if space or wide > 0.7 * high else 4),
        title=0.15 + 0.17 * max(map(len, titles)),
        least=_LETTER * max(len(line) for title in titles for line in title),
    )
    head = textwrap.wrap(words, int(across / (1.15 * _LETTER))) if space else []
    columns = max(1, min(len(entries), int(across / widest)))
    foot = 0.1 + _ROW * -(-len(entries) // columns)
    tall += 0.1 + _ROW * len(head) + foot
    figure = Figure(figsize=(across, tall))
    for (view, instants), place, box in zip(panels, places, boxes, strict=True):
        shares = np.add(place, (0.0, foot, 0.0, 0.0)) / [across, tall, across, tall]
        axes = figure.add_axes(tuple(shares))
        _frame(axes, view, box, place[2:], scale_for("m", size, si))
        axes.set_title(view.title)
        point = (box[1] - box[0]) / (72.0 * place[2])
        for k in reversed(instants[1:]):
            _painted(axes, seen(drawing(poses.during([k]), thin, {}), view), point, strong=False)
        named = not space or view is panels[1][0]
        _show(axes, view, poses.during([instants[0]]), thin, box, point, named)
    names, handles = zip(*entries, strict=True)
    figure.legend(
        handles,
        names,
        loc="lower center",
        ncols=columns,
        labelspacing=0.35,
        handler_map={Symbol: _Legend()},
    )
    figure.suptitle("\n".join(head), y=1.0 - 0.1 / tall, va="top")
    return figure


def draw_into(axes: Axes, solution: Solution) -> None:
    """The mechanism at its first instant, into axes of a figure; in space as it is seen from one
    side.
    """
    description = solution.description
    whole, one = Poses.of(solution), view_of(description)
    everything = drawing(whole)
    size = size_of(everything)
    box = np.column_stack(_ends(everything, one, size)).ravel().tolist()
    _frame(axes, one, box, (4.6, 3.4), scale_for("m", size))
    axes.set_aspect("equal")
    if description.space:
        axes.set_xlabel(one.title, fontsize=8)
    figure: Any = axes.figure
    if not figure.legends:
        bodies = (entry for entry in _entries(whole) if entry[0] in description.bodies)
        names, handles = zip(*bodies, strict=True)
        figure.legend(handles, names, loc="outside lower center", ncols=_IN_ROW, fontsize=8)
    # How large a point is on the page is known when that is laid out.
    figure.draw_without_rendering()
    point = (box[1] - box[0]) / (72.0 * axes.bbox.width / figure.dpi)
    _show(axes, one, whole.during([0]), whole, box, point)


def _show(
    axes: Axes,
    view: View,
    now: Poses,
    whole: Poses,
    box: Sequence[float],
    point: float,
    named: bool = True,
) -> None:
    """Paint an instant with its names, in space with the ground's axes, into a ``box`` of left,
    right, bottom and top [m], where a point of paper is so many metres.
    """
    things = seen(drawing(now, whole, None if named else {}), view)
    if named and now.description.space:
        everything = drawing(whole)
        things += seen(ground_axes(view, cloud(seen(everything, view)), size_of(everything)), view)
    letters = np.full(2, _POINTS / LETTER * point)
    _painted(axes, written(things, letters, np.reshape(box, (2, 2)).T), point)


def _painted(
    axes: Axes, things: Sequence[Line | Symbol | Name], point: float, strong: bool = True
) -> None:
    """Paint the lines and symbols of an instant, and the names beside them, where a point of paper
    is so many metres; of an instant that is not the ``strong`` one faint, without guides, the
    ground and names.
    """
    from matplotlib.patheffects import withStroke

    for order, thing in enumerate(things):
        if isinstance(thing, Name):
            x, y = thing.points[0, 0]
            axes.text(
                x,
                y,
                thing.text,
                fontsize=_POINTS,
                color="0.2",
                zorder=6,
                path_effects=[withStroke(linewidth=2.0, foreground="white")],
                in_layout=False,
            )
            continue
        if thing.level <= GROUND and not strong:
            continue
        for line, points in outlines(thing, np.full(2, _UNIT * point)):
            artist = _artist(line, points, 1.0 if strong else _FAINT)
            artist.set(
                zorder=2.0 + strong + 1e-4 * order,
                label=line.body if line.body and strong else "_",
            )
            axes.add_artist(artist)


def _artist(line: Line, points: Array, alpha: float = 1.0) -> Artist:
    """A line through points (n, 2) for matplotlib."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Polygon

    style: dict[str, Any] = {
        "linewidth": _UNIT * line.width,
        "linestyle": (0, (6, 4)) if line.dashed else "-",
    }
    if not line.closed:
        found = Line2D(*points.T, color=line.colour, alpha=alpha, **style)
        found.set(solid_capstyle="round", solid_joinstyle="round")
        return found
    face, rim = (line.fill or line.colour, alpha * line.opacity), (line.colour, alpha)
    return Polygon(points, facecolor=face, edgecolor=rim, joinstyle="round", **style)


def _panels(
    solution: Solution, spec: MechanismDrawing, chosen: Sequence[int]
) -> list[tuple[View, Sequence[int]]]:
    """The pictures of a figure: the direction from which each shows the mechanism, with its title,
    and instants of which the first is strong.
    """
    description = solution.description
    if description.space:
        seen_from = views(description.gravity, spec.azimuth, spec.elevation)
        return [(one, chosen) for one in seen_from]
    each = [chosen] if spec.overlay else [[k] for k in chosen]
    titles = ("\n".join(textwrap.wrap(_instants(solution, some), 46)) for some in each)
    plane = view_of(description)
    return [(replace(plane, title=title), some) for title, some in zip(titles, each, strict=True)]


class _Legend:
    """The painter of symbols in a legend."""

    def legend_artist(self, _: object, symbol: Symbol, size: float, box: Any) -> None:
        """Paint a symbol for letters of a ``size`` [pt]."""
        middle = [box.width / 2 - box.xdescent, box.height / 2 - box.ydescent]
        here = replace(symbol, points=np.array([[middle]]))
        for line, points in outlines(here, np.full(2, 0.08 * _UNIT * size)):
            box.add_artist(_artist(line, points))


def _ends(things: Sequence[Primitive], one: View, size: float) -> tuple[Array, Array]:
    """The lower left and upper right corners of a picture of everything [m]."""
    points = one.on_page(cloud(things))
    return points.min(axis=0) - _MARGIN * size, points.max(axis=0) + _MARGIN * size


def _instants(solution: Solution, chosen: Sequence[int]) -> str:
    """Instants in words, each with the drive's coordinate, if there is one."""
    first, *others = (instant(solution, i) for i in chosen)
    return f"{first}; faint: {'; '.join(others)}" if others else first


def _frame(
    axes: Axes, one: View, box: Sequence[float], size: Sequence[float], scale: Scale
) -> None:
    """Range of a picture, and its scales, with as many numbers as fit its ``size`` [inch]."""
    from matplotlib.ticker import MaxNLocator

    axes.set(xlim=box[:2], ylim=box[2:])
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
        Scale(-scale.factor if name.startswith("-") else scale.factor, scale.unit).put(axis)
    axes.tick_params(labelsize=8)


def _entries(poses: Poses) -> list[tuple[str, Any]]:
    """The legend: bodies by their colours, in space kinds of joints by their symbols, and declared
    points.
    """
    from matplotlib.lines import Line2D

    description = poses.description
    found: list[tuple[str, Any]] = [
        (body, Line2D([], [], color=colour, linewidth=3)) for body, colour in poses.colours.items()
    ]
    if description.space:
        nowhere = np.zeros((1, 1, 2))
        kinds = dict.fromkeys(joint.kind for joint in description.joints.values())
        found += [(f"{kind} joint", Symbol(kind, nowhere, colour="#ffffff")) for kind in kinds]
        if description.paths:
            found.append(("declared point", Symbol("point", nowhere)))
    return found
