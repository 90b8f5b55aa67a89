"""Results of one part: the motion and reaction of a joint, the pose of a body, the forces inside a
link.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..base.arrays import Array
from ..base.brief import Brief
from ..errors import NoComponentError, check_known
from .section_laws import SectionLaw
from .vector_sizes import size_of


@dataclass(frozen=True, eq=False, repr=False)
class JointMotion(Brief):
    """Coordinate of a joint [rad or m] with its rate and acceleration, each (t,): child against
    parent.

    An angle is counter-clockwise, a slide along the joint's axis. Both are continuous in time.
    """

    value: Array
    rate: Array
    acceleration: Array


@dataclass(frozen=True, eq=False, repr=False)
class Reaction(Brief):
    """Action of the joint's parent on its child, in ground axes, each (t,): ``fx``, ``fy`` [N],
    ``mz`` [N m] counter-clockwise.

    In space there are ``fz``, ``mx`` and ``my`` too, ``across`` the plane; in a plane they raise
    :class:`.NoComponentError`, an ``AttributeError``. Moments are about the joint's point on the
    child. What the joint does not bear is None. The drive's effort is not part of it.
    """

    fx: Array
    fy: Array
    mz: Array | None
    across: tuple[Array, Array | None, Array | None] | None = None

    @property
    def fz(self) -> Array:
        """The force along the ground's z (t,) [N]."""
        return self._in_space("fz")[0]

    @property
    def mx(self) -> Array | None:
        """The moment about the ground's x (t,) [N m]."""
        return self._in_space("mx")[1]

    @property
    def my(self) -> Array | None:
        """The moment about the ground's y (t,) [N m]."""
        return self._in_space("my")[2]

    def _in_space(self, name: str) -> tuple[Array, Array | None, Array | None]:
        if self.across is None:
            raise NoComponentError("component of a reaction in a plane", name, ("fx", "fy", "mz"))
        return self.across

    @property
    def resultant(self) -> Array:
        """The size of the force (t,) [N]."""
        return size_of((self.fx, self.fy) if self.across is None else (self.fx, self.fy, self.fz))

    @property
    def moment(self) -> Array | None:
        """The size of the moment (t,) [N m], or None where the joint bears none."""
        components = [
            values for values in (*(self.across or ())[1:], self.mz) if values is not None
        ]
        return size_of(components) if components else None


@dataclass(frozen=True, eq=False, repr=False)
class Pose(Brief):
    """Place of a body's base in ground axes [m] and direction of its axis [rad], each (t,).

    ``angle`` is counter-clockwise from x and continuous in time; it is None for a point mass and in
    space. There ``z`` is given too, and ``axes`` (t, 3, 3): its rows are the body's axes x, y and z
    in ground axes, NaN those that it has none of.
    """

    x: Array
    y: Array
    angle: Array | None
    z: Array | None = None
    axes: Array | None = None


@dataclass(frozen=True, eq=False)
class Section:
    """The forces inside a link: what the part towards the tip does to the part towards the base, on
    the link's axes.

    In the plane these are (e, n, z): e runs from base to tip, n is 90 degrees counter-clockwise of
    e. In space they are x, from base to tip, and the cross-section's y and z; ``shear`` and
    ``bending`` are then resultants. At a station the grids hold the value on its tip side. What
    equilibrium does not determine is NaN. A grid is made when it is first asked for, from ``law``,
    which holds seven numbers an instant, or twelve in space, and loads at stations and along the
    link; each raises :class:`.SizeError` where memory does not hold it. Those of space raise
    :class:`.UnknownNameError` in the plane. The paper's internal forces (Nguyen, Petre, Stroe, eq.
    13, 20 and 21) have the opposite sign.
    """

    law: SectionLaw
    xi: Array

    def __repr__(self) -> str:
        return (
            f"<Section of a link of {self.law.length:g} m: {self.law.coefficients['n0'].size}"
            f" instants, {self.xi.size} ratios>"
        )

    @cached_property
    def axial(self) -> Array:
        """Axial force (t, xi) [N], along the axis: positive in tension."""
        return self._grid("axial")

    @cached_property
    def shear(self) -> Array:
        """Shear force (t, xi) [N]: in the plane positive along n, minus the slope of ``bending``;
        in space the resultant.
        """
        return self._grid("shear")

    @cached_property
    def bending(self) -> Array:
        """Bending moment (t, xi) [N m]: in the plane positive counter-clockwise, in space the
        resultant.

        In the plane a positive one stretches the fibres on the side of -n, to the right of whoever
        goes from base to tip, and compresses those on the side of n. A cantilever whose tip is
        pulled along -n has a negative one.
        """
        return self._grid("bending")

    @cached_property
    def shear_y(self) -> Array:
        """Shear force along the link's y (t, xi) [N]: minus the slope of ``bending_z`` along the
        link.
        """
        return self._grid("shear_y")

    @cached_property
    def shear_z(self) -> Array:
        """Shear force along the link's z (t, xi) [N]: the slope of ``bending_y`` along the link."""
        return self._grid("shear_z")

    @cached_property
    def torsion(self) -> Array:
        """Torsional moment (t, xi) [N m], by the right hand about the link's axis."""
        return self._grid("torsion")

    @cached_property
    def bending_y(self) -> Array:
        """Bending moment about the link's y (t, xi) [N m], by the right hand."""
        return self._grid("bending_y")

    @cached_property
    def bending_z(self) -> Array:
        """Bending moment about the link's z (t, xi) [N m], by the right hand."""
        return self._grid("bending_z")

    def array(self, force: str) -> Array:
        """A force by its name (t, xi)."""
        return np.asarray(getattr(self, force))

    def _grid(self, force: str) -> Array:
        check_known("section force", [force], self.law.table.forces)
        return self.law.on_grid(force, self.xi)
