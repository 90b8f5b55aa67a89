"""The mechanism itself, drawn from a solution's poses and its description."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..declare.density import Array
from ..instants.solution import Solution
from .labels import apart, placed
from .solid import COLOURS, PATH

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_POINTS = 8.0
"""The size of names."""


def draw_mechanism(solution: Solution, count: int) -> Figure:
    """The mechanism at ``count`` instants, with the paths that its joints and declared points take over the whole time."""
    from matplotlib.figure import Figure

    paths, box, size = _extent(solution)
    columns = min(count, 2)
    rows = -(-count // columns)
    aspect = (box[3] - box[2]) / (box[1] - box[0])
    figure = Figure(figsize=(4.4 * columns, min(9.0, rows * (4.4 * aspect + 0.5))), layout="constrained")
    axes = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    chosen = np.linspace(0, solution.t.size - 1, count + 1).astype(int)[:-1] if count > 1 else [0]
    for place, i in zip(axes.flat, chosen, strict=False):
        _draw_instant(place, solution, int(i), paths, size)
        place.set(xlim=box[:2], ylim=box[2:], aspect="equal")
        over = f", {solution.over.shown(solution.over.values[i])}" if solution.over else ""
        place.set_title(f"t = {solution.t[i]:.4g} s{over}", fontsize=10)
        place.grid(True, color="0.93")
    for place in axes.flat[len(chosen) :]:
        place.set_axis_off()
    for place in axes[-1]:
        place.set_xlabel("x [m]")
    for place in axes[:, 0]:
        place.set_ylabel("y [m]")
    names = axes[0, 0].get_legend_handles_labels()
    figure.legend(*names, loc="outside lower center", ncols=min(6, max(1, len(names[1]))), frameon=False, fontsize=9)
    # Where everything is on the page is known when it is laid out.
    figure.draw_without_rendering()
    for place, i in zip(axes.flat, chosen, strict=False):
        _name(place, solution, int(i), paths, size)
    return figure


def draw_into(axes: Any, solution: Solution) -> None:
    """The mechanism at its first instant, into axes of a figure."""
    paths, box, size = _extent(solution)
    _draw_instant(axes, solution, 0, paths, size)
    axes.set(xlim=box[:2], ylim=box[2:], aspect="equal", xlabel="x [m]", ylabel="y [m]")
    axes.grid(True, color="0.93")
    axes.legend(frameon=False, fontsize=8)
    axes.figure.draw_without_rendering()
    _name(axes, solution, 0, paths, size)


def _extent(solution: Solution) -> tuple[dict[str, tuple[Array, Array]], tuple[float, float, float, float], float]:
    """The paths of joints and of declared points by name, the box that holds all, and its larger side [m]."""
    paths = {name: _place(solution, joint["child"]) for name, joint in solution.description["joints"].items()}
    paths |= {name: _place(solution, point) for name, point in solution.description.get("paths", {}).items()}
    ends = {name: _ends(solution, name) for name, body in solution.description["bodies"].items() if body["length"]}
    springs = [load["points"] for load in solution.description["loads"].values() if load["kind"] == "spring"]
    places = [*paths.values(), *(_place(solution, point) for points in springs for point in points)]
    for name, outline in solution.description.get("outlines", {}).items():
        places += [_place(solution, {"body": name, "x": x, "y": y}) for x, y in outline]
    x = np.concatenate([p[0] for p in places] + [e[k] for e in ends.values() for k in (0, 2)])
    y = np.concatenate([p[1] for p in places] + [e[k] for e in ends.values() for k in (1, 3)])
    size = max(float(np.ptp(x)), float(np.ptp(y))) or 1.0
    box = (x.min() - 0.12 * size, x.max() + 0.12 * size, y.min() - 0.12 * size, y.max() + 0.12 * size)
    return paths, box, size


def _draw_instant(axes: Any, solution: Solution, i: int, paths: Any, size: float) -> None:
    description = solution.description
    for number, (name, body) in enumerate(description["bodies"].items()):
        colour = COLOURS[number % len(COLOURS)]
        if body["length"]:
            _draw_body(axes, solution, name, i, colour)
        elif body["length"] is None:
            pose = solution.pose(name)
            axes.plot(pose.x[i], pose.y[i], "s", color=colour, markersize=11, label=name, zorder=3)
    for load in description["loads"].values():
        if load["kind"] == "spring":
            (ax, ay), (bx, by) = (_place(solution, point) for point in load["points"])
            axes.plot([ax[i], bx[i]], [ay[i], by[i]], color="0.4", linewidth=1.4, linestyle=":", zorder=2)
    for name, joint in description["joints"].items():
        x, y = paths[name]
        axes.plot(x, y, color="0.75", linewidth=0.9, zorder=1)
        if joint["kind"] in ("prismatic", "slot"):
            _draw_axis(axes, solution, joint, i, size)
        if joint["kind"] in ("revolute", "slot"):
            grounded = "ground" in (joint["parent"]["body"], joint["child"]["body"])
            axes.plot(x[i], y[i], "o", markersize=7, markerfacecolor="white", markeredgecolor="black", zorder=4)
            if grounded:
                axes.plot(x[i], y[i] - 0.035 * size, "^", markersize=12, color="0.55", zorder=2)
    for name in description.get("paths", {}):
        x, y = paths[name]
        axes.plot(x, y, color=PATH, linewidth=1.4, zorder=2)
        axes.plot(x[i], y[i], "D", markersize=5, color=PATH, zorder=5)


def _name(axes: Any, solution: Solution, i: int, paths: Any, size: float) -> None:
    """Write the names beside their points, where they hide neither each other nor more of the bodies than they must."""
    from matplotlib.textpath import TextPath

    points = 72.0 / axes.figure.dpi
    named = _labels(paths, i, size)
    words = [", ".join(names) for names in named.values()]
    sizes = np.array([(TextPath((0, 0), word, size=_POINTS).get_extents().width + 1.0, 1.2 * _POINTS) for word in words])
    anchors = axes.transData.transform(np.array(list(named))) * points
    ends = [_ends(solution, name) for name, body in solution.description["bodies"].items() if body["length"]]
    share = np.linspace(0.0, 1.0, 40)[:, None]
    bodies = [np.array([x[i], y[i]]) + share * np.array([u[i] - x[i], v[i] - y[i]]) for x, y, u, v in ends]
    things = axes.transData.transform(np.concatenate([*bodies, np.array(list(named))])) * points
    (left, bottom), (right, top) = axes.transAxes.transform([(0.0, 0.0), (1.0, 1.0)]) * points
    corners = placed(anchors, sizes, things, (left, bottom, right, top))
    for word, spot, anchor, low, wide in zip(words, named, anchors, corners, sizes, strict=True):
        own = apart(low, wide, anchor)
        far = own > 10.0 or sum(apart(low, wide, other) < 2.0 * own for other in anchors) > 1
        line = {"arrowprops": {"arrowstyle": "-", "color": "0.5", "linewidth": 0.5, "shrinkA": 0.0, "shrinkB": 0.0}} if far else {}
        words_at = {"xytext": low - anchor, "textcoords": "offset points", "fontsize": _POINTS, "color": "0.2", "zorder": 6}
        axes.annotate(word, spot, **words_at, **line).set_in_layout(False)


def _draw_body(axes: Any, solution: Solution, name: str, i: int, colour: str) -> None:
    """A link's axis, and arms to joints and declared points beside it; a body known by its centre of mass as arms from there."""
    body = solution.description["bodies"][name]
    points = [end for joint in solution.description["joints"].values() for end in (joint["parent"], joint["child"])]
    points += solution.description.get("paths", {}).values()
    own = [(point["x"], point["y"]) for point in points if point["body"] == name]
    outline = solution.description.get("outlines", {}).get(name)
    if outline:
        corners = [_at(solution, name, i, *corner) for corner in outline]
        axes.fill(*zip(*corners, strict=True), facecolor=colour, alpha=0.25, edgecolor=colour, linewidth=2.0, label=name, zorder=3)
        return
    if "centre" in body:
        centre = (body["centre"]["x"], body["centre"]["y"])
        lines, width = [(centre, point) for point in own], 3.0
    else:
        lines, width = [((min(max(x, 0.0), body["length"]), 0.0), (x, y)) for x, y in own], 1.6
        (x0, y0), (x1, y1) = (_at(solution, name, i, *place) for place in ((0.0, 0.0), (body["length"], 0.0)))
        axes.plot([x0, x1], [y0, y1], color=colour, linewidth=4, solid_capstyle="round", label=name, zorder=3)
    for k, (start, stop) in enumerate(lines):
        (x0, y0), (x1, y1) = _at(solution, name, i, *start), _at(solution, name, i, *stop)
        label = name if "centre" in body and k == 0 else None
        axes.plot([x0, x1], [y0, y1], color=colour, linewidth=width, solid_capstyle="round", label=label, zorder=3)


