"""Methods of evaluation, of the trade between speed and accuracy: by what, in which
precision, how exactly; how long.
"""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, get_args

from ...base.arguments import public
from ...base.brief import Brief
from ...base.vocabulary import Backend, Precision
from ...errors import DeclarationError, check_kind, check_known

if TYPE_CHECKING:
    from ..program import Program

FEWEST_NODES = 8
"""Nodes of a table: so many coefficients at least that no weight falls twice on one."""
MOST_STEPS = 1000
"""Each step squares what a loop still misses: after some ten nothing changes."""


@public
@dataclass(frozen=True, repr=False)
class Provenance(Brief):
    """Origin of the numbers.

    Holds no clock, no user and no path; ``method`` are the options of the
    :class:`.EvaluationMethod`.
    """

    backend: str
    precision: str
    compiler: str
    flags: str
    method: str
    versions: Mapping[str, str]


@dataclass(frozen=True)
class EvaluationMethod:
    """A method of evaluation: one choice of each.

    Parameters
    ----------
    backend
        Evaluate with SIMD in C++ (lanes), with C, or with CasADi's virtual machine (vm).

        ``lanes`` evaluates several instants at once, each in a lane of the vector registers, ``c``
        and ``vm`` one instant at a time. ``auto`` takes the first of them that there is a compiler
        for, and warns where there is none.
    precision
        Compute in double or in single precision.

        In ``single`` no operation is on doubles. Phases are kept in pairs of numbers, so that many
        turns cost no digits.
    newton
        Close iterated loops by this number of Newton steps from the instant before; default: until
        they close.

        At most 1000; at the first instant loops are closed.
    table
        Interpolate outputs in a table over one turn, with this number of nodes or this accuracy.

        Nodes are a whole number, an accuracy is below 1; the turn is that of the one drive.
    flags
        Pass these further flags to the compiler, as one word.

        They come after the package's own.

    Raises :class:`DeclarationError` for what does not go together.
    """

    backend: Backend = "auto"
    precision: Precision = "double"
    newton: int | None = None
    table: float | None = None
    flags: str = ""

    def __post_init__(self) -> None:
        for kind, name, valid in (
            ("backend", self.backend, get_args(Backend)),
            ("precision", self.precision, get_args(Precision)),
        ):
            check_known(kind, [str(name)], valid)
        if self.newton is not None and (
            type(self.newton) is not int or not 1 <= self.newton <= MOST_STEPS
        ):
            raise DeclarationError(
                f"newton: expected a number of steps, from 1 to {MOST_STEPS} (after some ten"
                f" nothing changes), got {self.newton!r}"
            )
        if self.table is not None and not _tabulates(self.table):
            raise DeclarationError(
                f"table: expected a number of nodes, at least {FEWEST_NODES}, or an accuracy"
                f" between 0 and 1, got {self.table!r}"
            )
        check_kind("flags", self.flags, "options of a compiler", str)
        try:
            words = shlex.split(self.flags) if self.flags else []
            if "\0" in self.flags:
                raise ValueError("they hold a null character")
        except ValueError as error:
            raise DeclarationError(
                f"flags: expected options of a compiler, got {self.flags!r}: {error}"
            ) from None
        if self.newton is not None and self.table is not None:
            raise DeclarationError(
                "newton and table exclude each other: a table is read, no loop is closed"
            )
        if self.backend == "vm" and self.precision == "single":
            raise DeclarationError(
                "backend 'vm' computes in doubles only; precision 'single' needs lanes or c"
            )
        if self.backend == "vm" and words:
            raise DeclarationError(
                f"backend 'vm' compiles nothing; flags '{self.flags}' need lanes or c"
            )

    def check(self, program: Program) -> None:
        """Raise :class:`DeclarationError` where a graph has nothing that the method chooses."""
        if self.newton is not None and program.newton is None:
            raise DeclarationError(
                f"newton: no loop of '{program.data.name}' is iterated; leave newton out: closed"
                " forms are exact and faster"
            )

    @property
    def options(self) -> str:
        """The method as options of the command line, as a shell takes them: only what differs from
        the default.
        """
        words = [
            f"--{name} {shlex.quote(str(value))}"
            for name, value in vars(self).items()
            if value != getattr(type(self), name)
        ]
        return " ".join(words) or "(default)"


def _tabulates(table: object) -> bool:
    if type(table) is int:
        return table >= FEWEST_NODES
    return type(table) is float and 0.0 < table < 1.0


_RATE, _RATE_INTERPRETED = 3e9, 3e6
"""Instructions a second of a core.

Time is counted before it begins, not measured, so that it is the same everywhere.
"""


def seconds(program: Program, instants: float, method: EvaluationMethod) -> float:
    """Seconds that a core takes for so many instants, within a factor of three or so."""
    counts = program.instructions
    steps = counts.get("loops", 0) * ((method.newton or 1) - 1)
    return (
        (sum(counts.values()) + steps)
        * instants
        / (_RATE_INTERPRETED if method.backend == "vm" else _RATE)
    )
