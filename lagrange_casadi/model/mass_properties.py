"""Declarations of a link's mass: even, by a density, by a beam, or by mass, centre and inertia."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TypeAlias

import casadi as ca

from ..errors import DeclarationError, check_kind
from .beams.beam import Beam
from .beams.shape import UNITS
from .declared_parts import Expression, Link, PointMass, RigidMass
from .directions import Reference, rotated, tensor
from .link_density import Density, Slices, uniform
from .ownership import Ownership

Masses: TypeAlias = tuple[Expression, Density | None, Expression, Expression, bool]
"""Mass, density, centre and inertia of a link as given, and whether any inertia is accepted."""

ALL = "all"
"""Name of the mass of everything that moves."""

UNDECLARED = RigidMass(math.nan)
"""The mass of a link of which none is declared so far."""


def mass_properties_of(
    own: Ownership,
    what: str,
    masses: Masses,
    beam: Beam | None,
    reference: Reference | None,
) -> Density | RigidMass:
    """The mass of a link by one of the ways, or none so far. A centre and moments of inertia are on
    the link's axes, or where there is a ``reference`` on the ground's.

    Raises :class:`DeclarationError` for more than one of the ways.
    """
    mass, density, centre, inertia, accepted = masses
    if all(one is None for one in (mass, density, centre, inertia, beam)):
        return UNDECLARED
    if beam is not None and centre is None and mass is None and density is None:
        return Density(beam.course.breaks, tuple(map(tuple, beam.masses())), per_length=True)
    if (mass is None) == (density is None):
        raise DeclarationError(f"{what}: expected either mass= or density=")
    if beam is not None and centre is not None:
        raise DeclarationError(
            f"{what}: beam= excludes centre= and inertia=, because a link with these has no"
            " sections"
        )
    if (centre is None) != (inertia is None) or (centre is not None and mass is None):
        raise DeclarationError(f"{what}: expected mass=, centre= and inertia= together")
    if density is not None:
        check_kind(what, density, "a density of lagrange_casadi.density", Density)
        if density.slices is not None and not own.declared.space:
            raise DeclarationError(
                f"{what}: second moments of slices are for links in space; leave them out in a"
                " plane"
            )
        slices, unit = density.slices, "kg/m" if density.per_length else "kg"
        if slices is not None:
            slices = Slices(
                *(_checked(own, m, f"{what}: second moments", "kg m") for m in slices.each)
            )
        return replace(_checked(own, density, f"{what}: density", unit), slices=slices)
    if centre is not None:
        place, moments = own.vector(f"{what}: centre", centre, "m"), tensor(what, inertia, own)
        if reference is not None:
            place, moments = reference.local(place), rotated(moments, reference)
        return RigidMass(own.expression(f"{what}: mass", mass, "kg"), place, moments, accepted)
    return uniform(own.expression(f"{what}: mass", mass, "kg"))


def beam_of(own: Ownership, what: str, beam: Beam | None) -> Beam | None:
    """Beam of a link, with its dimensions checked.

    Raises :class:`DeclarationError` for what is no beam.
    """
    if beam is None:
        return None
    check_kind(what, beam, "a beam of lagrange_casadi.beams", Beam)
    return beam.mapped(
        lambda name, value: own.expression(
            f"{what}: {name} of its cross-section", value, UNITS.get(name, "m")
        )
    )


def _checked(own: Ownership, density: Density, what: str, unit: str) -> Density:
    cells = tuple(tuple(own.expression(what, c, unit) for c in cell) for cell in density.cells)
    return Density(density.breaks, cells, density.per_length)


def second_moments(inertia: Sequence[Sequence[Expression]]) -> list[list[float]]:
    """J_ij, the integral of r_i r_j dm, of moments of inertia I [kg m^2] in three rows: tr(I) / 2 -
    I.
    """
    (ixx, ixy, ixz), (_, iyy, iyz), (_, _, izz) = inertia
    return [
        [(iyy + izz - ixx) / 2, -ixy, -ixz],
        [-ixy, (ixx + izz - iyy) / 2, -iyz],
        [-ixz, -iyz, (ixx + iyy - izz) / 2],
    ]


def mass_of(body: Link | PointMass) -> ca.SX:
    """The mass of a link or a point mass [kg]."""
    if isinstance(body, PointMass):
        return ca.SX(body.mass)
    if isinstance(body.mass, Density):
        return ca.SX(body.mass.tails(0.0, body.length)[0])
    return ca.SX(body.mass.mass)
