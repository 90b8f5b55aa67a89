"""Conditions for possible parts: one function of the parameters, for :func:`.evaluate`, sweeps and
exported C.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from ..base.numerals import readable
from ..base.scalars import column, graph
from ..base.symbolic import Graphs, symbolic, symbolic_property
from ..base.templates import mapped
from ..base.vectors import dot, nil
from ..base.vocabulary import Precision
from ..errors import ParameterError
from .beyond_ends import BEYOND, beyond_ends, words_beyond
from .declaration import Declaration
from .declared_parts import Expression, Link, Point, PointMass, RigidMass, Vector
from .directions import RIGHT, not_right
from .limits import END
from .link_density import Density, Slices
from .loads import POSITIVE, Friction, LineLoad
from .mass_properties import mass_of, second_moments
from .meshes import FITTING, Fit
from .polynomials import lowest, product

Evaluator = Callable[[Any], float]
"""Gives the value of an expression."""


@dataclass(frozen=True, eq=False)
class Demand:
    """A value that must be finite and not negative, nor zero where ``positive``; ``refusal`` says
    in words what is wrong.
    """

    value: Expression
    positive: bool
    refusal: Callable[[Evaluator], str]

    @classmethod
    def saying(cls, value: Expression, positive: bool, words: str, **numbers: Expression) -> Demand:
        """Make one that is refused in ``words``: in braces stand names of ``numbers``, and ``got``
        for the value.
        """
        shown = {"got": value} | numbers

        def refusal(number: Evaluator) -> str:
            return words.format(**{name: readable(number(one)) for name, one in shown.items()})

        return cls(value, positive, refusal)


@dataclass(frozen=True, eq=False)
class ParameterConstraints:
    """All demands of a mechanism's parts, in the order in which errors name them."""

    symbols: ca.SX
    each: tuple[Demand, ...]

    @symbolic_property
    def function(self) -> ca.Function:
        """``possible(p)``: the value of each demand."""
        values = column(ca.SX(demand.value) for demand in self.each)
        return graph("possible", {"p": self.symbols}, possible=values)

    def margins(self) -> Margins:
        """Return the values alone."""
        values = self.function(self.symbols)
        order = sorted(range(len(self.each)), key=lambda k: not self.each[k].positive)
        margins = column(values[k] for k in order)
        function = graph("margins", {"p": self.symbols}, margins=margins)
        return Margins(function, sum(demand.positive for demand in self.each))

    def check(self, p: Sequence[float], number: Evaluator) -> None:
        """Raise :class:`ParameterError` for parameters at which a part is impossible, by the first
        demand that is not met.
        """
        values = self.function(np.array(p, float)).full().ravel().tolist()
        for demand, value in zip(self.each, values, strict=True):
            if not (value > 0.0 if demand.positive else value >= 0.0) or value == math.inf:
                raise ParameterError(demand.refusal(number))


@dataclass(frozen=True, eq=False)
class Margins(Graphs):
    """Expressions that must stay positive, ``positive`` numbers of ``function(p)``, and then those
    that must not be negative.
    """

    function: ca.Function
    positive: int

    def in_order(self, symbols: ca.SX) -> tuple[list[ca.SX], list[ca.SX]]:
        """Return expressions in the parameters: those that must be positive, and the others."""
        values = ca.vertsplit(self.function(symbols)) if self.function.numel_out(0) else []
        return values[: self.positive], values[self.positive :]


@symbolic
def demands(declared: Declaration, precision: Precision = "double") -> ParameterConstraints:
    """Conditions on the parts of a mechanism: lengths, masses, densities, load points; with the
    tolerance of a precision.
    """
    return _of_frozen(declared, precision) if declared.frozen else _of(declared, precision)


@functools.lru_cache(maxsize=64)
def _of_frozen(declared: Declaration, precision: Precision) -> ParameterConstraints:
    return _of(declared, precision)


