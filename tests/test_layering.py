"""Imports run one way: no room imports one that stands above it, and no module stands in a circle."""

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

import lagrange_casadi

pytestmark = pytest.mark.quick

PACKAGE = Path(lagrange_casadi.__file__).parent
ORDER = (
    "version",
    "errors",
    "tables",
    "quantities",
    "system",
    "arguments",
    "arithmetic",
    "geometry",
    "beams",
    "declare",
    "elements",
    "equations",
    "summits",
    "codegen",
    "instants",
    "judge",
    "strength",
    "elastic",
    "sensitivity",
    "evaluate",
    "designs",
    "study",
    "export",
    "store",
    "draw",
    "report",
    "animation",
    "actuators",
    "bearings",
    "density",
    "motion",
    "figures",
    "peaks",
    "shipped_cases",
    "case_modules",
    "case",
    "sweep",
    "optimise",
    "cli",
)

LATE = {("scene.py", "report"), *(("solution.py", room) for room in ("animation", "elastic", "report", "strength"))}
"""What a user asks of a thing by a method, and what that looks for only when it is called."""


def modules():
    for path in sorted(PACKAGE.rglob("*.py")):
        parts = path.relative_to(PACKAGE).parts
        if parts[0] not in ("__init__.py", "__main__.py"):
            yield parts[0].removesuffix(".py"), path


def imported(path):
    """The package's own modules that a file imports, wherever in the file."""
    depth = len(path.relative_to(PACKAGE).parts)
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and node.level == depth:
            names = [node.module] if node.module else [alias.name for alias in node.names]
            yield from (name.split(".")[0] for name in names)


def test_every_module_has_its_place():
    assert {name for name, _ in modules()} == set(ORDER)


def test_imports_run_downward_only():
    for name, path in modules():
        for other in imported(path):
            assert ORDER.index(other) < ORDER.index(name) or (path.name, other) in LATE, f"{path.name} imports {other}"


def test_the_engine_knows_no_mechanism():
    """Nothing under the cases may know the words of one."""
    words = re.compile(r"\b(crank|rod|slider|rocker|coupler)\b", re.IGNORECASE)
    for name, path in modules():
        if name in ("geometry", "equations", "summits", "codegen", "instants", "judge", "evaluate"):
            for number, line in enumerate(path.read_text().splitlines(), 1):
                assert not words.search(line), f"{path.name}:{number}: {line}"


def test_only_the_command_line_speaks_of_its_options():
    """Words that are an option and nothing else are no message: a rung's, a compiler's."""
    for name, path in modules():
        for node in ast.walk(ast.parse(path.read_text())) if name != "cli" else ():
            if isinstance(node, ast.Constant) and isinstance(node.value, str) and not re.fullmatch(r"--\w+", node.value):
                assert not re.search(r"(^|[\s'(])--[a-z]", node.value), f"{path.name}:{node.lineno}: {node.value}"


def test_matplotlib_waits_until_a_figure_is_drawn():
    program = "import sys, lagrange_casadi, lagrange_casadi.cli; assert 'matplotlib' not in sys.modules"
    subprocess.run([sys.executable, "-c", program], check=True)


def test_tests_take_nothing_from_other_tests():
    """What several need has a place of its own, as mechanisms have."""
    for path in sorted(Path(__file__).parent.glob("*.py")):
        for node in ast.walk(ast.parse(path.read_text())):
            taken = [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            taken += [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            assert not [name for name in taken if name.startswith("test_")], f"{path.name}:{node.lineno}"


def test_no_file_is_two_things():
    for path in (*(path for _, path in modules()), *PACKAGE.rglob("*.js"), *Path(__file__).parent.glob("*.py")):
        assert len(path.read_text().splitlines()) <= 400, path
