"""Texts filled into templates, and how they are laid out."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable
from importlib import resources
from string import Template

WIDTH = 128


def template(file: str, /, **words: object) -> str:
    """A template of this package, filled in."""
    text = (resources.files(__package__) / "templates" / file).read_text()
    return Template(text).substitute({key: str(word) for key, word in words.items()})


def member(p: str, name: str, comment: str) -> str:
    """A member of a struct of numbers."""
    return f"  {p}_real {name}; /* {comment} */"


def indented(lines: Iterable[str]) -> str:
    """Lines of a body."""
    return "\n".join(f"  {line}" for line in lines)


def wrapped(text: str, before: str = "") -> str:
    """Text within a comment."""
    lines = textwrap.wrap(re.sub(r"\*/", "* /", text), WIDTH - 3, break_long_words=False, break_on_hyphens=False)
    indented = "\n   ".join(lines)
    return f"{before}   {indented}" if before else indented
