"""The statements of C around the functions of an exported program: what prepares a model, moves its
drives, and evaluates an instant.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from ...base.quantities import Output
from ...base.status import Status
from ...engine.codegen.emit import newton_rule
from ...engine.codegen.printer import function_name
from ...engine.codegen.reduction import centre
from ...engine.dead_centres import POINTS
from ...model.beyond_ends import BEYOND
from .contract import Contract
from .data import table_call, table_text
from .exported_calls import INSTANT, MODEL, PREPARE, call, given
from .exported_program import ExportedProgram
from .text import indented, template


@dataclass(frozen=True, eq=False)
class Statements:
    """Writer of the statements of a program; iterated loops begin at a ``guess``."""

    contract: Contract
    exported: ExportedProgram
    guess: Sequence[float]

    def put(self) -> Iterator[str]:
        """Yield what fills the outputs from the columns."""
        for m in self.contract.outputs:
            still = self.exported.still.get(Output.of(m.source))
            if still is not None:
                value = self.exported.number(still)
            else:
                value = self.exported.column(m.source)
                value = f"direction({value})" if m.wrapped else value
            yield f"outputs->{m.name} = {value};"

    def helpers(self) -> str:
        """Return what the functions share: a function of angles, one that closes loops, tables."""
        c, number, found = self.contract, self.exported.number, ""
        if self.exported.program.loop_angles:
            turn = number(math.tau)
            found += (
                "\n/* An angle without its whole turns, in (-pi, pi]. */\nstatic casadi_real"
                " direction(casadi_real angle) {\n  return angle -"
                f" {turn}*{function_name('ceil', c.precision)}(angle/{turn} -"
                f" {number(0.5)});\n}}\n"
            )
        if "loops" in self.exported.functions:
            newton = self.exported.program.newton
            rule = newton_rule(c.precision, self.exported.newton)
            assert newton is not None
            found += template(
                "loops.c",
                **c.words,
                nz=self.exported.sizes["loops"],
                turning=", ".join(str(int(turning)) for turning in newton.turning),
                turn=number(math.tau),
                inverse=number(1.0 / math.tau),
                half=number(0.5),
                floor=function_name("floor", c.precision),
                rate=number(rule["rate"]),
                rounding=number(rule["rounding"]),
                given=indented(given(self.exported.functions, "loops")),
            )
        if "status" in self.exported.functions:
            names = ", ".join(f"{c.words['P']}_{name}" for name in self.exported.answers())
            kind = f"static const {c.prefix}_status"
            found += (
                f"\n/* What a broken rule says, by its number. */\n{kind} broken[] = {{{names}}};\n"
            )
        return found + table_text(self.exported)

    def between(self) -> str:
        """Return the function of what is between two instants, with what it calls; nothing where no
        loop has a dead centre.
        """
        c, sizes, number = self.contract, self.exported.sizes, self.exported.number
        if "closing" not in self.exported.functions:
            return ""
        loops, drives = sizes["loops"], len(c.drives)
        return template(
            "between.c",
            **c.words,
            many=sizes["squares"],
            limits=", ".join(map(number, self.exported.zeros)),
            moment=max(1, sizes["moment"]),
            counted=max(1, sizes["counted"]),
            drives=drives,
            kept=f"  casadi_real kept[{loops}];\n" if loops else "",
            given=indented(self._between()),
            slopes=1 + drives,
            all=sizes["slopes"],
            points=POINTS,
            rule=centre(1 + drives),
            sum=" + ".join(f"{at}->{m.name}" for at in ("before", "after") for m in c.inputs),
        )

    def _between(self) -> Iterator[str]:
        """Yield the statements that evaluate ``closing`` at a fraction x of a step."""
        c, functions = self.contract, self.exported.functions
        model = {name: f"step->model->{name}" for name in MODEL}
        half = len(c.moment) // 2 if c.rests else len(c.moment)
        for k, member in enumerate(c.moment[:half]):
            rest = c.moment[half + k] if c.rests else ""
            if k == 0:
                yield "gone = x*h;"
            else:
                coordinate, v, a = (names[k - 1] for names in c.motion)
                change = " + ".join(f"(after->{m} - before->{m})" for m in (coordinate, rest) if m)
                yield (
                    f"gone = come(x, h, {change}, before->{v}, after->{v}, before->{a}, after->{a},"
                    f" rate + {k - 1}, acceleration + {k - 1});"
                )
            yield f"moment[{k}] = {f'before->{member} + gone' if member else '0'};"
            if c.rests:
                left = f"(before->{member} - moment[{k}]) + gone + before->{rest}"
                yield f"moment[{half + k}] = {left if member else '0'};"
        if "count" in functions:
            yield from call(functions, "count", **model)
        if "loops" in functions:
            words = {"nz": self.exported.sizes["loops"], "limits": self._limits(None)}
            yield template("between_loops.c", **c.words, **words).rstrip()
        yield from call(functions, "closing", **model)
        if "loops" in functions:
            yield f"for (k = 0; k < {words['nz']}; ++k) step->model->loops[k] = kept[k];"

    def _limits(self, newton: int | None) -> str:
        """Return the steps, and what done and lost mean, of so many Newton steps, or of all."""
        rule, number = newton_rule(self.contract.precision, newton), self.exported.number
        return f"{int(rule['steps'])}, {number(rule['done'])}, {number(rule['lost'])}"

    def defaults(self) -> str:
        """Return the constant with the default parameters."""
        c, p = self.contract, self.contract.prefix
        if not c.settings:
            return ""
        rows = ",\n".join(f"  {self.exported.number(m.default)} /* {m.name} */" for m in c.settings)
        return f"\nconst {p}_parameters {p}_defaults = {{\n{rows}\n}};\n"

    def prepare(self) -> Iterator[str]:
        """Yield what checks parameters, and computes what they alone set."""
        c, sizes, number = self.contract, self.exported.sizes, self.exported.number
        functions, called = self.exported.functions, self.exported.called(PREPARE)
        if c.settings:
            values = f"parameters ? parameters : &{c.prefix}_defaults"
            yield f"const {c.prefix}_parameters* values = {values};"
        if sizes["sound_of"]:
            yield f"casadi_real sound_of[{sizes['sound_of']}];\nint k;"
        if called:
            yield "const casadi_real* arg[1];\ncasadi_real* res[1];"
        yield "model->seal = 0;"
        for k, m in enumerate(c.settings):
            value = f"values->{m.name}"
            ends = self._ends(value, (">=", m.low), ("<=", m.high))
            within = " && ".join([f"is_finite({value})", *ends])
            yield f"if (!({within})) return {c.words['P']}_BAD_PARAMETER;"
            yield f"model->parameters[{k}] = {value};"
        for name in called:
            yield from call(functions, name)
            if name == "sound":
                yield from self._refused_parts()
        if self.exported.newton is not None:
            yield "model->closed = 0;"
        yield from (f"model->loops[{k}] = {number(value)};" for k, value in enumerate(self.guess))

    def _refused_parts(self) -> Iterator[str]:
        """Refuse parameters for which a margin is not positive, or a later one negative."""
        ends = (0, self.exported.positive, self.exported.sizes["sound_of"])
        for (start, stop), test in zip(itertools.pairwise(ends), (">", ">="), strict=True):
            if stop > start:
                yield template(
                    "sound.c", **self.contract.words, start=start, stop=stop, test=test
                ).rstrip()

    def motion(self) -> Iterator[str]:
        """Yield what fills the inputs with the motion of the drives at a time."""
        c, functions, drives = self.contract, self.exported.functions, len(self.contract.drives)
        at = ["time", "time_rest"] if c.rests else ["time"]
        vectors = f"at[{len(at)}], d[{len(at) * drives}], rate[{drives}], acceleration[{drives}]"
        yield f"casadi_real {vectors};\nconst casadi_real* arg[2];\ncasadi_real* res[3];"
        if (ends := functions.get("beyond")) is not None:
            yield f"casadi_real far[{ends.size1_out(0)}];"
        yield self._refused("model->seal != SEAL", "NOT_PREPARED")
        time, (low, high) = " + ".join(at), self.exported.program.laws.span
        untimely = [f"!is_finite({time})", *self._ends(time, ("<", low), (">", high))]
        yield self._refused(" || ".join(untimely), "BAD_TIME")
        yield from (f"at[{k}] = {one};" for k, one in enumerate(at))
        yield from call(functions, "law")
        if ends is not None:
            yield from call(functions, "beyond")
            limit = self.exported.number(BEYOND[c.precision])
            far = (f"!(far[{k}] <= {limit})" for k in range(ends.size1_out(0)))
            yield self._refused(" || ".join(far), "BAD_TIME")
        moment = (
            value
            for i, one in enumerate(at)
            for value in (one, *(f"d[{i * drives + k}]" for k in range(drives)))
        )
        values = dict(zip(c.moment, moment, strict=True))
        for vector, members in zip(("rate", "acceleration"), c.motion[1:], strict=True):
            values |= {member: f"{vector}[{k}]" for k, member in enumerate(members)}
        yield from (f"inputs->{m.name} = {values[m.name]};" for m in c.inputs)
        yield f"return {c.words['P']}_OK;"

    def _refused(self, condition: str, status: str) -> str:
        """Return what gives nothing but a status, where a condition holds."""
        nothing = indented(f"inputs->{m.name} = nothing;" for m in self.contract.inputs)
        return f"if ({condition}) {{\n{nothing}\n  return {self.contract.words['P']}_{status};\n}}"

    def _ends(self, value: str, *ends: tuple[str, float]) -> Iterator[str]:
        """Yield how a value is compared with those ends of a range that are finite."""
        for sign, end in ends:
            if math.isfinite(end):
                yield f"{value} {sign} {self.exported.number(end)}"

    def instant(self) -> Iterator[str]:
        """Yield what computes the columns of an instant, and refuses those that break a rule."""
        c, P = self.contract, self.contract.words["P"]
        sizes, table = self.exported.sizes, self.exported.cycle
        drives, called = len(c.drives), self.exported.called(INSTANT)
        functions, pointers = self.exported.functions, {"evaluated": "drive" if table else "y"}
        if "count" in called:
            yield f"casadi_real moment[{sizes['moment']}], counted[{sizes['counted']}];"
        yield f"casadi_real rate[{drives}], acceleration[{drives}];"
        if table is not None:
            yield f"casadi_real drive[{sizes['evaluated']}];"
        yield "const casadi_real* arg[5];\ncasadi_real* res[1];"
        if "status" in called:
            yield "casadi_real iterated = 0, rule;"
        if "loops" in called:
            yield f"{c.prefix}_status closed;"
        yield f"if (model->seal != SEAL) return {P}_NOT_PREPARED;"
        for k, member in enumerate(c.moment if "count" in called else ()):
            yield f"moment[{k}] = {f'inputs->{member}' if member else '0'};"
        for k, (_, rate, acceleration) in enumerate(zip(*c.motion, strict=True)):
            yield f"rate[{k}] = inputs->{rate};\nacceleration[{k}] = inputs->{acceleration};"
        total = " + ".join(f"inputs->{m.name}" for m in c.inputs)
        yield f"if (!is_finite({total})) return {P}_BAD_INPUT;"
        for name in called:
            yield from self._close() if name == "loops" else call(functions, name, **pointers)
            if name == "instant" and table is not None:
                yield from table_call(table, self.exported.number)
            if name == "status":
                yield "if (rule > 0) return broken[(int) rule];"
        yield f"if (!all_finite(y, {len(self.exported.columns)})) return {P}_NOT_FINITE;"

    def _close(self) -> Iterator[str]:
        """Yield what closes loops: by all steps that these want, or first so and then by a few."""
        P, newton = self.contract.words["P"], self.exported.newton
        if newton is not None:
            yield template("close_first.c", P=P, limits=self._limits(None)).rstrip()
        yield f"closed = close_loops(model, counted, {self._limits(newton)});"
        yield f"if (closed == {P}_NOT_CONVERGED) return closed;"
        if newton is None:
            slow = self.exported.number(float(Status.SLOW))
            yield f"if (closed == {P}_SLOW) iterated = {slow};"
