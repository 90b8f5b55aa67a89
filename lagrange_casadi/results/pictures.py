"""Pictures of a solution: the options of an animation, the animation in a file, and the report's
page in a notebook.
"""

from __future__ import annotations

import math
from base64 import b64encode
from dataclasses import dataclass
from html import escape
from pathlib import Path

from ..base.arguments import public
from ..base.vocabulary import RATE, SECONDS, WIDTH
from ..errors import DeclarationError

_KINDS = {".gif": "image/gif", ".svg": "image/svg+xml", ".mp4": "video/mp4"}
"""Kinds that browsers show."""

_WIDTHS, _MOST, _SHORTEST, _FASTEST = (80, 3840), 3000, 0.1, 50


@public
@dataclass(frozen=True)
class Film:
    """Options of a film: the picture's ``width`` [pixels], frames a second, and the ``seconds`` of
    a cycle.

    ``forces`` adds reactions, efforts and loads as arrows, ``section`` a section force by its name,
    as "bending", as ribbons along links. ``names`` writes the joints' names beside them. Raises
    :class:`.DeclarationError` for what is out of range.
    """

    width: int = WIDTH
    rate: float = RATE
    seconds: float = SECONDS
    forces: bool = False
    section: str = ""
    names: bool = True

    def __post_init__(self) -> None:
        low, high = _WIDTHS
        width, rate, seconds = self.width, self.rate, self.seconds
        for name, value, fits, expected in (
            (
                "width",
                width,
                low <= width <= high and not width % 2,
                f"an even number of pixels from {low} to {high}",
            ),
            ("rate", rate, 0.0 < rate < math.inf, "frames a second above 0"),
            ("seconds", seconds, 0.0 < seconds < math.inf, "seconds a cycle above 0"),
            ("seconds", seconds, seconds >= _SHORTEST, f"{_SHORTEST} seconds a cycle at least"),
            ("rate", rate, rate <= _FASTEST, f"{_FASTEST} frames a second at most"),
        ):
            if not fits:
                raise DeclarationError(f"{name}: expected {expected}, got {value!r}")
        if rate * seconds > _MOST:
            raise DeclarationError(
                f"rate and seconds: expected {_MOST} frames at most, got {rate * seconds:.6g}"
            )


@dataclass(frozen=True)
class Animation:
    """An animation in a file, which a notebook shows if it is the last value of a cell; a .glb is
    for programs of its own.
    """

    path: Path

    def _repr_html_(self) -> str:
        """The file itself, within the page."""
        path, kind = escape(str(self.path)), _KINDS.get(self.path.suffix.lower())
        if kind is None or not self.path.is_file():
            return f"<p>{path}</p>"
        source = f"data:{kind};base64,{b64encode(self.path.read_bytes()).decode()}"
        if kind.startswith("video"):
            return f'<video src="{source}" title="{path}" autoplay loop controls muted></video>'
        return f'<img src="{source}" alt="{path}">'


@dataclass(frozen=True)
class View:
    """A report's page, which a notebook shows in a frame of a ``height`` [points]."""

    case: str
    text: str
    height: int

    def __repr__(self) -> str:
        return (
            f"<View of {self.case}: a notebook shows it; solution.report('{self.case}.html')"
            " writes it>"
        )

    def _repr_html_(self) -> str:
        """The page in a frame of its own, which runs its script and may
        do nothing to the notebook.
        """
        style, text = "width:100%;border:0;border-radius:8px", escape(self.text)
        return (
            f'<iframe sandbox="allow-scripts allow-modals" style="{style}" height="{self.height}"'
            f' srcdoc="{text}"></iframe>'
        )
