"""Deflection of a link at an instant: the largest transverse deflection along it, as an expression.

Strains of Timoshenko's beam, turn' = M/EI and across' = turn + V/GAs, are taken at Chebyshev's
nodes of each part between two stations, and the polynomials through them are integrated: exactly
where the cross-section is constant. In space turn_z' and turn_y' are those of bending about any
axes, and shear twists about the shear centre.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import casadi as ca
import numpy as np
from numpy.polynomial import chebyshev

from ..base.arrays import Array, Expression
from ..base.quantities import Column, Output
from ..base.scalars import column
from ..model.mechanism import Mechanism
from .strains import Moduli, moduli_of, strains
from .utilisation import Loaded, Part, most, sampled


def deflections(
    mechanism: Mechanism, name: str, columns: Mapping[Column, Expression], *, ends: bool
) -> dict[Column, Expression]:
    """The size of the deflection across a link that is largest along it [m].

    It counts from the straight line between the ``ends`` as they are, or from the link's axes at
    its base. Raises :class:`.DeclarationError` where its material has no elasticity, or its
    cross-section in space no torsion constant.
    """
    link = Loaded(mechanism.space, mechanism.links[name], columns)
    moduli = moduli_of(link.beam, f"output 'deflection:{name}'", space=link.space)
    curves = [_curve(link, *plane, moduli, ends=ends) for plane in _PLANES[link.space]]
    along = zip(*curves, strict=True)
    value = most(
        [
            value
            for pieces in along
            for value in sampled(partial(_size, pieces), len(pieces) * (pieces[0].size - 1))
        ]
    )
    if link.space:
        # A root whose slope is nothing where nothing bends.
        bends = value > 0.0
        value = bends * ca.sqrt(ca.if_else(bends, value, 1.0))
    return {Output("deflection", name, "across"): value}


def _size(pieces: Sequence[Array], x: Expression) -> Expression:
    """The size of a deflection at a place of a part; in space its square."""
    first, *others = (chebyshev.chebval(2.0 * x - 1.0, piece) for piece in pieces)
    return sum((other**2 for other in others), first**2) if others else ca.fabs(first)


_PLANES = {
    False: (("bending", "shear", 1.0),),
    True: (("bending_z", "shear_y", 1.0), ("bending_y", "shear_z", -1.0)),
}
"""Section forces of each plane of bending, and the sign with which the first turns the link."""


def _curve(
    link: Loaded, bending: str, shear: str, sign: float, moduli: Moduli, *, ends: bool
) -> list[Array]:
    """The deflection in a plane, part after part, by coefficients of Chebyshev's polynomials from 0
    to 1.
    """
    found: list[tuple[Part, Any]] = []
    turn, across = ca.SX(0.0), ca.SX(0.0)
    for part in link.parts:
        nodes, once, twice = _integrals(link.degree_along(part))
        each = [
            strains(link.at(part, x), {name: part.force(name, x) for name in part.forces}, moduli)
            for x in nodes
        ]
        bent = sign * column(strain[bending] for strain in each)
        sheared = column(strain[shear] for strain in each)
        length = link.link.length * part.width
        curve = length * (
            length * ca.mtimes(twice, bent) + ca.vertcat(ca.mtimes(once, sheared), 0.0)
        )
        curve[:2] += length * turn / 2
        curve[0] += across
        found.append((part, curve))
        # All of these polynomials are one at the end.
        turn, across = turn + length * ca.sum1(ca.mtimes(once, bent)), ca.sum1(curve)
    if ends:
        for part, curve in found:
            curve[0] -= across * (part.low + part.width / 2)
            curve[1] -= across * part.width / 2
    return [np.fromiter(ca.vertsplit(curve), object) for _, curve in found]


def _integrals(degree: int) -> tuple[list[float], ca.DM, ca.DM]:
    """Nodes from 0 to 1, and what makes of values there the integral from 0 of their polynomial,
    and the integral of that.
    """
    x = np.cos(math.pi * (2.0 * np.arange(degree + 1) + 1.0) / (2.0 * (degree + 1)))
    fit = np.linalg.inv(chebyshev.chebvander(x, degree))
    once = chebyshev.chebint(fit, lbnd=-1, scl=0.5, axis=0)
    twice = chebyshev.chebint(once, lbnd=-1, scl=0.5, axis=0)
    return ((x + 1.0) / 2.0).tolist(), ca.DM(once), ca.DM(twice)
