"""Prescribed motions of driven joints: d(t), d'(t), d''(t).

A law is a frozen object with one method, ``graph(t)``, which returns a CasADi expression of the
symbol t; rates come by automatic differentiation.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from ..base.arguments import fitting, public
from ..base.brief import Brief
from ..errors import DeclarationError, shown
from .curves import curve, rows
from .declared_parts import Expression
from .expressions import coordinates, parametric
from .polynomials import value_at
from .stretches import Stretch
from .validity import Demand

_POINTS, _SAME = 8, 1e-11
"""Number of values of the parameters for which rows are compared, and their relative rounding."""


@dataclass(frozen=True, eq=False, repr=False)
class Motion(Brief):
    """A law of motion as a function from the symbol t [s] to the coordinate [rad or m].

    ``span`` is the time the law covers, and ``knots`` are the times between which the second
    derivative of a spline is linear. Of a motion made of moves ``stretches`` are these, ``period``
    is their time where they go on over and over, and ``parameter_constraints`` are conditions on
    the parameters. ``description`` describes a motion from a file, and ``note`` says how its time
    stamps were read; ``unit`` is rad or m if its numbers were given as texts with units.
    """

    graph: Callable[[Any], Any]
    span: tuple[float, float] = (-math.inf, math.inf)
    knots: tuple[float, ...] = ()
    stretches: tuple[Stretch, ...] = ()
    period: Expression | None = None
    parameter_constraints: tuple[Demand, ...] = ()
    description: str = ""
    unit: str = ""
    note: str = ""

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
    return Motion(lambda t: value_at(terms, t), unit=unit)


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
        Frequency [Hz], or a text such as ``"50 Hz"``.
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
    often = parametric("harmonic: frequency", frequency, "1/s")
    ahead = parametric("harmonic: phase", phase, "rad")
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
        times = [parametric("motion samples: times", time, "s") for time in times]
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


@dataclass(frozen=True, eq=False)
class Scaled:
    """A row that is shift + scale n_i; where it holds no parameters, the ``numbers`` themselves,
    with no shift and no scale.
    """

    numbers: Sequence[float]
    scale: Any = None
    shift: Any = None

    @classmethod
    def of(cls, what: str, row: ca.SX | Sequence[Expression]) -> Scaled:
        """A row of numbers or of expressions in parameters.

        Raises :class:`DeclarationError`, naming ``what``, for expressions that are not one scale
        times numbers, plus one shift.
        """
        if not isinstance(row, ca.SX) and (
            isinstance(row, str) or not hasattr(row, "__len__") or not getattr(row, "shape", (1,))
        ):
            raise DeclarationError(f"{what}: expected a row of numbers, got {row!r}")
        entries = ca.vertsplit(ca.vec(row)) if isinstance(row, ca.SX) else row
        if not any(isinstance(entry, ca.SX) and not entry.is_constant() for entry in entries):
            return cls([float(entry) for entry in entries] if isinstance(row, ca.SX) else row)
        column = ca.vertcat(*entries)
        symbols = ca.symvar(column)
        drawn = np.random.default_rng(0).uniform(0.5, 1.5, (len(symbols), _POINTS))
        with np.errstate(all="ignore"):
            values = ca.Function("row", [ca.vertcat(*symbols)], [ca.densify(column)])(drawn).full()
            off = values - values[0]
            last = int(np.argmax(np.abs(off[:, 0])))
            numbers = off[:, 0] / off[last, 0]
            alike = np.abs(off - numbers[:, None] * off[last]) <= _SAME * np.abs(values).max(axis=0)
        if not alike.all():
            raise DeclarationError(
                f"{what}: parameters may only scale and shift all of them together; expected"
                " NUMBERS*(expression) + (expression), or a motion.expression of"
                " lagrange_casadi.curve(times, values)"
            )
        return cls(numbers.tolist(), column[last] - column[0], column[0])
