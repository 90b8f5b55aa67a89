"""A scene over the cycle of its one drive: the terms of its columns at any angle, and after how
many turns they repeat.

Where one drive turns and nothing depends on time itself, every column is A theta'' + B theta'^2 + D
theta' + C of the drive's angle theta. The terms are derivatives of the graph at rest, by automatic
differentiation: no difference of large numbers is taken.
"""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from ...base.quantities import Check, Column
from ...base.symbolic import symbolic
from ...base.tables import ANGLE, FORCE, LENGTH, MOMENT
from ...errors import DeclarationError, listed
from ..dead_centres import POINTS
from ..iteration import CLOSED
from ..kinematics import describe_coordinate, where
from ..program import Program
from .passed_dead_centres import Placed, dead_steps
from .phases import add_turns
from .refusing import first_broken

FRACTIONS = ("gap", "misfit", "beyond", "stroke")
"""Checks that are small or large beside one."""

_JUMP, _STEEPEST, _HALVINGS = 1e-3, 64, 24
"""The least jump, of the largest of a column's unit, that is refused; how many steps of a course
are looked at, and how often each is halved.
"""

TURNS = 4
"""Number of the longest periods."""

_STEPS = 512
_OFFSET = 0.618
_BLOCK = 4096
_SAME, _FAINT = 1e-9, 1e-11
"""Relative changes that count as none: of a column's own largest value, and of the largest of its
unit.
"""

_ROUNDING = 16 * 2.0**-52
"""Rounding relative to the largest value of a unit."""

