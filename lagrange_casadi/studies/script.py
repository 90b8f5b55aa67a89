"""Scripts as cases: what a script declares at its top level goes into the function ``scene()``."""

from __future__ import annotations

import ast
import tokenize
from pathlib import Path

from ..errors import CaseError, PathError, one_line


def case_of_script(path: Path) -> tuple[str, list[str]]:
    """The text of a case for a script, and the lines in which something begins that is left out.

    The statements before the last ``Scene(...)`` at the top level go into ``scene()``, which
    returns that scene; imports stay above. What follows the scene is left out, and what prints.
    """
    text, tree = _read(path)
    scenes = [
        (statement, node)
        for statement in tree.body
        if not hasattr(statement, "body")
        for node in ast.walk(statement)
        if isinstance(node, ast.Call) and _called(node) == "Scene"
    ]
    if not scenes:
        raise CaseError(
            f"{path.name}: expected a script with scene = Scene(...) at its top level, in no"
            " function; a file in which a function scene() returns one is a case already"
        )
    last, call = scenes[-1]
    place = tree.body.index(last)
    assigned = {
        node.id
        for node in ast.walk(tree)
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)
    }
    # Lines that begin within a text: space before them would be part of it.
    within = {
        line
        for node in ast.walk(tree)
        if isinstance(node, (ast.Constant, ast.JoinedStr))
        for line in range(node.lineno + 1, (node.end_lineno or 0) + 1)
    }

    def inner(code: list[str], first: int) -> list[str]:
        """Lines of the function, of which the first has a number in the script."""
        return [
            line if number in within or not line.strip() else f"    {line}"
            for number, line in enumerate(code, first)
        ]

    lines, begin = text.split("\n"), 0
    above: list[str] = []
    body: list[str] = []
    left: list[str] = []
    for statement in tree.body[:place]:
        end = statement.end_lineno or 0
        if _prints(statement):
            left.append(str(statement.lineno))
        elif _is_above(statement, assigned):
            above += lines[begin:end]
        else:
            body += inner(lines[begin:end], begin + 1)
        begin = end
    body += inner(lines[begin : last.lineno - 1], begin + 1)
    left += [f"{one.lineno} and after" for one in tree.body[place + 1 : place + 2]]
    made = inner((ast.get_source_segment(text, call) or "").split("\n"), call.lineno)
    result = "\n".join(made).lstrip()
    inside = "\n".join(body).strip("\n")
    return "\n".join([*above, f"\n\ndef scene():\n{inside}\n    return {result}\n"]), left


def _read(path: Path) -> tuple[str, ast.Module]:
    """The text of a script, and its statements."""
    try:
        with tokenize.open(path) as file:
            text = file.read()
        return text, ast.parse(text, path.name)
    except OSError as error:
        raise PathError(f"cannot read {path}: {error.strerror}") from None
    except (SyntaxError, ValueError) as error:
        raise CaseError(f"{path.name}: {type(error).__name__}: {one_line(error)}") from None


def _called(call: ast.Call) -> str:
    """The name of a function that is called, without that of its module."""
    return ast.unparse(call.func).rpartition(".")[2]


def _prints(statement: ast.stmt) -> bool:
    value = statement.value if isinstance(statement, ast.Expr) else None
    return isinstance(value, ast.Call) and _called(value) == "print"


def _is_above(statement: ast.stmt, assigned: set[str]) -> bool:
    """Return whether a statement stays at the top level: what is said of the file, and an import
    unless the function has a variable of its name.
    """
    if isinstance(statement, (ast.Import, ast.ImportFrom)):
        names = {(one.asname or one.name).partition(".")[0] for one in statement.names}
        return not names & assigned
    return isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)
