"""Frames of a picture as pixels, painted by Pillow."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ...base.arrays import Array
from .picture_sheet import LETTER, Picture
from .symbols import PAPER, Name, edge, frame, outlines

if TYPE_CHECKING:
    from PIL.Image import Image
    from PIL.ImageDraw import ImageDraw

_FINE = 2
"""Pixels of the painting for each pixel of the frame, along each side: edges are smooth."""

_DASH = 9.0
"""The length of a dash and of the space behind [points]."""


def frames(picture: Picture, chosen: Iterable[int] | None = None) -> Iterator[Image]:
    """The frames, all or those that are ``chosen`` by number."""
    import matplotlib
    from PIL import Image, ImageDraw, ImageFont

    unit = _FINE * picture.unit
    letters = Path(matplotlib.get_data_path(), "fonts/ttf/DejaVuSans.ttf")
    font = ImageFont.truetype(str(letters), round(LETTER * unit))
    size = picture.width, picture.height
    for k in range(picture.frames) if chosen is None else chosen:
        sheet = Image.new("RGB", (_FINE * size[0], _FINE * size[1]), PAPER)
        brush = ImageDraw.Draw(sheet, "RGBA")
        for thing in picture.things:
            if isinstance(thing, Name):
                place = _FINE * frame(thing.points, k)[0]
                brush.text(
                    (place[0], place[1]),
                    thing.text,
                    thing.colour,
                    font,
                    "ls",
                    stroke_width=round(1.5 * unit),
                    stroke_fill=PAPER,
                )
                continue
            for line, points in outlines(thing, picture.unit * np.array([1.0, -1.0]), k):
                if line.opacity:
                    fill = f"{line.fill or line.colour}{round(255 * line.opacity):02x}"
                    brush.polygon([*(_FINE * points).ravel()], fill)
                way = _FINE * edge(line, points)
                for part in _dashes(way, _DASH * unit) if line.dashed else [way]:
                    _stroke(brush, part, line.colour, line.width * unit)
        yield sheet.resize(size, Image.Resampling.BOX)


def _stroke(brush: ImageDraw, points: Array, colour: str, width: float) -> None:
    """A polyline with round ends and corners."""
    wide = max(1, round(width))
    brush.line([*points.ravel()], colour, wide, "curve")
    for end in points[[0, -1]]:
        brush.ellipse([*(end - wide / 2), *(end + wide / 2)], colour)


def _dashes(points: Array, length: float) -> Iterator[Array]:
    """Dashes of a polyline (n, 2)."""
    gone = np.r_[0.0, np.cumsum(np.hypot(*np.diff(points, axis=0).T))]
    for at in np.arange(0.0, gone[-1], 2.0 * length):
        between = gone[(gone > at) & (gone < at + length)]
        along = np.r_[at, between, min(at + length, gone[-1])]
        yield np.column_stack([np.interp(along, gone, xs) for xs in points.T])
