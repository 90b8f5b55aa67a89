"""Models as SDF: links, frames and joints of Gazebo; loops are joints like others."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from ...errors import shown
from .file_elements import DEEPEST, Element, note_unread, parsed, six_moments
from .file_frames import Frame
from .record import GROUND, Body, Coupling, Joint, Model, Spring

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

_DYNAMICS = ("damping", "spring_stiffness", "spring_reference", "friction")
"""Numbers of what resists the motion of a revolute or prismatic joint."""


def read(model: Model, text: str) -> None:
    """Read a file: the first model that moves, of its first world or on its own.

    Raises :class:`.ModelFileError`, which names line and element.
    """
    root = parsed(model, text, "sdf")
    world = root.first("world") or root
    found = [one for one in world.inside if one.name == "model"]
    line = next((one for one in found if not one.switch("static", False)), None)
    if line is None:
        raise world.refuse("has no model that moves" if found else "lacks <model>")
    line.seen, model.gravity = True, np.array([0.0, 0.0, -9.8])  # of a world that gives none
    for one in (world.first("physics"), world):
        if one is not None and (given := one.first("gravity")) is not None:
            model.gravity = given.numbers("", "", "gravity")
    model.name = model.name_of("mechanism", line.attribute("name"), line.where)
    # Axes are on the frame of the model until 1.4, and on that of the joint since.
    on_model = root.stated("version", "1.7") in ("1.0", "1.2", "1.3", "1.4")
    named = line.by_name("link", "frame", "joint")
    if "world" in named:
        raise named["world"].refuse("the name is that of the ground; expected another one")
    for one in line.all("frame"):
        one.seen = False  # until something lies on it
    joints = Joints(
        model, named, {"world": GROUND}, {"world": Frame()}, _pose(line.optional("pose")), on_model
    )
    for name, link in ((name, one) for name, one in named.items() if one.name == "link"):
        joints.on[name] = _body(model, link, joints.frame(name))
    joints.read()
    for name, one in named.items():
        if one.name == "frame" and (body := joints.body_of(name)):
            model.spots[name] = body, model.frame_of(body).relative(joints.frame(name))
    if model.bodies and not model.joints_on()[GROUND]:
        first = next(iter(model.bodies.values()))
        model.base(first.name, first.where)
        if not model.floating:
            model.notes.append(f"No joint leads to the world: '{first.name}' is fixed.")
    for one in line.all("model", "include"):
        raise one.refuse("is not supported; put its links into the model itself")
    note_unread(model, root)


@dataclass(eq=False)
class Joints:
    """Joints of a model under way, which are ``named`` with what else has a place.

    ``on`` are the links with their bodies, ``placed`` are the frames that are known, and ``own`` is
    that of the model, on which axes are if they are ``on_model``.
    """

    model: Model
    named: dict[str, Element]
    on: dict[str, str]
    placed: dict[str, Frame]
    own: Frame = field(default_factory=Frame)
    on_model: bool = False

    def read(self) -> None:
        """Read the joints."""
        joints = [one for one in self.named.values() if one.name == "joint"]
        for joint in joints:
            if kind := joint.choice("type", KINDS):
                self.joint(joint, kind)
        on = self.model.joints_on()
        for joint in joints:
            self.couplings(joint, on)

    def joint(self, line: Element, kind: str) -> None:
        """Declare a joint, whose frames coincide as the model stands."""
        model, data = self.model, line.attribute("name")
        parent, child = self.end(line, "parent"), self.end(line, "child")
        near = far = frame = self.frame(data)
        if kind in ("revolute", "prismatic", "screw", "universal"):
            near = far = self.axis(line, "axis", frame)
        if kind == "universal":
            far = self.axis(line, "axis2", frame)
            if abs(near.axes[:, 2] @ far.axes[:, 2]) > 1e-6:
                raise line.refuse("its two axes are not at right angles")
        lead = line.inner("screw_thread_pitch", 1.0) if kind == "screw" else 0.0
        near, far = model.frame_of(parent).relative(near), model.frame_of(child).relative(far)
        name = model.add(Joint, data, line.where, kind, parent, child, near, far, lead)
        resist(model, name, line.optional("axis"), Element.inner)
        resist(model, name, line.optional("axis2"), Element.inner, first=False)

    def couplings(self, line: Element, on: dict[str, list[Joint]]) -> None:
        """Declare what ties a joint to another one, a mimic or a gearbox, by the joints on each
        body.
        """
        model, data, axis = self.model, line.attribute("name"), line.first("axis")
        if axis is not None and (mimic := axis.first("mimic")) is not None:
            ratio = mimic.inner("multiplier", 1.0)
            offset, reference = (mimic.inner(key) for key in ("offset", "reference"))
            leader, offset = mimic.attribute("joint"), offset - ratio * reference
            model.follow(data, leader, mimic.where, ratio, offset)
        if line.given["type"] != "gearbox":
            return
        ratio = line.inner("gearbox_ratio", 1.0)
        carrier = line.needed("gearbox_reference_body").text
        ends = []
        for side in ("parent", "child"):
            body = self.end(line, side)
            bodies = {body, self.on[line.known("link", carrier, self.on)]}
            found = [one.name for one in on[body] if {*one.ends} == bodies]
            if len(found) != 1:
                raise line.refuse(f"its {side} has no joint on the reference body {shown(carrier)}")
            ends += found
        model.add(Coupling, data, line.where, *ends, -ratio)

    def axis(self, line: Element, key: str, frame: Frame) -> Frame:
        """Return a frame on the ground, at the place of a joint's, whose z is its axis."""
        data = line.optional(key)
        xyz, given, on = data.optional("xyz"), np.array([0.0, 0.0, 1.0]), frame
        if xyz.text:
            given = xyz.numbers("", "", "xyz")
        else:
            line.usual(key, "0 0 1")
        if expressed := str(xyz.stated("expressed_in", "")):
            on = self.known(xyz, expressed)
        elif data.switch("use_parent_model_frame", self.on_model):
            on = self.own
        given = self.model.direction(data.where, given)
        return Frame.about(on.axes @ given / np.linalg.norm(given), frame.place)

    def end(self, line: Element, key: str) -> str:
        """Return the body of a joint's parent or child, which may be given by a frame on it."""
        data = line.needed(key)
        return self.body_of(data.text) or self.on[data.known("link", data.text, self.on)]

    def body_of(self, name: str) -> str:
        """Return the body that a link or frame is on; empty where there is none."""
        for _ in range(len(self.named) + 1):
            if name in self.on:
                return self.on[name]
            frame = self.named.get(name)
            if frame is None or frame.name != "frame":
                break
            frame.seen, name = True, str(frame.stated("attached_to", ""))
        return ""

    def frame(self, name: str, above: tuple[str, ...] = ()) -> Frame:
        """Return where a link, frame or joint is; poses may be given relative to each other."""
        if name in self.placed:
            return self.placed[name]
        line = self.named[name]
        line.seen = True
        if name in above or len(above) > DEEPEST:
            what = "itself" if name in above else "too many others"
            raise line.refuse(f"its pose is relative to {what}")
        pose = line.optional("pose")
        on = str(pose.stated("relative_to", "") or pose.stated("frame", ""))
        if not on and line.name == "joint":
            on = line.needed("child").text
        elif not on and line.name == "frame":
            on = str(line.stated("attached_to", ""))
        self.placed[name] = self.known(line, on, (*above, name)).then(_pose(pose))
        return self.placed[name]

    def known(self, line: Element, name: str, above: tuple[str, ...] = ()) -> Frame:
        """Return the frame of a name."""
        if name in ("", "__model__"):
            return self.own
        return self.frame(line.known("frame", name, {**self.on, **self.named}), above)


