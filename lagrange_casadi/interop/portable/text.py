"""Texts filled into templates, and how they are laid out."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable
from importlib import resources
from string import Template

from ...engine.codegen.printer import literal

WIDTH = 128
double = literal("double")

_PART = re.compile(r"^\$if (not )?(\w+)\n(.*?)^\$end \2\n", re.DOTALL | re.MULTILINE)


def template(file: str, /, **words: object) -> str:
    """A template of this package, filled in.

    Its lines between ``$if WORD`` and ``$end WORD`` are left out where that word is empty or false,
    those after ``$if not WORD`` where it is not.
    """

    def kept(part: re.Match[str]) -> str:
        return _PART.sub(kept, part[3]) if bool(words[part[2]]) is not bool(part[1]) else ""

    text = _PART.sub(kept, (resources.files(__package__) / "templates" / file).read_text())
    return Template(text).substitute({key: str(word) for key, word in words.items()})


def comment(text: str) -> str:
    """A user's text within a comment of C, CMake or MATLAB: it neither ends that nor begins
    another.
    """
    for before, after in (("??/", "? ?/"), ("\\", "/"), ("*/", "* /"), ("/*", "/ *")):
        text = text.replace(before, after)
    return text


def quoted(text: str) -> str:
    """A user's text between the quotes of a string of C, byte by byte the same."""
    known = {"\\": "\\\\", '"': '\\"', "?": "\\?"}
    return "".join(
        known.get(c) or (c if c.isascii() else "".join(f"\\{byte:03o}" for byte in c.encode()))
        for c in text
    )


def octave(text: str) -> str:
    """A user's text between the quotes of a string of MATLAB and Octave."""
    return text.replace("'", "''")


def markdown(text: str) -> str:
    """A user's text in Markdown, also in a table: what would be taken for markup is shown."""
    return re.sub(r"([\\`*{}\[\]<>#|&!~$])", r"\\\1", text)


def listed(words: Iterable[str]) -> str:
    """Words in a sentence: ``a, b and c``."""
    *first, last = words
    return f"{', '.join(first)} and {last}"


def member(p: str, name: str, about: str) -> str:
    """A member of a struct of numbers."""
    return f"  {p}_real {name}; /* {comment(about)} */"


def numbers(values: Iterable[float]) -> str:
    """Doubles of C with commas between."""
    return ", ".join(double(float(value)) for value in values)


def number_rows(table: Iterable[Iterable[float]]) -> str:
    """Rows of doubles, for an array of arrays."""
    return ",\n".join(f"  {{{numbers(row)}}}" for row in table)


def indented(lines: Iterable[str]) -> str:
    """Lines of a body."""
    return textwrap.indent("\n".join(lines), "  ")


def filled(text: str) -> str:
    """Text within a comment."""
    lines = textwrap.wrap(comment(text), WIDTH - 3, break_long_words=False, break_on_hyphens=False)
    return "\n   ".join(lines)
