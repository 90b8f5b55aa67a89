"""Robots as URDF: links, joints, and what people add for loops.

The root link is the ground. Links without mass that are fixed to another one are frames of it.
Loops are given by a second joint of a link, and by ``<constraint>`` (proposed for urdfdom),
``<loop>`` and ``<coupling>`` (URDF+), ``<loop_joint>`` (Isaac Sim), ``<drake:ball_constraint>``
and joints of SDF in ``<gazebo>``.
"""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np

from ...errors import listed, shown
from .file_elements import Element, note_unread, parsed, six_moments
from .file_frames import Frame
from .posture import outward
from .record import GROUND, Body, Coupling, Joint, Model
from .sdf import Joints, resist

KINDS: dict[str, str] = {
    "revolute": "revolute",
    "continuous": "revolute",
    "prismatic": "prismatic",
    "fixed": "weld",
    "floating": "free",
    "planar": "planar",
    "spherical": "spherical",
    "ball": "spherical",
    "universal": "universal",
    "cylindrical": "cylindrical",
}
"""Types of joints; those after ``planar`` are of loops alone in most dialects."""

_ONE = ("parent", "predecessor", "link1")
_OTHER = ("child", "successor", "link2")


def read(model: Model, text: str) -> None:
    """Read a file. Raises :class:`.ModelFileError`, which names line and element."""
    root = parsed(model, text, "robot")
    for one in root.inside:
        if one.name.startswith("xacro:"):
            raise one.refuse(
                f"is a macro of xacro; expand it first: xacro {model.file.name} > expanded.urdf"
            )
    model.name = model.name_of("mechanism", root.given.get("name", model.name), root.where)
    _Robot(model, root).read()
    note_unread(model, root)


