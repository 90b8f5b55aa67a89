"""Limits on factors of safety, as limits on how far a link is used."""

from __future__ import annotations

import math
import re

from ..declare.mechanism import Mechanism
from ..declare.scene import Wanted
from ..errors import DeclarationError
from ..system.numerals import real
from .terms import Constraint

_LEAST = re.compile(r"\s*least:(safety|yield|buckling|fatigue):([^<>=!:]+?)\s*(<=|>=|<|>)\s*([^<>=!]+?)\s*")
_WAYS = ("yield", "buckling")


def constraints_of(text: str, mechanism: Mechanism) -> list[Constraint]:
    """The constraints that a text says: ``least:safety:LINK >= NUMBER`` is one for each way to fail, any other text one.

    Raises :class:`.DeclarationError` for what is none, and for a factor against fatigue.
    """
    found = _LEAST.fullmatch(text) if isinstance(text, str) else None
    if found is None:
        return [Constraint.parse(text, mechanism.parameters)]
    way, link, relation, number = found.groups()
    Wanted.of(mechanism, [f"safety:{link}"])
    try:
        factor = real(number)
    except ValueError:
        factor = math.nan
    if not (0.0 < factor < math.inf and relation.startswith(">")):
        raise DeclarationError(f"'{text}': expected a least factor of safety, as least:safety:{link} >= 2")
    beam = mechanism.links[link].beam
    assert beam is not None
    if way == "fatigue" or (way == "safety" and beam.material.endurance is not None):
        own = " and ".join(f"least:{each}:{link}" for each in _WAYS)
        raise DeclarationError(f"'{text}': fatigue is that of a whole cycle, and is followed by sweeps alone; limit {own}")
    ways = _WAYS if way == "safety" else (way,)
    return [Constraint.parse(f"peak:utilisation:{link}:{each} <= {1.0 / factor:.17g}", mechanism.parameters) for each in ways]
