"""Instants of a scene: in equal steps of time, or of the coordinate of a driven joint.

Start and stop may be expressions of the parameters. Then every design has instants of its own.
"""

from __future__ import annotations

import functools
import hashlib
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np
import numpy.typing as npt

from ..base.arrays import Array, Operand
from ..base.brief import Brief
from ..base.scalars import called
from ..base.tables import ANGLE, LENGTH
from ..base.units import quantity
from ..errors import DeclarationError, check_known, shown
from .declared_parts import Expression
from .even_points import EvenPoints, checked, points
from .limits import values_note
from .mechanism import Mechanism
from .motion_inverse import Missed, MotionInverse, Passage
from .motion_laws import Motion
from .sampled_laws import Laws

Over = tuple[str, Expression, Expression, int]
"""Equal steps of the coordinate of a driven joint [rad or m]: its name, start, stop and count; both
ends are included.
"""

Times = tuple[Expression, Expression, int]
"""Equal steps of time [s]: start, stop and count; both ends are included."""

Bound = float | str
"""A number, or a function of the parameters as CasADi writes it down, so that it can be compared
and sent.
"""

_ENDS = 1e-12
"""Part of the requested time by which rounding may put an end of it beyond samples: a motion is
inverted to find the times of ``over=``.
"""

TURNS = 4.0 * math.pi
"""Angles beyond these [rad], without a unit, were meant in degrees: the directions of a posture,
and whole numbers over a drive.
"""

_MOST_SAMPLES = 1 << 16
"""Largest number of times at which a motion is checked for reversal."""


@dataclass(frozen=True)
class Timing:
    """Definition of instants: ``count`` from ``start`` to ``stop``, of time [s], or of the
    coordinate of ``joint`` [rad or m].

    A law of motion that is not steady is followed to that joint's coordinate from the time
    ``around`` [s]. The coordinate ``slides``, or is an angle.
    """

    start: Bound
    stop: Bound
    count: int
    joint: str = ""
    around: Bound = 0.0
    slides: bool = False

    @classmethod
    def of(
        cls,
        mechanism: Mechanism,
        motion: Mapping[str, Motion],
        t: Expression,
        over: Over | None = None,
    ) -> Timing:
        """Parse the user's ``t``, or ``over`` if that is given; ``t`` is then the range in which
        ``over`` is sought.

        Raises :class:`.DeclarationError` for what is neither, :class:`.UnknownNameError` for a
        joint that is not driven.
        """
        if over is None:
            return cls(*_read(mechanism, "t", t))
        if not isinstance(over, (tuple, list)) or len(over) != 4 or not isinstance(over[0], str):
            raise DeclarationError(f"over: expected (joint, start, stop, count), got {shown(over)}")
        check_known("driven joint in over", [over[0]], motion)
        slides = mechanism.coordinates[over[0]][1].kind == "slide"
        unit = LENGTH if slides else ANGLE
        bounds = [
            _bound(name, bound, unit)
            for name, bound in zip(("START", "STOP"), over[1:], strict=False)
        ]
        start, stop, count = _read(mechanism, "over", (*bounds, over[3]), unit)
        if count < 2:
            raise DeclarationError(f"over: COUNT must be 2 or more, got {count}")
        if start == stop:
            raise DeclarationError(f"over: STOP must not be START, got {over[1]} for both")
        return cls(start, stop, count, over[0], _read(mechanism, "t", t)[0], slides)

    @property
    def unit(self) -> str:
        """The unit of start and stop."""
        return "s" if not self.joint else LENGTH if self.slides else ANGLE

    @property
    def fixed(self) -> bool:
        """True if start and stop are numbers, the same for all parameters."""
        return not isinstance(self.start, str) and not isinstance(self.stop, str)

    @property
    def shared(self) -> bool:
        """True if the instants are the same for all parameters."""
        return self.fixed and not self.joint

    def bounds(self, p: Array) -> tuple[Array, Array, Array]:
        """Start, stop and around for parameters (n, parameters), each (n,)."""
        start, stop, around = (_values(bound, p) for bound in (self.start, self.stop, self.around))
        return start, stop, around

    def ends(self, symbols: Expression) -> tuple[Operand, Expression]:
        """Start and stop as expressions of the parameters' symbols."""
        start, stop = (
            _function(bound)(symbols) if isinstance(bound, str) else bound
            for bound in (self.start, self.stop)
        )
        return start, stop

    def words(self, symbols: ca.SX) -> list[float | str]:
        """Form for JSON: start, stop, count, and for a joint its name and around; expressions as
        text that distinguishes them.
        """
        bounds = (self.start, self.stop, self.around)
        start, stop, around = (
            _text(bound, symbols) if isinstance(bound, str) else bound for bound in bounds
        )
        if self.joint:
            return [start, stop, self.count, self.joint, around]
        return [start, stop, self.count]


