"""The public names are there after a bare import, no others are listed, and little is loaded before
it is asked for.
"""

import ast
import json
from pathlib import Path

import pytest
from commands import python

import lagrange_casadi as lc

pytestmark = pytest.mark.quick

STUB = Path(lc.__file__).with_suffix(".pyi")


def test_the_public_names_are_listed_and_nothing_else():
    tree = ast.parse(STUB.read_text())
    named = [
        alias.name for node in tree.body if isinstance(node, ast.ImportFrom) for alias in node.names
    ]
    (listed,) = (ast.literal_eval(node.value) for node in tree.body if isinstance(node, ast.Assign))
    assert sorted(listed) == sorted(named) == dir(lc) == sorted(lc.__all__)
    assert python("import lagrange_casadi as lc; print(*dir(lc))").split() == dir(lc)
    with pytest.raises(AttributeError, match="nothing"):
        _ = lc.nothing


def test_each_name_is_there_after_a_bare_import():
    """And is what its stub says: no module takes the place of a function of its name, in whatever
    order they are asked for; and what few need is not loaded yet.
    """
    program = """
import json, sys, lagrange_casadi as lc
names = dir(lc)
for name in (names, names[::-1])[int(sys.argv[1])]:
    getattr(lc, name)
loaded = [*sys.modules]
import lagrange_casadi.cli, lagrange_casadi.interop.exports, lagrange_casadi.studies.sweep
print(json.dumps([{name: type(getattr(lc, name)).__name__ for name in names}, loaded]))
"""
    tree = ast.parse(STUB.read_text())
    submodules = {
        a.name
        for node in tree.body
        if isinstance(node, ast.ImportFrom) and node.module is None
        for a in node.names
    }
    for order in ("0", "1"):
        kinds, loaded = json.loads(python(program, order))
        assert not {*loaded} & {"matplotlib", "tqdm", "distributed"}
        assert {name for name, kind in kinds.items() if kind == "module"} == submodules
        assert all(
            kinds[name] == "function"
            for name in ("evaluate", "sweep", "optimise", "export", "table", "check", "size")
        )


@pytest.mark.parametrize(
    ("program", "unneeded"),
    [
        (
            "import lagrange_casadi",
            ("numpy", "casadi", "h5py", "matplotlib", "lagrange_casadi.model"),
        ),
        (
            "import lagrange_casadi as lc; lc.Mechanism, lc.Scene, lc.evaluate",
            ("h5py", "matplotlib", "lagrange_casadi.engine.derive"),
        ),
        (
            "import lagrange_casadi.cli",
            ("numpy", "casadi", "h5py", "matplotlib", "tqdm", "lagrange_casadi.model"),
        ),
    ],
)
def test_what_is_not_asked_for_is_not_loaded(program, unneeded):
    loaded = python(f"{program}\nimport sys; print(*sys.modules)").split()
    assert not set(loaded) & set(unneeded)
