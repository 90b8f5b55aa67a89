"""The record as JSON: our own format, for other programs and for generators of models.

``docs/model.schema.json`` is its schema. A number after ``version`` counts its changes.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..base.arrays import Json
from ..errors import shown
from .elements import Element
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

TOP = ("schema", "version", "name", "units", "gravity", "time", "bodies", "joints", "couplings",
       "motions", "posture", "drives", "notes")  # fmt: skip
FRAME = ("place", "axes", "z")
BODY = ("name", "mass", "centre", "inertia", "rod", "point", "places", *FRAME)
JOINT = ("name", "kind", "parent", "child", "on_parent", "on_child", "lead")
COUPLING = ("name", "first", "second", "ratio", "offset")


class _Object(Element):
    """An object of the file; its name is its path."""

    form = "'{}'"

    @property
    def where(self) -> str:
        """The path of the object."""
        return self.name

    def at(self, key: str) -> str:
        """Return the path of an entry."""
        return f"{self.name}.{key}" if self.name else key

    def objects(self, key: str, valid: Sequence[str], *needed: str) -> Iterator[_Object]:
        """Yield the objects in a list of it."""
        for k, one in enumerate(self.list(key)):
            yield _object(self.model, f"{self.at(key)}[{k}]", one, valid, *needed)

    def list(self, key: str) -> list[object]:
        """Return a list in it, which is empty if it is not there."""
        return _list(self.model, self.at(key), self.given.get(key, []))

    def table(self, key: str) -> dict[str, object]:
        """Return an object in it of any keys, empty if it is not there."""
        return _object(self.model, self.at(key), self.given.get(key, {})).given

    def word(self, key: str, usual: str = "") -> str:
        """Return a text in it."""
        return _text(self.model, self.at(key), self.given.get(key, usual))

    def frame(self, key: str = "") -> Frame:
        """Return a frame in it: its place, and either its three axes, or the direction of z."""
        one = self
        if key:
            one = _object(self.model, self.at(key), self.given.get(key, {}), FRAME)
        place = one.triple("place", (0.0, 0.0, 0.0))
        if "axes" in one.given:
            where = one.at("axes")
            axes = np.array([numbers(one.model, where, row, "axes", 3) for row in one.list("axes")])
            if axes.shape != (3, 3):
                raise one.model.refuse(where, "expected three unit vectors, those of x, y and z")
            return Frame(place, rotation(one.model, where, axes.T))
        return Frame(place, about_axis(one.direction("z"))) if "z" in one.given else Frame(place)


def _object(
    model: Model, path: str, data: object, valid: Sequence[str] = (), *needed: str
) -> _Object:
    """Return an object of valid keys, if there are any, of which some are needed."""
    if not isinstance(data, dict):
        raise model.refuse(path, f"expected an object, got {shown(data)}")
    for key in data:
        if valid and key not in valid:
            raise model.refuse(path, f"unknown key {shown(key)}; valid: {', '.join(valid)}")
    for key in needed:
        if key not in data:
            raise model.refuse(path, f"lacks '{key}'")
    return _Object(model, path, 0, data)


def _list(model: Model, where: str, data: object) -> list[object]:
    if not isinstance(data, list | tuple):
        raise model.refuse(where, f"expected a list, got {shown(data)}")
    return list(data)


def _text(model: Model, where: str, given: object) -> str:
    if not isinstance(given, str) or not given or len(given) > 200:
        raise model.refuse(where, f"expected a text, got {shown(given)}")
    return given


def read(path: Path, text: str) -> Model:
    """Return the model of a file. Raises :class:`.ModelFileError`, which names the element."""
    model = Model(path.stem, path.name)
    try:
        data = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise model.refuse("", f"no JSON: {error}") from None
    top = _object(model, "", data, TOP, "schema", "version", "bodies", "joints")
    if data["schema"] != SCHEMA or data["version"] != VERSION:
        expected = f'"schema": "{SCHEMA}", "version": {VERSION}'
        got = f"{shown(data['schema'])}, {shown(data['version'])}"
        raise model.refuse("", f"expected {expected}, got {got}")
    if data.get("units", "SI") != "SI":
        raise model.refuse("units", f'expected "SI", got {shown(data["units"])}')
    model.name = top.word("name", model.name)
    x, y, z = top.triple("gravity", model.gravity)
    model.gravity = (float(x), float(y), float(z))
    for one in top.objects("bodies", BODY, "name", "mass"):
        _body(one)
    for one in top.objects("joints", JOINT, "name", "kind", "parent", "child"):
        _joint(one)
    for one in top.objects("couplings", COUPLING, "name", "first", "second", "ratio"):
        joints, ratio = (one.word("first"), one.word("second")), one.amount("ratio")
        model.add(Coupling, one.word("name"), one.where, *joints, ratio, one.amount("offset", 0.0))
    for name, law in top.table("motions").items():
        model.motions[name] = _law(model, f"motions.{name}", law)
    for name, value in top.table("posture").items():
        model.posture[name] = number(model, f"posture.{name}", value, "value")
    if "drives" in data:
        model.drives = [_text(model, "drives", one) for one in top.list("drives")]
    if "time" in data:
        model.span = _span(model, data["time"])
    model.notes = [_text(model, "notes", one) for one in top.list("notes")]
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


def _body(one: _Object) -> None:
    model, name, mass = one.model, one.word("name"), one.amount("mass")
    given, inertia, rod = one.given.get("inertia"), None, None
    centre, frame = one.triple("centre", (0.0, 0.0, 0.0)), one.frame()
    places = {
        place: numbers(model, f"{one.at('places')}.{place}", at, "place", 3)
        for place, at in one.table("places").items()
    }
    if "rod" in one.given:
        ends = one.list("rod")
        if len(ends) != 2:
            raise model.refuse(one.at("rod"), "expected two places")
        start, end = (numbers(model, one.at("rod"), place, "rod", 3) for place in ends)
        body = Body.slender(name, mass, (start, end))
        centre, inertia, rod = body.centre, body.inertia, body.rod
    elif isinstance(given, Sequence) and all(isinstance(row, Sequence) for row in given):
        where = one.at("inertia")
        inertia = np.array([numbers(model, where, row, "inertia", 3) for row in given])
        if inertia.shape != (3, 3) or not np.allclose(inertia, inertia.T, rtol=1e-9, atol=0.0):
            raise model.refuse(where, "expected three moments or three rows, symmetric")
    elif given is not None:
        inertia = np.diag(one.triple("inertia"))
    point = one.given.get("point", False) is True
    model.add(Body, name, one.where, mass, centre, inertia, frame, places, rod, point)


def _joint(one: _Object) -> None:
    if one.given["kind"] not in [*MOVES]:
        kind, valid = shown(one.given["kind"]), ", ".join(MOVES)
        words = f"joint '{one.word('name')}': unknown kind {kind}; valid: {valid}"
        raise one.model.refuse(one.at("kind"), words)
    bodies = one.word("parent"), one.word("child")
    frames, lead = (one.frame("on_parent"), one.frame("on_child")), one.amount("lead", 0.0)
    one.model.add(Joint, one.word("name"), one.where, one.given["kind"], *bodies, *frames, lead)


def _law(model: Model, where: str, given: object) -> Law:
    if isinstance(given, str):
        return Law(given, where=where)
    keys = ("times", "values")
    one = _object(model, where, given, keys, *keys)
    count = len(one.list("times"))
    times, values = (numbers(model, one.at(key), one.given[key], key, count) for key in keys)
    return Law(samples=(tuple(times.tolist()), tuple(values.tolist())), where=where)


def _span(model: Model, given: object) -> tuple[float, float, int]:
    keys = ("start", "stop", "count")
    one = _object(model, "time", given, keys, *keys)
    count = one.given["count"]
    if not isinstance(count, int) or isinstance(count, bool) or not 1 <= count <= 1_000_000:
        raise model.refuse("time.count", f"expected 1 to 1000000, got {shown(count)}")
    return one.amount("start"), one.amount("stop"), count
