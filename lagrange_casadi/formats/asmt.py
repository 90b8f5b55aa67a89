"""Assemblies of FreeCAD and OndselSolver, ``.asmt``: parts, markers, joints and motions.

A file is a tree of lines by their tabs. A joint is between two markers; what it does is along and
about z of its marker I. Curves of the series of results that a file may have are not read.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from ..base.arrays import Array
from .elements import Element
from .record import GROUND, Body, Frame, Joint, Law, Model, Row, Tie

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

_MOTIONS = {
    "RotationalMotion": ("RotationZ", "turn", "revolute"),
    "TranslationalMotion": ("TranslationZ", "slide", "prismatic"),
}
"""Property with the law of a motion, its coordinate, and the kind of joint that has it alone."""

_GENERAL = ("rIJI1", "rIJI2", "rIJI3", "angIJJ1", "angIJJ2", "angIJJ3")
"""Properties with the laws of a general motion: of the place of marker J and of its three turns."""

_HALF_TURNS = [np.diag(one) for one in ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1))]
_MARKERS = ("MarkerI", "MarkerJ")
_HEADS = ("freeCAD: 3D CAD with Motion Simulation  by  askoh.com", "OndselSolver")
_DEEPEST = 40


class _Line(Element):
    """A line, and what stands below it one tab further."""

    form = "{}"

    def below(self, name: str) -> Iterator[_Line]:
        """Yield what stands below the lines of a text below it."""
        return (one for group in self.all(name) for one in group.inside)

    def value(self, name: str) -> str:
        """Return the text below the line of a text."""
        found = self.needed(name).inside
        return found[0].name if found else ""

    def number(self, name: str, where: str = "") -> float:
        """Return the number below the line of a text."""
        return self.model.number(where or self.where, self.value(name), name)

    def vector(self, name: str) -> Array:
        """Return three numbers below the line of a text."""
        return self.model.numbers(self.needed(name).where, self.value(name), name)

    def frame(self) -> Frame:
        """Return the place and axes below it."""
        place, rows = self.vector("Position3D"), self.needed("RotationMatrix")
        axes = [self.model.numbers(rows.where, one.name, "axes") for one in rows.inside]
        if len(axes) != 3:
            raise rows.refuse("expected three rows")
        return Frame(place, self.model.rotation(rows.where, np.array(axes)))


def read(path: Path, text: str) -> Model:
    """Return the model of a file. Raises :class:`.ModelFileError`, which names line and element."""
    model = Model(path.stem, path.name, gravity=np.zeros(3))
    return _Reader(model, _tree(model, text)).read()


def _tree(model: Model, text: str) -> _Line:
    """Return the line ``Assembly``, with what is below it; the series after it are left out."""
    lines = text.splitlines()
    if not lines or lines[0].strip() not in _HEADS:
        raise model.refuse("line 1", "expected the first line of an assembly of FreeCAD")
    above = [_Line(model, "", 1)]
    for at, line in enumerate(lines[1:], 2):
        if line.startswith("TimeSeries"):
            break
        data = line.lstrip("\t")
        depth = len(line) - len(data)
        if not data.strip():
            continue
        if depth > len(above) - 1 or depth > _DEEPEST:
            raise model.refuse(f"line {at}", "has more tabs than the lines above it allow")
        del above[depth + 1 :]
        above[-1].inside.append(one := _Line(model, data.strip(), at))
        above.append(one)
    return above[0].needed("Assembly")


class _Reader:
    """A file under way: the model, and where its markers are."""

    def __init__(self, model: Model, root: _Line) -> None:
        self.model, self.root = model, root
        self.markers: dict[str, tuple[str, Frame]] = {}
        self.named: dict[str, str] = {}

    def read(self) -> Model:
        """Return the model."""
        model, root, stated = self.model, self.root, self.root.value("Name")
        model.name = model.name_of("mechanism", stated, root.where, {})
        if not np.allclose(root.frame().axes, np.eye(3)) or any(root.frame().place):
            model.notes.append(
                "The placement of the assembly itself is ignored: the assembly is the ground."
            )
        self.points(root, GROUND, f"/{stated}")
        for part in root.below("Parts"):
            if part.name != "Part":
                raise part.refuse("is not supported here; expected a Part")
            self.part(part, f"/{stated}")
        sets = root.needed("ConstraintSets")
        for joint in sets.below("Joints"):
            self.joint(joint, f"/{stated}")
        for motion in sets.below("Motions"):
            if motion.name != "AllowRotation":
                self.motion(motion)
        ignored = [one for one in sets.below("Motions") if one.name == "AllowRotation"]
        ignored += [*sets.below("Limits"), *sets.below("GeneralConstraintSets")]
        for one in (*ignored, *root.below("ForceTorques")):
            model.notes.append(f"{one.name} of line {one.line} is ignored.")
        model.gravity = root.vector("ConstantGravity")
        self.times()
        return model

    def points(self, line: _Line, body: str, path: str) -> None:
        """Keep the markers of a body; one on a curve has no place."""
        for point in line.below("RefPoints"):
            frame = point.frame()
            for marker in point.below("Markers"):
                name = f"{path}/{marker.value('Name')}"
                self.markers[name] = (body, frame.then(marker.frame()))

    def part(self, line: _Line, path: str) -> None:
        """Read a body."""
        stated, mass = line.value("Name"), line.needed("PrincipalMassMarker")
        centre, heavy = mass.frame(), mass.number("Mass")
        inertia = centre.axes @ np.diag(mass.vector("MomentOfInertias")) @ centre.axes.T
        given, where = (heavy, centre.place, inertia, line.frame()), f"{line.where} {stated}"
        name = self.model.add(Body, stated, where, *given)
        self.markers[f"{path}/{stated}/MassMarker"] = (name, centre)
        self.points(line, name, f"{path}/{stated}")

    def marker(self, line: _Line, name: str) -> tuple[str, Frame]:
        """Return the body and the frame of a marker that a line names."""
        if (data := line.value(name)) not in self.markers:
            raise line.refuse(f"unknown marker '{data}'; valid: {', '.join(self.markers)}")
        return self.markers[data]

    def joint(self, line: _Line, path: str) -> None:
        """Read a joint between two markers."""
        model, kind, value = self.model, line.name, 0.0
        stated = line.value("Name") or f"{kind}_{line.line}"
        where = f"{line.where} {stated}"
        if kind not in KINDS and kind not in TIES:
            words = f"is not supported; valid: {', '.join([*KINDS, *TIES])}"
            raise model.refuse(where, words)
        (parent, near), (child, far) = (self.marker(line, key) for key in _MARKERS)
        if line.first(key := _NUMBERS.get(kind, "")) is not None:
            value = line.number(key, where)
        if kind in KINDS:
            near = near.then(Frame(np.array([0.0, 0.0, value])))
            known = model.frame_of(parent).then(near).relative(model.frame_of(child).then(far))
            far = far.then(Frame(axes=_half_turn(KINDS[kind], known.axes)))
            name = model.add(Joint, stated, where, KINDS[kind], parent, child, near, far)
        else:
            if kind == "GearJoint":
                one, other = (line.number(key, where) for key in ("radiusI", "radiusJ"))
                if not one or not other:
                    raise model.refuse(where, "a radius of zero is impossible")
                value = one / other
            if kind == "AngleJoint" and abs(math.sin(value)) < 1e-9:
                kind = "ParallelAxesJoint"  # where the slope of the angle's cosine is zero
            frames = model.frame_of(parent).then(near), model.frame_of(child).then(far)
            rows = tuple(self.row(frames, row, kind, value) for row in TIES[kind])
            name = model.add(Tie, stated, where, parent, child, near, far, rows)
        self.named[f"{path}/{stated}"] = name

    def row(self, frames: tuple[Frame, Frame], row: Row, kind: str, value: float) -> Row:
        """Return a row of a joint with its number; one that turns keeps what it is in the file."""
        near, far = frames
        known = near.relative(far)
        if row.kind == "slide and turn":
            factor = value if kind == "RackPinionJoint" else -value / math.tau
            angle = math.atan2(known.axes[1, 0], known.axes[0, 0])
            found = float(known.place[row.i]) + factor * angle
            return replace(row, value=_clean(found), factor=factor, angle=_clean(angle))
        if row.kind == "wheels":
            back = far.relative(near).place
            first = _clean(math.atan2(known.place[1], known.place[0]))
            second = _clean(math.atan2(back[1], back[0]))
            found = second + value * first
            return replace(row, value=found, factor=value, angle=first, other=second)
        if kind == "AngleJoint":
            return replace(row, value=math.cos(value))
        if row.kind.startswith("distance"):
            return replace(row, value=value**2)
        return replace(row, value=value) if row.kind == "slide" else row

    def motion(self, line: _Line) -> None:
        """Read the motion of a joint, or of one marker against another one."""
        model, stated = self.model, line.value("Name")
        where = f"{line.where} {stated}"
        if line.name == "GeneralMotion":
            (parent, near), (child, far) = (self.marker(line, key) for key in _MARKERS)
            if line.value("RotationOrder").split() != ["1", "2", "3"]:
                raise model.refuse(where, "is supported only with the RotationOrder 1 2 3")
            name = model.add(Joint, stated, where, "free", parent, child, near, far)
            for key, coordinate in zip(_GENERAL, model.joints[name].coordinates, strict=True):
                model.motions[coordinate] = Law(_law(line.value(key)), where=where)
            return
        if line.name not in _MOTIONS:
            words = f"is not supported; valid: {', '.join([*_MOTIONS, 'GeneralMotion'])}"
            raise model.refuse(where, words)
        key, direction, single = _MOTIONS[line.name]
        joint = model.joints.get(self.named.get(path := line.value("MotionJoint"), ""))
        if joint is None:
            valid = ", ".join(path for path, name in self.named.items() if name in model.joints)
            raise model.refuse(where, f"unknown joint '{path}'; valid: {valid}")
        coordinate = joint.name if joint.kind == single else f"{joint.name}:{direction}"
        model.motions[coordinate] = Law(_law(line.value(key)), where=where)

    def times(self) -> None:
        """Read the instants, where the file has a simulation."""
        if (data := self.root.first("SimulationParameters")) is None:
            return
        start, stop, step = (data.number(key) for key in ("tstart", "tend", "hout"))
        count = round((stop - start) / step) + 1 if step > 0.0 else 101
        if stop > start:  # a drawing that was assembled only has no duration
            self.model.span = (start, stop, count if 1 < count <= 100_001 else 101)


def _half_turn(kind: str, axes: Array) -> Array:
    """Return the half turn of marker J, or none, after which its axes are along those of marker I.

    A joint holds axes at right angles, so they may point the other way; turns are of its x axis.
    """
    if kind in ("prismatic", "weld"):
        return max(_HALF_TURNS, key=lambda half: float(np.trace(axes @ half)))
    return _HALF_TURNS[int(kind in ("revolute", "cylindrical", "planar") and axes[2, 2] < 0.0)]


def _law(text: str) -> str:
    """Return a law without comments, which are in quotes, and without its marks of new lines."""
    return re.sub(r'"[^"]*"', "", text).replace("<n>", " ")


def _clean(value: float) -> float:
    """Return a number, zero where it is a drawing's rounding of it."""
    return value if abs(value) > 1e-9 else 0.0
