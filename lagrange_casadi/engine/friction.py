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

import itertools
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca

from ..base.arrays import Expression, Operand
from ..base.quantities import Check, Column
from ..base.scalars import column
from ..base.vectors import nil
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
    contacts = [contact for one in found for contact in one.contacts]
    pressing = column(x for contact in contacts for x in contact.pressing)
    all_symbols = ca.vertcat(symbols, indeterminate)
    rows = (
        ca.substitute(pressing, all_symbols, ca.SX.zeros(all_symbols.numel())),
        ca.jacobian(pressing, symbols),
        ca.fabs(ca.jacobian(pressing, indeterminate)) @ indeterminate,
    )
    ends = [0, *itertools.accumulate(len(contact.pressing) for contact in contacts)]
    parts = map(_Pressed, contacts, *(ca.vertsplit(of, ends) for of in rows))
    laws = [
        _Law.of(
            one,
            [next(parts) for _ in one.contacts],
            None if signs is None else signs.get(one.friction.name),
        )
        for one in found
    ]
    values = ca.SX.zeros(len(found))
    checks: dict[Column, Any] = {
        Check("rest", law.name): law.rest for law in laws if law.rest is not None
    }
    for block in _blocks(laws):
        checks |= _solve_block([laws[j] for j in block], block, values)
    if signs is not None:
        checks |= {
            Check("bend", law.name): bend for law in laws if (bend := _bend(law, laws)) is not None
        }
    values = _doubted(laws, values)
    forces = {one.friction.name: values[j] for j, one in enumerate(found)}
    lost = {one.friction.name: -values[j] * one.rate for j, one in enumerate(found)}
    return Solved(symbols, values, checks, forces, lost)


@dataclass(frozen=True, eq=False)
class _Pressed:
    """A contact as R0 + A s: ``free`` is R0, ``slopes`` is A, and ``doubted`` how much R may change
    with what equilibrium leaves open.
    """

    contact: Contact
    free: ca.SX
    slopes: ca.SX
    doubted: ca.SX

    def at(self, values: ca.SX) -> ca.SX:
        """R for values of all frictions."""
        pressing: ca.SX = self.free + self.slopes @ values
        return pressing

    def dependence(self, k: int) -> Expression:
        """Largest dependence on a friction."""
        most = self.contact.arm + ca.fabs(self.contact.lean)
        slopes = [slope for slope in ca.vertsplit(self.slopes[:, k]) if not nil(slope)]
        return most * self.contact.size(slopes) if slopes else ca.SX(0)

    def push(self, pressing: ca.SX, sigma: Expression) -> Expression:
        """The couple or force of a unit of mu where so much presses."""
        size = self.contact.arm * self.contact.size(ca.vertsplit(pressing))
        return size + sigma * (self.contact.lean * pressing[0])

    def weights(self, pressing: ca.SX, sigma: Expression, unit: Expression) -> Expression:
        """Derivatives of ``unit`` times the normal force by each component, a row; its product with
        the components is that force.
        """
        if pressing.numel() == 1:
            return unit * (self.contact.arm * ca.sign(pressing) + sigma * self.contact.lean)
        share, components = unit * self.contact.arm, ca.vertsplit(pressing)
        if self.contact.edges:
            one, other = (ca.sign(edge) for edge in both_edges(components))
            return share / 2 * ca.horzcat(one + other, one - other)
        return share / ca.fmax(self.contact.size(components), _NOTHING) * pressing.T


