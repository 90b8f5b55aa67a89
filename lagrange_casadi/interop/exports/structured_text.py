"""Structured text of IEC 61131-3: function blocks of a scene and of its motion, and a program that
tests them against golden vectors.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence

import casadi as ca
import numpy as np

from ...base.interpret import INFIX, codes, operation_name, steps
from ...base.lookups import Lookup
from ...base.status import Status
from ...engine.codegen.emit import NEWTON_STEPS, newton_rule
from ...engine.dead_centres import FAR, POINTS, ROUNDS, TOUCHES
from ...errors import DeclarationError
from ..portable.contract import Member
from ..portable.exported_calls import CALLS, INSTANT, PREPARE
from ..portable.naming import distinct
from ..portable.source import Source
from ..portable.text import indented, template

_WRITTEN_HERE = "FLOOR CEIL ATAN2 FMOD REMAINDER COPYSIGN"
_LIBRARY = {
    **codes("SQRT SIN COS TAN ASIN ACOS ATAN EXP"),
    **{code: f"LC_{name}" for code, name in codes(_WRITTEN_HERE).items()},
    **dict.fromkeys((ca.OP_POW, ca.OP_CONSTPOW), "EXPT"),
    ca.OP_FABS: "ABS",
    ca.OP_LOG: "LN",
    ca.OP_FMIN: "MIN",
    ca.OP_FMAX: "MAX",
}
_WRITTEN = {
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
    c, exported, golden = source.contract, source.exported, source.golden
    if c.rests or exported.cycle is not None:
        raise DeclarationError("structured text: expected double precision and no table")
    given = _identifiers("in", (m.name for m in c.inputs))
    taken = _identifiers("out", (m.name for m in c.outputs))
    instant, motion = _Block(source, given), _Block(source, given)
    body, moved = list(instant.instant()), list(motion.call("law"))
    between = list(instant.between())
    moved += [f"{given[c.moment[0]]} := t;"] if c.timed else []
    last = len(exported.columns) - 1
    outputs = np.where(np.abs(golden.outputs) > _LEAST, golden.outputs, 0.0)
    filled = (f"{taken[m.name]} := {_turned(m, exported.column(m.source))};" for m in c.outputs)
    words = source.words | {
        "name": re.sub(r"[^ -~]|\(\*|\*\)", "?", c.name),
        "block": _identifiers("mechanism", [c.prefix])[c.prefix],
        "inputs": indented(f"{name} : LREAL;" for name in given.values()),
        "outputs": indented(f"{name} : LREAL;" for name in taken.values()),
        "columns": last,
        "finite": "\n".join(_loop("n", 0, last, _FINITE)),
        "registers": indented(instant.declared()),
        "motion_registers": indented(motion.declared()),
        "body": "\n".join(body),
        "between": "\n".join(between),
        "motion": "\n".join(moved),
        "taken": indented(filled),
        "start": _number(golden.times[0]),
        "golden": indented([*_table("times", golden.times), *_table("golden", outputs.ravel())]),
        "test": "\n".join(_test(source, given, taken)),
    }
    return {f"{c.prefix}.st": template("structured.st", **words)}


class _Block:
    """A function block under way: the elements of vectors that functions take and fill, its arrays
    by their sizes, and the names of its tables. Its inputs are named as they are ``given``, and
    parameters are numbers.
    """

    def __init__(self, source: Source, given: Mapping[str, str]) -> None:
        self.source = source
        c, exported = source.contract, source.exported
        self.arrays: dict[str, int] = {}
        self.tables: dict[tuple[float, ...], str] = {}
        self.vectors = {name: [name] for name in ("size", "iterated", "rule")} | {"at": ["t"]}
        self.vectors["moment"] = [given.get(member, "0.0") for member in c.moment]
        for name, members in zip(("d", "rate", "acceleration"), c.motion, strict=True):
            self.vectors[name] = [given[member] for member in members]
        self.vectors["parameters"] = [_number(value) for value in source.p]
        for name in exported.called(PREPARE):
            found = np.ravel(exported.functions[name](source.p).full())
            self.vectors[CALLS[name].fills[0]] = [_number(value) for value in found]
        y = [f"y[{k}]" for k in range(len(exported.columns))]
        self.vectors |= {"y": y, "evaluated": y}

    def declared(self) -> Iterator[str]:
        """Yield declarations of variables."""
        for name, size in self.arrays.items():
            start = (
                f" := [{', '.join(map(_number, self.source.exported.guess))}]"
                if name == "z"
                else ""
            )
            yield f"{name} : ARRAY[0..{size - 1}] OF LREAL{start};"
        if "z" in self.arrays:
            yield "k : DINT;\nsize : LREAL;\nbefore : LREAL;"
        if "square" in self.arrays:
            zeros = [_number(zero) for zero in self.source.exported.zeros]
            yield template(
                "structured_registers.st", last=len(zeros) - 1, zeros=", ".join(zeros)
            ).rstrip()
        for numbers, name in self.tables.items():
            yield from _table(name, numbers)

    def array(self, name: str, size: int) -> list[str]:
        """Declare an array, and a vector of its name; return its elements."""
        self.arrays[name] = size
        return self.vectors.setdefault(name, [f"{name}[{k}]" for k in range(size)])

    def instant(self) -> Iterator[str]:
        """Yield the statements of an instant, up to whether it is valid."""
        exported = self.source.exported
        self.array("counted", exported.sizes["counted"])
        for name in exported.called(INSTANT):
            yield from self.closing() if name == "loops" else self.call(name)
            if name == "count":
                yield from ("iterated := 0.0;", "valid := TRUE;")
            elif name == "status":
                allowed = (k for k, answer in enumerate(exported.answers()) if answer == "OK")
                tests = " OR ".join(f"rule = {_number(k)}" for k in allowed)
                yield f"valid := valid AND ({tests});"

    def closing(self) -> Iterator[str]:
        """Yield the statements that close loops from where they stood."""
        exported, newton = self.source.exported, self.source.exported.program.newton
        assert newton is not None
        z, stood, c = (self.array(name, exported.sizes["loops"]) for name in ("w", "z", "c"))
        self.vectors |= {"z": z, "loops": z, "correction": c, "kept": stood}
        turn, rule = _number(math.tau), newton_rule("double", exported.newton)
        words = {key: _number(x) for key, x in rule.items()}
        whole = [
            f" - {turn} * LC_FLOOR({now} / {turn} + 0.5)" if turning else ""
            for now, turning in zip(z, newton.turning, strict=True)
        ]
        step = ["before := size;", *self.step()]
        yield template(
            "structured_loops.st",
            **words,
            begin="\n".join(map("{} := {};".format, z, stood)),
            iterate="\n".join(_iterated("n", int(rule["steps"]), words["done"], step)),
            keep="\n".join(map("{} := {}{};".format, stood, z, whole)),
            slow=_number(Status.SLOW),
        ).rstrip()

    def between(self) -> Iterator[str]:
        """Yield the statements that look for a dead centre on the straight way from the last
        instant that was valid; none where no loop has one.
        """
        exported, moment = self.source.exported, self.vectors["moment"]
        if not self.source.closing:
            return
        sizes, many, drives = exported.sizes, len(exported.zeros), len(self.vectors["rate"])
        stood, place, gone = (self.array(name, len(moment)) for name in ("stood", "place", "gone"))
        for name in ("squares", "rates", "slopes"):
            self.array(name, sizes[name])
        for name, size in (("part", 1), ("square", 1), ("rate", 1), ("slope", 1 + drives)):
            self.arrays[name] = POINTS * size
        own = self.vectors
        self.vectors = own | {"moment": place, "rate": gone[1:], "acceleration": ["0.0"] * drives}
        count = self.call("count") if "count" in exported.functions else ()
        words = {
            "gone": "\n".join(map("{0} := {1} - {2};".format, gone, moment, stood)),
            "place": "\n".join(map("{0} := {1} + part[j] * {2};".format, place, stood, gone)),
            "count": "\n".join(count),
            "close": "",
            "lost": "",
        }
        if "loops" in exported.functions:
            done = _number(newton_rule("double", None)["done"])
            close = [*map("{} := {};".format, own["z"], own["kept"]), "size := 1.0;"]
            words["close"] = "\n".join(close + _iterated("m", NEWTON_STEPS, done, self.step()))
            words["lost"] = f"IF NOT (size < {done}) THEN\nsquare[j] := 0.0;\nEND_IF;"
        words["closing"] = "\n".join(self.call("closing"))
        self.vectors = own
        each = template(
            "structured_centre.st",
            **words,
            rounds=ROUNDS,
            end=POINTS - 1,
            far=_number(FAR),
            low=_number(TOUCHES[0]),
            high=_number(TOUCHES[1]),
            drives=drives,
            slopes=1 + drives,
        )
        lines = [line for line in each.splitlines() if line]
        yield template(
            "structured_between.st",
            loops="\n".join(_loop("which", 0, many - 1, lines)),
            keep="\n".join(map("{} := {};".format, stood, moment)),
        ).rstrip()

    def step(self) -> list[str]:
        """Return the statements of a step that closes loops."""
        changes = map("{0} := {0} + {1};".format, self.vectors["z"], self.vectors["correction"])
        return [*self.call("loops", within="k"), *changes]

    def call(self, name: str, within: str = "n") -> Iterator[str]:
        """Yield the instructions of a function, one statement each; ``within`` counts in tables."""
        function, called = self.source.exported.functions[name], CALLS[name]
        written = {step.results[0] for step in steps(function) if step.operation != ca.OP_OUTPUT}
        self.arrays["a"] = max(1 + max(written), self.arrays.get("a", 0))
        for step in steps(function):
            target, given = f"a[{step.results[0]}]", [f"a[{place}]" for place in step.arguments]
            if step.looked_up is not None:
                yield from self.looked_up(target, given[0], step.looked_up, within)
                continue
            if step.operation == ca.OP_OUTPUT:
                i, k = step.results
                target, value = self.vectors[called.fills[i]][k], given[0]
            elif step.operation == ca.OP_INPUT:
                i, k = step.arguments
                value = self.vectors[called.takes[i]][k]
            elif step.operation == ca.OP_CONST:
                value = _number(step.constant)
            elif step.operation in _LIBRARY:
                value = f"{_LIBRARY[step.operation]}({', '.join(given)})"
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
        numbers = tuple((table.numbers[1:-1] if cell else table.numbers).tolist())
        name = self.tables.setdefault(numbers, f"table_{len(self.tables)}")
        if not cell:
            yield f"{target} := {name}[LREAL_TO_DINT({given})];"
            return
        yield from (f"x := {given};", f"{target} := 0.0;")
        test = [f"IF {name}[{counter}] <= x THEN", f"{target} := {target} + 1.0;", "END_IF;"]
        yield from _loop(counter, 0, len(numbers) - 1, test)


def _test(source: Source, given: Mapping[str, str], taken: Mapping[str, str]) -> list[str]:
    """Return statements that follow the motion and compare outputs at golden instants."""
    g, outputs = source.golden, source.contract.outputs
    inputs = ", ".join(f"{name} := drive.{name}" for name in given.values())
    share = f"DINT_TO_LREAL(n) / {_number(g.steps)}"
    step = f"t := SEL(n = {g.steps}, before + {share} * (times[k] - before), times[k]);"
    moved = _loop("n", 1, g.steps, [step, "drive(t := t);", f"unit({inputs});"])
    gaps = (
        _turned(m, f"unit.{taken[m.name]} - golden[k * {len(outputs)} + {j}]")
        for j, m in enumerate(outputs)
    )
    least = (_number(max(off, _LEAST)) for off in g.outputs_off)
    near = (f"(ABS({gap}) <= {off})" for gap, off in zip(gaps, least, strict=True))
    tests = (f"IF NOT {one} THEN\nfailed := failed + 1;\nEND_IF;" for one in ("unit.valid", *near))
    return _loop("k", 0, g.times.size - 1, [*moved, "before := t;", *tests])


def _turned(member: Member, value: str) -> str:
    """Return the value of an output, without whole turns where these do not count."""
    return f"LC_DIRECTION({value})" if member.wrapped else value


def _table(name: str, numbers: Iterable[float]) -> Iterator[str]:
    """Yield the declaration of an array of numbers."""
    texts = [_number(one) for one in numbers]
    yield f"{name} : ARRAY[0..{len(texts) - 1}] OF LREAL := ["
    rows = (", ".join(texts[k : k + 6]) for k in range(0, len(texts), 6))
    yield ",\n  ".join(f"  {row}" for row in rows) + "];"


def _loop(counter: str, first: int, last: int, body: Sequence[str]) -> list[str]:
    """Return a loop; of one turn its body alone, which matiec would leave out."""
    head = f"FOR {counter} := {first} TO {last} DO"
    return [f"{counter} := {first};", *body] if last == first else [head, *body, "END_FOR;"]


def _iterated(counter: str, steps: int, done: str, step: Sequence[str]) -> list[str]:
    """Return a loop of so many steps, which are left out once the size is small."""
    return _loop(counter, 1, steps, [f"IF NOT (size < {done}) THEN", *step, "END_IF;"])


def _number(value: float) -> str:
    """Return a number of LREAL."""
    if math.isnan(value):
        raise DeclarationError("structured text has no number for NaN, which the scene needs")
    value = max(-1.7976931348623157e308, min(float(value), 1.7976931348623157e308))
    mantissa, _, power = f"{value:.17g}".partition("e")
    mantissa += "" if "." in mantissa else ".0"
    return f"{mantissa}E{power}" if power else mantissa


def _identifiers(first: str, names: Iterable[str]) -> dict[str, str]:
    """Return names that differ where capitals do not count; with a first word none is the
    language's.
    """
    plain = {name: re.sub("_+", "_", f"{first}_{name}").rstrip("_") for name in names}
    return distinct(plain, compared=str.lower)
