"""A link of a solution as an elastic beam, in numbers: its strains (:mod:`.engine.strains`),
and where they are summed.
"""

from __future__ import annotations

import numpy as np

from ...base.arrays import Array
from ...engine.strains import Moduli, strains
from ..strength.member import Member


def strains_along(member: Member, moduli: Moduli, forces: Array, u: Array) -> Array:
    """The strains of section forces (forces, t, n) of a link with ``moduli`` [Pa] at ratios (t, n):
    in the order of the forces.
    """
    found = np.empty_like(forces)
    for here, properties in member.properties(u):
        forces_here = dict(zip(member.forces, forces[:, here], strict=True))
        each = strains(properties, forces_here, moduli)
        for k, name in enumerate(member.forces):
            found[k, here] = each[name]
    return found


def nodes(member: Member) -> tuple[Array, Array]:
    """Gauss's nodes along a link at every instant, ratios and weights [m], (t, n), that sum the
    product of the link's section forces with linear ones exactly.

    Of a cross-section that changes it is summed as closely as polynomials give its properties, to
    1e-13.
    """
    x, w = np.polynomial.legendre.leggauss((member.strain_degree + 1) // 2 + 1)
    low, width = member.edges[:, :-1, None], np.diff(member.edges, axis=1)[:, :, None]
    u = (low + width * (x + 1.0) / 2.0).reshape(member.t.size, -1)
    return u, (member.law.length * width * w / 2.0).reshape(member.t.size, -1)
