"""Elements of files, which know their place: what is missing or wrong in one is a
:class:`.ModelFileError` that names it. XML is read as data: no document types, no entities.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar
from xml.parsers import expat

import numpy as np

from ..base.arrays import Array
from ..errors import ModelFileError, shown
from .record import Model

if TYPE_CHECKING:
    from typing_extensions import Self

_DEEPEST = 200
_MOST = 500_000


@dataclass(eq=False)
class Element:
    """An element of a model's file: its name, line, attributes, text, and what is in it."""

    form: ClassVar[str] = "<{}>"

    model: Model
    name: str
    line: int
    given: dict[str, Any] = field(default_factory=dict)
    pieces: list[str] = field(default_factory=list)
    inside: list[Self] = field(default_factory=list)

    @property
    def where(self) -> str:
        """Line and start of the element, for messages."""
        named = f" name={shown(self.given['name'])}" if "name" in self.given else ""
        return f"line {self.line}, {self.form.format(self.name[:40] + named)}"

    def at(self, _name: str) -> str:
        """Return the place of an attribute, for messages."""
        return self.where

    def all(self, *names: str) -> Iterator[Self]:
        """Yield the elements in it of these names."""
        return (one for one in self.inside if one.name in names)

    def first(self, *names: str) -> Self | None:
        """Return the first element in it of these names."""
        return next(self.all(*names), None)

    def refuse(self, words: str) -> ModelFileError:
        """Return the error of this element."""
        return self.model.refuse(self.where, words)

    def known(self, what: str, stated: str, valid: Collection[str]) -> str:
        """Return a name in this element, which must be one of the valid ones."""
        return self.model.known(self.where, what, stated, valid)

    def ignore(self) -> None:
        """Note that the element is not read."""
        words = f"{self.form.format(self.name)} of line {self.line} is ignored."
        self.model.notes.append(words)

    def needed(self, *names: str) -> Self:
        """Return the first element in it of these names, of which there must be one."""
        if (found := self.first(*names)) is None:
            raise self.refuse(f"lacks {self.form.format(names[0])}")
        return found

    def attribute(self, name: str) -> str:
        """Return an attribute, which there must be."""
        return str(self.stated(name, None))

    def stated(self, name: str, usual: object) -> object:
        """Return what an attribute gives; ``usual`` if there is none, unless that is None."""
        if usual is None and name not in self.given:
            raise self.refuse(f"lacks {name}=")
        return self.given.get(name, usual)

    @property
    def text(self) -> str:
        """The text in it, without blanks at its ends."""
        return "".join(self.pieces).strip()

    def amount(self, name: str, usual: float | None = None, what: str = "") -> float:
        """Return the number in an attribute; ``usual`` if there is no such attribute."""
        return self.model.number(self.at(name), self.stated(name, usual), what or name)

    def triple(self, name: str, usual: object = None, what: str = "") -> Array:
        """Return three numbers in an attribute; ``usual`` if there is no such attribute."""
        return self.model.numbers(self.at(name), self.stated(name, usual), what or name)

    def direction(self, name: str, what: str = "") -> Array:
        """Return three numbers in an attribute that are a direction."""
        return self.model.direction(self.at(name), self.triple(name, what=what))

    def choice(self, name: str, valid: Mapping[str, str]) -> str:
        """Return what a word in an attribute means."""
        return valid[self.known(name, self.attribute(name), valid)]

    def inner(self, name: str = "", usual: float = 0.0) -> float:
        """Return the number that is the text of an element in it, without a name its own."""
        found = self.first(name) if name else self
        if found is None:
            return usual
        return self.model.number(found.where, found.text, name or self.name)

    def numbers(self, what: str, count: int) -> Array:
        """Return so many numbers of its text."""
        return self.model.numbers(self.where, self.text, what, count)

    def by_name(self, *names: str) -> dict[str, Self]:
        """Return the elements in it of these names, by their attribute name."""
        found: dict[str, Self] = {}
        for one in self.all(*names):
            if (name := one.attribute("name")) in found:
                raise one.refuse("the name is taken")
            found[name] = one
        return found


def six_moments(stated: Callable[[str, float], float], usual: float = 0.0) -> Array:
    """Return the inertia of six moments ``ixx``, ``ixy``, ..., as URDF and SDF name them; those
    about an axis have a usual value.
    """
    return np.array(
        [[stated(f"i{min(a, b)}{max(a, b)}", usual * (a == b)) for b in "xyz"] for a in "xyz"]
    )


def parsed(model: Model, text: str, root: str) -> Element:
    """Return the root element of a text; with an empty name, any root element.

    Raises :class:`.ModelFileError`.
    """
    # The text is decoded, whatever encoding it states.
    parser, stack, count = expat.ParserCreate("utf-8"), [Element(model, "", 0)], 0

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
        stack[-1].pieces.append(data)

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
