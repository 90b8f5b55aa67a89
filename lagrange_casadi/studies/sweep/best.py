"""The best designs of a sweep: least or largest in one column, or the front of two, among those
that meet conditions.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from ...base.arguments import Count, public
from ...base.arrays import Array, Operand
from ...base.numerals import real
from ...base.units import in_unit, typed
from ...errors import DeclarationError, check_kind
from .meanings import ERROR, STATUS
from .reading import Sweep, Values, names_in
from .selection import absent, near

_RELATIONS = {
    "<=": (True, True, False),
    ">=": (False, True, True),
    "!=": (True, False, True),
    "==": (False, True, False),
    "<": (True, False, False),
    ">": (False, False, True),
    "=": (False, True, False),
}
"""Truth of relations to a number for what is below the number, equal to it, and above it."""

_CONDITION = re.compile(r"\s*([^<>=!]+?)\s*(<=|>=|!=|==|<|>|=)\s*([^<>=!]+?)\s*")


@public
@dataclass(frozen=True)
class Condition:
    """A parameter or a column against a number; peaks by their size, whatever their sign.

    What differs from the number by a billionth of it is equal to it, for what is computed is
    rounded. ``unit`` is that of a text.
    """

    name: str
    relation: str
    value: float
    unit: str = ""

    @classmethod
    def parse(cls, text: str) -> Condition:
        """Read ``NAME<NUMBER``, or with ``<=``, ``>``, ``>=``, ``==`` or ``!=``; a number may have
        a unit, as ``30deg``.

        Raises :class:`DeclarationError`.
        """
        if found := _CONDITION.fullmatch(text):
            name, relation, words = found.groups()
            value, unit = typed(words)
            with suppress(ValueError):
                value = value if unit else real(words)
            if isinstance(value, float) and not math.isnan(value):
                return cls(name, relation, value, unit)
        raise DeclarationError(
            f"expected a condition like l<0.3 or peak:effort:O<=12, got '{text}'"
        )

    def holds(self, values: Array) -> npt.NDArray[np.bool_]:
        """Return where the condition holds; never where there is no number."""
        sized, (below, equal, above) = size(self.name, values), _RELATIONS[self.relation]
        apart = np.where(sized < self.value, below, above)
        return np.where(near(sized, self.value), equal, apart) & ~np.isnan(sized)


@dataclass(frozen=True)
class Design:
    """A design by its number, and values of parameters and columns by name."""

    number: int
    values: dict[str, float]


def size(name: str, values: Array) -> Array:
    """Key by which a column is compared: peaks by their size."""
    return np.abs(values) if name.startswith(("peak:", "peak_at:")) else np.asarray(values, float)


@public
def best(
    sweep: Sweep,
    *,
    minimise: str | Sequence[str] = (),
    maximise: str | Sequence[str] = (),
    where: str | Condition | Sequence[str | Condition] = (),
    count: Count | None = None,
    columns: str | Sequence[str] = (),
) -> list[Design]:
    """Return the best designs of a sweep that have a result and meet all conditions.

    With two objectives it is their front: a design is on the front where no other is at least as
    good in both and better in one. Peaks are compared by magnitude.

    Parameters
    ----------
    sweep
        The sweep.
    minimise
        Minimise this column; of two objectives, list their Pareto front.

        A name or a list of them; one or two objectives in all.
    maximise
        Maximise this column.

        A name or a list of them.
    where
        Choose only designs that satisfy this: <, <=, >, >=, == or !=, in SI units.

        Conditions on columns, as ``"peak:effort:O<12"``.
    count
        List this number of designs; default: the best one, or the whole front.
    columns
        List this column too.

        Names of columns of which each design has the value.

    Returns
    -------
    list of Design
        The designs, the best first, a front in the order of its first objective: number,
        parameters, objectives and ``columns``, sampled peaks with their errors, in the columns'
        units.

    Raises
    ------
    UnknownNameError
        For a column that the sweep does not have.
    DeclarationError
        For no objective, or more than two.
    """
    objectives = [
        *((name, 1.0) for name in names_in(minimise)),
        *((name, -1.0) for name in names_in(maximise)),
    ]
    if len(objectives) not in (1, 2):
        raise DeclarationError(
            "expected one column to minimise or maximise, or two for their front, got"
            f" {len(objectives)}"
        )
    names = tuple(dict.fromkeys(name for name, _ in objectives))
    sweep.check_columns(
        [*names, *names_in(columns), *(condition.name for condition in conditions_in(where))]
    )
    kept: npt.NDArray[np.int64] = np.zeros(0, np.int64)
    costs = np.zeros((len(objectives), 0))
    for numbers, values in chosen(sweep, (*names, STATUS), where):
        cost = np.stack([sign * size(name, values[name]) for name, sign in objectives])
        there = ~np.isnan(cost).any(axis=0) & (values[STATUS] == 0)
        kept, costs = (
            np.concatenate([kept, numbers[there]]),
            np.concatenate([costs, cost[:, there]], axis=1),
        )
        order = (
            _front(costs) if len(objectives) == 2 else np.lexsort((kept, costs[0]))[: count or 1]
        )
        kept, costs = kept[order], costs[:, order]
    shown = with_errors(sweep, [*names, *names_in(columns)])
    asked = tuple(dict.fromkeys([*sweep.parameters, *shown]))
    return [Design(number, sweep.values(number, asked)) for number in kept[:count].tolist()]


def with_errors(sweep: Sweep, names: Sequence[str]) -> list[str]:
    """Names of columns, each peak that is sampled followed by its error."""
    found: list[str] = []
    for name in names:
        kind, _, quantity = name.partition(":")
        error = f"{ERROR}:{quantity}"
        found += [name, error] if kind == "peak" and error in sweep.columns else [name]
    return found


@public
def chosen(
    sweep: Sweep,
    names: str | Sequence[str],
    where: str | Condition | Sequence[str | Condition] = (),
    along: Sequence[str] = (),
) -> Iterator[tuple[npt.NDArray[np.int64], dict[str, Values]]]:
    """The designs, or rows ``along`` axes, that meet all conditions, in blocks, as
    :meth:`.Sweep.blocks` gives them.
    """
    names, conditions = names_in(names), conditions_in(where)
    asked = list(dict.fromkeys([*names, *(condition.name for condition in conditions)]))
    conditions = [_measured(condition, sweep) for condition in conditions]

    def satisfied(
        numbers: npt.NDArray[np.int64], values: dict[str, Operand]
    ) -> tuple[npt.NDArray[np.int64], dict[str, Operand]]:
        there = np.ones(numbers.size, bool)
        for condition in conditions:
            there &= condition.holds(values[condition.name])
        return numbers[there], {name: values[name][there] for name in names}

    return (satisfied(*block) for block in sweep.blocks(asked, along))


def _measured(condition: Condition, sweep: Sweep) -> Condition:
    """A condition with its number in the unit of a sweep's column.

    Raises :class:`DeclarationError` for a text in a unit of another kind.
    """
    if not condition.unit:
        return condition
    what, unit = f"condition on {condition.name}: its number", sweep.unit(condition.name)
    read = in_unit(what, [condition.value], condition.unit, unit)
    return replace(condition, value=read[0], unit="")


def conditions_in(where: str | Condition | Sequence[str | Condition]) -> list[Condition]:
    """Conditions, of which one may stand alone.

    Raises :class:`DeclarationError` for what is none.
    """
    check_kind(
        "where", where, "a condition as 'l<0.3', or a list of them", str, Condition, list, tuple
    )
    given = [where] if isinstance(where, (str, Condition)) else where
    for one in given:
        check_kind("where", one, "a condition as 'l<0.3'", str, Condition)
    return [Condition.parse(text) if isinstance(text, str) else text for text in given]


def counts(
    sweep: Sweep, where: str | Condition | Sequence[str | Condition] = (), along: Sequence[str] = ()
) -> tuple[int, int]:
    """Number of designs, or rows ``along`` axes, that meet all conditions, and the number of these
    that have a result.
    """
    satisfied = with_result = 0
    for numbers, values in chosen(sweep, [STATUS], where, along):
        satisfied += numbers.size
        with_result += int(np.sum(values[STATUS] == 0))
    return satisfied, with_result


def missed(
    sweep: Sweep, where: str | Condition | Sequence[str | Condition], along: Sequence[str] = ()
) -> str:
    """Conditions that nothing meets because a parameter or an axis never has the value, with the
    nearest that it has.
    """
    asked = [
        c
        for c in conditions_in(where)
        if c.relation in ("==", "=") and c.name in (*sweep.parameters, *along)
    ]
    return "".join(
        f"; {absent(c.name, sweep[c.name], c.value)}"
        for c in asked
        if not near(sweep[c.name], c.value).any()
    )


def _front(costs: Array) -> npt.NDArray[np.intp]:
    """Pairs that nothing beats, by the first cost."""
    order = np.lexsort((costs[1], costs[0]))
    second = costs[1, order]
    before = np.concatenate([[np.inf], np.minimum.accumulate(second)[:-1]])
    return np.asarray(order[second < before])
