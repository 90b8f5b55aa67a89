"""What layers promise beside the contracts of imports in pyproject.toml: each leaf can be taken
away, and what is compiled is not declared again.
"""

import ast
import re
from functools import cache
from importlib import import_module
from pathlib import Path

import pytest
from internals import METHODS_METHODS as METHODS
from places import TESTS
from source import PACKAGE, PATHS, nodes_of

DECLARED = ("version", "errors", "base", "model", "engine")
"""The packages up to where a scene is compiled. All others read what it is compiled to."""


PUBLIC = (
    *("actuators", "animation", "beams", "bearings", "cli", "density", "elements"),
    *("errors", "figures", "forward", "motion", "peaks", "strength", "version"),
    *("studies.case", "studies.optimise", "studies.sweep", "studies.trade"),
)
"""What users import from, and tests as well."""

ALONE = ("cli", "messages")
"""Folders of tests that import nothing else of the package."""


@cache
def modules() -> dict[str, Path]:
    """The modules by their names within the package: all but the façade,
    which leads to every room.
    """
    named = {".".join(path.relative_to(PACKAGE).with_suffix("").parts): path for path in PATHS}
    return {
        name.removesuffix(".__init__"): path
        for name, path in named.items()
        if name not in ("__init__", "__main__")
    }


def room(module: str) -> str:
    return module.partition(".")[0]


@pytest.mark.quick
def test_the_map_shows_the_rooms_and_files_that_are_there():
    root = Path(__file__).parents[2]
    page = (root / "docs" / "architecture.md").read_text()
    rooms = {room(name) for name in modules() if (PACKAGE / room(name)).is_dir()}
    assert {*re.findall(r"^\| `(\w+)` \|", page, re.MULTILINE)} == rooms
    here = {
        *(path.name for path in modules().values()),
        *(path.relative_to(PACKAGE).as_posix() for path in modules().values()),
    }
    for named in re.findall(r"[\w/]+\.py\b", page):
        assert named in here or (root / named).exists(), named


@pytest.mark.quick
def test_what_is_compiled_is_not_declared_again():
    """No module goes back from what it has to a scene or its mechanism: a case that was loaded, and
    an error, hand over theirs.
    """
    for name, path in modules().items():
        loads = [
            node
            for node in (nodes_of(path) if "load_case(" in path.read_text() else ())
            if isinstance(node, ast.Assign) and "load_case(" in ast.unparse(node.value)
        ]
        handed = {ast.unparse(target) for node in loads for target in node.targets} | {"error"}
        for node in nodes_of(path) if room(name) not in DECLARED and name != "studies.case" else ():
            if isinstance(node, ast.Attribute) and node.attr in ("scene", "mechanism"):
                owner = ast.unparse(node.value)
                assert owner in handed or owner.startswith("load_case("), f"{name}:{node.lineno}"
                assert node.attr == "scene", f"{name}:{node.lineno}"


TABLES = ("base.methods", "cli.help")
"""Modules that import what they read in a table."""


@pytest.mark.quick
def test_only_the_table_of_methods_names_what_is_above():
    """A method of the table answers from a module that is there, and each is asked for by the
    module that has it. Commands have a table of their own.
    """
    asked: dict[str, str] = {}
    for name, path in modules().items():
        for node in nodes_of(path):
            called = node.func if isinstance(node, ast.Call) else None
            if isinstance(called, ast.Name) and called.id == "method":
                (word,) = (argument.value for argument in node.args)
                asked[word] = name
            last = getattr(called, "attr", getattr(called, "id", ""))
            if last.endswith(("import_module", "__import__")) and name not in TABLES:
                assert ast.unparse(node.args[0]).startswith("'distributed"), f"{name}:{node.lineno}"
    assert asked.keys() == METHODS.keys()
    for answer in METHODS.values():
        module, _, function = answer.partition(":")
        assert hasattr(import_module(f"lagrange_casadi.{module}"), function), answer


@pytest.mark.quick
def test_the_engine_knows_no_mechanism():
    """Nothing under the cases may know the words of one."""
    words = re.compile(r"\b(crank|rod|slider|rocker|coupler)\b", re.IGNORECASE)
    for name, path in modules().items():
        if room(name) in ("engine", "results") or name in ("studies.evaluate", "studies.solving"):
            for number, line in enumerate(path.read_text().splitlines(), 1):
                assert not words.search(line), f"{path.name}:{number}: {line}"


@pytest.mark.quick
def test_only_the_command_line_speaks_of_its_options():
    """Words that are an option and nothing else are no message: a rung's, a compiler's."""
    for name, path in modules().items():
        for node in nodes_of(path) if room(name) != "cli" else ():
            if (
                isinstance(node, ast.Constant)
                and isinstance(node.value, str)
                and not re.fullmatch(r"--\w+", node.value)
            ):
                assert not re.search(r"(^|[\s'(])--[a-z]", node.value), (
                    f"{path.name}:{node.lineno}: {node.value}"
                )


DOUBTFUL = re.compile(
    rf"^ *(from|import) +(test_|internals|lagrange_casadi\.(?!({'|'.join(PUBLIC)}) import))",
    re.MULTILINE,
)
"""A line that may be an import of a test, or of an inner module."""


@pytest.mark.quick
def test_tests_take_inner_modules_from_one_file_and_nothing_from_other_tests():
    """A module that moves is then a change of one line of the tests; what several tests need has a
    place of its own, as mechanisms have.
    """
    for path in sorted(TESTS.rglob("*.py")):
        # Few files have such a line, and to parse them all takes seconds.
        for node in nodes_of(path) if DOUBTFUL.search(path.read_text()) else ():
            parts = (node.module or "").split(".") if isinstance(node, ast.ImportFrom) else []
            inner = parts[:1] == ["lagrange_casadi"] and len(parts) > 1
            assert path.name == "internals.py" or not inner or ".".join(parts[1:]) in PUBLIC, (
                f"{path.name}:{node.lineno}: from {node.module}: take it from internals"
            )
            taken = [parts[0]] if parts else []
            taken += [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            assert path.parent.name not in ALONE or "internals" not in taken, path
            assert not [name for name in taken if name.startswith("test_")], (
                f"{path.name}:{node.lineno}"
            )


def length_of_code(path: Path) -> int:
    """Lines beside docstrings."""
    documented = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    length = len(path.read_text().splitlines())
    for node in nodes_of(path):
        if isinstance(node, documented) and ast.get_docstring(node) is not None:
            text = node.body[0]
            length -= text.end_lineno - text.lineno + 1
    return length


@pytest.mark.quick
def test_no_file_is_two_things():
    # A docstring with sections is as long as its arguments need; the limit is for code.
    for path in modules().values():
        assert length_of_code(path) <= 550, path
    for path in (*PACKAGE.rglob("*.js"), *TESTS.rglob("*.py")):
        assert len(path.read_text().splitlines()) <= 750, path