@dataclass(frozen=True, eq=False, repr=False)
class DriveAxis(Brief, np.lib.mixins.NDArrayOperatorsMixin):
    """The coordinate of a driven ``joint`` at instants that are equal steps of it: ``values`` (t,),
    in ``unit``, rad or m.

    NumPy and figures take it as its values.
    """

    joint: str
    unit: str
    values: Array

    def __array__(self, dtype: npt.DTypeLike | None = None, copy: bool | None = None) -> Array:
        return np.array(self.values, dtype) if copy else np.asarray(self.values, dtype)

    def __array_ufunc__(
        self, ufunc: np.ufunc, method: str, *inputs: Operand, **keywords: Operand
    ) -> Operand:
        return getattr(ufunc, method)(
            *(one.values if isinstance(one, DriveAxis) else one for one in inputs), **keywords
        )

    def __len__(self) -> int:
        return len(self.values)

    def __getitem__(self, chosen: int | slice | npt.NDArray[np.generic]) -> Operand:
        return self.values[chosen]

    @property
    def long_name(self) -> str:
        """Name in words."""
        return f"coordinate of joint '{self.joint}'"

    @property
    def label(self) -> str:
        """Label of an axis of a figure, with the unit of :meth:`drawn`."""
        return f"{self.joint} [{'deg' if self.unit == ANGLE else self.unit}]"

    def shown(self, value: float) -> str:
        """A coordinate in words, an angle in degrees."""
        return (
            f"{self.joint} = {self.drawn(value):.5g} {'deg' if self.unit == ANGLE else self.unit}"
        )

    def drawn(self, values: Operand) -> Operand:
        """Coordinates as figures and lines show them: angles in degrees."""
        return np.degrees(values) if self.unit == ANGLE else values


@dataclass(frozen=True, eq=False)
class Instants:
    """Instants ``t`` (t,) [s], and where they were asked for by a drive, its coordinate there."""

    t: Array
    over: DriveAxis | None = None


def even_of(timing: Timing, values: Mapping[str, float]) -> EvenPoints:
    """Start, stop and count in numbers, for values of all parameters.

    Raises :class:`.DeclarationError` for what they cannot be.
    """
    start, stop, _ = (float(bound[0]) for bound in timing.bounds(_row(values)))
    what, falls = ("over", True) if timing.joint else ("t", False)
    try:
        return checked(what, (start, stop, timing.count), falls=falls)
    except DeclarationError as error:
        note = "" if timing.fixed else values_note(values)
        raise DeclarationError(f"{error}{note}") from None


def span_of(laws: Laws, timing: Timing, values: Mapping[str, float]) -> tuple[float, float]:
    """The first and the last instant [s].

    Raises :class:`.DeclarationError` where there are none.
    """
    start, stop, _ = even_of(timing, values)
    if not timing.joint:
        return start, stop
    passage = _way(laws, timing, values)
    return float(passage.first[0]), float(passage.last[0])


def checked_span(laws: Laws, timing: Timing, values: Mapping[str, float]) -> tuple[float, float]:
    """The first and the last of instants [s].

    Raises :class:`DeclarationError` where there are none, or samples of a motion end.
    """
    start, stop = span_of(laws, timing, values)
    slack = _ENDS * (stop - start)
    for joint, (low, high) in zip(laws.joints, laws.spans, strict=True):
        if start < low - slack or stop > high + slack:
            raise DeclarationError(
                f"the samples of the motion of joint '{joint}' cover t from {low:g} to {high:g} s,"
                f" but t from {start:g} to {stop:g} s was requested"
            )
    return start, stop


def instants_of(laws: Laws, timing: Timing, values: Mapping[str, float]) -> Instants:
    """All instants for values of all parameters.

    Raises :class:`.DeclarationError` where there are none.
    """
    even = even_of(timing, values)
    if not timing.joint:
        return Instants(points(even))
    coordinates = points(even)
    passage = _way(laws, timing, values)
    t = MotionInverse.of(laws, timing.joint).times(passage, coordinates[None], _row(values))[0]
    if not np.isfinite(t).all():
        raise DeclarationError(
            f"over: {timing.count} coordinates of joint '{timing.joint}' from"
            f" {_shown(timing, even[0])} to {_shown(timing, even[1])} are too close in time: its"
            " motion is nearly at rest there; expected fewer points or another range"
        )
    return Instants(t, DriveAxis(timing.joint, timing.unit, coordinates))


