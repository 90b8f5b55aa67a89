"""Strains of a link under its section forces, in numbers or expressions: a beam of Timoshenko's.

Axial strain N/EA, curvatures by both bendings about any axes, twist T/GIt about the shear centre,
and the shear strains V/GAs, along y and along z (Timoshenko, *Strength of Materials*, part I;
Cowper, *The Shear Coefficient in Timoshenko's Beam Theory*, J. Appl. Mech. 33, 1966). Warping that
is held adds nothing. In a planar mechanism bending is in its plane.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeAlias

from ..base.arrays import Array, Operand
from ..errors import DeclarationError
from ..model.beams.beam import Beam
from ..model.beams.properties import Properties

Moduli: TypeAlias = tuple[float, ...]
"""Elasticity and shear modulus [Pa]."""


def moduli_of(beam: Beam, what: str, *, space: bool) -> Moduli:
    """Return the moduli of a beam's material.

    Raises :class:`.DeclarationError` where one is not there, or in space no torsion constant, which
    ``what`` needs.
    """
    found = beam.material.needs(what, "elasticity", "shear_modulus")
    for shape in beam.course.shapes if space else ():
        if shape.properties().torsion is None:
            how = "use beams.given with its properties, torsion included"
            raise DeclarationError(
                f"{what}: there is no formula for torsion of a {shape.kind}; {how}"
            )
    return found


def resultants(
    p: Properties, force: Mapping[str, Array], moduli: Moduli
) -> dict[str, tuple[Array, Operand]]:
    """Section forces put together so that each strains alone, with how much: a unit of length has
    half their squares' energy.

    Torsion is about the shear centre, and bending about y has with it the part of bending about z
    that strains as it does.
    """
    elasticity, shear_modulus = moduli
    whole = elasticity * (p.iy * p.iz - p.iyz**2)
    found = {"axial": (force["axial"], 1.0 / (elasticity * p.area))}
    for name, area in (("shear", p.shear_y), ("shear_y", p.shear_y), ("shear_z", p.shear_z)):
        if name in force and area is not None:
            found[name] = force[name], 1.0 / (shear_modulus * area)
    if "bending" in force:
        return found | {"bending": (force["bending"], p.iy / whole)}
    # Section forces act at the centroid, torsion counts from the shear centre.
    torsion = force["torsion"] + p.centre_z * force["shear_y"] - p.centre_y * force["shear_z"]
    return found | {
        "torsion": (torsion, 1.0 / (shear_modulus * p.torsion)),
        "bending_y": (force["bending_y"] + p.iyz / p.iz * force["bending_z"], p.iz / whole),
        "bending_z": (force["bending_z"], 1.0 / (elasticity * p.iz)),
    }


def strains(p: Properties, force: Mapping[str, Array], moduli: Moduli) -> dict[str, Array]:
    """Strain of each section force, by its name, for a unit of the link's length."""
    found = dict.fromkeys(force, 0.0) | {
        name: value * soft for name, (value, soft) in resultants(p, force, moduli).items()
    }
    if "bending" in force:
        return found
    found["shear_y"] = found["shear_y"] + p.centre_z * found["torsion"]
    found["shear_z"] = found["shear_z"] - p.centre_y * found["torsion"]
    found["bending_z"] = found["bending_z"] + p.iyz / p.iz * found["bending_y"]
    return found
