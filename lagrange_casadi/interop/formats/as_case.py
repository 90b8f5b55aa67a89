"""A record as the text of a case: what a person would have written, with the public API alone.

All lies in the reference posture: links between two places, joints at a place. A joint whose frames
are apart there, of a loop that closes elsewhere, is between points of its bodies.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from ...base.arrays import Array
from .file_frames import Frame
from .motion_texts import LawError, parsed
from .places import Places
from .posture import about_z, at_reference, extent, opened
from .python_text import Call, comment, direction, of_pi, safe, short, signed, text_of, vector
from .record import GROUND, MOVES, Body, Coupling, Joint, Model, Spring

_FRAME = '''

def frame(m, body, at, x, y):
    """Return the place of a frame that a body carries, and its three axes."""
    ends = ([a + b for a, b in zip(at, along)] for along in ((0.0, 0.0, 0.0), x, y))
    place, first, second = (ca.vertcat(*m.place(m.at(body, *end))) for end in ends)
    return place, first - place, second - place, ca.cross(first - place, second - place)
'''
_TURNED = '''

def turned(angle, cosine, sine):
    """Return an angle that joints count, with the forces of what turns against what."""
    return angle + sine * ca.cos(angle) - cosine * ca.sin(angle)
'''

_SMOOTH = "smooth=0.001"
"""The rate within which dry friction grows, so that a joint at rest has a definite effort."""

_OWN = f"""
from math import pi

import casadi as ca

