"""XML as elements that know their line, read as data: no document types, no entities."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from xml.parsers import expat

import numpy as np

from ..base.arrays import Array
from ..errors import ModelFileError, shown
from .record import Model, number, numbers

_DEEPEST = 200
_MOST = 500_000


@dataclass(eq=False)
class Element:
    """An element of a model's file: its name, attributes, text, and what is in it. What is missing
    or wrong in it is a :class:`.ModelFileError`.
    """

    model: Model
    name: str
    line: int
    given: dict[str, str] = field(default_factory=dict)
    text: str = ""
    inside: list[Element] = field(default_factory=list)

    @property
    def where(self) -> str:
        """Line and start of the element, for messages."""
        named = f" name={shown(self.given['name'])}" if "name" in self.given else ""
        return f"line {self.line}, <{self.name}{named}>"

    def all(self, *names: str) -> Iterator[Element]:
        """Yield the elements in it of these names."""
        return (one for one in self.inside if one.name in names)

    def first(self, *names: str) -> Element | None:
        """Return the first element in it of these names."""
        return next(self.all(*names), None)

    def refuse(self, words: str) -> ModelFileError:
        """Return the error of this element."""
        return self.model.refuse(self.where, words)

    def needed(self, *names: str) -> Element:
        """Return the first element in it of these names, of which there must be one."""
        if (found := self.first(*names)) is None:
            raise self.refuse(f"lacks <{names[0]}>")
        return found

    def attribute(self, *names: str) -> str:
        """Return the first attribute of these names, of which there must be one."""
        for name in names:
            if name in self.given:
                return self.given[name]
        raise self.refuse(f"lacks {names[0]}=")

    def number(self, given: object, what: str) -> float:
        """Return a number of it."""
        return number(self.model, self.where, given, what)

    def amount(self, name: str, usual: float | None = None, what: str = "") -> float:
        """Return the number in an attribute; ``usual`` if there is no such attribute."""
        given: object = usual if name not in self.given else None
        return self.number(self.attribute(name) if given is None else given, what or name)

    def inner(self, name: str, usual: float) -> float:
        """Return the number that is the text of an element in it, without a name its own."""
        found = self.first(name) if name else self
        return usual if found is None else found.number(found.text.strip(), name or self.name)

    def triple(self, name: str, what: str = "", usual: str = "") -> Array:
        """Return three numbers in an attribute; ``usual`` if there is no such attribute."""
        given = self.given.get(name, usual) or self.attribute(name)
        return numbers(self.model, self.where, given, what or name, 3)

    def direction(self, given: str, what: str) -> Array:
        """Return three numbers that are not all zero."""
        found = numbers(self.model, self.where, given, what, 3)
        if not np.any(found):
            raise self.refuse("expected a direction, got zero")
        return found

    def numbers(self, given: object, what: str, count: int) -> Array:
        """Return so many numbers of it."""
        return numbers(self.model, self.where, given, what, count)

    def by_name(self, *names: str) -> dict[str, Element]:
        """Return the elements in it of these names, by their attribute name."""
        found: dict[str, Element] = {}
        for one in self.all(*names):
            if (name := one.attribute("name")) in found:
                raise one.refuse("the name is taken")
            found[name] = one
        return found


def parsed(model: Model, text: str, root: str) -> Element:
    """Return the root element of a text; with an empty name, any root element.

    Raises :class:`.ModelFileError`.
    """
    parser, stack, count = expat.ParserCreate(), [Element(model, "", 0)], 0

    def start(name: str, given: dict[str, str]) -> None:
        nonlocal count
        count += 1
        one = Element(model, name, parser.CurrentLineNumber, given)
        if len(stack) > _DEEPEST or count > _MOST:
            raise one.refuse("too deep, or too many elements")
        stack[-1].inside.append(one)
        stack.append(one)

    def end(_: str) -> None:
        stack.pop()

    def characters(data: str) -> None:
        stack[-1].text += data

    def refuse(*_: object) -> None:
        where = f"line {parser.CurrentLineNumber}"
        raise model.refuse(where, "document types and entities are refused: a model is data")

    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.CharacterDataHandler = characters
    parser.StartDoctypeDeclHandler = parser.EntityDeclHandler = refuse
    parser.buffer_text = True
    try:
        parser.Parse(text.encode(), True)
    except expat.ExpatError as error:
        raise model.refuse(f"line {error.lineno}", f"no XML: {error}") from None
    found = stack[0].inside[0]
    if root and found.name != root:
        raise found.refuse(f"expected <{root}>")
    return found
