"""Elements of files, which know their place: what is missing or wrong in one is a
:class:`.ModelFileError` that names it. XML is read as data: no document types, no entities.

An element marks what readers take of it, and :func:`note_unread` names what they left.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import count
from typing import TYPE_CHECKING, Any, ClassVar
from xml.parsers import expat

import numpy as np

from ...base.arrays import Array
from ...errors import ModelFileError, listed, shown
from .record import Model

if TYPE_CHECKING:
    from typing_extensions import Self

DEEPEST = 200
"""Elements in each other, and poses on each other, at most."""

_MOST = 500_000
_LONGEST = 60
"""Characters of a name in a note, at most."""

_DRAWN = ("visual", "collision", "material", "light", "scene", "gui")
"""Elements with shapes and colours, wherever they stand."""

_SWITCH = {"true": True, "1": True, "false": False, "0": False}
"""Words that switch something on or off."""


@dataclass(eq=False)
class Element:
    """An element of a model's file: its name, line, attributes, and what is in it. Its text is an
    attribute of an empty name.

    ``part`` is the name of what it belongs to. ``seen`` is whether a reader took the element,
    ``taken`` are the attributes that readers took.
    """

    form: ClassVar[str] = "<{}>"
    blank: ClassVar[tuple[str, ...]] = ("",)

    model: Model
    name: str
    line: int
    given: dict[str, Any] = field(default_factory=dict)
    inside: list[Self] = field(default_factory=list)
    part: str = ""
    seen: bool = False
    taken: set[str] = field(default_factory=set)

    @property
    def where(self) -> str:
        """Line and start of the element, for messages."""
        named = f" name={shown(self.given['name'])}" if "name" in self.given else ""
        return f"line {self.line}, {self.form.format(self.name[:40] + named)}"

    def at(self, _name: str) -> str:
        """Return the place of an attribute, for messages."""
        return self.where

    def all(self, *names: str) -> Iterator[Self]:
        """Yield the elements in it of these names, and mark them."""
        for one in self.inside:
            if one.name in names:
                one.seen = True
                yield one

    def first(self, *names: str) -> Self | None:
        """Return the first element in it of these names."""
        return next(self.all(*names), None)

    def optional(self, name: str) -> Self:
        """Return the first element in it of a name, an empty one if there is none."""
        return self.first(name) or type(self)(self.model, name, self.line, part=self.part)

    def refuse(self, words: str) -> ModelFileError:
        """Return the error of this element."""
        return self.model.refuse(self.where, words)

    def known(self, what: str, stated: str, valid: Collection[str]) -> str:
        """Return a name in this element, which must be one of the valid ones."""
        return self.model.known(self.where, what, stated, valid)

    def ignore(self) -> None:
        """Note that the element is not read."""
        self.model.notes.append(f"{self.form.format(self.name)} of line {self.line} is ignored.")

    def needed(self, *names: str) -> Self:
        """Return the first element in it of these names, of which there must be one."""
        if (found := self.first(*names)) is None:
            raise self.refuse(f"lacks {self.form.format(names[0])}")
        return found

    def attribute(self, name: str) -> str:
        """Return an attribute, which there must be."""
        return str(self.stated(name, None))

    def stated(self, name: str, usual: object) -> object:
        """Return what an attribute gives; ``usual`` if it is blank or missing, unless that is
        None.
        """
        self.taken.add(name)
        if usual is None and name not in self.given:
            raise self.refuse(f"lacks {name}=")
        found = self.given.get(name, usual)
        return usual if usual is not None and str(found).strip() in self.blank else found

    @property
    def text(self) -> str:
        """The text in it, without blanks at its ends."""
        return str(self.stated("", ""))

    def usual(self, name: str, value: object) -> None:
        """Keep for a note that a number is not given, and is what the format says."""
        self.model.usual.setdefault(f"{name} {value}", {})[self.part or f"line {self.line}"] = None

    def amount(self, name: str, usual: float | None = None, what: str = "") -> float:
        """Return the number in an attribute; ``usual`` if there is no such attribute."""
        given = self.stated(name, usual)
        if usual and given is usual:
            self.usual(what or name, f"{usual:g}")
        return self.model.number(self.at(name), given, what or name)

    def numbers(self, name: str, usual: object = None, what: str = "", count: int = 3) -> Array:
        """Return so many numbers in an attribute; ``usual`` if there is no such attribute."""
        return self.model.numbers(self.at(name), self.stated(name, usual), what or name, count)

    def direction(self, name: str, what: str = "") -> Array:
        """Return three numbers in an attribute that are a direction."""
        return self.model.direction(self.at(name), self.numbers(name, what=what))

    def choice(self, name: str, valid: Mapping[str, str]) -> str:
        """Return what a word in an attribute means."""
        return valid[self.known(name, self.attribute(name), valid)]

    def inner(self, name: str, usual: float = 0.0) -> float:
        """Return the number that is the text of an element in it; ``usual`` if that is blank or
        missing.
        """
        return self.optional(name).amount("", usual, name)

    def switch(self, name: str, usual: bool) -> bool:
        """Return what an attribute or an element in it switches on or off."""
        data = self.stated(name, "") if name in self.given else self.optional(name).text
        return _SWITCH[self.known(name, str(data).lower(), _SWITCH)] if data else usual

    def leave(self, name: str) -> None:
        """Unmark an attribute or an element in it, which was looked at but not read."""
        self.taken.discard(name)
        for one in self.all(name):
            one.seen = False

    def left(self, path: str = "") -> Iterator[tuple[str, str, str]]:
        """Yield what no reader took of it: the path where it stands, its name, and its part."""
        for key in self.given:
            if key not in (*self.taken, "name") and not key.startswith("xmlns"):
                yield path, f"{key}=" if key else "text", self.part
        for one in self.inside:
            if one.seen:
                yield from one.left(f"{path}/{one.name}".lstrip("/"))
            else:
                yield path, one.name, one.part or f"line {one.line}"

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


def note_unread(model: Model, root: Element) -> None:
    """Note what no reader took of a file, a line for each kind of place and one for shapes; and
    what is as the format says because the file does not.
    """
    groups: dict[str, dict[str, dict[str, None]]] = {}
    for path, name, part in root.left():
        of = ", shapes and colours" if name in _DRAWN else f" of {path}" if path else ""
        groups.setdefault(of, {}).setdefault(name[:_LONGEST], {})[part[:_LONGEST]] = None
    for of, names in groups.items():
        parts = dict.fromkeys(part for each in names.values() for part in each)
        model.notes.append(f"Not read{of}: {', '.join(names)} ({listed(parts)}).")
    for lacking in {tuple(each): None for each in model.usual.values()}:
        words = ", ".join(word for word, each in model.usual.items() if tuple(each) == lacking)
        model.notes.append(f"Not given, so as the format says: {words} ({listed(lacking)}).")


def parsed(model: Model, text: str, root: str) -> Element:
    """Return the root element of a text; with an empty name, any root element.

    Raises :class:`.ModelFileError`.
    """
    # The text is decoded, whatever encoding it states.
    parser, number = expat.ParserCreate("utf-8"), count(1)
    stack = [(Element(model, "", 0), list[str]())]  # with the pieces of their texts

    def start(name: str, given: dict[str, str]) -> None:
        part = given.get("name") or given.get("reference") or stack[-1][0].part
        one = Element(model, name, parser.CurrentLineNumber, given, part=part)
        if len(stack) > DEEPEST or next(number) > _MOST:
            raise one.refuse("too deep, or too many elements")
        stack[-1][0].inside.append(one)
        stack.append((one, []))

    def end(_: str) -> None:
        one, pieces = stack.pop()
        if data := "".join(pieces).strip():
            one.given[""] = data

    def refuse(*_: object) -> None:
        raise model.refuse(
            f"line {parser.CurrentLineNumber}",
            "document types and entities are refused: a model is data",
        )

    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.CharacterDataHandler = lambda data: stack[-1][1].append(data)
    parser.StartDoctypeDeclHandler = parser.EntityDeclHandler = refuse
    parser.buffer_text = True
    try:
        parser.Parse(text.encode(), True)
    except expat.ExpatError as error:
        raise model.refuse(f"line {error.lineno}", f"no XML: {error}") from None
    found = stack[0][0].inside[0]
    if root and found.name != root:
        raise found.refuse(f"expected <{root}>")
    return found
