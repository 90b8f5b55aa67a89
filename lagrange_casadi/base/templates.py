"""Trees of dataclasses, mappings and sequences: their leaves replaced, their expressions made
numbers, and their one form as text.

A text names only dataclasses that its reader lists, so reading one calls nothing else.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass
from functools import cache, cached_property, partial
from operator import itemgetter
from typing import Any, Generic, TypeAlias, TypeVar, cast

import casadi as ca
import numpy as np

from .arrays import Array, Expression, Json
from .scalars import called, column
from .symbolic import Graphs, symbolic

Tree = TypeVar("Tree")
Part = TypeVar("Part")

_Numbers: TypeAlias = Sequence[Expression] | Array
_Fill: TypeAlias = Callable[[_Numbers], Any]


_Parts: TypeAlias = tuple[Collection[Any], Callable[[Iterable[object]], Any]]
"""The parts of a tree, and a function that makes a tree of its kind of other parts."""


def mapped(tree: Any, leaf: Callable[[Any], object]) -> Any:
    """Return a tree with ``leaf(value)`` for each value that has no parts."""
    of = _parts(tree)
    if of is None:
        return leaf(tree)
    parts, again = of
    return again([mapped(part, leaf) for part in parts])


def _parts(tree: Any) -> _Parts | None:
    """Return the parts of a tree, and what makes a tree of others; None of a value without."""
    kind = type(tree)
    if kind is dict:
        return tree.values(), lambda parts: dict(zip(tree, parts, strict=True))
    if kind is tuple or kind is list:
        return tree, kind
    if names := _names(tree.__class__):
        return [getattr(tree, name) for name in names], partial(_again, kind)
    return None


@cache
def _names(kind: Any) -> tuple[str, ...]:
    """Return the names of a dataclass's fields; none of another type."""
    return tuple([entry.name for entry in fields(kind)]) if is_dataclass(kind) else ()


def _again(kind: Any, parts: Iterable[object]) -> object:
    """Make a dataclass of parts that were checked when the first of the kind was made."""
    made = object.__new__(kind)
    vars(made).update(zip(_names(kind), parts, strict=True))
    return made


class Leaf(int):
    """The number of an expression of a tree among all of them."""


@dataclass(frozen=True, eq=False)
class Template(Graphs, Generic[Tree]):
    """A tree for any parameters: ``content`` has a :class:`Leaf` for each expression, and
    ``numbers(p)`` is a column of all expressions.
    """

    content: Tree
    numbers: ca.Function

    @classmethod
    @symbolic
    def of(cls, tree: Tree, symbols: ca.SX) -> Template[Tree]:
        """Make the template of a tree with expressions of the ``symbols`` of parameters."""
        found: list[ca.SX] = []

        def place(leaf: object) -> object:
            if not isinstance(leaf, ca.SX):
                return leaf
            found.append(leaf)
            return Leaf(len(found) - 1)

        content, numbers = mapped(tree, place), ca.densify(column(found))
        return cls(content, ca.Function("numbers", [symbols], [numbers], ["p"], ["numbers"]))

    def at(self, p: Sequence[float] | Array) -> Tree:
        """Return the tree of numbers for parameters ``p``."""
        numbers = called(self.numbers, np.asarray(p, float)[:, None])[:, 0]
        return self._fill(numbers.tolist())

    @cached_property
    def _fill(self) -> Callable[[_Numbers], Tree]:
        return _filling(self.content)

    def each(self, content: Part, p: Array) -> Part:
        """Return a part of the content with numbers (n,) for parameters ``p`` (n, parameters), or
        with a number for ``p`` (parameters,).
        """
        numbers = self.numbers(p.T).full()
        return _filling(content)(numbers if p.ndim > 1 else numbers.ravel().tolist())

    def placed(self, content: Part, p: Expression) -> Part:
        """Return a part of the content with expressions of parameters ``p``, and with numbers for
        constant ones.
        """
        numbers = [float(x) if x.is_constant() else x for x in ca.vertsplit(ca.SX(self.numbers(p)))]
        return _filling(content)(numbers)


def _filling(tree: Part) -> Callable[[_Numbers], Part]:
    """Return the function that makes a tree with numbers for its leaves."""
    return _filler(tree) or (lambda _: tree)


def _filler(tree: Any) -> _Fill | None:
    """Return the function that makes the tree of numbers, parts without leaves being its own; None
    of a tree without leaves.
    """
    if type(tree) is Leaf:
        return itemgetter(int(tree))
    parts, again = _parts(tree) or ((), tuple)
    fills = {k: fill for k, part in enumerate(parts) if (fill := _filler(part))}
    if not fills:
        return None
    if again is tuple and len(parts) > 1 and all(type(part) is Leaf for part in parts):
        return itemgetter(*map(int, parts))

    def filled(numbers: _Numbers) -> Any:
        own = [*parts]
        for k, fill in fills.items():
            own[k] = fill(numbers)
        return again(own)

    return filled


_READ: dict[str, Callable[[Any], object]] = {
    "tuple": tuple,
    "mapping": dict,
    "flags": lambda values: np.array(values, bool),
    "function": ca.Function.deserialize,
    "symbol": ca.SX.sym,
}
"""Readers of values that JSON does not know, by the one key that an object of JSON has here."""


def graphs(leaf: object) -> Json:
    """Write functions, symbols by their names, and arrays of bools."""
    if isinstance(leaf, ca.Function):
        return {"function": leaf.serialize()}
    if isinstance(leaf, ca.SX):
        return {"symbol": leaf.name()}
    if isinstance(leaf, np.ndarray) and leaf.dtype == bool:
        return {"flags": leaf.tolist()}
    raise TypeError(f"{type(leaf).__name__} cannot be written as text")


def dumps(tree: object, leaf: Callable[[object], Json] = graphs) -> str:
    """Write a tree; ``leaf`` writes values that are no plain data, or raises ``TypeError``."""
    return json.dumps(_plain(tree, leaf))


def loads(text: str, kinds: tuple[type[Any], ...]) -> Any:
    """Read a text of :func:`dumps`, whose dataclasses, and numbers of kinds of their own, are of
    ``kinds``.
    """
    known = {kind.__name__: kind for kind in kinds}

    def read(written: dict[str, Any]) -> object:
        ((name, content),) = written.items()
        if name not in known:
            return _READ[name](content)
        kind = known[name]
        return _again(kind, content) if is_dataclass(kind) else kind(*content)

    return json.loads(text, object_hook=read)


def _plain(tree: Any, leaf: Callable[[object], Json]) -> Json:
    kind = type(tree)
    if tree is None or kind in (bool, int) or isinstance(tree, str | float):
        return cast(Json, tree)
    if isinstance(tree, int):
        return {kind.__name__: [int(tree)]}
    if isinstance(tree, tuple | list):
        parts = [_plain(part, leaf) for part in tree]
        return parts if isinstance(tree, list) else {"tuple": parts}
    if isinstance(tree, frozenset | set):
        return {"set": sorted(tree)}
    if isinstance(tree, Mapping):
        return {"mapping": [[_plain(part, leaf) for part in item] for item in tree.items()]}
    if is_dataclass(tree) and not isinstance(tree, type):
        parts = [_plain(getattr(tree, name), leaf) for name in _names(tree.__class__)]
        return {kind.__name__: parts}
    return leaf(tree)
