"""The mechanism itself, painted by matplotlib: a plane at several instants, space from four sides,
or into axes of a figure that shows other things too.
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...base.arrays import Array, every
from ...results.solution import Solution
from ...results.store.specs import MechanismDrawing
from ..shapes.labels import apart, label_bodies, placed
from ..shapes.marks import ground_axes
from ..shapes.orthographic import View, page, views
from ..shapes.picture_sheet import filling, together, view_of
from ..shapes.poses import Poses
from ..shapes.primitives import (
    GROUND,
    Line,
    Name,
    Primitive,
    Symbol,
    cloud,
    colours_of,
    drawing,
    edge,
    seen,
    size_of,
    spread,
    turn,
)
from ..shapes.readable import Scale, instant, scale_for
from ..shapes.symbols import SYMBOLS
from .stills import stills

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.transforms import Transform

_UNIT = 0.55
"""Points of a figure for a point of symbols and lines."""

_POINTS, _LETTER = 8.0, 0.075
"""The size of names [pt], and the width of a letter of titles and legends [inch]."""

_FAINT, _MARGIN = 0.2, 0.12
"""The opacity of other instants, and the room around everything over the mechanism's size."""

_THINNED = 2000
"""Largest number of instants at which everything must have room."""

_ROW = 0.21
"""The height of a row of the legend [inch]."""


class _Panel(NamedTuple):
    """A picture of a figure: the direction from which it shows the mechanism, instants of which the
    first is strong, the title, and whether names are written.
    """

    view: View
    instants: Sequence[int]
    title: str
    named: bool = True


