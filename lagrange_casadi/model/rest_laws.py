"""Laws of moves from rest to rest: the share of the way over the share of the time, of the
literature on cams and servo drives.

A law is s(u) with u from 0 to 1, s(0) = 0, s(1) = 1, at rest at both ends, and the same backwards:
s(1 - u) = 1 - s(u). A move over a way h in a time T has the largest speed ``speed`` h/T,
acceleration ``acceleration`` h/T^2 and jerk ``jerk`` h/T^3. R. L. Norton, *Cam Design and
Manufacturing Handbook*, 2nd edition, 2009, chapter 3; VDI 2143, part 1.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import casadi as ca

from ..base.arguments import Symbolic, public
from ..base.brief import Brief
from ..errors import DeclarationError, check_known
from .declared_parts import Expression
from .expressions import plain

_CUBE = 1.0 / 3.0
_ROOTS: dict[str, Callable[[Any], Any]] = {
    "speed": lambda ratio: ratio,
    "acceleration": ca.sqrt,
    "jerk": lambda ratio: ratio**_CUBE,
}
"""Time of a move from the ratio of its largest speed, acceleration or jerk in a time of one, to
the limit.
"""


@dataclass(frozen=True, eq=False, repr=False)
class RestLaw(Brief):
    """A law from rest to rest, ``shape(u)``, and its largest ``speed``, ``acceleration`` and
    ``jerk``, for one way in one time.

    ``jerk`` is infinite where accelerations jump. ``begins`` are acceleration and jerk where the
    law begins; at its end they are the same with the opposite sign, and the same. ``inner`` are
    places u within it at which they jump, each with by how much.
    """

    name: str
    speed: Expression
    acceleration: Expression
    jerk: Expression
    shape: Callable[[Any], Any]
    begins: tuple[Expression, Expression] = (0.0, 0.0)
    inner: tuple[tuple[Expression, tuple[Expression, Expression]], ...] = ()

    def least_time(self, displacement: Expression, limits: Mapping[str, Expression]) -> Expression:
        """The shortest time [s] in which a way [rad or m] is made within limits of speed,
        acceleration and jerk, by these names.
        """
        size = ca.fabs(ca.SX(displacement))
        return functools.reduce(
            ca.fmax,
            (
                root(getattr(self, name) * size / limits[name])
                for name, root in _ROOTS.items()
                if name in limits
            ),
        )


@public
def trapezoid(share: Symbolic = _CUBE) -> RestLaw:
    """Return the law of constant acceleration, constant speed and constant deceleration, for a
    :func:`move`.

    Parameters
    ----------
    share
        Share of the time in which the motion speeds up, at most 1/2.

    Returns
    -------
    RestLaw
        The law.

    Raises
    ------
    DeclarationError
        For a number that is no such share.
    """
    _refuse_share("trapezoid: share", share, 0.5)
    top, steep = 1.0 / (1.0 - share), 1.0 / (share * (1.0 - share))

    def shape(u: Expression) -> Expression:
        return _both_halves(
            u, lambda w: _before(w, share, steep * w * w / 2.0, top * (w - share / 2.0))
        )

    inner = ((share, (-steep, 0.0)), (1.0 - share, (-steep, 0.0)))
    return RestLaw("trapezoid", top, steep, math.inf, shape, (steep, 0.0), inner)


@public
def s_curve(share: Symbolic = _CUBE, rounding: Symbolic = 0.5) -> RestLaw:
    """Return the S-curve law of seven segments, for a :func:`move`.

    Parameters
    ----------
    share
        Share of the time in which the motion speeds up, at most 1/2.
    rounding
        Share of that in which the acceleration changes, at most 1.

    Returns
    -------
    RestLaw
        The law.

    Raises
    ------
    DeclarationError
        For numbers that are no such shares.
    """
    _refuse_share("s_curve: share", share, 0.5)
    _refuse_share("s_curve: rounding", rounding, 1.0)
    third = share * rounding / 2.0
    return _seven(1.0 - share, share - third, third)


def s_curve_within(
    displacement: Expression, speed: Expression, acceleration: Expression, jerk: Expression
) -> RestLaw:
    """The S-curve of the shortest time within all three limits: fewer than seven segments where a
    limit is not reached.

    With a top speed v, acceleration a and jerk j it is a rectangle of h/v seconds, averaged over
    v/a and over j/a seconds.
    """
    size = ca.fabs(ca.SX(displacement))
    most = ca.fmin(ca.SX(acceleration), ca.sqrt(speed * jerk))
    most = ca.fmin(most, (size * jerk * jerk / 2.0) ** _CUBE)
    ramp = most * most / jerk
    # The speed at which the way is used up by speeding up and slowing down.
    top = ca.fmin(
        ca.SX(speed), 2.0 * most * size / (ramp + ca.sqrt(ramp * ramp + 4.0 * most * size))
    )
    each = size / top, top / most, most / jerk
    whole = each[0] + each[1] + each[2]
    return _seven(*(plain(part / whole) for part in each))


def trapezoid_within(
    displacement: Expression, speed: Expression, acceleration: Expression
) -> RestLaw:
    """The trapezoid of speed of the shortest time within a speed and an acceleration; a triangle
    where the speed is not reached.
    """
    size = ca.fabs(ca.SX(displacement))
    top = ca.fmin(ca.SX(speed), ca.sqrt(acceleration * size))
    ramp = top / acceleration
    return trapezoid(plain(ca.fmin(ramp / (size / top + ramp), 0.5)))


def _seven(first: Expression, second: Expression, third: Expression) -> RestLaw:
    """Fractions of time of the rectangle of speed and of its two averages, the longest first; their
    sum is one.
    """
    top = 1.0 / first
    steep = top / second
    sharp = steep / third
    ramp = second + third
    end = top * ramp / 2.0  # the way of speeding up

    def shape(u: Expression) -> Expression:
        def half(w: Expression) -> Expression:
            rising = sharp * w**3 / 6.0
            x = w - third
            steady = sharp * third**3 / 6.0 + x * (sharp * third * third / 2.0 + x * steep / 2.0)
            remaining = ramp - w
            fading = (
                end - top * remaining + ca.if_else(remaining > 0.0, sharp * remaining**3 / 6.0, 0.0)
            )
            return _before(w, third, rising, _before(w, second, steady, fading))

        return _both_halves(u, half)

    places = (third, second, ramp)
    inner = [(place, (0.0, -sharp if k < 2 else sharp)) for k, place in enumerate(places)]
    inner += [(1.0 - place, (0.0, -jump[1])) for place, jump in reversed(inner)]
    return RestLaw("s_curve", top, steep, sharp, shape, (0.0, sharp), tuple(inner))


def _refuse_share(what: str, share: object, most: float) -> None:
    if not isinstance(share, ca.SX) and not (
        isinstance(share, (int, float)) and 0.0 < share <= most
    ):
        raise DeclarationError(f"{what} must be above 0 and at most {most:g}, got {share!r}")


def _both_halves(u: Expression, half: Callable[[Expression], Expression]) -> Expression:
    """A law of which the first half is known."""
    displacement = half(_before(u, 0.5, u, 1.0 - u))
    return _before(u, 0.5, displacement, 1.0 - displacement)


def _before(x: Expression, place: Expression, first: Expression, then: Expression) -> Expression:
    """One value before a place and another from there on; by two comparisons, for C distinguishes a
    number from its negation.
    """
    return ca.if_else(x < place, first, 0.0) + ca.if_else(x >= place, then, 0.0)


def _modified_trapezoid(w: Expression) -> Expression:
    c = 1.0 / (2.0 + math.pi)
    rising = c * (2.0 * w - ca.sin(4.0 * math.pi * w) / (2.0 * math.pi))
    x = w - 0.125
    steady = c * (0.25 - 1.0 / (2.0 * math.pi) + x * (2.0 + 4.0 * math.pi * x))
    y = w - 0.5
    fading = 0.5 + c * (2.0 * (1.0 + math.pi) * y + ca.sin(4.0 * math.pi * y) / (2.0 * math.pi))
    return _before(w, 0.125, rising, _before(w, 0.375, steady, fading))


def _modified_sine(w: Expression) -> Expression:
    c = 1.0 / (4.0 + math.pi)
    rising = c * (math.pi * w - ca.sin(4.0 * math.pi * w) / 4.0)
    y = w - 0.5
    steady = 0.5 + c * (math.pi * y + 2.25 * ca.sin(4.0 * math.pi / 3.0 * y))
    return _before(w, 0.125, rising, steady)


_LAWS: dict[str, RestLaw] = {
    law.name: law
    for law in (
        RestLaw(
            "cycloidal",
            2.0,
            2.0 * math.pi,
            4.0 * math.pi**2,
            lambda u: u - ca.sin(2.0 * math.pi * u) / (2.0 * math.pi),
            (0.0, 4.0 * math.pi**2),
        ),
        RestLaw(
            "modified_sine",
            4.0 * math.pi / (4.0 + math.pi),
            4.0 * math.pi**2 / (4.0 + math.pi),
            16.0 * math.pi**3 / (4.0 + math.pi),
            lambda u: _both_halves(u, _modified_sine),
            (0.0, 16.0 * math.pi**3 / (4.0 + math.pi)),
        ),
        RestLaw(
            "modified_trapezoid",
            2.0,
            8.0 * math.pi / (2.0 + math.pi),
            32.0 * math.pi**2 / (2.0 + math.pi),
            lambda u: _both_halves(u, _modified_trapezoid),
            (0.0, 32.0 * math.pi**2 / (2.0 + math.pi)),
        ),
        RestLaw(
            "polynomial_345",
            1.875,
            10.0 / math.sqrt(3.0),
            60.0,
            lambda u: _both_halves(u, lambda w: w**3 * (10.0 + w * (6.0 * w - 15.0))),
            (0.0, 60.0),
        ),
        RestLaw(
            "polynomial_4567",
            2.1875,
            84.0 * math.sqrt(5.0) / 25.0,
            52.5,
            lambda u: _both_halves(u, lambda w: w**4 * (35.0 + w * (w * (70.0 - 20.0 * w) - 84.0))),
        ),
        RestLaw(
            "simple_harmonic",
            math.pi / 2.0,
            math.pi**2 / 2.0,
            math.inf,
            lambda u: (1.0 - ca.cos(math.pi * u)) / 2.0,
            (math.pi**2 / 2.0, 0.0),
        ),
        trapezoid(),
        s_curve(),
    )
}
"""The laws by name, those of shares with the usual ones."""

LAWS = (*_LAWS,)
"""The names of all laws."""


def rest_law(what: str, law: str | RestLaw) -> RestLaw:
    """A law by its name, or one of :func:`trapezoid` and :func:`s_curve`.

    Raises :class:`DeclarationError`, naming ``what``.
    """
    if isinstance(law, RestLaw):
        return law
    check_known("law", [law], LAWS, place=what)
    return _LAWS[law]
