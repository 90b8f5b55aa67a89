"""Interface of an exported program: its names, units, signs and ranges, from which every consumer
is written.
"""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from ...base.arrays import Json
from ...base.brief import Brief
from ...base.quantities import Output, motion_names, motions_of
from ...base.symbolic import symbolic
from ...base.tables import PLANE, Table, table_of
from ...base.vocabulary import Precision
from ...engine.program import Program
from ...model.description import ParameterNumbers
from ...results.solution import Solution
from .naming import constants, members, prefix

REST = "rest:"
"""First part of the full name of a rest."""

FAINT = 1e-9
"""Relative size below which a value is written as zero, for its digits are rounding."""


@dataclass(frozen=True, repr=False)
class Member(Brief):
    """A member of a struct: its name in C, the full name of what it holds, and what a reader must
    know of it.

    ``wrapped`` is true for an angle that is known up to whole turns. A parameter has a ``default``,
    and a range from ``low`` to ``high``.
    """

    name: str
    source: str
    unit: str
    meaning: str
    sign: str = ""
    range: str = ""
    wrapped: bool = False
    default: float = math.nan
    low: float = -math.inf
    high: float = math.inf

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

    def described(self, meaning: str) -> dict[str, Json]:
        """Return what programs read of it."""
        return {"name": self.name, "path": self.path, "unit": self.unit, "meaning": meaning}


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
    settings: tuple[Member, ...]
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
    def words(self) -> dict[str, str]:
        """Words of every template: the prefix of names, and that of constants."""
        return {"p": self.prefix, "P": self.prefix.upper()}

    @property
    def shown(self) -> tuple[Member, Member]:
        """An input and an output for examples: a coordinate, and an effort, if there is one."""
        efforts = (m for m in self.outputs if m.source.startswith("effort:"))
        moved = next(m for m in self.inputs if m.source.startswith("motion:"))
        return moved, next(efforts, self.outputs[0])

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
        return found | {
            f"link {link.name}": link.constant
            for link in self.links
            if link.constant != f"{self.prefix}_link_{link.name}".upper()
        }

    def parts_of(self, name: str) -> list[str]:
        """The members that add up to the input of a full name, such as ``motion:O_rate`` or
        ``time``: its own, and its rest, if any.
        """
        return [m.name for m in self.inputs if m.source in (name, f"{REST}{name}")]

    def split(self, value: str) -> list[str]:
        """A variable of C that is a double as numbers of the precision: one, or in single precision
        two that add up to it.
        """
        first = f"({self.prefix}_real) {value}"
        rest = f"({self.prefix}_real) ({value} - (double) {first})"
        return [first, rest] if self.rests else [first]

    def given(self, struct: str, name: str, value: str) -> Iterator[str]:
        """Yield the statements of C that give the inputs of a ``struct``, by a full name, a
        variable that is a double; rates and accelerations have no rest.
        """
        for member, part in zip(self.parts_of(name), self.split(value), strict=False):
            yield f"{struct}{member} = {part};"

    @property
    def moved(self) -> list[list[str]]:
        """Full names of the coordinates, the rates and the accelerations, each by drive."""
        return motion_names(self.drives)

    @property
    def motion(self) -> list[list[str]]:
        """The members for coordinates, rates and accelerations, each by drive."""
        return [[self.parts_of(name)[0] for name in names] for names in self.moved]

    @property
    def moment(self) -> list[str]:
        """The members for the time and the coordinates, and in single precision for the rest of
        each; the time is empty where nothing depends on it.
        """
        names = ["time", *self.moved[0]]
        names += [f"{REST}{name}" for name in names] if self.rests else []
        given = {m.source: m.name for m in self.inputs}
        return [given.get(name, "") for name in names]


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
    values = solution.description.parameters
    timed = _timed(program)
    settings = [] if fixed else [_setting(key, values[key]) for key in program.data.parameters]
    inputs = list(_inputs(program, precision, timed))
    taken = {m.source for m in inputs}
    given = [output for output in program.outputs if str(output) not in taken]
    units = [output.unit(program.data.kinds) for output in given]
    largest = largest_of(units, (np.abs(solution.outputs[output]).max() for output in given))
    outputs = [_output(program, output, solution, largest) for output in given]
    numbered = constants(f"{prefix(name)}_link", program.links)
    links = [LinkContract(link, constant) for link, constant in numbered.items()]
    return Contract(
        prefix(name),
        name,
        precision,
        _named(settings),
        _named(inputs, "input"),
        _named(outputs),
        tuple(links),
        program.driven,
        timed,
        tuple(map(str, indeterminate)),
        solution.table,
    )