def _of(declared: Declaration, precision: Precision) -> ParameterConstraints:
    found: list[Demand] = []
    for what, expressions in _numbers(declared):
        found += _of_curves(what, expressions)
    for body in declared.moving:
        found += _of_body(body, precision, space=declared.space)
    masses = [mass_of(body) for body in declared.moving]
    if not any(mass.is_constant() and 0.0 < float(mass) < math.inf for mass in masses):
        loaded = any(not isinstance(load, Friction) for load in declared.loads.values())
        found.append(_some_mass(declared.name, masses, loaded=loaded))
    for joint in declared.joints.values():
        what, (u, v, _), turned = f"joint '{joint.name}'", joint.triad, joint.turned
        found += _of_pair(what, u, v, precision)
        found += _of_pair(f"{what}: turned", turned.x, turned.y, precision)
        # A child that slides loads its parent at a place on the line along which it slides.
        for point in (joint.child,) if joint.slides else (joint.parent, joint.child):
            found += _of_load_point(what, point, precision, space=declared.space)
    for load in declared.loads.values():
        if isinstance(load, LineLoad):
            found += _of_part(load, precision)
        elif isinstance(load, Friction):
            found += _of_friction(load)
        else:
            what = f"load '{load.name}'"
            for point in load.points:
                found += _of_load_point(what, point, precision, space=declared.space)
    for stroke in declared.strokes.values():
        words = f"{stroke.what}: open must be longer than closed, got {{open}} m and {{closed}} m"
        ends = {"open": stroke.open, "closed": stroke.closed}
        found.append(Demand.saying(stroke.open - stroke.closed, True, words, **ends))
        found.append(
            Demand.saying(
                stroke.closed, True, f"{stroke.what}: closed must be positive, got {{got}} m"
            )
        )
    for drive in declared.drives.values():
        found += _of_numbers(f"drive '{drive.name}'", drive.numbers)
    for constraint in declared.constraints.values():
        if constraint.transmission is not None:
            found += [
                _of_fit(constraint.name, fit, precision) for fit in constraint.transmission.varying
            ]
    return ParameterConstraints(declared.symbols, tuple(found))


def _numbers(declared: Declaration) -> Iterator[tuple[str, list[Expression]]]:
    """The expressions in parameters of which parts are made, and what they are of."""
    for body in declared.moving:
        found: list[Expression] = []
        mapped(body, found.append)
        yield _called(body), found
    for joint in declared.joints.values():
        places = [number for point in (joint.parent, joint.child) for number in point.place]
        directions = (*joint.triad, joint.turned.x, joint.turned.y)
        numbers = [number for direction in directions for number in direction]
        yield f"joint '{joint.name}'", [*places, *numbers, joint.pitch]
    for load in declared.loads.values():
        places = [number for point in load.points for number in point.place]
        numbers = [*load.numbers.values()] if isinstance(load, Friction) else places
        yield f"load '{load.name}'", numbers
    for drive in declared.drives.values():
        yield f"drive '{drive.name}'", [drive.ratio, *drive.numbers.values()]
    yield "gravity", [*declared.gravity]


def _of_curves(what: str, expressions: list[Expression]) -> list[Demand]:
    """Conditions that arguments of curves are between the curves' ends."""
    symbolic = [expression for expression in expressions if isinstance(expression, ca.SX)]
    found = beyond_ends(ca.vertcat(*symbolic)) if symbolic else []
    return [
        Demand.saying(BEYOND["double"] - far, False, words_beyond(what, argument, ""))
        for argument, far in found
    ]


def _of_part(load: LineLoad, precision: Precision) -> list[Demand]:
    """The part on which a load acts is on its link, and has a length."""
    (start, end), link = load.between, load.link
    if load.whole:
        return []
    words = f"load '{load.name}': it acts between {{start}} and {{end}} m"
    beyond = f"{words}, but link '{link.name}' is from 0 to {{length}} m"
    rising = f"{words}; expected an end greater than the start"
    slack, numbers = END[precision] * link.length, {"start": start, "end": end}
    return [
        *(
            Demand.saying(margin, False, beyond, **numbers, length=link.length)
            for margin in (start + slack, (link.length - end) + slack)
        ),
        Demand.saying(load.reach, True, rising, **numbers),
    ]


def _of_fit(name: str, fit: Fit, precision: Precision) -> Demand:
    """Condition that two numbers of a transmission are equal."""
    apart = max(FITTING, END[precision]) * fit.size - ca.fabs(ca.SX(fit.got - fit.meant))
    return Demand(
        apart, False, lambda number: f"'{name}': {fit.refusal(number(fit.got), number(fit.meant))}"
    )


