"""Prescribed motions of driven joints: d(t), d'(t), d''(t).

A law is a frozen object with one method, ``graph(t)``, which returns a CasADi expression of the
symbol t; rates come by automatic differentiation.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca

from ..arguments import fitting, public
from ..arithmetic.scalars import column, entries
from ..base.symbolic import symbolic
from ..errors import DeclarationError, shown
from ..renamed import renamed
from .curves import curve, rows
from .ends import beyond_ends
from .expressions import coordinates, expressed, scalar, symbols_of
from .kinks import Smooth
from .parts import Expression
from .scaled import Scaled
from .stretches import Stretch
from .validity import Demand


@renamed
@dataclass(frozen=True, eq=False)
class Motion:
    """A law of motion as a function from the symbol t [s] to the coordinate [rad or m].

    ``span`` is the time the law covers, and ``knots`` are the times between which the second
    derivative of a spline is linear. Of a motion made of moves ``stretches`` are these, ``period``
    is their time where they go on over and over, and ``parameter_constraints`` are conditions on
    the parameters. ``description`` describes a motion from a file; ``unit`` is rad or m if its
    numbers were given as texts with units.
    """

    graph: Callable[[Any], Any]
    span: tuple[float, float] = (-math.inf, math.inf)
    knots: tuple[float, ...] = ()
    stretches: tuple[Stretch, ...] = ()
    period: Expression | None = None
    parameter_constraints: tuple[Demand, ...] = ()
    description: str = ""
    unit: str = ""

    @fitting
    def __call__(self, x: Expression) -> Expression:
        """The law of an expression in place of the time, as of a joint's coordinate, for
        constraints and loads.
        """
        if self.knots:
            raise DeclarationError(
                "a motion by samples depends on the time alone; expected lagrange_casadi.curve(x,"
                " y)(EXPRESSION)"
            )
        try:
            expression = ca.SX(x)
        except (NotImplementedError, TypeError, RuntimeError):
            raise DeclarationError(
                f"motion: expected a casadi.SX expression, got {shown(x)}"
            ) from None
        return self.graph(expression)


@public
def polynomial(*coefficients: Expression) -> Motion:
    """Return the motion c0 + c1 t + c2 t^2 + ... (paper, eq. 22).

    Parameters
    ----------
    *coefficients
        Coefficients [rad or m, per s, per s^2 and so on]: numbers, expressions of parameters, or
        texts as in ``polynomial("45 deg", "360 deg/s")``.

    Returns
    -------
    Motion
        The law of motion: the joint's coordinate [rad or m] at the time t [s].

    Raises
    ------
    DeclarationError
        Without a coefficient, and for one that is no number or expression.
    """
    if not coefficients:
        raise DeclarationError("polynomial: expected at least one coefficient")
    terms, unit = coordinates("polynomial", ((c, _per(k)) for k, c in enumerate(coefficients)))

    def graph(t: ca.SX) -> ca.SX:
        value = ca.SX(terms[-1])
        for coefficient in reversed(terms[:-1]):
            value = value * t + coefficient
        return value

    return Motion(graph, unit=unit)


def _per(order: int) -> str:
    """Unit suffix of a derivative by time."""
    return "" if order == 0 else "/s" if order == 1 else f"/s^{order}"


@public
def harmonic(
    mean: Expression, amplitude: Expression, frequency: Expression, phase: Expression = 0.0
) -> Motion:
    """Return the motion mean + amplitude sin(2 pi frequency t + phase).

    Parameters
    ----------
    mean, amplitude
        Mean value and amplitude [rad or m], or texts such as ``"45 deg"``.
    frequency
        Frequency [Hz], a number or an expression of parameters.
    phase
        Phase [rad], or a text such as ``"90 deg"``.

    Returns
    -------
    Motion
        The law of motion.

    Raises
    ------
    DeclarationError
        For a value that is neither a number nor an expression of parameters.
    """
    (middle, size), unit = coordinates("harmonic", ((mean, ""), (amplitude, "")))
    often = scalar("harmonic: frequency", frequency, symbols_of(frequency), "parameter")
    ahead = scalar("harmonic: phase", phase, symbols_of(phase), "parameter", "rad")
    return Motion(lambda t: middle + size * ca.sin(2.0 * math.pi * often * t + ahead), unit=unit)


@public
def expression(law: Callable[[ca.SX], Expression]) -> Motion:
    """Return a motion by a function of the time.

    Parameters
    ----------
    law
        Function that takes the symbol t [s] and returns a ``casadi.SX`` expression of it and of
        parameters [rad or m]. Its value and rate must not jump.

    Returns
    -------
    Motion
        The law of motion; a scene refuses expressions of anything else.

    Raises
    ------
    DeclarationError
        If ``law`` is not a function.
    """
    if not callable(law):
        raise DeclarationError(f"expression: expected a function of the symbol t, got {law!r}")
    return Motion(law)


@public
def samples(times: Sequence[Expression], values: Sequence[Expression]) -> Motion:
    """Return a cubic spline through samples, with a continuous second derivative (not-a-knot ends).

    Parameters
    ----------
    times
        Increasing times [s], or texts such as ``"20 ms"``, at least four.
    values
        Values at these times [rad or m], or texts such as ``"45 deg"``. Parameters may scale and
        shift all of them together, as in ``samples(times, ratio * angles)``; the same holds for
        ``times``.

    Returns
    -------
    Motion
        The law of motion, defined between the first and the last time only.

    Raises
    ------
    DeclarationError
        For fewer than four samples, times that do not increase, numbers that are not finite, and
        parameters that do not change all values alike.
    """
    unit = ""
    if isinstance(times, list | tuple) and any(isinstance(time, str) for time in times):
        times = [
            scalar("motion samples: times", time, symbols_of(time), "parameter", "s")
            for time in times
        ]
    if isinstance(values, list | tuple) and any(isinstance(value, str) for value in values):
        values, unit = coordinates("motion samples: values", ((value, "") for value in values))
    at, to = Scaled.of("motion samples: times", times), Scaled.of("motion samples: values", values)
    t, v = rows("motion samples", at.numbers, to.numbers, 4)
    through = curve(t, v)

    def graph(time: ca.SX) -> Expression:
        value = through(time if at.scale is None else (time - at.shift) / at.scale)
        return value if to.scale is None else to.shift + to.scale * value

    if at.scale is not None or to.scale is not None:
        return Motion(graph, unit=unit)
    return Motion(graph, span=(t[0], t[-1]), knots=tuple(t), unit=unit)


@symbolic
def motion_function(laws: Mapping[str, Motion], parameters: ca.SX) -> ca.Function:
    """The CasADi function ``motion(t, p) -> (d, d_rate, d_acceleration)`` of several laws, by the
    joint's name.

    Raises :class:`DeclarationError` for a law that is not a scalar expression of t and parameters.
    """
    t = ca.SX.sym("t")
    rows = [_derivatives(_scalar(joint, law, t, parameters), t) for joint, law in laws.items()]
    stacked = [column(row[order] for row in rows) for order in range(3)]
    return ca.Function(
        "motion",
        [t, parameters],
        stacked,
        ["t", "p"],
        ["d", "d_rate", "d_acceleration"],
        {"cse": True},
    )


def smooth_laws(laws: Mapping[str, Motion], parameters: ca.SX) -> dict[str, Smooth]:
    """Check that laws have no kinks in time, by the joint's name.

    Moves go on smoothly by their making, wherever parameters allow them.
    """
    t = ca.SX.sym("t")
    looked_at = {joint: law for joint, law in laws.items() if not (law.knots or law.stretches)}
    found = {
        joint: Smooth.of(_scalar(joint, law, t, parameters), t, parameters)
        for joint, law in looked_at.items()
    }
    return {joint: smooth for joint, smooth in found.items() if smooth is not None}


@symbolic
def ends_function(laws: Mapping[str, Motion], parameters: ca.SX) -> ca.Function | None:
    """The CasADi function ``beyond(t, p)``: how far what the laws put into curves is beyond their
    ends, a row a joint of the laws.

    Below zero where it is between them; None where no law has a curve with ends.
    """
    t = ca.SX.sym("t")
    found = [
        [] if law.knots else beyond_ends(_scalar(joint, law, t, parameters))
        for joint, law in laws.items()
    ]
    if not any(found):
        return None
    rows = [functools.reduce(ca.fmax, far, ca.SX(-1.0)) for far in found]
    return ca.Function(
        "beyond",
        [t, parameters],
        [ca.densify(ca.vertcat(*rows))],
        ["t", "p"],
        ["beyond"],
        {"cse": True},
    )


def _scalar(joint: str, law: Motion, t: ca.SX, parameters: ca.SX) -> Expression:
    what = f"the motion of joint '{joint}'"
    value = expressed(what, law.graph, [t], "the time t")
    if isinstance(value, float) and math.isnan(value):
        raise DeclarationError(
            f"{what} is not a number; use CasADi's functions, as casadi.sin in place of math.sin"
        )
    symbols = [t, *entries(parameters)]
    return scalar(what, value, symbols, "parameter")


def _derivatives(value: ca.SX, t: ca.SX) -> list[ca.SX]:
    value = ca.SX(value)
    rate = ca.densify(ca.jacobian(value, t))
    return [ca.densify(value), rate, ca.densify(ca.jacobian(rate, t))]
