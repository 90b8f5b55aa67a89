"""Deflections of links under their section forces: the elastic curve, and how far the ends move
against each other.

Strains are those of :mod:`.compliance`: turn' = M/EI, across' = turn + V/GAs, along' = N/EA, twist'
= T/GIt (Timoshenko, *Strength of Materials*, part I); in space turn_z' = Mz/EIz and across_y' =
turn_z + Vy/GAsy, turn_y' = My/EIy and across_z' = -turn_y + Vz/GAsz, for any axes of the
cross-section. They are integrated as polynomials between two marks: exactly, where the
cross-section is constant.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Literal

import numpy as np

from ...base.arguments import Numeric, public
from ...base.arrays import Array
from ...base.bernstein import interpolated, nodes, product, raised, slope, value, zeros
from ...engine.strains import Moduli, moduli_of
from ...errors import DeclarationError, check_known
from ...model.description import Description
from ...model.end_conditions import ends_of
from ..histories import Histories
from ..strength.all_parts import reason, strong_of
from ..strength.member import Member
from ..vector_sizes import largest
from .compliance import strains_along

Against = Literal["ends", "base"]

MOVES = {
    False: ("along", "across", "turn"),
    True: ("along", "across_y", "across_z", "twist", "turn_y", "turn_z"),
}
"""Displacements at a place of a link, in the plane and in space."""

_SLOPES = {
    "across": ("turn", 1.0, "shear"),
    "across_y": ("turn_z", 1.0, "shear_y"),
    "across_z": ("turn_y", -1.0, "shear_z"),
}
"""Slopes of transverse deflections: the turn, its sign, and the section force of shear strain."""


@dataclass(frozen=True)
class DeflectionPeak:
    """The deflection across a link that is largest in size [m], in the plane with its sign; its
    time [s] and ratio xi/l.
    """

    value: float
    t: float
    xi: float


@public
@dataclass(frozen=True, eq=False)
class Deflection:
    """Bending, stretch and twist of a link, over time and along it.

    ``against`` says from where deflections count. ``ends``: from the straight line between the
    link's ends as they are. ``base``: from the link's own axes at its base. Stretch and twist count
    from the base in both. Names are ``along``, ``across`` [m] and ``turn`` [rad], in space
    ``along``, ``across_y``, ``across_z``, ``twist``, ``turn_y``, ``turn_z``; methods raise
    :class:`.UnknownNameError` for any other.
    """

    member: Member
    moduli: Moduli
    against: Against

    @classmethod
    def of(
        cls, member: Member, description: Description, against: Against | None = None
    ) -> Deflection:
        """The deflection of a link, by default from where its joints hold it.

        Raises :class:`.DeclarationError` where its material has no elasticity, or its cross-section
        in space no torsion constant.
        """
        moduli = moduli_of(member.beam, f"deflection of '{member.link}'", space=member.space)
        by_joints: Against = "base" if "free" in ends_of(description, member.link) else "ends"
        return cls(member, moduli, against or by_joints)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the displacements at every place."""
        return MOVES[self.member.space]

    def __repr__(self) -> str:
        return (
            f"<Deflection of '{self.member.link}' against its {self.against}: {self.member.t.size}"
            " instants>"
        )

    def at(self, name: str, u: Numeric) -> Array:
        """Displacement by a name, at a ratio, or at ratios (t, ...), a row an instant."""
        check_known("deflection", [name], self.names)
        u = np.asarray(u, float)
        if not u.shape:
            u = np.full(self.member.t.size, float(u))
        if len(u) != self.member.t.size or not ((u >= 0.0) & (u <= 1.0)).all():
            raise DeclarationError(
                "deflection: expected ratios xi/l from 0 to 1, a row for each of"
                f" {self.member.t.size} instants"
            )
        return self._valued(self._curves[name], u)

    def grid(self, name: str, xi: Array | None = None) -> Array:
        """Displacement (t, xi) over ratios, by default those of the solution."""
        u = self.member.xi if xi is None else np.asarray(xi, float)
        return self.at(name, np.broadcast_to(u, (self.member.t.size, u.size)))

    @property
    def tip(self) -> Mapping[str, Array]:
        """Displacements of the tip, each (t,): relative to the base those of the ends against each
        other.
        """
        return {name: self.at(name, 1.0) for name in self.names}

    @property
    def base(self) -> Mapping[str, Array]:
        """Rotation of the base, each (t,), relative to the line through the ends."""
        return {name: self.at(name, 0.0) for name in self.names}

    def size(self, u: Array) -> Array:
        """The deflection across the link at ratios (t, ...): in the plane with its sign, in space
        its size.
        """
        if not self.member.space:
            return self.at("across", u)
        return np.hypot(self.at("across_y", u), self.at("across_z", u))

    def largest(self) -> tuple[Array, Array]:
        """The deflection across the link that is largest in size at every instant, and its ratio
        xi/l, both (t,).
        """
        edges, curves = self.member.edges, [self._curves[n] for n in self.names if n in _SLOPES]
        low, high = edges[:, :-1], edges[:, 1:]
        rate = slope(curves[0])
        if self.member.space:
            rate = np.asarray(sum(product(curve, slope(curve)) for curve in curves))
        inner = low + (high - low) * zeros(rate).places
        places = np.concatenate([edges, np.concatenate([*inner], axis=1)], axis=1)
        values = self.size(places)
        best = np.argmax(np.abs(values), axis=1)[:, None]
        return np.take_along_axis(values, best, 1)[:, 0], np.take_along_axis(places, best, 1)[:, 0]

    def peak(self) -> DeflectionPeak:
        """The largest of these, over the instants: along the link exactly, where the cross-section
        is constant.
        """
        values, places = self.largest()
        i = largest(values)
        return DeflectionPeak(float(values[i]), float(self.member.t[i]), float(places[i]))

    @cached_property
    def _strains(self) -> dict[str, Array]:
        """Ordinates (n + 1, t, parts) of the strains between two edges, by section forces."""
        member = self.member
        low, width = member.edges[:, :-1, None], np.diff(member.edges, axis=1)[:, :, None]
        u = (low + width * nodes(member.strain_degree)).reshape(member.t.size, -1)
        strains = strains_along(member, self.moduli, member.at(u), u)
        strains = strains.reshape(len(member.forces), *width.shape[:2], -1)
        ordinates = interpolated(np.moveaxis(strains, 3, 0))
        return {name: ordinates[:, k] for k, name in enumerate(member.forces)}

    @cached_property
    def _curves(self) -> dict[str, Array]:
        """Ordinates (n + 1, t, parts) of all displacements between two edges."""
        strains, edges, length = self._strains, self.member.edges, self.member.law.length
        turns = ("bending_y", "bending_z") if self.member.space else ("bending",)
        found = {"along": self._sum(strains["axial"])}
        if self.member.space:
            found["twist"] = self._sum(strains["torsion"])
        for bending in turns:
            found[bending.replace("bending", "turn")] = self._sum(strains[bending])
        for across, (turn, sign, shear) in _SLOPES.items():
            if turn in found:
                turned = sign * found[turn]
                found[across] = self._sum(turned + raised(strains[shear], len(turned) - 1))
        if self.against == "base":
            return found
        for across, (turn, sign, _) in _SLOPES.items():
            if across in found:
                tip = found[across][-1, :, -1:]
                share = np.linspace(0.0, 1.0, len(found[across]))[:, None, None]
                found[turn] = found[turn] - sign * tip / length
                found[across] = found[across] - tip * (
                    edges[:, :-1] + share * np.diff(edges, axis=1)
                )
        return found

    def _sum(self, ordinates: Array) -> Array:
        """Integrate polynomials between two edges from the base."""
        parts = self.member.law.length * np.diff(self.member.edges, axis=1) / len(ordinates)
        found = np.zeros((len(ordinates) + 1, *parts.shape))
        np.cumsum(ordinates * parts, axis=0, out=found[1:])
        found[:, :, 1:] += np.cumsum(found[-1], axis=1)[:, :-1]
        return found

    def _valued(self, ordinates: Array, u: Array) -> Array:
        """Values of polynomials between two edges at ratios (t, ...)."""
        places, edges = u.reshape(len(u), -1), self.member.edges
        index = np.sum(places[:, :, None] >= edges[:, None, 1:-1], axis=2)
        low, high = (np.take_along_axis(edges, index + k, 1) for k in (0, 1))
        x = np.divide(places - low, high - low, out=np.zeros_like(places), where=high > low)
        chosen = np.take_along_axis(ordinates, index[None], 2)
        return np.asarray(value(chosen, x[None])[0].reshape(u.shape))


def deflection(solution: Histories, link: str, against: Against | None = None) -> Deflection:
    """Quasi-static deflection of a link under its section forces: see :class:`Deflection`.

    By default deflections count from the line between the ends where joints hold both
    (:func:`..declare.held.ends_of`), else from the link's axes at its base.

    Parameters
    ----------
    solution : Solution
        Has the section forces of the link.
    link : str
        Name of a link with a beam.
    against : {"ends", "base"}, optional
        Count from the line between the ends, or from the axes at the base.

    Returns
    -------
    Deflection
        Displacements [m] and rotations [rad] along the link.

    Raises
    ------
    DeclarationError
        If the link has no beam, its sections were not evaluated, its forces are indeterminate, its
        material has no elasticity, or there is no formula for the torsion of its cross-section.
    """
    if against not in (None, "ends", "base"):
        raise DeclarationError(
            f"deflection of '{link}': expected against='ends' or 'base', got {against!r}"
        )
    return Deflection.of(Member.of(solution, link), solution.description, against)


def bending_of(solution: Histories) -> tuple[str, ...]:
    """The links whose deflections were evaluated."""
    links = strong_of(solution, "elasticity")
    return tuple(link for link in links if not reason(partial(deflection, solution), link))
