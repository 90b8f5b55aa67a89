"""Structured text of IEC 61131-3: function blocks of a scene and of its motion, and a program that
tests them against golden vectors.
"""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field

import casadi as ca
import numpy as np

from ..arithmetic.interpret import INFIX, operation_name, steps
from ..arithmetic.lookups import Lookup
from ..base.quantities import Output
from ..base.status import Status
from ..errors import DeclarationError
from ..portable.source import Source
from ..portable.text import indented, template

_ONE = {
    **{name: name.upper() for name in ("sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "exp")},
    "fabs": "ABS",
    "log": "LN",
    "floor": "LC_FLOOR",
    "ceil": "LC_CEIL",
}
_TWO = {"pow": "EXPT", "constpow": "EXPT", "fmin": "MIN", "fmax": "MAX"}
_TWO |= {name: f"LC_{name.upper()}" for name in ("atan2", "fmod", "remainder", "copysign")}
_WRITTEN = {
    **{getattr(ca, f"OP_{name.upper()}"): f"{own}({{0}})" for name, own in _ONE.items()},
    **{getattr(ca, f"OP_{name.upper()}"): f"{own}({{0}}, {{1}})" for name, own in _TWO.items()},
    **INFIX,
    ca.OP_INV: "1.0 / {0}",
    ca.OP_HYPOT: "SQRT({0} * {0} + {1} * {1})",
    ca.OP_LT: "SEL({0} < {1}, 0.0, 1.0)",
    ca.OP_LE: "SEL({0} <= {1}, 0.0, 1.0)",
    ca.OP_EQ: "SEL({0} = {1}, 0.0, 1.0)",
    ca.OP_NE: "SEL({0} <> {1}, 0.0, 1.0)",
    ca.OP_NOT: "SEL({0} = 0.0, 0.0, 1.0)",
    ca.OP_AND: "SEL({0} <> 0.0 AND {1} <> 0.0, 0.0, 1.0)",
    ca.OP_OR: "SEL({0} <> 0.0 OR {1} <> 0.0, 0.0, 1.0)",
    ca.OP_SIGN: "SEL({0} > 0.0, SEL({0} < 0.0, {0}, -1.0), 1.0)",
    ca.OP_IF_ELSE_ZERO: "SEL({0} <> 0.0, 0.0, {1})",
}

_FINITE = ("IF NOT (y[n] - y[n] = 0.0) THEN", "valid := FALSE;", "END_IF;")

_LEAST = 1e-37
"""Outputs below it are compared with zero: matiec reads numbers of LREAL in the range of REAL."""


def structured_text(source: Source) -> dict[str, str]:
    """Return the file ``<prefix>.st`` of a scene, for the parameters of the export.

    Raises :class:`.DeclarationError` for what the language lacks: single precision, a table of the
    cycle, a function that has no name in it.
    """
    c = source.contract
    if c.rests or source.exported.cycle is not None:
        raise DeclarationError("structured text: expected double precision and no table")
    given = _identifiers("in", (m.name for m in c.inputs))
    taken = _identifiers("out", (m.name for m in c.outputs))
    called = {m.name: name for m, name in zip(c.inputs, given, strict=True)}
    time = called[c.input_of("time")] if c.timed else "0.0"
    moved = [[called[member] for member in members] for members in c.motion]
    instant, drive = _Block(source, time, moved), _Block(source, time, moved)
    body, motion = list(instant.instant()), list(drive.motion())
    outputs = []
    for name, m in zip(taken, c.outputs, strict=True):
        value = f"y[{source.exported.columns.index(Output.of(m.source))}]"
        outputs.append(f"  {name} := {f'LC_DIRECTION({value})' if m.wrapped else value};")
    words = {
        "name": re.sub(r"[^ -~]|\(\*|\*\)", "?", c.name),
        "block": _identifiers("mechanism", [c.prefix])[0],
        "version": source.words["version"],
        "scene": source.identity,
        "inputs": indented(f"{name} : LREAL;" for name in given),
        "outputs": indented(f"{name} : LREAL;" for name in taken),
        "columns": len(source.exported.columns) - 1,
        "finite": "\n".join(_loop("n", 0, len(source.exported.columns) - 1, _FINITE)),
        "registers": indented(instant.declared()),
        "motion_registers": indented(drive.declared()),
        "body": "\n".join(body),
        "motion": "\n".join(motion),
        "taken": "\n".join(outputs),
    }
    words |= _test(source, given, taken)
    return {f"{c.prefix}.st": template("structured.st", **words)}


@dataclass(eq=False)
class _Block:
    """A function block under way: the names of the time and of coordinates, rates and
    accelerations, its arrays by their sizes, and its tables.
    """

    source: Source
    time: str
    moved: list[list[str]]
    arrays: dict[str, int] = field(default_factory=dict)
    tables: dict[str, Sequence[float]] = field(default_factory=dict)

    def declared(self) -> Iterator[str]:
        """Yield declarations of variables."""
        for name, size in self.arrays.items():
            start = f" := [{', '.join(map(_number, self.source.guess))}]" if name == "z" else ""
            yield f"{name} : ARRAY[0..{max(size, 1) - 1}] OF LREAL{start};"
        if "z" in self.arrays:
            yield from ("k : DINT;", "size : LREAL;", "before : LREAL;")
        for name, numbers in self.tables.items():
            yield from _table(name, numbers)

    def array(self, name: str, size: int) -> list[str]:
        """Declare an array; return its elements."""
        self.arrays[name] = size
        return [f"{name}[{k}]" for k in range(size)]

    def motion(self) -> Iterator[str]:
        """Yield the statements of the scene's motion at t."""
        law = self.source.exported.functions["law"]
        yield from self.lines(law, [["t"], self.parameters()], self.moved)
        if self.source.contract.timed:
            yield f"{self.time} := t;"

    def instant(self) -> Iterator[str]:
        """Yield the statements of an instant, up to whether it is valid."""
        exported, (coordinates, *rates) = self.source.exported, self.moved
        functions, sizes = exported.functions, exported.sizes
        counted = self.array("counted", sizes["counted"])
        if counted:
            given = [[self.time, *coordinates], self.parameters()]
            yield from self.lines(functions["count"], given, [counted])
        z: list[str] = []
        yield from ("iterated := 0.0;", "valid := TRUE;")
        if self.source.iterated:
            z = self.array("w", sizes["loops"])
            yield from self.closing(z, counted)
        columns = [f"y[{k}]" for k in range(sizes["evaluated"])]
        given = [counted, *rates, z, self.fixed("constants_of")]
        yield from self.lines(functions["instant"], given, [columns])
        if "status" in functions:
            rows = [f"y[{k}]" for k in range(len(exported.columns))]
            given = [rows, self.fixed("matter")[: sizes["gapped"]], ["iterated"]]
            yield from self.lines(functions["status"], given, [["rule"]])
            allowed = [k for k, answer in enumerate(self.source.answers()) if answer == "OK"]
            tests = " OR ".join(f"rule = {_number(float(k))}" for k in allowed)
            yield f"valid := valid AND ({tests});"

    def closing(self, z: Sequence[str], counted: Sequence[str]) -> Iterator[str]:
        """Yield the statements that close loops from where they stood."""
        exported, newton = self.source.exported, self.source.exported.program.newton
        assert newton is not None
        stood, c, turn = self.array("z", len(z)), self.array("c", len(z)), _number(math.tau)
        step, given = exported.functions["loops"], [z, counted, self.parameters()]
        moved = [f"{now} := {now} + {more};" for now, more in zip(z, c, strict=True)]
        whole = [
            f" - {turn} * LC_FLOOR({now} / {turn} + 0.5)" if turning else ""
            for now, turning in zip(z, newton.turning, strict=True)
        ]
        rule = {key: _number(float(value)) for key, value in exported.rule.items()}
        body = [f"IF NOT (size < {rule['done']}) THEN", "before := size;"]
        body += [*self.lines(step, given, [c, ["size"]], within="k"), *moved, "END_IF;"]
        yield template(
            "structured_loops.st",
            **rule,
            begin="\n".join(f"{now} := {then};" for now, then in zip(z, stood, strict=True)),
            iterate="\n".join(_loop("n", 1, int(exported.rule["steps"]), body)),
            keep="\n".join(map("{} := {}{};".format, stood, z, whole)),
            slow=_number(float(Status.SLOW)),
        ).rstrip()

    def parameters(self) -> list[str]:
        """Return the parameters as numbers."""
        return [_number(value) for value in self.source.values.values()]

    def fixed(self, name: str) -> list[str]:
        """Return what a function of parameters alone gives, as numbers."""
        function = self.source.exported.functions.get(name)
        if function is None:
            return []
        values = function(list(self.source.values.values()))
        return [_number(float(x)) for x in np.ravel(values.full())]

    def lines(
        self,
        function: ca.Function,
        inputs: Sequence[Sequence[str]],
        outputs: Sequence[Sequence[str]],
        within: str = "n",
    ) -> Iterator[str]:
        """Yield the instructions of a function, one statement each; ``within`` counts in tables."""
        computed = [step for step in steps(function) if step.operation != ca.OP_OUTPUT]
        size = 1 + max(step.results[0] for step in computed)
        self.arrays["a"] = max(size, self.arrays.get("a", 0))
        for step in steps(function):
            target, given = f"a[{step.results[0]}]", [f"a[{place}]" for place in step.arguments]
            if step.looked_up is not None:
                yield from self.looked_up(target, given[0], step.looked_up, within)
                continue
            if step.operation == ca.OP_OUTPUT:
                i, k = step.results
                target, value = outputs[i][k], given[0]
            elif step.operation == ca.OP_INPUT:
                i, k = step.arguments
                value = inputs[i][k]
            elif step.operation == ca.OP_CONST:
                value = _number(step.constant)
            elif step.operation in _WRITTEN:
                value = _WRITTEN[step.operation].format(*given)
            else:
                raise DeclarationError(
                    f"structured text has no word for {operation_name(step.operation)}, which the"
                    " scene needs"
                )
            yield f"{target} := {value};"

    def looked_up(self, target: str, given: str, table: Lookup, counter: str) -> Iterator[str]:
        """Yield statements that look a number up: its entry, or by counting its cell."""
        cell = table.kind == "cell"
        numbers = (table.numbers[1:-1] if cell else table.numbers).tolist()
        name = next((one for one, held in self.tables.items() if held == numbers), "")
        name = name or f"table_{len(self.tables)}"
        self.tables[name] = numbers
        if not cell:
            yield f"{target} := {name}[LREAL_TO_DINT({given})];"
            return
        yield from (f"x := {given};", f"{target} := 0.0;")
        test = [f"IF {name}[{counter}] <= x THEN", f"{target} := {target} + 1.0;", "END_IF;"]
        yield from _loop(counter, 0, len(numbers) - 1, test)


def _table(name: str, numbers: Iterable[float]) -> Iterator[str]:
    """Yield the declaration of an array of numbers."""
    texts = [_number(float(one)) for one in numbers]
    yield f"{name} : ARRAY[0..{len(texts) - 1}] OF LREAL := ["
    rows = (", ".join(texts[k : k + 6]) for k in range(0, len(texts), 6))
    yield ",\n    ".join(f"  {row}" for row in rows) + "];"


def _loop(counter: str, first: int, last: int, body: Sequence[str]) -> list[str]:
    """Return a loop; of one turn its body alone, which matiec would leave out."""
    head = f"FOR {counter} := {first} TO {last} DO"
    return [f"{counter} := {first};", *body] if last == first else [head, *body, "END_FOR;"]


def _test(source: Source, given: Sequence[str], taken: Sequence[str]) -> dict[str, str]:
    """Return words of a program that follows the motion and compares outputs at golden instants."""
    g, c, count = source.golden, source.contract, len(taken)
    numbers = np.where(np.abs(g.outputs) > _LEAST, g.outputs, 0.0)
    inputs = ", ".join(f"{name} := drive.{name}" for name in given)
    share = f"DINT_TO_LREAL(n) / {_number(float(g.steps))}"
    step = f"t := SEL(n = {g.steps}, before + {share} * (times[k] - before), times[k]);"
    body = [step, "drive(t := t);", f"unit({inputs});"]
    body = [*_loop("n", 1, g.steps, body), "before := t;"]
    body += ["IF NOT unit.valid THEN", "failed := failed + 1;", "END_IF;"]
    for j, (name, m) in enumerate(zip(taken, c.outputs, strict=True)):
        gap = f"unit.{name} - golden[k * {count} + {j}]"
        gap = f"LC_DIRECTION({gap})" if m.wrapped else gap
        off = _number(max(float(g.outputs_off[j]), _LEAST))
        body += [f"IF NOT (ABS({gap}) <= {off}) THEN", "failed := failed + 1;", "END_IF;"]
    return {
        "start": _number(float(g.times[0])),
        "golden": indented([*_table("times", g.times), *_table("golden", numbers.ravel())]),
        "test": "\n".join(_loop("k", 0, g.times.size - 1, body)),
    }


def _number(value: float) -> str:
    """Return a number of LREAL."""
    if math.isnan(value):
        raise DeclarationError("structured text has no number for NaN, which the scene needs")
    value = max(-1.7976931348623157e308, min(value, 1.7976931348623157e308))
    mantissa, _, power = f"{value:.17g}".partition("e")
    mantissa += "" if "." in mantissa else ".0"
    return f"{mantissa}E{power}" if power else mantissa


def _identifiers(first: str, names: Iterable[str]) -> list[str]:
    """Return names that differ where capitals do not count; with a first word none is the
    language's.
    """
    found: dict[str, str] = {}
    for name in names:
        plain = re.sub("_+", "_", f"{first}_{name}").rstrip("_")
        tries = itertools.chain([plain], (f"{plain}_{k}" for k in itertools.count(2)))
        chosen = next(one for one in tries if one.lower() not in found)
        found[chosen.lower()] = chosen
    return list(found.values())
