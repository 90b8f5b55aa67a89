"""What rubs: contacts and what presses on them, and how slow is at rest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca

from ..declare.meshes import Loss, Transmission
from ..declare.parts import Friction
from .gaps import reach
from .multibody import Multibody

_REST = 1e-12
"""Of the fastest motion in the mechanism: a rate below is that of rest, but for rounding."""


@dataclass(frozen=True, eq=False)
class Contact:
    """What presses on a rubbing place [N], of one component or two, and the ``arm`` that its friction has: 1 or a radius [m].

    Of a thread, ``lean`` tells how much more one direction of sliding presses than the other [m].
    """

    arm: Any
    pressing: tuple[Any, ...]
    lean: Any = None


@dataclass(frozen=True, eq=False)
class Rubbing:
    """A friction as expressions of an instant: its contacts, and rate and acceleration of its coordinate.

    What presses the parts of a transmission apart is found with frictions, because they depend on each other. It has no rate.

    ``slowest`` is the rate below which it rests, and the change of rate below which it goes on to.
    """

    friction: Friction | Transmission | Loss
    contacts: tuple[Contact, ...]
    rate: Any
    acceleration: Any
    slowest: tuple[Any, Any]

    @property
    def rows(self) -> list[Any]:
        """All its expressions, in an order that :meth:`of_rows` knows."""
        return [*(x for contact in self.contacts for x in contact.pressing), self.rate, self.acceleration, *self.slowest]

    def of_rows(self, rows: Sequence[Any]) -> Rubbing:
        """The same with other expressions."""
        left = iter(rows)
        contacts = tuple(Contact(c.arm, tuple(next(left) for _ in c.pressing), c.lean) for c in self.contacts)
        rate, acceleration, *slowest = left
        return Rubbing(self.friction, contacts, rate, acceleration, (slowest[0], slowest[1]))


def slowest_of(multibody: Multibody, *, slides: bool) -> tuple[Any, Any]:
    """The rate below which a coordinate rests, and the change of rate below which it goes on to: beside those of the drives."""
    unit, fastest, quickest = reach(multibody.mechanism), ca.SX(0), ca.SX(0)
    for own in (coordinate for coordinate in multibody.coordinates if coordinate.driven):
        size = 1 if own.kind == "angle" else unit
        fastest += ca.fabs(own.rate) / size
        quickest += ca.fabs(own.acceleration) / size
    quickest += fastest * fastest
    least = _REST * (unit if slides else 1)
    return least * fastest, least * quickest
