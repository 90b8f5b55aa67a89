"""Mistakes of a script, in words on what can be done instead of those of Python and CasADi."""

from __future__ import annotations

import re
import sys
from types import ModuleType, TracebackType
from typing import Any

from ..errors import UnknownNameError, one_line

_INSTEAD = {
    "truth value of a CasADi": (
        "a symbol has no truth value: use casadi.if_else(condition, a, b) for 'if',"
        " casadi.logic_and and logic_or for 'and' and 'or', casadi.fmin and fmax for 'min' and"
        " 'max'"
    ),
    r"'SX' and 'str'|'str' and 'SX'|str \(not \"SX\"\)|non-int of type 'SX'": (
        "a text with a unit goes into no formula: write its number in SI units, as 0.1 for"
        " '100 mm'; the entries of a list are multiplied one by one"
    ),
    "to_int not defined for SymbolicSX|not SX|'SX' object cannot be inter|to SX.__format": (
        "a symbol has no number while a mechanism is declared"
    ),
    "'(SX|Link|Point|Ground|PointMass|Mechanism|Scene)' object is not callable": (
        r"'\1' is no function: leave out the ()"
    ),
    r"'numpy\.(\w+)' on types that implement": (
        r"NumPy's \1 takes no symbol: use functions of CasADi, as casadi.if_else, or a table"
    ),
    r"'SX' object has no attribute '(\w+)'": (
        r"an expression has no \1: use functions of CasADi, as casadi.fmax(a, b)"
    ),
    "matrices are not iterable|out of bounds with supplied length of 1$": (
        "an expression is one number and has no parts: m.place(point) and m.velocity(point) have"
    ),
}
"""Words on what can be done, by those of Python and CasADi about a symbol or a part."""


def error_text(error: BaseException) -> str:
    """Message of an error in a line; for what Python cannot do with a symbol, what can be done, and
    for a name that a module lacks, the nearest.
    """
    if answer := answer_to(error):
        return answer
    text = one_line(error)
    module = getattr(error, "obj", sys.modules.get(str(getattr(error, "name", ""))))
    lacking = re.search(r"(?:import name|attribute) '?(\w+)", text)
    if isinstance(module, ModuleType) and lacking:
        place, names = module.__name__, [name for name in dir(module) if name[0] != "_"]
        return str(UnknownNameError(f"name in {place}", lacking[1], names, f"dir({place})"))
    return f"{type(error).__name__}{text and ': '}{text}"


def answer_to(error: BaseException | None) -> str:
    """Words on what can be done instead of what Python cannot do with a symbol; otherwise none."""
    text = one_line(error) if error else ""
    found = ((re.search(words, text), instead) for words, instead in _INSTEAD.items())
    return next((match.expand(instead) for match, instead in found if match), "")


def _answer(error: BaseException | None) -> None:
    """Show what can be done instead, below an error."""
    if answer := answer_to(error):
        print(f"lagrange_casadi: {answer}", file=sys.stderr)


def _end(kind: type[BaseException], error: BaseException, at: TracebackType | None) -> None:
    """Show an error that ends a script as before, and below it what can be done instead."""
    _former(kind, error, at)
    _answer(error)


def _end_cell(result: Any) -> None:
    """Show what can be done instead below the error of a notebook's cell."""
    _answer(result.error_in_exec)


_former, sys.excepthook = sys.excepthook, _end
if shell := getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)():
    shell.events.register("post_run_cell", _end_cell)
