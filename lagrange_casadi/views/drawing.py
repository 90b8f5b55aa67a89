"""Drawings of what is declared: of a mechanism at a posture, of a scene at an instant, whether its
loops close or not.
"""

from __future__ import annotations

import os
import textwrap
from collections.abc import Mapping
from contextlib import suppress
from functools import partial
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from ..base.drawn import Drawing
from ..base.files import writing
from ..engine.placement import Placement, place, place_scene
from ..errors import LagrangeCasadiError
from ..model.mechanism import Mechanism
from ..model.scene import Scene
from ..studies.case import declared
from .shapes.marks import (
    body_names,
    driven_marks,
    gap_marks,
    ground_axes,
    load_marks,
)
from .shapes.picture_files import check_picture
from .shapes.picture_sheet import picture, view_of
from .shapes.pixels import frames
from .shapes.poses import Poses
from .shapes.primitives import cloud, drawing, seen, size_of
from .shapes.symbols import Primitive
from .shapes.vector import svg

ENDINGS = (".svg", ".png")
"""Kinds of drawings, by the name's ending."""

_WIDE, _TALLEST, _FINE = 720, 0.85, 2
"""The width of a picture [points], its largest height over the width, and pixels of a PNG for a
point.
"""

_LETTERS = 88
"""Letters in a line of words below a picture."""


def draw_mechanism(
    mechanism: Mechanism,
    path: str | os.PathLike[str] | None = None,
    *,
    parameters: Mapping[str, float] | None = None,
    posture: Mapping[str, Any] | None = None,
) -> Drawing:
    """Draw a mechanism, see :meth:`.Mechanism.draw`."""
    return _drawn(place(mechanism, values=parameters, posture=posture), path)


def draw_scene(
    scene: Scene,
    path: str | os.PathLike[str] | None = None,
    *,
    t: float | None = None,
    parameters: Mapping[str, float] | None = None,
) -> Drawing:
    """Draw a scene, see :meth:`.Scene.draw`."""
    return _drawn(place_scene(scene, t=t, values=parameters), path)


def draw_error(error: LagrangeCasadiError, path: Path | None = None) -> Drawing:
    """Draw the placement of an error, with its message, see :meth:`.Mechanism.draw`."""
    assert isinstance(error.placement, Placement)
    return _drawn(error.placement, path, str(error))


def draw_declared(
    file: Path,
    error: BaseException,
    path: Path | None = None,
    parameters: Mapping[str, float] | None = None,
) -> Drawing | None:
    """Draw the mechanism that a case's file had declared before an error of :func:`.load_case`;
    None where none can be drawn.
    """
    with suppress(LagrangeCasadiError):
        if mechanism := declared(file, error, Mechanism):
            return draw_mechanism(mechanism, path, parameters=parameters)
    return None


def face(mechanism: Mechanism) -> str:
    """A drawing of a mechanism for a notebook, or its parts where it cannot be drawn."""
    with suppress(LagrangeCasadiError):
        return draw_mechanism(mechanism).svg
    return f"<p>{escape(repr(mechanism))}</p>"


def _drawn(
    placement: Placement,
    path: str | os.PathLike[str] | None,
    words: str = "",
) -> Drawing:
    """A drawing of a placed mechanism with some words, by default on its gaps; in a file too."""
    gaps = tuple(gap.sentence for gap in placement.gaps)
    lines = [line for one in ([words] if words else gaps) for line in textwrap.wrap(one, _LETTERS)]
    shown = partial(
        picture,
        placement.declared.name,
        _things(placement),
        view_of(placement.description),
        tallest=_TALLEST,
        words="\n".join(lines),
    )
    still = shown(_WIDE)
    if path is not None:
        check_picture(path, ENDINGS)
        with writing(Path(path)) as file:
            if Path(path).suffix == ".svg":
                file.write(svg(still).encode())
            else:
                next(frames(shown(_FINE * _WIDE, unit=_FINE))).save(file, "PNG")
    return Drawing(placement.declared.name, svg(still, paper=False), gaps)


def _things(placement: Placement) -> list[Primitive]:
    """All that a drawing of a placed mechanism shows."""
    poses = Poses(
        placement.description,
        {"ground": np.zeros((1, 3))} | {name: x[None] for name, x in placement.bases.items()},
        {"ground": np.eye(3)[None]} | {name: x[None] for name, x in placement.axes.items()},
    )
    parts, p = drawing(poses), [*placement.description.values.values()]
    size = size_of(parts)
    found = [
        *parts,
        *driven_marks(poses, placement.driven, size),
        *load_marks(placement.declared, poses, placement.t, p, size),
        *body_names(poses),
        *gap_marks(placement.gaps),
    ]
    if placement.description.space:
        view = view_of(placement.description)
        found += ground_axes(view, cloud(seen(found, view)), size)
    return found
