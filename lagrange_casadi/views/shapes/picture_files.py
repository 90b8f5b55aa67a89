"""Files of pictures: their kinds, one at a time, with the same bytes each time."""

from __future__ import annotations

import os
import threading
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

from ...base.files import check_writable, writing
from ...errors import DeclarationError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PICTURES: dict[str, dict[str, None]] = {
    ".png": {"Software": None},
    ".pdf": {"Creator": None, "Producer": None, "CreationDate": None},
    ".svg": {"Creator": None, "Date": None},
}
"""Endings of pictures' names, and the metadata that each must not hold, so that a figure always
gives the same bytes: programs, clocks.
"""


def check_picture(
    path: str | os.PathLike[str] | None, endings: Collection[str] = tuple(PICTURES)
) -> None:
    """Raise :class:`.DeclarationError` for a name with none of some endings, and
    :class:`.PathError`; None is no picture.
    """
    if path is None:
        return
    target = Path(path)
    if target.suffix not in endings:
        raise DeclarationError(f"{target}: expected a name that ends in {', '.join(endings)}")
    check_writable(target)


RED, BLUE = "#b2182b", "#2166ac"

_STYLE: dict[Any, Any] = {
    "axes.titlesize": 10,
    "figure.titlesize": 11,
    "legend.fontsize": 9,
    "legend.frameon": False,
}
"""Settings of matplotlib for all figures."""

GRIDS = {"axes.grid": True, "grid.color": "0.92"}
"""Settings beside these for charts, all of which have a grid."""

_drawing = threading.RLock()


@contextmanager
def one_at_a_time(settings: Mapping[Any, Any] = {}) -> Iterator[None]:
    """Draw, by ``settings`` of matplotlib beside those of all figures: a thread at a time, for they
    are those of the whole process.
    """
    from matplotlib import rc_context

    with _drawing, rc_context({**_STYLE, **settings}):
        yield


def subplots(
    size: tuple[float, float], down: int = 1, across: int = 1, **more: Any
) -> tuple[Figure, list[Any]]:
    """A figure of a size [inch], and its axes row by row."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=size, layout="constrained")
    return figure, figure.subplots(down, across, squeeze=False, **more).ravel().tolist()


def save(
    figure: Figure, file: BinaryIO | str | os.PathLike[str], ending: str = ".png", dpi: int = 150
) -> None:
    """Write a figure into a file. ``ending`` is a key of :data:`PICTURES`, ``dpi`` the pixels for
    each inch.
    """
    # Names within an SVG are drawn at random where nothing is given.
    with one_at_a_time({"svg.hashsalt": "lagrange_casadi"}):
        figure.savefig(file, format=ending.removeprefix("."), dpi=dpi, metadata=PICTURES[ending])


def put_figure(figure: Figure, path: str | os.PathLike[str]) -> None:
    """Write a figure into a file that appears whole, of the kind that the name's ending says.

    Raises as :func:`check_picture` does.
    """
    check_picture(path)
    target = Path(path)
    with writing(target) as file:
        save(figure, file, target.suffix)
