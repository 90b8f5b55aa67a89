"""Columns that are no outputs: they show if there is a result, or the certificate needs them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias, cast

from ..base.quantities import Output

Kind: TypeAlias = Literal[
    "beyond",
    "gimbal",
    "roll",
    "closure",
    "hold",
    "gap",
    "misfit",
    "row",
    "rowsize",
    "turned",
    "turns",
    "multiplier",
    "open",
    "jam",
    "slip",
    "rest",
    "bend",
    "drive",
    "seen",
    "watched",
]

FRACTIONS: tuple[Kind, ...] = ("gap", "misfit", "beyond")
"""Checks that are small or large beside one."""


@dataclass(frozen=True)
class Check:
    """A column that is no output.

    Whether there is a result, ``closure`` (see :mod:`.loops`), ``gap`` and ``misfit`` (see
    :mod:`.residuals`) of the joint or constraint that closes a loop say, ``gimbal`` of a joint how
    far its three turns are from losing one, ``roll`` of a bar how far it is from lying along the
    direction that was declared for its y axis, ``hold`` of drives whether they can make the motion
    (see :mod:`.drives`), ``row`` and ``rowsize`` of a non-holonomic row, and ``turned`` of a joint,
    how far an angle swings that is seen with its turns (see :mod:`.revolutions`), and ``beyond``
    of a load, constraint or row, how far what is put into its curves is beyond their ends (see
    :mod:`.ends`). Whether it is the only one says ``open`` of an output (see :mod:`.determinacy`),
    and of a friction whether it is at ``rest``, 1 or 0. ``jam`` says how far frictions are from
    holding each other, ``slip`` what is left of their laws, and ``bend`` how much one that slides
    changes with those at rest (see :mod:`.friction`). ``turns`` are the whole turns of a joint's
    angle that its column is without, ``multiplier`` is one that was not wanted, ``drive`` is what a
    table needs of its drive, ``seen`` what a constraint sees that may have kinks (see
    :mod:`.corners`), and ``watched`` what is watched for jumps and kinks between instants.
    """

    kind: Kind
    part: str | Output

    def __str__(self) -> str:
        """A name that no output has."""
        return f"_{self.kind}:{self.part}"

    @classmethod
    def of(cls, name: str) -> Check:
        """The check that a name says."""
        kind, _, part = name.removeprefix("_").partition(":")
        return cls(cast(Kind, kind), Output.of(part) if kind == "open" else part)


Column: TypeAlias = Output | Check


def column_of(name: str) -> Column:
    """The output or check that a name says."""
    return Check.of(name) if name.startswith("_") else Output.of(name)
