"""What a search for a design gives."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ..declare.density import Array
from .terms import Constraint, Term


@dataclass(frozen=True)
class Limit:
    """A constraint at the optimum: the ``value`` of its term, whether it is ``active``, and what its ``multiplier`` is.

    That is by how much the objective falls for each unit by which the limit is relaxed, in the objective's unit over the term's.
    """

    constraint: Constraint
    value: float
    active: bool
    multiplier: float


@dataclass(frozen=True, eq=False)
class Start:
    """One start of a search: values of the parameters, the design it ended at, and how.

    ``excess`` is by how much the worst constraint is violated there, over its limit; ``ending`` says why it ended.
    """

    values: Mapping[str, float]
    end: Mapping[str, float]
    objective: float
    excess: float
    ending: str


@dataclass(frozen=True, eq=False)
class Optimum:
    """The best design of a search.

    ``values`` are those of the parameters that were chosen, ``parameters`` those of all. ``objective`` is the value of
    ``minimised`` there. ``start`` is the start that led there, ``starts`` are all. ``transmission`` is the least sine of a loop's
    transmission angle, of an iterated loop the least volume; NaN without loops. ``feasible`` tells whether every constraint holds,
    that of the transmission angle too, ``converged`` whether the conditions for an optimum do. ``residual`` is what is left of
    those of Karush, Kuhn and Tucker, over the largest of their terms. ``curvature`` is the least second derivative of the
    Lagrangian along what the active constraints leave free, NaN where that is nothing or is not formed. ``bounds`` are multipliers
    of the parameters' own bounds, by name: below zero at the low one. ``history`` (k, 4 + parameters) has a row for every step:
    number of the start, objective, excess, 1 where that design has a result, and the values. ``stopped`` tells that the search was
    ended before its end, ``evaluations`` how many designs were looked at. ``unit`` is the objective's, ``notes`` what is
    worth a word.
    """

    case: str
    minimised: Term
    unit: str
    values: Mapping[str, float]
    parameters: Mapping[str, float]
    objective: float
    start: Start
    starts: tuple[Start, ...]
    limits: tuple[Limit, ...]
    bounds: Mapping[str, float]
    transmission: float
    feasible: bool
    converged: bool
    stopped: bool
    residual: float
    curvature: float
    history: Array
    evaluations: int
    notes: tuple[str, ...] = ()
