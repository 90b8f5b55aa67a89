"""Interface of an exported program: its names, units, signs and ranges, from which every consumer
is written.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from ..base.brief import Brief
from ..base.quantities import Output
from ..base.symbolic import symbolic
from ..base.tables import PLANE, Table, table_of
from ..base.vocabulary import Precision
from ..equations.program import Program
from ..instants.solution import Solution
from .naming import constants, members, prefix

REST = "rest:"
"""First part of the full name of a rest."""

CORNERS = "Corners of motions, constraints and lifts were checked with the default parameters only."
"""Note for whoever changes parameters."""

_DIGITS = 3
FAINT = 1e-9
"""Relative size below which a value is written as zero, for its digits are rounding."""


@dataclass(frozen=True)
class Member:
    """A member of a struct: its name in C, the full name of what it holds, and what a reader must
    know of it.

    ``wrapped`` is true for an angle that is known up to whole turns.
    """

    name: str
    source: str
    unit: str
    meaning: str
    sign: str = ""
    range: str = ""
    wrapped: bool = False

    @property
    def rest_of(self) -> str:
        """The full name of what this is the rest of, empty where it is none."""
        return self.source.removeprefix(REST) if self.source.startswith(REST) else ""

    @property
    def comment(self) -> str:
        """One line: meaning, unit, sign and range."""
        return "; ".join(
            part for part in (f"{self.meaning} [{self.unit}]", self.sign, self.range) if part
        )

    @property
    def path(self) -> str:
        """Path in a file of results."""
        return self.source.replace(":", "/")


@dataclass(frozen=True)
class Setting(Member):
    """A parameter, with its default and its range."""

    default: float = math.nan
    low: float = -math.inf
    high: float = math.inf


@dataclass(frozen=True)
class LinkContract:
    """A link that has sections: its name, and its number in C."""

    name: str
    constant: str


@dataclass(frozen=True, repr=False)
class Contract(Brief):
    """An exported program's interface.

    ``inputs`` and ``outputs`` are the members of these structs in order; ``rests`` is true if each
    coordinate, and the time, has a second number, its error of rounding to single precision.
    ``settings`` are the parameters, ``links`` those with sections, ``drives`` the driven joints.
    ``timed`` is true if results depend on the time. ``table`` has the description of the members.
    """

    prefix: str
    name: str
    precision: Precision
    settings: tuple[Setting, ...]
    inputs: tuple[Member, ...]
    outputs: tuple[Member, ...]
    links: tuple[LinkContract, ...]
    drives: tuple[str, ...]
    timed: bool
    undetermined: tuple[str, ...]
    table: Table

    @property
    def rests(self) -> bool:
        """True if coordinates come in two numbers."""
        return self.precision == "single"

    @property
    def real(self) -> str:
        """The type of numbers."""
        return "float" if self.precision == "single" else "double"

    @property
    def shown(self) -> tuple[Member, Member]:
        """An input and an output for examples: a coordinate, and an effort, if there is one."""
        efforts = (m for m in self.outputs if m.source.startswith("effort:"))
        moved = next(m for m in self.inputs if m.source.startswith("motion:"))
        return moved, next(efforts, self.outputs[0])

    @property
    def units(self) -> set[str]:
        """The units of the outputs."""
        return {m.unit for m in self.outputs}

    @property
    def mapped(self) -> dict[str, str]:
        """Names that C writes otherwise: a parameter's or a joint's own name, and what it is
        called.
        """
        found = {f"name {self.name}": self.prefix} if self.name != self.prefix else {}
        for kind, struct in (
            ("parameter", self.settings),
            ("input", self.inputs),
            ("output", self.outputs),
        ):
            for m in struct:
                short = _short(m.source, kind)
                if m.name != re.sub(r"\W", "_", short):
                    found[f"{kind} {short}, a rest" if m.rest_of else f"{kind} {short}"] = m.name
        usual = {link.name: f"{self.prefix}_link_{link.name}".upper() for link in self.links}
        return found | {
            f"link {link.name}": link.constant
            for link in self.links
            if link.constant != usual[link.name]
        }

    def input_of(self, name: str) -> str:
        """The member for the input of a full name, such as ``motion:O_rate`` or ``time``."""
        return next(member.name for member in self.inputs if member.source == name)

    def parts_of(self, name: str) -> list[str]:
        """The members that add up to the input of a full name: its own, and its rest, if any."""
        return [m.name for m in self.inputs if m.source in (name, f"{REST}{name}")]

    @property
    def motion(self) -> list[list[str]]:
        """The members for coordinates, rates and accelerations, each by drive."""
        return [
            [self.input_of(f"motion:{drive}{order}") for drive in self.drives]
            for order in ("", "_rate", "_acceleration")
        ]


def _short(source: str, kind: str = "") -> str:
    """A full name without what C leaves out: of inputs, that they are motions; of a section's law,
    the word.
    """
    if kind != "input":
        return source.replace(":law:", ":")
    return (
        f"{_short(source.removeprefix(REST), kind)}_rest"
        if source.startswith(REST)
        else source.removeprefix("motion:")
    )


def contract(
    program: Program,
    name: str,
    precision: Precision,
    solution: Solution,
    indeterminate: tuple[Output, ...],
    *,
    fixed: bool,
) -> Contract:
    """The contract of a graph whose evaluation over its cycle is ``solution``; ``fixed`` leaves no
    parameter open.
    """
    values = solution.description["parameters"]
    timed = _timed(program)
    settings = [] if fixed else [_setting(key, values[key]) for key in program.data.parameters]
    names = members({setting.source: setting.source for setting in settings})
    inputs = _inputs(program, precision, timed)
    shown = members({key: _short(key, "input") for key in inputs})
    given = [output for output in program.outputs if str(output) not in inputs]
    called = members({str(output): _short(str(output)) for output in given})
    largest: dict[str, float] = {}
    for output in given:
        unit = output.unit(program.data.kinds)
        largest[unit] = max(largest.get(unit, 0.0), float(np.abs(solution.outputs[output]).max()))
    numbered = constants(f"{prefix(name)}_link", program.links)
    links = [LinkContract(link, constant) for link, constant in numbered.items()]
    return Contract(
        prefix(name),
        name,
        precision,
        tuple(replace(s, name=names[s.source]) for s in settings),
        tuple(replace(m, name=shown[key]) for key, m in inputs.items()),
        tuple(_output(program, output, called[str(output)], solution, largest) for output in given),
        tuple(links),
        program.driven,
        timed,
        tuple(map(str, indeterminate)),
        solution.table,
    )


@symbolic
def _timed(program: Program) -> bool:
    """Return whether anything but the motion depends on the time."""
    functions = [(program.instant, 0), *([(program.newton.step, 1)] if program.newton else [])]
    called = ((function.sx_in(), function, place) for function, place in functions)
    return any(
        ca.depends_on(ca.veccat(*function.call(symbols)), symbols[place])
        for symbols, function, place in called
    )


def _setting(key: str, parameter: dict[str, float]) -> Setting:
    low, high = (
        -math.inf if parameter["low"] is None else parameter["low"],
        math.inf if parameter["high"] is None else parameter["high"],
    )
    within = f"{_bracket(low, '[', '(')}{low:.6g}, {high:.6g}{_bracket(high, ']', ')')}"
    unit = str(parameter["unit"])
    default = parameter["value"]
    return Setting(
        name=key,
        source=key,
        unit=unit,
        meaning=f"parameter {key}",
        range=f"in {within}; default {default:.6g}",
        default=default,
        low=low,
        high=high,
    )


def _bracket(value: float, closed: str, opened: str) -> str:
    return closed if math.isfinite(value) else opened


def _inputs(program: Program, precision: Precision, timed: bool) -> dict[str, Member]:
    rests = precision == "single"
    found: dict[str, Member] = {}

    def add(
        key: str, unit: str, meaning: str, sign: str = "", range_: str = "any finite number"
    ) -> None:
        found[key] = Member("", key, unit, meaning, sign, range_)

    rest = "remainder of {} that single precision does not hold, 0 if unknown"
    if timed:
        add("time", "s", "time, which loads of this mechanism depend on")
        if rests:
            add(f"{REST}time", "s", rest.format("the time"))
    for joint in program.driven:
        for member in ("", "rate", "acceleration"):
            output = Output("motion", joint, member)
            key, unit = str(output), output.unit(program.data.kinds)
            add(
                key,
                unit,
                f"{_where(output)}: {_brief(output.quantity.long_name)}",
                _sign(program, output),
            )
            if rests and not member:
                add(f"{REST}{key}", unit, rest.format("it"))
    return found


def _sign(program: Program, output: Output) -> str:
    table = table_of(program.data.space)
    if output == Output("motion", output.part) and table is PLANE:
        return (
            "counter-clockwise"
            if program.data.kinds.coordinates[output.part] == "angle"
            else "along the axis"
        )
    return output.meant(table).sign


def _output(
    program: Program, output: Output, member: str, solution: Solution, largest: Mapping[str, float]
) -> Member:
    unit, wrapped = output.unit(program.data.kinds), output in program.loop_angles
    within = "in (-pi, pi]" if wrapped else _range(solution, output, largest[unit])
    meaning = f"{_where(output)}: {_brief(output.meant(solution.table).long_name)}"
    return Member(member, str(output), unit, meaning, _sign(program, output), within, wrapped)


def _where(output: Output) -> str:
    kinds = {
        "motion": "joint",
        "pose": "body",
        "effort": "joint",
        "reaction": "joint",
        "law": "link",
        "station": "link",
    }
    if output.group == "spread":
        return (
            f"link {output.part}, load"
            f" {output.load_point}{'' if output.power is None else f', power {output.power}'}"
        )
    found = f"{kinds.get(output.group, output.group)} {output.part}"
    return f"{found}, load point {output.load_point}" if output.load_point else found


def _brief(meaning: str) -> str:
    """A meaning as it is said of a part that was named."""
    for words in (
        " of the joint's coordinate",
        " of the joint",
        " of the drive",
        ", continuous in time",
    ):
        meaning = meaning.replace(words, "")
    return meaning


def _range(solution: Solution, output: Output, largest: float) -> str:
    """Range of a quantity over the cycle of the scene, in a few digits; ``largest`` is the largest
    of its unit.
    """
    values = solution.outputs[output]
    faint = max(FAINT * largest, 2.0 * solution.errors.get(str(output), 0.0))
    low, high = (0.0 if abs(x) <= faint else float(x) for x in (values.min(), values.max()))
    ends = [f"{x:.{_DIGITS}g}" for x in (low, high)]
    return (
        f"{ends[0] if ends[0] == ends[1] else f'from {ends[0]} to {ends[1]}'} over the scene's"
        " motion"
    )
