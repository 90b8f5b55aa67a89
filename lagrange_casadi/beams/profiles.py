"""Tables of profiles, as standards and dealers have them: names and dimensions, a line each."""

from __future__ import annotations

import csv
import math
import os
import re
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path

from ..errors import DeclarationError, PathError, one_line
from .shape import Shape, dimensions_of

_HEAD = re.compile(r"\s*([A-Za-z_]\w*)\s*(?:\[\s*(\w+)\s*\])?\s*")
_UNITS = {"": 1, "m": 1, "cm": 100, "mm": 1000}
"""How many of each are a metre."""


@dataclass(frozen=True)
class Profile:
    """A profile: its name, and dimensions [m] by name."""

    name: str
    dimensions: dict[str, float]

    def shape(self, kind: str) -> Shape:
        """The cross-section of a kind that has these dimensions. Raises :class:`.DeclarationError` where it has others."""
        names = dimensions_of(kind)
        if names is None or set(names) != set(self.dimensions):
            told = ", ".join(names or ("none by name",))
            raise DeclarationError(f"profile '{self.name}': a {kind} has the dimensions {told}, got {', '.join(self.dimensions)}")
        return Shape(kind, {name: self.dimensions[name] for name in names})


def read_profiles(path: str | os.PathLike[str]) -> tuple[Profile, ...]:
    """Profiles of a CSV file: a column ``name``, and one for each dimension, in metres or with a unit as ``height [mm]``.

    Raises :class:`.PathError` where there is no such file, and :class:`.DeclarationError` that names the line which is wrong.
    """
    try:
        with Path(path).open(newline="", encoding="utf-8") as file:
            lines = [(number, row) for number, row in enumerate(csv.reader(file), 1) if any(cell.strip() for cell in row)]
    except OSError as error:
        raise PathError(f"cannot read {path}: {one_line(error)}") from None
    except (UnicodeDecodeError, csv.Error) as error:
        raise DeclarationError(f"{path}: no CSV: {one_line(error)}") from None
    if len(lines) < 2:
        raise DeclarationError(f"{path}: expected a head and a line for every profile")
    heads = [_head(f"{path}", head) for head in lines[0][1]]
    names = [name for name, _ in heads]
    if names.count("name") != 1 or len(set(names)) < len(names) or len(names) < 2:
        raise DeclarationError(f"{path}: expected a column 'name' and one for each dimension, got {', '.join(names)}")
    found: dict[str, Profile] = {}
    for number, row in lines[1:]:
        place = f"{path}, line {number}"
        if len(row) != len(names):
            raise DeclarationError(f"{place}: {len(row)} cells, expected {len(names)}")
        cells = dict(zip(names, row, strict=True))
        name = cells.pop("name").strip()
        if not name.isprintable() or not name or name in found:
            raise DeclarationError(f"{place}: " + (f"profile '{name}' comes twice" if name in found else "it has no name"))
        found[name] = Profile(name, {key: _size(f"{place}: {key}", text, dict(heads)[key]) for key, text in cells.items()})
    return tuple(found.values())


def _head(place: str, text: str) -> tuple[str, int]:
    """The name of a column, and how many of its unit are a metre."""
    match = _HEAD.fullmatch(text.removeprefix("\ufeff"))
    name, unit = (match.group(1), match.group(2) or "") if match else ("", "")
    if not name or unit not in _UNITS:
        raise DeclarationError(f"{place}: column '{text}': expected a name, and m, cm or mm as its unit, as in height [mm]")
    return name, _UNITS[unit]


def _size(place: str, text: str, unit: int) -> float:
    try:
        value = float(Decimal(text.strip()) / unit)
    except (ArithmeticError, ValueError):
        value = math.nan
    if not 0.0 < value < math.inf:
        raise DeclarationError(f"{place}: expected a positive number, got '{text.strip()}'")
    return value
