"""Parameters of functions, as their signatures and docstrings have them.

Both are read from the source: importing a module that evaluates something takes ten times as long
as a help may.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

from ..base import vocabulary

_PACKAGE = Path(__file__).parent.parent
_ENTRY = re.compile(r"^(\w+(?:, \w+)*)(?: : (.+))?\n((?: +.+\n)*)", re.MULTILINE)
"""Names of a numpydoc entry, what stands for their value, and the first paragraph on them; more
paragraphs are for Python.
"""

_ELSEWHERE = re.compile(r"As of :\w+:`\.([\w.]+)`(?:\.|: (.+))")
"""A place that describes a parameter, and what is said in place of its description."""


@dataclass(frozen=True)
class Parameter:
    """A parameter of a function, or a field of a class.

    ``kind`` is its annotation as text, ``default`` its default as a node, ``metavar`` what stands
    for its value, and ``says`` its description; each is empty or None if there is none.
    """

    name: str
    kind: str = ""
    default: ast.expr | None = None
    positional: bool = False
    metavar: str = ""
    says: str = ""

    @property
    def value(self) -> Any:
        """The default: a literal, or a name of :mod:`.base.vocabulary`."""
        if isinstance(self.default, ast.Name):
            return getattr(vocabulary, self.default.id)
        return None if self.default is None else ast.literal_eval(self.default)


def summary(place: str) -> str:
    """Return what the docstring of a function or a class says above its parameters.

    ``place`` is where it stands in the package, as ``studies.sizing.size``.
    """
    return _parts(_node(place))[0]


@cache
def parameters(place: str) -> dict[str, Parameter]:
    """Return the parameters of a function or a class, in the order of its docstring.

    An entry of the docstring may say ``As of`` another place, which has what is not declared or
    said here.
    """
    node = _node(place)
    declared = {one.name: one for one in _declared(node)}
    found = {}
    for names, metavar, description in _ENTRY.findall(_parts(node)[1]):
        says = " ".join(description.split())
        elsewhere = _ELSEWHERE.fullmatch(says)
        other_place, says = elsewhere.groups() if elsewhere else ("", says)
        others = parameters(other_place) if other_place else {}
        for one in names.split(", "):
            other = replace(others.get(one, Parameter(one)), positional=False)
            found[one] = replace(
                declared.get(one, other),
                metavar=metavar or other.metavar,
                says=says or other.says,
            )
    return found


@cache
def _node(place: str) -> ast.FunctionDef | ast.ClassDef:
    """Parse a function or a class, of several of its name the last: others are overloads."""
    module, _, name = place.rpartition(".")
    file = _PACKAGE.joinpath(*module.split(".")).with_suffix(".py")
    lines = rf"^(?:class|def) {name}\b.*\n(?:[ )].*\n|\n)*"
    *_, source = re.findall(lines, file.read_text(encoding="utf-8"), re.MULTILINE)
    (node,) = ast.parse(source).body
    assert isinstance(node, ast.FunctionDef | ast.ClassDef)
    return node


def _parts(node: ast.FunctionDef | ast.ClassDef) -> tuple[str, str]:
    """Split a docstring into what stands above its parameters, and their entries."""
    above, _, entries = f"{ast.get_docstring(node)}\n".partition("\n\nParameters\n----------\n")
    return above, re.split(r"\n\n\w+\n-+\n", entries)[0] + "\n"


def _declared(node: ast.FunctionDef | ast.ClassDef) -> Iterator[Parameter]:
    """Give the parameters of a signature, or the fields of a class, without descriptions."""
    if isinstance(node, ast.ClassDef):
        yield from (
            Parameter(ast.unparse(line.target), ast.unparse(line.annotation), line.value)
            for line in node.body
            if isinstance(line, ast.AnnAssign)
        )
        return
    taken = node.args
    required = [None] * (len(taken.args) - len(taken.defaults))
    values = [*required, *taken.defaults, *taken.kw_defaults]
    for one, default in zip([*taken.args, *taken.kwonlyargs], values, strict=True):
        kind = "" if one.annotation is None else ast.unparse(one.annotation)
        yield Parameter(one.arg, kind, default, one in taken.args)
