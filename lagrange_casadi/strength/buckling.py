"""Columns: Euler's and Johnson's critical loads, the interaction with bending, and effective lengths by joints.

Johnson's parabola joins Euler's curve at half the yield strength (Shigley, *Mechanical Engineering Design*, 9th edition, sections
4-12 and 4-13). Bending adds to compression as N/N_cr + M/(M_yield (1 - N/N_Euler)) = 1, about both axes (Timoshenko and Gere,
*Theory of Elastic Stability*, sections 1.11 and 1.13, for moments that are even along the link, the worst). Of a link whose
cross-section changes, the least second moment, area and modulus count for all of it.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arguments import Numeric, Positive, public
from ..base.arrays import Array
from ..beams.beam import SLIGHT
from .member import Member

_HALVINGS = 80
_LOOKED_AT = 65


@public
def critical_stress(slenderness: Numeric, elasticity: Positive, strength: Positive) -> Any:
    """The stress at which a column of a slenderness, effective length over radius of gyration, fails: Euler's or Johnson's [Pa]."""
    s = np.asarray(slenderness, float)
    with np.errstate(divide="ignore"):
        euler = np.pi**2 * elasticity / s**2
    return np.where(euler <= strength / 2, euler, strength - (strength * s / (2 * np.pi)) ** 2 / elasticity)


@dataclass(frozen=True)
class Column:
    """A link as a column, where it bends along y and where it bends along z: effective lengths over its own, slenderness, Euler's
    load and the critical one [N], and the moment at which its outermost fibre yields [N m].
    """

    effective: tuple[float, float]
    slenderness: tuple[float, float]
    euler: tuple[float, float]
    critical: tuple[float, float]
    yielding: tuple[float, float]


def column(member: Member, effective: tuple[float, float]) -> Column:
    """A link as a column. Raises :class:`.DeclarationError` where its material lacks elasticity or yield strength."""
    elasticity, strength = member.beam.material.needs("buckling", "elasticity", "yield_strength")
    area, second, modulus = math.inf, [math.inf] * 2, [math.inf] * 2
    breaks = member.beam.course.breaks
    for k, (a, b) in enumerate(itertools.pairwise(breaks)):
        p = member.properties(k, np.linspace(a, b, _LOOKED_AT))
        # Principal axes, where y and z are none.
        half, turned = (p.iz + p.iy) / 2, np.hypot((p.iz - p.iy) / 2, p.iyz)
        i = (p.iz, p.iy) if not np.any(p.iyz) else (half - turned, half - turned)
        area = min(area, float(np.min(p.area)))
        second = [min(old, float(np.min(new))) for old, new in zip(second, i, strict=True)]
        modulus = [min(old, float(np.min(new))) for old, new in zip(modulus, (p.wz, p.wy), strict=True)]
    lengths = [k * member.law.length for k in effective]
    slender = [length * math.sqrt(area / i) for length, i in zip(lengths, second, strict=True)]
    euler = [math.pi**2 * elasticity * i / length**2 for length, i in zip(lengths, second, strict=True)]
    critical = [float(critical_stress(s, elasticity, strength)) * area for s in slender]
    pairs = (effective, tuple(slender), tuple(euler), tuple(critical), tuple(w * strength for w in modulus))
    return Column(*((float(a), float(b)) for a, b in pairs))


def load_factor(compression: Array, moments: tuple[Array, Array], of: Column) -> Array:
    """By how much compression and moments may grow together until the column fails; infinite where nothing is compressed.

    Compression of less than 1e-6 of the critical load counts as none.
    """
    n, (mz, my) = np.maximum(compression, 0.0), moments
    share = n / min(of.critical)
    low, high = np.zeros_like(n), np.full_like(n, np.inf)
    with np.errstate(divide="ignore", invalid="ignore"):
        high = np.minimum(1.0 / share, min(of.euler) / n)

        def fails(factor: Array) -> Array:
            bent = sum(
                factor * np.abs(m) / limit / (1.0 - factor * n / euler)
                for m, limit, euler in zip((mz, my), of.yielding, of.euler, strict=True)
            )
            return np.asarray(~(factor * share + bent <= 1.0))

        there = share > SLIGHT
        low, high = np.where(there, low, 0.0), np.where(there, high, 0.0)
        for _ in range(_HALVINGS):
            middle = (low + high) / 2
            beyond = fails(middle)
            low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
    return np.where(there, low, np.inf)
