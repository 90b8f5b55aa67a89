"""Friction that follows reactions: forces and reactions solved together, at every instant.

All forces are linear in the frictions' forces s along their coordinates, so what presses on each
joint is R(s) = R0 + A s. The law

    s_j = -sigma_j sum_k c_k |R_k(s)| - viscous_j v_j

is solved friction by friction where these are explicit, in blocks where they depend on each other:
by a fixed number of Newton steps, from s of the frictionless R0. With B_jk = sum c |A_k|, which is
not negative, I - B is an M-matrix where all pivots of its elimination are positive (Berman,
Plemmons, *Nonnegative Matrices in the Mathematical Sciences*, chapter 6). Then the law is a
contraction in a weighted norm: there is one solution, and only one. Else the mechanism may jam.

At rest the sign is open, and so is all that depends on it: no number. Where a rate passes through
zero, as at the end of a stroke, the sign is the one of the acceleration, that of the instants right
after.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from ..base.arrays import Expression, Operand
from ..base.quantities import Check, Column
from ..base.scalars import column
from ..base.vocabulary import Precision
from ..model.meshes import Loss, Transmission
from .pressing import Contact, FrictionContact, both_edges

STEPS = 4
"""Newton's steps: the error goes as the 4th, 10th, 22nd, 46th power of how much of itself a
friction brings about.
"""

SLIP: dict[Precision, float] = {"double": 1e-9, "single": 1e-4}
"""Largest relative residual of friction laws."""

_NOTHING = 1e-30


@dataclass(frozen=True, eq=False)
class Solved:
    """Symbols of frictions and their values; by name the forces and the power that is lost; and the
    checks of them.
    """

    symbols: Any
    values: Any
    checks: dict[Column, Any]
    forces: Mapping[str, Any]
    lost: Mapping[str, Any]


def solve(
    found: Sequence[FrictionContact],
    indeterminate: ca.SX,
    signs: Mapping[str, Expression] | None = None,
) -> Solved:
    """The forces of frictions, along their coordinates, from what presses on them, which is linear
    in the symbols of all.

    It is linear too in the symbols ``indeterminate`` of what equilibrium leaves open: frictions are
    solved where these are zero, and change with them by what they can change most. At rest
    frictions are at their limits, with the ``signs`` that are given by name; without, they are no
    number.
    """
    symbols = column(one.friction.symbol for one in found)
    n = len(found)
    pressing = column(x for one in found for contact in one.contacts for x in contact.pressing)
    slopes = ca.jacobian(pressing, symbols)
    indeterminate_slopes = ca.jacobian(pressing, indeterminate)
    free = ca.substitute(
        pressing, ca.vertcat(symbols, indeterminate), ca.SX.zeros(n + indeterminate.numel())
    )
    laws: list[_Law] = []
    first = 0
    for one in found:
        parts = []
        for contact in one.contacts:
            rows = range(first, first + len(contact.pressing))
            first += len(contact.pressing)
            parts.append(
                _Pressed(
                    contact,
                    [free[row] for row in rows],
                    [[_entry(slopes, row, k) for k in range(n)] for row in rows],
                )
            )
        laws.append(_Law.of(one, parts, None if signs is None else signs.get(one.friction.name)))
    values: list[Any] = [None] * n
    checks: dict[Column, Any] = {
        Check("rest", law.name): law.rest for law in laws if law.rest is not None
    }
    for block in _blocks(laws):
        checks |= _solve_block([laws[j] for j in block], block, values)
    if signs is not None:
        checks |= {
            Check("bend", law.name): bend for law in laws if (bend := _bend(law, laws)) is not None
        }
    if indeterminate_slopes.nnz():
        values = _doubted(laws, values, ca.fabs(indeterminate_slopes) @ indeterminate)
    lost = {one.friction.name: -value * one.rate for one, value in zip(found, values, strict=True)}
    forces = {one.friction.name: value for one, value in zip(found, values, strict=True)}
    return Solved(symbols, ca.densify(column(values)), checks, forces, lost)


@dataclass(frozen=True, eq=False)
class _Pressed:
    """A contact as R0 + A s: ``free`` is R0, ``slopes`` the rows of A, None where nothing."""

    contact: Contact
    free: list[Any]
    slopes: list[list[Any]]

    def at(self, values: Sequence[ca.SX | None]) -> list[ca.SX]:
        """R for values of all frictions, None where they count as zero."""
        return [_sum(row, values, start) for row, start in zip(self.slopes, self.free, strict=True)]

    def dependence(self, k: int) -> Expression:
        """Largest dependence on a friction; None if there is none."""
        column_ = [row[k] for row in self.slopes if row[k] is not None]
        lean = self.contact.lean
        most = self.contact.arm if lean is None else self.contact.arm + ca.fabs(lean)
        return None if not column_ else most * self.contact.size(column_)

    def push(self, pressing: Sequence[ca.SX], sigma: Expression) -> Expression:
        """The couple or force of a unit of mu where so much presses."""
        size, lean = self.contact.arm * self.contact.size(pressing), self.contact.lean
        return size if lean is None else size + sigma * (lean * pressing[0])

    def weights(
        self, pressing: Sequence[Expression], sigma: Expression, unit: Expression
    ) -> list[Expression]:
        """Derivatives of ``unit`` times the normal force by each component; their products with the
        components add up to it.
        """
        arm, lean = self.contact.arm, self.contact.lean
        if len(pressing) == 1:
            direction = arm * ca.sign(pressing[0])
            return [unit * (direction if lean is None else direction + sigma * lean)]
        share = unit * arm
        if self.contact.edges:
            one, other = (ca.sign(edge) for edge in both_edges(pressing))
            return [share / 2 * (one + other), share / 2 * (one - other)]
        share = share / ca.fmax(self.contact.size(pressing), _NOTHING)
        return [share * x for x in pressing]


@dataclass(frozen=True, eq=False)
class _Law:
    """s = -sigma mu sum arm |R(s)| - steady; ``still`` says that it is open at all instants."""

    name: str
    pressed: list[_Pressed]
    mu: Any
    sigma: Any
    steady: Any
    rest: Any
    still: bool = False

    @classmethod
    def of(cls, one: FrictionContact, pressed: list[_Pressed], sign: Expression = None) -> _Law:
        friction, v = one.friction, one.rate
        if isinstance(friction, Transmission):
            return cls(friction.name, pressed, 1.0, -1.0, None, None)
        if isinstance(friction, Loss):
            sigma, rest, still = _way(one, sign)
            return cls(friction.name, pressed, 1.0, sigma, None, rest, still)
        steady = (
            None
            if isinstance(friction.viscous, float) and friction.viscous == 0.0
            else friction.viscous * v
        )
        if not pressed:
            return cls(friction.name, [], 0.0, 0.0, steady, None)
        mu, lever = friction.mu, friction.radius if friction.axis.kind == "angle" else 1.0
        if friction.coulomb is not None:
            mu, lever = 1.0, 1.0
        if friction.static is not None:
            speed = v * lever / friction.stribeck
            squares = (
                speed * speed
                if not one.beside
                else speed * speed + (one.beside[0] / friction.stribeck) ** 2
            )
            mu = mu + (friction.static - mu) * ca.exp(-squares)
        if friction.smooth is not None:
            return cls(friction.name, pressed, mu, ca.tanh(v / friction.smooth), steady, None)
        sigma, rest, still = _way(one, sign, lever)
        return cls(friction.name, pressed, mu, sigma, steady, rest, still)

    def pushed(self, values: Sequence[ca.SX | None]) -> Expression:
        """The force for values of all frictions."""
        dry = -self.sigma * (
            self.mu
            * sum((part.push(part.at(values), self.sigma) for part in self.pressed), ca.SX(0))
        )
        return dry if self.steady is None else dry - self.steady

    def straight(
        self, values: Sequence[Expression], known: Sequence[Expression]
    ) -> tuple[Expression, list[Expression]]:
        """The force as ``start - slopes s``, beside what is ``known``, if all that presses kept its
        direction at ``values``.
        """
        start, slopes = ca.SX(0) if self.steady is None else -self.steady, [None] * len(known)
        for part in self.pressed:
            weights = part.weights(part.at(values), self.sigma, self.sigma * self.mu)
            for weight, beside, row in zip(weights, part.at(known), part.slopes, strict=True):
                start = start - weight * beside
                slopes = [
                    so_far
                    if slope is None
                    else weight * slope
                    if so_far is None
                    else so_far + weight * slope
                    for so_far, slope in zip(slopes, row, strict=True)
                ]
        return start, slopes

    def depends(self, k: int) -> bool:
        """Return whether it depends on a friction: never if the joint does not move at all, for
        then the friction is indeterminate.
        """
        return not self.still and any(part.dependence(k) is not None for part in self.pressed)


def _way(
    one: FrictionContact, sign: Expression, lever: Operand = 1.0
) -> tuple[Expression, Expression, bool]:
    """The sign of what slides, or its share of where it slides along two coordinates; whether it
    rests; and whether it always does, and has no ``sign`` given for that.
    """
    v, acceleration = one.rate, one.acceleration
    slow, quiet = one.slowest
    # A size has a kink wherever a change of rate is nothing but rounding; comparisons with a limit
    # have none.
    moves, reverses = ca.fabs(v) > slow, ca.logic_or(acceleration > quiet, acceleration < -quiet)
    if one.beside:
        other, change = one.beside
        moves = ca.logic_or(moves, ca.fabs(other) > lever * slow)
        reverses = ca.logic_or(
            reverses, ca.logic_or(change > lever * quiet, change < -lever * quiet)
        )
    if one.beside:
        direction = ca.if_else(moves, lever * v, lever * acceleration)
        across = ca.if_else(moves, other, change)
        sigma = direction / ca.fmax(ca.sqrt(direction * direction + across * across), _NOTHING)
        rest = ca.if_else(moves, 0, ca.logic_not(reverses))
    else:
        direction = ca.if_else(moves, v, ca.if_else(reverses, acceleration, 0))
        sigma, rest = ca.sign(direction), ca.logic_not(direction)
    if sign is not None:
        return ca.if_else(rest, sign, sigma), rest, False
    # No number at rest: zero over zero, which of what never moves would be read as zero.
    sigma = ca.sqrt(1 - 2 * rest) - 1 if ca.SX(sigma).is_zero() else sigma / (1 - rest)
    return sigma, rest, ca.SX(rest).is_one()


def _bend(law: _Law, laws: Sequence[_Law]) -> Expression:
    """Largest change of slope of a law by sliding friction, or by those at rest; None if there is
    none.

    Its force is then no straight line in theirs, and need not be largest where they are at their
    limits.
    """
    measured = [
        other.rest * (law.mu * size)
        for k, other in enumerate(laws)
        if other is not law and other.rest is not None
        for part in law.pressed
        if (size := part.dependence(k)) is not None
    ]
    sliding = ca.fabs(law.sigma) * (1 if law.rest is None else 1 - law.rest)
    return sliding * sum(measured, ca.SX(0)) if measured else None


def _solve_block(
    laws: Sequence[_Law], block: Sequence[int], values: list[Expression]
) -> dict[Column, Expression]:
    """Put the values of frictions that depend on each other into ``values``; and the checks of
    them.
    """
    known = list(values)
    for j, law in zip(block, laws, strict=True):
        values[j] = law.pushed(known)
    if not any(law.depends(k) for law in laws for k in block):
        return {}
    found = list(values)
    for _ in range(STEPS):
        rows = [law.straight(found, known) for law in laws]
        matrix = [
            [slopes[k] if k != j else 1 if slopes[k] is None else 1 + slopes[k] for k in block]
            for j, (_, slopes) in zip(block, rows, strict=True)
        ]
        for j, value in zip(
            block, _eliminated(matrix, [start for start, _ in rows])[0], strict=True
        ):
            found[j] = value
    missed, size = ca.SX(0), ca.SX(_NOTHING)
    for j, law in zip(block, laws, strict=True):
        push = law.pushed(found)
        missed, size = missed + ca.fabs(found[j] - push), size + ca.fabs(push)
        values[j] = push
    name = ", ".join(law.name for law in laws)
    return {Check("jam", name): _least_pivot(laws, block), Check("slip", name): missed / size}


def _doubted(
    laws: Sequence[_Law], values: Sequence[Expression], indeterminate_slopes: Expression
) -> list[Expression]:
    """Values with what they change at most where what presses on them changes by
    ``indeterminate_slopes``, row by row.
    """
    rows = iter(ca.vertsplit(indeterminate_slopes))
    local = [
        law.mu
        * sum((part.contact.arm * next(rows) for part in law.pressed for _ in part.free), ca.SX(0))
        for law in laws
    ]
    changes = local
    for _ in laws:
        changes = [
            start
            + sum(
                (
                    law.mu * measured * changes[k]
                    for part in law.pressed
                    for k in range(len(laws))
                    if (measured := part.dependence(k)) is not None
                ),
                ca.SX(0),
            )
            for law, start in zip(laws, local, strict=True)
        ]
    return [value + change for value, change in zip(values, changes, strict=True)]


def _least_pivot(laws: Sequence[_Law], block: Sequence[int]) -> Expression:
    """The least pivot of I - B: positive where there is one solution."""
    matrix: list[list[Any]] = []
    for j, law in zip(block, laws, strict=True):
        row: list[Any] = []
        for k in block:
            sizes = [size for part in law.pressed if (size := part.dependence(k)) is not None]
            entry = None if not sizes else -law.mu * sum(sizes[1:], sizes[0])
            row.append(entry if j != k else 1 if entry is None else 1 + entry)
        matrix.append(row)
    pivots = _eliminated(matrix, [ca.SX(0)] * len(matrix))[1]
    least = ca.SX(pivots[0])
    for pivot in pivots[1:]:
        least = ca.fmin(least, pivot)
    return least


def _eliminated(
    matrix: list[list[Expression]], right: list[Expression]
) -> tuple[list[Expression], list[Expression]]:
    """The solution of a system by elimination without exchange of rows, and its pivots; None stands
    for zero.
    """
    n, rows, right = len(right), [list(row) for row in matrix], list(right)
    for i in range(n):
        for j in range(i + 1, n):
            if rows[j][i] is None:
                continue
            factor = rows[j][i] / rows[i][i]
            for k in range(i + 1, n):
                if rows[i][k] is not None:
                    rows[j][k] = (0 if rows[j][k] is None else rows[j][k]) - factor * rows[i][k]
            right[j] = right[j] - factor * right[i]
    found: list[Any] = [None] * n
    for i in reversed(range(n)):
        rest = right[i]
        for k in range(i + 1, n):
            if rows[i][k] is not None:
                rest = rest - rows[i][k] * found[k]
        found[i] = rest / rows[i][i]
    return found, [rows[i][i] for i in range(n)]


def _blocks(laws: Sequence[_Law]) -> list[list[int]]:
    """Frictions that depend on each other, those first that depend on no others."""
    n = len(laws)
    reached = np.array(
        [[j == k or law.depends(k) for k in range(n)] for j, law in enumerate(laws)], bool
    ).reshape(n, n)
    for k in range(n):
        reached |= np.outer(reached[:, k], reached[k])
    found = {
        tuple(np.flatnonzero(reached[j] & reached[:, j]).tolist()): int(reached[j].sum())
        for j in range(n)
    }
    return [list(block) for block in sorted(found, key=lambda block: (found[block], block))]


def needed(
    forces: ca.SX, found: Mapping[str, FrictionContact], wanted: Collection[str]
) -> list[str]:
    """The frictions on which forces depend, or which are ``wanted``, and those on which these
    depend.
    """
    names = [
        name
        for name, one in found.items()
        if name in wanted or ca.depends_on(forces, one.friction.symbol)
    ]
    while True:
        rows = column(
            x for name in names for contact in found[name].contacts for x in contact.pressing
        )
        more = [
            name
            for name, one in found.items()
            if name in names or ca.depends_on(rows, one.friction.symbol)
        ]
        if more == names:
            return names
        names = more


def _sum(
    row: Sequence[Expression | None], values: Sequence[Expression], start: Expression
) -> Expression:
    """A row of A times values, and R0."""
    total = None
    for slope, value in zip(row, values, strict=True):
        if slope is not None and value is not None:
            total = slope * value if total is None else total + slope * value
    return start if total is None else start + total


def _entry(matrix: Expression, row: int, k: int) -> Expression:
    entry = matrix[row, k]
    return None if not entry.nnz() or entry.is_zero() else entry
