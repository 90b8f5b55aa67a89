"""Motions of points and of bodies' poses, said as motions of joints: of slides and a pin, without
mass, that guide them.

The point of a path is pinned to a guide that slides along the ground's x and y; a body whose pose
is given is turned on it. The guide bears nothing: no effort is at its joints, and what holds it
there are the drives of the scene. So everything that solves loops of joints serves here too.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from typing import Literal

from ..base.tables import ANGLE, LENGTH
from ..base.vectors import AXES
from ..errors import DeclarationError, UnknownNameError, check_kind
from .declared_parts import Body, Link, Point, PointMass, RigidMass
from .joints import Axis, Joint
from .mechanism import Mechanism
from .motion_laws import Motion

_NOTHING = RigidMass(0.0)


def laws_of(
    mechanism: Mechanism, motion: Mapping[str, Motion | Sequence[Motion]]
) -> dict[str, Motion]:
    """The motions by joint, those of guides by names like ``tool.x``.

    Raises :class:`UnknownNameError` for what is no joint, path or body, and
    :class:`DeclarationError` for what cannot move so.
    """
    found: dict[str, Motion] = {}
    coordinates = mechanism.coordinates
    for name, laws in motion.items():
        given = tuple(laws) if isinstance(laws, (tuple, list)) else (laws,)
        check_kind("motion", name, "a name of a joint, a path or a body", str)
        names, what, wanted = [name], "joint", "one law"
        if name in mechanism.joints:
            joint = mechanism.joints[name]
            names = [axis.coordinate for axis in joint.axes]
            if not names:
                why = (
                    "weld has no coordinate"
                    if joint.kind == "weld"
                    else "revolute joint at a point mass has no angle"
                )
                raise DeclarationError(f"joint '{name}' cannot be driven: a {why}")
            if len(names) > 1:
                wanted = f"{len(names)} laws, of {', '.join(names)}"
        elif name in coordinates:
            pass
        elif mechanism.space and (name in mechanism.paths or name in mechanism.bodies):
            raise DeclarationError(
                f"motion of '{name}': in space a point or a pose has no motion of its own; declare"
                " a free() joint from the ground to it, give that joint the motion, and list the"
                " joints that drive it in drives="
            )
        elif name in mechanism.paths or (name in mechanism.bodies and name != "ground"):
            names, wanted = [f"{name}.x", f"{name}.y"], "two laws, of x and y"
            what = "path" if name in mechanism.paths else "body"
            if what == "body" and mechanism.bodies[name].oriented:
                names, wanted = [*names, f"{name}.angle"], "three laws, of x, y and the angle"
        else:
            bodies = [body.name for body in mechanism.moving]
            raise UnknownNameError(
                "joint, path or body in motion",
                name,
                [*coordinates, *mechanism.paths, *bodies],
            )
        if len(given) != len(names):
            raise DeclarationError(
                f"motion of {what} '{name}': expected {wanted}, got {len(given)}"
            )
        for law in given:
            check_kind(f"motion of {what} '{name}'", law, "a law of lagrange_casadi.motion", Motion)
        found |= zip(names, given, strict=True)
    for name, law in found.items():
        unit = ANGLE if kind_of(coordinates, name) == "angle" else LENGTH
        if law.unit not in ("", unit):
            raise DeclarationError(
                f"motion of '{name}': the law is in {law.unit}, but the coordinate is in {unit}"
            )
    return found


def kind_of(coordinates: Mapping[str, tuple[Joint, Axis]], name: str) -> Literal["angle", "slide"]:
    """The kind of a coordinate whose motion is given: one of the ``coordinates`` of joints, or that
    of a guide.
    """
    of_guide: Literal["angle", "slide"] = "angle" if name.endswith(".angle") else "slide"
    return coordinates[name][1].kind if name in coordinates else of_guide


def point_of(mechanism: Mechanism, name: str) -> Point:
    """The point that guides move: of a path, or the base or origin of a body."""
    path = mechanism.paths.get(name)
    return path.point if path else Point(mechanism.bodies[name], 0.0, 0.0)


def guided(mechanism: Mechanism, motion: Mapping[str, Motion | Sequence[Motion]]) -> Mechanism:
    """The mechanism with the guides of what moves as given, and with the same symbols; itself where
    only joints do.
    """
    coordinates = mechanism.coordinates
    names = [name for name in motion if name not in mechanism.joints and name not in coordinates]
    if not names:
        return mechanism
    found = copy.copy(mechanism)
    found.bodies, found.joints = dict(mechanism.bodies), dict(mechanism.joints)
    for name in names:
        point = point_of(mechanism, name)
        rotates = name not in mechanism.paths and point.body.oriented
        beside = Link(f"{name}.x", 0.0, _NOTHING)
        guide: Body = Link(f"{name}.y", 0.0, _NOTHING) if rotates else PointMass(f"{name}.y", 0.0)
        ground, middle, end = (Point(one, 0.0, 0.0) for one in (mechanism.ground, beside, guide))
        along = Joint.flat(f"{name}.x", "prismatic", ground, middle, AXES[0])
        across = Joint.flat(f"{name}.y", "prismatic", middle, end, AXES[1])
        if rotates:
            held = Joint.flat(f"{name}.angle", "revolute", end, point)
        else:
            held = Joint.flat(name, "revolute", point, end)
        found.bodies |= {part.name: part for part in (beside, guide)}
        found.joints |= {joint.name: joint for joint in (along, across, held)}
    return found
