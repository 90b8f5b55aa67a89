"""Tables that graphs look up, as C of our own: CasADi's copies a table at every call, and knows no packs."""

from __future__ import annotations

import re
from collections.abc import Iterable

import casadi as ca

from ..arithmetic.lookups import Lookup, lookup

_DEFINITION = re.compile(r"^/\* (\w+):\(i0\)->\(o0\) \*/\nstatic int casadi_(f\d+)\(.*?^\}\n", re.DOTALL | re.MULTILINE)
_CALL = re.compile(
    r"^  arg\[\d+\](?:=w\+(?P<into>\d+)| = arg\[(?P<input>\d+)\]\? arg\[(?P=input)\] \+ (?P<nonzero>\d+) : 0);\n"
    r"  res\[\d+\]=w\+(?P<out>\d+);\n"
    r"(?:  w\[(?P=into)\] = (?P<argument>a\d+);\n)?"
    r"  if \((?P<name>casadi_f\d+)\(arg\+\d+, res\+\d+, iw, w\+\d+, 0\)\) return 1;\n"
    r"  (?P<result>a\d+) = w\[(?P=out)\];\n",
    re.MULTILINE,
)
_NEEDED_BY_TABLES = re.compile(
    r"^(?:static const casadi_real (casadi_c\d+)\[[^;]*;\n|(?:static )?\w+ (casadi_low|casadi_copy)\([^;{]*\) \{\n.*?^\}\n)",
    re.DOTALL | re.MULTILINE,
)
_STATEMENT = re.compile(r"  (a\d+)=(?:(casadi_f\d+)\(|(?:ceil\((a\d+)\));)?")

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


def with_tables(text: str, functions: Iterable[ca.Function], *, packs: bool) -> str:
    """CasADi's C of functions with tables of our own: of one ``casadi_real``, or where it may be a pack of ``lanes_real``."""
    called = {inner.name(): lookup(inner) for function in functions for inner in function.find_functions()}
    tables = {name: found for name, found in called.items() if found is not None}
    if not tables:
        return text
    entries: set[str] = set()

    def written(found: re.Match[str]) -> str:
        if found[1] not in tables:
            return found.group()
        table, name = tables[found[1]], f"casadi_{found[2]}"
        if table.kind == "entry":
            entries.add(name)
        if not packs:
            return _table(table, name, "casadi_real")
        one = f"CASADI_PREFIX({found[2]}_of)"
        return _table(table, one, "lanes_real") + _PACK.format(name=name, one=one)

    text = _DEFINITION.sub(written, text)
    text = _CALL.sub(_called, text)
    text = _whole(text, entries)
    return _NEEDED_BY_TABLES.sub(lambda found: found.group() if _called_more(text, found[1] or found[2]) else "", text)


def _table(table: Lookup, name: str, real: str) -> str:
    numbers = table.numbers[1:-1] if table.kind == "cell" else table.numbers
    lines = ",\n    ".join(", ".join(map(repr, numbers[k : k + 4].tolist())) for k in range(0, numbers.size, 4))
    template = _CELL if table.kind == "cell" else _ENTRY
    return template.format(name=name, real=real, count=numbers.size, numbers=lines)


def _called_more(text: str, name: str) -> bool:
    """Whether a name stands where it is used, and not only where it is defined."""
    return len(re.findall(rf"(?<!define )\b{name}\b", text)) > 1


def _called(found: re.Match[str]) -> str:
    argument = found["argument"] or f"arg[{found['input']}][{found['nonzero']}]"
    return f"  {found['result']}={found['name']}({argument});\n"


def _whole(text: str, entries: set[str]) -> str:
    """The same without rounding of entries, which are whole: see :func:`.entries`."""
    lines, whole = text.splitlines(keepends=True), set[str]()
    for k, line in enumerate(lines):
        statement = _STATEMENT.match(line)
        if statement is None:
            continue
        target, called, rounded = statement.groups()
        if rounded in whole:
            lines[k] = f"  {target}={rounded};\n" if target != rounded else ""
        elif called in entries:
            whole.add(target)
            continue
        whole.discard(target)
    return "".join(lines)
