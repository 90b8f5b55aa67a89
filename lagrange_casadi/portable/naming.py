"""Names of a mechanism as names in C: no keyword of C or C++, no macro of their libraries, and no
two alike.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Mapping, Sequence
from importlib import resources


@functools.cache
def taken_words(kind: str) -> frozenset[str]:
    """Return the words of a kind that are taken, a section of ``reserved.txt``."""
    text = (resources.files(__package__) / "templates" / "reserved.txt").read_text()
    section = text.partition(f"[{kind}]\n")[2].partition("\n[")[0]
    return frozenset(
        word for line in section.splitlines() if not line.startswith("#") for word in line.split()
    )


def reserved(word: str) -> bool:
    """Return whether a name is taken in C, C++ or the headers of their libraries."""
    return word in taken_words("languages") or word in taken_words("headers")


def prefix(name: str) -> str:
    """First part of the names of all files, symbols and targets of a mechanism: its name, with
    underscores for what C does not allow.
    """
    word = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_") or "mechanism"
    word = word if word[0].isalpha() else f"mechanism_{word}"
    taken = word.lower() in taken_words("files") or word in taken_words("cmake") or reserved(word)
    return f"{word}_mechanism" if taken else word


def members(names: Mapping[str, str]) -> dict[str, str]:
    """Members of one struct for full names and what each is to be called, with underscores for
    colons.

    Where two would be alike, the later one is numbered.
    """
    found: dict[str, str] = {}
    taken: set[str] = set()
    for full, name in names.items():
        plain = re.sub(r"\W", "_", name)
        word = f"{plain}_" if reserved(plain) else plain
        number = 2
        while word in taken:
            word, number = f"{plain}_{number}", number + 1
        taken.add(word)
        found[full] = word
    return found


def constants(begin: str, links: Sequence[str]) -> dict[str, str]:
    """Constants for names that may differ in capitals alone; where two would be alike, the later
    one is numbered.
    """
    found: dict[str, str] = {}
    for link in links:
        word, number = f"{begin}_{link}".upper(), 2
        while word in found.values():
            word, number = f"{begin}_{link}_{number}".upper(), number + 1
        found[link] = word
    return found
