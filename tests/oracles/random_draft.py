"""A mechanism that is drawn part by part in a posture: as the Python that declares it, and in
numbers for the oracle.

What is drawn is placed at once, so whatever is joined fits in this posture. The package sees only
the source; the oracle sees only the numbers.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import oracle
from random_formula import Formula, Measure, Number, joint_coordinate, literal

Place = tuple[float, float]

_NOTHING = 1e-9
"""Where a number is meant to be none, it is as large as its rounding; nobody names that by a
parameter.
"""


@dataclass(frozen=True)
class Spot:
    """A point of a body: how it is written, and its place in the body's axes."""

    body: str
    text: str
    x: float
    y: float

    @property
    def point(self) -> tuple[str, float, float]:
        """The same for the oracle."""
        return self.body, self.x, self.y


class Draft:
    """A mechanism under construction; ``parametric`` is how often a number is written by a
    parameter.
    """

    def __init__(
        self, name: str, rng: np.random.Generator, parametric: float = 0.0, far: float = 0.0
    ) -> None:
        self.name, self.rng, self.parametric, self.far = name, rng, parametric, far
        self.lines: list[str] = []
        self.parameters: dict[str, tuple[float, float]] = {}  # default and value
        self.bodies: dict[str, oracle.Body] = {}
        self.poses: dict[str, tuple[float, float, float]] = {}
        self.joints: dict[str, oracle.Joint] = {}
        self.laws: dict[str, tuple[str, Formula]] = {}
        self.constraints: dict[str, Formula] = {}
        self.rows: dict[str, tuple[Formula, str]] = {}
        self.contacts: dict[str, Any] = {}  # of random_elements
        self.guides: dict[str, list[tuple[str, Formula]]] = {}  # laws of points, and their gaps
        self.paths: dict[str, Spot] = {}
        self.outputs: dict[str, tuple[str, float]] = {}  # so many times what
        self.pushed: dict[str, float] | None = None  # weights by joint
        self.loads: dict[str, Callable] = {}
        self.spreads: dict[str, Callable] = {}
        self.strokes: dict[str, tuple] = {}  # two points, and their distances closed and open
        self.gravity: Place = (0.0, -9.81)
        self.stations: dict[str, list[float]] = {}
        self.limited: set[str] = set()  # links whose stations must lie on them
        self.loose_axes = False  # whether axes and angles may be written by parameters
        self.exact = (
            False  # whether only what leaves all places as they are is written by parameters
        )
        self.start = 0.0
        self.leads: list[str] = []  # joints to drive first
        self.whole = False  # whether the first of them may turn all the way round
        self.defaults: dict[str, float] = {}  # coordinates at which joints stand by default
        self.fits = True  # whether there are as many drives as freedoms, and they move all
        self.holds = True  # whether what is pushed holds all the motion, far from any dead centre
        self._counts: dict[str, int] = {}
        self._spreads: dict[str, float] = {}

    # Chances and numbers

    def chance(self, probability: float) -> bool:
        return bool(self.rng.random() < probability)

    def choose(self, *options, weights=None):
        p = None if weights is None else np.array(weights) / np.sum(weights)
        return options[int(self.rng.choice(len(options), p=p))]

    def between(self, low: float, high: float) -> float:
        """A number of four digits."""
        return float(f"{self.rng.uniform(low, high):.4g}")

    def angle(self) -> float:
        """A direction, often a right one."""
        if self.chance(0.2):
            return self.choose(0.0, math.pi / 2, -math.pi / 2, 3.0)
        return self.between(-3.1, 3.1)

    def number(
        self, value: float, spread: float | None = 0.03, default: float | None = None
    ) -> Number:
        """A number as it stands, or by a parameter whose default is off by up to ``spread`` of it,
        or is the one given.
        """
        value = float(value)
        if self.exact and spread is not None and spread < 0.1:
            spread = None
        if spread is None or abs(value) < _NOTHING or not self.chance(self.parametric):
            return literal(value)
        alike = [
            name
            for name, most in self._spreads.items()
            if most <= spread and name in self.parameters
        ]
        if alike and default is None and self.chance(0.3):
            name = self.choose(*alike)
            factor = value / self.parameters[name][1]
            return Number(f"{factor!r} * {name}", factor * self.parameters[name][1])
        name = self.new("p")
        default = (
            value * (1.0 + self.far * self.rng.uniform(-spread, spread))
            if default is None
            else default
        )
        self.parameters[name], self._spreads[name] = (default, value), spread
        self.lines.append(f'{name} = m.parameter("{name}", {default!r})')
        return Number(name, value)

    def new(self, kind: str) -> str:
        self._counts[kind] = self._counts.get(kind, -1) + 1
        return f"{kind}{self._counts[kind]}"

    # Bodies and points

    def link(
        self,
        length: float | Number,
        matter: tuple[str, dict] | None = None,
        spread: float | None = 0.03,
    ) -> str:
        """A link that is not placed yet; ``matter`` is its text, and what :class:`oracle.Body`
        takes.
        """
        name = self.new("b")
        size = length if isinstance(length, Number) else self.number(length, spread)
        text, body = matter or self.matter(size.value)
        self.lines.append(f'{name} = m.link("{name}", length={size.text}, {text})')
        if "centre" in body:
            self.bodies[name] = oracle.Body(name, length=size.value, **body)
        else:
            self.bodies[name] = oracle.from_density(name, size.value, **body)
            self.limited.add(name)
        return name

    def matter(self, length: float) -> tuple[str, dict]:
        """How the mass of a link is given."""
        kind = self.choose(
            "uniform", "massless", "light", "taper", "table", "rigid", weights=[8, 2, 1, 2, 1, 3]
        )
        if kind == "massless":
            return "mass=0.0", {"density": lambda u: 0.0}
        if kind == "light":
            mass = 10.0 ** int(self.rng.integers(-9, -3))
            return f"mass={mass!r}", {"density": lambda u: mass}
        if kind == "uniform":
            mass = self.number(self.between(0.1, 2.0), 0.5)
            return f"mass={mass.text}", {"density": lambda u: mass.value}
        if kind == "taper":
            a, b = self.number(self.between(0.5, 4.0), 0.5), self.between(0.0, 3.0)
            return f"density=density.polynomial({a.text}, {b!r})", {
                "density": lambda u: (a.value + b * u) * length
            }
        if kind == "table":
            at = (0.0, self.between(0.2, 0.8), 1.0)
            to = tuple(self.between(0.0, 4.0) for _ in range(3))
            return f"density=density.tabulated({at}, {to})", {
                "density": lambda u: _linear(u, at, to) * length,
                "breaks": at,
            }
        mass = self.number(self.between(0.1, 3.0), 0.5)
        inertia = self.number(self.between(1e-3, 0.1), 0.5)
        centre = (self.between(-0.2, 0.4), self.choose(0.0, self.between(-0.2, 0.2)))
        given = {"mass": mass.value, "centre": centre, "inertia": inertia.value}
        return f"mass={mass.text}, centre={centre}, inertia={inertia.text}", given

    def mass_point(self, at: Place, mass: float | None = None) -> Spot:
        """A point mass at a place."""
        mass = self.choose(0.0, self.between(0.05, 1.0), weights=[1, 3]) if mass is None else mass
        name, given = self.new("b"), self.number(mass, 0.5)
        self.lines.append(f'{name} = m.point_mass("{name}", {given.text})')
        self.bodies[name] = oracle.Body(name, given.value, oriented=False)
        self.poses[name] = (*at, 0.0)
        return Spot(name, name, 0.0, 0.0)

    def base(self, body: str) -> Spot:
        return Spot(body, body, 0.0, 0.0)

    def tip(self, body: str) -> Spot:
        return Spot(body, f"{body}.tip", self.bodies[body].length, 0.0)

    def at(self, body: str, x: float, y: float = 0.0, spread: float | None = 0.03) -> Spot:
        """A place on a body, in its axes."""
        a, b = self.number(x, spread), self.number(y, spread)
        self.stations.setdefault(body, []).append(a.value)
        return Spot(
            body,
            f"{body}.at({a.text}, {b.text})" if b.text != "0.0" else f"{body}.at({a.text})",
            a.value,
            b.value,
        )

    def ground(self, at: Place, spread: float | None = 0.03) -> Spot:
        if at == (0.0, 0.0):
            return Spot("ground", "m.ground", 0.0, 0.0)
        x, y = self.number(at[0], spread), self.number(at[1], spread)
        return Spot("ground", f"m.ground.at({x.text}, {y.text})", x.value, y.value)

    def spot(self, body: str) -> Spot:
        """Any point of a body that is there."""
        if body == "ground":
            return self.ground((self.between(-0.5, 0.5), self.between(-0.5, 0.5)))
        if not self.bodies[body].oriented:
            return self.base(body)
        kind = self.choose("base", "tip", "station", "beside", weights=[2, 3, 2, 1])
        l = self.bodies[body].length
        if kind in ("base", "tip"):
            return getattr(self, kind)(body)
        return self.at(
            body,
            float(f"{l * self.rng.uniform(0.1, 0.9):.4g}"),
            0.0 if kind == "station" else self.between(-0.15, 0.15),
        )

    def meet(self, body: str, at: Place, spread: float | None = 0.03) -> Spot | None:
        """The point of a body at a place; None where its link has no such station."""
        if body == "ground":
            return self.ground(at, spread)
        if not self.bodies[body].oriented:
            return None
        x, y = self.local(body, at)
        l = self.bodies[body].length
        for end, spot in ((0.0, self.base), (l, self.tip)):
            if math.hypot(x - end, y) < 1e-12:
                return spot(body)
        y = 0.0 if abs(y) < 1e-13 else y
        return (
            self.at(body, x, y, spread)
            if body not in self.limited or 0.08 * l < x < 0.92 * l
            else None
        )

    def pose(self, body: str) -> tuple[float, float, float]:
        return (0.0, 0.0, 0.0) if body == "ground" else self.poses[body]

    def place(self, spot: Spot) -> Place:
        x, y, phi = self.pose(spot.body)
        return x + math.cos(phi) * spot.x - math.sin(phi) * spot.y, y + math.sin(
            phi
        ) * spot.x + math.cos(phi) * spot.y

    def local(self, body: str, at: Place) -> Place:
        x, y, phi = self.pose(body)
        dx, dy = at[0] - x, at[1] - y
        return math.cos(phi) * dx + math.sin(phi) * dy, math.cos(phi) * dy - math.sin(phi) * dx

    def put(self, spot: Spot, at: Place, phi: float) -> None:
        """Place a body so that its point is at a place."""
        self.poses[spot.body] = (0.0, 0.0, phi)
        x, y = self.place(spot)
        self.poses[spot.body] = (at[0] - x, at[1] - y, phi)

    def bar(self, a: Place, b: Place) -> tuple[Spot, Spot]:
        """A link through two places, and its points there: its ends, either way round, or
        stations.
        """
        length, phi = math.dist(a, b), math.atan2(b[1] - a[1], b[0] - a[0])
        turned = self.chance(0.25)
        start, phi = (b, math.remainder(phi + math.pi, math.tau)) if turned else (a, phi)
        if self.chance(0.8):
            name = self.link(length)
            first, second = self.base(name), self.tip(name)
        else:
            before = self.between(0.02, 0.1)
            name = self.link(before + length + self.between(0.06, 0.1))
            first, second = self.at(name, before), self.at(name, before + length)
        self.put(first, start, phi)
        return (second, first) if turned else (first, second)

    # Joints

    def pin(self, a: Spot, b: Spot) -> str:
        return self.joint("revolute", *self._either(a, b))

    def weld(self, a: Spot, b: Spot) -> str:
        if self._oriented(a.body) and self._oriented(b.body):
            a, b = self._either(a, b)
            turn = self.number(
                self.pose(b.body)[2] - self.pose(a.body)[2], 0.05 if self.loose_axes else None
            )
            return self.joint("weld", a, b, f", angle={turn.text}", angle=turn.value)
        a, b = (a, b) if self._oriented(a.body) else (b, a)
        return self.joint("weld", a, b)

    def line(
        self, kind: str, carrier: str, child: Spot, direction: float, origin: Spot | None = None
    ) -> str | None:
        """A prismatic joint or a slot of a carrier, along a direction, for a point of another body;
        None where it has no place.
        """
        at, phi = self.place(child), self.pose(carrier)[2]
        c, s = math.cos(direction), math.sin(direction)
        ways = [
            0.0 if self.chance(0.5) else self.between(-0.4, 0.4) for _ in range(0 if origin else 8)
        ]
        if (
            carrier in self.limited and abs(math.cos(direction - phi)) > 0.1
        ):  # or where the line meets the carrier's middle
            ways.append(
                (self.local(carrier, at)[0] - self.bodies[carrier].length / 2)
                / math.cos(direction - phi)
            )
        for away in ways:
            origin = origin or self.meet(carrier, (at[0] - away * c, at[1] - away * s))
        if origin is None:
            return None
        way = self.number(direction - phi, 0.05 if self.loose_axes else None)
        axis = (_exact(math.cos(way.value)), _exact(math.sin(way.value)))
        written = self.choose(axis, tuple(2.0 * x for x in axis), weights=[3, 1])
        if way.text != repr(way.value):
            written = f"(cos({way.text}), sin({way.text}))"
        if kind == "prismatic" and self._oriented(child.body):
            turn = self.number(
                _exact(self.pose(child.body)[2] - phi), 0.05 if self.loose_axes else None
            )
            end = f", angle={turn.text}" if turn.value else ""
            return self.joint(
                kind, origin, child, f", axis={written}{end}", axis=axis, angle=turn.value
            )
        return self.joint(kind, origin, child, f", axis={written}", axis=axis)

    def joint(self, kind: str, parent: Spot, child: Spot, more: str = "", **given) -> str:
        name = self.new("j")
        self.lines.append(f'{name} = m.{kind}("{name}", {parent.text}, {child.text}{more})')
        self.joints[name] = oracle.Joint(name, kind, parent.point, child.point, **given)
        return name

    def _either(self, a: Spot, b: Spot) -> tuple[Spot, Spot]:
        return (b, a) if self.chance(0.35) else (a, b)

    def _oriented(self, body: str) -> bool:
        return body == "ground" or self.bodies[body].oriented

    def movable(self) -> list[str]:
        """The joints that can be driven, as far as they themselves tell."""
        found = []
        for name, joint in self.joints.items():
            turns = (
                joint.kind == "revolute"
                and self._oriented(joint.parent[0])
                and self._oriented(joint.child[0])
            )
            slides = joint.kind == "prismatic" or (
                joint.kind == "slot" and not self._oriented(joint.child[0])
            )
            if turns or slides:
                found.append(name)
        return found

    # Formulas

    def measured(self, kind: str, of, rate: bool = False) -> dict[str, Measure]:
        """Names for the places of a spot, a link's direction, or a joint's coordinate, or for their
        rates.
        """
        if kind == "place":
            names = [self.new("vx" if rate else "x"), self.new("vy" if rate else "y")]
            self.lines.append(
                f"{', '.join(names)} = m.{'velocity' if rate else 'place'}({of.text})"
            )
            return {n: Measure(k, of.point, rate) for n, k in zip(names, "xy", strict=True)}
        name = self.new("w" if rate else "q")
        if kind == "direction":
            self.lines.append(f"{name} = m.direction({of})")
            return {name: Measure("angle", (of, 0.0, 0.0))}
        self.lines.append(f"{name} = m.{'rate' if rate else 'coordinate'}({of})")
        return {name: Measure("coordinate", self.joints[of], rate)}

    def formula(self, text: str, names: dict[str, Measure]) -> Formula:
        return Formula(text, names, {name: value for name, (_, value) in self.parameters.items()})

    def held(self, text: str, names: dict[str, Measure]) -> Formula:
        """A formula less its value in the posture, so that it is zero there."""
        value = float(self.formula(text, names).jet(self.posture_place(), self.start).v)
        return self.formula(f"{text} - ({value!r})", names)

    def constraint(self, formula: Formula) -> str:
        name = self.new("c")
        self.lines.append(f'm.constraint("{name}", {formula.text})')
        self.constraints[name] = formula
        return name

    def gear(self, first: str, second: str, ratio: float) -> str:
        """A gear between two joints."""
        given = self.number(ratio, None)
        q, r = (joint_coordinate(self.joints[j], self.posture_place()).v for j in (first, second))
        name, offset = self.new("c"), literal(r - given.value * q)
        self.lines.append(
            f'm.gear("{name}", {first}, {second}, ratio={given.text}, offset={offset.text})'
        )
        names = {
            "first": Measure("coordinate", self.joints[first]),
            "second": Measure("coordinate", self.joints[second]),
        }
        self.constraints[name] = self.formula(
            f"second - {given.text} * first - ({offset.text})", names
        )
        return name

    def row(self, formula: Formula, replaces: str) -> str:
        name = self.new("r")
        self.lines.append(f'm.nonholonomic("{name}", {formula.text}, replaces={replaces})')
        self.rows[name] = (formula, replaces)
        return name

    def drive(self, joint: str, text: str, formula: str) -> None:
        """A law for a joint's coordinate: how it is declared, and as a formula of t."""
        self.laws[joint] = (text, self.formula(formula, {}))

    def coordinate(self, joint: str) -> float:
        """Of a joint in the posture."""
        return float(joint_coordinate(self.joints[joint], self.posture_place()).v)

    # The oracle

    def posture_place(self):
        """Places of points in the posture, at rest."""
        return self.oracle(self.start).places(
            oracle.Result({name: tuple(map(oracle.Jet, pose)) for name, pose in self.poses.items()})
        )

    def oracle(self, t: float) -> oracle.Oracle:
        """The oracle of an instant."""
        extras = [_extra(name, f, t, holds=True) for name, f in self.constraints.items()]
        extras += [_extra(name, f, t, holds=False) for name, (f, _) in self.rows.items()]
        extras += [contact.extra(name, t) for name, contact in self.contacts.items()]
        guides = [gap for laws in self.guides.values() for _, gap in laws]
        extras += [
            oracle.Extra(f"guide{k}", lambda place, gap=gap: gap.jet(place, t), None)
            for k, gap in enumerate(guides)
        ]
        loads = [lambda place, load=load: load(place, t) for load in self.loads.values()]
        unaided = [joint for _, joint in self.rows.values()]
        joints, bodies = list(self.joints.values()), list(self.bodies.values())
        spreads = [lambda place, one=one: one(place, t) for one in self.spreads.values()]
        pushed = self.pushed or {}
        more = len(pushed) > len(self.laws) + len(guides)
        return oracle.Oracle(
            bodies,
            joints,
            self.gravity,
            loads,
            extras,
            unaided,
            pushed=[*pushed] or None,
            spreads=spreads,
            weights=pushed if more else {},
        )

    def drives(self, t: float) -> dict[str, tuple[float, float, float]]:
        """Coordinate, rate and acceleration of the driven joints."""
        jets = {joint: law.jet(None, t) for joint, (_, law) in self.laws.items()}
        return {joint: (jet.v, jet.d, jet.a) for joint, jet in jets.items()}


def _extra(name, formula, t, *, holds):
    gap = (lambda place: formula.jet(place, t)) if holds else None
    return oracle.Extra(name, gap, lambda place: formula.effect(place, t))


def _exact(x: float) -> float:
    """A number that is meant to be none, or one."""
    return round(x) + 0.0 if abs(x - round(x)) < 1e-12 else x


def _linear(u, at, to):
    i = 1 if u < at[1] else 2
    return to[i - 1] + (to[i] - to[i - 1]) * (u - at[i - 1]) / (at[i] - at[i - 1])
