"""C of CasADi's functions of scalars, one statement an instruction: with the bits of CasADi's
virtual machine.

CasADi's own generator writes literals of doubles, functions of any length, a call that copies a
table for every look at it, and arguments that may be missing. Here all numbers are of one
precision, tables are looked up where they stand, a function is as long as compilers are quick with,
and may be of packs of numbers (``lanes.h``).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass

import casadi as ca
import numpy as np

from ...base.interpret import INFIX, Step, codes, operation_name, steps
from ...base.lookups import Lookup
from ...base.vocabulary import Precision
from ...errors import DeclarationError, SizeError

LENGTH = 250
"""Statements of a part of a long function.

Shorter ones compile no faster; longer ones do not run faster (``docs/speed.md``).
"""

Format = Callable[[float], str]


def literal(precision: Precision) -> Format:
    """Return how a number is written in C, so that it is read as the same number again, or as the
    nearest single.
    """
    single = precision == "single"

    def write(value: float) -> str:
        with np.errstate(over="ignore"):
            number = float(np.float32(value)) if single else float(value)
        if math.isinf(number):
            if math.isfinite(value):
                largest = np.finfo(np.float32).max
                raise SizeError(
                    f"the number {value:g} is too large for single precision, which ends at"
                    f" {largest:.3g}"
                )
            return "-INFINITY" if number < 0 else "INFINITY"
        if math.isnan(number):
            return "NAN"
        text = f"{number:.9g}" if single else f"{number:.17g}"
        text = text if any(mark in text for mark in ".e") else f"{text}.0"
        return f"{text}f" if single else text

    return write


def function_name(name: str, precision: Precision) -> str:
    """Return what the C library calls a function of numbers of a precision."""
    return f"{name}f" if precision == "single" else name


def defined(prefix: str, macros: Mapping[str, object]) -> str:
    """Return definitions of macros, by their names after the prefix."""
    return "".join(f"#define {prefix}_{name} {value}\n" for name, value in macros.items())


def print_functions(
    functions: Mapping[str, ca.Function],
    precision: Precision,
    *,
    prefix: str,
    packs: bool = False,
    rare: bool = False,
) -> str:
    """Return static C functions, each ``void NAME(const casadi_real** arg, casadi_real** res)``, of
    SX functions by name.

    ``casadi_real`` is for the caller to define: a number of the precision, or with ``packs`` a pack
    of ``lanes_real``. Names of tables begin with ``prefix``. Long functions that are ``rare`` are
    compiled for size. Nothing of it allocates, recurs, or is seen outside. Raises
    :class:`.DeclarationError` for a function that calls another one, or does what C has no name
    for; :class:`.SizeError` for a number that is too large for single precision.
    """
    printer = _Printer(precision, prefix, packs, "RARE" if rare else "PART", {})
    bodies = [printer.function(name, function) for name, function in functions.items()]
    return "\n".join([*printer.tables(), *bodies])


@dataclass(frozen=True)
class _Statement:
    """A statement: the variable that it sets, if it does, those that it reads, and its text."""

    target: int | None
    reads: tuple[int, ...]
    text: str


@dataclass(frozen=True, eq=False)
class _Printer:
    """Writer of functions in a precision, for packs or not; ``looked_up`` are the tables that they
    call, by CasADi's name.
    """

    precision: Precision
    prefix: str
    packs: bool
    part: str
    looked_up: dict[str, tuple[str, Lookup]]

    def function(self, name: str, function: ca.Function) -> str:
        """Return a function, in parts where it is long."""
        statements = list(self._statements(function))
        short = len(statements) <= 2 * LENGTH
        return (
            _whole(name, statements)
            if short
            else _in_parts(name, statements, f"LAGRANGE_CASADI_{self.part} " if self.packs else "")
        )

    def tables(self) -> Iterator[str]:
        """Return the C of the tables that were called."""
        for name, table in self.looked_up.values():
            if self.packs:
                yield self._table(table, f"{name}_of", "lanes_real") + _PACK.format(
                    name=name, one=f"{name}_of"
                )
            else:
                yield self._table(table, name, "casadi_real")

    def _table(self, table: Lookup, name: str, real: str) -> str:
        numbers = table.numbers[1:-1] if table.kind == "cell" else table.numbers
        lines = ",\n    ".join(
            map(", ".join, _rows(map(literal(self.precision), numbers.tolist()), 4))
        )
        return (_CELL if table.kind == "cell" else _ENTRY).format(
            name=name, real=real, count=numbers.size, numbers=lines
        )

    def _called(self, table: Lookup) -> str:
        name = f"{self.prefix}_{table.kind}{len(self.looked_up)}"
        return self.looked_up.setdefault(table.function.name(), (name, table))[0]

    def _statements(self, function: ca.Function) -> Iterator[_Statement]:
        number, whole = literal(self.precision), set[int]()
        reads: tuple[int, ...]
        for step in steps(function):
            if step.operation == ca.OP_INPUT:
                i, k = step.arguments
                value, reads = f"arg[{i}][{k}]", ()
            elif step.operation == ca.OP_OUTPUT:
                i, k = step.results
                yield _Statement(None, step.arguments, f"res[{i}][{k}] = a{step.arguments[0]};")
                continue
            elif step.operation == ca.OP_CONST:
                value, reads = number(step.constant), ()
            else:
                value, reads = self._value(function, step), step.arguments
            target = step.results[0]
            entry = step.looked_up is not None and step.looked_up.kind == "entry"
            if _same(step) or (step.operation == ca.OP_CEIL and step.arguments[0] in whole):
                # An entry is whole: rounding it changes nothing.
                value, entry = f"a{step.arguments[0]}", False
                if target == step.arguments[0]:
                    whole.discard(target)
                    continue
            (whole.add if entry else whole.discard)(target)
            yield _Statement(target, reads, f"a{target} = {value};")

    def _value(self, function: ca.Function, step: Step) -> str:
        given = [f"a{place}" for place in step.arguments]
        if step.looked_up is not None:
            return f"{self._called(step.looked_up)}({given[0]})"
        if step.operation in _LIBRARY:
            return f"{function_name(_LIBRARY[step.operation], self.precision)}({', '.join(given)})"
        form = (_OF_PACKS if self.packs else _OF_NUMBERS).get(step.operation) or _WRITTEN.get(
            step.operation
        )
        if form is None:
            what = (
                "calls another one"
                if step.operation == ca.OP_CALL
                else f"takes {operation_name(step.operation)}"
            )
            raise DeclarationError(
                f"function '{function.name()}' has no C: it {what}; evaluate with backend 'vm'"
            )
        return form.format(*given, one=literal(self.precision)(1.0))


def _same(step: Step) -> bool:
    """Return whether an instruction changes nothing, as the sign that keeps a sum from being
    simplified: see :func:`.closed`.
    """
    return step.operation == ca.OP_ASSIGN or (
        step.operation == ca.OP_COPYSIGN and step.arguments[0] == step.arguments[1]
    )


_LIBRARY = {
    ca.OP_CONSTPOW: "pow",
    **codes("pow atan2 hypot fmin fmax fmod remainder copysign sqrt fabs floor ceil erf"),
    **codes("sin cos tan asin acos atan sinh cosh tanh asinh acosh atanh exp log log1p expm1"),
}
"""Operations that are functions of C's library."""