class _Robot:
    """A robot under way: its links by name, and the body and the frame on it that each is."""

    def __init__(self, model: Model, root: Element) -> None:
        self.model, self.root = model, root
        self.links, self.joints = root.by_name("link"), list(root.all("joint"))
        self.on: dict[str, tuple[str, Frame]] = {}

    def read(self) -> None:
        """Read the robot."""
        joints = [
            SimpleNamespace(line=one, parent=self.end(one, _ONE)[0], child=self.end(one, _OTHER)[0])
            for one in self.joints
        ]
        children = {one.child for one in joints}
        roots = [name for name in self.links if name not in children]
        if len(roots) != 1:
            none = "none: each link is the child of a joint" if self.links else "no link"
            found = ", ".join(map(repr, roots)) or none
            raise self.root.refuse(f"expected one root link, found {found}")
        self.on[roots[0]] = (GROUND, Frame())
        if self.model.floating:
            for one in joints:
                if one.parent == roots[0] and one.line.attribute("type") == "floating":
                    raise one.line.refuse(f"frees {shown(one.child)} already: leave floating out")
            self.on[roots[0]] = (name := self.body(roots[0], Frame()), Frame())
            self.model.base(name, self.links[roots[0]].where)
        for one in outward(joints, {roots[0]}, down=True):
            self.grow(one.line, one.parent, one.child)
        for one in joints:
            if one.parent not in self.on:
                raise one.line.refuse("its links are not connected to the root")
        for loop in self.root.all("constraint", "loop", "loop_joint"):
            self.loop(loop)
        for line in self.root.all("drake:ball_constraint"):
            self.ball_constraint(line)
        for joint in self.joints:
            if (mimic := joint.first("mimic")) is not None:
                name, leader = joint.attribute("name"), mimic.attribute("joint")
                ratio, offset = mimic.amount("multiplier", 1.0), mimic.amount("offset", 0.0)
                self.model.follow(name, leader, mimic.where, ratio, offset)
        above = {one.child: one for one in reversed(joints)}
        for coupling in self.root.all("coupling"):
            self.coupling(coupling, above)
        self.gazebo()
        self.actuators()

    def grow(self, line: Element, parent: str, child: str) -> None:
        """Read a joint: its link is placed by it, or closes a loop."""
        kind = line.choice("type", KINDS)
        origin, stated = self.origin(line.optional("origin")), line.attribute("name")
        if child not in self.on:
            body, frame = self.on[parent]
            if kind == "weld" and self.links[child].first("inertial") is None:
                self.on[child] = (body, frame.then(origin))
                self.model.spots[child] = self.on[child]
                self.model.named["joint", stated] = ""
                return
            self.on[child] = (self.body(child, self.placed(parent).then(origin)), Frame())
        axes = self.axes(line, kind)
        name = self.add(line, kind, (parent, origin.then(axes)), (child, axes))
        resist(self.model, name, line, Element.amount)

    def placed(self, link: str) -> Frame:
        """Return where a link is in the zero posture."""
        body, frame = self.on[link]
        return self.model.frame_of(body).then(frame)

    def add(
        self, line: Element, kind: str, one: tuple[str, Frame], other: tuple[str, Frame]
    ) -> str:
        """Declare a joint between frames of two links; return its name here."""
        ends = [self.on[link][1].then(frame) for link, frame in (one, other)]
        bodies = [self.on[link][0] for link, _ in (one, other)]
        return self.model.add(Joint, line.attribute("name"), line.where, kind, *bodies, *ends)

    def loop(self, line: Element) -> None:
        """Read a loop that an element of its own closes."""
        kind, axis = line.choice("type", KINDS), line.first("parent_axis", "axis")
        (parent, near), (child, far) = self.side(line, _ONE), self.side(line, _OTHER)
        near = near.then(self.axes(line, kind, "parent_axis", "axis"))
        apart = kind == "universal" or line.first("child_axis") is not None
        if axis is not None and not apart and axis.given.get("frame") == "parent":
            axis.taken.add("frame")
            # The axis is given on the parent alone: the child's is where it is at zero.
            known = self.placed(child).relative(self.placed(parent).then(near))
            far = Frame(far.place, self.model.rotation(line.where, known.axes))
        else:
            far = far.then(self.axes(line, kind, "child_axis" if apart else "parent_axis", "axis"))
        self.add(line, kind, (parent, near), (child, far))

    def ball_constraint(self, line: Element) -> None:
        """Read a ball constraint of Drake's."""
        sides = []
        for letter, point in (("A", "p_AP"), ("B", "p_BQ")):
            body = line.needed(f"drake:ball_constraint_body_{letter}")
            at = line.needed(f"drake:ball_constraint_{point}").numbers("value", what=point)
            sides.append((body.known("link", body.attribute("name"), self.links), Frame(at)))
        line.given.setdefault("name", f"ball_{len(self.model.joints)}")
        self.add(line, "spherical", sides[0], sides[1])

    def coupling(self, line: Element, above: dict[str, SimpleNamespace]) -> None:
        """Read a coupling of two links' joints, of those by the links above which they are."""
        links = [self.end(line, side)[0] for side in (_ONE, _OTHER)]
        for link in links:
            if link not in above:
                raise line.refuse(f"link {shown(link)} has no joint")
        if len({above[link].parent for link in links}) > 1:
            raise line.refuse("is supported only if both its links have the same parent")
        joints = [self.model.named["joint", above[link].line.attribute("name")] for link in links]
        ratio = line.needed("ratio").amount("value", what="ratio")
        self.model.add(Coupling, line.attribute("name"), line.where, *joints, ratio)

    def gazebo(self) -> None:
        """Read what Gazebo adds: joints of SDF, and which links have no weight."""
        model, more = self.model, Element(self.model, "gazebo", 0)
        for line in self.root.all("gazebo"):
            if not (stated := str(line.stated("reference", ""))):
                more.inside += line.all("joint")
            elif body := model.bodies.get(model.named.get(("body", stated), "")):
                off = line.switch("turnGravityOff", False) or not line.switch("gravity", True)
                model.bodies[body.name] = replace(body, weight=float(not off))
        on = {"world": GROUND} | {link: self.on[link][0] for link in self.links}
        placed = {"world": Frame()} | {link: self.placed(link) for link in self.links}
        Joints(model, more.by_name("joint"), on, placed).read()

    def actuators(self) -> None:
        """Read which joints have a drive, its ratio, and the inertia of its rotor."""
        model, fixed, own = self.model, [], list(self.root.all("transmission", "ros2_control"))
        for group in (line for one in own for line in (one, *one.all("transmission"))):
            parts = [group, *group.all("joint", "actuator")]
            for joint in group.all("joint"):
                if group.name == "transmission" or joint.first("command_interface") is not None:
                    if name := model.moving(stated := joint.attribute("name")):
                        model.preferred.append(name)
                        self.rotor(name, parts)
                    else:
                        fixed.append(stated)
        if fixed:
            model.notes.append(
                f"Drives of joints that are fixed or not in the file: {listed(fixed)}."
            )

    def rotor(self, joint: str, parts: list[Element]) -> None:
        """Read the ratio and the rotor's inertia of a joint's transmission, from any of its
        ``parts``.
        """
        found = {"ratio": 0.0, "rotor_inertia": 0.0}
        for part in parts:
            for key in ("mechanicalReduction", "mechanical_reduction"):
                found["ratio"] = part.inner(key) or found["ratio"]
            for key, word in (("gear_ratio", "ratio"), ("rotor_inertia", "rotor_inertia")):
                if (line := part.first(f"drake:{key}")) is not None:
                    found[word] = line.amount("value", what=key)
        self.model.motor(joint, **found)

    def body(self, stated: str, frame: Frame) -> str:
        """Declare a link as a body."""
        link = self.links[stated]
        inertial = link.optional("inertial")
        mass = inertial.needed("mass").amount("value", what="mass") if inertial.seen else 0.0
        centre, moments = self.origin(inertial.optional("origin")), inertial.optional("inertia")
        inertia = centre.tensor(six_moments(moments.amount))
        return self.model.add(Body, stated, link.where, mass, centre.place, inertia, frame)

    def axes(self, line: Element, kind: str, *names: str) -> Frame:
        """Return a frame whose z is the axis of a joint, where its kind has one."""
        if kind in ("weld", "free", "spherical"):
            return Frame()
        if (found := line.first(*(names or ("axis",)))) is None:
            line.usual("axis", "1 0 0")
            return Frame.about(np.array([1.0, 0.0, 0.0]))
        return Frame.about(found.direction("xyz", "axis"))

    def origin(self, line: Element) -> Frame:
        """Return the frame that ``xyz`` and ``rpy`` of an element give."""
        return Frame.posed(line.numbers("xyz", "0 0 0"), line.numbers("rpy", "0 0 0"))

    def end(self, line: Element, names: tuple[str, ...]) -> tuple[str, Element]:
        """Return one link of a joint or a loop, and the element that names it."""
        found = line.first(*names)
        if found is None and names == _OTHER:  # some write link1 twice
            found = next(iter(list(line.all("link1"))[1:2]), None)
        found = found or line.needed(*names)
        return line.known("link", found.attribute("link"), self.links), found

    def side(self, line: Element, names: tuple[str, ...]) -> tuple[str, Frame]:
        """Return one link of a loop, and the frame on it that the dialect gives."""
        link, found = self.end(line, names)
        origin = found.first("origin") or line.first(f"{found.name}_origin") or found
        return link, self.origin(origin)
