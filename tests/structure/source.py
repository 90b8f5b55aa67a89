"""The package as text: its modules and their syntax trees, which several tests look at."""

import ast
from functools import cache
from pathlib import Path

import lagrange_casadi

PACKAGE = Path(lagrange_casadi.__file__).parent
PATHS = sorted(PACKAGE.rglob("*.py"))


@cache
def nodes_of(path: Path) -> tuple[ast.AST, ...]:
    """All nodes of a file; to find them takes the time."""
    return tuple(ast.walk(ast.parse(path.read_text())))