_WRITTEN = {
    **INFIX,
    ca.OP_INV: "{one} / {0}",
    ca.OP_LT: "{0} < {1}",
    ca.OP_LE: "{0} <= {1}",
    ca.OP_EQ: "{0} == {1}",
    ca.OP_NE: "{0} != {1}",
}
_OF_NUMBERS = {
    ca.OP_NOT: "{0} == 0",
    ca.OP_AND: "{0} != 0 && {1} != 0",
    ca.OP_OR: "{0} != 0 || {1} != 0",
    ca.OP_SIGN: "{0} < 0 ? -1 : {0} > 0 ? 1 : {0}",
    ca.OP_IF_ELSE_ZERO: "{0} != 0 ? {1} : 0",
}
_OF_PACKS = {
    ca.OP_NOT: "!{0}",
    ca.OP_AND: "{0} && {1}",
    ca.OP_OR: "{0} || {1}",
    ca.OP_SIGN: "lanes_sign({0})",
    ca.OP_IF_ELSE_ZERO: "lanes_choose({0}, {1})",
}

_CELL = """\
static {real} {name}({real} x) {{
  static const {real} rising[{count}] = {{{numbers}}};
  const {real}* at = rising;
  int many = {count}, half;
  while (many > 1) {{
    half = many/2;
    at += at[half - 1] <= x ? half : 0;
    many -= half;
  }}
  return ({real}) ((at - rising) + (*at <= x));
}}
"""
_ENTRY = """\
static {real} {name}({real} x) {{
  static const {real} entry[{count}] = {{{numbers}}};
  return entry[(int) x];
}}
"""
_PACK = """\
static casadi_real {name}(casadi_real x) {{
  lanes_real lane[sizeof x/sizeof(lanes_real)];
  int j;
  memcpy(lane, &x, sizeof x);
  for (j = 0; j < (int) (sizeof x/sizeof *lane); ++j) lane[j] = {one}(lane[j]);
  memcpy(&x, lane, sizeof x);
  return x;
}}
"""
_HEAD = "static {part}void {name}(const casadi_real** arg, casadi_real** res{more}) {{\n"