from lagrange_casadi import Scene, SpatialMechanism
from lagrange_casadi.motion import expression, polynomial, samples
{_FRAME}{_TURNED}
m, laws, scene, t = None, None, None, None
p, x, y, z = q, u, v, w = frame()
turn, first, second = None, None, None
"""
NAMES = frozenset(compile(_OWN, "names", "exec").co_names)
"""The names that a case with all features uses by itself, which no variable of a part may have."""


class CaseText:
    """The lines of a case under way, of a checked model."""

    def __init__(self, model: Model) -> None:
        self.model, self.size, self.open = model, extent(model), opened(model)
        self.counted = [name for name in model.joints if self.counts_turns(name)]
        self.open = dict.fromkeys(self.counted, (0.0, 0.0)) | self.open
        self.places = Places(model, self.open, NAMES)
        self.variables = self.places.variables
        self.lines: list[str] = []
        turned = {*self.open, *(one.joint for one in model.springs if one.stiffness)}
        self.turned = {end for one in model.closures if one.name in turned for end in one.ends}
        self.used = {end for one in model.couplings.values() for end in (one.first, one.second)}
        self.used |= {*model.motors, *(one.joint for one in model.springs)}
        self.stated = {
            here: stated
            for (kind, stated), here in model.named.items()
            if kind != "mechanism" and stated != here
        }

    def offset(self, coordinate: str) -> float:
        """Return what a coordinate of the file is where that of the case is zero: a case counts
        from the reference posture, but those of joints that are open as in the file.
        """
        if coordinate.partition(":")[0] in self.open:
            return 0.0
        return at_reference(self.model, coordinate, self.size)

    def law(self, coordinate: str) -> Call:
        """Return the motion of a coordinate."""
        law, less = self.model.motions[coordinate], self.offset(coordinate)
        if law.samples is not None:
            times, values = law.samples
            return Call("samples", [vector(times), vector(one - less for one in values)])
        try:
            text, value = parsed(law.text)
        except LawError as error:
            raise self.model.refuse(law.where, f"motion of '{coordinate}': {error}") from None
        if value is None:
            return Call("expression", [f"lambda t: {text}{signed(-less)}"])
        return Call("polynomial", [of_pi(value - less)])

    def counts_turns(self, name: str) -> bool:
        """Return whether the turns of a joint are counted from another posture than the reference:
        three turns, of which not the last one alone differs from zero there, have no difference.
        """
        joint = self.model.joints[name]
        turns = [one for one in joint.coordinates if ":turn_" in one]
        turned = (at_reference(self.model, one, self.size) for one in turns[:-1])
        if len(turns) < 3 or not any(turned):
            return False
        given = [one for one in turns if one in self.model.motions]
        if all(str(self.law(one)) == "polynomial(0.0)" for one in given):
            return False
        if len(given) < len(turns):
            raise self.model.refuse(
                joint.where,
                f"motion of '{given[0]}': expected one of each turn of joint '{name}',"
                " for the body is turned about several axes in the reference posture",
            )
        return True

    def text(self) -> str:
        """Return the text of the file."""
        model = self.model
        self.lines += self.places.parameters()
        if (gravity := model.gravity.tolist()) != [0.0, 0.0, -9.81]:
            self.call("m.set_gravity", *vector(gravity).arguments)
        self.lines += [f"{name} = {vector(at)}" for at, name in self.places.named.items()]
        for body in model.bodies.values():
            self.body(body)
        for joint in model.joints.values():
            self.joint(joint)
        for coupling in model.couplings.values():
            self.coupling(coupling)
        self.loads()
        self.drives()
        for tie in model.ties.values():
            self.called(tie.name)
            self.lines += _tie_lines(self.places, tie)
        for body in model.bodies.values():
            for name, place in body.places.items():
                point = self.places.point(body.name, body.frame.at(place))
                self.call("m.path", json.dumps(name), point)
        self.end()
        return self.imports() + "".join(f"    {line}\n" for line in self.lines)

    def call(self, function: str, *arguments: object) -> None:
        """Write a call."""
        self.lines += Call(function, arguments).lines()

    def own(self, wanted: str) -> str:
        """Return a name for a load of the case, as text."""
        return json.dumps(self.places.own(wanted))

    def called(self, name: str) -> None:
        """Write what a part is called in the file, where that is no name here."""
        if name in self.stated:
            self.lines.append(f"# {safe(self.stated[name])} in the file")

    def imports(self) -> str:
        """Return what stands before the declaration."""
        body, model = "\n".join(self.lines), self.model
        laws = [name for name in ("expression", "polynomial", "samples") if f"{name}(" in body]
        notes = [line for note in model.notes for line in comment(note)]
        parts = {
            f'"""{safe(f"{model.name}, as {model.file.name} describes it.")}"""\n': True,
            "\n".join(["", *notes, ""]): notes,
            "\nfrom math import pi\n": re.search(r"\bpi\b", body),
            "\nimport casadi as ca\n": "ca." in body,
            "\nfrom lagrange_casadi import Scene, SpatialMechanism\n": True,
            f"from lagrange_casadi.motion import {', '.join(laws)}\n": laws,
            _FRAME: model.ties,
            _TURNED: " = turned(" in body,
            "\n\ndef scene() -> Scene:\n": True,
            f"    m = SpatialMechanism({json.dumps(model.name)})\n": True,
        }
        return "".join(part for part, needed in parts.items() if needed)

    def body(self, body: Body) -> None:
        """Declare a body as a link between two places, all in ground axes."""
        name = self.variables[body.name] = self.places.variable(body.name)
        self.called(body.name)
        mass = self.places.mass(body)
        if body.point:
            self.lines.append(f"{name} = m.point_mass({json.dumps(body.name)}, {mass})")
            return
        base, tip = self.places.between[body.name]
        axes, centre = body.frame.axes, self.places.place(body.frame.at(body.centre))
        own = self.places.frame(body.name)
        arguments: list[object] = [json.dumps(body.name)]
        if body.name in self.places.held:
            arguments.append(Call("between=", [*map(self.places.written, (base, tip))]))
            if body.name in self.turned:
                arguments.append(direction(own.axes[:, 1], "beside"))
        else:  # no joint gives its posture: it is on its own axes
            axes = own.axes.T @ axes
            centre = self.places.place(own.relative(Frame(np.array(centre))).place)
            arguments.append(f"length={text_of(math.dist(base, tip))}")
        arguments.append(f"mass={mass}")
        if body.rod is None:
            arguments.append(vector(centre, "centre"))
            inertia = short(axes @ body.inertia @ axes.T)
            if np.array_equal(inertia, diagonal := np.diag(np.diag(inertia))):
                arguments.append(vector(np.diag(diagonal).tolist(), "inertia"))
            else:
                arguments.append(Call("inertia=", [*map(vector, inertia.tolist())]))
            arguments += ["accept_inertia=True"] if body.strange else []
        self.call(f"{name} = m.link", *arguments)

    def joint(self, joint: Joint) -> None:
        """Declare a joint at its place, or between two points where these are apart."""
        name = self.variables[f"joint {joint.name}"] = self.places.variable(joint.name)
        near, far = self.model.frames(joint)
        arguments: list[object] = [json.dumps(joint.name)]
        if joint.name in self.model.contacts:
            foot, at = self.places.point(joint.child, far.place), self.places.place(near.place)
            self.call("m.contact", *arguments, foot, f"friction={self.places.mu}", vector(at, "at"))
            return
        if joint.name in self.open:
            gap, angle = self.open[joint.name]
            if gap or angle:
                self.lines.append(
                    f"# Closes a loop elsewhere: here it is {gap:.3g} m, {angle:.3g} rad open."
                )
            parent, child = (self.places.frame(one).axes for one in joint.ends)
            arguments += map(self.places.point, joint.ends, (near.place, far.place))
            arguments += self.axes(joint, parent.T @ near.axes, far)
            if joint.kind not in ("spherical", "free", "slot") or joint.name in self.counted:
                turned = short(parent.T @ near.axes @ far.axes.T @ child, 1.0)
                arguments.append(Call("turned=", [*map(vector, turned[:, :2].T.tolist())]))
        else:
            arguments += [self.variables[joint.parent], self.variables[joint.child]]
            arguments += self.axes(joint, near.axes, far)
            arguments.append(f"at={self.places.written(self.places.at[joint.name])}")
        self.called(joint.name)
        used = self.model.ties or joint.name in self.used
        self.call(f"{name} = m.{joint.kind}" if used else f"m.{joint.kind}", *arguments)

    def axes(self, joint: Joint, axes: Array, far: Frame) -> list[object]:
        """Return the arguments that say along and about what a joint moves."""
        x, y, z = axes.T
        several = {
            "weld": (),
            "spherical": (x, y),
            "free": (x, y),
            "universal": (z, far.axes[:, 2]),
            "planar": (z, x),
        }
        given = several.get(joint.kind, (z,))
        moved = {*self.model.motions, *self.model.posture} & {*joint.coordinates}
        usual = not moved or np.array_equal(short(axes, 1.0), np.eye(3))
        if usual and joint.kind in ("spherical", "free"):
            return []
        found = [direction(*one) for one in zip(given, ("axis", "second"), strict=False)]
        return [*found, f"lead={text_of(joint.lead)}"] if joint.kind == "screw" else [*found]

    def coupling(self, one: Coupling) -> None:
        """Declare a coupling as a pair of gears."""
        joints = [self.variables[f"joint {name}"] for name in (one.first, one.second)]
        first, second = (self.offset(name) for name in (one.first, one.second))
        offset = one.offset - (second - one.ratio * first)
        law = [f"ratio={of_pi(one.ratio)}", *([f"offset={of_pi(offset)}"] if offset else [])]
        self.call("m.gear", json.dumps(one.name), *joints, *law)

    def loads(self) -> None:
        """Declare springs and dampers of joints, and what bears bodies on which not all of gravity
        acts.
        """
        for one in self.model.springs:
            joint, rest = self.variables[f"joint {one.joint}"], self.offset(one.joint)
            losses = [f"viscous={text_of(one.damping)}"] if one.damping else []
            losses += [f"coulomb={text_of(one.friction)}", _SMOOTH] if one.friction else []
            if losses:
                word = "friction" if one.friction else "damping"
                self.call("m.friction", self.own(f"{one.joint}_{word}"), joint, *losses)
            if one.stiffness and self.model.joints[one.joint].kind == "prismatic":
                self.pull(one, f"m.coordinate({joint}){signed(rest - one.rest)}")
            elif one.stiffness:
                law = f"stiffness={text_of(one.stiffness)}", f"angle={of_pi(one.rest - rest)}"
                self.call("m.torsion_spring", self.own(f"{one.joint}_spring"), joint, *law)
        for body in self.model.bodies.values():
            lift = (body.weight - 1.0) * self.model.gravity
            if body.mass and np.any(lift):
                point = self.places.point(body.name, body.frame.at(body.centre))
                self.force(f"{body.name}_lift", point, lift, self.places.mass(body))

    def drives(self) -> None:
        """Declare what is known of drives, and name frames without mass."""
        for joint, numbers in self.model.motors.items():
            given = [f"{word}={text_of(number)}" for word, number in numbers.items()]
            driven = self.variables[f"joint {joint}"]
            self.call("m.drive", self.own(f"{joint}_drive"), driven, *given)
        for stated, (body, frame) in self.model.spots.items():
            point = self.places.point(body, self.model.frame_of(body).then(frame).place)
            self.lines.append(f"{self.places.variable(stated)} = {point}")

    def pull(self, one: Spring, stretched: str) -> None:
        """Declare the spring of a joint that slides, as a force on its child along the axis, and
        the opposite one on its parent.
        """
        joint, pull = self.model.joints[one.joint], self.places.variable(f"{one.joint}_spring")
        self.lines.append(f"{pull} = {text_of(-one.stiffness)} * ({stretched})")
        near = self.model.frames(joint)[0]
        for body, sign in ((joint.child, ""), (joint.parent, "-")):
            if body != GROUND:
                along = short(self.places.frame(body).axes.T @ near.axes[:, 2], 1.0)
                point, name = self.places.point(body, near.place), f"{one.joint}_spring_{body}"
                self.force(name, point, along, f"{sign}{pull}", "turning=True")

    def force(self, name: str, point: Call, along: Array, size: str, *more: str) -> None:
        """Declare a force at a point, along a vector times a size."""
        given = [
            f"{axis}={text_of(part)} * {size}"
            for axis, part in zip("xyz", along.tolist(), strict=True)
            if part
        ]
        self.call("m.force", self.own(name), point, *given, *more)

    def end(self) -> None:
        """End with the motion of each drive."""
        model = self.model
        self.lines.append("laws = {")
        for name in (name for name in model.coordinates if name in model.motions):
            law = self.law(name)
            entry = replace(law, function=f"{json.dumps(name)}: {law.function}")
            self.lines += [f"    {line}" for line in entry.lines(",")]
        self.lines.append("}")
        start, stop, count = model.span
        end = [f"t=({text_of(start)}, {text_of(stop)}, {count})"]
        if model.posture:
            posture = model.posture.items()
            rough = {name: round(x - self.offset(name), 6) + 0.0 for name, x in posture}
            end.append(f"posture={json.dumps(rough)}")
        if model.drives is not None:
            end.append(f"drives={json.dumps(model.drives)}")
        self.call("return Scene", "m", "laws", *end)


def _tie_lines(places: Places, tie: Joint) -> Iterator[str]:
    """Yield the lines that declare a tie."""
    near, far = places.model.frames(tie)
    for names, body, frame in (("p, x, y, z", tie.parent, near), ("q, u, v, w", tie.child, far)):
        x, y, _ = (direction(axis) for axis in frame.axes.T)
        at = places.written(places.place(frame.place))
        yield from Call(f"{names} = frame", [f"m, {places.variables[body]}", at, x, y]).lines()
    turns = partial(_turns_about, places, tie)
    for k, row in enumerate(tie.rows, 1):
        name, value = tie.name if len(tie.rows) == 1 else f"{tie.name}_{k}", row.value
        if row.kind == "slide and turn":
            known = near.relative(far)
            angle = about_z(known)
            value = _clean(float(known.place[row.i]) + row.factor * angle)
            counted = turns(tie.child, 1.0) + turns(tie.parent, -1.0)
            yield from _turn("turn", counted, _clean(angle), "x", "y", "u")
        elif row.kind == "wheels":
            away = f"(q - p) / {text_of(math.dist(near.place, far.place))}"
            first, second = (
                _clean(math.atan2(at[1], at[0]))
                for at in (near.relative(far).place, far.relative(near).place)
            )
            value = second + row.factor * first
            yield from _turn("first", turns(tie.parent, -1.0), first, "x", "y", away)
            back = away.replace("q - p", "p - q")
            yield from _turn("second", turns(tie.child, -1.0), second, "u", "v", back)
        yield from Call("m.constraint", [json.dumps(name), row.text + signed(-value)]).lines()


def _turn(name: str, counted: str, start: float, x: str, y: str, along: str) -> list[str]:
    """Return an angle that coordinates of joints count, from what it is at the start."""
    guess = f"{counted.removeprefix(' + ').replace(' - ', '-', 1)}{signed(start)}"
    arguments = [guess.removeprefix(" + ") or "0", f"ca.dot({x}, {along})", f"ca.dot({y}, {along})"]
    return Call(f"{name} = turned", arguments).lines()


def _turns_about(places: Places, tie: Joint, body: str, sign: float) -> str:
    """Return by how much a body of a tie has turned about z of its first frame, as a term with a
    sign: the coordinate of the joint on which it turns, of both on the same body.
    """
    model = places.model
    along = model.frames(tie)[0].axes[:, 2]
    for joint in places.on[body]:
        names = [one for one, _, _ in MOVES[joint.kind] if one in ("", "turn")]
        mine = {*tie.ends} != {*joint.ends}
        cosine = float(model.frames(joint)[0].axes[:, 2] @ along)
        if mine and names and joint.kind != "prismatic" and abs(cosine) > 1.0 - 1e-9:
            direction = sign * (cosine if joint.child == body else -cosine)
            arguments = [places.variables[f"joint {joint.name}"]]
            arguments += [f'"{names[0]}"'] if names[0] else []
            return f" {'+' if direction > 0 else '-'} m.coordinate({', '.join(arguments)})"
    return ""


def _clean(value: float) -> float:
    """Return a number, zero where it is a drawing's rounding of it."""
    return value if abs(value) > 1e-9 else 0.0
