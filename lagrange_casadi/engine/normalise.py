"""Scenes as they are derived: the wanted outputs read, and what is named refused."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ..base.arguments import texts
from ..base.symbolic import symbolic
from ..errors import DeclarationError
from ..model.scene import STRENGTH, Scene, Wanted
from ..model.wanted_names import among
from .two_force_links import find_two_force_links, unaimed


@dataclass(frozen=True)
class Model:
    """A ``scene``, the outputs that are wanted of it, and ``values`` of all parameters, with which
    its loops are assembled if they cannot be with the scene's own; None if there are no others.
    """

    scene: Scene
    want: Wanted
    values: Mapping[str, float] | None


@symbolic
def normalise(
    scene: Scene, wanted: Sequence[str] | None = None, values: Mapping[str, float] | None = None
) -> Model:
    """Read the outputs that are wanted of a scene, by default its own; ``values`` are checked.

    Raises :class:`.DeclarationError` for outputs that the mechanism does not have.
    """
    names = scene.wanted if wanted is None else wanted
    listed = texts(names)
    want = Wanted.of(scene.mechanism, names) if listed is None else _read(scene, tuple(listed))
    return Model(scene, want, values)


@functools.lru_cache(maxsize=64)
def _read(scene: Scene, names: tuple[str, ...]) -> Wanted:
    want = Wanted.of(scene.mechanism, names)
    _check_aimed(scene, names)
    return want


def _check_aimed(scene: Scene, names: Sequence[str]) -> None:
    """Raise :class:`DeclarationError` for a bar whose strength is asked for by name, and which has
    no direction for it.
    """
    named = [name for name in names if name != "all"]
    for two_force_link in find_two_force_links(scene.guided, scene.laws) if named else ():
        asked = any(among(kind, [two_force_link.link.name], named) for kind in STRENGTH)
        if (
            asked
            and not two_force_link.aimed
            and two_force_link.link.beam is not None
            and not two_force_link.link.beam.round
        ):
            raise DeclarationError(unaimed(two_force_link.link.name))
