"""Motions by samples and tables of a cycle as constants in C, and how large they are."""

from __future__ import annotations

import re
from collections.abc import Iterable
from importlib import resources

import numpy as np

from ..arithmetic.lookups import lookup
from ..base.arrays import Array
from ..base.vocabulary import Precision
from ..errors import SizeError
from .program import Format, Program, Samples, literal

LARGEST: dict[Precision, int] = {"double": 16_000_000, "single": 64_000}
"""Bytes of a table, unless more are allowed: what a large and what a small machine has room for."""

_LINE = 6
_HALF, _SIXTH = 1 / 2, 1 / 6


def table_bytes(program: Program) -> dict[str, int]:
    """The size of each table of numbers, by what it is."""
    size = 4 if program.precision == "single" else 8
    found = {}
    for sample in program.samples:
        more = 2 if program.precision == "single" else 1
        found[f"the motion of joint '{sample.joint}'"] = size * (sample.knots.size * more + sample.pieces.size + len(sample.pieces))
    called = {inner.name(): lookup(inner) for function in program.functions.values() for inner in function.find_functions()}
    if curves := sum(table.numbers.size for table in called.values() if table is not None):
        found["what all curves look up"] = size * curves
    if program.cycle is not None:
        found["the table of the cycle"] = program.cycle.coefficients.size * size
    return found


def check_size(program: Program, limit: int) -> None:
    """Raise :class:`SizeError` where a table is larger than ``limit`` bytes."""
    for what, size in table_bytes(program).items():
        if size > limit:
            raise SizeError(
                f"{what} takes {size} bytes of constants, and the limit is {limit}: take fewer numbers, or raise the limit"
            )


def sampled(program: Program, number: Format) -> str:
    """The motions by samples: constants, and a function for each."""
    if not program.samples:
        return ""
    text = (resources.files(__package__) / "templates" / "samples.c").read_text()
    return text + "".join(_motion(k, sample, program.precision == "single", number) for k, sample in enumerate(program.samples))


def _motion(k: int, sample: Samples, single: bool, number: Format) -> str:
    value, rest = _parts(sample.pieces[:, 0], single)
    rows = np.column_stack([value, rest, sample.pieces[:, 1:]])
    knots, knots_rest = _parts(sample.knots, single)
    half, sixth = number(_HALF), number(_SIXTH)
    text = (
        f"\n/* The motion of joint {sample.joint}: knots, and of each piece its value, what rounding left of that, and so on. */\n"
    )
    text += _constants(f"knots_{k}", knots, number)
    from_knot = f"time - knots_{k}[i]"
    if single:
        text += _constants(f"knots_rest_{k}", knots_rest, number)
        from_knot = f"({from_knot}) + (rest - knots_rest_{k}[i])"
    text += _constants(f"pieces_{k}", rows.ravel(), number)
    lines = [
        f"const int i = piece_of(time, {len(sample.pieces)}, knots_{k});",
        f"const casadi_real* c = pieces_{k} + 5*i;",
        f"const casadi_real s = {from_knot};",
        f"const casadi_real step = s*(c[2] + s*(c[3]*{half} + s*c[4]*{sixth}));",
        "const casadi_real value = c[0] + step, part = value - c[0];",
        "found[0] = value;",
        f"found[1] = c[2] + s*(c[3] + s*c[4]*{half});",
        "found[2] = c[3] + s*c[4];",
        "found[3] = ((c[0] - (value - part)) + (step - part)) + c[1];",
        *([] if single else ["(void) rest;"]),
    ]
    body = "\n".join(f"  {line}" for line in lines)
    return f"{text}\nstatic void sample_of_{k}(casadi_real time, casadi_real rest, casadi_real* found) {{\n{body}\n}}\n"


def _parts(values: Array, single: bool) -> tuple[Array, Array]:
    high = values.astype(np.float32).astype(float) if single else values
    return high, values - high


def table_text(program: Program) -> str:
    """A table of the cycle, and what reads it."""
    cycle = program.cycle
    if cycle is None:
        return ""
    text = (resources.files("lagrange_casadi.codegen") / "interpolate.c").read_text()
    text = re.sub(r"^#.*\n", "", text, flags=re.MULTILINE)
    text = text.replace("typedef REAL real;\n", "").replace("*restrict ", "*").replace("* restrict ", "* ")
    for word, value in (("BLOCK", "1"), ("PACK", "1"), ("TILE", "32"), ("WEIGHTS", "6"), ("FACTORS", "4")):
        text = re.sub(rf"\b{word}\b", value, text)
    # A number becomes a long by one instruction of a small machine, a long long by a library's arithmetic of doubles.
    text = text.replace("long long", "long")
    text = re.sub(r"\breal\b", "casadi_real", text)
    if program.precision == "single":
        text = text.replace("floor(", "floorf(")
    number = literal(program.precision)
    layout = cycle.layout
    text += _constants("cell", cycle.cell.astype(float), number)
    text += _constants("slopes", cycle.slopes.astype(float), number)
    text += _constants("coefficients", cycle.coefficients.astype(float).ravel(), number)
    text += _integers("order", layout.order.ravel()) + _integers("runs", layout.runs.ravel())
    return "\n" + text


def table_call(program: Program) -> Iterable[str]:
    """Statements that read the columns ``y`` from the table, for what the drive's own graph gave."""
    cycle = program.cycle
    assert cycle is not None
    phase = f"drive[{2 + cycle.turns}]"
    yield (
        f"interpolate(1, 1, &{phase}, drive + 1, drive + 2, {cycle.nodes}, cell, {cycle.coefficients.shape[1]}, coefficients, "
        f"{len(cycle.columns)}, order, slopes, {len(cycle.layout.runs)}, runs, y);"
    )
    number = literal(program.precision)
    for k in np.flatnonzero(cycle.drift):
        yield f"y[{k}] = y[{k}] + {number(cycle.drift[k])}*(drive[0] - {phase});"


def _constants(name: str, values: Array, number: Format) -> str:
    return _array("casadi_real", name, [number(value) for value in values])


def _integers(name: str, values: Iterable[int]) -> str:
    return _array("int", name, [str(int(value)) for value in values])


def _array(kind: str, name: str, words: list[str]) -> str:
    rows = (", ".join(words[i : i + _LINE]) for i in range(0, len(words), _LINE))
    body = ",\n  ".join(rows) if words else "0"
    return f"static const {kind} {name}[] = {{\n  {body}\n}};\n"
