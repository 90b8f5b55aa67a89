"""Strains of a link at an instant, as a beam of Timoshenko's, as expressions: see :mod:`..elastic.compliance`."""

from __future__ import annotations

from typing import Any

from ..errors import DeclarationError
from .strength import Loaded, Part


def moduli(link: Loaded, what: str) -> tuple[float, ...]:
    """Elasticity and shear modulus [Pa].

    Raises :class:`.DeclarationError` where one is not there, or in space no torsion constant, which ``what`` needs.
    """
    found = link.beam.material.needs(what, "elasticity", "shear_modulus")
    if not link.told:
        kind = next(shape.kind for shape in link.course.shapes() if shape.properties().torsion is None)
        how = "give its properties by beams.given, with its torsion"
        raise DeclarationError(f"{what}: for torsion of a {kind} there is no formula; {how}")
    return found


def strains(link: Loaded, part: Part, x: float, elasticity: float, shear_modulus: float) -> dict[str, Any]:
    """By the names of section forces what each strains, for a unit of the link's length, at a place of a part from 0 to 1."""
    p = link.at(part, x)
    force = {name: part.force(name, x) for name in part.forces}
    whole = elasticity * (p.iy * p.iz - p.iyz**2)
    sheared = {
        name: 0.0 if area is None else force[name] / (shear_modulus * area)
        for name, area in (("shear", p.shear_y), ("shear_y", p.shear_y), ("shear_z", p.shear_z))
        if name in force
    }
    found = {"axial": force["axial"] / (elasticity * p.area), **sheared}
    if not link.space:
        return found | {"bending": force["bending"] * p.iy / whole}
    # Section forces act at the centroid, torsion counts from the shear centre.
    twist = (force["torsion"] + p.centre_z * force["shear_y"] - p.centre_y * force["shear_z"]) / (shear_modulus * p.torsion)
    about_y, about_z = force["bending_y"], force["bending_z"]
    return found | {
        "shear_y": sheared["shear_y"] + p.centre_z * twist,
        "shear_z": sheared["shear_z"] - p.centre_y * twist,
        "torsion": twist,
        "bending_y": (p.iz * about_y + p.iyz * about_z) / whole,
        "bending_z": (p.iyz * about_y + p.iy * about_z) / whole,
    }
