"""Declarations of a link's mass: even, by a density, by a beam, or by mass, centre and inertia."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import TypeAlias

import casadi as ca

from ..base.vectors import ZERO
from ..errors import DeclarationError
from .beams.beam import Beam
from .declared_parts import Expression, Link, PointMass, RigidMass, Vector
from .link_density import Density, Slices, uniform

Inertia: TypeAlias = tuple[Vector, Vector, Vector]
"""Moments of inertia [kg m^2], three rows of a matrix."""

Rigid: TypeAlias = Callable[[Expression, Expression], tuple[Vector, Inertia]]
"""Reader of a centre and moments of inertia."""

ALL = "all"
"""Name of the mass of everything that moves."""

UNDECLARED = RigidMass(math.nan, ZERO, (ZERO, ZERO, ZERO))
"""The mass of a link of which none is declared so far."""


def mass_properties_of(
    what: str,
    mass: Expression,
    density: Density | None,
    centre: tuple[Expression, ...] | None,
    inertia: Expression,
    checked: Callable[..., Expression],
    rigid: Rigid | None,
    beam: Beam | None,
) -> Density | RigidMass:
    """The mass of a link by one of the ways, or none so far; ``checked`` takes what is said of an
    expression, and the expression.

    ``rigid`` reads a centre and moments of inertia; by default those of a plane, two places and one
    moment.

    Raises :class:`DeclarationError` for more than one of the ways.
    """
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
        if not isinstance(density, Density):
            raise DeclarationError(
                f"{what}: expected a density of lagrange_casadi.density, got {density!r}"
            )
        if density.slices is not None and rigid is None:
            raise DeclarationError(
                f"{what}: second moments of slices are for links in space; leave them out in a"
                " plane"
            )
        unit = "kg/m" if density.per_length else "kg"
        checked_density = _checked(density, f"{what}: density", checked, unit)
        if density.slices is None:
            return checked_density
        moments = (
            _checked(moment, f"{what}: second moments", checked, "kg m")
            for moment in density.slices.each
        )
        return replace(checked_density, slices=Slices(*moments))
    if centre is not None:
        place, about = (rigid or partial(_in_plane, what, checked))(centre, inertia)
        return RigidMass(checked(f"{what}: mass", mass, "kg"), place, about)
    return uniform(checked(f"{what}: mass", mass, "kg"))


def _in_plane(
    what: str, checked: Callable[..., Expression], centre: Expression, inertia: Expression
) -> tuple[Vector, Inertia]:
    """A centre of two places, and one moment of inertia, about z."""
    if not isinstance(centre, (tuple, list)) or len(centre) != 2:
        raise DeclarationError(f"{what}: centre must be two components (x, y), got {centre!r}")
    x, y = (checked(f"{what}: centre", c, "m") for c in centre)
    return (x, y, 0.0), (ZERO, ZERO, (0.0, 0.0, checked(f"{what}: inertia", inertia, "kg m^2")))


def beam_of(what: str, beam: Beam | None, checked: Callable[..., Expression]) -> Beam | None:
    """Beam of a link, with its dimensions checked.

    Raises :class:`DeclarationError` for what is no beam.
    """
    if beam is None:
        return None
    if not isinstance(beam, Beam):
        raise DeclarationError(f"{what}: expected a beam of lagrange_casadi.beams, got {beam!r}")
    return beam.mapped(lambda name, value: checked(f"{what}: {name} of its cross-section", value))


def _checked(density: Density, what: str, checked: Callable[..., Expression], unit: str) -> Density:
    cells = tuple(tuple(checked(what, c, unit) for c in cell) for cell in density.cells)
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
