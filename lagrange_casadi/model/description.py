"""A mechanism at given parameters as plain numbers: what a file keeps of it, and what a drawing is
made from.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import Any

import casadi as ca

from ..base.arrays import Expression
from ..base.quantities import Kinds
from ..base.vectors import cross
from .beams.beam import beam_to_numbers
from .density import Density, NumericDensity
from .fitted import parts_to_numbers
from .joints import Joint
from .mass_properties import mass_of
from .mechanism import Mechanism
from .parts import Friction, Link, Load, Point, PointMass, RigidMass

Description = dict[str, Any]

_PLACE = {"body": str, "x": float, "y": float}

_VECTOR = [float, float, float]
_MATRIX = [_VECTOR, _VECTOR, _VECTOR]
_DENSITY = {"breaks": [float], "cells": [[float]]}


def _shape(
    place: Expression, centre: Expression, gravity: Expression, joint: Any, load: Any
) -> dict[str, Any]:
    body = {"length": float, "mass": float}
    return {
        "name": str,
        "parameters": {str: {"value": float, "unit": str, "low": float, "high": float}},
        "gravity": gravity,
        "bodies": {
            str: (
                {"length": None, "mass": float},
                body | {"centre": centre},
                body | {"density": _DENSITY},
                body
                | {
                    "density": _DENSITY
                    | {"slices": {"yy": _DENSITY, "zz": _DENSITY, "yz": _DENSITY}}
                },
            )
        },
        "joints": {str: {"kind": str, "parent": place, "child": place} | joint},
        "loads": {str: {"kind": str, "points": [place]} | load},
        "rows": {str: str},
        "constraints": [str],
    }


IN_PLANE = _shape(
    place=_PLACE,
    centre={"x": float, "y": float, "inertia": float},
    gravity=[float],
    joint={"coordinate": (str, None), "driven": bool, "axis": [float], "angle": float},
    load={},
)
"""Form of every description of a planar mechanism, in the words of :mod:`.untrusted`."""

IN_SPACE = _shape(
    place=_PLACE | {"z": float},
    centre={"x": float, "y": float, "z": float, "inertia": _MATRIX},
    gravity=_VECTOR,
    joint={
        "coordinates": {str: str},
        "driven": [str],
        "axes": [_VECTOR],
        "triad": _MATRIX,
        "turned": _MATRIX,
        "pitch": float,
    },
    load={"turning": bool},
) | {"bars": [str], "unmeasured": [str]}
"""Form of the description of a mechanism in space."""


def in_space(description: Description) -> bool:
    """Return whether a described mechanism lies in space: its gravity has a z."""
    return len(description["gravity"]) > 2


def shape_of(value: Any) -> dict[str, Any]:
    """Form of a description: that of a planar mechanism, or that of one in space."""
    gravity = value.get("gravity") if isinstance(value, dict) else None
    shape = IN_SPACE if isinstance(gravity, list) and len(gravity) > 2 else IN_PLANE
    optional = {
        "outlines": {str: [[[float, float]]]},
        "rollers": {str: _PLACE | {"radius": float}},
        "losses": [str],
        "beside": {str: _VECTOR},
        "rounded": {str: [float]},
        "snapped": {str: [float]},
        "unturned": [str],
    }
    return shape | {
        name: kind for name, kind in optional.items() if isinstance(value, dict) and name in value
    }


def check_places(description: Description) -> None:
    """Raise ``ValueError`` where a joint or a load is at a place on a body that there is not."""
    ends = (
        (name, joint[end])
        for name, joint in description["joints"].items()
        for end in ("parent", "child")
    )
    for name, place in (
        *ends,
        *((name, point) for name, load in description["loads"].items() for point in load["points"]),
    ):
        if place["body"] != "ground" and place["body"] not in description["bodies"]:
            raise ValueError(
                f"'{name}' is at a place on '{place['body']}', which is not a body of the mechanism"
            )


def density_of(body: Description) -> NumericDensity:
    """The density of a described link that has sections."""
    return _density(body["density"])


def oriented(description: Description, body: str) -> bool:
    """Return whether a body has a direction; a point mass has none."""
    return body == "ground" or description["bodies"][body]["length"] is not None


def slice_densities(body: Description) -> tuple[NumericDensity, ...]:
    """The second moments yy, zz and yz of slices along a described link, each like a density; none
    of a link whose slices have no rotary inertia.
    """
    slices = body["density"].get("slices")
    return tuple(_density(slices[name]) for name in ("yy", "zz", "yz")) if slices else ()


def slices_of(body: Description) -> tuple[float, float, float]:
    """The second moments yy, zz, yz of all slices of a described link [kg m^2]."""
    if not (moments := slice_densities(body)):
        return 0.0, 0.0, 0.0
    yy, zz, yz = (moment.mass for moment in moments)
    return yy, zz, yz


def _density(entry: Description) -> NumericDensity:
    return NumericDensity(tuple(entry["breaks"]), tuple(tuple(cell) for cell in entry["cells"]))


def coordinates_of(description: Description) -> dict[str, str]:
    """The coordinates of all joints, with their kinds: "angle" or "slide"."""
    if not in_space(description):
        return {
            name: joint["coordinate"]
            for name, joint in description["joints"].items()
            if joint["coordinate"]
        }
    return {
        name: kind
        for joint in description["joints"].values()
        for name, kind in joint["coordinates"].items()
    }


def kinds_of_described(description: Description) -> Kinds:
    """The kinds of coordinates, those of guides too, and of frictions of a described mechanism, and
    the units of its outputs.
    """
    coordinates = coordinates_of(description) | motions_of(description)
    sliding = {
        name: load["friction"]["coordinate"]
        for name, load in description["loads"].items()
        if "friction" in load
    }
    frictions = {name: coordinates[coordinate] for name, coordinate in sliding.items()}
    return Kinds(coordinates, frictions, description.get("outputs", {}))


def _driven(description: Description) -> list[str]:
    joints = description["joints"].items()
    if not in_space(description):
        return [name for name, joint in joints if joint["driven"]]
    return [name for _, joint in joints for name in joint["driven"]]


def drives_of(description: Description) -> list[str]:
    """The coordinates whose efforts make the motion."""
    drives = description.get("drives")
    if drives is None:
        return [name for name in _driven(description) if name not in description["rows"].values()]
    known = coordinates_of(description)
    return [name for name in drives if name in known]


def values_of(description: Description) -> dict[str, float]:
    """Return the values of all parameters."""
    return {name: parameter["value"] for name, parameter in description["parameters"].items()}


def beams_of(description: Description) -> list[str]:
    """Return the links that have sections and a beam."""
    return [name for name, body in description["bodies"].items() if "beam" in body]


def fitted_of(description: Description) -> list[str]:
    """Return the joints that have a pin or a bearing."""
    return [name for name, joint in description["joints"].items() if "fitted" in joint]


def shaft_bearings_of(description: Description) -> list[str]:
    """Return the joints of shafts in a fixed and a floating bearing in space: those that say by
    which coordinate the shaft turns in them.
    """
    return [name for name, joint in description["joints"].items() if "turning" in joint]


def bends_of(description: Description) -> list[str]:
    """Return the welds between the pieces of bent bars, by the names that they get there."""
    found = []
    for name, joint in description["joints"].items():
        bar, bend, number = name.rpartition("_bend_")
        if bend and number.isdigit() and joint["kind"] == "weld":
            pieces = joint["parent"]["body"], joint["child"]["body"]
            if pieces == (f"{bar}_{number}", f"{bar}_{int(number) + 1}"):
                found.append(name)
    return found


def pieces_of(description: Description) -> set[str]:
    """Return the links that bent bars were cut into."""
    joints = (description["joints"][name] for name in bends_of(description))
    return {joint[end]["body"] for joint in joints for end in ("parent", "child")}


def parts_of(description: Description) -> list[str]:
    """The names of all parts that outputs are of."""
    tables = ("bodies", "joints", "constraints", "rows", "loads")
    return [part for table in tables for part in description[table]] + list(
        description.get("outputs", ())
    )


def _lies_by_default(joint: Joint) -> bool:
    """Return whether a slender link slides along one line of its parent, and its direction there
    was not declared.
    """
    body = joint.child.body
    slender = isinstance(body, Link) and isinstance(body.mass, Density)
    return slender and joint.kind in ("prismatic", "cylindrical", "screw") and not joint.turn_given


def _kind(mechanism: Mechanism, name: str) -> str:
    """The kind of a coordinate whose motion is given, of a joint or a guide (:mod:`.guiding`)."""
    if name in mechanism.coordinates:
        return mechanism.coordinates[name][1].kind
    return "angle" if name.endswith(".angle") else "slide"


def motions_of(description: Description) -> dict[str, str]:
    """The coordinates whose motion is given, of joints and of guides, with their kinds: "angle" or
    "slide".
    """
    kinds = coordinates_of(description)
    driven = {name: kinds[name] for name in _driven(description)}
    return driven | {str(name): str(kind) for name, kind in description.get("motions", {}).items()}


def described(
    mechanism: Mechanism, driven: Collection[str], drives: Collection[str] | None
) -> Description:
    """Bodies with their length [m] (None for a point mass) and mass [kg], and joints with the
    places they join; in place of numbers expressions of the parameters.

    ``driven`` are the coordinates whose motion is given, ``drives`` those whose efforts make it,
    where these are others. A joint in space has its coordinates in sequence, with their kinds;
    their ``axes`` and how the child's axes are ``turned``, both where all coordinates are zero; and
    its own axes, the ``triad``. Directions are in the parent's axes, a row each.
    """

    def place(point: Point) -> Description:
        found = {"body": point.body.name, "x": ca.SX(point.x), "y": ca.SX(point.y)}
        return found | {"z": ca.SX(point.z)} if mechanism.space else found

    def vector(components: Iterable[Expression]) -> list[ca.SX]:
        return [ca.SX(component) for component in components]

    def centre(mass: RigidMass) -> Description:
        found = dict(zip("xyz", vector(mass.centre), strict=False))
        return found | {
            "inertia": [vector(row) for row in mass.inertia]
            if mechanism.space
            else ca.SX(mass.inertia)
        }

    def mass_properties(body: Link | PointMass) -> Description:
        if isinstance(body, PointMass):
            return {"length": None, "mass": mass_of(body)}
        found: Description = {"length": ca.SX(body.length), "mass": mass_of(body)}
        if isinstance(body.mass, RigidMass):
            return found | {"centre": centre(body.mass)}
        entry = along(body, body.mass)
        if body.mass.slices is not None:
            names = zip(("yy", "zz", "yz"), body.mass.slices.each, strict=True)
            entry["slices"] = {name: along(body, moment) for name, moment in names}
        beam = {} if body.beam is None else {"beam": beam_to_numbers(body.beam, ca.SX)}
        return found | {"density": entry} | beam

    def along(link: Link, density: Density) -> Description:
        scale = link.length if density.per_length else 1.0
        return {
            "breaks": list(density.breaks),
            "cells": [vector(c * scale for c in cell) for cell in density.cells],
        }

    def fitted(joint: Joint) -> Description:
        parts = mechanism.fitted.get(joint.name)
        turning = mechanism.turning.get(joint.name)
        found: Description = {"fitted": parts_to_numbers(parts, ca.SX)} if parts else {}
        return found | {"turning": turning} if turning else found

    def freedoms(joint: Joint) -> Description:
        if joint.turned is None:
            entry: Description = {"coordinate": joint.coordinate, "driven": joint.name in driven}
            ends = {"parent": place(joint.parent), "child": place(joint.child)}
            return entry | ends | {"axis": vector(joint.axis), "angle": ca.SX(joint.angle)}
        x, y = joint.turned
        return {
            "coordinates": {axis.coordinate: axis.kind for axis in joint.axes},
            "driven": [axis.coordinate for axis in joint.axes if axis.coordinate in driven],
            "parent": place(joint.parent),
            "child": place(joint.child),
            "axes": [vector(axis.direction) for axis in joint.axes],
            "triad": [vector(direction) for direction in joint.triad],
            "turned": [vector(direction) for direction in (x, y, cross(x, y))],
            "pitch": ca.SX(joint.pitch),
        }

    def load_of(load: Load) -> Description:
        found: Description = {
            "kind": type(load).__name__.lower(),
            "points": [place(point) for point in load.points],
        }
        if mechanism.space:
            found["turning"] = getattr(load, "turning", False)
        if isinstance(load, Friction):
            numbers = {word: ca.SX(value) for word, value in load.numbers.items()}
            found["friction"] = {"coordinate": load.axis.coordinate, "numbers": numbers}
        return found

    bodies = {body.name: mass_properties(body) for body in mechanism.moving}
    loads = {name: load_of(load) for name, load in mechanism.loads.items()}
    joints = {
        joint.name: {"kind": joint.kind} | freedoms(joint) | fitted(joint)
        for joint in mechanism.joints.values()
    }
    parameters = {
        name: {
            "value": parameter.symbol,
            "unit": parameter.unit,
            "low": parameter.low,
            "high": parameter.high,
        }
        for name, parameter in mechanism.parameters.items()
    }
    paths = {name: place(path.point) for name, path in mechanism.paths.items()}
    beside = {
        name: vector(link.beside)
        for name, link in mechanism.links.items()
        if link.beside is not None
    }
    outlines = {
        body: [[vector(corner) for corner in outline] for outline in found]
        for body, found in mechanism.outlines.items()
    }
    rollers = {
        name: place(roller.centre) | {"radius": ca.SX(roller.radius)}
        for name, roller in mechanism.rollers.items()
    }
    lossy = [
        c.name
        for c in mechanism.constraints.values()
        if c.transmission is not None and c.transmission.loss is not None
    ]
    unturned = [joint.name for joint in mechanism.joints.values() if _lies_by_default(joint)]
    optional = (
        ("paths", paths),
        ("outlines", outlines),
        ("rollers", rollers),
        ("losses", lossy),
        ("beside", beside),
        ("unturned", unturned),
        ("outputs", {name: output.unit for name, output in mechanism.outputs.items()}),
        ("rounded", {name: list(by) for name, by in mechanism.rounded.items()}),
        ("snapped", {name: list(by) for name, by in mechanism.snapped.items()}),
        ("drives", list(drives or ())),
        ("motions", {name: _kind(mechanism, name) for name in driven} if drives else {}),
    )
    content: Description = {
        "name": mechanism.name,
        "parameters": parameters,
        "gravity": vector(mechanism.gravity[: 3 if mechanism.space else 2]),
        "bodies": bodies,
        "joints": joints,
        "loads": loads,
        "rows": {name: row.replaces for name, row in mechanism.rows.items()},
        "constraints": list(mechanism.constraints),
    }
    return content | {name: found for name, found in optional if found}
