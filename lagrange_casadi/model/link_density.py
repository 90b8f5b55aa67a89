"""Distribution of mass along a straight link: piecewise polynomial in the ratio u = xi/l, which
covers every density a table can give.

From a section at u to the tip the moments of the material are combinations of T_k(u) = int_u^1 p(w)
(w - u)^k dw with p = dm/du: mu0 = T0, mu1 = l (u T0 + T1), mu1 - xi mu0 = l T1, mu2 - xi mu1 = l^2
(u T1 + T2): nothing cancels near the tip.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Annotated, Any

import casadi as ca
import numpy as np

from ..base.arguments import Row, Symbolic, public
from ..base.arrays import Array, Expression, Operand
from ..base.brief import Brief
from ..errors import DeclarationError, check_kind
from .curves import Curve, rows


@dataclass(frozen=True, eq=False, repr=False)
class Density(Brief):
    """Mass along a link: on the i-th interval of ``breaks`` (ratios from 0 to 1) the polynomial
    sum_j cells[i][j] u^j.

    It is the mass per unit of the ratio [kg], or where ``per_length`` the mass per length [kg/m].
    Coefficients are numbers or expressions in parameters. Where slices have rotary inertia,
    ``slices`` are the :class:`.Slices`.
    """

    breaks: tuple[float, ...]
    cells: tuple[tuple[Expression, ...], ...]
    per_length: bool
    slices: Slices | None = None

    @property
    def even(self) -> bool:
        """True if it is one constant."""
        return len(self.cells) == len(self.cells[0]) == 1

    @property
    def jumps(self) -> tuple[float, ...]:
        """The inner breaks at which neighbouring cells have two values, or values that are not
        numbers.
        """
        found = []
        for u, before, after in zip(self.breaks[1:], self.cells, self.cells[1:], strict=False):
            known = not any(isinstance(c, ca.SX) for c in (*before, *after))
            values = (
                [sum(c * u**j for j, c in enumerate(cell)) for cell in (before, after)]
                if known
                else []
            )
            sizes = [sum(np.abs(c) for c in cell) for cell in (before, after)] if known else []
            if not known or np.any(np.abs(values[1] - values[0]) > _SAME * np.maximum(*sizes)):
                found.append(u)
        return tuple(found)

    def ends(self, length: Expression) -> tuple[Expression, Expression, Expression]:
        """Return two masses and a moment of inertia that together move just as the link does.

        They have its mass, first and second moment: with p = dm/du int p (1 - u) du, int p u du,
        and l^2 int p u (u - 1) du.

        Parameters
        ----------
        length : float or casadi.SX
            Length of the link [m].

        Returns
        -------
        tuple
            Mass at the base and at the tip [kg], and moment of inertia [kg m^2], not positive.
        """
        found: list[Any] = [0.0, 0.0, 0.0]
        for (a, b), cell in zip(
            zip(self.breaks, self.breaks[1:], strict=False), self.cells, strict=True
        ):
            for j, coefficient in enumerate(cell):
                mass, first, second = (
                    part / n
                    for n, part in zip(
                        range(j + 1, j + 4), _differences(b, a, j + 3)[j:], strict=True
                    )
                )
                for k, part in enumerate((mass - first, first, second - first)):
                    found[k] = found[k] + coefficient * part
        scale = length if self.per_length else 1.0
        return found[0] * scale, found[1] * scale, found[2] * scale * length * length

    def tails(self, u: Expression, length: Expression) -> tuple[Expression, Expression, Expression]:
        """Return T0, T1 and T2 of the mass from a ratio to the tip.

        Parameters
        ----------
        u : float or casadi.SX
            The ratio, from 0 to 1.
        length : float or casadi.SX
            Length of the link [m].

        Returns
        -------
        tuple
            The integrals of p (v - u)^k dv from u to 1, for k of 0, 1 and 2 [kg].
        """

        def larger(x: Expression) -> Expression:
            return ca.fmax(x, 0.0) if isinstance(u, ca.SX) else max(x, 0.0)

        scale = length if self.per_length else 1.0
        found: list[Any] = [0.0, 0.0, 0.0]
        for (a, b), cell in zip(
            zip(self.breaks, self.breaks[1:], strict=False), self.cells, strict=True
        ):
            high, low = 1.0 - u if b == 1.0 else larger(b - u), 0.0 if a == 0.0 else larger(a - u)
            parts = _differences(high, low, len(cell) + 2)
            for j, term in enumerate(shifted(cell, u)):
                for k in range(3):
                    found[k] = found[k] + term * (parts[j + k] / (j + k + 1))
        return found[0] * scale, found[1] * scale, found[2] * scale

    def cell_at(self, u: float) -> tuple[Expression, ...]:
        """Return the coefficients that hold at a ratio between two breaks.

        Parameters
        ----------
        u : float
            The ratio, from 0 to 1.

        Returns
        -------
        tuple
            Coefficients of powers of the ratio, the constant first.
        """
        return self.cells[int(np.searchsorted(self.breaks, u, side="right")) - 1]

    def at(self, number: Callable[[Expression], float], length: float) -> NumericDensity:
        """Return the density at given parameters.

        Parameters
        ----------
        number : callable
            Gives the value of an expression.
        length : float
            Length of the link [m].

        Returns
        -------
        NumericDensity
            Mass per unit of the ratio [kg].
        """
        scale = length if self.per_length else 1.0
        return NumericDensity(
            self.breaks, tuple(tuple(number(c) * scale for c in cell) for cell in self.cells)
        )


@dataclass(frozen=True, eq=False, repr=False)
class Slices(Brief):
    """Second moments of mass per length [kg m] of a link's slices, on the axes of its
    cross-section: like densities along it.

    They are the sums of y y, z z and y z over a slice; its moments of inertia per length are ``yy +
    zz`` about the link's axis, ``zz`` about y and ``yy`` about z.
    """

    yy: Density
    zz: Density
    yz: Density

    @property
    def each(self) -> tuple[Density, Density, Density]:
        """All three."""
        return self.yy, self.zz, self.yz

    @property
    def breaks(self) -> tuple[float, ...]:
        """All places between which each of them is a polynomial."""
        return tuple(sorted({place for moment in self.each for place in moment.breaks}))

    def whole(self, length: Expression) -> tuple[Expression, Expression, Expression]:
        """Return the moments of the whole link.

        Parameters
        ----------
        length : float or casadi.SX
            Length of the link [m].

        Returns
        -------
        tuple
            The sums of y y, z z and y z [kg m^2].
        """
        yy, zz, yz = (sum(moment.ends(length)[:2]) for moment in self.each)
        return yy, zz, yz


@dataclass(frozen=True)
class NumericDensity:
    """A :class:`Density` in numbers: mass per unit of the ratio [kg]."""

    breaks: tuple[float, ...]
    cells: tuple[tuple[float, ...], ...]

    @property
    def mass(self) -> float:
        """The whole mass [kg]."""
        return float(self.tails(0.0)[0])

    def tails(self, u: Operand) -> tuple[Any, Any, Any]:
        """T0, T1 and T2 at a ratio."""
        return Density(self.breaks, self.cells, per_length=False).tails(u, 1.0)

    def at(self, u: Array) -> Array:
        """The density at ratios ``u`` of any shape; at a break, that towards the tip."""
        cell = np.clip(np.searchsorted(self.breaks, u, side="right") - 1, 0, len(self.cells) - 1)
        return np.asarray(
            sum(
                np.where(cell == i, np.polynomial.polynomial.polyval(u, c), 0.0)
                for i, c in enumerate(self.cells)
            )
        )


@public
def uniform(mass: Symbolic) -> Density:
    """Return a constant density, by the whole mass of the link.

    Parameters
    ----------
    mass : float or casadi.SX
        Mass of the link [kg], a number or an expression of parameters.

    Returns
    -------
    Density
        Mass per length [kg/m].
    """
    return Density((0.0, 1.0), ((mass,),), per_length=False)


@public
def polynomial(*coefficients: Symbolic) -> Density:
    """Return the density c0 + c1 u + c2 u^2 + ... [kg/m], with u = xi/l.

    Parameters
    ----------
    *coefficients : float or casadi.SX
        The coefficients [kg/m], numbers or expressions of parameters. ``polynomial(a, b - a)``
        tapers from a at the base to b at the tip.

    Returns
    -------
    Density
        Mass per length [kg/m].

    Raises
    ------
    DeclarationError
        Without a coefficient.
    """
    if not coefficients:
        raise DeclarationError("density polynomial: expected at least one coefficient")
    return Density((0.0, 1.0), (tuple(coefficients),), per_length=True)


@public
def tabulated(ratios: Sequence[float], values: Annotated[Row, "kg/m"]) -> Density:
    """Return a density that is linear between values at ratios xi/l.

    Parameters
    ----------
    ratios : sequence of float
        Ratios xi/l (n,) that increase from 0 to 1.
    values : sequence of float
        Mass per length there (n,) [kg/m].

    Returns
    -------
    Density
        Mass per length [kg/m].

    Raises
    ------
    DeclarationError
        If ratios do not increase or do not reach from 0 to 1, or a value is negative.
    """
    u, v = rows("density table", ratios, values, 2)
    if (u[0], u[-1]) != (0.0, 1.0):
        raise DeclarationError(
            f"density table: ratios must reach from 0 to 1, got {u[0]:g} to {u[-1]:g}"
        )
    cells = []
    for i in range(len(u) - 1):
        slope = (v[i + 1] - v[i]) / (u[i + 1] - u[i])
        cells.append((v[i] - slope * u[i], slope))
    return Density(tuple(u), tuple(cells), per_length=True)


@public
def thick(density: Density, *, yy: Expression, zz: Expression, yz: Expression = 0.0) -> Density:
    """Return a density of slices that have rotary inertia, for a link in space.

    Parameters
    ----------
    density : Density
        Mass per length [kg/m].
    yy, zz, yz : float, casadi.SX or Density
        Second moments of mass per length [kg m]: the sums over a slice of y y, z z and y z times
        mass, on the axes of the link's cross-section. Each is a number, an expression of
        parameters, or a function of this module, whose values are then in kg m.

    Returns
    -------
    Density
        Mass per length with its second moments.

    Raises
    ------
    DeclarationError
        If ``density`` is not a density.

    Notes
    -----
    For a homogeneous bar, the second moments are the density of its material times the second
    moments of its area. A round bar of diameter d has yy = zz = d^2/16 times its mass per length.
    """
    check_kind("density thick", density, "a density of lagrange_casadi.density", Density)
    moments = [
        moment if isinstance(moment, Density) else polynomial(moment) for moment in (yy, zz, yz)
    ]
    if any(not moment.per_length or moment.slices for moment in moments) or density.slices:
        raise DeclarationError(
            "density thick: second moments are numbers, or along the link by polynomial, tabulated"
            " or along"
        )
    return replace(density, slices=Slices(*moments))


@public
def along(curve: Curve) -> Density:
    """Return a density along a smooth curve.

    Parameters
    ----------
    curve : Curve
        A :func:`.curve` through values [kg/m] over the ratio xi/l, from 0 to 1.

    Returns
    -------
    Density
        Mass per length [kg/m]. A value that is negative is refused when the density is used.

    Raises
    ------
    DeclarationError
        If it is periodic, or does not reach from 0 to 1.
    """
    if curve.periodic or (curve.low, curve.high) != (0.0, 1.0):
        raise DeclarationError(
            "density along: the curve must reach from 0 to 1, and must not be periodic, got"
            f" {curve!r}"
        )
    cells = []
    for start, cell in zip(curve.starts, curve.cells, strict=True):
        # In powers of the ratio, not of what is beyond the start; by fractions, for these terms
        # nearly cancel.
        powers = shifted([Fraction(c) for c in cell], -Fraction(start))
        cells.append(tuple(float(power) for power in powers))
    return Density((*curve.starts, 1.0), tuple(cells), per_length=True)


_SAME = 1e-9


def _differences(high: Operand, low: Operand, count: int) -> list[Operand]:
    """high^n - low^n for n = 1, 2, ..., by products of their difference, so that close ones do not
    cancel; of numbers or arrays.
    """
    width, power, total, found = high - low, low, 1.0, []
    for _ in range(count):
        found.append(width * total)
        total, power = total * high + power, power * low
    return found


def shifted(cell: Sequence[Expression], u: Operand) -> list[Operand]:
    """Coefficients of p(u + x) as a polynomial in x."""
    return [
        sum(c * math.comb(n, j) * u ** (n - j) for n, c in enumerate(cell) if n >= j)
        for j in range(len(cell))
    ]