def _named(struct: Sequence[Member], kind: str = "") -> tuple[Member, ...]:
    """Members of a struct, with their names in C."""
    names = members({m.source: _short(m.source, kind) for m in struct})
    return tuple(replace(m, name=names[m.source]) for m in struct)


def largest_of(units: Iterable[str], sizes: Iterable[float]) -> dict[str, float]:
    """The largest of some sizes in each unit."""
    found: dict[str, float] = {}
    for unit, size in zip(units, sizes, strict=True):
        found[unit] = max(found.get(unit, 0.0), float(size))
    return found


@symbolic
def _timed(program: Program) -> bool:
    """Return whether anything but the motion depends on the time."""
    functions = [(program.instant, 0), *([(program.newton.step, 1)] if program.newton else [])]
    called = ((function.sx_in(), function, place) for function, place in functions)
    return any(
        ca.depends_on(ca.veccat(*function.call(symbols)), symbols[place])
        for symbols, function, place in called
    )


def _setting(key: str, parameter: ParameterNumbers) -> Member:
    low, high = parameter.low, parameter.high
    begin, end = "[" if math.isfinite(low) else "(", "]" if math.isfinite(high) else ")"
    return Member(
        name="",
        source=key,
        unit=parameter.unit,
        meaning=f"parameter {key}",
        range=f"in {begin}{low:.6g}, {high:.6g}{end}; default {parameter.value:.6g}",
        default=parameter.value,
        low=low,
        high=high,
    )


def _inputs(program: Program, precision: Precision, timed: bool) -> Iterator[Member]:
    time = ("time", "s", "time, which loads of this mechanism depend on", "", "the time")
    rows = [time] if timed else []
    for output in itertools.chain(*map(motions_of, program.driven)):
        meaning = f"{_where(output)}: {_brief(output.quantity.long_name)}"
        unit, sign = output.unit(program.data.kinds), _sign(program, output)
        rows.append((str(output), unit, meaning, sign, "" if output.member else "it"))
    for key, unit, meaning, sign, rounded in rows:
        yield Member("", key, unit, meaning, sign, "any finite number")
        if rounded and precision == "single":
            rest = f"remainder of {rounded} that single precision does not hold, 0 if unknown"
            yield Member("", f"{REST}{key}", unit, rest, range="any finite number")


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
    program: Program, output: Output, solution: Solution, largest: Mapping[str, float]
) -> Member:
    unit, wrapped = output.unit(program.data.kinds), output in program.loop_angles
    within = "in (-pi, pi]" if wrapped else _range(solution, output, largest[unit])
    meaning = f"{_where(output)}: {_brief(output.meant(solution.table).long_name)}"
    return Member("", str(output), unit, meaning, _sign(program, output), within, wrapped)


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
    return re.sub(" of the joint('s coordinate)?| of the drive|, continuous in time", "", meaning)


def _range(solution: Solution, output: Output, largest: float) -> str:
    """Range of a quantity over the cycle of the scene, in a few digits; ``largest`` is the largest
    of its unit.
    """
    values = solution.outputs[output]
    faint = max(FAINT * largest, 2.0 * solution.errors.get(str(output), 0.0))
    low, high = (0.0 if abs(x) <= faint else float(x) for x in (values.min(), values.max()))
    ends = [f"{x:.3g}" for x in (low, high)]
    return (
        f"{ends[0] if ends[0] == ends[1] else f'from {ends[0]} to {ends[1]}'} over the scene's"
        " motion"
    )
