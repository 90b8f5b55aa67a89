"""Drives of joints: the inertia of their rotors, and what they can do."""

from __future__ import annotations

from dataclasses import dataclass

from ..base.brief import Brief
from .declared_parts import Expression
from .joints import Axis, Joint


@dataclass(frozen=True, eq=False, repr=False)
class Drive(Brief):
    """A drive of a joint of one coordinate q, whose axis is a: a rotor that turns about a line
    along a, ``ratio`` times as far as q, in a housing that the joint's parent carries.

    The rotor's mass, and its inertia I where it does not turn in its housing, are among those of
    the parent. With w the parent's angular velocity and r the ratio, what is left of its
    acceleration takes from the effort::

        (armature + r^2 I) q'' + r I (a . w)'

    and the spin, r I q' a, puts -(r I q' a)' on the parent: gyroscopic terms are exact. An
    ``armature`` [kg m^2 or kg] is the inertia r^2 I of a rotor whose ratio is not known, as
    MuJoCo and Pinocchio have it: without the terms in r I, which are 1/r of it.

    ``effort`` [N m or N] and ``speed`` [rad/s or m/s] are the largest that the drive can do; None
    where they are not known.
    """

    name: str
    joint: Joint
    axis: Axis
    rotor_inertia: Expression = 0.0
    ratio: Expression = 1.0
    armature: Expression = 0.0
    effort: Expression | None = None
    speed: Expression | None = None

    @property
    def numbers(self) -> dict[str, Expression]:
        """Numbers of the drive that must not be negative, by the keywords of its declaration."""
        limits = {"effort": self.effort, "speed": self.speed}
        given = {word: value for word, value in limits.items() if value is not None}
        return {"rotor_inertia": self.rotor_inertia, "armature": self.armature} | given

    @property
    def reflected(self) -> Expression:
        """The inertia that the coordinate sees [kg m^2 or kg]."""
        return self.armature + self.ratio * self.ratio * self.rotor_inertia

    @property
    def spin(self) -> Expression:
        """The rotor's angular momentum against its housing, for a unit of the joint's rate."""
        return self.ratio * self.rotor_inertia
