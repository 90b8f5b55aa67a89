"""Stresses in a beam's cross-sections, of its section forces: in numbers, arrays or expressions.

s = N/A + a y + b z with a Iz + b Iyz = -Mz and a Iyz + b Iy = My, for any axes; shear stresses are
those of :mod:`..beams`. In a planar mechanism bending is about z. All are linear in section forces.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from ..base.arrays import Array, Operand
from ..beams.beam import Beam, Notch
from ..beams.properties import Properties, smaller
from ..beams.shape import between

FORCES = {
    False: ("axial", "shear", "bending"),
    True: ("axial", "shear_y", "shear_z", "torsion", "bending_y", "bending_z"),
}
"""The section forces that stresses are linear in: in the plane, and in space."""

_PLACES = {False: (0, 1, 5), True: (0, 1, 2, 3, 4, 5)}
"""Places of the forces in :meth:`.Properties.rows`."""

KINDS = {"normal": (1.0, 0.0), "shear": (0.0, 1.0), "von_mises": (1.0, 3.0), "tresca": (1.0, 4.0)}
"""Weights of s^2 and t^2 in the square of each kind of stress."""

_SAMPLED = 65
"""Places at which the thinnest cross-section is sought where it changes."""

_DEEP = 4
"""Depth to which expressions of two fibres are compared."""


@dataclass(frozen=True, eq=False)
class Thinnest:
    """The least area of a beam, second moments and elastic moduli, each where it bends along y and
    along z.
    """

    area: float
    second: tuple[float, float]
    modulus: tuple[float, float]


@dataclass(frozen=True, eq=False)
class CrossSections:
    """The cross-sections of a beam along a link, and the stresses at their fibres."""

    beam: Beam
    space: bool

    @property
    def forces(self) -> tuple[str, ...]:
        """The names of the section forces that stresses are made of."""
        return FORCES[self.space]

    def properties(self, cell: int, u: Operand) -> Properties:
        """The properties between two breaks, at ratios ``u``."""
        course = self.beam.course
        first, last = course.cells[cell]
        share = (u - course.breaks[cell]) / (course.breaks[cell + 1] - course.breaks[cell])
        return between(first, last, share).properties(space=self.space)

    def stresses(
        self, p: Properties, fibres: Sequence[int], forces: Sequence[Any]
    ) -> tuple[Any, Any, Any]:
        """Normal stresses, and shear stresses along y and along z, at some fibres, of section
        forces: as expressions, (fibres,).
        """
        rows = [
            self._row(numbers)
            for part in zip(*(p.rows(p.fibres[k]) for k in fibres), strict=True)
            for numbers in part
        ]
        factors = ca.sparsify(ca.vertcat(*(ca.horzcat(*row) for row in rows)))
        normal, along_y, along_z = ca.vertsplit(
            ca.mtimes(factors, ca.vertcat(*forces)), len(fibres)
        )
        return normal, along_y, along_z

    def factors(self, cell: int, u: Array) -> Array:
        """Factors of stresses by section forces between two breaks, at ratios ``u``: (3, fibres,
        forces, u...).
        """
        p = self.properties(cell, u)
        found = np.zeros((3, len(p.fibres), len(self.forces), *np.shape(u)))
        for k, fibre in enumerate(p.fibres):
            for part, numbers in enumerate(p.rows(fibre)):
                for force, number in enumerate(self._row(numbers)):
                    found[part, k, force] = number
        return found

    def _row(self, numbers: Sequence[Operand]) -> list[Operand]:
        return [numbers[place] for place in _PLACES[self.space]]

    @cached_property
    def thinnest(self) -> Thinnest:
        """The thinnest that the beam is; second moments are principal ones where y and z are no
        principal axes.
        """
        every = []
        for cell, ((first, last), (low, high)) in enumerate(
            zip(self.beam.course.cells, itertools.pairwise(self.beam.course.breaks), strict=True)
        ):
            for u in [low] if first is last else np.linspace(low, high, _SAMPLED).tolist():
                p = self.properties(cell, u)
                straight = p.iyz.is_zero() if isinstance(p.iyz, ca.SX) else not p.iyz
                half = (p.iz + p.iy) / 2
                least = half - (((p.iz - p.iy) / 2) ** 2 + p.iyz**2) ** 0.5
                every.append((p.area, *((p.iz, p.iy) if straight else (least, least)), p.wz, p.wy))
        area, *others = (_least(values) for values in zip(*every, strict=True))
        return Thinnest(area, (others[0], others[1]), (others[2], others[3]))

    @cached_property
    def alone(self) -> list[list[int]]:
        """Fibres of each cell without those that equal another one."""
        return [self._differing(cell, lower=False) for cell in range(len(self.beam.course.cells))]

    @cached_property
    def needed(self) -> list[list[int]]:
        """Fibres of each cell without those that have the normal stress of another one, and no
        shear.
        """
        return [self._differing(cell, lower=True) for cell in range(len(self.beam.course.cells))]

    def _differing(self, cell: int, *, lower: bool) -> list[int]:
        first, last = self.beam.course.cells[cell]
        shapes = [first] if first is last else [first, last]
        every = [
            [self._plain(p.rows(f)) for f in p.fibres]
            for p in (s.properties(space=self.space) for s in shapes)
        ]
        numbers, kept = range(len(every[0])), list[int]()
        for k in numbers:
            alike = (all(_same(rows[k], rows[other]) for rows in every) for other in kept)
            below = (
                all(_below(rows[k], rows[other]) for rows in every)
                for other in numbers
                if lower and other != k
            )
            if not any(alike) and not any(below):
                kept.append(k)
        return kept

    def _plain(self, row: tuple[tuple[Any, ...], ...]) -> tuple[list[Any], list[Any]]:
        """Factors of a fibre's normal stress and shear stress: in the plane only the square of the
        latter matters.
        """
        if self.space:
            return [ca.SX(x) for x in row[0]], [ca.SX(x) for each in row[1:] for x in each]
        return [ca.SX(row[0][k]) for k in (0, 5)], [ca.SX(row[1][1] ** 2 + row[2][1] ** 2)]


def squared(stresses: Operand, weights: tuple[float, float]) -> Operand:
    """The square of a kind of stress by its ``weights``, of normal stress and shear stresses along
    y and along z.
    """
    (normal, *shears), (of_normal, of_shear) = stresses, weights
    return of_normal * normal**2 + of_shear * sum(shear**2 for shear in shears)


def concentration(notch: Notch | None, force: str) -> float:
    """The factor of a notch on the nominal stress of a section force; 1 where there is none."""
    if notch is None:
        return 1.0
    return (
        notch.axial
        if force == "axial"
        else notch.bending
        if force.startswith("bending")
        else notch.shear
    )


def _least(values: Sequence[float]) -> float:
    found = values[0]
    for value in values[1:]:
        found = smaller(found, value)
    return found


def _same(a: tuple[list[Any], list[Any]], b: tuple[list[Any], list[Any]]) -> bool:
    return all(
        ca.is_equal(x, y, _DEEP) for x, y in zip([*a[0], *a[1]], [*b[0], *b[1]], strict=True)
    )


def _below(a: tuple[list[Any], list[Any]], b: tuple[list[Any], list[Any]]) -> bool:
    """Return whether a fibre has the normal stress of another one, no shear stress, and the other
    some.
    """
    same = all(ca.is_equal(x, y, _DEEP) for x, y in zip(a[0], b[0], strict=True))
    return same and all(x.is_zero() for x in a[1]) and not all(x.is_zero() for x in b[1])
