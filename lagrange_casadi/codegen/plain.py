"""CasADi's C of scalar functions without what only CasADi needs: static functions, and the few small ones that they call."""

from __future__ import annotations

import re
from collections.abc import Mapping

import casadi as ca

from ..base.vocabulary import Precision
from .emit import in_single, opened
from .split import split
from .tables import with_tables

_ITEM = re.compile(
    r"^(?:static |CASADI_SYMBOL_EXPORT )?\w+\*? (?P<name>\w+|CASADI_PREFIX\(\w+\))\([^{;]*\) ?\{(?:[^\n]*\}\n|.*?^\}\n)",
    re.DOTALL | re.MULTILINE,
)
_ENTRY = re.compile(r"int (\w+)\(const casadi_real\*\* arg[^{]*\{\s*return (\w+)\(arg, res, iw, w, mem\);")
_DEFINITION = re.compile(r"^(static void \w+\((const casadi_real\*\* arg[^)]*)\) \{\n)(.*?)^\}\n", re.DOTALL | re.MULTILINE)
_WORD = re.compile(r"\w+")


def plain(functions: Mapping[str, ca.Function], precision: Precision) -> str:
    """Static C functions of SX functions by name, each ``void NAME(const casadi_real** arg, casadi_real** res)``.

    ``casadi_real`` is for the caller to define. Nothing of it allocates, recurs, or is seen outside.
    """
    generator = ca.CodeGenerator("graph", {"with_header": False})
    for function in functions.values():
        generator.add(function)
    called = {function.name(): name for name, function in functions.items()}
    text = with_tables(str(generator.dump()), functions.values(), packs=False)
    text = re.sub(r"if \(res\[(\d+)\]!=0\) ", "", text)
    text = split(opened(re.sub(r"arg\[(\d+)\]\? (arg\[\1\]\[\d+\]) : 0", r"\2", text)))
    text = re.sub(r"CASADI_PREFIX\((\w+)\)", r"casadi_\1", text).replace("LAGRANGE_CASADI_PART ", "")
    items = {found["name"]: found.group() for found in _ITEM.finditer(text)}
    entries = {found[2]: called[found[1]] for found in _ENTRY.finditer(text) if found[1] in called}
    needed: set[str] = set()
    wanted = list(entries)
    while wanted:
        name = wanted.pop()
        if name not in needed:
            needed.add(name)
            wanted += [word for word in _WORD.findall(items[name]) if word in items]
    text = "\n".join(re.sub(r"^(?!static )", "static ", item) for name, item in items.items() if name in needed)
    text = re.sub(
        r"static int (\w+)\(const casadi_real\*\* arg[^)]*\)", r"static void \1(const casadi_real** arg, casadi_real** res)", text
    )
    text = re.sub(r"^  return 0;\n", "", text, flags=re.MULTILINE)
    text = re.sub(r"\((a\d+)\?(a\d+):0\)", r"(\1!=0?\2:0)", text)
    # Numbers taken for truths are conversions, of which compilers warn.
    text = re.sub(r"\(!(a\d+)\)", r"(\1==0)", text)
    text = re.sub(r"\((a\d+)(&&|\|\|)(a\d+)\)", r"((\1!=0)\2(\3!=0))", text)
    text = _DEFINITION.sub(_used, text)
    for inner, outer in entries.items():
        text = re.sub(rf"\b{inner}(?=\b|_\d)", outer, text)
    return in_single(text) if precision == "single" else text


def _used(found: re.Match[str]) -> str:
    """The function with its unused arguments marked, so that compilers do not warn of them."""
    head, arguments, body = found.groups()
    idle = [name for name in ("arg", "res", "a") if re.search(rf"\b{name}\b", arguments) and not re.search(rf"\b{name}\b", body)]
    return head + "".join(f"  (void) {name};\n" for name in idle) + body + "}\n"
