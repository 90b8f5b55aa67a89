"""Functions of a scene, as CasADi functions that hold nothing else; and their text, to be kept."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeAlias

import casadi as ca
import numpy as np

from ..base.arrays import Array, Expression
from ..base.quantities import Check, Column, Output
from ..base.scalars import called, graph, inputs_of
from ..base.symbolic import Graphs, symbolic, symbolic_property
from ..base.templates import Leaf, Template, dumps, loads
from ..base.vocabulary import Precision
from ..errors import PickleError, listed
from ..model.corners import Corners
from ..model.declared_parts import Parameter
from ..model.description import DESCRIBED, Description
from ..model.kinks import Smooth
from ..model.limits import FITS
from ..model.sampled_laws import Laws
from ..model.scene import Wanted
from ..model.stated import Entry, Equation, LoadLaw, Stated, Touch
from ..model.times import Timing
from ..model.validity import Margins
from .dead_centres import closing_of
from .iteration import NewtonLoop
from .least_energy import Completion
from .model_data import ModelData
from .section_function import SectionInputs
from .verdicts import Bound, Broken, Tolerances, bounds_of, rules_of, status_of

Turns: TypeAlias = tuple[tuple[int, int], ...]
"""Numbers of parts of an angle, and the sign of each."""


@dataclass(frozen=True, eq=False, repr=False)
class Program(Graphs):
    """A compiled scene: CasADi functions and plain data, with no reference to its declaration, so
    that it can be sent to other processes and stored as text.

    ``motion(t, p) -> (d, d_rate, d_acceleration)``; ``instant(t, d, d_rate, d_acceleration, z, p)
    -> out``, one row of ``out`` for each of ``columns``, which are outputs and checks; ``newton``
    for loops that must be iterated. ``loop_angles`` are the angles that loops determine, each as a
    sum of directions of bodies that are known modulo 2 pi, and the revolutions of joints that count
    them, which the columns leave out. ``completion`` is there if least strain energy determines
    what equilibrium does not. ``identity`` is the hash of everything that the Program follows from
    (see :func:`.identity_of`), or None if the declaration holds something without a stable content.
    """

    data: ModelData
    wanted: Wanted
    instant: ca.Function
    newton: NewtonLoop | None
    columns: tuple[Column, ...]
    loop_angles: Mapping[Output, Mapping[Column, int]]
    completion: Completion | None = None
    identity: str | None = None

    def __repr__(self) -> str:
        return (
            f"<Program of {self.data.name}: {len(self.outputs)} outputs,"
            f" {len(self.columns) - len(self.outputs)} checks; parameters:"
            f" {listed(self.data.parameters)}>"
        )

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The full names of the outputs, and names for the checks, which begin with ``_``: one a
        row of ``out``.
        """
        return tuple(map(str, self.columns))

    @cached_property
    def outputs(self) -> dict[Output, int]:
        """The outputs, and their rows of ``out``."""
        return {column: k for k, column in enumerate(self.columns) if isinstance(column, Output)}

    def described(self, p: Array, out: Array) -> Description:
        """The mechanism in plain numbers, for parameters ``p``; where axes are rounded, with what
        loops miss in its columns ``out`` (columns, t), by what closes them, if any does.
        """
        description = self.data.at(p)
        if not self.data.rounding:
            return description
        gaps = {name: float(np.max(out[row])) for name, row in self.checks("misfit").items()}
        missed = {name: gap for name, gap in gaps.items() if gap > FITS}
        return replace(description, missed=missed, rounding=self.data.rounding if missed else 0.0)

    def checks(self, kind: str) -> Mapping[str, int]:
        """The parts that have a check of a kind, and its row of ``out``."""
        return self._checks.get(kind, {})

    @cached_property
    def _checks(self) -> dict[str, dict[str, int]]:
        found: dict[str, dict[str, int]] = {}
        for k, check in enumerate(self.columns):
            if isinstance(check, Check):
                found.setdefault(check.kind, {})[str(check.part)] = k
        return found

    @cached_property
    def loop_rows(self) -> tuple[tuple[tuple[int, bool], ...], tuple[tuple[int, Turns], ...]]:
        """Rows of what ``loop_angles`` are sums of, and whether each has whole turns; and by
        the row of each angle, the numbers among these of its parts, with their signs.
        """
        rows = {column: k for k, column in enumerate(self.columns)}
        parts = dict.fromkeys(part for signs in self.loop_angles.values() for part in signs)
        numbers = {part: number for number, part in enumerate(parts)}
        return tuple((rows[part], isinstance(part, Check)) for part in parts), tuple(
            (rows[angle], tuple((numbers[part], sign) for part, sign in signs.items()))
            for angle, signs in self.loop_angles.items()
        )

    @cached_property
    def bounds(self) -> tuple[Bound, ...]:
        """The columns with a verdict (:mod:`.verdicts`), in their order."""
        iterated = self.newton.names if self.newton is not None else ()
        return bounds_of(self.columns, self.data.kinds, iterated)

    @cached_property
    def rules(self) -> tuple[Broken, ...]:
        """The rules of an instant, in the order in which they are reported."""
        return rules_of(self.bounds, iterated=self.newton is not None)

    @symbolic_property
    def status(self) -> ca.Function:
        """The function ``status(checks, limits, beside, iterated)``: the number of the first of
        :attr:`rules` that is broken.
        """
        return status_of(self.rules, len(self.bounds))

    def tolerances(
        self, precision: Precision, newton: int | None, extent: Expression
    ) -> Tolerances:
        """Tolerances of a precision, for an ``extent`` [m]; ``newton`` as in
        :class:`.EvaluationMethod`.
        """
        return Tolerances(precision, newton is not None, self.data.rounding, extent)

    def limits(
        self, precision: Precision, newton: int | None, extent: Expression
    ) -> list[Expression]:
        """Limits of :attr:`bounds`, by the same."""
        at = self.tolerances(precision, newton, extent)
        return [bound.verdict.limit(at) for bound in self.bounds]

    @symbolic_property
    def closing(self) -> ca.Function:
        """The function ``closing(t, d, d_rate, d_acceleration, z, p) -> (squares, rates, slopes)``
        of what is zero at dead centres, as ``closing_of`` returns it.
        """
        return closing_of(self.instant, self.bounds, self.newton)

    def seen_columns(self, constraint: str) -> list[int]:
        """The rows of ``out`` that have the symbols of a constraint that may have kinks."""
        return [
            k for part, k in self.checks("seen").items() if part.rpartition(":")[0] == constraint
        ]

    @property
    def laws(self) -> Laws:
        """The motions of the drives."""
        return self.data.laws

    @property
    def driven(self) -> tuple[str, ...]:
        """The coordinates whose motion is given."""
        return self.laws.joints

    @property
    def motion(self) -> ca.Function:
        """The function ``motion(t, p) -> (d, d_rate, d_acceleration)``."""
        return self.laws.motion

    @symbolic
    def extent(self, p: Array) -> float:
        """The size of the mechanism [m], beside which a gap is large or small, for parameters
        ``p``.
        """
        return float(called(self.data.extent, p[:, None])[0, 0])

    @cached_property
    def links(self) -> tuple[str, ...]:
        """The links of which a whole section law was wanted, and is there."""
        inputs = {link: SectionInputs.of(self.outputs, link) for link in self.wanted.sections}
        return tuple(
            link for link, of in inputs.items() if self.outputs.keys() >= {*of.law, *of.acting}
        )

    @cached_property
    def indeterminate(self) -> dict[Output, int]:
        """The outputs that may be indeterminate, and the columns that show at which instants."""
        checks = ((column, k) for k, column in enumerate(self.columns) if isinstance(column, Check))
        return {check.part: k for check, k in checks if isinstance(check.part, Output)}

    @symbolic
    def with_columns(self, columns: Sequence[Column], out: Expression) -> Program:
        """The Program with other columns, ``out`` as expressions of the symbols of ``instant``."""
        instant = graph("instant", inputs_of(self.instant), out=out)
        return replace(self, instant=instant, columns=tuple(columns))

    def iterates(self, closure: str) -> bool:
        """Return whether the loops of a closure are iterated."""
        return self.newton is not None and closure in self.newton.names

    @cached_property
    def instructions(self) -> dict[str, int]:
        """Instructions of each function."""
        functions = {"motion": self.motion, "instant": self.instant} | (
            {"loops": self.newton.step} if self.newton else {}
        )
        return {
            name: f.n_instructions() if f.is_a("SXFunction") else f.n_nodes()
            for name, f in functions.items()
        }

    def dumps(self) -> str:
        """Write it as text."""
        return dumps(self)

    @classmethod
    @symbolic
    def loads(cls, text: str) -> Program:
        """Read the text that :meth:`dumps` wrote."""
        found: Program = loads(text, (cls, *_PARTS))
        return found

    def __reduce__(self) -> tuple[Callable[[str], Program], tuple[str]]:
        """Send it as its text. Raises :class:`.PickleError` if the text is incomplete."""
        if self.identity is None:
            raise PickleError(
                f"the scene of '{self.data.name}' cannot be pickled: it calls a function"
                " that exists in this process only; expected expressions of CasADi's own functions"
            )
        return Program.loads, (self.dumps(),)


_PARTS = (
    *(Check, Completion, Corners, Entry, Equation, Laws, LoadLaw, Margins, ModelData, NewtonLoop),
    *(Output, Parameter, Leaf, Smooth, Stated, Template, Timing, Touch, Wanted, *DESCRIBED),
)
"""Kinds of what a program is made of."""
