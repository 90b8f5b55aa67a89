"""A record as the text of a case: what a person would have written, with the public API alone.

All lies in the reference posture: links between two places, joints at a place. A joint whose frames
are apart there, of a loop that closes elsewhere, is between points of its bodies.
"""

from __future__ import annotations

import json
import keyword
import math
import re
from collections import Counter
from collections.abc import Iterable, Sequence

import numpy as np

from ..base.arrays import Array
from ..errors import escaped
from .checks import EXACT, opened
from .laws import LawError, of_pi, python, text_of, tuple_of
from .record import GROUND, MOVES, Body, Frame, Joint, Law, Model, Tie

WIDTH = 96
"""Characters of a line, at most, where it can be broken."""

_NAMES = {"m", "ca", "pi", "scene", "samples", "polynomial", "expression", "t", "laws"}
_NAMES |= {*"pqxyzuvw", "turn", "turned", "frame"}

_FRAME = '''

def frame(m, body, at, x, y):
    """Return the place of a frame that a body carries, and its three axes."""
    ends = ([a + b for a, b in zip(at, along)] for along in ((0.0, 0.0, 0.0), x, y))
    place, first, second = (ca.vertcat(*m.place(m.at(body, *end))) for end in ends)
    return place, first - place, second - place, ca.cross(first - place, second - place)
'''
_TURN = '''

def turned(angle, cosine, sine):
    """Return an angle that joints count, with the forces of what turns against what."""
    return angle + sine * ca.cos(angle) - cosine * ca.sin(angle)
'''

Place = tuple[float, float, float]


def case_text(model: Model) -> str:
    """Return the text of a case file for a checked model."""
    return _Case(model).text()