def _body(model: Model, link: Element, frame: Frame) -> str:
    """Declare a link as a body; return its name here."""
    inertial = link.optional("inertial")
    if inertial.switch("auto", False):
        raise inertial.refuse("auto: is not supported; give mass and inertia")
    mass, centre = inertial.inner("mass", 1.0), _pose(inertial.optional("pose"))
    inertia = centre.tensor(six_moments(inertial.optional("inertia").inner, 1.0))
    given, weight = (mass, centre.place, inertia, frame), float(link.switch("gravity", True))
    return model.add(Body, link.attribute("name"), link.where, *given, weight=weight)


def resist(
    model: Model,
    joint: str,
    line: Element,
    number: Callable[[Element, str, float], float],
    *,
    first: bool = True,
) -> None:
    """Read what resists a joint's motion about its first axis or second one, and the largest effort
    and speed of its drive, as far as its kind can have this; what else has a number there is left.
    """
    single = first and model.joints[joint].kind in ("revolute", "prismatic")
    losses, bounds = line.optional("dynamics"), line.optional("limit")
    found = [0.0] * len(_DYNAMICS)
    for k, key in enumerate(_DYNAMICS):
        value = number(losses, key, 0.0)
        if single and (value >= 0.0 or key not in ("damping", "friction")):
            found[k] = value
        elif value:
            losses.leave(key)
    if found[2] and not found[1]:
        losses.leave("spring_reference")
    if found[0] or found[1] or found[3]:
        model.springs.append(Spring(joint, *found))
    # A number that is not positive is none.
    effort, speed = (max(number(bounds, name, 0.0), 0.0) for name in ("effort", "velocity"))
    if not model.motor(joint, effort=effort, speed=speed):
        bounds.leave("effort")
        bounds.leave("velocity")


def _pose(line: Element) -> Frame:
    """Return the frame of a pose: a place, and roll, pitch and yaw."""
    if not line.text:
        return Frame()
    if line.stated("rotation_format", "euler_rpy") != "euler_rpy":
        raise line.refuse("rotation_format: expected euler_rpy")
    six = line.numbers("", "", "pose", 6)
    angles = np.radians(six[3:]) if line.switch("degrees", False) else six[3:]
    return Frame.posed(six[:3], angles)
