"""SVG of a picture: every thing once, with its places over the cycle (SMIL), which any browser
plays. The file needs no other file.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from html import escape

import numpy as np

from ...base.arrays import Array
from .picture_sheet import LETTER, Picture
from .symbols import INK, PAPER, Line, Name, Symbol, outlines, turn

_UNFIT = re.compile(r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Letters that XML cannot hold."""


def svg(picture: Picture, seconds: float = 0.0, *, paper: bool = True) -> str:
    """The text of the file, a still if a cycle takes no ``seconds``; without ``paper`` there is no
    background, and words have the colour of the page that shows it.
    """
    wide, high = picture.width, picture.height
    style = (
        f'font-family="sans-serif" font-size="{LETTER * picture.unit:.4g}" stroke-linecap="round"'
        ' stroke-linejoin="round"'
    )
    lines = [
        (
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{wide}" height="{high}" viewBox="0 0'
            f' {wide} {high}" {style}>'
        ),
        f"<title>{_text(picture.title)}</title>",
    ]
    if paper:
        lines.append(f'<rect width="{wide}" height="{high}" fill="{PAPER}"/>')
    for thing in picture.things:
        lines += _element(thing, picture, seconds, paper)
    return "\n".join([*lines, "</svg>", ""])


def _element(
    thing: Line | Symbol | Name, picture: Picture, seconds: float, paper: bool
) -> Iterator[str]:
    if isinstance(thing, Line):
        places = [_pairs(points) for points in thing.points]
        moved = _animated("points", places, picture, seconds)
        yield _drawn(thing, places[0], picture.unit, moved)
        return
    points = thing.points.reshape(-1, 2)
    places = [f"{x:.1f} {y:.1f}" for x, y in points]
    moved = _animated("translate", places, picture, seconds)
    if isinstance(thing, Name):
        fill = thing.colour if paper or thing.colour != INK else "currentColor"
        halo = f' stroke="{PAPER}" stroke-width="{3.0 * picture.unit:.4g}" paint-order="stroke"'
        ink = f'fill="{fill}"{halo if paper else ""}'
        yield f'<text transform="translate({places[0]})" {ink}>{_text(thing.text)}{moved}</text>'
        return
    angles = np.unwrap([turn(thing, k) for k in range(len(thing.points))])
    turns = [f"{-angle:.4g}" for angle in np.degrees(angles)]
    turned = f' transform="rotate({turns[0]})"' if thing.along is not None else ""
    rotated = _animated("rotate", turns, picture, seconds)
    yield f'<g transform="translate({places[0]})">{moved}<g{turned}>{rotated}'
    still = replace(thing, points=np.zeros((1, 1, 2)), along=None)
    for line, corners in outlines(still, picture.unit * np.array([1.0, -1.0])):
        yield _drawn(line, _pairs(corners), picture.unit)
    yield "</g></g>"


def _drawn(line: Line, points: str, unit: float, moved: str = "") -> str:
    """The element of a line at some points."""
    name, width = "polygon" if line.closed else "polyline", line.width * unit
    fill = line.fill or line.colour if line.opacity else "none"
    clear = f' fill-opacity="{line.opacity:g}"' if 0.0 < line.opacity < 1.0 else ""
    dash = f' stroke-dasharray="{4.0 * width:.4g} {4.0 * width:.4g}"' if line.dashed else ""
    ink = f'fill="{fill}"{clear} stroke="{line.colour}" stroke-width="{width:.4g}"{dash}'
    if line.radius:
        return f'<circle r="{line.radius * unit:.4g}" {ink}/>'
    return f'<{name} points="{points}" {ink}' + (f">{moved}</{name}>" if moved else "/>")


def _pairs(points: Array) -> str:
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in points)


def _animated(name: str, places: list[str], picture: Picture, seconds: float) -> str:
    """The motion of an attribute, or of a transformation, over the frames."""
    if all(place == places[0] for place in places):
        return ""
    values = ";".join([*places, places[0]] if picture.closed else places)
    element = f'animateTransform attributeName="transform" type="{name}"'
    if name == "points":
        element = 'animate attributeName="points"'
    return f'<{element} dur="{seconds:.6g}s" repeatCount="indefinite" values="{values}"/>'


def _text(text: str) -> str:
    return escape(_UNFIT.sub("\ufffd", text))
