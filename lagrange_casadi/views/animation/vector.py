"""An animated SVG: every thing once, with its places over the cycle (SMIL), which any browser
plays. It needs no other file.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from html import escape

from ...base.arrays import Array
from .drawn import INK, Dot, Line, Picture, Thing, Words

_UNFIT = re.compile(r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Letters that XML cannot hold."""


def svg(picture: Picture, seconds: float) -> str:
    """The text of the file."""
    wide, high = picture.width, picture.height
    style = (
        f'font-family="sans-serif" font-size="{13.0 * picture.unit:.4g}" stroke-linecap="round"'
        ' stroke-linejoin="round"'
    )
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{wide}" height="{high}" viewBox="0 0'
        f' {wide} {high}" {style}>'
    )
    lines = [
        head,
        f"<title>{_text(picture.title)}</title>",
        f'<rect width="{wide}" height="{high}" fill="#ffffff"/>',
    ]
    for thing in picture.things:
        lines += _element(thing, picture, seconds)
    return "\n".join([*lines, "</svg>", ""])


def _element(thing: Thing, picture: Picture, seconds: float) -> Iterator[str]:
    if isinstance(thing, Line):
        name = "polygon" if thing.closed else "polyline"
        fill = (
            f'fill="{thing.fill}" fill-opacity="{thing.opacity:g}"' if thing.fill else 'fill="none"'
        )
        dashes = (
            f' stroke-dasharray="{4.0 * thing.width:.4g} {4.0 * thing.width:.4g}"'
            if thing.dashed
            else ""
        )
        places = [_places(points) for points in thing.points]
        ink = f'{fill} stroke="{thing.colour}" stroke-width="{thing.width:.4g}"{dashes}'
        yield (
            f'<{name} points="{places[0]}"'
            f" {ink}>{_animated('points', places, picture, seconds)}</{name}>"
        )
        return
    places = [f"{x:.1f} {y:.1f}" for x, y in thing.points]
    moved = _animated("transform", places, picture, seconds)
    if isinstance(thing, Dot):
        ink = (
            f'r="{thing.radius:.4g}" fill="{thing.fill}" stroke="{INK}"'
            f' stroke-width="{1.5 * picture.unit:.4g}"'
        )
        yield f'<circle transform="translate({places[0]})" {ink}>{moved}</circle>'
    elif isinstance(thing, Words):
        ink = (
            f'fill="{INK}" stroke="#ffffff" stroke-width="{3.0 * picture.unit:.4g}"'
            ' paint-order="stroke"'
        )
        anchor = ' text-anchor="end"' if thing.before else ""
        yield (
            f'<text transform="translate({places[0]})"'
            f" {ink}{anchor}>{_text(thing.text)}{moved}</text>"
        )


def _places(points: Array) -> str:
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in points)


def _animated(name: str, places: list[str], picture: Picture, seconds: float) -> str:
    if all(place == places[0] for place in places):
        return ""
    values = ";".join([*places, places[0]] if picture.closed else places)
    element, kind = (
        ("animateTransform", ' type="translate"') if name == "transform" else ("animate", "")
    )
    return (
        f'<{element} attributeName="{name}"{kind} dur="{seconds:.6g}s" repeatCount="indefinite"'
        f' values="{values}"/>'
    )


def _text(text: str) -> str:
    return escape(_UNFIT.sub("\ufffd", text))