def _of_friction(friction: Friction) -> Iterator[Demand]:
    """The numbers of a friction are not negative, and what it divides by is not zero."""
    what = f"friction '{friction.name}'"
    yield from _of_numbers(what, friction.numbers)
    if friction.joint.kind == "screw" and friction.dry and friction.radius is not None:
        steep = (
            f"{what}: mu times the lead per radian must be less than the radius; otherwise no"
            " torque can drive the screw"
        )
        yield Demand.saying(
            friction.radius - friction.mu * ca.fabs(friction.joint.pitch), True, steep
        )


def _of_numbers(what: str, numbers: Mapping[str, Expression]) -> Iterator[Demand]:
    for word, number in numbers.items():
        if isinstance(number, ca.SX):
            positive = word in POSITIVE
            least = "positive" if positive else "at least 0"
            yield Demand.saying(number, positive, f"{what}: {word} must be {least}, got {{got}}")


def _of_body(body: Link | PointMass, precision: Precision, *, space: bool) -> Iterator[Demand]:
    """Conditions on the sizes and the mass of a body."""
    what, mass = _called(body), body.mass
    if isinstance(body, Link):
        yield from _of_beam(what, body)
        yield Demand.saying(body.length, True, f"{what}: length must be positive, got {{got}} m")
        if isinstance(mass, Density):
            yield from _of_density(what, mass, body.length, precision)
            yield from _of_slices(what, mass.slices, precision) if mass.slices else ()
            return
    whole = mass.mass if isinstance(mass, RigidMass) else mass
    yield Demand.saying(whole, False, f"{what}: mass must not be negative, got {{got}} kg")
    if isinstance(mass, RigidMass) and not mass.accepted:
        if space:
            yield from _of_inertia(what, mass)
        else:
            words = f"{what}: inertia must not be negative, got {{got}} kg m^2"
            yield Demand.saying(mass.inertia[2][2], False, words)


def _called(body: Link | PointMass) -> str:
    return f"link '{body.name}'" if isinstance(body, Link) else f"point mass '{body.name}'"


def _of_beam(what: str, link: Link) -> list[Demand]:
    """Conditions on the dimensions of a cross-section; between two breaks they are linear, and so
    are the conditions.
    """
    shapes = () if link.beam is None else link.beam.course.shapes
    return [
        Demand.saying(
            value, True, f"{what}: {words} of its {shape.kind} must be positive, got {{got}}"
        )
        for shape in shapes
        for value, words in shape.parameter_constraints()
    ]


def _of_inertia(what: str, mass_properties: RigidMass) -> Iterator[Demand]:
    """Conditions that moments of inertia belong to a mass: no principal second moment is negative.

    So it is where no minor on the diagonal of the matrix of second moments is, each beside its
    largest terms.
    """
    moments = [[ca.SX(entry) for entry in row] for row in second_moments(mass_properties.inertia)]
    numbers = {axis: mass_properties.inertia[k][k] for k, axis in enumerate("xyz")}
    words = (
        f"{what}: impossible moments of inertia {{x}}, {{y}}, {{z}} kg m^2 about x, y and z: each"
        " principal moment must be at most the sum of the other two"
    )
    for chosen in ((0,), (1,), (2,), (0, 1), (0, 2), (1, 2), (0, 1, 2)):
        minor = ca.vertcat(*(ca.horzcat(*(moments[i][j] for j in chosen)) for i in chosen))
        size = sum((ca.fabs(moments[i][i]) for i in range(3)), ca.SX(0)) ** len(chosen)
        yield Demand.saying(ca.det(minor) + END["double"] * size, False, words, **numbers)


