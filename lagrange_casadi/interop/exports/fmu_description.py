"""Model description of a unit: its variables with units, start values and limits, and their
dependencies.
"""

from __future__ import annotations

import hashlib
import itertools
import math
import uuid
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from html import escape
from typing import TYPE_CHECKING, Literal
from xml.sax.saxutils import quoteattr

import numpy as np

from ...base.quantities import Output, motion_names
from ...base.units import known
from ...engine.program import Program
from ...version import __version__
from ..portable.contract import Member
from ..portable.golden import motions_at
from ..portable.source import Source
from ..portable.text import template

if TYPE_CHECKING:
    import casadi as ca


@dataclass(frozen=True)
class Variable:
    """A variable of a unit: what it is in C, its ``kind`` to importers, the full name that outputs
    depend on, empty of an output itself, and its start value, if it has one.
    """

    member: Member
    kind: Literal["parameter", "input", "output", "independent"]
    name: str = ""
    start: float | None = None


@dataclass(frozen=True, eq=False)
class Description:
    """A unit's ``modelDescription.xml``; ``sources`` are the files to compile.

    ``by`` is empty where the motion of the drives is an input, ``time`` where the scene's motion is
    inside, or the coordinate that is an input in place of the time.
    """

    source: Source
    sources: tuple[str, ...]
    by: str = ""

    @property
    def timed(self) -> bool:
        """True if anything depends on the importer's time."""
        return self.by == "time" or (self.source.contract.timed and not self.by)

    @property
    def place(self) -> str:
        """Full name of the coordinate that is an input in place of the time, empty if none is."""
        return "" if self.by in ("", "time") else str(Output("motion", self.by))

    @cached_property
    def start(self) -> dict[str, float]:
        """Start values of inputs: the scene's motion at its first instant."""
        program = self.source.exported.program
        moved = motions_at(program, np.array(program.data.span[:1]), self.source.p)
        return {name: float(values[0]) for name, values in moved.items()}

    @cached_property
    def variables(self) -> tuple[Variable, ...]:
        """All variables; the value reference of each is its place.

        The time is the importer's, and what single precision leaves is computed.
        """
        c, start = self.source.contract, self.start
        found = [Variable(m, "parameter", f"parameter:{m.source}", m.default) for m in c.settings]
        found += [
            Variable(m, "input", m.source, start[m.source])
            for m in c.inputs
            if m.source in start and (not self.by or m.source == self.place)
        ]
        found += [Variable(m, "output") for m in c.outputs]
        if self.timed:
            name = "time" if all(m.source != "time" for m in c.settings) else "simulation/time"
            found.append(Variable(Member("", name, "s", "time"), "independent", "time"))
        return tuple(found)

    def members(self, kind: str) -> list[Member]:
        """Return the members of a kind of variables, in order."""
        return [one.member for one in self.variables if one.kind == kind]

    @cached_property
    def guid(self) -> str:
        """Identifier of the scene and of its description."""
        whole = self.source.identity + self.source.code + self.text("")
        return f"{{{uuid.UUID(hashlib.sha256(whole.encode()).hexdigest()[:32])}}}"

    @cached_property
    def known(self) -> dict[str, int]:
        """The index, from 1, of everything outputs may depend on, by its full name: parameters,
        inputs, and the time.
        """
        found = {one.name: k for k, one in enumerate(self.variables, 1) if one.name}
        if not self.by:
            return found
        inside = found["time" if self.by == "time" else self.place]
        return found | dict.fromkeys(["time", *self.start], inside)

    def text(self, guid: str) -> str:
        """Return the text of the file, with an identifier."""
        c, data = self.source.contract, self.source.exported.program.data
        (start, stop), count = data.span, data.timing.count
        span = {"startTime": start}
        if stop > start:
            span |= {"stopTime": stop, "stepSize": (stop - start) / max(1, count - 1)}
        units = dict.fromkeys(one.member.unit for one in self.variables)
        return template(
            "model_description.xml",
            **self.source.words | {"name": quoteattr(c.name)},
            guid=guid,
            files="\n".join("      " + _tag("File", name=file) for file in self.sources),
            units="\n".join(map(_unit, units)),
            span=_tag("DefaultExperiment", **span),
            variables="\n".join(map(_variable, itertools.count(), self.variables)),
            outputs="\n".join(self._unknowns(fixed=False)),
            unknowns="\n".join(self._unknowns(fixed=True)),
        )

    def _unknowns(self, *, fixed: bool) -> Iterator[str]:
        """Yield the elements of outputs with what these depend on, with parameters if these are
        ``fixed`` first.
        """
        exported = self.source.exported
        reach = None if exported.cycle is not None else reached(exported.program)
        for k, one in enumerate(self.variables, 1):
            if one.kind == "output":
                on: dict[str, object] = {}
                if reach is not None:
                    places = {
                        self.known[name]
                        for name in reach[one.member.source] & self.known.keys()
                        if fixed or not name.startswith("parameter:")
                    }
                    on["dependencies"] = " ".join(map(str, sorted(places)))
                yield "      " + _tag("Unknown", index=k, **on)


