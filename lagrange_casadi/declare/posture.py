"""Rough directions and places of a posture, as a user says them."""

from __future__ import annotations

import math
from collections.abc import Mapping

from ..base.numerals import readable
from ..base.tables import ANGLE, LENGTH
from ..base.units import number
from ..errors import DeclarationError, NumberError, UnknownNameError
from .mechanism import Mechanism
from .times import TURNS


def rough_posture(mechanism: Mechanism, posture: Mapping[str, object]) -> dict[str, float]:
    """Return rough directions of links and coordinates of joints [rad, m] by name.

    Raises what a :class:`.Scene` does.
    """
    coordinates = mechanism.coordinates
    places = [*(() if mechanism.space else mechanism.links), *coordinates]
    for name in posture:
        if name not in places:
            raise UnknownNameError("link or joint in posture", name, places)
    slides = {name for name, (_, axis) in coordinates.items() if axis.kind == "slide"}
    return {name: _rough(name, value, name not in slides) for name, value in posture.items()}


def posture_entry(name: str, slides: bool, value: float, *others: float) -> str:
    """Write an entry of a posture to paste, so that a ``value`` [rad or m] differs from others."""
    if slides:
        return f"'{name}': {readable(value, *others)}"
    return f"'{name}': '{readable(*map(math.degrees, (value, *others)))} deg'"


def _rough(name: str, value: object, is_angle: bool) -> float:
    """Direction [rad] or place [m] of a posture. Raises :class:`DeclarationError`."""
    try:
        found = number(value, ANGLE if is_angle else LENGTH)
    except NumberError as error:
        raise DeclarationError(f"posture of '{name}': {error}") from None
    if is_angle and abs(found) > TURNS:
        degrees = f"{math.degrees(found):.6g} deg, more than two turns"
        hint = f"; '{value:g} deg' is {value:g} degrees" if isinstance(value, (int, float)) else ""
        raise DeclarationError(f"posture of '{name}': {found:.6g} rad is {degrees}{hint}")
    return found
