"""The mechanism at one instant as a small SVG: for notebooks, in any colours of theirs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from html import escape

import numpy as np

from ...base.arrays import Array
from ...model.description import Place
from ...results.solution import Solution
from ..shapes.places import drawn_spots, placed
from ..shapes.shapes import named_spots, shapes
from ..shapes.solid import COLOURS, PATH
from ..shapes.views import AZIMUTH, ELEVATION, upright, view

_WIDE, _HIGH, _MARGIN = 460.0, 300.0, 34.0
_TRACED = 120
"""Largest number of instants at which paths of declared points are drawn."""

_STAND = "M0 0L8 12H-8ZM-12 12H12" + "".join(f"M{x} 12l-4 5" for x in (-6, -1, 4, 9))
"""The mark of what stands still, under its place."""

_NEAR = 6.0
"""Joints that are no farther apart on the sheet have their names together."""

Places = Callable[[Place], Array]


def still(solution: Solution) -> str:
    """The mechanism at the first instant; from a slanted direction where it is in space."""
    description = solution.description
    if description.space:
        one = view(upright(description.gravity), AZIMUTH, ELEVATION)
        right, up = one.right, one.up
    else:
        right, up = np.eye(3)[0], np.eye(3)[1]
    thin = solution.during(slice(None, None, 1 + solution.t.size // _TRACED))

    def flat(spot: Place) -> Array:
        """A place over the instants (t, 2), to the right and up [m]."""
        found: Array = placed(thin, spot) @ np.column_stack([right, up])
        return found

    cloud = np.concatenate([flat(spot) for spot in drawn_spots(solution.description)])
    low, high = cloud.min(axis=0), cloud.max(axis=0)
    span = np.maximum(high - low, 0.2 * max(float(np.max(high - low)), 1e-12))
    scale = float(min((np.array([_WIDE, _HIGH]) - 2 * _MARGIN) / span))
    middle = (low + high) / 2

    def on_sheet(spot: Place) -> Array:
        found: Array = np.array([_WIDE / 2, _HIGH / 2]) + scale * (flat(spot) - middle) * [
            1.0,
            -1.0,
        ]
        return found

    lines = "".join(_drawn(solution, on_sheet))
    size = f'width="{_WIDE:g}" height="{_HIGH:g}" viewBox="0 0 {_WIDE:g} {_HIGH:g}"'
    label = f'role="img" aria-label="{escape(solution.case)} at its first instant"'
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" {size} {label} stroke-linecap="round"'
        f' stroke-linejoin="round">{lines}</svg>'
    )


def _drawn(solution: Solution, on_sheet: Places) -> Iterator[str]:
    def first(spots: Sequence[Place]) -> Array:
        return np.array([on_sheet(spot)[0] for spot in spots])

    description = solution.description
    for spot in description.paths.values():
        yield _line(on_sheet(spot), PATH, 1.4)
    for k, shape in enumerate(shapes(description)):
        colour, name = COLOURS[k % len(COLOURS)], shape.name
        for plate in shape.plates:
            yield _line(first([Place(name, at) for at in plate]), colour, 1.6, closed=True)
        for ends in ([shape.axis] if shape.axis else []) + list(shape.arms):
            yield _line(
                first([Place(name, at) for at in ends]),
                colour,
                6.0 if shape.axis and ends is shape.axis else 4.0,
            )
        if shape.kind == "point":
            x, y = first([Place(name, (0.0, 0.0, 0.0))])[0]
            yield (
                f'<rect x="{x - 8:.1f}" y="{y - 8:.1f}" width="16" height="16" rx="2"'
                f' fill="{colour}"/>'
            )
    for spring in description.springs.values():
        yield _line(first(spring), "currentColor", 1.4, dashed=True)
    names: dict[tuple[float, float], str] = {}
    named = named_spots(description)
    for joint in description.joints.values():
        x, y = (float(value) for value in first([joint.child])[0])
        if "ground" in (joint.parent.body, joint.child.body) and joint.kind not in (
            "free",
            "prismatic",
            "slot",
        ):
            yield (
                f'<path transform="translate({x:.1f} {y:.1f})" d="{_STAND}" fill="none"'
                ' stroke="currentColor"/>'
            )
        radius = 3.5 if joint.kind == "spherical" else 4.5
        yield (
            f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius}" fill="#fff" stroke="#222"'
            ' stroke-width="1.4"/>'
        )
        if joint.name not in named:
            continue
        at = next(
            (other for other in names if abs(other[0] - x) + abs(other[1] - y) < _NEAR), (x, y)
        )
        names[at] = f"{names[at]}, {joint.name}" if at in names else joint.name
    for (x, y), name in names.items():
        left, anchor = (x + 8, "start") if x < 0.75 * _WIDE else (x - 8, "end")
        font = f'font-size="11" font-family="sans-serif" fill="currentColor" text-anchor="{anchor}"'
        yield f'<text x="{left:.1f}" y="{y - 7:.1f}" {font}>{escape(name)}</text>'


def _line(
    points: Array, colour: str, width: float, *, closed: bool = False, dashed: bool = False
) -> str:
    path = "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in points) + ("Z" if closed else "")
    fill = f'fill="{colour}" fill-opacity="0.25"' if closed else 'fill="none"'
    dashes = ' stroke-dasharray="2 4"' if dashed else ""
    return f'<path d="{path}" {fill} stroke="{colour}" stroke-width="{width:g}"{dashes}/>'