def _at(solution: Solution, body: str, i: int, x: float, y: float) -> tuple[float, float]:
    place = _place(solution, {"body": body, "x": x, "y": y})
    return float(place[0][i]), float(place[1][i])


def _labels(paths: Any, i: int, size: float) -> dict[tuple[float, float], list[str]]:
    """The joints' names by place, those at one place together."""
    found: dict[tuple[float, float], list[str]] = {}
    for name, (x, y) in paths.items():
        near = next((at for at in found if max(abs(at[0] - x[i]), abs(at[1] - y[i])) < 1e-3 * size), (float(x[i]), float(y[i])))
        found.setdefault(near, []).append(name)
    return found


def _draw_axis(axes: Any, solution: Solution, joint: Any, i: int, size: float) -> None:
    """The line of a prismatic joint, through its parent's point."""
    parent = joint["parent"]
    c, s = _direction(solution, parent["body"])
    ax = c[i] * joint["axis"][0] - s[i] * joint["axis"][1]
    ay = s[i] * joint["axis"][0] + c[i] * joint["axis"][1]
    x, y = (values[i] for values in _place(solution, parent))
    axes.plot(
        [x - 4 * size * ax, x + 4 * size * ax],
        [y - 4 * size * ay, y + 4 * size * ay],
        color="0.55",
        linewidth=1.0,
        linestyle=(0, (6, 4)),
        zorder=1,
    )


def _direction(solution: Solution, body: str) -> tuple[Array, Array]:
    angle = None if body == "ground" else solution.pose(body).angle
    return (np.ones_like(solution.t), np.zeros_like(solution.t)) if angle is None else (np.cos(angle), np.sin(angle))


def _place(solution: Solution, point: Any) -> tuple[Array, Array]:
    """The path of a point of a body."""
    c, s = _direction(solution, point["body"])
    x, y = point["x"], point["y"]
    if point["body"] == "ground":
        return x * c, y * c
    pose = solution.pose(point["body"])
    return pose.x + c * x - s * y, pose.y + s * x + c * y


def _ends(solution: Solution, body: str) -> tuple[Array, Array, Array, Array]:
    length = solution.description["bodies"][body]["length"]
    base = _place(solution, {"body": body, "x": 0.0, "y": 0.0})
    return (*base, *_place(solution, {"body": body, "x": length, "y": 0.0}))