def draw_mechanism(solution: Solution, spec: MechanismDrawing, si: bool = False) -> Figure:
    """The mechanism at some instants, with the ways of its declared points over the whole time.

    In the plane one picture beside the other, or if the spec asks for an overlay all in one: the
    first strong, the others faint. In space an overlay from above, from the front, from the right,
    and from the direction of the spec, which names the joints.
    """
    from matplotlib.figure import Figure

    chosen = stills(solution, spec.count)
    thin = Poses.of(solution.during(every(solution.t.size, _THINNED)))
    everything, poses = drawing(thin), Poses.of(solution)
    size = size_of(everything)
    panels = [*_panels(solution, spec, chosen)]
    space = solution.description.space
    words = f"{solution.case}: {_instants(solution, chosen)}; orthographic, all views to one scale"
    ends = [_ends(everything, panel.view, size) for panel in panels]
    wide, high = ends[0][1] - ends[0][0]
    entries = _entries(solution)
    widest = max(0.62 + _LETTER * len(name) for name, _ in entries)
    titles = [panel.title.split("\n") for panel in panels]
    laid_out = partial(
        page,
        ends,
        min(len(panels), 2 if space or wide > 0.7 * high else 4),
        title=0.15 + 0.17 * max(map(len, titles)),
        least=_LETTER * max(len(line) for title in titles for line in title),
    )
    across = laid_out(head=0.0, foot=0.0).size[0]
    head = textwrap.wrap(words, int(across / (1.15 * _LETTER))) if space else []
    columns = max(1, min(len(entries), int(across / widest)))
    foot = 0.1 + _ROW * -(-len(entries) // columns)
    sheet = laid_out(head=0.1 + _ROW * len(head), foot=foot)
    figure = Figure(figsize=sheet.size)
    for panel, place, box in zip(panels, sheet.places, sheet.boxes, strict=True):
        axes, view = figure.add_axes(tuple(np.array(place) / (sheet.size * 2))), panel.view
        _frame(axes, view, box, place[2:], scale_for("m", size, si))
        axes.set_title(panel.title, fontsize=10)
        first, *others = (seen(drawing(poses.during([k]), thin), view) for k in panel.instants)
        for other in reversed(others):
            paint(axes, other, strong=False)
        if panel.named and space:
            first += seen(ground_axes(view, cloud(seen(everything, view)), size), view)
        paint(axes, first)
        if panel.named:
            _name(axes, first)
    names, handles = zip(*entries, strict=True)
    figure.legend(
        handles,
        names,
        loc="lower center",
        ncols=columns,
        frameon=False,
        fontsize=9,
        labelspacing=0.35,
        handler_map={Symbol: _handler()},
    )
    figure.suptitle("\n".join(head), fontsize=11, y=1.0 - 0.1 / sheet.size[1], va="top")
    return figure


def draw_into(axes: Axes, solution: Solution) -> None:
    """The mechanism at its first instant, into axes of a figure; in space as it is seen from one
    side.
    """
    description = solution.description
    whole, one = Poses.of(solution), view_of(description)
    everything, things = drawing(whole), seen(drawing(whole.during([0]), whole), one)
    size = size_of(everything)
    if description.space:
        things += seen(ground_axes(one, cloud(seen(everything, one)), size), one)
    low, high = _ends(everything, one, size)
    _frame(axes, one, (low[0], high[0], low[1], high[1]), (4.6, 3.4), scale_for("m", size))
    axes.set_aspect("equal")
    if description.space:
        axes.set_xlabel(one.title, fontsize=8)
    paint(axes, things)
    bodies = [entry for entry in _entries(solution) if entry[0] in description.bodies]
    label_bodies(axes.figure, [handle for _, handle in bodies], [name for name, _ in bodies])
    figure: Any = axes.figure
    # Where everything is on the page is known when it is laid out.
    if figure.get_layout_engine():
        figure.draw_without_rendering()
    else:
        axes.apply_aspect()
    _name(axes, things)


def paint(axes: Axes, things: Sequence[Line | Symbol | Name], strong: bool = True) -> None:
    """Paint the lines and symbols of an instant; of one that is not the ``strong`` one faint,
    without guides and the ground.
    """
    alpha = 1.0 if strong else _FAINT
    for order, thing in enumerate(things):
        if isinstance(thing, Name) or (thing.level <= GROUND and not strong):
            continue
        style: dict[str, Any] = {"alpha": alpha, "zorder": 2.0 + strong + 1e-4 * order}
        points = thing.points[0]
        if isinstance(thing, Symbol):
            for patch in _patches(thing, _stands_at(axes, thing)):
                patch.set(**style)
                axes.add_artist(patch)
            continue
        if thing.opacity:
            face = {**style, "alpha": thing.opacity * alpha}
            axes.fill(*points.T, facecolor=thing.colour, linewidth=0.0, **face)
        axes.plot(
            *edge(points, thing.closed).T,
            color=thing.colour,
            linewidth=_UNIT * thing.width,
            linestyle=(0, (6, 4)) if thing.dashed else "-",
            solid_capstyle="round",
            solid_joinstyle="round",
            label=thing.body if thing.body and strong else "_",
            **style,
        )


def _panels(solution: Solution, spec: MechanismDrawing, chosen: Sequence[int]) -> Iterator[_Panel]:
    """The pictures of a figure."""
    description = solution.description
    if description.space:
        for k, one in enumerate(views(description.gravity, spec.azimuth, spec.elevation)):
            yield _Panel(one, chosen, one.title, k == 1)
        return
    for instants in [chosen] if spec.overlay else [[k] for k in chosen]:
        title = "\n".join(textwrap.wrap(_instants(solution, instants), 46))
        yield _Panel(view_of(description), instants, title)


def _stands_at(axes: Axes, symbol: Symbol) -> Transform:
    """The transformation of points about a symbol's place to the display."""
    from matplotlib.transforms import Affine2D, ScaledTranslation

    display: Any = axes.transData
    x, y = symbol.points[0, 0]
    turned = Affine2D().rotate(turn(symbol, 0)).scale(_UNIT / 72.0)
    return turned + axes.figure.dpi_scale_trans + ScaledTranslation(x, y, display)


def _patches(symbol: Symbol, transform: Transform) -> Iterator[Artist]:
    """The outlines of a symbol."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    for one in SYMBOLS[symbol.kind]:
        yield PathPatch(
            Path(edge(one.points, one.closed), closed=one.closed),
            facecolor=filling(symbol, one) or "none",
            edgecolor=one.colour,
            linewidth=_UNIT * one.width,
            transform=transform,
        )


def _handler() -> Any:
    """The painter of symbols in a legend."""
    from matplotlib.legend_handler import HandlerBase
    from matplotlib.transforms import Affine2D

    class Handler(HandlerBase):
        def create_artists(self, *given: Any) -> list[Artist]:
            _, symbol, x, y, wide, high, size, transform = given
            middle = Affine2D().scale(0.08 * _UNIT * size).translate(wide / 2 - x, high / 2 - y)
            return [*_patches(symbol, middle + transform)]

    return Handler()


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
    from matplotlib.ticker import FuncFormatter, MaxNLocator

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
        if name.startswith("-"):
            axis.set_major_formatter(FuncFormatter(lambda value, _: scale.label(0.0 - value)))
        else:
            scale.put(axis)
    axes.tick_params(labelsize=8)


def _entries(solution: Solution) -> list[tuple[str, Any]]:
    """The legend: bodies by their colours, in space kinds of joints by their symbols, and declared
    points.
    """
    from matplotlib.lines import Line2D

    description = solution.description
    found: list[tuple[str, Any]] = [
        (body, Line2D([], [], color=colour, linewidth=3))
        for body, colour in colours_of(description.bodies).items()
    ]
    if description.space:
        nowhere = np.zeros((1, 1, 2))
        kinds = dict.fromkeys(joint.kind for joint in description.joints.values())
        found += [(f"{kind} joint", Symbol(kind, nowhere, colour="#ffffff")) for kind in kinds]
        if description.paths:
            found.append(("declared point", Symbol("point", nowhere)))
    return found


def _name(axes: Axes, things: Sequence[Line | Symbol | Name]) -> None:
    """Write names beside their places, where they hide neither each other nor more of the picture
    than they must, with a line to the place if the name may be taken for another's.
    """
    from matplotlib.patheffects import withStroke
    from matplotlib.textpath import TextPath

    points, display = 72.0 / axes.figure.dpi, axes.transData
    near = (
        2.0
        / points
        / float(np.hypot(*(display.transform((1.0, 0.0)) - display.transform((0.0, 0.0)))))
    )
    names = together((one for one in things if isinstance(one, Name)), near)
    if not names:
        return
    texts = ["\n".join(textwrap.wrap(one.text, 34)) for one in names]
    lines = [[TextPath((0, 0), line, size=_POINTS) for line in text.split("\n")] for text in texts]
    sizes = np.array(
        [
            (max(e.get_extents().width for e in rows) + 1.0, 1.25 * _POINTS * len(rows))
            for rows in lines
        ]
    )
    anchors = points * display.transform(np.array([one.points[0, 0] for one in names]))
    hidden = [np.zeros((0, 2))]
    for thing in things:
        if isinstance(thing, Line) and thing.level > GROUND:
            hidden.append(points * display.transform(spread(thing.points[0], thing.closed)))
        elif isinstance(thing, Symbol):
            about = _stands_at(axes, thing)
            lines_of = (spread(one.points, one.closed) for one in SYMBOLS[thing.kind])
            hidden += [points * about.transform(line) for line in lines_of]
    border = points * axes.bbox.get_points().ravel() + [2.0, 2.0, -2.0, -2.0]
    corners = placed(anchors, sizes, np.concatenate(hidden), [border] * len(names))
    for text, anchor, low, size in zip(texts, anchors, corners, sizes, strict=True):
        distance = apart(low, size, anchor)
        far = (
            distance > 10.0
            or sum(apart(low, size, other) < 2.0 * distance for other in anchors) > 1
        )
        line = {"arrowstyle": "-", "color": "0.5", "linewidth": 0.5, "shrinkA": 0, "shrinkB": 0}
        name = axes.annotate(
            text,
            tuple(display.inverted().transform(anchor / points)),
            tuple(low - anchor),
            textcoords="offset points",
            fontsize=_POINTS,
            color="0.2",
            zorder=6,
            arrowprops=line if far else None,
            path_effects=[withStroke(linewidth=2.0, foreground="white")],
        )
        name.set_in_layout(False)
