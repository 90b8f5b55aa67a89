"""Models as SDF: links, frames and joints of Gazebo; loops are joints like others."""

from __future__ import annotations

import numpy as np

from ..base.arrays import Array
from ..errors import shown
from .elements import Element, parsed, six_moments
from .frames import Frame
from .record import GROUND, Body, Coupling, Joint, Model

KINDS: dict[str, str] = {
    "revolute": "revolute",
    "continuous": "revolute",
    "prismatic": "prismatic",
    "ball": "spherical",
    "universal": "universal",
    "revolute2": "universal",
    "screw": "screw",
    "fixed": "weld",
    "gearbox": "",
}
"""Types of joints; a gearbox couples two others."""

_DEEPEST = 200
_IGNORED = ("pose", "link", "joint", "frame", "static", "self_collide", "enable_wind")


def read(model: Model, text: str) -> None:
    """Read a file. Raises :class:`.ModelFileError`, which names line and element."""
    root = parsed(model, text, "sdf")
    world = root.first("world")
    model.gravity = np.array([0.0, 0.0, -9.8])  # of a world whose file gives none
    if world is not None and (line := world.first("gravity")) is not None:
        model.gravity = line.numbers("gravity", 3)
    line = (world or root).needed("model")
    for one in (world or root).all("model"):
        if one is not line:
            named = shown(one.given.get("name"))
            model.notes.append(f"Model {named} of line {one.line} is ignored.")
    for one in root.all("world"):
        if one is not world:
            one.ignore()
    model.name = model.name_of("mechanism", line.attribute("name"), line.where)
    _Reader(model, line).read()


