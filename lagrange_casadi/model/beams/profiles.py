"""Tables of profiles, as standards and dealers have them: names and dimensions, a line each."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from pathlib import Path

from ...base.arguments import public
from ...base.csv_table import Table
from ...errors import DeclarationError
from .shape import DIMENSIONS, Shape

_TABLES = Path(__file__).parent / "tables"
STANDARD = tuple(sorted(path.stem for path in _TABLES.glob("*.csv")))
"""Names of the tables of standard profiles."""


@public
@dataclass(frozen=True)
class Profile:
    """A profile: its name, and dimensions [m] by name.

    ``table`` is the standard table that it is of, if any: its dimensions are all of its shape's.
    """

    name: str
    dimensions: dict[str, float]
    table: str = field(default="", repr=False, compare=False)

    def shape(self, kind: str) -> Shape:
        """Return the cross-section of a kind that has these dimensions.

        Parameters
        ----------
        kind : str
            Kind of shape, as ``"i_section"``.

        Returns
        -------
        Shape
            The cross-section.

        Raises
        ------
        DeclarationError
            If the kind has other dimensions.
        """
        names = DIMENSIONS.get(kind, ())
        if set(names) != set(self.dimensions):
            valid = ", ".join(names or ("none by name",))
            raise DeclarationError(
                f"profile '{self.name}': a {kind} has the dimensions {valid}, got"
                f" {', '.join(self.dimensions)}"
            )
        return Shape(kind, {name: self.dimensions[name] for name in names})


@public
def read_profiles(path: str | os.PathLike[str]) -> tuple[Profile, ...]:
    """Read a table of profiles.

    Parameters
    ----------
    path
        CSV file with a column ``name``, and one for each dimension, in metres or with a unit as
        ``height [mm]``; lines that begin with ``#`` are skipped. If there is no such file, the
        name of a standard table: IPE, HEA and HEB of EN 10365, CHS for round tubes, SHS and RHS
        for square and rectangular ones (SHS_cold and RHS_cold if cold formed), flat and round.
        Each table says in its first lines where its sizes are from.

    Returns
    -------
    tuple of Profile
        The profiles, in the order of the table.

    Raises
    ------
    PathError
        For a file that cannot be read.
    DeclarationError
        For a wrong line, which it names.
    """
    table = str(path) if str(path) in STANDARD and not Path(path).exists() else ""
    if table:
        path = _TABLES / f"{table}.csv"
    tables = f"tables: {', '.join(STANDARD)}"
    read = Table.read(path, "a head and a line for every profile", others=tables)
    names = read.names
    if names.count("name") != 1 or len(set(names)) < len(names) or len(names) < 2:
        raise DeclarationError(
            f"{read.head.where}: expected a column 'name' and one for each dimension, got"
            f" {', '.join(names)}"
        )
    dimensions = [name for name in names if name != "name"]
    if wrong := [name for name in dimensions if not name.isidentifier()]:
        raise DeclarationError(f"{read.head.where}: column '{wrong[0]}': expected a name")
    metres = dict.fromkeys(dimensions, "m")
    units = read.units_of(metres, usual=metres)
    return tuple(
        Profile(
            name, {key: row.positive(key, cells[key], unit) for key, unit in units.items()}, table
        )
        for row, name, cells in read.named("profile")
    )
