"""A link of a solution as an elastic beam, in numbers: its strains (:mod:`.engine.strains`),
and where they are summed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...base.arrays import Array
from ...base.brief import Brief
from ...engine.strains import Moduli, moduli_of, strains
from ..strength.member import Member


@dataclass(frozen=True, eq=False, repr=False)
class Compliance(Brief):
    """A link of a solution as an elastic beam, by the moduli of its material [Pa]."""

    member: Member
    moduli: Moduli

    @classmethod
    def of(cls, member: Member, what: str) -> Compliance:
        """A link as an elastic beam.

        Raises :class:`.DeclarationError` where its material has no elasticity, or its cross-section
        in space no torsion constant, which ``what`` needs.
        """
        return cls(member, moduli_of(member.beam, what, space=member.space))

    def strains(self, forces: Array, u: Array) -> Array:
        """The strains of section forces (forces, t, n) at ratios (t, n): in the order of the
        forces.
        """
        found = np.empty_like(forces)
        for here, properties in self.member.properties(u):
            forces_here = dict(zip(self.member.forces, forces[:, here], strict=True))
            each = strains(properties, forces_here, self.moduli)
            for k, name in enumerate(self.member.forces):
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
