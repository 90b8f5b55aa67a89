"""Assemblies of FreeCAD and OndselSolver, ``.asmt``: parts, markers, joints and motions.

A file is a tree of lines by their tabs. A joint is between two markers; what it does is along and
about z of its marker I. Curves of the series of results that a file may have are not read.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ..base.arrays import Array
from .record import (
    GROUND,
    Body,
    Frame,
    Joint,
    Law,
    Model,
    Row,
    Tie,
    number,
    numbers,
    rotation,
)

KINDS: dict[str, str] = {
    "RevoluteJoint": "revolute",
    "CylindricalJoint": "cylindrical",
    "SphericalJoint": "spherical",
    "UniversalJoint": "universal",
    "TranslationalJoint": "prismatic",
    "PlanarJoint": "planar",
    "FixedJoint": "weld",
    "PointInLineJoint": "slot",
}
"""The joints that are joints here too."""

_PARALLEL = (Row("cosine", 2, 0), Row("cosine", 2, 1))

TIES: dict[str, tuple[Row, ...]] = {
    "PointInPlaneJoint": (Row("slide"),),
    "LineInPlaneJoint": (Row("slide"), Row("cosine")),
    "ParallelAxesJoint": _PARALLEL,
    "PerpendicularJoint": (Row("cosine"),),
    "NoRotationJoint": (Row("cosine", 1, 0), *_PARALLEL),
    "ConstantVelocityJoint": (Row("sides"),),
    "AngleJoint": (Row("cosine"),),
    "SphSphJoint": (Row("distance"),),
    "CylSphJoint": (Row("distance across"),),
    "RevCylJoint": (Row("distance across"), *_PARALLEL),
    "RevRevJoint": (Row("distance across"), Row("slide"), *_PARALLEL),
    "ScrewJoint": (Row("slide and turn"),),
    "RackPinionJoint": (Row("slide and turn", i=0),),
    "GearJoint": (Row("wheels"),),
}
"""The joints that are rows between their markers; an atomic joint of such is one of several."""

_NUMBERS = {"AngleJoint": "theIzJz", "ScrewJoint": "pitch", "RackPinionJoint": "pitchRadius"}
_NUMBERS |= {"PointInPlaneJoint": "offset", "LineInPlaneJoint": "offset", "PlanarJoint": "offset"}
_NUMBERS |= dict.fromkeys(
    ("SphSphJoint", "CylSphJoint", "RevCylJoint", "RevRevJoint"), "distanceIJ"
)

_HEADS = ("freeCAD: 3D CAD with Motion Simulation  by  askoh.com", "OndselSolver")
_DEEPEST = 40


@dataclass(eq=False)
class _Line:
    """A line, and what stands below it one tab further."""

    text: str
    at: int
    below: list[_Line] = field(default_factory=list)

    @property
    def where(self) -> str:
        return f"line {self.at}, {self.text[:40]}"


def read(path: Path, text: str) -> Model:
    """Return the model of a file. Raises :class:`.ModelFileError`, which names line and element."""
    return _Reader(Model(path.stem, path.name, gravity=(0.0, 0.0, 0.0)), text).read()


class _Reader:
    """A file under way: the model, and where its markers are."""

    def __init__(self, model: Model, text: str) -> None:
        self.model = model
        self.markers: dict[str, tuple[str, Frame]] = {}
        self.named: dict[str, str] = {}
        self.root = self.tree(text)

    def read(self) -> Model:
        """Return the model."""
        model, root = self.model, self.root
        local = self.value(root, "Name")
        model.name = model.name_of("mechanism", local, root.where, {})
        if not np.allclose(self.frame(root).axes, np.eye(3)) or any(self.frame(root).place):
            model.notes.append(
                "The placement of the assembly itself is ignored: the assembly is the ground."
            )
        self.points(root, GROUND, f"/{local}")
        for part in self.all(root, "Parts"):
            if part.text != "Part":
                raise model.refuse(part.where, "is not supported here; expected a Part")
            self.part(part, f"/{local}")
        sets = self.below(root, "ConstraintSets")
        for joint in self.all(sets, "Joints"):
            self.joint(joint, f"/{local}")
        for motion in self.all(sets, "Motions"):
            self.motion(motion)
        for group, parent in (
            ("Limits", sets),
            ("GeneralConstraintSets", sets),
            ("ForceTorques", root),
        ):
            for one in self.all(parent, group):
                model.notes.append(f"{one.text} of line {one.at} is ignored.")
        x, y, z = self.vector(root, "ConstantGravity")
        model.gravity = (float(x), float(y), float(z))
        self.times()
        return model

    def tree(self, text: str) -> _Line:
        """Return the line ``Assembly``, with what is below it; the series after it are left out."""
        lines = text.splitlines()
        if not lines or lines[0].strip() not in _HEADS:
            raise self.model.refuse("line 1", "expected the first line of an assembly of FreeCAD")
        root = _Line("", 0)
        above = [root]
        for at, line in enumerate(lines[1:], 2):
            if line.startswith("TimeSeries"):
                break
            data = line.lstrip("\t")
            depth = len(line) - len(data)
            if not data.strip():
                continue
            if depth > len(above) - 1 or depth > _DEEPEST:
                raise self.model.refuse(f"line {at}", "has too many tabs for what is above it")
            del above[depth + 1 :]
            above[-1].below.append(one := _Line(data.strip(), at))
            above.append(one)
        return self.below(root, "Assembly")

    def below(self, line: _Line, text: str) -> _Line:
        """Return the line of a text below another. Raises :class:`.ModelFileError` for none."""
        for one in line.below:
            if one.text == text:
                return one
        raise self.model.refuse(line.where if line.at else "", f"lacks {text}")

    def all(self, line: _Line, text: str) -> Iterator[_Line]:
        """Yield what stands below a line of this text."""
        for one in line.below:
            if one.text == text:
                yield from one.below

    def value(self, line: _Line, text: str) -> str:
        """Return the text below a line of this text."""
        found = self.below(line, text)
        return found.below[0].text if found.below else ""

    def vector(self, line: _Line, text: str) -> Array:
        """Return three numbers below a line of this text."""
        data = self.value(line, text)
        return numbers(self.model, self.below(line, text).where, data, text, 3)

    def frame(self, line: _Line) -> Frame:
        """Return a place and axes."""
        place, rows = self.vector(line, "Position3D"), self.below(line, "RotationMatrix")
        data = [numbers(self.model, rows.where, one.text, "axes", 3) for one in rows.below]
        if len(data) != 3:
            raise self.model.refuse(rows.where, "expected three rows")
        return Frame(place, rotation(self.model, rows.where, np.array(data)))

    def points(self, line: _Line, body: str, path: str) -> None:
        """Keep the markers of a body; one on a curve has no place."""
        for point in self.all(line, "RefPoints"):
            frame = self.frame(point)
            for marker in self.all(point, "Markers"):
                name = f"{path}/{self.value(marker, 'Name')}"
                self.markers[name] = (body, frame.then(self.frame(marker)))

    def part(self, line: _Line, path: str) -> None:
        """Read a body."""
        model, data = self.model, self.value(line, "Name")
        where = f"line {line.at}, Part {data}"
        name = model.name_of("body", data, where, model.bodies)
        mass = self.below(line, "PrincipalMassMarker")
        frame = self.frame(mass)
        moments = self.vector(mass, "MomentOfInertias")
        inertia = frame.axes @ np.diag(moments) @ frame.axes.T
        heavy = number(model, mass.where, self.value(mass, "Mass"), "Mass")
        model.bodies[name] = Body(name, heavy, frame.place, inertia, self.frame(line), where=where)
        self.points(line, name, f"{path}/{data}")

    def marker(self, line: _Line, text: str) -> tuple[str, Frame]:
        """Return the body and the frame of a marker that a line names."""
        data = self.value(line, text)
        if data not in self.markers:
            words = f"unknown marker '{data}'; valid: {', '.join(self.markers)}"
            raise self.model.refuse(f"line {line.at}, {line.text}", words)
        return self.markers[data]

    def joint(self, line: _Line, path: str) -> None:
        """Read a joint between two markers."""
        model, data = self.model, self.value(line, "Name")
        where = f"line {line.at}, {line.text} {data}"
        taken = {**model.joints, **model.ties}
        name = self.named[f"{path}/{data}"] = model.name_of("joint", data, where, taken)
        if line.text not in KINDS and line.text not in TIES:
            raise model.refuse(where, f"is not supported; valid: {', '.join([*KINDS, *TIES])}")
        (parent, near), (child, far) = self.marker(line, "MarkerI"), self.marker(line, "MarkerJ")
        key = _NUMBERS.get(line.text, "")
        has = any(one.text == key for one in line.below)
        value = number(model, where, self.value(line, key), key) if has else 0.0
        if line.text in KINDS:
            kind = KINDS[line.text]
            near = near.then(Frame(np.array([0.0, 0.0, value])))
            model.joints[name] = Joint(name, kind, parent, child, near, far, where=where)
        else:
            tie = Tie(name, parent, child, near, far, TIES[line.text], where)
            if line.text == "GearJoint":
                one, other = (
                    number(model, where, self.value(line, key), key)
                    for key in ("radiusI", "radiusJ")
                )
                if not one or not other:
                    raise model.refuse(where, "a radius of zero is impossible")
                value = one / other
            rows = tuple(self.row(tie, row, line.text, value) for row in tie.rows)
            model.ties[name] = Tie(name, parent, child, near, far, rows, where)

    def row(self, tie: Tie, row: Row, kind: str, value: float) -> Row:
        """Return a row of a joint with its number; one that turns keeps what it is in the file."""
        near, far = self.model.frames(tie)
        known = near.relative(far)
        if row.kind == "slide and turn":
            factor = value if kind == "RackPinionJoint" else -value / math.tau
            angle = math.atan2(known.axes[1, 0], known.axes[0, 0])
            found = float(known.place[row.i]) + factor * angle
            return Row(row.kind, row.i, value=_clean(found), factor=factor, angle=_clean(angle))
        if row.kind == "wheels":
            back = far.relative(near).place
            first = _clean(math.atan2(known.place[1], known.place[0]))
            second = _clean(math.atan2(back[1], back[0]))
            found = second + value * first
            return Row(row.kind, value=found, factor=value, angle=first, other=second)
        if kind == "AngleJoint":
            return Row(row.kind, row.i, row.j, math.cos(value))
        if row.kind.startswith("distance"):
            return Row(row.kind, row.i, row.j, value**2)
        return Row(row.kind, row.i, row.j, value) if row.kind == "slide" else row

    def motion(self, line: _Line) -> None:
        """Read the motion of a joint."""
        model, data = self.model, self.value(line, "Name")
        where = f"line {line.at}, {line.text} {data}"
        laws: Mapping[str, tuple[str, str]] = {
            "RotationalMotion": ("RotationZ", "turn"),
            "TranslationalMotion": ("TranslationZ", "slide"),
        }
        if line.text not in laws:
            raise model.refuse(where, f"is not supported; valid: {', '.join(laws)}")
        key, direction = laws[line.text]
        path = self.value(line, "MotionJoint")
        joint = model.joints.get(self.named.get(path, ""))
        if joint is None:
            valid = ", ".join(path for path, name in self.named.items() if name in model.joints)
            raise model.refuse(where, f"unknown joint '{path}'; valid: {valid}")
        single = {"revolute": "turn", "prismatic": "slide"}.get(joint.kind)
        coordinate = joint.name if single == direction else f"{joint.name}:{direction}"
        model.motions[coordinate] = Law(self.value(line, key), where=where)

    def times(self) -> None:
        """Read the instants, where the file has a simulation."""
        if not any(one.text == "SimulationParameters" for one in self.root.below):
            return
        data = self.below(self.root, "SimulationParameters")
        start, stop, step = (
            number(self.model, data.where, self.value(data, key), key)
            for key in ("tstart", "tend", "hout")
        )
        count = round((stop - start) / step) + 1 if step > 0.0 else 101
        self.model.span = (start, stop, count if 1 < count <= 100_001 else 101)


def _clean(value: float) -> float:
    """Return a number, zero where it is a drawing's rounding of it."""
    return value if abs(value) > 1e-9 else 0.0