class _Case:
    """The lines of a case under way: names of variables, parameters, places."""

    def __init__(self, model: Model) -> None:
        self.model, self.open, self.size = model, opened(model), model.size()
        self.counted = [name for name in model.joints if self.counts(name)]
        self.open = dict.fromkeys(self.counted, (0.0, 0.0)) | self.open
        self.held = {GROUND}
        for joint in model.joints.values():
            self.held |= set() if joint.name in self.open else {joint.parent, joint.child}
        self.variables: dict[str, str] = {GROUND: "m.ground"}
        self.used = set(_NAMES)
        self.lines: list[str] = []
        self.known = [0.0]
        self.at: dict[str, Place] = {
            name: self.place(model.frames(joint)[1].place)
            for name, joint in model.joints.items()
            if name not in self.open
        }
        self.between = {name: self.ends(body) for name, body in model.bodies.items()}
        self.places: dict[Place, str] = {}
        self.lengths: dict[tuple[int, float], str] = {}
        self.masses: dict[float, str] = {}
        self.turning = False

    def counts(self, name: str) -> bool:
        """Return whether the turns of a joint are counted from another posture than the reference:
        three turns, of which not the last one alone differs from zero there, have no difference.
        """
        turns = [one for one in self.model.joints[name].coordinates if ":turn_" in one]
        first = [abs(self.model.at_reference(one)) for one in turns[:-1]]
        given = {one: law for one, law in self.model.motions.items() if one in turns}
        if len(turns) < 3 or max(first) < EXACT:
            return False
        if all(self.law(one, law) == "polynomial(0.0)" for one, law in given.items()):
            return False
        if len(given) < len(turns):
            words = f"motion of '{next(iter(given))}': expected one of each turn of joint '{name}'"
            words += ", for the body is turned about several axes in the reference posture"
            raise self.model.refuse(self.model.joints[name].where, words)
        return True

    def text(self) -> str:
        """Return the whole."""
        self.parameters()
        self.gravity()
        for at, name in self.places.items():
            self.lines.append(f"{name} = {self.written(at, named=False)}")
        for body in self.model.bodies.values():
            self.body(body)
        for joint in self.model.joints.values():
            self.joint(joint)
        for one in self.model.couplings.values():
            first, second = (self.variables[f"joint {name}"] for name in (one.first, one.second))
            arguments = [json.dumps(one.name), first, second, f"ratio={of_pi(one.ratio)}"]
            offset = self.offset(one.second) - one.ratio * self.offset(one.first)
            arguments += [f"offset={of_pi(one.offset - offset)}"] if one.offset - offset else []
            self.lines += _call("m.gear", arguments)
        for tie in self.model.ties.values():
            self.tie(tie)
        for body in self.model.bodies.values():
            for name, place in body.places.items():
                arguments = [json.dumps(name), self.point(body.name, body.frame.at(place))]
                self.lines += _call("m.path", arguments)
        self.end()
        return self.imports() + "".join(f"    {line}\n" if line else "\n" for line in self.lines)

    def imports(self) -> str:
        """Return what stands before the declaration."""
        body, model = "\n".join(self.lines), self.model
        head = f"{model.name}, as {model.file} describes it."
        notes = [_comment(note) for note in model.notes]
        parts = [f'"""{_safe(head)}"""\n\n']
        parts += [f"{line}\n" for note in notes for line in note] + (["\n"] if notes else [])
        parts += ["from math import pi\n\n"] if re.search(r"\bpi\b", body) else []
        parts += ["import casadi as ca\n\n"] if "ca." in body else []
        parts.append("from lagrange_casadi import Scene, SpatialMechanism\n")
        laws = [name for name in ("expression", "polynomial", "samples") if f"{name}(" in body]
        parts += [f"from lagrange_casadi.motion import {', '.join(laws)}\n"] if laws else []
        parts += [_FRAME] if model.ties else []
        parts += [_TURN] if "turned(" in body and self.turning else []
        start = f"\n\ndef scene() -> Scene:\n    m = SpatialMechanism({json.dumps(model.name)})\n"
        return "".join(parts) + start

    def parameters(self) -> None:
        """Declare what repeats: masses of several bodies, and components of several places."""
        masses = Counter(body.mass for body in self.model.bodies.values() if body.mass > 0.0)
        first = {body.mass: body.name for body in reversed(self.model.bodies.values())}
        for mass, count in masses.items():
            if count > 1:
                name = self.parameter(f"mass_{first[mass]}")
                self.masses[mass] = name
                arguments = f'"{name}", {text_of(mass)}, "kg", low=0.0'
                self.lines.append(f"{name} = m.parameter({arguments})")
        for joint, place in self.at.items():
            if place not in self.places and any(place):
                self.places[place] = self.variable(f"at_{joint}")
        joint_at = {place: joint for joint, place in reversed(self.at.items())}
        sizes = Counter((k, abs(x)) for place in self.places for k, x in enumerate(place) if x)
        for (k, size), count in sizes.items():
            if count > 1:
                owner = next(at for at in self.places if abs(at[k]) == size)
                name = self.parameter(f"{joint_at[owner]}_{'xyz'[k]}")
                self.lengths[k, size] = name
                self.lines.append(f'{name} = m.parameter("{name}", {text_of(size)}, "m")')

    def gravity(self) -> None:
        """Declare gravity where it is not the usual one."""
        if (gravity := self.model.gravity.tolist()) != [0.0, 0.0, -9.81]:
            self.lines.append(f"m.set_gravity{tuple_of(gravity)}")

    def ends(self, body: Body) -> tuple[Place, Place]:
        """Return two places that a link lies between: a joint, and the place farthest from it."""
        if body.rod is not None:
            return self.place(body.frame.at(body.rod[0])), self.place(body.frame.at(body.rod[1]))
        mine = [one for one in self.model.joints.values() if body.name in (one.parent, one.child)]
        mine.sort(key=lambda one: one.child != body.name)
        origins = []
        for joint in mine:
            near, far = self.model.frames(joint)
            origins.append(self.place((near if joint.parent == body.name else far).place))
            if joint.name in self.at:
                origins[-1] = self.at[joint.name]
        centre = self.place(body.frame.at(body.centre))
        base = origins[0]
        tip = max(origins, key=lambda place: math.dist(base, place))
        if math.dist(base, tip) < 1e-6 * self.size:
            tip = centre
        if math.dist(base, tip) < 1e-6 * self.size:
            tip = self.place(np.array(base) + body.frame.axes[:, 0] * self.size / 10.0)
        return base, tip

    def body(self, body: Body) -> None:
        """Declare a body as a link between two places, all in ground axes."""
        name = self.variables[body.name] = self.variable(body.name)
        self.called(body.name)
        mass = self.masses.get(body.mass) or text_of(body.mass)
        if body.point:
            self.lines.append(f"{name} = m.point_mass({json.dumps(body.name)}, {mass})")
            return
        base, tip = self.between[body.name]
        assert body.inertia is not None
        turn, centre = body.frame.axes, self.place(body.frame.at(body.centre))
        ends = [f"between=({self.written(base)}, {self.written(tip)})"]
        if body.name not in self.held:  # no joint gives its posture: it is on its own axes
            own = Frame(np.array(base), self.link_axes(body.name))
            turn = own.axes.T @ turn
            centre = self.place(own.relative(Frame(np.array(centre))).place)
            ends = [f"length={text_of(math.dist(base, tip))}"]
        inertia = self.settled(turn @ body.inertia @ turn.T)
        diagonal = np.diag(np.diag(inertia))
        moments = np.diag(inertia).tolist() if np.array_equal(inertia, diagonal) else inertia
        rows = tuple_of(moments) if isinstance(moments, list) else _rows(moments)
        arguments = [
            json.dumps(body.name),
            *ends,
            f"mass={mass}",
        ]
        if body.rod is None:
            arguments.append(f"centre={tuple_of(centre)}")
            arguments.append(f"inertia={rows}")
        if body.name in self.held and any(
            body.name in (self.model.joints[one].parent, self.model.joints[one].child)
            for one in self.open
        ):
            arguments.insert(2, f"beside={_tuple(self.link_axes(body.name)[:, 1])}")
        self.lines += _call(f"{name} = m.link", arguments)

    def joint(self, joint: Joint) -> None:
        """Declare a joint at its place, or between two points where these are apart."""
        name = self.variables[f"joint {joint.name}"] = self.variable(joint.name)
        parent, child = self.variables[joint.parent], self.variables[joint.child]
        near, far = self.model.frames(joint)
        arguments, axes = [json.dumps(joint.name)], near.axes
        if joint.name in self.open:
            gap, angle = self.open[joint.name]
            if gap or angle:
                self.lines.append(
                    f"# Closes a loop elsewhere: here it is {gap:.3g} m, {angle:.3g} rad open."
                )
            local = self.link_axes(joint.parent)
            turned = self.directions(local.T @ near.axes @ far.axes.T @ self.link_axes(joint.child))
            arguments += [self.point(joint.parent, near.place), self.point(joint.child, far.place)]
            axes = local.T @ near.axes
            closing = [f"turned=({_tuple(turned[:, 0])}, {_tuple(turned[:, 1])})"]
            if joint.kind in ("spherical", "free", "slot") and joint.name not in self.counted:
                closing = []
        else:
            arguments += [parent, child]
            at = self.at[joint.name]
            closing = [f"at={self.written(at)}"]
        arguments += self.axes(joint, axes, far) + closing
        self.called(joint.name)
        used = bool(self.model.ties) or any(
            joint.name in (one.first, one.second) for one in self.model.couplings.values()
        )
        self.lines += _call(f"{name} = m.{joint.kind}" if used else f"m.{joint.kind}", arguments)

    def point(self, body: str, place: Array) -> str:
        """Return a point of a body that is at a place in the reference posture."""
        if body not in self.held:
            own = Frame(np.array(self.between[body][0]), self.link_axes(body))
            place = own.relative(Frame(place)).place
            return f"{self.variables[body]}.at{tuple_of(self.place(place))}"
        at = self.written(self.place(place), inner=True)
        return f"m.ground.at({at})" if body == GROUND else f"m.at({self.variables[body]}, {at})"

    def axes(self, joint: Joint, axes: Array, far: Frame) -> list[str]:
        """Return the arguments that say along and about what a joint moves."""
        x, y, z = (_tuple(column) for column in self.directions(axes).T)
        match joint.kind:
            case "weld":
                return []
            case "spherical" | "free":
                arguments = {*self.model.motions, *self.model.posture} & {*joint.coordinates}
                usual = not arguments or np.array_equal(self.directions(axes), np.eye(3))
                return [] if usual else [f"axis={x}", f"second={y}"]
            case "universal":
                return [f"axis={z}", f"second={_tuple(self.directions(far.axes)[:, 2])}"]
            case "planar":
                return [f"axis={z}", f"second={x}"]
            case "screw":
                return [f"axis={z}", f"lead={text_of(joint.lead)}"]
        return [f"axis={z}"]

    def tie(self, tie: Tie) -> None:
        """Declare rows between two frames as constraints of places that their bodies carry."""
        self.called(tie.name)
        arguments = []
        for body, frame in zip((tie.parent, tie.child), self.model.frames(tie), strict=True):
            x, y = (_tuple(self.directions(frame.axes)[:, k]) for k in (0, 1))
            at = self.written(self.place(frame.place))
            arguments.append([f"m, {self.variables[body]}", at, x, y])
        self.lines += _call("p, x, y, z = frame", arguments[0]) + _call(
            "q, u, v, w = frame", arguments[1]
        )
        for k, row in enumerate(tie.rows, 1):
            name = tie.name if len(tie.rows) == 1 else f"{tie.name}_{k}"
            if row.kind == "slide and turn":
                parent, child = self.turns_about(tie, tie.parent), self.turns_about(tie, tie.child)
                self.turn("turn", f"{child}{_minus(parent)}", row.angle, ("x", "y", "u"))
            elif row.kind == "wheels":
                frames = self.model.frames(tie)
                away = f"(q - p) / {text_of(math.dist(frames[0].place, frames[1].place))}"
                back = away.replace("q - p", "p - q")
                parent, child = self.turns_about(tie, tie.parent), self.turns_about(tie, tie.child)
                self.turn("first", _minus(parent), row.angle, ("x", "y", away))
                self.turn("second", _minus(child), row.other, ("u", "v", back))
            said = row.text + _signed(-row.value)
            self.lines += _call("m.constraint", [json.dumps(name), said])

    def turn(self, name: str, counted: str, start: float, axes: tuple[str, str, str]) -> None:
        """Write an angle that coordinates of joints count, from what it is at the start."""
        x, y, along = axes
        guess = (
            f"{counted.removeprefix(' + ').replace(' - ', '-', 1)}{_signed(start)}".removeprefix(
                " + "
            )
            or "0"
        )
        arguments = [guess, f"ca.dot({x}, {along})", f"ca.dot({y}, {along})"]
        self.turning = True
        self.lines += _call(f"{name} = turned", arguments)

    def turns_about(self, tie: Tie, body: str) -> str:
        """Return by how much a body of a tie has turned about z of its first frame, as the
        coordinate of the joint on which it turns: of both on the same body.
        """
        along = self.model.frames(tie)[0].axes[:, 2]
        for joint in self.model.joints.values():
            names = [one for one, _, _ in MOVES[joint.kind] if one in ("", "turn")]
            mine = body in (joint.parent, joint.child) and not {tie.parent, tie.child} <= {
                joint.parent,
                joint.child,
            }
            cosine = float(self.model.frames(joint)[0].axes[:, 2] @ along)
            if mine and names and joint.kind != "prismatic" and abs(cosine) > 1.0 - 1e-9:
                direction = cosine if joint.child == body else -cosine
                arguments = [self.variables[f"joint {joint.name}"]]
                arguments += [f'"{names[0]}"'] if names[0] else []
                return f" {'+' if direction > 0 else '-'} m.coordinate({', '.join(arguments)})"
        return ""

    def end(self) -> None:
        """End with the motion of each drive."""
        model, order = self.model, [joint.coordinates for joint in self.model.joints.values()]
        laws = {name: law for names in order for name in names if (law := model.motions.get(name))}
        self.lines.append("laws = {")
        for name, law in laws.items():
            head, _, inner = self.law(name, law).partition("(")
            arguments = _call(f"{json.dumps(name)}: {head}", _parts(inner[:-1]), ",")
            self.lines += [f"    {line}" for line in arguments]
        self.lines.append("}")
        start, stop, count = model.span
        end = [f"t=({text_of(start)}, {text_of(stop)}, {count})"]
        if model.posture:
            shifted = {name: value - self.offset(name) for name, value in model.posture.items()}
            rough = ", ".join(f'"{name}": {text_of(round(x, 6))}' for name, x in shifted.items())
            end.append(f"posture={{{rough}}}")
        if model.drives is not None:
            end.append(f"drives={json.dumps(model.drives)}")
        self.lines += _call("return Scene", ["m", "laws", *end])

    def law(self, coordinate: str, law: Law) -> str:
        """Return a motion, counted from the reference posture."""
        less = self.offset(coordinate)
        if law.samples is not None:
            times, values = law.samples
            return f"samples({tuple_of(times)}, {tuple_of([one - less for one in values])})"
        try:
            return python(law.text, less)
        except LawError as error:
            words = f"motion of '{coordinate}': {error}"
            raise self.model.refuse(law.where, words) from None

    def offset(self, coordinate: str) -> float:
        """Return what a coordinate of the file is where that of the case is zero."""
        if coordinate.partition(":")[0] in self.open:
            return 0.0
        found = self.model.at_reference(coordinate)
        return 0.0 if abs(found) < EXACT * max(self.size, 1.0) else found

    def link_axes(self, body: str) -> Array:
        """Return the axes of a link as declared: x from its base to its tip, y across."""
        if body == GROUND:
            return np.eye(3)
        base, tip = (np.array(place) for place in self.between[body])
        x = (tip - base) / np.linalg.norm(tip - base)
        y = np.eye(3)[int(np.argmin(np.round(np.abs(x), 6)))]
        y = y - (y @ x) * x
        y /= np.linalg.norm(y)
        return np.column_stack([x, y, np.cross(x, y)])

    def parameter(self, wanted: str) -> str:
        """Return a name for a parameter, which no part may have."""
        parts = {*self.model.bodies, *self.model.joints, *self.model.couplings, *self.model.ties}
        while wanted in parts:
            wanted = f"{wanted}_"
        return self.variable(wanted)

    def variable(self, arguments: str) -> str:
        """Return a name for a variable that none has yet."""
        name = re.sub(r"\W", "_", arguments, flags=re.ASCII)
        name = f"{name}_" if keyword.iskeyword(name) or name in _NAMES else name
        while name in self.used:
            name = f"{name}_"
        self.used.add(name)
        return name

    def called(self, name: str) -> None:
        """Write what a part is called in the file, where that is no name here."""
        if arguments := self.model.called.get(name):
            self.lines.append(f"# {_safe(arguments)} in the file")

    def place(self, place: Array) -> Place:
        """Return a place without the rounding of sums: its components are those of places before
        where they are so but for that.
        """
        x, y, z = (self.component(one) for one in self.settled(place, self.size).tolist())
        return x, y, z

    def component(self, value: float) -> float:
        """Return a number, or one that was there before and is the same but for rounding."""
        for one in self.known:
            if abs(abs(value) - one) <= EXACT * self.size:
                return math.copysign(one, value) if one else 0.0
        self.known.append(abs(value))
        return value

    def directions(self, axes: Array) -> Array:
        """Return axes without the rounding of sums."""
        return self.settled(axes, 1.0)

    def settled(self, values: Array, size: float | None = None) -> Array:
        """Return numbers, those that are short but for the rounding of sums as short ones."""
        scale = float(np.abs(values).max()) if size is None else size
        if not scale:
            return np.zeros_like(values)
        digits = 8 - math.floor(math.log10(scale))
        short = np.round(values, digits)
        return np.asarray(np.where(np.abs(values - short) <= EXACT * scale, short, values) + 0.0)

    def written(self, place: Place, *, named: bool = True, inner: bool = False) -> str:
        """Return a place: its name, or its components, by parameters where these have them."""
        if named and not inner and place in self.places:
            return self.places[place]
        parts = []
        for k, x in enumerate(place):
            name = self.lengths.get((k, abs(x)))
            parts.append((f"-{name}" if x < 0 else name) if name else text_of(x))
        return ", ".join(parts) if inner else f"({', '.join(parts)})"


