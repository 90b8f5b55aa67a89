"""The file that an animation makes."""

from __future__ import annotations

import os
from pathlib import Path

from ...base.arguments import public
from ...base.files import writing
from ...errors import DeclarationError
from ...results.pictures import Animation, Film
from ...results.solution import Solution
from ..shapes.picture_sheet import Picture, picture, view_of
from ..shapes.poses import Poses
from ..shapes.primitives import drawing, size_of
from ..shapes.shapes import named_spots
from ..shapes.vector import svg
from .film_frames import frames_of, require_motion
from .forces import drawn_forces, moving
from .gltf import glb
from .moving_pixels import find_ffmpeg, gif, mp4

ENDINGS = (".gif", ".mp4", ".svg", ".glb")
"""Kinds of animations, by the name's ending."""

_WIDE = 640.0
"""The width of a sheet [points]: widths of lines and sizes of letters are for it, and grow with the
picture.
"""


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
    require_motion(solution)
    solution = moving(solution)
    ending = target.suffix.lower()
    if ending == ".glb":
        if film.section:
            raise DeclarationError(
                f"animation {target}: a .glb has no section forces; they are in"
                f" {', '.join(ENDINGS[:-1])}"
            )
        data = glb(solution, _frames(film), film.seconds, forces=film.forces)
    elif ending == ".svg":
        data = svg(picture_of(solution, film), film.seconds).encode()
    else:
        data = (gif if ending == ".gif" else mp4)(picture_of(solution, film), film.seconds)
    with writing(target) as file:
        file.write(data)
    return Animation(target)


def picture_of(solution: Solution, film: Film) -> Picture:
    """All that is drawn, frame by frame.

    Raises :class:`.DeclarationError` for forces that the solution lacks.
    """
    whole = Poses.of(solution)
    shown, closed = frames_of(solution, whole, _frames(film))
    description = solution.description
    joints = {
        name: spot
        for name, spot in named_spots(description).items()
        if film.names and name in description.joints
    }
    poses = Poses.of(shown)
    lines = drawing(poses, whole, joints)
    forces, words = drawn_forces(
        shown, poses, solution, size_of(lines), arrows=film.forces, section=film.section
    )
    return picture(
        solution.case,
        (*lines, *forces),
        view_of(description),
        film.width,
        unit=film.width / _WIDE,
        words=words,
        closed=closed,
    )


def _frames(film: Film) -> int:
    """The number of frames of a cycle at most."""
    return max(2, round(film.rate * film.seconds))
