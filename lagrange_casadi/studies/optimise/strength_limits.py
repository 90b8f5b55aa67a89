"""Limits on factors of safety, as limits on how far a link is used."""

from __future__ import annotations

import math
import re

from ...base.numerals import real
from ...declare.scene import Scene
from ...equations.model_data import materials_of, template
from ...errors import DeclarationError
from ...strength.fatigue import lacking, strengths
from ..sweep.meanings import WAYS
from .terms import Constraint

_LEAST = re.compile(
    r"\s*least:(safety|yield|buckling|fatigue):([^<>=!:]+?)\s*(<=|>=|<|>)\s*([^<>=!]+?)\s*"
)


def constraints_of(text: str, scene: Scene) -> list[Constraint]:
    """The constraints that a text says: ``least:safety:LINK >= NUMBER`` is one for each way to
    fail, any other text one.

    Raises :class:`.DeclarationError` for what is none, and where fatigue is to be limited of a
    material that lacks a number.
    """
    found = _LEAST.fullmatch(text) if isinstance(text, str) else None
    if found is None:
        return [Constraint.parse(text, scene.parameters)]
    mode, link, relation, number = found.groups()
    scene.wants([f"safety:{link}"])
    try:
        factor = real(number)
    except ValueError:
        factor = math.nan
    if not (0.0 < factor < math.inf and relation.startswith(">")):
        raise DeclarationError(
            f"'{text}': expected a least factor of safety, as least:safety:{link} >= 2"
        )
    material = materials_of(template(scene).content)[link]
    if mode == "fatigue":
        strengths(material, "goodman")
    modes = (
        tuple(w for w in WAYS if w != "fatigue" or not lacking(material))
        if mode == "safety"
        else (mode,)
    )
    return [
        Constraint.parse(f"peak:utilisation:{link}:{each} <= {1.0 / factor:.17g}", scene.parameters)
        for each in modes
    ]
