"""A mechanism at given parameters as plain numbers: what a file keeps of it, and what a drawing is made from."""

from __future__ import annotations

import functools
from collections.abc import Callable, Collection, Mapping
from typing import Any

import casadi as ca

from .density import NumericDensity
from .mechanism import Mechanism
from .parts import Link, Point, PointMass, RigidMass

Description = dict[str, Any]

_PLACE = {"body": str, "x": float, "y": float}
_BODY = {"length": float, "mass": float}
SHAPE = {
    "name": str,
    "parameters": {str: {"value": float, "unit": str, "low": float, "high": float}},
    "gravity": [float],
    "bodies": {
        str: (
            {"length": None, "mass": float},
            _BODY | {"centre": {"x": float, "y": float, "inertia": float}},
            _BODY | {"density": {"breaks": [float], "cells": [[float]]}},
        )
    },
    "joints": {
        str: {
            "kind": str,
            "coordinate": (str, None),
            "driven": bool,
            "parent": _PLACE,
            "child": _PLACE,
            "axis": [float],
            "angle": float,
        }
    },
    "loads": {str: {"kind": str, "points": [_PLACE]}},
    "rows": {str: str},
    "constraints": [str],
}
"""What every description is like, in the words of :mod:`.untrusted`."""


def density_of(body: Description) -> NumericDensity:
    """The density of a described link that has sections."""
    return NumericDensity(tuple(body["density"]["breaks"]), tuple(tuple(cell) for cell in body["density"]["cells"]))


def drives_of(description: Description) -> list[str]:
    """The joints whose efforts make the motion."""
    driven = [name for name, joint in description["joints"].items() if joint["driven"] and name not in description["rows"].values()]
    drives = description.get("drives")
    return driven if drives is None else [name for name in drives if name in description["joints"]]


def parts_of(description: Description) -> list[str]:
    """The names of all parts that outputs are of."""
    tables = ("bodies", "joints", "constraints", "rows", "loads")
    return [part for table in tables for part in description[table]] + list(description.get("outputs", ()))


def describe(
    mechanism: Mechanism, values: Mapping[str, float], driven: Collection[str], drives: Collection[str] | None = None
) -> Description:
    """Bodies with their length [m] (None for a point mass) and mass [kg], and joints with the places they join.

    ``driven`` are the joints whose motion is given, ``drives`` those whose efforts make it, where these are others.
    """
    numbers = iter(_numbers(mechanism)([values[name] for name in mechanism.parameters]).full().ravel().tolist())
    found = _described(mechanism, values, driven, lambda _: next(numbers))
    if mechanism.outputs:
        found["outputs"] = {name: own.unit for name, own in mechanism.outputs.items()}
    if drives is None:
        return found
    return found | {"drives": list(drives), "motions": {name: _kind(mechanism, name) for name in driven}}


def _kind(mechanism: Mechanism, name: str) -> str:
    """The kind of a coordinate whose motion is given, of a joint or a guide (:mod:`.guiding`)."""
    if name in mechanism.coordinates:
        return mechanism.coordinates[name][1].kind
    return "angle" if name.endswith(".angle") else "slide"


def motions_of(description: Description) -> dict[str, str]:
    """The coordinates whose motion is given, of joints and of guides, with their kinds: "angle" or "slide"."""
    driven = {name: joint["coordinate"] for name, joint in description["joints"].items() if joint["driven"]}
    return driven | {str(name): str(kind) for name, kind in description.get("motions", {}).items()}


@functools.lru_cache(maxsize=32)
def _numbers(mechanism: Mechanism) -> ca.Function:
    """All numbers of a description at once, in the order in which it asks for them."""
    asked: list[Any] = []

    def number(expression: Any) -> float:
        asked.append(expression)
        return 1.0

    _described(mechanism, dict.fromkeys(mechanism.parameters, 1.0), (), number)
    return ca.Function("numbers", [mechanism.symbols], [ca.densify(ca.vertcat(ca.SX(0, 1), *asked))])


def _described(
    mechanism: Mechanism, values: Mapping[str, float], driven: Collection[str], number: Callable[[Any], float]
) -> Description:
    def place(point: Point) -> Description:
        return {"body": point.body.name, "x": number(point.x), "y": number(point.y)}

    def matter(body: Link | PointMass) -> Description:
        if isinstance(body, PointMass):
            return {"length": None, "mass": number(body.mass)}
        length = number(body.length)
        if isinstance(body.mass, RigidMass):
            x, y = body.mass.centre
            mass, centre = number(body.mass.mass), {"x": number(x), "y": number(y), "inertia": number(body.mass.inertia)}
            return {"length": length, "mass": mass, "centre": centre}
        density = body.mass.at(number, length)
        return {
            "length": length,
            "mass": density.mass,
            "density": {"breaks": list(density.breaks), "cells": [list(c) for c in density.cells]},
        }

    bodies = {body.name: matter(body) for body in mechanism.moving}
    loads = {
        name: {"kind": type(load).__name__.lower(), "points": [place(point) for point in load.points]}
        for name, load in mechanism.loads.items()
    }
    joints = {
        joint.name: {
            "kind": joint.kind,
            "coordinate": joint.coordinate,
            "driven": joint.name in driven,
            "parent": place(joint.parent),
            "child": place(joint.child),
            "axis": [number(component) for component in joint.axis],
            "angle": number(joint.angle),
        }
        for joint in mechanism.joints.values()
    }
    parameters = {
        name: {"value": values[name], "unit": parameter.unit, "low": parameter.low, "high": parameter.high}
        for name, parameter in mechanism.parameters.items()
    }
    paths = {name: place(path.point) for name, path in mechanism.paths.items()}
    return {
        "name": mechanism.name,
        "parameters": parameters,
        "gravity": [number(component) for component in mechanism.gravity[: 3 if mechanism.space else 2]],
        "bodies": bodies,
        "joints": joints,
        "loads": loads,
        "rows": {name: row.replaces for name, row in mechanism.rows.items()},
        "constraints": list(mechanism.constraints),
    } | ({"paths": paths} if paths else {})
