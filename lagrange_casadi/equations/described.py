"""A scene's mechanism as plain numbers, with what its spanning tree tells of it."""

from __future__ import annotations

from collections.abc import Mapping

from ..declare.description import Description, describe
from ..declare.scene import Scene
from ..system.symbolic import symbolic
from .tree import span


@symbolic
def described(scene: Scene, values: Mapping[str, float]) -> Description:
    """The description of a scene's mechanism, for values of its parameters.

    In space it names the ``bars``, links whose spin about their own axis is idle and taken to be none, and the coordinates that are
    ``unmeasured``.
    """
    mechanism = scene.mechanism
    found = describe(mechanism, values, scene.laws, scene.weights)
    if not mechanism.space:
        return found
    tree = span(scene.guided, scene.laws)
    unmeasured = [name for name, (joint, axis) in mechanism.coordinates.items() if not tree.measures(joint, axis)]
    return found | {"bars": [bar.link.name for bar in tree.bars], "unmeasured": unmeasured}
