"""How a link gives way to its section forces: the strains of a straight beam, and its strain energy.

Axial strain N/EA, curvatures by both bendings about any axes, twist T/GIt about the shear centre, and the shear strains V/GAs of
Timoshenko's beam, each along y and z (Timoshenko, *Strength of Materials*, part I; Cowper, *The Shear Coefficient in
Timoshenko's Beam Theory*, J. Appl. Mech. 33, 1966). Warping that is held adds nothing. In a planar mechanism bending is in its
plane.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..base.arrays import Array
from ..errors import DeclarationError
from ..strength.member import Member

_PLANE = (0, 1, 5)


@dataclass(frozen=True, eq=False)
class Compliance:
    """A link of a solution as an elastic beam, by its elasticity and shear modulus [Pa]."""

    member: Member
    elasticity: float
    shear_modulus: float

    @classmethod
    def of(cls, member: Member, what: str) -> Compliance:
        """A link as an elastic beam.

        Raises :class:`.DeclarationError` where its material has no elasticity, or its cross-section in space no torsion constant,
        which ``what`` needs.
        """
        elasticity, shear_modulus = member.beam.material.needs(what, "elasticity", "shear_modulus")
        if member.space:
            for first, _ in member.beam.course.cells:
                if first.properties().torsion is None:
                    how = "give its properties by beams.given, with its torsion"
                    raise DeclarationError(f"{what}: for torsion of a {first.kind} there is no formula; {how}")
        return cls(member, elasticity, shear_modulus)

    def root(self, index: int, u: Array) -> Array:
        """Factors of section forces between two breaks, at ratios ``u`` (n,), whose squares add up to twice the strain energy of a
        unit of length: (strains, forces, n), or (strains, forces, 1) where the cross-section is constant.
        """
        p = self.member.cross.properties(index, u)
        e, g = self.elasticity, self.shear_modulus
        numbers = (p.area, p.iy, p.iz, p.iyz, p.torsion, p.shear_y, p.shear_z, p.centre_y, p.centre_z)
        area, iy, iz, iyz, torsion, *rest = np.broadcast_arrays(*(np.atleast_1d(np.inf if x is None else x) for x in numbers))
        shear_y, shear_z, centre_y, centre_z = rest
        found = np.zeros((6, 6, *area.shape))
        found[0, 0] = 1.0 / np.sqrt(e * area)
        found[1, 1], found[2, 2] = 1.0 / np.sqrt(g * shear_y), 1.0 / np.sqrt(g * shear_z)
        # Section forces act at the centroid, torsion counts from the shear centre.
        found[3, 3] = 1.0 / np.sqrt(g * torsion)
        found[3, 1], found[3, 2] = centre_z * found[3, 3], -centre_y * found[3, 3]
        found[4, 4] = np.sqrt(iz / (e * (iy * iz - iyz**2)))
        found[4, 5] = found[4, 4] * iyz / iz
        found[5, 5] = 1.0 / np.sqrt(e * iz)
        if self.member.space:
            return found
        plane = found[_PLANE, :][:, _PLANE]
        plane[2, 2] = np.hypot(found[4, 5], found[5, 5])
        return plane

    def scaled(self, forces: Array, index: npt.NDArray[np.intp], u: Array) -> Array:
        """Section forces (forces, ..., t, n) at ratios (t, n) in cells ``index`` (t, n), times :meth:`root`, of the same shape."""
        found = np.empty_like(forces)
        for cell in range(len(self.member.beam.course.cells)):
            here = index == cell
            if here.any():
                found[..., here] = np.einsum("rfn,f...n->r...n", self.root(cell, u[here]), forces[..., here])
        return found

    def strains(self, forces: Array, index: npt.NDArray[np.intp], u: Array) -> Array:
        """The strains of section forces (forces, t, n): axial, shears, twist and curvatures, in the order of the forces."""
        found = np.empty_like(forces)
        for cell in range(len(self.member.beam.course.cells)):
            here = index == cell
            if here.any():
                root = self.root(cell, u[here])
                found[:, here] = np.einsum("rgn,rfn,fn->gn", root, root, forces[:, here])
        return found


def sorted_edges(t: Array, marks: list[Array], fixed: list[float]) -> Array:
    """Ratios (t, m) from 0 to 1 between which a link is smooth, in order at every instant."""
    still = np.zeros_like(t)
    return np.sort(np.stack([*marks, *(still + ratio for ratio in fixed)], axis=1), axis=1)


@dataclass(frozen=True, eq=False)
class Nodes:
    """Gauss's nodes along a link at every instant: ratios ``u``, weights [m], and the cell of the cross-section, each (t, n)."""

    u: Array
    weights: Array
    index: npt.NDArray[np.intp]

    @classmethod
    def between(cls, edges: Array, breaks: tuple[float, ...], count: int, length: float) -> Nodes:
        """``count`` nodes between two edges each, of a link with ``breaks`` of its cross-section."""
        x, w = np.polynomial.legendre.leggauss(count)
        low, width = edges[:, :-1, None], np.diff(edges, axis=1)[:, :, None]
        u = (low + width * (x + 1.0) / 2.0).reshape(len(edges), -1)
        weights = (length * width * w / 2.0).reshape(len(edges), -1)
        index = np.clip(np.searchsorted(np.array(breaks[1:-1]), u, side="right"), 0, len(breaks) - 2)
        return cls(u, weights, index)


def nodes(member: Member, more: int = 0) -> Nodes:
    """Nodes that sum the product of a link's section forces with linear ones exactly; ``more`` than that between two marks.

    Of a cross-section that changes it is summed as closely as polynomials give its properties, to 1e-13.
    """
    fixed = [0.0, 1.0, *(cell.high for cell in member.cells[:-1])]
    changing = max(cell.degree for cell in member.cells)
    count = (member.degree + 1 + (changing + 6 if changing else 0)) // 2 + 1 + more
    return Nodes.between(sorted_edges(member.t, member.marks, fixed), member.beam.course.breaks, count, member.law.length)
