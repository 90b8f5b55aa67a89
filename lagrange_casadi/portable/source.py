"""The header and the source of an exported program, filled in from their templates."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from ..base.quantities import Output
from ..base.status import Status
from ..codegen.emit import newton_rule
from ..codegen.printer import Format, function_name, literal
from ..declare.ends import BEYOND
from ..version import __version__
from .contract import REST, Contract
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
        p, sizes = self.contract.prefix, self.exported.sizes
        sections = functions(self.contract, self.exported) if self.contract.links else ""
        if self.slopes is not None:
            sections += sensitivity(self.contract, self.slopes, sizes["drives"], self.iterated)
        return template(
            "mechanism.c",
            **self.words,
            includes="\n#include <string.h>" if self.exported.cycle is not None else "",
            graph=self.exported.text,
            seal=f"0x{self.identity[:8]}u",
            helpers=self._helpers(),
            put="\n".join(
                f"  outputs->{m.name} = {self._value(m.source)};" for m in self.contract.outputs
            ),
            defaults=self._defaults(),
            given=f", const {p}_parameters* parameters" if self.contract.settings else "",
            time_rest=f", {p}_real time_rest" if self.contract.rests else "",
            prepare=indented(self._prepare()),
            motion=indented(self._motion()),
            instant=indented(self._instant()),
            rows=sizes["rows"],
            sections=sections,
            messages="\n".join(
                f'  case {self._upper}_{key}:\n    return "{text}";'
                for key, text in STATUSES.items()
            ),
        )

    @property
    def _upper(self) -> str:
        return self.contract.prefix.upper()

    @property
    def words(self) -> dict[str, str]:
        """Values of every template."""
        return {
            "name": comment(self.contract.name),
            "called": printed(self.contract.name),
            "p": self.contract.prefix,
            "P": self._upper,
            "space": " " * (2 * len(self.contract.prefix) + 9),
            "version": __version__,
            "casadi": ca.CasadiMeta.version(),
            "scene": self.identity,
        }

    @property
    def fixed(self) -> Mapping[str, float]:
        """The parameters that are no longer open."""
        return {} if self.contract.settings else self.values

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
        return bool(self.exported.sizes["loops"]) and self.exported.cycle is None

    @property
    def model(self) -> list[tuple[str, str, int]]:
        """The members of a model: name, type, where ``real`` is that of the precision, and how many
        of it.
        """
        sizes = self.exported.sizes
        vectors = {"parameters": sizes["p"]} | {
            name: sizes[name] for name in ("constants", "matter", "loops")
        }
        closed = [("closed", "int", 1)] if self.exported.newton is not None else []
        return [
            ("seal", "unsigned", 1),
            *closed,
            *((name, "real", size) for name, size in vectors.items() if size),
        ]

    @property
    def span(self) -> tuple[float, float]:
        """The times [s] that all motions cover."""
        return self.exported.program.laws.span

    def _value(self, source: str) -> str:
        output = Output.of(source)
        if output in self.exported.still:
            return self._number(self.exported.still[output])
        value = f"y[{self.exported.columns.index(output)}]"
        return f"direction({value})" if output in self.exported.program.loop_angles else value

    @property
    def _number(self) -> Format:
        return literal(self.contract.precision)

    def _helpers(self) -> str:
        number, found = self._number, ""
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
                p_values="model->parameters" if self.exported.sizes["p"] else "0",
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
        rows = ",\n".join(f"  {self._number(m.default)} /* {m.name} */" for m in c.settings)
        return f"\nconst {p}_parameters {p}_defaults = {{\n{rows}\n}};\n"

    def _prepare(self) -> Iterable[str]:
        c, P, sizes, number = self.contract, self._upper, self.exported.sizes, self._number
        if c.settings:
            yield (
                f"const {c.prefix}_parameters* values = parameters ? parameters :"
                f" &{c.prefix}_defaults;"
            )
        if sizes["sound"]:
            yield f"casadi_real sound_of[{sizes['sound']}];"
            yield "int k;"
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
        yield f"arg[0] = {self._p};"
        if sizes["sound"]:
            yield "res[0] = sound_of;"
            yield "sound(arg, res);"
            if sizes["positive"]:
                yield f"for (k = 0; k < {sizes['positive']}; ++k) {{"
                yield (
                    f"  if (!(sound_of[k] > 0 && is_finite(sound_of[k]))) return {P}_BAD_PARAMETER;"
                )
                yield "}"
            if sizes["sound"] > sizes["positive"]:
                yield f"for (k = {sizes['positive']}; k < {sizes['sound']}; ++k) {{"
                yield (
                    "  if (!(sound_of[k] >= 0 && is_finite(sound_of[k]))) return"
                    f" {P}_BAD_PARAMETER;"
                )
                yield "}"
        for vector, function in (("constants", "constants_of"), ("matter", "matter")):
            if sizes[vector]:
                yield f"res[0] = model->{vector};"
                yield f"{function}(arg, res);"
        if self.exported.newton is not None:
            yield "model->closed = 0;"
        yield from (f"model->loops[{k}] = {number(value)};" for k, value in enumerate(self.guess))
        if not any(sizes[vector] for vector in ("constants", "matter", "sound")):
            yield "(void) arg;"
            yield "(void) res;"

    @property
    def _p(self) -> str:
        return "model->parameters" if self.exported.sizes["p"] else "0"

    def _motion(self) -> Iterable[str]:
        c, P, drives = self.contract, self._upper, self.exported.sizes["drives"]
        ends = self.exported.functions.get("beyond")
        if drives:
            values = 2 * drives if c.rests else drives
            yield (
                f"casadi_real at[{1 + c.rests}], d[{values}], rate[{drives}],"
                f" acceleration[{drives}];"
            )
            yield "const casadi_real* arg[2];"
            yield "casadi_real* res[3];"
        if ends is not None:
            yield f"casadi_real far[{ends.size1_out(0)}];"
        yield from self._refused("model->seal != SEAL", "NOT_PREPARED")
        yield from self._refused(self._untimely(), "BAD_TIME")
        if drives:
            yield "at[0] = time;"
            if c.rests:
                yield "at[1] = time_rest;"
            yield "arg[0] = at;"
            yield f"arg[1] = {self._p};"
            yield "res[0] = d;"
            yield "res[1] = rate;"
            yield "res[2] = acceleration;"
            yield "law(arg, res);"
        if ends is not None:
            limit = self._number(BEYOND[self.contract.precision])
            yield "res[0] = far;"
            yield "beyond(arg, res);"
            yield from self._refused(
                " || ".join(f"!(far[{k}] <= {limit})" for k in range(ends.size1_out(0))), "BAD_TIME"
            )
        yield from self._driven()
        yield f"return {P}_OK;"

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
        bad += [f"{moment} < {self._number(low)}"] if math.isfinite(low) else []
        bad += [f"{moment} > {self._number(high)}"] if math.isfinite(high) else []
        return " || ".join(bad)

    def _driven(self) -> Iterable[str]:
        """Time, where it counts, and the motion of each drive, put into the inputs."""
        c = self.contract
        if c.timed:
            yield f"inputs->{c.input_of('time')} = time;"
            if c.rests:
                yield f"inputs->{c.input_of(f'{REST}time')} = time_rest;"
        for k, (value, rate, acceleration) in enumerate(zip(*c.motion, strict=True)):
            yield f"inputs->{value} = d[{k}];"
            if c.rests:
                rest = c.input_of(f"{REST}motion:{c.drives[k]}")
                yield f"inputs->{rest} = d[{len(c.drives) + k}];"
            yield f"inputs->{rate} = rate[{k}];"
            yield f"inputs->{acceleration} = acceleration[{k}];"

    def _instant(self) -> Iterable[str]:
        c, P, sizes = self.contract, self._upper, self.exported.sizes
        drives = sizes["drives"]
        yield f"casadi_real moment[{sizes['moment']}], counted[{max(1, sizes['counted'])}];"
        yield f"casadi_real rate[{drives}], acceleration[{drives}];"
        if self.exported.cycle is not None:
            yield f"casadi_real drive[{sizes['evaluated']}];"
        yield "const casadi_real* arg[5];"
        yield "casadi_real* res[1];"
        if "status" in self.exported.functions:
            yield "casadi_real iterated = 0, rule;"
        if self.iterated:
            yield f"{c.prefix}_status closed;"
        yield f"if (model->seal != SEAL) return {P}_NOT_PREPARED;"
        names = ["time", *(str(Output("motion", drive)) for drive in c.drives)]
        names += [f"{REST}{name}" for name in names] if c.rests else []
        for k, name in enumerate(names):
            known = "motion:" in name or c.timed
            yield f"moment[{k}] = {f'inputs->{c.input_of(name)}' if known else '0'};"
        for k, (_, rate, acceleration) in enumerate(zip(*c.motion, strict=True)):
            yield f"rate[{k}] = inputs->{rate};"
            yield f"acceleration[{k}] = inputs->{acceleration};"
        given = " + ".join(f"inputs->{m.name}" for m in c.inputs)
        yield f"if (!is_finite({given})) return {P}_BAD_INPUT;"
        yield "arg[0] = moment;"
        yield f"arg[1] = {self._p};"
        if sizes["counted"]:
            yield "res[0] = counted;"
            yield "count(arg, res);"
        if self.iterated:
            yield from self._close()
        yield "arg[0] = counted;"
        yield "arg[1] = rate;"
        yield "arg[2] = acceleration;"
        yield f"arg[3] = {'model->loops' if self.iterated else '0'};"
        yield f"arg[4] = {'model->constants' if sizes['constants'] else '0'};"
        yield f"res[0] = {'y' if self.exported.cycle is None else 'drive'};"
        yield "instant(arg, res);"
        if self.exported.cycle is not None:
            yield from table_call(self.exported)
        yield from self._verdict()

    def _close(self) -> Iterable[str]:
        P, rule, number = self._upper, self.exported.rule, self._number
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

    def _verdict(self) -> Iterable[str]:
        """Answer for a broken rule of the scene's status, and for a value that is not finite."""
        P, sizes = self._upper, self.exported.sizes
        if "status" in self.exported.functions:
            yield "arg[0] = y;"
            yield f"arg[1] = {'model->matter' if sizes['gapped'] else '0'};"
            yield "arg[2] = &iterated;"
            yield "res[0] = &rule;"
            yield "status(arg, res);"
            yield "if (rule > 0) return broken[(int) rule];"
        yield f"if (!all_finite(y, {len(self.exported.columns)})) return {P}_NOT_FINITE;"
