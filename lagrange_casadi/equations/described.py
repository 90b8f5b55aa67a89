"""A scene's mechanism as plain numbers, with what its spanning tree tells of it."""

from __future__ import annotations

import functools
from dataclasses import replace
from typing import Any

from ..base.symbolic import symbolic
from ..beams.beam import Beam
from ..beams.material import Material
from ..beams.told import beam_of
from ..declare.description import Description, Template, beams_of, template_of
from ..declare.scene import Scene
from .tree import span


def materials_of(description: Description) -> dict[str, Material]:
    """Return what links with a beam are made of."""
    return {name: Material(**description["bodies"][name]["beam"]["material"]) for name in beams_of(description)}


@symbolic
def beam_at(described: Template, link: str, p: Any) -> Beam:
    """Return the beam of a link, its numbers as expressions of parameters ``p``, or as numbers where these are numbers."""
    return beam_of(described.placed(described.content["bodies"][link]["beam"], p))


@symbolic
@functools.lru_cache(maxsize=32)
def template(scene: Scene) -> Template:
    """The description of a scene's mechanism but for its numbers.

    In space it names the ``bars``, links whose spin about their own axis is idle and taken to be none, and the coordinates that are
    ``unmeasured``.
    """
    mechanism = scene.mechanism
    found = template_of(mechanism, tuple(scene.laws), None if scene.weights is None else tuple(scene.weights))
    if not mechanism.space:
        return found
    tree = span(scene.guided, scene.laws)
    unmeasured = [name for name, (joint, axis) in mechanism.coordinates.items() if not tree.measures(joint, axis)]
    return replace(found, content=found.content | {"bars": [bar.link.name for bar in tree.bars], "unmeasured": unmeasured})
