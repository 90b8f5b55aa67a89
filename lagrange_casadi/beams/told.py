"""What a link is made of in plain numbers, as a file keeps it, and back."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, fields
from typing import Any

from .beam import Beam, Notch
from .material import Material
from .shape import Course, Shape, dimensions_of, kinds


def told_beam(beam: Beam, number: Callable[[Any], float]) -> dict[str, Any]:
    """A beam, its expressions as numbers."""
    course, shapes = beam.course, list(beam.course.shapes())
    known = [{"kind": s.kind, "dimensions": {name: number(value) for name, value in s.dimensions.items()}} for s in shapes]
    places = [[next(k for k, s in enumerate(shapes) if s is end) for end in cell] for cell in course.cells]
    return {
        "breaks": list(course.breaks),
        "shapes": known,
        "cells": places,
        "material": asdict(beam.material),
        "notches": [asdict(notch) for notch in beam.notches],
        "columns": None if beam.columns is None else list(beam.columns),
    }


def beam_told(told: Mapping[str, Any]) -> Beam:
    """The beam of such numbers.

    Raises ``ValueError``, ``TypeError``, ``LookupError`` or :class:`.DeclarationError` for what is none, as in a forged file.
    """
    for shape in told["shapes"]:
        kind, numbers = shape["kind"], shape["dimensions"]
        known = dimensions_of(kind)
        if kind not in kinds() or (known is not None and tuple(numbers) != known):
            raise ValueError(f"{kind!r} is no cross-section with these dimensions")
        if not all(type(x) in (int, float) and math.isfinite(x) for x in numbers.values()):
            raise ValueError(f"the dimensions of a {kind} are not numbers")
    breaks = tuple(map(float, told["breaks"]))
    if len(breaks) != len(told["cells"]) + 1 or any(b <= a for a, b in itertools.pairwise(breaks)):
        raise ValueError("the breaks of a beam do not fit its cells")
    return beam_of(told)


def beam_of(told: Mapping[str, Any]) -> Beam:
    """Make the beam of what :func:`told_beam` wrote, be it numbers or expressions."""
    shapes = [Shape(shape["kind"], dict(shape["dimensions"])) for shape in told["shapes"]]
    breaks = tuple(map(float, told["breaks"]))
    course = Course(breaks, tuple((shapes[first], shapes[last]) for first, last in told["cells"]))
    material = Material(**{entry.name: told["material"][entry.name] for entry in fields(Material)})
    columns = None if told["columns"] is None else tuple(told["columns"])
    return Beam(course, material, [Notch(**notch) for notch in told["notches"]], columns)
