"""Model description of a unit: its variables with units, start values and limits, and their
dependencies.
"""

from __future__ import annotations

import hashlib
import itertools
import math
import uuid
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from html import escape
from typing import TYPE_CHECKING
from xml.etree import ElementTree

import numpy as np

from ..base.arrays import Array
from ..base.quantities import Output
from ..equations.program import Program
from ..portable.contract import Contract, Member, Setting
from ..portable.source import Source
from ..version import __version__
from .units import BASE, base_unit

if TYPE_CHECKING:
    import casadi as ca

LOGGED = {
    "logStatusDiscard": "instants without a result, and why",
    "logStatusError": "parameters that are refused, and calls that are out of order",
}


@dataclass(frozen=True, eq=False)
class Description:
    """A unit's ``modelDescription.xml``, for parameters ``p``; ``sources`` are the files to
    compile.

    ``by`` is empty where the motion of the drives is an input, ``time`` where the scene's motion is
    inside, or the coordinate that is an input in place of the time. The value reference of a
    variable is its place: parameters, inputs, outputs, and the time where anything depends on it.
    """

    source: Source
    p: Array
    sources: tuple[str, ...]
    by: str = ""

    @property
    def contract(self) -> Contract:
        """Inputs and outputs of the program."""
        return self.source.contract

    @property
    def inputs(self) -> tuple[Member, ...]:
        """The motion of the drives, or as much of it as is an input.

        The time is the importer's, and what single precision leaves is computed.
        """
        given = (m for m in self.contract.inputs if m.source in self.start)
        return tuple(m for m in given if self.by in ("", m.source.removeprefix("motion:")))

    @property
    def timed(self) -> bool:
        """True if anything depends on the importer's time."""
        return self.by == "time" or (self.contract.timed and not self.by)

    @cached_property
    def start(self) -> dict[str, float]:
        """Start values of inputs: the scene's motion at its first instant."""
        program = self.source.exported.program
        rows = [
            np.atleast_1d(row.full().ravel())
            for row in program.motion(program.data.span[0], self.p)
        ]
        names = [
            str(Output("motion", joint, member))
            for member in ("", "rate", "acceleration")
            for joint in program.driven
        ]
        return dict(zip(names, np.concatenate(rows).tolist(), strict=True))

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
        c = self.contract
        names = [f"parameter:{m.source}" for m in c.settings] + [m.source for m in self.inputs]
        found = {name: k for k, name in enumerate(names, 1)}
        found |= {"time": len(names) + len(c.outputs) + 1} if self.timed else {}
        if not self.by:
            return found
        inside = found["time"] if self.by == "time" else found[f"motion:{self.by}"]
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
        members = (*c.settings, *self.inputs, *c.outputs)
        units = _add(root, "UnitDefinitions")
        for unit in dict.fromkeys([m.unit for m in members] + ["s"] * self.timed):
            _unit(units, unit)
        logged = _add(root, "LogCategories")
        for name, meaning in LOGGED.items():
            _add(logged, "Category", name=name, description=meaning)
        (start, stop), count = (
            self.source.exported.program.data.span,
            self.source.exported.program.data.timing.count,
        )
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
        c, place = self.contract, itertools.count()

        def add(member: Member, words: dict[str, str], values: dict[str, str]) -> None:
            description = "; ".join(part for part in (member.meaning, member.sign) if part)
            called = {
                "name": member.path,
                "valueReference": str(next(place)),
                "description": description,
            }
            variable = _add(parent, "ScalarVariable", **called, **words)
            _add(variable, "Real", unit=member.unit, **values)

        for m in c.settings:
            limits = {
                key: _number(x) for key, x in (("min", m.low), ("max", m.high)) if math.isfinite(x)
            }
            add(
                m,
                {"causality": "parameter", "variability": "tunable", "initial": "exact"},
                limits | {"start": _number(m.default)},
            )
        for given in self.inputs:
            add(
                given,
                {"causality": "input", "variability": "continuous"},
                {"start": _number(self.start[given.source])},
            )
        for output in c.outputs:
            add(
                output,
                {"causality": "output", "variability": "continuous", "initial": "calculated"},
                {},
            )
        if self.timed:
            name = "time" if all(m.source != "time" for m in c.settings) else "simulation/time"
            add(
                Member("", name, "s", "time"),
                {"causality": "independent", "variability": "continuous"},
                {},
            )

    def _structure(self, parent: ElementTree.Element) -> None:
        reach = (
            None
            if self.source.exported.cycle is not None
            else reached(self.source.exported.program)
        )
        for kind, fixed in (("Outputs", False), ("InitialUnknowns", True)):
            group = _add(parent, kind)
            for k, m in enumerate(
                self.contract.outputs, len(self.contract.settings) + len(self.inputs) + 1
            ):
                unknown = _add(group, "Unknown", index=str(k))
                if reach is not None:
                    on = sorted(
                        {
                            self.known[name]
                            for name in reach[m.source] & self.known.keys()
                            if fixed or not name.startswith("parameter:")
                        }
                    )
                    unknown.set("dependencies", " ".join(map(str, on)))


_KINDS = {
    "ModelExchange": "completedIntegratorStepNotNeeded",
    "CoSimulation": "canHandleVariableCommunicationStepSize",
}


def reached(program: Program) -> dict[str, frozenset[str]]:
    """Dependencies of each column of a graph, by its structure: ``time``, ``motion:...`` and
    ``parameter:NAME``.
    """
    named = [
        ["time"],
        *(
            [str(Output("motion", joint, member)) for joint in program.driven]
            for member in ("", "rate", "acceleration")
        ),
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


_ABOUT = """\
Efforts of the drives, reactions of the joints and forces inside the links of a mechanism, at any
instant of any motion of its drives: everything follows from the inputs, the parameters and the
time, and nothing is integrated. If there is no result, fmi2Discard is returned; if a parameter is
refused, fmi2Error; and the reason is logged. Angles that follow from loops continue from the last
instant by the nearest revolution, and iterated loops start from its solution, so instants must be
near each other. In Co-Simulation, inputs are constant during a step: outputs that are read after it
belong to the inputs before it, unless inputs are set again."""


def page(description: Description) -> str:
    """Documentation of the unit: ``documentation/index.html``."""
    c = description.contract
    tables = (("Parameters", c.settings), ("Inputs", description.inputs), ("Outputs", c.outputs))
    rest = "".join(_table(title, members) for title, members in tables if members)
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head><meta charset="utf-8">'
        f"<title>{escape(c.name)}</title></head>\n<body>\n<h1>{escape(c.name)}</h1>\n<p>{_ABOUT}</p>\n"
        f"<p>{escape(c.table.conventions)}.</p>\n{rest}<p>Written"
        f" by lagrange_casadi {__version__} from the scene"
        f" {description.source.identity}.</p>\n</body>\n</html>\n"
    )


def _table(title: str, members: Sequence[Member]) -> str:
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
