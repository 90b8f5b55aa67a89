"""Long straight-line functions cut into short ones, for a compiler's time grows faster than the length of a function.

CasADi writes an SX function as statements over local variables, which it uses again and again. A part takes what it reads first
from an array, and leaves there what a later part reads.
"""

from __future__ import annotations

import re

LENGTH = 250
"""Statements of a part. Shorter ones compile no faster; longer ones do not run faster (``docs/speed.md``)."""

_FUNCTION = re.compile(
    r"static int (casadi_f\d+)\(([^)]*)\) \{\n((?:  casadi_real a\d+[^\n]*;\n)+)(.*?)  return 0;\n\}\n", re.DOTALL
)
_VARIABLE = re.compile(r"\ba(\d+)\b")


def split(text: str) -> str:
    """The same C with every function of more than twice :data:`LENGTH` statements in parts."""
    return _FUNCTION.sub(_split, text)


def _split(found: re.Match[str]) -> str:
    name, arguments, _, body = found.groups()
    statements = body.splitlines(keepends=True)
    if len(statements) <= 2 * LENGTH:
        return found.group(0)
    parts = [statements[i : i + LENGTH] for i in range(0, len(statements), LENGTH)]
    reads, writes = zip(*(_flow(part) for part in parts), strict=True)
    later: set[str] = set()
    kept: list[set[str]] = [set()] * len(parts)
    for i in reversed(range(len(parts))):
        kept[i] = writes[i] & later
        later = (later - writes[i]) | reads[i]
    pieces, calls = [], []
    for i, part in enumerate(parts):
        variables = sorted({v for line in part for v in _VARIABLE.findall(line)}, key=int)
        declared = ", ".join(f"a{v}=a[{int(v)}]" if v in reads[i] else f"a{v}" for v in variables)
        leaving = "".join(f"  a[{int(v)}]=a{v};\n" for v in sorted(kept[i], key=int))
        pieces.append(
            f"static LAGRANGE_CASADI_PART void {_part(name, i)}(const casadi_real** arg, casadi_real** res, casadi_real* a) {{\n"
            f"  casadi_real {declared};\n{''.join(part)}{leaving}}}\n\n"
        )
        calls.append(f"  {_part(name, i)}(arg, res, a);\n")
    size = 1 + max(int(v) for v in _VARIABLE.findall(body))
    return f"{''.join(pieces)}static int {name}({arguments}) {{\n  casadi_real a[{size}];\n{''.join(calls)}  return 0;\n}}\n"


def _part(name: str, i: int) -> str:
    return f"CASADI_PREFIX({name.removeprefix('casadi_')}_{i})"


def _flow(part: list[str]) -> tuple[set[str], set[str]]:
    """The variables that a part reads before it writes them, and those that it writes."""
    reads: set[str] = set()
    writes: set[str] = set()
    for line in part:
        target, _, value = line.strip().partition("=")
        reads |= set(_VARIABLE.findall(value)) - writes
        written = _VARIABLE.fullmatch(target)
        if written:
            writes.add(written.group(1))
    return reads, writes