def _whole(name: str, statements: list[_Statement]) -> str:
    """Return a function in one piece."""
    variables = sorted(
        {statement.target for statement in statements if statement.target is not None}
    )
    body = "".join(f"  {statement.text}\n" for statement in statements)
    head = _HEAD.format(part="", name=name, more="") + _unused(body, "arg", "res")
    return f"{head}{_declared(f'a{variable}' for variable in variables)}{body}}}\n"


def _in_parts(name: str, statements: list[_Statement], noinline: str) -> str:
    """Return a long function in parts: a compiler's time grows faster than the length of a
    function.

    A part takes first, from an array ``a``, what parts before it computed, and leaves there what
    later ones read.
    """
    parts = [statements[i : i + LENGTH] for i in range(0, len(statements), LENGTH)]
    flows = [_flow(part) for part in parts]
    later, kept = set[int](), list[set[int]]()
    for reads, writes in reversed(flows):
        kept.insert(0, writes & later)
        later = (later - writes) | reads
    text, size = "", 1 + max(set[int]().union(*kept), default=0)
    for number, (part, (reads, writes), left) in enumerate(zip(parts, flows, kept, strict=True)):
        body = "".join(f"  {statement.text}\n" for statement in part)
        body += "".join(f"  a[{k}] = a{k};\n" for k in sorted(left))
        names = (f"a{k} = a[{k}]" if k in reads else f"a{k}" for k in sorted(reads | writes))
        head = _HEAD.format(part=noinline, name=f"{name}_{number}", more=", casadi_real* a")
        idle = _unused(body + "a[" * bool(reads or left), "arg", "res", "a")
        text += f"{head}{idle}{_declared(names)}{body}}}\n\n"
    calls = "".join(f"  {name}_{number}(arg, res, a);\n" for number in range(len(parts)))
    return f"{text}{_HEAD.format(part='', name=name, more='')}  casadi_real a[{size}];\n{calls}}}\n"


def _flow(part: Iterable[_Statement]) -> tuple[set[int], set[int]]:
    """Return the variables that a part reads before it sets them, and those that it sets."""
    reads, writes = set[int](), set[int]()
    for statement in part:
        reads |= {*statement.reads} - writes
        if statement.target is not None:
            writes.add(statement.target)
    return reads, writes


def _declared(names: Iterable[str]) -> str:
    return "".join(f"  casadi_real {', '.join(row)};\n" for row in _rows(names, 12))


def _rows(words: Iterable[str], length: int) -> list[list[str]]:
    every = list(words)
    return [every[i : i + length] for i in range(0, len(every), length)]


def _unused(body: str, *names: str) -> str:
    """Return marks of the arguments that a body has no use for, lest compilers warn of them."""
    return "".join(f"  (void) {name};\n" for name in names if f"{name}[" not in body)
