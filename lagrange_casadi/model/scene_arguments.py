"""Arguments of a scene, as a user says them: joints that drive, links that are compliant, and rough
directions and places of a posture.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import casadi as ca

from ..base.arguments import texts
from ..base.numerals import readable
from ..base.tables import ANGLE, LENGTH
from ..base.units import quantity
from ..errors import DeclarationError, UnknownNameError, check_known, shown
from .declared_parts import Expression
from .link_density import Density
from .mechanism import Mechanism
from .times import TURNS

Elastic = bool | Sequence[str]
"""Links that are compliant, if elasticity determines what equilibrium leaves indeterminate: none,
all, or some by name.
"""


def weighed(
    mechanism: Mechanism, drives: Mapping[str, Expression] | Sequence[str], moved: Sequence[str]
) -> dict[str, Expression]:
    """The joints whose efforts make a motion, with their weights, in the order of declaration.

    ``moved`` are the joints whose motion needs an effort. Raises :class:`UnknownNameError` for a
    joint that is none, and :class:`DeclarationError` for one that has no coordinate, for too few,
    and for a weight that is not positive.
    """
    if not isinstance(drives, Mapping) and texts(drives) is None:
        raise DeclarationError(
            f"drives: expected a list of joints, or weights by joint, got {shown(drives)}"
        )
    coordinates = mechanism.coordinates
    weights = dict(drives) if isinstance(drives, Mapping) else dict.fromkeys(drives, 1.0)
    if len(weights) < len(drives):
        raise DeclarationError(f"drives: a joint is listed twice in {', '.join(drives)}")
    for name, weight in weights.items():
        if name in mechanism.joints and name not in coordinates:
            axes = ", ".join(axis.coordinate for axis in mechanism.joints[name].axes)
            why = (
                f"has several coordinates; expected one of {axes}"
                if axes
                else "has no coordinate for an effort"
            )
            raise DeclarationError(f"drives: joint '{name}' {why}")
        check_known("joint in drives", [name], coordinates)
        if not isinstance(weight, ca.SX):
            if not isinstance(weight, (int, float)) or not 0.0 < weight < float("inf"):
                raise DeclarationError(
                    f"drives: expected a positive weight of joint '{name}', got {weight!r}"
                )
        elif strange := [
            str(s) for s in ca.symvar(weight) if not ca.depends_on(mechanism.symbols, s)
        ]:
            raise DeclarationError(
                f"drives: the weight of joint '{name}' depends on {', '.join(strange)}, which is"
                " not a parameter"
            )
    if len(weights) < len(moved):
        raise DeclarationError(
            f"drives: {len(weights)} cannot make {len(moved)} independent motions; expected at"
            f" least {len(moved)} joints for the motion of {', '.join(moved)}, got"
            f" {', '.join(weights) or 'none'}"
        )
    return {name: weights[name] for name in coordinates if name in weights}


def compliant_links(mechanism: Mechanism, elastic: Elastic) -> Elastic:
    """Check the scene's ``elastic``: no, yes, or the compliant links, in their order.

    Raises :class:`.UnknownNameError` for what is no link, and :class:`.DeclarationError` for a link
    that has no beam, or a material without elasticity.
    """
    if isinstance(elastic, bool):
        return elastic
    if not isinstance(elastic, (list, tuple)) or not all(isinstance(name, str) for name in elastic):
        raise DeclarationError(
            f"elastic: expected True, or a list of the links that are elastic, got {elastic!r}"
        )
    having = links_with_beams(mechanism)
    for name in elastic:
        if name not in mechanism.links:
            raise UnknownNameError("link in elastic", name, having)
        beam = mechanism.links[name].beam
        if name not in having or beam is None:
            raise DeclarationError(
                f"elastic: link '{name}' has no beam=; links with a beam:"
                f" {', '.join(having) or 'none'}"
            )
        beam.material.needs(f"elastic link '{name}'", "elasticity")
    return tuple(name for name in having if name in elastic)


def links_with_beams(mechanism: Mechanism) -> list[str]:
    """The links that have sections and a beam."""
    return [
        name
        for name, link in mechanism.links.items()
        if isinstance(link.mass, Density) and link.beam is not None
    ]


def rough_posture(mechanism: Mechanism, posture: Mapping[str, object]) -> dict[str, float]:
    """Return rough directions of links and coordinates of joints [rad, m] by name.

    In space a link that a joint holds at a point mass has turns there, which are no coordinates of
    the joint: from what has no direction none are measured. Raises what a :class:`.Scene` does.
    """
    coordinates = mechanism.coordinates
    turns = (
        axis.coordinate
        for joint in mechanism.joints.values()
        for body in joint.bodies
        for axis in joint.axes_of(body)
    )
    places = [*coordinates, *turns] if mechanism.space else [*mechanism.links, *coordinates]
    check_known("link or joint in posture", posture, dict.fromkeys(places))
    slides = {name for name, (_, axis) in coordinates.items() if axis.kind == "slide"}
    return {name: _rough(name, value, name not in slides) for name, value in posture.items()}


def posture_entry(name: str, slides: bool, value: float, *others: float) -> str:
    """Write an entry of a posture to paste, so that a ``value`` [rad or m] differs from others."""
    if slides:
        return f"'{name}': {readable(value, *others)}"
    return f"'{name}': '{readable(*map(math.degrees, (value, *others)))} deg'"


def _rough(name: str, value: object, is_angle: bool) -> float:
    """Direction [rad] or place [m] of a posture. Raises :class:`DeclarationError`."""
    found = quantity(f"posture of '{name}'", value, ANGLE if is_angle else LENGTH)
    if is_angle and abs(found) > TURNS:
        degrees = f"{math.degrees(found):.6g} deg, more than two turns"
        hint = f"; '{value:g} deg' is {value:g} degrees" if isinstance(value, (int, float)) else ""
        raise DeclarationError(f"posture of '{name}': {found:.6g} rad is {degrees}{hint}")
    return found
