"""What the units of a mechanism's outputs depend on."""

from __future__ import annotations

from ..base.quantities import Kinds
from .mechanism import Mechanism
from .parts import Friction


def kinds_of(mechanism: Mechanism) -> Kinds:
    """The kinds of coordinates and of frictions, and the units of the user's outputs."""
    coordinates = {name: axis.kind for name, (_, axis) in mechanism.coordinates.items()}
    frictions = {name: load.axis.kind for name, load in mechanism.loads.items() if isinstance(load, Friction)}
    return Kinds(coordinates, frictions, {name: own.unit for name, own in mechanism.outputs.items()})
