"""Properties of a cross-section in numbers or expressions: area, second moments, torsion, shear,
and the fibres at which stress is computed.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from ...base.arrays import Operand
from ...base.brief import Brief

ALONG_Y, ALONG_Z = ((1, "+y"), (-1, "-y")), ((1, "+z"), (-1, "-z"))
"""Both sides of a cross-section along an axis: a sign, and its name in the names of fibres."""

POISSON = 0.3
"""Poisson's ratio in the coefficients of shear: from 0 to 0.5 they change by a twentieth."""


@dataclass(frozen=True, eq=False)
class Fibre:
    """A place of a cross-section whose stress is looked at: ``y`` and ``z`` from the centroid [m].

    ``along_y`` and ``along_z`` are the shear stresses there, along y and along z, for a unit each
    of the shear force along y, the shear force along z [1/m^2], and the torsional moment about the
    shear centre [1/m^3].
    """

    name: str
    y: Any
    z: Any
    along_y: tuple[Any, Any, Any] = (0.0, 0.0, 0.0)
    along_z: tuple[Any, Any, Any] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False, repr=False)
class Properties(Brief):
    """A cross-section about its centroid, on the link's axes y and z, in SI units.

    ``iz`` is the integral of y^2, which bending in the plane of a planar mechanism sees, ``iy``
    that of z^2, ``iyz`` that of y z. ``torsion`` is Saint-Venant's constant, None where it is not
    known. ``shear_y`` and ``shear_z`` are the areas of Timoshenko's beam. The shear centre is at
    (``centre_y``, ``centre_z``).
    """

    area: Any
    iy: Any
    iz: Any
    fibres: tuple[Fibre, ...]
    iyz: Any = 0.0
    torsion: Any = None
    shear_y: Any = None
    shear_z: Any = None
    centre_y: Any = 0.0
    centre_z: Any = 0.0

    def rows(self, fibre: Fibre) -> tuple[tuple[Operand, ...], ...]:
        """Return the stresses at a fibre by unit section forces.

        Section forces act at the centroid, torsion counts from the shear centre.

        Parameters
        ----------
        fibre : Fibre
            The fibre.

        Returns
        -------
        tuple (3, 6)
            Normal stress, and shear stress along y and along z [Pa], each by axial force, two
            shears, torsion and two bendings [N, N m].
        """
        whole = self.iz * self.iy - self.iyz**2
        about_y = (self.iz * fibre.z - self.iyz * fibre.y) / whole
        about_z = (self.iyz * fibre.z - self.iy * fibre.y) / whole
        sheared = [
            (0.0, by_y + self.centre_z * twist, by_z - self.centre_y * twist, twist, 0.0, 0.0)
            for by_y, by_z, twist in (fibre.along_y, fibre.along_z)
        ]
        return ((1.0 / self.area, 0.0, 0.0, 0.0, about_y, about_z), *sheared)

    @property
    def wz(self) -> Operand:
        """The elastic modulus about z: iz over the largest distance of a fibre along y."""
        return self.iz / _farthest([fibre.y for fibre in self.fibres])

    @property
    def wy(self) -> Operand:
        """The elastic modulus about y: iy over the largest distance of a fibre along z."""
        return self.iy / _farthest([fibre.z for fibre in self.fibres])


def symbolic(*values: Operand) -> bool:
    """True if any of the values is an expression."""
    return any(isinstance(value, (ca.SX, ca.MX)) for value in values)


def larger(a: Operand, b: Operand) -> Operand:
    """The larger of two, of numbers, arrays or expressions."""
    return ca.fmax(a, b) if symbolic(a, b) else np.maximum(a, b)


def smaller(a: Operand, b: Operand) -> Operand:
    """The smaller of two."""
    return ca.fmin(a, b) if symbolic(a, b) else np.minimum(a, b)


def chosen(a: Operand, b: float, first: Operand, second: float) -> Operand:
    """``first`` where a is b or more, else ``second``."""
    if symbolic(a, b, first, second):
        return ca.if_else(a >= b, first, second)
    return np.where(a >= b, first, second)


def exponential(x: Operand) -> Operand:
    """The exponential."""
    return ca.exp(x) if symbolic(x) else np.exp(x)


def _farthest(places: list[Operand]) -> Operand:
    return functools.reduce(larger, map(abs, places))
