"""The record as JSON: our own format, for other programs and for generators of models.

``docs/model.schema.json`` is its schema. A number after ``version`` counts its changes.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..base.arrays import Json
from ..errors import shown
from .record import (
    MOVES,
    Body,
    Coupling,
    Frame,
    Joint,
    Law,
    Model,
    about_axis,
    number,
    numbers,
    rotation,
)

SCHEMA, VERSION = "lagrange_casadi.model", 1
"""Name of the format in a file."""

TOP = (
    "schema",
    "version",
    "name",
    "units",
    "gravity",
    "time",
    "bodies",
    "joints",
    "couplings",
    "motions",
    "posture",
    "drives",
    "notes",
)
FRAME = ("place", "axes", "z")
BODY = ("name", "mass", "centre", "inertia", "rod", "point", "places", *FRAME)
JOINT = ("name", "kind", "parent", "child", "on_parent", "on_child", "lead")
COUPLING = ("name", "first", "second", "ratio", "offset")

Data = Mapping[str, Any]


def read(path: Path, text: str) -> Model:
    """Return the model of a file. Raises :class:`.ModelFileError`, which names the element."""
    model = Model(path.stem, path.name)
    try:
        data = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise model.refuse("", f"no JSON: {error}") from None
    _keys(model, "", data, TOP, ("schema", "version", "bodies", "joints"))
    if data["schema"] != SCHEMA or data["version"] != VERSION:
        expected = f'"schema": "{SCHEMA}", "version": {VERSION}'
        got = f"{shown(data['schema'])}, {shown(data['version'])}"
        raise model.refuse("", f"expected {expected}, got {got}")
    if data.get("units", "SI") != "SI":
        raise model.refuse("units", f'expected "SI", got {shown(data["units"])}')
    model.name = _text(model, "name", data.get("name", model.name))
    x, y, z = numbers(model, "gravity", data.get("gravity", (0.0, 0.0, -9.81)), "gravity", 3)
    model.gravity = (float(x), float(y), float(z))
    for k, one in enumerate(_list(model, "bodies", data["bodies"])):
        body = _body(model, f"bodies[{k}]", one)
        model.bodies[body.name] = body
    for k, one in enumerate(_list(model, "joints", data["joints"])):
        joint = _joint(model, f"joints[{k}]", one)
        model.joints[joint.name] = joint
    for k, one in enumerate(_list(model, "couplings", data.get("couplings", []))):
        coupling = _coupling(model, f"couplings[{k}]", one)
        model.couplings[coupling.name] = coupling
    for name, one in _table(model, "motions", data.get("motions", {})).items():
        model.motions[name] = _law(model, f"motions.{name}", one)
    for name, one in _table(model, "posture", data.get("posture", {})).items():
        model.posture[name] = number(model, f"posture.{name}", one, "value")
    if "drives" in data:
        names = _list(model, "drives", data["drives"])
        model.drives = [_text(model, "drives", one) for one in names]
    if "time" in data:
        model.span = _span(model, data["time"])
    model.notes = [
        _text(model, "notes", one) for one in _list(model, "notes", data.get("notes", []))
    ]
    return model


def write(model: Model) -> str:
    """Return the text of the file for a model."""
    data: dict[str, Any] = {"schema": SCHEMA, "version": VERSION, "name": model.name, "units": "SI"}
    data["gravity"] = list(model.gravity)
    data["time"] = dict(zip(("start", "stop", "count"), model.span, strict=True))
    data["bodies"] = [_body_data(body) for body in model.bodies.values()]
    data["joints"] = [
        {"name": one.name, "kind": one.kind, "parent": one.parent, "child": one.child}
        | {"on_parent": _frame_data(one.on_parent), "on_child": _frame_data(one.on_child)}
        | ({"lead": one.lead} if one.lead else {})
        for one in model.joints.values()
    ]
    data["couplings"] = [
        {key: getattr(one, key) for key in COUPLING} for one in model.couplings.values()
    ]
    data["motions"] = {
        name: law.text
        if law.samples is None
        else {"times": list(law.samples[0]), "values": list(law.samples[1])}
        for name, law in model.motions.items()
    }
    data |= {"posture": model.posture} if model.posture else {}
    data |= {"drives": model.drives} if model.drives is not None else {}
    data |= {"notes": model.notes} if model.notes else {}
    return json.dumps(data, indent=1, allow_nan=False) + "\n"


def _body_data(body: Body) -> dict[str, Json]:
    data: dict[str, Any] = {"name": body.name, "mass": body.mass} | _frame_data(body.frame)
    if body.rod is not None:
        data["rod"] = [end.tolist() for end in body.rod]
    elif body.point:
        data["point"] = True
    else:
        assert body.inertia is not None
        data |= {"centre": body.centre.tolist(), "inertia": body.inertia.tolist()}
    if body.places:
        data["places"] = {name: place.tolist() for name, place in body.places.items()}
    return data


def _frame_data(frame: Frame) -> dict[str, Json]:
    data: dict[str, Any] = {"place": frame.place.tolist()}
    if not np.array_equal(frame.axes, np.eye(3)):
        data["axes"] = frame.axes.T.tolist()
    return data


def _body(model: Model, where: str, data: Data) -> Body:
    _keys(model, where, data, BODY, ("name", "mass"))
    name = model.name_of("body", _text(model, where, data["name"]), where, model.bodies)
    mass = number(model, f"{where}.mass", data["mass"], "mass")
    frame = _frame(model, where, {key: data[key] for key in FRAME if key in data})
    places = {
        one: numbers(model, f"{where}.places.{one}", place, "place", 3)
        for one, place in _table(model, f"{where}.places", data.get("places", {})).items()
    }
    if "rod" in data:
        ends = _list(model, f"{where}.rod", data["rod"])
        if len(ends) != 2:
            raise model.refuse(f"{where}.rod", "expected two places")
        start, end = (numbers(model, f"{where}.rod", one, "rod", 3) for one in ends)
        body = Body.slender(name, mass, (start, end), where)
        return Body(name, mass, body.centre, body.inertia, frame, places, body.rod, where=where)
    centre = numbers(model, f"{where}.centre", data.get("centre", (0.0, 0.0, 0.0)), "centre", 3)
    inertia, given = None, data.get("inertia")
    if given is not None and all(isinstance(one, Sequence) for one in _list(model, where, given)):
        rows = [numbers(model, f"{where}.inertia", one, "inertia", 3) for one in given]
        inertia = np.array(rows)
        if inertia.shape != (3, 3) or not np.allclose(inertia, inertia.T, rtol=1e-9, atol=0.0):
            raise model.refuse(
                f"{where}.inertia", "expected three moments or three rows, symmetric"
            )
    elif given is not None:
        inertia = np.diag(numbers(model, f"{where}.inertia", given, "inertia", 3))
    point = data.get("point", False) is True
    return Body(name, mass, centre, inertia, frame, places, point=point, where=where)


def _joint(model: Model, where: str, data: Data) -> Joint:
    _keys(model, where, data, JOINT, ("name", "kind", "parent", "child"))
    name = model.name_of("joint", _text(model, where, data["name"]), where, model.joints)
    if data["kind"] not in [*MOVES]:
        valid = ", ".join(MOVES)
        words = f"joint '{name}': unknown kind {shown(data['kind'])}; valid: {valid}"
        raise model.refuse(f"{where}.kind", words)
    parent, child = (_text(model, f"{where}.{key}", data[key]) for key in ("parent", "child"))
    near, far = (
        _frame(model, f"{where}.{key}", data.get(key, {})) for key in ("on_parent", "on_child")
    )
    lead = number(model, f"{where}.lead", data.get("lead", 0.0), "lead")
    return Joint(name, data["kind"], parent, child, near, far, lead, where)


def _frame(model: Model, where: str, data: Data) -> Frame:
    """Return a frame: its place, and either its three axes, or the direction of z."""
    _keys(model, where, data, FRAME, ())
    place = numbers(model, f"{where}.place", data.get("place", (0.0, 0.0, 0.0)), "place", 3)
    if "axes" in data:
        rows = _list(model, f"{where}.axes", data["axes"])
        axes = np.array([numbers(model, f"{where}.axes", row, "axes", 3) for row in rows]).T
        if axes.shape != (3, 3):
            raise model.refuse(f"{where}.axes", "expected the directions of x, y and z")
        return Frame(place, rotation(model, f"{where}.axes", axes))
    if "z" in data:
        z = numbers(model, f"{where}.z", data["z"], "z", 3)
        if not np.any(z):
            raise model.refuse(f"{where}.z", "expected a direction, got zero")
        return Frame(place, about_axis(z))
    return Frame(place)


def _coupling(model: Model, where: str, data: Data) -> Coupling:
    _keys(model, where, data, COUPLING, ("name", "first", "second", "ratio"))
    name = model.name_of("coupling", _text(model, where, data["name"]), where, model.couplings)
    first, second = (_text(model, f"{where}.{key}", data[key]) for key in ("first", "second"))
    ratio = number(model, f"{where}.ratio", data["ratio"], "ratio")
    offset = number(model, f"{where}.offset", data.get("offset", 0.0), "offset")
    return Coupling(name, first, second, ratio, offset, where)


def _law(model: Model, where: str, given: object) -> Law:
    if isinstance(given, str):
        return Law(given, where=where)
    table = _table(model, where, given)
    _keys(model, where, table, ("times", "values"), ("times", "values"))
    count = len(_list(model, where, table["times"]))
    rows = [numbers(model, f"{where}.{key}", table[key], key, count) for key in ("times", "values")]
    return Law(samples=(tuple(rows[0].tolist()), tuple(rows[1].tolist())), where=where)


def _span(model: Model, given: object) -> tuple[float, float, int]:
    table = _table(model, "time", given)
    _keys(model, "time", table, ("start", "stop", "count"), ("start", "stop", "count"))
    start, stop = (number(model, f"time.{key}", table[key], key) for key in ("start", "stop"))
    count = table["count"]
    if not isinstance(count, int) or isinstance(count, bool) or not 1 <= count <= 1_000_000:
        raise model.refuse("time.count", f"expected 1 to 1000000, got {shown(count)}")
    return start, stop, count


def _keys(
    model: Model, where: str, data: object, valid: Sequence[str], needed: Sequence[str]
) -> None:
    table = _table(model, where, data)
    for key in table:
        if key not in valid:
            raise model.refuse(where, f"unknown key {shown(key)}; valid: {', '.join(valid)}")
    for key in needed:
        if key not in table:
            raise model.refuse(where, f"lacks '{key}'")


def _table(model: Model, where: str, given: object) -> dict[str, Any]:
    if not isinstance(given, dict):
        raise model.refuse(where, f"expected an object, got {shown(given)}")
    return given


def _list(model: Model, where: str, data: object) -> list[Any]:
    if not isinstance(data, list | tuple):
        raise model.refuse(where, f"expected a list, got {shown(data)}")
    return list(data)


def _text(model: Model, where: str, given: object) -> str:
    if not isinstance(given, str) or not given or len(given) > 200:
        raise model.refuse(where, f"expected a text, got {shown(given)}")
    return given
