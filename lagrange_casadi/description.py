"""A mechanism at given parameters as plain numbers: what a file keeps of it, and what a drawing is made from."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

from .mechanism import Link, Mechanism, Point

Description = dict[str, Any]


def describe(mechanism: Mechanism, values: Mapping[str, float], driven: Collection[str]) -> Description:
    """Bodies with their length [m] (None for a point mass) and mass [kg], and joints with the places they join."""

    def number(expression: Any) -> float:
        return mechanism.number(expression, values)

    def place(point: Point) -> Description:
        return {"body": point.body.name, "x": number(point.x), "y": number(point.y)}

    bodies = {
        body.name: {"length": number(body.length) if isinstance(body, Link) else None, "mass": number(body.mass)}
        for body in mechanism.moving
    }
    joints = {
        joint.name: {
            "kind": joint.kind,
            "coordinate": joint.coordinate,
            "driven": joint.name in driven,
            "parent": place(joint.parent),
            "child": place(joint.child),
            "axis": [number(component) for component in joint.axis],
        }
        for joint in mechanism.joints.values()
    }
    parameters = {
        name: {"value": values[name], "unit": parameter.unit, "low": parameter.low, "high": parameter.high}
        for name, parameter in mechanism.parameters.items()
    }
    return {
        "name": mechanism.name,
        "parameters": parameters,
        "gravity": [number(component) for component in mechanism.gravity],
        "bodies": bodies,
        "joints": joints,
    }
