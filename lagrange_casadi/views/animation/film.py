"""Options of an animation, and the file that it makes."""

from __future__ import annotations

import math
import os
from base64 import b64encode
from dataclasses import dataclass
from html import escape
from pathlib import Path

from ...base.arguments import public
from ...base.files import writing
from ...base.vocabulary import RATE, SECONDS, WIDTH
from ...errors import DeclarationError
from ...results.solution import Solution
from ..shapes.poses import require_poses
from ..shapes.primitives import drawing, size_of
from ..shapes.shapes import named_spots
from ..shapes.sheet import Picture, picture, view_of
from ..shapes.vector import svg
from .forces import drawn_forces
from .frames import frames_of
from .gltf import glb
from .pixels import find_ffmpeg, gif, mp4

ENDINGS = (".gif", ".mp4", ".svg", ".glb")
"""Kinds of animations, by the name's ending."""

_KINDS = {".gif": "image/gif", ".svg": "image/svg+xml", ".mp4": "video/mp4"}
"""Kinds that browsers show."""

_WIDE = 640.0
"""The width of a sheet [points]: widths of lines and sizes of letters are for it, and grow with the
picture.
"""

_WIDTHS, _MOST, _SHORTEST = (80, 3840), 3000, 0.1


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
        if (
            isinstance(self.width, bool)
            or not isinstance(self.width, int)
            or not low <= self.width <= high
            or self.width % 2
        ):
            raise DeclarationError(
                f"width: expected an even number of pixels from {low} to {high}, got {self.width!r}"
            )
        for name, value, unit in (
            ("rate", self.rate, "frames a second"),
            ("seconds", self.seconds, "seconds a cycle"),
        ):
            if (
                isinstance(value, bool)
                or not isinstance(value, (int, float))
                or not (math.isfinite(value) and value > 0)
            ):
                raise DeclarationError(f"{name}: expected {unit} above 0, got {value!r}")
        if self.seconds < _SHORTEST:
            raise DeclarationError(
                f"seconds: expected {_SHORTEST} seconds a cycle at least, got {self.seconds!r}"
            )
        if self.rate > 50:
            raise DeclarationError(f"rate: expected 50 frames a second at most, got {self.rate!r}")
        if self.rate * self.seconds > _MOST:
            raise DeclarationError(
                f"rate and seconds: expected {_MOST} frames at most, got"
                f" {self.rate * self.seconds:.6g}"
            )


def check_ending(path: Path) -> None:
    """Check that an animation can be written into a file of this name.

    Parameters
    ----------
    path : Path
        Name of the file.

    Raises
    ------
    DeclarationError
        If it has another ending than .gif, .mp4, .svg and .glb.
    LagrangeCasadiError
        For an MP4, if ffmpeg is not found.
    """
    if path.suffix.lower() not in ENDINGS:
        raise DeclarationError(
            f"animation {path}: expected a name that ends in {', '.join(ENDINGS[:-1])} or"
            f" {ENDINGS[-1]}"
        )
    if path.suffix.lower() == ".mp4":
        find_ffmpeg()


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


@public
def write_animation(
    solution: Solution, path: str | os.PathLike[str], film: Film | None = None
) -> Animation:
    """Write one cycle of a solution as a GIF, an MP4, an animated SVG or glTF.

    Parameters
    ----------
    solution : Solution
        Has the motion of all bodies, and the forces that are shown.
    path : path
        The file, which ends in .gif, .mp4, .svg or .glb. It is replaced whole or not at all.
    film : Film, optional
        Width, rate, duration and forces.

    Returns
    -------
    Animation
        The file; a notebook shows it.

    Raises
    ------
    DeclarationError
        If the solution lacks the motion or the forces, or the ending is another.
    PathError
        If the file cannot be written.
    StoreError
        If writing fails.
    LagrangeCasadiError
        For an MP4, if ffmpeg is not found.
    """
    target, film = Path(path), film or Film()
    check_ending(target)
    ending = target.suffix.lower()
    if ending == ".glb":
        if film.section:
            raise DeclarationError(
                f"animation {target}: a .glb has no section forces; they are in"
                f" {', '.join(ENDINGS[:-1])}"
            )
        require_poses(solution, "an animation")
        solid = glb(
            solution, max(2, round(film.rate * film.seconds)), film.seconds, forces=film.forces
        )
        with writing(target) as file:
            file.write(solid)
        return Animation(target)
    shown = picture_of(solution, film)
    if ending == ".mp4":
        data = mp4(shown, shown.frames / film.seconds)
    elif ending == ".gif":
        data = gif(shown, film.seconds)
    else:
        data = svg(shown, film.seconds).encode()
    with writing(target) as file:
        file.write(data)
    return Animation(target)


def picture_of(solution: Solution, film: Film) -> Picture:
    """All that is drawn, frame by frame.

    Raises :class:`.DeclarationError` for motion or forces that the solution lacks.
    """
    require_poses(solution, "an animation")
    frames = frames_of(solution, max(2, round(film.rate * film.seconds)))
    description = solution.description
    named = named_spots(description) if film.names else {}
    joints = {name: spot for name, spot in named.items() if name in description.joints}
    lines = drawing(frames.poses, frames.whole, joints)
    forces, words = drawn_forces(frames, size_of(lines), arrows=film.forces, section=film.section)
    return picture(
        solution.case,
        (*lines, *forces),
        view_of(description),
        film.width,
        unit=film.width / _WIDE,
        words=words,
        closed=frames.closed,
    )