@dataclass(frozen=True, eq=False)
class _Law:
    """s = -sigma mu sum arm |R(s)| - steady; ``still`` says that it is open at all instants."""

    name: str
    pressed: list[_Pressed]
    mu: Any
    sigma: Any
    rest: Any
    still: bool = False
    steady: Any = 0.0

    @classmethod
    def of(cls, one: FrictionContact, pressed: list[_Pressed], sign: Expression = None) -> _Law:
        friction, v = one.friction, one.rate
        if isinstance(friction, Transmission):
            return cls(friction.name, pressed, 1.0, -1.0, None)
        if isinstance(friction, Loss):
            return cls(friction.name, pressed, 1.0, *_way(one, sign))
        steady = friction.viscous * v
        if not pressed:
            return cls(friction.name, [], 0.0, 0.0, None, steady=steady)
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
            sigma = ca.tanh(v / friction.smooth)
            return cls(friction.name, pressed, mu, sigma, None, steady=steady)
        return cls(friction.name, pressed, mu, *_way(one, sign, lever), steady=steady)

    def pushed(self, values: ca.SX) -> Expression:
        """The force for values of all frictions."""
        pushes = (part.push(part.at(values), self.sigma) for part in self.pressed)
        return -self.sigma * (self.mu * sum(pushes, ca.SX(0))) - self.steady

    def straight(self, values: ca.SX, known: ca.SX) -> tuple[Expression, ca.SX]:
        """The force as ``start - slopes s``, beside what is ``known``, if all that presses kept its
        direction at ``values``.
        """
        start, slopes = -self.steady, ca.SX(1, values.numel())
        for part in self.pressed:
            weights = part.weights(part.at(values), self.sigma, self.sigma * self.mu)
            start, slopes = start - weights @ part.at(known), slopes + weights @ part.slopes
        return start, slopes

    def dependence(self, k: int) -> Expression:
        """Largest dependence on a friction, without mu."""
        return sum((part.dependence(k) for part in self.pressed), ca.SX(0))

    def depends(self, k: int) -> bool:
        """Return whether it depends on a friction: never if the joint does not move at all, for
        then the friction is indeterminate.
        """
        return not self.still and not all(part.slopes[:, k].is_zero() for part in self.pressed)


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
        other.rest * (law.mu * law.dependence(k))
        for k, other in enumerate(laws)
        if other is not law and other.rest is not None and not nil(law.dependence(k))
    ]
    sliding = ca.fabs(law.sigma) * (1 if law.rest is None else 1 - law.rest)
    return sliding * sum(measured, ca.SX(0)) if measured else None


def _solve_block(
    laws: Sequence[_Law], block: Sequence[int], values: ca.SX
) -> dict[Column, Expression]:
    """Put the values of frictions that depend on each other into ``values``, where those to come
    are zero; and the checks of them.
    """
    known = ca.SX(values)
    for j, law in zip(block, laws, strict=True):
        values[j] = law.pushed(known)
    if not any(law.depends(k) for law in laws for k in block):
        return {}
    found = ca.SX(values)
    for _ in range(STEPS):
        starts, slopes = zip(*(law.straight(found, known) for law in laws), strict=True)
        matrix = ca.SX.eye(len(laws)) + ca.vertcat(*slopes)[:, block]
        found[block] = _eliminated(matrix, column(starts))[0]
    missed, size = ca.SX(0), ca.SX(_NOTHING)
    for j, law in zip(block, laws, strict=True):
        values[j] = push = law.pushed(found)
        missed, size = missed + ca.fabs(found[j] - push), size + ca.fabs(push)
    name = ", ".join(law.name for law in laws)
    # The least pivot of I - B is positive where there is one solution.
    taken = ca.vertcat(*(-law.mu * ca.horzcat(*map(law.dependence, block)) for law in laws))
    _, pivots = _eliminated(ca.SX.eye(len(laws)) + taken, ca.SX.zeros(len(laws)))
    return {Check("jam", name): ca.mmin(pivots), Check("slip", name): missed / size}


def _doubted(laws: Sequence[_Law], values: ca.SX) -> ca.SX:
    """Values with what they change at most with what equilibrium leaves open."""
    local = column(
        law.mu * sum((part.contact.arm * ca.sum1(part.doubted) for part in law.pressed), ca.SX(0))
        for law in laws
    )
    if local.is_zero():
        return values
    changes, numbers = local, range(len(laws))
    leaning = ca.vertcat(*(law.mu * ca.horzcat(*map(law.dependence, numbers)) for law in laws))
    for _ in laws:
        changes = local + leaning @ changes
    return values + changes


def _eliminated(matrix: ca.SX, right: ca.SX) -> tuple[ca.SX, ca.SX]:
    """The solution of a system by elimination without exchange of rows, and its pivots."""
    rows, n = ca.densify(ca.horzcat(matrix, right)), right.numel()
    for i in range(n):
        for j in range(i + 1, n):
            rows[j, i + 1 :] -= rows[j, i] / rows[i, i] * rows[i, i + 1 :]
    return ca.solve(ca.triu(rows[:, :n]), rows[:, n]), ca.diag(rows[:, :n])


def _blocks(laws: Sequence[_Law]) -> list[list[int]]:
    """Frictions that depend on each other, those first that depend on no others."""
    n = len(laws)
    entries = [(j, k) for j, law in enumerate(laws) for k in range(n) if j == k or law.depends(k)]
    rows, columns = [j for j, _ in entries], [k for _, k in entries]
    count, order, cuts = ca.Sparsity.triplet(n, n, rows, columns).scc()
    return [sorted(order[cuts[i] : cuts[i + 1]]) for i in reversed(range(count))]


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