def _of_density(
    what: str, density: Density, length: Expression, precision: Precision
) -> list[Demand]:
    """The lowest density of each cell, beside what the sum of its terms rounds [kg or kg/m]; not
    finite where a term is not.
    """
    if density.even:
        mass = density.cells[0][0] * (length if density.per_length else 1.0)
        return [Demand.saying(mass, False, f"{what}: mass must not be negative, got {{got}} kg")]
    spans = zip(density.breaks, density.breaks[1:], density.cells, strict=False)
    places = [lowest(cell, a, b) for a, b, cell in spans]

    def refusal(number: Evaluator) -> str:
        value, place = min((number(value), number(place)) for place, value in places)
        got = value / (1.0 if density.per_length else number(length))
        return (
            f"{what}: density must not be negative, got {readable(got)} kg/m at xi/l = {place:.6g}"
        )

    sizes = [sum(ca.fabs(ca.SX(c)) for c in cell) for cell in density.cells]
    return [
        Demand(least + END[precision] * size, False, refusal)
        for (_, least), size in zip(places, sizes, strict=True)
    ]


def _of_slices(what: str, slices: Slices, precision: Precision) -> Iterator[Demand]:
    """Conditions that second moments of slices belong to a mass: neither yy, nor zz, nor yy zz - yz
    yz is negative anywhere.
    """
    words = (
        f"{what}: impossible second moments of slices: yy, zz and yy zz - yz yz must not be"
        " negative anywhere along the link"
    )
    for start, stop in itertools.pairwise(slices.breaks):
        yy, zz, yz = (moment.cell_at((start + stop) / 2) for moment in slices.each)
        squares = product(yy, zz), product(yz, yz)
        both = [a - b for a, b in itertools.zip_longest(*squares, fillvalue=ca.SX(0))]
        for cell in (yy, zz, both) if any(not nil(c) for c in yz) else (yy, zz):
            size = sum(ca.fabs(ca.SX(c)) for c in cell)
            least = lowest(cell, start, stop)[1] + END[precision] * size
            yield Demand.saying(least, False, words)


def _some_mass(name: str, masses: list[ca.SX], *, loaded: bool) -> Demand:
    """Condition that something has a mass, or is loaded: without either there is no force
    anywhere.
    """
    total = sum(masses[1:], masses[0]) if masses else ca.SX(0)

    def refusal(number: Evaluator) -> str:
        mass = number(total)
        if mass == 0.0:
            return (
                f"mechanism '{name}' has neither mass nor load; give at least one link or point"
                " mass a mass or a load"
            )
        return (
            f"mechanism '{name}': its whole mass must be finite and positive, got"
            f" {readable(mass)} kg"
        )

    return Demand(total, not loaded, refusal)


def _of_pair(what: str, first: Vector, second: Vector, precision: Precision) -> list[Demand]:
    """Conditions that two directions in space that depend on parameters are not zero, and at right
    angles.
    """
    cosine = dot(first, second)
    if not isinstance(cosine, ca.SX) or cosine.is_constant():
        return []
    return [
        Demand.saying(
            dot(first, first) + dot(second, second),
            True,
            f"{what}: its axes must not be of length zero",
        ),
        Demand(
            max(RIGHT, END[precision]) - ca.fabs(cosine),
            False,
            lambda number: not_right(what, number(cosine)),
        ),
    ]


def _of_load_point(what: str, point: Point, precision: Precision, *, space: bool) -> list[Demand]:
    """A fixed point is between both ends of its link, if that has sections."""
    body = point.body
    if point.end is not None or not (isinstance(body, Link) and isinstance(body.mass, Density)):
        return []
    back = ", turned=[('z', '180 deg')]" if space else ", angle='180 deg'"

    def refusal(number: Evaluator) -> str:
        x, length, link = number(point.x), number(body.length), body.name
        there = (
            f"its point at {readable(x, 0.0, length)} m is outside link '{link}', 0 to"
            f" {readable(length, x)} m"
        )
        end, beyond, turned = ("", -x, back) if x < 0.0 else (".tip", x - length, "")
        if not math.isfinite(beyond):
            return f"{what}: {there}"
        tail = f"tail = m.link('{link}_tail', length={readable(beyond)}, mass=0.0)"
        weld = f"m.weld('{link}_end', m.links['{link}']{end}, tail{turned})"
        return (
            f"{what}: {there}; for a point beyond an end declare another link: {tail}; {weld}; and"
            " use tail.tip as the point"
        )

    slack = END[precision] * body.length
    margins = point.x + slack, (body.length - point.x) + slack
    return [Demand(margin, False, refusal) for margin in margins]