def _way(laws: Laws, timing: Timing, values: Mapping[str, float]) -> Passage:
    """Times at which a drive goes from start to stop.

    Raises :class:`.DeclarationError` where it does not, and says what it does instead.
    """
    p = _row(values)
    start, stop, around = timing.bounds(p)
    law = MotionInverse.of(laws, timing.joint)
    passage = law.passage(start, stop, p, around, samples=min(4 * timing.count, _MOST_SAMPLES) + 1)
    why = Missed(int(passage.missed[0]))
    if why is Missed.REACHED:
        return passage
    joint, shown = timing.joint, functools.partial(_shown, timing)
    asked = f"from {shown(start[0])} to {shown(stop[0])}"
    where = f"t = {passage.t[0]:.6g} s, at {shown(passage.d[0])}"
    said = {
        Missed.STANDS_STILL: f"is at rest and does not go {asked}",
        Missed.OTHER_WAY: (
            f"runs opposite to the range {asked} at t = {passage.t[0]:.6g} s; expected START"
            " and STOP in the order of time"
        ),
        Missed.TURNS_BACK: f"does not go {asked}: it reverses at {where}",
        Missed.ENDS: f"does not go {asked}: its samples end at {where}",
        Missed.NEVER: f"does not go {asked}",
    }[why]
    raise DeclarationError(f"over: the motion of joint '{joint}' {said}{values_note(values)}")


def _shown(timing: Timing, value: float) -> str:
    """A coordinate in words."""
    if timing.slides:
        return f"{value:.6g} m"
    return f"{value:.6g} rad ({math.degrees(value):.6g} deg)"


def _read(
    mechanism: Mechanism, what: str, even: Times, unit: str = "s"
) -> tuple[Bound, Bound, int]:
    """Start, stop and count, each a number or an expression of parameters; two numbers are looked
    at as :func:`.checked` does.
    """
    if not isinstance(even, Sequence) or not any(isinstance(bound, ca.SX) for bound in even[:2]):
        return checked(what, even, unit, falls=what == "over")
    if len(even) != 3:
        raise DeclarationError(f"{what}: expected (start, stop, count), got {shown(even)}")
    names = ("START", "STOP")
    each = [
        mechanism.ownership.expression(f"{what}: {name}", bound, unit)
        for name, bound in zip(names, even[:2], strict=True)
    ]
    _, _, count = checked(what, (0.0, 1.0, even[2]))
    start, stop = (
        _written(mechanism, bound) if isinstance(bound, ca.SX) else bound for bound in each
    )
    return start, stop, count


def _bound(name: str, bound: Expression, unit: str) -> Operand:
    """A bound of a coordinate, a text as a number.

    Raises :class:`DeclarationError` for a text of another unit, and for an angle beyond two turns
    that is a whole number without a unit: what turns so often is rarely whole in rad, and was meant
    in degrees.
    """
    if isinstance(bound, ca.SX):
        return bound
    found = quantity(f"over: {name}", bound, unit, finite=False)
    as_number = unit == ANGLE and not isinstance(bound, str)
    if as_number and math.isfinite(found) and abs(found) > TURNS and found == round(found):
        raise DeclarationError(
            f"over: {name}: {found:.6g} rad is {math.degrees(found):.6g} deg, more than two turns;"
            f" '{found:g} deg' is {found:g} degrees, and '{found:g} rad' as many turns"
        )
    return found


def _written(mechanism: Mechanism, expression: ca.SX) -> str:
    return str(
        ca.Function(
            "bound", [mechanism.symbols], [ca.densify(expression)], ["p"], ["bound"], {"cse": True}
        ).serialize()
    )


@functools.lru_cache(maxsize=64)
def _function(written: str) -> ca.Function:
    return ca.Function.deserialize(written)


def _values(bound: Bound, p: Array) -> Array:
    if not isinstance(bound, str):
        return np.full(len(p), float(bound))
    return np.asarray(called(_function(bound), p.T)[0])


def _text(written: str, symbols: ca.SX) -> str:
    return f"{_function(written)(symbols)} #{hashlib.sha256(written.encode()).hexdigest()[:8]}"


def _row(values: Mapping[str, float]) -> Array:
    return np.array(list(values.values()), float)[None]
