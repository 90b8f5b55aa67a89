"""The header and the source of an exported program, filled in from their templates."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from ..base.arrays import Array
from ..base.quantities import Output
from ..base.status import Status
from ..codegen.emit import newton_rule
from ..codegen.printer import Format, function_name, literal
from ..declare.ends import BEYOND
from ..version import __version__
from .calls import INSTANT, MODEL, PREPARE, CalledInC
from .contract import Contract, Member
from .data import table_call, table_text
from .exported_program import ExportedProgram
from .golden import Golden
from .sections import functions
from .slopes import ExportedSlopes
from .slopes import code as sensitivity
from .statuses import ANSWERS, STATUSES
from .text import comment, indented, printed, template


@dataclass(frozen=True, eq=False)
class Source:
    """Data from which header and source are written.

    ``identity`` is the hash of the scene, ``guess`` where iterated loops begin, ``method`` the
    options by which it is evaluated, ``values`` are the parameters, of which a table leaves none
    open, and ``golden`` what it must compute, ``slopes`` the derivatives of its outputs, where they
    are wanted.
    """

    contract: Contract
    exported: ExportedProgram
    identity: str
    guess: Sequence[float]
    method: str
    values: Mapping[str, float]
    golden: Golden
    slopes: ExportedSlopes | None = None

    @cached_property
    def code(self) -> str:
        """The source: ``<prefix>.c``."""
        sections = functions(self.contract, self.exported) if self.contract.links else ""
        if self.slopes is not None:
            sections += sensitivity(self.contract, self.slopes)
        return template(
            "mechanism.c",
            **self.words,
            includes="\n#include <string.h>" if self.exported.cycle is not None else "",
            graph=self.exported.text,
            seal=f"0x{self.identity[:8]}u",
            helpers=self._helpers(),
            put=indented(f"outputs->{m.name} = {self._value(m)};" for m in self.contract.outputs),
            defaults=self._defaults(),
            prepare=indented(self._prepare()),
            motion=indented(self._motion()),
            instant=indented(self._instant()),
            rows=len(self.exported.columns),
            sections=sections,
            messages="\n".join(
                f'  case {self._upper}_{key}:\n    return "{text}";'
                for key, text in STATUSES.items()
            ),
        )

    @property
    def _upper(self) -> str:
        return self.contract.words["P"]

    @property
    def words(self) -> dict[str, str]:
        """Values of every template."""
        c = self.contract
        return c.words | {
            "name": comment(c.name),
            "called": printed(c.name),
            "space": " " * (2 * len(c.prefix) + 9),
            "and_parameters": f", const {c.prefix}_parameters* parameters" if c.settings else "",
            "and_defaults": ", 0" if c.settings else "",
            "and_rest": f", {c.prefix}_real time_rest" if c.rests else "",
            "version": __version__,
            "casadi": ca.CasadiMeta.version(),
            "scene": self.identity,
        }

    @property
    def fixed(self) -> Mapping[str, float]:
        """The parameters that are no longer open."""
        return {} if self.contract.settings else self.values

    @property
    def p(self) -> Array:
        """The parameters as one vector."""
        return np.array(list(self.values.values()))

    @property
    def story(self) -> str:
        """Description of the evaluation, its accuracy, and its fixed numbers."""
        error, output = self.golden.worst
        text = f"In {self.contract.precision} precision; options of the export: {self.method}. "
        text += (
            f"Its outputs are off by about {error:.0e} of their largest values over the scene's"
            f" motion at most ({output})."
        )
        if self.fixed:
            text += (
                " Fixed here: "
                + ", ".join(f"{name} = {value:.6g}" for name, value in self.fixed.items())
                + "."
            )
        return text

    @property
    def iterated(self) -> bool:
        """True if it follows loops from one instant to the next."""
        return "loops" in self.exported.functions

    @property
    def model(self) -> list[tuple[str, str, int]]:
        """The members of a model: name, type, where ``real`` is that of the precision, and how many
        of it.
        """
        sizes = self.exported.sizes
        closed = [("closed", "int", 1)] if self.exported.newton is not None else []
        return [
            ("seal", "unsigned", 1),
            *closed,
            *((name, "real", sizes[name]) for name in MODEL if sizes[name]),
        ]

    @property
    def span(self) -> tuple[float, float]:
        """The times [s] that all motions cover."""
        return self.exported.program.laws.span

    def column(self, member: Member) -> str:
        """The column of an output, as C and other languages write it."""
        return f"y[{self.exported.columns.index(Output.of(member.source))}]"

    def _value(self, member: Member) -> str:
        still = self.exported.still.get(Output.of(member.source))
        if still is not None:
            return self.number(still)
        return f"direction({self.column(member)})" if member.wrapped else self.column(member)

    @property
    def number(self) -> Format:
        """Literal of C for a number of the precision."""
        return literal(self.contract.precision)

    def _helpers(self) -> str:
        number, found = self.number, ""
        if self.exported.program.loop_angles:
            turn = number(math.tau)
            found += (
                "\n/* An angle without its whole turns, in (-pi, pi]. */\nstatic casadi_real"
                " direction(casadi_real angle) {\n  return angle -"
                f" {turn}*{function_name('ceil', self.contract.precision)}(angle/{turn} -"
                f" {number(0.5)});\n}}\n"
            )
        if self.iterated:
            rule = {key: number(value) for key, value in self.exported.rule.items()}
            newton = self.exported.program.newton
            assert newton is not None
            found += template(
                "loops.c",
                **self.words,
                nz=self.exported.sizes["loops"],
                turning=", ".join(str(int(turning)) for turning in newton.turning),
                turn=number(math.tau),
                inverse=number(1.0 / math.tau),
                half=number(0.5),
                floor=function_name("floor", self.contract.precision),
                rate=rule["rate"],
                rounding=rule["rounding"],
                given=indented(CalledInC(self.exported.functions).given("loops")),
            )
        if "status" in self.exported.functions:
            names = ", ".join(f"{self._upper}_{name}" for name in self.answers())
            kind = f"static const {self.contract.prefix}_status"
            found += (
                f"\n/* What a broken rule says, by its number. */\n{kind} broken[] = {{{names}}};\n"
            )
        return found + table_text(self.exported)

    def answers(self) -> Iterator[str]:
        """Answer for each rule that may be broken, by its number."""
        program = self.exported.program
        yield "OK"
        for rule in program.rules:
            indeterminate = rule.bound is not None and program.bounds[rule.bound].kind.startswith(
                "OPEN"
            )
            yield "UNDETERMINED" if indeterminate else ANSWERS.get(rule.status, "OK")

    def _defaults(self) -> str:
        c, p = self.contract, self.contract.prefix
        if not c.settings:
            return ""
        rows = ",\n".join(f"  {self.number(m.default)} /* {m.name} */" for m in c.settings)
        return f"\nconst {p}_parameters {p}_defaults = {{\n{rows}\n}};\n"

    def _prepare(self) -> Iterable[str]:
        c, P, sizes, number = self.contract, self._upper, self.exported.sizes, self.number
        calls = CalledInC(self.exported.functions)
        if c.settings:
            yield (
                f"const {c.prefix}_parameters* values = parameters ? parameters :"
                f" &{c.prefix}_defaults;"
            )
        if sizes["sound_of"]:
            yield f"casadi_real sound_of[{sizes['sound_of']}];"
            yield "int k;"
        if self.exported.called(PREPARE):
            yield "const casadi_real* arg[1];"
            yield "casadi_real* res[1];"
        yield "model->seal = 0;"
        for k, m in enumerate(c.settings):
            low, high = (
                (f"values->{m.name} >= {number(m.low)}" if math.isfinite(m.low) else ""),
                (f"values->{m.name} <= {number(m.high)}" if math.isfinite(m.high) else ""),
            )
            within = " && ".join(
                part for part in (f"is_finite(values->{m.name})", low, high) if part
            )
            yield f"if (!({within})) return {P}_BAD_PARAMETER;"
            yield f"model->parameters[{k}] = values->{m.name};"
        for name in self.exported.called(PREPARE):
            yield from calls.call(name)
            if name == "sound":
                yield from self._refused_parts()
        if self.exported.newton is not None:
            yield "model->closed = 0;"
        yield from (f"model->loops[{k}] = {number(value)};" for k, value in enumerate(self.guess))

    def _refused_parts(self) -> Iterable[str]:
        """Refuse parameters for which a margin is not positive, or a later one negative."""
        ends = (0, self.exported.positive, self.exported.sizes["sound_of"])
        for (start, stop), test in zip(itertools.pairwise(ends), (">", ">="), strict=True):
            if stop > start:
                yield f"for (k = {start}; k < {stop}; ++k) {{"
                yield (
                    f"  if (!(sound_of[k] {test} 0 && is_finite(sound_of[k]))) return"
                    f" {self._upper}_BAD_PARAMETER;"
                )
                yield "}"

    def _motion(self) -> Iterable[str]:
        c, drives = self.contract, len(self.contract.drives)
        calls = CalledInC(self.exported.functions)
        at = ["time", "time_rest"] if c.rests else ["time"]
        ends = self.exported.functions.get("beyond")
        yield (
            f"casadi_real at[{len(at)}], d[{len(at) * drives}], rate[{drives}],"
            f" acceleration[{drives}];"
        )
        yield "const casadi_real* arg[2];"
        yield "casadi_real* res[3];"
        if ends is not None:
            yield f"casadi_real far[{ends.size1_out(0)}];"
        yield from self._refused("model->seal != SEAL", "NOT_PREPARED")
        yield from self._refused(self._untimely(), "BAD_TIME")
        yield from (f"at[{k}] = {time};" for k, time in enumerate(at))
        yield from calls.call("law")
        if ends is not None:
            limit = self.number(BEYOND[self.contract.precision])
            yield from calls.call("beyond")
            yield from self._refused(
                " || ".join(f"!(far[{k}] <= {limit})" for k in range(ends.size1_out(0))), "BAD_TIME"
            )
        moment = (
            value
            for i, time in enumerate(at)
            for value in (time, *(f"d[{i * drives + k}]" for k in range(drives)))
        )
        values = dict(zip(c.moment, moment, strict=True))
        for vector, members in zip(("rate", "acceleration"), c.motion[1:], strict=True):
            values |= {member: f"{vector}[{k}]" for k, member in enumerate(members)}
        yield from (f"inputs->{m.name} = {values[m.name]};" for m in c.inputs)
        yield f"return {self._upper}_OK;"

    def _refused(self, condition: str, status: str) -> Iterable[str]:
        """Give nothing but a status, where a condition holds."""
        yield f"if ({condition}) {{"
        yield from (f"  inputs->{m.name} = nothing;" for m in self.contract.inputs)
        yield f"  return {self._upper}_{status};"
        yield "}"

    def _untimely(self) -> str:
        """Test that a time is outside the motion."""
        moment = "time + time_rest" if self.contract.rests else "time"
        low, high = self.span
        bad = [f"!is_finite({moment})"]
        bad += [f"{moment} < {self.number(low)}"] if math.isfinite(low) else []
        bad += [f"{moment} > {self.number(high)}"] if math.isfinite(high) else []
        return " || ".join(bad)

    def _instant(self) -> Iterable[str]:
        c, P, sizes, table = self.contract, self._upper, self.exported.sizes, self.exported.cycle
        drives, called = len(c.drives), self.exported.called(INSTANT)
        evaluated = "y" if table is None else "drive"
        calls = CalledInC(self.exported.functions, {"evaluated": evaluated})
        if "count" in called:
            yield f"casadi_real moment[{sizes['moment']}], counted[{sizes['counted']}];"
        yield f"casadi_real rate[{drives}], acceleration[{drives}];"
        if table is not None:
            yield f"casadi_real drive[{sizes['evaluated']}];"
        yield "const casadi_real* arg[5];"
        yield "casadi_real* res[1];"
        if "status" in called:
            yield "casadi_real iterated = 0, rule;"
        if "loops" in called:
            yield f"{c.prefix}_status closed;"
        yield f"if (model->seal != SEAL) return {P}_NOT_PREPARED;"
        for k, member in enumerate(c.moment if "count" in called else ()):
            yield f"moment[{k}] = {f'inputs->{member}' if member else '0'};"
        for k, (_, rate, acceleration) in enumerate(zip(*c.motion, strict=True)):
            yield f"rate[{k}] = inputs->{rate};"
            yield f"acceleration[{k}] = inputs->{acceleration};"
        given = " + ".join(f"inputs->{m.name}" for m in c.inputs)
        yield f"if (!is_finite({given})) return {P}_BAD_INPUT;"
        for name in called:
            yield from self._close() if name == "loops" else calls.call(name)
            if name == "instant" and table is not None:
                yield from table_call(self.exported)
            if name == "status":
                yield "if (rule > 0) return broken[(int) rule];"
        yield f"if (!all_finite(y, {len(self.exported.columns)})) return {P}_NOT_FINITE;"

    def _close(self) -> Iterable[str]:
        P, rule, number = self._upper, self.exported.rule, self.number
        done, lost, most = number(rule["done"]), number(rule["lost"]), int(rule["steps"])
        if self.exported.newton is not None:
            full = newton_rule(self.contract.precision, None)
            limits = f"{int(full['steps'])}, {number(full['done'])}, {number(full['lost'])}"
            yield (
                f"if (!model->closed && close_loops(model, counted, {limits}) =="
                f" {P}_NOT_CONVERGED) {{"
            )
            yield f"  return {P}_NOT_CONVERGED;"
            yield "}"
            yield "model->closed = 1;"
        yield f"closed = close_loops(model, counted, {most}, {done}, {lost});"
        yield f"if (closed == {P}_NOT_CONVERGED) return closed;"
        if self.exported.newton is None:
            yield f"if (closed == {P}_SLOW) iterated = {number(float(Status.SLOW))};"
