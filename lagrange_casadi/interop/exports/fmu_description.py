"""Model description of a unit: its variables with units, start values and limits, and their
dependencies.
"""

from __future__ import annotations

import hashlib
import math
import uuid
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from html import escape
from typing import TYPE_CHECKING, Literal
from xml.etree import ElementTree

import numpy as np

from ...base.quantities import Output, motion_names
from ...engine.program import Program
from ...version import __version__
from ..portable.contract import Contract, Member, Setting
from ..portable.golden import motions_at
from ..portable.source import Source
from ..portable.text import template
from .unit_powers import BASE, base_unit

if TYPE_CHECKING:
    import casadi as ca

LOGGED = {
    "logStatusDiscard": "instants without a result, and why",
    "logStatusError": "parameters that are refused, and calls that are out of order",
}


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
    def contract(self) -> Contract:
        """Inputs and outputs of the program."""
        return self.source.contract

    @property
    def timed(self) -> bool:
        """True if anything depends on the importer's time."""
        return self.by == "time" or (self.contract.timed and not self.by)

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
        c, start = self.contract, self.start
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
        text = _text(self._root(""))
        whole = self.source.identity + self.source.code + text
        return f"{{{uuid.UUID(hashlib.sha256(whole.encode()).hexdigest()[:32])}}}"

    @property
    def xml(self) -> str:
        """The text of the file."""
        return '<?xml version="1.0" encoding="UTF-8"?>\n' + _text(self._root(self.guid)) + "\n"

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

    def _root(self, guid: str) -> ElementTree.Element:
        c = self.contract
        root = ElementTree.Element(
            "fmiModelDescription",
            fmiVersion="2.0",
            modelName=c.name,
            guid=guid,
            description=(
                "Efforts, reactions and section forces of a mechanism, from the motion of its"
                " drives"
            ),
            generationTool=f"lagrange_casadi {__version__}",
            variableNamingConvention="flat",
            numberOfEventIndicators="0",
        )
        for kind, able in _KINDS.items():
            element = _add(
                root, kind, modelIdentifier=c.prefix, **{able: "true"}, canGetAndSetFMUstate="true"
            )
            files = _add(element, "SourceFiles")
            for file in self.sources:
                _add(files, "File", name=file)
        units = _add(root, "UnitDefinitions")
        for unit in dict.fromkeys(one.member.unit for one in self.variables):
            _unit(units, unit)
        logged = _add(root, "LogCategories")
        for name, meaning in LOGGED.items():
            _add(logged, "Category", name=name, description=meaning)
        data = self.source.exported.program.data
        (start, stop), count = data.span, data.timing.count
        span = {"startTime": _number(start)}
        if stop > start:
            span |= {
                "stopTime": _number(stop),
                "stepSize": _number((stop - start) / max(1, count - 1)),
            }
        _add(root, "DefaultExperiment", **span)
        self._variables(_add(root, "ModelVariables"))
        self._structure(_add(root, "ModelStructure"))
        return root

    def _variables(self, parent: ElementTree.Element) -> None:
        for place, one in enumerate(self.variables):
            m, numbers = one.member, dict[str, float]()
            if isinstance(m, Setting):
                numbers = {"min": m.low, "max": m.high}
            if one.start is not None:
                numbers["start"] = one.start
            finite = {key: _number(x) for key, x in numbers.items() if math.isfinite(x)}
            variable = _add(
                parent,
                "ScalarVariable",
                name=m.path,
                valueReference=str(place),
                description="; ".join(part for part in (m.meaning, m.sign) if part),
                causality=one.kind,
                **_CHANGING[one.kind],
            )
            _add(variable, "Real", unit=m.unit, **finite)

    def _structure(self, parent: ElementTree.Element) -> None:
        exported = self.source.exported
        reach = None if exported.cycle is not None else reached(exported.program)
        for kind, fixed in (("Outputs", False), ("InitialUnknowns", True)):
            group = _add(parent, kind)
            for k, one in enumerate(self.variables, 1):
                if one.kind != "output":
                    continue
                unknown = _add(group, "Unknown", index=str(k))
                if reach is not None:
                    on = {
                        self.known[name]
                        for name in reach[one.member.source] & self.known.keys()
                        if fixed or not name.startswith("parameter:")
                    }
                    unknown.set("dependencies", " ".join(map(str, sorted(on))))


_KINDS = {
    "ModelExchange": "completedIntegratorStepNotNeeded",
    "CoSimulation": "canHandleVariableCommunicationStepSize",
}
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
    named = [
        ["time"],
        *motion_names(program.driven),
        [f"parameter:{name}" for name in program.data.parameters],
    ]
    _, coordinate, rate, acceleration, z, p = range(6)
    loops: set[str] = set()
    if program.newton is not None:
        # What closes the loops closes all of them.
        for place, names in ((1, named[0]), (2, named[1]), (3, named[4])):
            loops |= {names[column] for _, column in _entries(program.newton.step, place)}
    found: list[set[str]] = [set() for _ in program.columns]
    for place, names in zip((0, coordinate, rate, acceleration, p), named, strict=True):
        for row, column in _entries(program.instant, place):
            found[row].add(names[column])
    for row, _ in _entries(program.instant, z):
        found[row] |= loops
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
        title=escape(description.contract.name),
        conventions=escape(description.contract.table.conventions),
        tables="".join(_table(f"{kind.title()}s", description.members(kind)) for kind in kinds),
        version=__version__,
        scene=description.source.identity,
    )


def _table(title: str, members: Sequence[Member]) -> str:
    if not members:
        return ""
    rows = "".join(
        f"<tr><td><code>{escape(m.path)}</code></td><td>{escape(m.unit)}</td><td>{escape(m.meaning)}</td>"
        f"<td>{escape(m.range if isinstance(m, Setting) else m.sign)}</td></tr>\n"
        for m in members
    )
    return (
        f"<h2>{title}</h2>\n<table>\n<tr><th>name</th><th>unit</th><th>what</th><th>sign or"
        f" range</th></tr>\n{rows}</table>\n"
    )


def _add(parent: ElementTree.Element, tag: str, **attributes: str) -> ElementTree.Element:
    return ElementTree.SubElement(parent, tag, attributes)


def _unit(parent: ElementTree.Element, name: str) -> None:
    unit, known = _add(parent, "Unit", name=name), base_unit(name)
    if known is not None:
        powers = {base: str(n) for base, n in zip(BASE, known.exponents, strict=True) if n}
        _add(
            unit,
            "BaseUnit",
            **powers,
            **({} if known.factor == 1.0 else {"factor": _number(known.factor)}),
        )


def _number(value: float) -> str:
    return repr(float(value))


def _text(root: ElementTree.Element) -> str:
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode")
