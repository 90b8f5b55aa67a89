"""Action of teeth, belts and chains on the bodies that they couple: forces on their real lines,
from one multiplier.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import casadi as ca

from ..base.numerals import readable
from ..base.vectors import ZERO
from .declared_parts import Body, Expression, Point, Vector
from .joints import Joint

FITTING = 1e-9
"""Largest relative difference of two numbers that must be equal."""


@dataclass(frozen=True, eq=False)
class Wrench:
    """A force, and a couple about the place where it is given [m for a force without a unit], in a
    carrier's axes.
    """

    force: Vector = ZERO
    couple: Vector = ZERO


@dataclass(frozen=True, eq=False)
class Mesh:
    """Place where two bodies touch, or where a belt runs over them; ``carrier`` is the body on
    which both turn.

    The first bears, at its point ``first``, lambda ``along`` + s ``apart`` + c ``braking``, and the
    second the opposite. lambda is the multiplier, of either sign; s is never negative; c is what
    friction takes. ``centre`` is the place of ``first`` in the carrier's axes, and ``reach`` leads
    from there to ``second``, which may be at a place that moves on its body. Whatever moves is an
    expression of coordinates.
    """

    first: Point
    second: Point
    carrier: Body
    centre: Vector
    reach: Vector
    along: Wrench
    apart: Wrench | None = None
    braking: Wrench | None = None


@dataclass(frozen=True, eq=False)
class Loss:
    """Friction loss in a transmission: c = -(sigma ``arm`` |lambda| + ``lean`` lambda), with sigma
    the sign of a rate.

    The rate is that of the sum of coordinates of joints, each with its sign, ``rotations``.
    ``symbol`` stands for c until it is found, as a friction's does.
    """

    name: str
    arm: Expression
    lean: Expression
    rotations: tuple[tuple[int, Joint], ...]
    symbol: Any = field(default_factory=lambda: ca.SX.sym("loss"))


@dataclass(frozen=True, eq=False)
class Fit:
    """Two numbers of a transmission that must be the same, beside a ``size``; ``words`` name both,
    as {got} and {meant}.
    """

    words: str
    got: Expression
    meant: Expression
    size: Expression

    def refusal(self, got: float, meant: float) -> str:
        """Describe the difference of two numbers."""
        return self.words.format(got=readable(got, meant), meant=readable(meant, got))


@dataclass(frozen=True, eq=False)
class Transmission:
    """Meaning of a constraint's multiplier lambda: the force along the teeth, or the difference of
    a belt's tensions [N].

    It acts in every one of ``meshes``: several share a load evenly. With it comes s = (|lambda +
    slack| + |lambda - slack|)/2: of teeth, whose ``slack`` is zero, the size of lambda; of a belt
    the sum of its tensions, of which none can be negative. ``symbol`` stands for s until it is
    found. ``loss`` is there where parts rub. ``fits`` say of which numbers the parts must be.
    """

    name: str
    meshes: tuple[Mesh, ...]
    slack: Expression = 0.0
    fits: tuple[Fit, ...] = ()
    loss: Loss | None = None
    symbol: Expression = field(default_factory=lambda: ca.SX.sym("apart"))

    @property
    def varying(self) -> list[Fit]:
        """Fits that depend on parameters."""
        return [f for f in self.fits if isinstance(f.got, ca.SX) or isinstance(f.meant, ca.SX)]

    @property
    def parts(self) -> tuple[tuple[float, Expression], ...]:
        """The factors and slacks of the sizes that s is the sum of."""
        if isinstance(self.slack, float) and self.slack == 0.0:
            return ((1.0, 0.0),)
        return ((0.5, self.slack), (0.5, -self.slack))

    @property
    def presses(self) -> bool:
        """True if s has an effect."""
        return any(mesh.apart is not None for mesh in self.meshes)