def _call(function: str, arguments: Sequence[str], after: str = "") -> list[str]:
    """Return a call in one line, or in a line for each argument, these broken like it."""
    if len(line := f"{function}({', '.join(arguments)}){after}") <= WIDTH or len(arguments) < 2:
        return [line]
    lines = [f"{function}("]
    for one in arguments:
        head, bracket, inner = one.partition("(")
        broken = [f"{one},"]
        if bracket and len(one) > WIDTH - 4 and one.endswith(")"):
            broken = _call(head, _parts(inner[:-1]), ",")
        lines += [f"    {line}" for line in broken]
    return [*lines, f"){after}"]


def _parts(text: str) -> list[str]:
    """Return what commas outside of brackets part."""
    parts, depth, start = [], 0, 0
    for k, letter in enumerate(text):
        depth += (letter in "([") - (letter in ")]")
        if letter == "," and not depth:
            parts.append(text[start:k].strip())
            start = k + 1
    return [*parts, text[start:].strip()]


def _minus(terms: str) -> str:
    """Return the opposite of one signed term."""
    return terms.replace("+", "*").replace("-", "+").replace("*", "-")


def _signed(value: float) -> str:
    """Return a number as a term of a sum; nothing for zero."""
    return "" if not value else f" + {of_pi(value)}" if value > 0 else f" - {of_pi(-value)}"


def _tuple(vector: Array) -> str:
    return tuple_of(vector.tolist())


def _rows(matrix: Array) -> str:
    return f"({', '.join(tuple_of(row) for row in matrix.tolist())})"


def _safe(text: str) -> str:
    """Return a text that ends neither a comment nor a docstring."""
    return escaped(text).replace("\\", "/").replace('"', "'")


def _comment(text: str) -> Iterable[str]:
    """Return a text as lines of a comment."""
    words, line = _safe(text).split(), "#"
    for word in words:
        if len(line) + len(word) + 1 > WIDTH and line != "#":
            yield line
            line = "#  "
        line += f" {word}"
    yield line
