"""Expressions looked at at random points: an identity of smooth functions that holds at some of
them holds at all.

So a pattern is verified before a rule is applied that needs it, and what rounding leaves of a
coefficient is distinguished from a coefficient. The points are the same in every process.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt

from ..base.arrays import Expression
from ..base.interpret import Arithmetic, followable, interpret, numpy_arithmetic
from ..base.scalars import column
from .multibody import Coordinate, Multibody
from .spherical import SphericalCoordinates, axes_of
from .substitution import Expressions

COUNT = 64
_FEWEST = 8
_ZERO = 1e-10

Values = npt.NDArray[Any]
"""Array of doubles, or of complex numbers."""


def drawn(expression: ca.SX, coordinates: Iterable[Coordinate]) -> Values:
    """An expression's entries at random values of all its symbols, (entries, :data:`COUNT`); NaN
    where it has no value.

    Cosine and sine of a coordinate are those of one angle, and axes of a body are at right angles;
    every other symbol is a number from a half to one and a half, as lengths, masses and factors
    are; a slide is so many of its ``size``. The root of a negative number is imaginary, so an
    identity also holds where links do not reach.
    """
    symbols = ca.symvar(ca.SX(expression))
    generator = np.random.default_rng(0)
    values = {symbol.element_hash(): generator.uniform(0.5, 1.5, COUNT) for symbol in symbols}
    turned = set[SphericalCoordinates]()
    for coordinate in coordinates:
        spherical = coordinate.spherical
        if coordinate.kind == "angle" and not values.keys().isdisjoint(coordinate.keys):
            angle = generator.uniform(-np.pi, np.pi, COUNT)
            values |= dict(
                zip(coordinate.keys, (np.cos(angle), np.sin(angle), angle), strict=False)
            )
        elif coordinate.kind == "slide" and coordinate.keys[0] in values:
            values[coordinate.keys[0]] *= coordinate.size
        elif not (
            spherical is None or spherical in turned or values.keys().isdisjoint(coordinate.keys)
        ):
            turned.add(spherical)
            axes = _turned(generator.normal(size=(4, COUNT)))
            for symbol, row in zip(ca.vertsplit(spherical.axes), axes, strict=True):
                values[symbol.element_hash()] = row
    rows = [values[symbol.element_hash()] for symbol in symbols]
    function = ca.Function("drawn", [column(symbols)], [ca.densify(ca.vec(ca.SX(expression)))])
    with np.errstate(all="ignore"):
        try:
            found = (
                interpret(function, [rows], _ARITHMETIC)[0]
                if followable(function)
                else function(np.array(rows)).full()
            )
        except TypeError:  # no order of imaginary numbers
            found = [np.nan] * function.numel_out(0)
    return np.array([np.broadcast_to(row, COUNT) for row in found]).reshape(-1, COUNT)


def _turned(quaternions: Values) -> Values:
    """The axes that quaternions (4, n) turn to, (9, n)."""
    symbols = ca.SX.sym("quaternion", 4)
    return np.asarray(ca.Function("axes", [symbols], [axes_of(symbols)])(quaternions).full())


@dataclass(frozen=True, eq=False)
class Sampling:
    """Random values of ``coordinates`` at which expressions are looked at; what is below
    ``rounding``, relative to others, is zero.
    """

    coordinates: Sequence[Coordinate]
    rounding: float

    @classmethod
    def of(cls, multibody: Multibody) -> Sampling:
        """The values of a mechanism's coordinates, and the rounding of its axes and places."""
        return cls(multibody.coordinates, max(_ZERO, multibody.slack))

    def over(self, known: Expressions) -> Sampling:
        """The values of inputs, for expressions into which what is ``known`` was put: a slide that
        is an input itself has its size.
        """
        slides = {c: known.put_into(c.value) for c in self.coordinates if c.kind == "slide"}
        given = [replace(c, variables=x) for c, x in slides.items() if x.is_symbolic()]
        return replace(self, coordinates=given)

    def vanish(self, expressions: Expression, beside: Expression = 1.0) -> bool:
        """Return whether expressions are zero for all values of their symbols, relative to the
        largest of others.
        """
        expressions = ca.SX(expressions)
        if expressions.is_zero():
            return True
        found = drawn(ca.vertcat(ca.vec(expressions), ca.vec(ca.SX(beside))), self.coordinates)
        found = np.abs(found[:, np.isfinite(found).all(axis=0)])
        residuals, sizes = found[: expressions.numel()], found[expressions.numel() :]
        return bool(
            found.shape[1] >= _FEWEST
            and (residuals.max(axis=0) <= self.rounding * sizes.max(axis=0)).all()
        )


_KNOWN = numpy_arithmetic()
_ARITHMETIC = Arithmetic(_KNOWN.constant, {**_KNOWN.operations, ca.OP_SQRT: np.emath.sqrt})
