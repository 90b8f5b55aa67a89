"""Names of a mechanism as names in C: no keyword of C or C++, no macro of their libraries, and no
two alike.
"""

from __future__ import annotations

import functools
import itertools
import re
from collections.abc import Callable, Mapping, Sequence

from .text import template

_LONGEST = 200
"""Letters of a prefix: names of files, which are longer by up to 17, may have 255."""


@functools.cache
def taken_words(kind: str) -> frozenset[str]:
    """Return the words of a kind that are taken, a section of ``reserved.txt``."""
    section = template("reserved.txt").partition(f"[{kind}]\n")[2].partition("\n[")[0]
    return frozenset(
        word for line in section.splitlines() if not line.startswith("#") for word in line.split()
    )


def reserved(word: str) -> bool:
    """Return whether a name is taken in C, C++ or the headers of their libraries."""
    return word in taken_words("languages") or word in taken_words("headers")


def prefix(name: str) -> str:
    """First part of the names of all files, symbols and targets of a mechanism: its name, with
    underscores for what C does not allow, and without what is too long for a file.
    """
    word = re.sub(r"[^A-Za-z0-9]+", "_", name)[:_LONGEST].strip("_") or "mechanism"
    word = word if word[0].isalpha() else f"mechanism_{word}"
    taken = word.lower() in taken_words("files") or word in taken_words("cmake") or reserved(word)
    return f"{word}_mechanism" if taken else word


def members(names: Mapping[str, str]) -> dict[str, str]:
    """Members of one struct for full names and what each is to be called, with underscores for
    colons.
    """
    plain = {full: re.sub(r"\W", "_", name) for full, name in names.items()}
    return distinct(plain, lambda word: f"{word}_" if reserved(word) else word)


def constants(begin: str, links: Sequence[str]) -> dict[str, str]:
    """Constants for names that may differ in capitals alone."""
    return distinct({link: f"{begin}_{link}" for link in links}, str.upper)


def distinct(
    names: Mapping[str, str],
    written: Callable[[str], str] = str,
    compared: Callable[[str], str] = str,
) -> dict[str, str]:
    """Return names as they are ``written``; where two are alike as they are ``compared``, the later
    one is numbered.
    """
    found: dict[str, str] = {}
    taken: set[str] = set()
    for key, name in names.items():
        numbered = (f"{name}_{number}" for number in itertools.count(2))
        tries = map(written, itertools.chain([name], numbered))
        found[key] = next(word for word in tries if compared(word) not in taken)
        taken.add(compared(found[key]))
    return found
