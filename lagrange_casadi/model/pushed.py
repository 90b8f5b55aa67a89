"""A scene with one force more, at a point that is asked how it gives way."""

from __future__ import annotations

import copy
import math
from dataclasses import replace
from typing import Any

import casadi as ca

from ..errors import DeclarationError, check_kind
from .declared_parts import Body, Link, Parameter, Point, PointMass
from .loads import Force
from .scene import Scene

_LOAD = "tool deflection"


def with_push(scene: Scene, point: Body | Point) -> tuple[Scene, tuple[str, ...], str]:
    """Return a scene that pushes at a point, the parameters that are the force's components, and
    the name of the point's body.

    Raises :class:`.DeclarationError` for a point on the ground or of another mechanism.
    """
    mechanism: Any = scene.mechanism
    check_kind("tool_deflection", point, "a point of the mechanism", Point, Link, PointMass)
    place = point if isinstance(point, Point) else Point(point, 0.0, 0.0)
    if mechanism.bodies.get(place.body.name) is not place.body or place.body is mechanism.ground:
        raise DeclarationError(
            f"tool_deflection: the point is on '{place.body.name}', expected a moving body of"
            f" '{mechanism.name}'"
        )
    pushes = {
        name: Parameter(name, 0.0, "N", -math.inf, math.inf, ca.SX.sym(name))
        for name in (f"{_LOAD} {axis}" for axis in "xyz")
    }
    x, y, z = (parameter.symbol for parameter in pushes.values())
    force = Force(_LOAD, place, (x, y, z if mechanism.space else 0.0), False)
    found = copy.copy(mechanism)
    found.parameters = dict(mechanism.parameters) | pushes
    found.loads = dict(mechanism.loads) | {_LOAD: force}
    pushed = replace(scene, mechanism=found, assembly=dict(scene.assembly))
    return pushed, tuple(pushes)[: 3 if mechanism.space else 2], place.body.name