_CHANGING = {
    "parameter": {"variability": "tunable", "initial": "exact"},
    "input": {"variability": "continuous"},
    "output": {"variability": "continuous", "initial": "calculated"},
    "independent": {"variability": "continuous"},
}
"""Words of the kinds of variables, beside their causality."""


def reached(program: Program) -> dict[str, frozenset[str]]:
    """Dependencies of each column of a graph, by its structure: ``time``, ``motion:...`` and
    ``parameter:NAME``.
    """
    time, *motion, parameters = (
        [{name} for name in names]
        for names in (
            ["time"],
            *motion_names(program.driven),
            [f"parameter:{name}" for name in program.data.parameters],
        )
    )
    loops: set[str] = set()
    if program.newton is not None:
        # What closes the loops closes all of them.
        for place, names in ((1, time), (2, motion[0]), (3, parameters)):
            loops.update(*(names[column] for _, column in _entries(program.newton.step, place)))
    iterated = [loops] * program.instant.size1_in("z")
    found: list[set[str]] = [set() for _ in program.columns]
    for place, names in enumerate((time, *motion, iterated, parameters)):
        for row, column in _entries(program.instant, place):
            found[row] |= names[column]
    return {name: frozenset(names) for name, names in zip(program.names, found, strict=True)}


def _entries(function: ca.Function, place: int) -> list[tuple[int, int]]:
    """Rows and columns of what is not zero in the derivative of a function's first output by an
    input.
    """
    rows, columns = function.jac_sparsity(0, place).get_triplet()
    return list(zip(rows, columns, strict=True))


def page(description: Description) -> str:
    """Documentation of the unit: ``documentation/index.html``."""
    kinds = ("parameter", "input", "output")
    return template(
        "fmu.html",
        title=escape(description.source.contract.name),
        conventions=escape(description.source.contract.table.conventions),
        tables="".join(_table(f"{kind.title()}s", description.members(kind)) for kind in kinds),
        version=__version__,
        scene=description.source.identity,
    )


def _table(title: str, members: Sequence[Member]) -> str:
    if not members:
        return ""
    rows = "".join(
        f"<tr><td><code>{escape(m.path)}</code></td><td>{escape(m.unit)}</td><td>{escape(m.meaning)}</td>"
        f"<td>{escape(m.sign or m.range)}</td></tr>\n"
        for m in members
    )
    return (
        f"<h2>{title}</h2>\n<table>\n<tr><th>name</th><th>unit</th><th>what</th><th>sign or"
        f" range</th></tr>\n{rows}</table>\n"
    )


def _tag(element: str, /, **attributes: object) -> str:
    """Return an element that has attributes alone."""
    given = (f" {key}={quoteattr(str(value))}" for key, value in attributes.items())
    return f"<{element}{''.join(given)} />"


def _unit(name: str) -> str:
    """Return the element of a unit, in base units if it is known."""
    if (unit := known(name)) is None:
        return "    " + _tag("Unit", name=name)
    powers = {base: n for base, n in zip(("kg", "m", "s", "rad"), unit.powers, strict=True) if n}
    factor = {} if unit.factor == 1.0 else {"factor": unit.factor}
    return f"    <Unit name={quoteattr(name)}>{_tag('BaseUnit', **powers, **factor)}</Unit>"


def _variable(place: int, one: Variable) -> str:
    """Return the element of a variable."""
    m = one.member
    numbers = {"min": m.low, "max": m.high, "start": one.start}
    finite = {key: x for key, x in numbers.items() if x is not None and math.isfinite(x)}
    variable = _tag(
        "ScalarVariable",
        name=m.path,
        valueReference=place,
        description="; ".join(part for part in (m.meaning, m.sign) if part),
        causality=one.kind,
        **_CHANGING[one.kind],
    )
    real = _tag("Real", unit=m.unit, **finite)
    return f"    {variable.removesuffix(' />')}>{real}</ScalarVariable>"
