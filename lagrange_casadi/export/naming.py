"""Names of a mechanism as names in C: no keyword of C or C++, no macro of their libraries, and no two alike."""

from __future__ import annotations

import re
from collections.abc import Mapping

_KEYWORDS = frozenset(
    """
    alignas alignof and and_eq asm auto bitand bitor bool break case catch char char8_t char16_t char32_t class compl concept const
    consteval constexpr constinit const_cast continue co_await co_return co_yield decltype default delete do double dynamic_cast
    else enum explicit export extern false float for friend goto if inline int long mutable namespace new noexcept not not_eq
    nullptr operator or or_eq private protected public register reinterpret_cast requires restrict return short signed sizeof static
    static_assert static_cast struct switch template this thread_local throw true try typedef typeid typename typeof union unsigned
    using virtual void volatile wchar_t while xor xor_eq linux unix near far huge interrupt
    I NAN INFINITY HUGE_VAL NULL EOF BUFSIZ DOMAIN SING OVERFLOW UNDERFLOW PLOSS TLOSS errno signal assert math_errhandling
    isfinite isinf isnan isnormal signbit fpclassify min max
    """.split()  # noqa: SIM905
)
_FILES = frozenset(
    """
    all build clean edit_cache example fmu help install list_install_components make mex package package_source rebuild_cache
    selftest test c dl m pthread rt
    assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdarg stdbool stddef stdint stdio
    stdlib string tgmath time wchar wctype algorithm array cmath cstdio vector
    """.split()  # noqa: SIM905
)
"""What CMake, the C library or the folder itself already calls a target, a header or a file."""


def prefix(name: str) -> str:
    """What all files, symbols and targets of a mechanism begin with: its name, with underscores for what C does not allow."""
    word = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_") or "mechanism"
    word = word if word[0].isalpha() else f"mechanism_{word}"
    return f"{word}_mechanism" if word.lower() in _FILES or word in _KEYWORDS else word


def members(names: Mapping[str, str]) -> dict[str, str]:
    """Members of one struct for full names and what each is to be called, with underscores for colons.

    Where two would be alike, the later one is numbered.
    """
    found: dict[str, str] = {}
    taken: set[str] = set()
    for full, name in names.items():
        plain = re.sub(r"\W", "_", name)
        word = f"{plain}_" if plain in _KEYWORDS else plain
        number = 2
        while word in taken:
            word, number = f"{plain}_{number}", number + 1
        taken.add(word)
        found[full] = word
    return found
