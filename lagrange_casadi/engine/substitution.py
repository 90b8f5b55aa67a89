"""Substitution of symbols: by expressions or numbers.

Only what an expression holds is looked at.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import casadi as ca

from ..base.arrays import Expression
from ..base.scalars import as_expression, column, entries


class Expressions:
    """Expressions by the symbols that they stand for."""

    def __init__(self) -> None:
        self._known: dict[int, tuple[Any, Any]] = {}

    def note(self, symbols: Expression, values: Expression) -> None:
        """Let expressions stand for symbols, entry by entry."""
        for symbol, value in zip(entries(symbols), entries(values), strict=True):
            self._known[symbol.element_hash()] = symbol, value

    def change(self, of: Callable[[ca.SX], ca.SX]) -> None:
        """Let another expression, made of each, stand for its symbol."""
        if self._known:
            symbols, values = (column(parts) for parts in zip(*self._known.values(), strict=True))
            self.note(symbols, of(values))

    def put_into(self, expression: ca.SX) -> ca.SX:
        """An expression with what is known in the place of its symbols."""
        expression = as_expression(expression)
        there = [
            self._known[key]
            for symbol in ca.symvar(expression)
            if (key := symbol.element_hash()) in self._known
        ]
        if not there:
            return expression
        symbols, values = zip(*there, strict=True)
        return ca.substitute(expression, ca.vertcat(*symbols), ca.vertcat(*values))


class Numbers:
    """Numbers by the symbols that they stand for."""

    def __init__(self, others: Numbers | None = None) -> None:
        self._known: dict[int, float] = {} if others is None else dict(others._known)

    def note(self, symbols: Expression, values: Sequence[float]) -> None:
        """Let numbers stand for symbols, entry by entry."""
        self._known |= {
            symbol.element_hash(): value
            for symbol, value in zip(entries(symbols), values, strict=True)
        }

    def has(self, symbols: Expression) -> bool:
        """Return whether the numbers of all symbols are known."""
        return all(symbol.element_hash() in self._known for symbol in entries(symbols))

    def of(self, expression: Expression) -> list[float]:
        """The entries of an expression all of whose symbols are known."""
        expression = as_expression(expression)
        symbols = ca.symvar(expression)
        function = ca.Function("number", [column(symbols)], [ca.densify(ca.vec(expression))])
        return [
            float(x)
            for x in function([self._known[symbol.element_hash()] for symbol in symbols])
            .full()
            .ravel()
        ]
