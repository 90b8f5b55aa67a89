"""Columns: Euler's and Johnson's critical loads, and the interaction with bending; in numbers,
arrays or expressions.

Johnson's parabola joins Euler's curve at half the yield strength (Shigley, *Mechanical Engineering
Design*, 9th edition, sections 4-12 and 4-13). Bending adds to compression as N/N_cr + M/(M_yield (1
- N/N_Euler)) = 1, about both axes (Timoshenko and Gere, *Theory of Elastic Stability*, sections
1.11 and 1.13, for moments that are even along the link, the worst). Of a link whose cross-section
changes, the least second moment, area and modulus count for all of it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..base.arguments import Numeric, Stress, public
from ..base.arrays import Array, Expression, Operand
from ..model.beams.beam import SLIGHT
from ..model.beams.properties import chosen, larger, smaller, symbolic
from .section_stress import CrossSections

_ROUNDS, _TINY = 8, 1e-12
"""Steps of Newton's method for bending about two axes, and how near Euler's load they begin."""


@public
def critical_stress(slenderness: Numeric, elasticity: Stress, strength: Stress) -> Expression:
    """Return the stress at which a column fails, by Euler's or Johnson's formula.

    Parameters
    ----------
    slenderness : float, array or casadi.SX
        Effective length over radius of gyration.
    elasticity : float
        Young's modulus [Pa].
    strength : float
        Yield strength [Pa].

    Returns
    -------
    float, array or casadi.SX
        The critical stress [Pa]: pi^2 E/slenderness^2 (Euler), or Johnson's parabola above half the
        yield strength.
    """
    with np.errstate(divide="ignore"):
        return _critical(np.pi**2 * elasticity / np.asarray(slenderness, float) ** 2, strength)


@dataclass(frozen=True)
class Column:
    """A link as a column, where it bends along y and where it bends along z: effective lengths over
    its own, slenderness, Euler's load and the critical one [N], and the moment at which its
    outermost fibre yields [N m].
    """

    effective: tuple[Any, Any]
    slenderness: tuple[Any, Any]
    euler: tuple[Any, Any]
    critical: tuple[Any, Any]
    yield_moment: tuple[Any, Any]

    @classmethod
    def of(cls, cross: CrossSections, length: Operand, effective: tuple[float, float]) -> Column:
        """Return a link as a column.

        Parameters
        ----------
        cross : CrossSections
            Its cross-sections.
        length : float or casadi.SX
            Its length [m].
        effective : tuple of float
            Effective lengths over its own, for bending along y and along z.

        Returns
        -------
        Column
            The column.

        Raises
        ------
        DeclarationError
            If its material lacks elasticity or yield strength.
        """
        elasticity, strength = cross.beam.material.needs("buckling", "elasticity", "yield_strength")
        area, seconds, moduli = cross.thinnest

        def column(k: int) -> tuple[Operand, ...]:
            effective_length, second = effective[k] * length, seconds[k]
            euler = math.pi**2 * elasticity * second / effective_length**2
            slenderness = effective_length * (area / second) ** 0.5
            critical = _critical(euler, strength * area)
            yield_moment = moduli[k] * strength
            numbers = (effective[k], slenderness, euler, critical, yield_moment)
            return tuple(number if symbolic(number) else float(number) for number in numbers)

        return cls(*zip(column(0), column(1), strict=True))


def used(column: Column, compression: Operand, moments: Sequence[Operand]) -> Operand:
    """Utilisation of a column by compression and moments, about z and in space about y: one over
    the factor of safety.

    That is the largest u with N/(N_cr u) + M_z/(M_y,z (u - N/N_e,z)) + M_y/(M_y,y (u - N/N_e,y)) =
    1. Compression of less than 1e-6 of the critical load counts as none.
    """
    compressed = larger(compression, 0.0)
    share = compressed / smaller(*column.critical)
    shares = [compressed / euler for euler in column.euler]
    bent = [moment / limit for moment, limit in zip(moments, column.yield_moment, strict=False)]
    found = larger(*shares)
    for euler, moment in zip(shares, bent, strict=False):
        found = larger(found, _alone(share, euler, moment))
    if len(bent) > 1:
        # From the left, where it is convex and falls, Newton's method rises to the solution.
        for _ in range(_ROUNDS):
            residuals = [larger(found - euler, _TINY * found) for euler in shares]
            over = (
                share / found
                + sum(b / residual for b, residual in zip(bent, residuals, strict=True))
                - 1.0
            )
            slope = share / found**2 + sum(
                b / residual**2 for b, residual in zip(bent, residuals, strict=True)
            )
            found = found + larger(over / slope, 0.0)
    return chosen(share, SLIGHT, found, 0.0)


def _critical(euler: Operand, crushing: Operand) -> Operand:
    """The critical load of Euler's load and the one at which all of the cross-section yields."""
    return chosen(crushing / 2, euler, euler, crushing * (1.0 - crushing / (4.0 * euler)))


def _alone(a: Array, c: Array, b: Array) -> Operand:
    """The larger u of a/u + b/(u - c) = 1."""
    total = a + b + c
    return (total + larger(total * total - 4.0 * a * c, 0.0) ** 0.5) / 2