_PROBES = ((1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (0.5, 0.0), (-0.1, 0.1), (1e-3, 0.0))


@dataclass(frozen=True, eq=False)
class Cycle:
    """A scene over the cycle of its one drive.

    ``turns`` of the drive are its period, over which each column gains ``drift`` a radian beside
    (columns). ``rounding`` (factors, columns) is what rounding makes of a term: some units of it of
    the largest term of its unit, or more where it changes more from one period to the next.
    """

    drive: Drive
    course: Course
    turns: int
    drift: Array
    rounding: Array

    @property
    def period(self) -> float:
        """The period [rad]."""
        return math.tau * self.turns

    def values(self, nodes: int, *, halfway: bool = False) -> Array:
        """The terms less the drift at equal distances, (factors, columns, nodes): the first at the
        angle 0, or halfway to the next.

        They are taken where the motion goes from its start on, for a load may be declared for no
        other angles.
        """
        width = self.period / nodes
        first = (
            math.ceil(self.drive.start / width)
            if self.drive.sense > 0
            else math.floor(self.drive.start / width) - nodes
        )
        angles = (
            np.arange(first, first + nodes).astype(np.float64) + (0.5 if halfway else 0.0)
        ) * width
        return np.roll(self.at(angles), first, axis=-1)

    def at(self, angles: Array) -> Array:
        """The terms less the drift at angles of the course, (factors, columns, n)."""
        values = self.drive.terms_at(
            angles, self.drive.settle(angles, self.course.places_near(angles))
        )
        self.drive.unwind(values[0], self.course.turns_of(angles, values[0, self.drive.wrapped]))
        values[0] -= self.drift[:, None] * angles
        return values


@dataclass(frozen=True, eq=False)
class Course:
    """Some turns of the drive at equal steps: angles (n), iterated coordinates (k, n), and the
    angles known up to whole turns, made continuous (m, n).
    """

    angles: Array
    places: Array
    wrapped: Array

    def places_near(self, angles: Array) -> Array:
        """Iterated coordinates to begin with."""
        step = self.angles[1] - self.angles[0]
        nearest = np.rint((angles - self.angles[0]) / step).astype(int)
        return self.places[:, np.clip(nearest, 0, self.angles.size - 1)]

    def turns_of(self, angles: Array, wrapped: Array) -> Array:
        """Multiples of 2 pi that make angles continuous with those of the course, (m, n)."""
        rising = slice(None, None, 1 if self.angles[1] > self.angles[0] else -1)
        near = [np.interp(angles, self.angles[rising], row[rising]) for row in self.wrapped]
        return math.tau * np.rint((np.reshape(near, wrapped.shape) - wrapped) / math.tau)


@dataclass(frozen=True, eq=False)
class Drive:
    """A scene's one drive, that of a joint that turns: where it starts, the sign of the way it
    goes, and the terms by its angle.
    """

    program: Program
    p: Array
    joint: str
    start: float
    sense: int
    terms: Any

    @classmethod
    @symbolic
    def of(cls, program: Program, p: Array) -> Drive:
        """Raises :class:`DeclarationError` where there is not one drive that turns, or where
        columns depend on time itself.
        """
        joint = the_drive(program)
        t, d, rate, acceleration, z, parameters = program.instant.sx_in()
        out = program.instant(t, d, rate, acceleration, z, parameters)
        timed = [program.columns[k] for k in ca.jacobian_sparsity(out, t).row()]
        if program.newton is not None and ca.depends_on(
            program.newton.step(z, t, d, parameters)[0], t
        ):
            timed += [Check("closure", name) for name in program.newton.names]
        if timed:
            raise DeclarationError(
                f"table: expected outputs that depend on the angle of joint '{joint}' alone, but"
                f" these depend on the time: {_listed(timed)}"
            )
        slope = ca.jacobian(out, rate)
        rows = [out, slope, ca.jacobian(slope, rate) / 2, ca.jacobian(out, acceleration)]
        moving = ca.vertcat(t, rate, acceleration)
        at_rest = [ca.densify(ca.substitute(row, moving, ca.SX.zeros(3))) for row in rows]
        terms = ca.Function("terms", [d, z, parameters], at_rest, {"cse": True})
        start, stop = (float(program.motion(moment, p)[0]) for moment in program.data.span)
        return cls(program, p, joint, start, -1 if stop < start else 1, terms)

    @property
    def wrapped(self) -> list[int]:
        """The rows of the angles that are known up to whole turns only."""
        return [k for k, whole in self.program.loop_rows[0] if not whole]

    def terms_at(self, angles: Array, places: Array) -> Array:
        """The terms at angles, as they come, (factors, columns, n).

        Raises :class:`DeclarationError` where a loop does not close, or a term is not finite.
        """
        values = np.empty((4, len(self.program.columns), angles.size))
        for start in range(0, angles.size, _BLOCK):
            cut = slice(start, start + _BLOCK)
            found = self.terms(angles[None, cut], places[:, cut], self.p)
            values[..., cut] = [part.full() for part in found]
        self._refuse(angles, values)
        return values

    def settle(self, angles: Array, places: Array) -> Array:
        """The iterated coordinates at angles, from ones that are near.

        Raises :class:`DeclarationError` where there are none.
        """
        if self.program.newton is None:
            return places
        found, size = self.program.newton.closed(places, 0.0, angles[None], self.p)
        closed = size.full()[0] < CLOSED
        if closed.all():
            return np.asarray(found.full())
        bad = angles[int(np.argmin(closed))]
        raise DeclarationError(
            f"table: the loops closed by {self.program.newton.joints} did not"
            f" converge{self._not_round(bad)}"
        )

    def unwind(self, columns: Array, turns: Array) -> None:
        """Add to the angles known up to whole turns (columns, n), and to their sums, the turns (m,
        n) that they lack.

        Whole turns that columns count are then in the angles, and the columns are zero.
        """
        lacking, parts = iter(turns), self.program.loop_rows[0]
        add_turns(
            self.program,
            columns,
            [math.tau * columns[k] if whole else next(lacking) for k, whole in parts],
        )
        columns[[k for k, whole in parts if whole]] = 0.0

    def follow(self, turns: int) -> tuple[Course, Array]:
        """Some turns from the start on, and the terms there, angles made continuous.

        Raises :class:`DeclarationError` where a loop cannot be closed all the way, or passes a dead
        centre.
        """
        steps = np.arange(turns * _STEPS).astype(np.float64) + _OFFSET
        angles = self.start + self.sense * math.tau / _STEPS * steps
        here = np.array(self.program.newton.guess if self.program.newton else ())[:, None]
        places = np.empty((here.size, angles.size))
        for i in range(angles.size if self.program.newton else 0):
            here = self.settle(angles[i : i + 1], here)
            places[:, i] = here[:, 0]
        values = self.terms_at(angles, places)
        for bound, passed in zip(
            self.program.bounds, self._dead_steps(angles, places, values[0]), strict=True
        ):
            if passed.any():
                near = describe_coordinate(self.joint, "angle", angles[int(np.argmax(passed))])
                raise DeclarationError(
                    f"table: the loop closed by {self.program.data.closing(str(bound.part))} passes"
                    f" a dead centre near {near}"
                )
        wrapped = values[0, self.wrapped].copy()
        course = Course(angles, places, np.unwrap(wrapped))
        self.unwind(values[0], course.wrapped - wrapped)
        return course, values

    def _dead_steps(self, angles: Array, places: Array, out: Array) -> Array:
        """Steps of the cycle (bounds, t) that pass a dead centre, as :func:`.dead_steps` gives
        them.
        """
        rate, still = ca.DM.ones(1, POINTS), np.zeros(POINTS)

        def place(i: int, x: Array) -> Placed:
            width = angles[i + 1] - angles[i]
            d = angles[i] + x * width
            z = places[:, np.where(x < 0.5, i, i + 1)]
            z = self.settle(d, z) if self.program.newton else z
            return width, still, (ca.DM(d[None]), rate, 0.0 * rate), z

        most = self.program.limits("double", None, self.program.extent(self.p))
        return dead_steps(self.program, angles, out, np.isfinite(angles), most, self.p, place)

    def _refuse(self, angles: Array, values: Array) -> None:
        program = self.program
        most = program.limits("double", None, program.extent(self.p))
        beside = np.zeros((len(program.bounds), angles.size))
        broken = first_broken(program, values[0], most, beside, np.zeros(angles.size))
        for i in np.flatnonzero(broken):
            bound = program.bounds[program.rules[broken[i] - 1][1] or 0]
            if bound.kind in ("closure", "branch", "gap"):
                loop = f"the loop closed by {program.data.closing(str(bound.part))}"
                what = (
                    f"the solution of {loop} does not close it"
                    if bound.kind == "gap"
                    else f"{loop} cannot be closed"
                )
                raise DeclarationError(f"table: {what}{self._not_round(angles[i])}")
        found = np.argwhere(~np.isfinite(values).all(axis=0))
        if found.size:
            k, i = found[0]
            at = where([(self.joint, "angle", angles[i])])
            raise DeclarationError(f"table: '{self.program.names[k]}' is not finite at rest{at}")

    def _not_round(self, angle: float) -> str:
        return (
            f"{where([(self.joint, 'angle', angle)])}; expected a drive that can make whole"
            " revolutions"
        )


def the_drive(program: Program) -> str:
    """The one driven joint of a scene.

    Raises :class:`DeclarationError` where there is not one, or where it slides.
    """
    if len(program.driven) != 1:
        named = ", ".join(f"'{name}'" for name in program.driven) or "none"
        raise DeclarationError(
            f"table: expected one driven joint, whose angle determines all, got {named}"
        )
    (joint,) = program.driven
    if program.data.kinds.coordinates[joint] != "angle":
        raise DeclarationError(
            f"table: the driven joint '{joint}' slides; expected one that turns, because only"
            " an angle repeats"
        )
    return joint


def cycle_of(program: Program, p: Array, rates: tuple[float, float]) -> Cycle:
    """The cycle of a scene for parameters ``p`` and motions up to a rate and an acceleration.

    Raises :class:`DeclarationError`, with the reason, where there is none.
    """
    drive = Drive.of(program, p)
    reasons = [f"friction '{name}' depends on its sign" for name in program.checks("rest")]
    reasons += [f"the margin of {part} is none" for part in program.checks("slides")]
    if reasons:
        raise DeclarationError(
            f"table: expected columns quadratic in the rate of joint '{drive.joint}', but"
            f" {', '.join(reasons)}; evaluate without a table"
        )
    for revolutions in range(1, TURNS + 1):
        course, values = drive.follow(2 * revolutions)
        sizes = _sizes(program, p, np.abs(values).max(axis=-1))
        if revolutions == 1:
            _refuse_other_powers(drive, course, sizes, rates)
        half = course.angles.size // 2
        gained = drive.sense * (values[..., half:] - values[..., :half])
        near = _SAME * np.abs(values).max(axis=-1) + _FAINT * sizes
        change = gained[0].mean(axis=-1)
        change[np.abs(change) <= near[0]] = 0.0
        gained[0] -= change[:, None]
        noise = np.abs(gained).max(axis=-1)
        moved = ~(noise <= near).all(axis=0)
        if not moved.any():
            # An angle gains whole turns, and just so.
            gain = change / math.tau
            whole = np.rint(gain)
            drift = (
                np.where((whole != 0.0) & (np.abs(gain - whole) < _SAME), whole, gain) / revolutions
            )
            cycle = Cycle(drive, course, revolutions, drift, _ROUNDING * sizes + 2.0 * noise)
            _refuse_jumps(cycle, values[..., :half], sizes)
            return cycle
    names = [name for name, does in zip(program.columns, moved, strict=True) if does]
    wound_angles = bool(program.checks("turned"))
    why = "; a load that depends on a number of revolutions may not repeat" if wound_angles else ""
    raise DeclarationError(
        f"table: expected columns that repeat after at most {TURNS} turns of joint"
        f" '{drive.joint}', but {_listed(names)} do not repeat{why}"
    )


def _refuse_other_powers(
    drive: Drive, course: Course, sizes: Array, rates: tuple[float, float]
) -> None:
    """Derivatives at rest see nothing of a load by the rate's sign, or its size: so the columns
    themselves are looked at.
    """
    columns = drive.program.columns
    some = slice(0, _STEPS, 7)
    angles, places = course.angles[some], course.places[:, some]
    revolutions_of = drive.terms_at(angles, places)
    wrong: npt.NDArray[np.bool_] = np.zeros(len(columns), dtype=bool)
    for by_rate, by_acceleration in _PROBES:
        rate, acceleration = by_rate * (rates[0] or 1.0), by_acceleration * (rates[1] or 1.0)
        factors = np.array([1.0, rate, rate**2, acceleration])
        moving = (angles[None], rate, acceleration, places)
        found = drive.program.instant(0.0, *moving, drive.p).full()
        near = _SAME * np.abs(found).max(axis=-1) + _FAINT * np.abs(factors) @ sizes
        wrong |= ~(np.abs(found - np.tensordot(factors, revolutions_of, 1)).max(axis=-1) <= near)
    if wrong.any():
        names = [name for name, is_wrong in zip(columns, wrong, strict=True) if is_wrong]
        raise DeclarationError(
            f"table: expected columns quadratic in the rate of joint '{drive.joint}', but a load"
            f" that depends on a rate's sign, size or another power enters {_listed(names)}"
        )


def _refuse_jumps(cycle: Cycle, values: Array, sizes: Array) -> None:
    """A spline swings beside a jump: so the steepest steps of the course are halved until a smooth
    change is none.
    """
    least = np.where(sizes > 0.0, sizes, math.inf)[..., None]

    def apart(one: Array, other: Array) -> Array:
        return np.asarray((np.abs(one - other) / least).max(axis=(0, 1)))

    some = np.argsort(apart(values[..., 1:], values[..., :-1]))[-_STEEPEST:]
    low, high = cycle.course.angles[some], cycle.course.angles[some + 1]
    before, after = map(cycle.at, (low, high))
    for _ in range(_HALVINGS):
        middle = (low + high) / 2.0
        here = cycle.at(middle)
        first = apart(before, here) > apart(here, after)
        low, high = np.where(first, (low, middle), (middle, high))
        before, after = np.where(first, (before, here), (here, after))
    jumps = np.abs(after - before) / least
    if jumps.max() > _JUMP:
        _, column, k = np.unravel_index(np.argmax(jumps), jumps.shape)
        raise DeclarationError(
            f"table: '{cycle.drive.program.names[column]}' jumps near"
            f" {describe_coordinate(cycle.drive.joint, 'angle', low[k])}, and a table holds smooth"
            " columns alone; evaluate without a table"
        )


def _sizes(program: Program, p: Array, peaks: Array) -> Array:
    """The largest terms of the same unit, (factors, columns), of a misfit one; the rate's square
    and the acceleration have one.
    """
    kinds = [_kind(program, column) for column in program.columns]
    alike = np.stack((peaks[0], peaks[1], *[np.maximum(peaks[2], peaks[3])] * 2))
    largest = {kind: alike[:, [k == kind for k in kinds]].max(axis=-1) for kind in set(kinds)}
    _raise_to_other_units(largest, program.extent(p))
    sizes: Array = np.array([largest[kind] for kind in kinds]).reshape(len(kinds), 4).T
    sizes[0, [k for kind in FRACTIONS for k in program.checks(kind).values()]] = 1.0
    return sizes


def _raise_to_other_units(largest: dict[str | Column, Array], extent: float) -> None:
    """Raise units in which all terms are zero within rounding, such as a slide that never moves, to
    the size of others.

    A motion is so beside a turn of all, whose points are as far away as the mechanism is large [m];
    a force beside moments, and moments beside forces, at that arm.
    """
    for unit, least in ((ANGLE, 1.0), (LENGTH, extent), ("1", 1.0)):
        for power, per in enumerate(("", "/s", "/s^2")):
            if (found := largest.get(unit + per)) is not None:
                which = slice(power, power + 1 if power < 2 else None)
                found[which] = np.maximum(found[which], least)
    if FORCE in largest and MOMENT in largest and extent > 0.0:
        forces, moments = largest[FORCE], largest[MOMENT]
        largest[FORCE] = np.maximum(forces, moments / extent)
        largest[MOMENT] = np.maximum(moments, forces * extent)


def _kind(program: Program, column: Column) -> str | Column:
    """Key by which columns are compared: their unit, or, if that says nothing, themselves;
    directions with each other.
    """
    if isinstance(column, Check):
        return ANGLE if column.kind == "turns" else column
    unit = column.unit(program.data.kinds)
    return (
        column.group if column.group == "pose" and unit == "1" else column if unit == "1" else unit
    )


def _listed(columns: Collection[Column]) -> str:
    """Some columns for a reader, outputs before what is none."""
    return listed(f"'{name}'" for name in sorted(columns, key=lambda one: isinstance(one, Check)))
