"""The record as JSON: our own format, for other programs and for generators of models.

``docs/model.schema.json`` is its schema. A number after ``version`` counts its changes.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from ...base.arrays import Array
from ...errors import shown
from .file_elements import Element
from .file_frames import Frame
from .record import GROUND, MOVES, Body, Coupling, Joint, Law, Model, slender

SCHEMA, VERSION = "lagrange_casadi.model", 1
"""Name of the format in a file."""

TOP = ("schema", "version", "name", "units", "gravity", "time", "bodies", "joints", "couplings",
       "motions", "posture", "drives", "notes")  # fmt: skip
FRAME = ("place", "axes", "z")
BODY = ("name", "mass", "centre", "inertia", "rod", "point", "places", *FRAME)
JOINT = ("name", "kind", "parent", "child", "on_parent", "on_child", "lead")
COUPLING = ("name", "first", "second", "ratio", "offset")
SPAN, SAMPLES = ("start", "stop", "count"), ("times", "values")


class _Object(Element):
    """An object of the file; its name is its path."""

    blank = ()

    @property
    def where(self) -> str:
        """The path of the object."""
        return self.name

    def at(self, key: str) -> str:
        """Return the path of an entry."""
        return f"{self.name}.{key}" if self.name else key

    def table(self, key: str, valid: Sequence[str] = (), *needed: str) -> _Object:
        """Return an object in it, empty if it is not there."""
        return _object(self.model, self.at(key), self.given.get(key, {}), valid, *needed)

    def objects(self, key: str, valid: Sequence[str], *needed: str) -> Iterator[_Object]:
        """Yield the objects in a list of it."""
        for k, one in enumerate(self.items(key)):
            yield _object(self.model, f"{self.at(key)}[{k}]", one, valid, *needed)

    def items(self, key: str) -> list[object]:
        """Return a list in it, empty if it is not there."""
        found = self.given.get(key, [])
        if not isinstance(found, list):
            raise self.model.refuse(self.at(key), f"expected a list, got {shown(found)}")
        return found

    def rows(self, key: str, count: int, expected: str) -> Array:
        """Return a list in it of so many rows of three numbers."""
        if len(rows := self.items(key)) != count:
            raise self.model.refuse(self.at(key), f"expected {expected}")
        return np.array([self.model.numbers(self.at(key), row, key) for row in rows])

    def as_text(self, key: str, given: object) -> str:
        """Return what an entry, or a list of it, gives as a text."""
        if not isinstance(given, str) or not given or len(given) > 200:
            raise self.model.refuse(self.at(key), f"expected a text, got {shown(given)}")
        return given

    def word(self, key: str, usual: str = "") -> str:
        """Return a text in it."""
        return self.as_text(key, self.given.get(key, usual))

    def words(self, key: str) -> list[str]:
        """Return a list of texts in it."""
        return [self.as_text(key, one) for one in self.items(key)]

    def frame(self, key: str = "") -> Frame:
        """Return a frame in it: its place, and either its three axes, or the direction of z."""
        one = self.table(key, FRAME) if key else self
        place = one.numbers("place", (0.0, 0.0, 0.0))
        if "axes" in one.given:
            rows = one.rows("axes", 3, "three unit vectors, those of x, y and z")
            return Frame(place, one.model.rotation(one.at("axes"), rows.T))
        return Frame.about(one.direction("z"), place) if "z" in one.given else Frame(place)


def _object(
    model: Model, path: str, data: object, valid: Sequence[str] = (), *needed: str
) -> _Object:
    """Return an object of valid keys, if there are any, of which some are needed."""
    if not isinstance(data, dict):
        raise model.refuse(path, f"expected an object, got {shown(data)}")
    for key in data:
        model.known(path, "key", key, valid or data)
    for key in needed:
        if key not in data:
            raise model.refuse(path, f"lacks '{key}'")
    return _Object(model, path, 0, data)


def read(model: Model, text: str) -> None:
    """Read a file. Raises :class:`.ModelFileError`, which names the element."""
    try:
        data = json.loads(text)
    except json.JSONDecodeError as error:
        raise model.refuse("", f"no JSON: {error}") from None
    except (ValueError, RecursionError):
        raise model.refuse("", "lists in lists are too deep, or a number is too long") from None
    top = _object(model, "", data, TOP, "schema", "version", "bodies", "joints")
    if data["schema"] != SCHEMA or data["version"] != VERSION:
        raise model.refuse(
            "",
            f'expected "schema": "{SCHEMA}", "version": {VERSION},'
            f" got {shown(data['schema'])}, {shown(data['version'])}",
        )
    if data.get("units", "SI") != "SI":
        raise model.refuse("units", f'expected "SI", got {shown(data["units"])}')
    model.name = model.name_of("mechanism", top.word("name", model.name), top.at("name"))
    model.gravity = top.numbers("gravity", model.gravity.tolist())
    for one in top.objects("bodies", BODY, "name", "mass"):
        _body(one)
    for one in top.objects("joints", JOINT, "name", "kind", "parent", "child"):
        _joint(one)
    for one in top.objects("couplings", COUPLING, "name", "first", "second", "ratio"):
        joints = (_here(model, "joint", one.word(key)) for key in ("first", "second"))
        law = one.amount("ratio"), one.amount("offset", 0.0)
        model.add(Coupling, one.word("name"), one.where, *joints, *law)
    motions, posture = top.table("motions"), top.table("posture")
    for name in motions.given:
        model.motions[_here(model, "joint", name)] = _law(motions, name)
    for name in posture.given:
        model.posture[_here(model, "joint", name)] = posture.amount(name, what="value")
    if "drives" in data:
        model.drives = [_here(model, "joint", name) for name in top.words("drives")]
    if "time" in data:
        model.span = _span(top.table("time", SPAN, *SPAN))
    model.notes = top.words("notes")


def write(model: Model) -> str:
    """Return the text of the file for a model."""
    data = {
        "schema": SCHEMA,
        "version": VERSION,
        "name": model.name,
        "units": "SI",
        "gravity": model.gravity,
        "time": dict(zip(SPAN, model.span, strict=True)),
        "bodies": [*model.bodies.values()],
        "joints": [*model.joints.values()],
        "couplings": [*model.couplings.values()],
        "motions": model.motions,
        "posture": model.posture or None,
        "drives": model.drives,
        "notes": model.notes or None,
    }
    given = {key: value for key, value in data.items() if value is not None}
    return json.dumps(given, indent=1, allow_nan=False, default=_plain) + "\n"


def _plain(part: object) -> Any:
    """Return a part of a record in the words of the file."""
    match part:
        case Body():
            own: dict[str, Any] = {"centre": part.centre, "inertia": part.inertia}
            own = {"rod": part.rod} if part.rod else {"point": True} if part.point else own
            own |= {"places": part.places} if part.places else {}
            return {"name": part.name, "mass": part.mass, **_plain(part.frame), **own}
        case Joint() | Coupling():
            keys = COUPLING if isinstance(part, Coupling) else JOINT if part.lead else JOINT[:-1]
            return {key: getattr(part, key) for key in keys}
        case Law():
            samples = part.samples
            return part.text if samples is None else dict(zip(SAMPLES, samples, strict=True))
        case Frame():
            upright = np.array_equal(part.axes, np.eye(3))
            return {"place": part.place} | ({} if upright else {"axes": part.axes.T})
    assert isinstance(part, np.ndarray)
    return part.tolist()


def _body(one: _Object) -> None:
    name, mass, given = one.word("name"), one.amount("mass"), one.given.get("inertia")
    if name == GROUND:
        raise one.refuse("body 'ground': the name is taken")
    centre, inertia, rod = one.numbers("centre", (0.0, 0.0, 0.0)), np.zeros((3, 3)), None
    places = one.table("places")
    named = {place: places.numbers(place, what="place") for place in places.given}
    if "rod" in one.given:
        start, end = one.rows("rod", 2, "two places")
        centre, inertia = slender(mass, start, end)
        rod = start, end
    elif isinstance(given, list) and all(isinstance(row, list) for row in given):
        expected = "three moments or three rows, symmetric"
        inertia = one.rows("inertia", 3, expected)
        if not np.allclose(inertia, inertia.T, rtol=1e-9, atol=0.0):
            raise one.model.refuse(one.at("inertia"), f"expected {expected}")
    elif given is not None:
        inertia = np.diag(one.numbers("inertia"))
    if not isinstance(point := one.given.get("point", False), bool):
        raise one.model.refuse(one.at("point"), f"expected true or false, got {shown(point)}")
    one.model.add(Body, name, one.where, mass, centre, inertia, one.frame(), named, rod, point)


def _joint(one: _Object) -> None:
    name, where = one.word("name"), f"{one.at('kind')}: joint '{one.word('name')}'"
    kind = one.model.known(where, "kind", one.given["kind"], [*MOVES])
    bodies = (_here(one.model, "body", one.word(key)) for key in ("parent", "child"))
    frames, lead = (one.frame("on_parent"), one.frame("on_child")), one.amount("lead", 0.0)
    if lead and kind != "screw":
        raise one.model.refuse(one.at("lead"), f"a {kind} joint has no lead; only a screw has")
    one.model.add(Joint, name, one.where, kind, *bodies, *frames, lead)


def _here(model: Model, kind: str, stated: str) -> str:
    """Return the name here of a body, a joint or a coordinate of the file."""
    name, colon, freedom = stated.partition(":")
    return (
        model.named.get((kind, stated)) or f"{model.named.get((kind, name), name)}{colon}{freedom}"
    )


def _law(motions: _Object, name: str) -> Law:
    where, given = motions.at(name), motions.given[name]
    if isinstance(given, str):
        return Law(given, where=where)
    one = motions.table(name, SAMPLES, *SAMPLES)
    count = len(one.items("times"))
    times, values = (one.model.numbers(one.at(key), one.given[key], key, count) for key in SAMPLES)
    return Law(samples=(tuple(times.tolist()), tuple(values.tolist())), where=where)


def _span(one: _Object) -> tuple[float, float, int]:
    count = one.given["count"]
    if not isinstance(count, int) or isinstance(count, bool) or not 1 <= count <= 1_000_000:
        raise one.model.refuse(one.at("count"), f"expected 1 to 1000000, got {shown(count)}")
    return one.amount("start"), one.amount("stop"), count
