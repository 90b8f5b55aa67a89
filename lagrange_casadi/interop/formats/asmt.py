"""Assemblies of FreeCAD and OndselSolver, ``.asmt``: parts, markers, joints and motions.

A file is a tree of lines by their tabs. A joint is between two markers; what it does is along and
about z of its marker I. Curves of the series of results that a file may have are not read.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator

import numpy as np

from ...base.arrays import Array
from .file_elements import Element
from .file_frames import Frame
from .record import GROUND, Body, Joint, Law, Model, Row

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

TIES: dict[str, tuple[str, Callable[[float], tuple[Row, ...]]]] = {
    "PointInPlaneJoint": ("offset", lambda x: (Row("slide", value=x),)),
    "LineInPlaneJoint": ("offset", lambda x: (Row("slide", value=x), Row("cosine"))),
    "ParallelAxesJoint": ("", lambda _: _PARALLEL),
    "PerpendicularJoint": ("", lambda _: (Row("cosine"),)),
    "NoRotationJoint": ("", lambda _: (Row("cosine", 1, 0), *_PARALLEL)),
    "ConstantVelocityJoint": ("", lambda _: (Row("sides"),)),
    "AngleJoint": ("theIzJz", lambda x: (Row("cosine", value=math.cos(x)),)),
    "SphSphJoint": ("distanceIJ", lambda x: (Row("distance", value=x**2),)),
    "CylSphJoint": ("distanceIJ", lambda x: (_across(x),)),
    "RevCylJoint": ("distanceIJ", lambda x: (_across(x), *_PARALLEL)),
    "RevRevJoint": ("distanceIJ", lambda x: (_across(x), Row("slide"), *_PARALLEL)),
    "ScrewJoint": ("pitch", lambda x: (Row("slide and turn", factor=-x / math.tau),)),
    "RackPinionJoint": ("pitchRadius", lambda x: (Row("slide and turn", i=0, factor=x),)),
    "GearJoint": ("radiusI", lambda x: (Row("wheels", factor=x),)),
}
"""The joints that are rows between their markers: the property with their number, and the rows. An
atomic joint of such is one of several.
"""


def _across(distance: float) -> Row:
    return Row("distance across", value=distance**2)


_MOTIONS = {
    "RotationalMotion": ("RotationZ", "turn", "revolute"),
    "TranslationalMotion": ("TranslationZ", "slide", "prismatic"),
}
"""Property with the law of a motion, its coordinate, and the kind of joint that has it alone."""

_GENERAL = ("rIJI1", "rIJI2", "rIJI3", "angIJJ1", "angIJJ2", "angIJJ3")
"""Properties with the laws of a general motion: of the place of marker J and of its three turns."""

_HALF_TURNS = [np.diag(one) for one in ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1))]
_HEADS = ("freeCAD: 3D CAD with Motion Simulation  by  askoh.com", "OndselSolver")
_DEEPEST = 40


class _Line(Element):
    """A line, and what stands below it one tab further."""

    form = "{}"

    def below(self, name: str) -> Iterator[_Line]:
        """Yield what stands below the lines of a text below it."""
        return (one for group in self.all(name) for one in group.inside)

    def at(self, _name: str = "") -> str:
        """Return the place of the line and the name below it, for messages."""
        return f"{self.where} {self.stated('Name', '')}".rstrip()

    def stated(self, name: str, usual: object) -> object:
        """Return the text below the line of a text."""
        if usual is not None and self.first(name) is None:
            return usual
        found = self.needed(name).inside
        return found[0].name if found else ""

    def frame(self) -> Frame:
        """Return the place and axes below it."""
        place, rows = self.numbers("Position3D"), self.needed("RotationMatrix")
        axes = [self.model.numbers(rows.where, one.name, "axes") for one in rows.inside]
        if len(axes) != 3:
            raise rows.refuse("expected three rows")
        return Frame(place, self.model.rotation(rows.where, np.array(axes)))


def read(model: Model, text: str) -> None:
    """Read a file. Raises :class:`.ModelFileError`, which names line and element."""
    _Reader(model, _tree(model, text)).read()


def _tree(model: Model, text: str) -> _Line:
    """Return the line ``Assembly``, with what is below it; the series after it are left out."""
    lines = text.splitlines()
    if not lines or lines[0].strip() not in _HEADS:
        raise model.refuse("line 1", "expected the first line of an assembly of FreeCAD")
    above = [_Line(model, lines[0].strip(), 1)]
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
    root = above[0].needed("Assembly")
    for one in above[0].inside:
        if one is not root:
            one.ignore()
    return root


class _Reader:
    """A file under way: the model, where its markers are, and which joints are ``named``."""

    def __init__(self, model: Model, root: _Line) -> None:
        self.model, self.root, self.path = model, root, f"/{root.attribute('Name')}"
        self.markers: dict[str, tuple[str, Frame]] = {}
        self.named: dict[str, str] = {}

    def read(self) -> None:
        """Read the assembly."""
        model, root = self.model, self.root
        model.drawn, model.gravity = True, root.numbers("ConstantGravity")
        model.name = model.name_of("mechanism", self.path[1:], root.where)
        if not np.allclose(root.frame().axes, np.eye(3)) or any(root.frame().place):
            model.notes.append(
                "The placement of the assembly itself is ignored: the assembly is the ground."
            )
        self.points(root, GROUND, self.path)
        for part in root.below("Parts"):
            if part.name != "Part":
                raise part.refuse("is not supported here; expected a Part")
            self.part(part)
        sets = root.needed("ConstraintSets")
        for joint in sets.below("Joints"):
            self.joint(joint)
        for motion in sets.below("Motions"):
            if motion.name == "AllowRotation":
                motion.ignore()
            else:
                self.motion(motion)
        limits, more = sets.below("Limits"), sets.below("GeneralConstraintSets")
        for one in (*limits, *more, *root.below("ForceTorques")):
            one.ignore()
        self.times()

    def points(self, line: _Line, body: str, path: str) -> None:
        """Keep the markers of a body; one on a curve has no place."""
        for point in line.below("RefPoints"):
            frame = point.frame()
            for marker in point.below("Markers"):
                name = f"{path}/{marker.attribute('Name')}"
                self.markers[name] = (body, frame.then(marker.frame()))

    def part(self, line: _Line) -> None:
        """Read a body."""
        stated, mass = line.attribute("Name"), line.needed("PrincipalMassMarker")
        centre, heavy = mass.frame(), mass.amount("Mass")
        inertia = centre.tensor(np.diag(mass.numbers("MomentOfInertias")))
        given, path = (heavy, centre.place, inertia, line.frame()), f"{self.path}/{stated}"
        name = self.model.add(Body, stated, line.at(), *given)
        self.markers[f"{path}/MassMarker"] = (name, centre)
        self.points(line, name, path)

    def ends(self, line: _Line) -> tuple[tuple[str, str], tuple[Frame, Frame]]:
        """Return the bodies and the frames of the two markers that a line names."""
        stated = (line.attribute(key) for key in ("MarkerI", "MarkerJ"))
        sides = (self.markers[line.known("marker", one, self.markers)] for one in stated)
        (parent, near), (child, far) = sides
        return (parent, child), (near, far)

    def joint(self, line: _Line) -> None:
        """Read a joint between two markers."""
        model, kind, where = self.model, line.name, line.at()
        stated = line.attribute("Name") or f"{kind}_{line.line}"
        if kind not in KINDS and kind not in TIES:
            raise model.refuse(where, f"is not supported; valid: {', '.join([*KINDS, *TIES])}")
        bodies, (near, far) = self.ends(line)
        if kind in KINDS:
            offset = line.amount("offset", 0.0) if kind == "PlanarJoint" else 0.0
            near = near.then(Frame(np.array([0.0, 0.0, offset])))
            one, other = (
                model.frame_of(body).then(at) for body, at in zip(bodies, (near, far), strict=True)
            )
            far = far.then(Frame(axes=_half_turn(KINDS[kind], one.relative(other).axes)))
            self.named[f"{self.path}/{line.attribute('Name')}"] = model.add(
                Joint, stated, where, KINDS[kind], *bodies, near, far
            )
        else:
            key, rows = TIES[kind]
            value = line.amount(key, None if kind == "GearJoint" else 0.0) if key else 0.0
            if kind == "GearJoint":
                radius = line.amount("radiusJ")
                if not value or not radius:
                    raise model.refuse(where, "a radius of zero is impossible")
                value = model.number(where, value / radius, "ratio of radii")
            if kind == "AngleJoint" and abs(math.sin(value)) < 1e-9:
                _, rows = TIES["ParallelAxesJoint"]  # the slope of the angle's cosine is zero
            model.add(Joint, stated, where, "", *bodies, near, far, rows=rows(value))

    def motion(self, line: _Line) -> None:
        """Read the motion of a joint, or of one marker against another one."""
        model, where = self.model, line.at()
        if line.name == "GeneralMotion":
            if line.attribute("RotationOrder").split() != ["1", "2", "3"]:
                raise model.refuse(where, "is supported only with the RotationOrder 1 2 3")
            bodies, frames = self.ends(line)
            name = model.add(Joint, line.attribute("Name"), where, "free", *bodies, *frames)
            for key, coordinate in zip(_GENERAL, model.joints[name].coordinates, strict=True):
                model.motions[coordinate] = Law(_law(line.attribute(key)), where=where)
            return
        if line.name not in _MOTIONS:
            raise model.refuse(
                where, f"is not supported; valid: {', '.join([*_MOTIONS, 'GeneralMotion'])}"
            )
        key, direction, single = _MOTIONS[line.name]
        path = model.known(where, "joint", line.attribute("MotionJoint"), self.named)
        joint = model.joints[self.named[path]]
        coordinate = joint.name if joint.kind == single else f"{joint.name}:{direction}"
        model.motions[coordinate] = Law(_law(line.attribute(key)), where=where)

    def times(self) -> None:
        """Read the instants, where the file has a simulation."""
        if (data := self.root.first("SimulationParameters")) is None:
            return
        start, stop, step = (data.amount(key) for key in ("tstart", "tend", "hout"))
        steps = (stop - start) / step if step > 0.0 else 0.0
        if stop > start:  # a drawing that was assembled only has no duration
            count = round(steps) + 1 if 0.5 < steps <= 100_000 else 101
            self.model.span = (start, stop, count)


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