class _Reader:
    """A model under way: its links, frames and joints by name."""

    def __init__(self, model: Model, line: Element) -> None:
        self.model, self.line = model, line
        self.named = line.by_name("link", "frame", "joint")
        self.placed: dict[str, Frame] = {}
        self.own = self.pose(line.first("pose"))

    def read(self) -> None:
        """Read the model."""
        model, joints = self.model, list(self.line.all("joint"))
        for link in self.line.all("link"):
            self.body(link)
        for joint in joints:
            if kind := joint.choice("type", KINDS):
                self.joint(joint, kind)
        on = model.joints_on()
        for joint in joints:
            self.couplings(joint, on)
        hung = {name for one in model.joints.values() for name in (one.parent, one.child)}
        if GROUND not in hung and model.bodies:
            first = next(iter(model.bodies.values()))
            model.attach(first.name, GROUND, "weld", first.where)
            model.notes.append(f"No joint leads to the world: '{first.name}' is fixed.")
        for one in self.line.inside:
            if one.name in ("model", "include"):
                raise one.refuse("is not supported; put its links into the model itself")
            if one.name not in _IGNORED:
                one.ignore()

    def body(self, link: Element) -> None:
        """Declare a link as a body."""
        inertial = link.first("inertial")
        if inertial is None or (moments := inertial.first("inertia")) is None:
            words = "lacks <inertia>, in place of which Gazebo has 1 kg and 1 kg m^2"
            raise (inertial or link).refuse(words)
        mass, centre = inertial.inner("mass", 1.0), self.pose(inertial.first("pose"))
        inertia, name = centre.tensor(six_moments(moments.inner, 1.0)), link.attribute("name")
        given = mass, centre.place, inertia, self.frame(name, ())
        self.model.add(Body, name, link.where, *given)

    def joint(self, line: Element, kind: str) -> None:
        """Declare a joint, whose frames coincide as the model stands."""
        model, data, lead = self.model, line.attribute("name"), 0.0
        parent, child = self.end(line, "parent"), self.end(line, "child")
        near = far = frame = self.frame(data, ())
        if kind in ("revolute", "prismatic", "screw", "universal"):
            first = self.axis(line, "axis", frame)
            near = far = Frame.about(first, frame.place)
            if kind == "universal":
                second = self.axis(line, "axis2", frame)
                if abs(first @ second) > 1e-6:
                    raise line.refuse("its two axes are not at right angles")
                far = Frame.about(second, frame.place)
        if kind == "screw":
            lead = line.needed("screw_thread_pitch").inner()
        near, far = model.frame_of(parent).relative(near), model.frame_of(child).relative(far)
        model.add(Joint, data, line.where, kind, parent, child, near, far, lead)

    def couplings(self, line: Element, on: dict[str, list[str]]) -> None:
        """Declare what ties a joint to another one, a mimic or a gearbox, by the joints on each
        body.
        """
        model, data, axis = self.model, line.attribute("name"), line.first("axis")
        if axis is not None and (mimic := axis.first("mimic")) is not None:
            keys = ("multiplier", "offset", "reference")
            ratio, offset, reference = (mimic.inner(key) for key in keys)
            joints, offset = (mimic.attribute("joint"), data), offset - ratio * reference
            model.couple(f"{data}_mimic", mimic.where, joints, ratio, offset)
        if line.given["type"] != "gearbox":
            return
        ratio = line.inner("gearbox_ratio", 1.0)
        carrier = line.needed("gearbox_reference_body").text
        ends = []
        for side in ("parent", "child"):
            body = self.end(line, side)
            bodies = {body, model.named.get(("body", carrier), GROUND)}
            mine = (model.joints[name] for name in on[body])
            found = [one.name for one in mine if {one.parent, one.child} == bodies]
            if len(found) != 1:
                words = f"its {side} has no joint on the reference body {shown(carrier)}"
                raise line.refuse(words)
            ends += found
        model.add(Coupling, data, line.where, *ends, -ratio)

    def axis(self, line: Element, key: str, frame: Frame) -> Array:
        """Return the direction of a joint's axis, on the ground's axes."""
        data = line.needed(key)
        xyz, given, on = data.first("xyz"), np.array([0.0, 0.0, 1.0]), frame
        if xyz is not None:
            given = xyz.numbers("xyz", 3)
            if expressed := xyz.given.get("expressed_in"):
                on = self.known(xyz, expressed, ())
        legacy = data.first("use_parent_model_frame")
        if legacy is not None and legacy.text in ("1", "true"):
            on = self.own
        given = self.model.direction(data.where, given)
        return np.asarray(on.axes @ given / np.linalg.norm(given))

    def end(self, line: Element, key: str) -> str:
        """Return the body of a joint's parent or child, which may be given by a frame on it."""
        data = line.needed(key)
        name = data.text
        for _ in range(len(self.named) + 1):
            if name == "world":
                return GROUND
            if ("body", name) in self.model.named:
                return self.model.named["body", name]
            frame = self.named.get(name)
            if frame is None or frame.name != "frame":
                break
            name = frame.given.get("attached_to", "")
        valid = ", ".join(["world", *(one.given["name"] for one in self.line.all("link"))])
        raise data.refuse(f"unknown link {shown(data.text)}; valid: {valid}")

    def frame(self, name: str, above: tuple[str, ...]) -> Frame:
        """Return where a link, frame or joint is; poses may be given relative to each other."""
        if name in self.placed:
            return self.placed[name]
        line = self.named[name]
        if name in above or len(above) > _DEEPEST:
            what = "itself" if name in above else "too many others"
            raise line.refuse(f"its pose is relative to {what}")
        pose, on = line.first("pose"), ""
        if pose is not None:
            on = pose.given.get("relative_to", "") or pose.given.get("frame", "")
        if not on and line.name == "joint":
            on = line.needed("child").text
        elif not on and line.name == "frame":
            on = line.given.get("attached_to", "")
        self.placed[name] = self.known(line, on, (*above, name)).then(self.pose(pose))
        return self.placed[name]

    def known(self, line: Element, name: str, above: tuple[str, ...]) -> Frame:
        """Return the frame of a name."""
        if name in ("", "__model__"):
            return self.own
        if name == "world":
            return Frame()
        return self.frame(line.known("frame", name, self.named), above)

    def pose(self, line: Element | None) -> Frame:
        """Return the frame of a pose: a place, and roll, pitch and yaw."""
        if line is None or not line.text:
            return Frame()
        if line.given.get("rotation_format", "euler_rpy") != "euler_rpy":
            raise line.refuse("rotation_format: expected euler_rpy")
        six = line.numbers("pose", 6)
        angles = np.radians(six[3:]) if line.given.get("degrees") in ("true", "1") else six[3:]
        return Frame.posed(six[:3], angles)
