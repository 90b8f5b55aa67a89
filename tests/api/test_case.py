"""Loading cases: what a case may be, and what is said of one that is broken."""

import linecache

import pytest

from lagrange_casadi import Mechanism, load_case
from lagrange_casadi.errors import CaseError, DeclarationError

pytestmark = pytest.mark.quick

GOOD = """
from lagrange_casadi import Mechanism, Scene, motion

def scene():
    m = Mechanism("arm")
    m.revolute("J", m.ground, m.link("a", length=1, mass=1))
    return Scene(m, {"J": motion.polynomial(0, 1)})
"""


@pytest.mark.parametrize(
    ("given", "name"),
    [
        ("press_1.2", "press_1.2"),
        ("press_1.3/case.py", "press_1.3"),
        ("rod.v2.py", "rod.v2"),
        (".", "here.too"),
    ],
)
def test_a_name_keeps_what_looks_like_an_ending(tmp_path, monkeypatch, given, name):
    here = tmp_path / "here.too"
    for folder in (here, here / "press_1.2", here / "press_1.3"):
        folder.mkdir()
        (folder / "case.py").write_text(GOOD)
    (here / "rod.v2.py").write_text(GOOD)
    monkeypatch.chdir(here)
    assert load_case(given).name == name


DRAWN = """
import casadi, numpy
from lagrange_casadi.figures import TimePlot
def figures():
    return [TimePlot("f", ("effort:O",), factor={})]
"""
SLIPS = {
    "'100 mm' * m.parameter('p', 1)": "line 7: a text with a unit goes into no formula",
    "m.parameter('p', 1) - '5 mm'": "write its number in SI units, as 0.1 for '100 mm'",
    "int(m.parameter('p', 1))": "a symbol has no number while a mechanism is declared",
    "[1][m.parameter('p', 1)]": "line 7: a symbol has no number while",
    "max(m.parameter('p', 1), 2)": "line 7: a symbol has no truth value: use casadi.if_else",
    "m.parameter('p', 1).max()": r"line 7: an expression has no max: use .* casadi\.fmax\(a, b\)",
    "m.time[3]": "line 7: an expression is one number and has no parts: m.place",
    "list(m.time)": "line 7: an expression is one number and has no parts: m.place",
    "m.ground.at(1, 0)()": "line 7: 'Point' is no function: leave out the ()",
    "motion.polynomail": r"in lagrange_casadi\.motion 'polynomail' \(did you mean 'polynomial'",
    "from lagrange_casadi.elements import geers": r"'geers' \(did you mean 'gears'\?\)",
    "import lagrange_casadi; lagrange_casadi.evalute": r"'evalute' \(did you mean 'evaluate'",
}
STRANGE = ("casadi.SX.sym('x')", "1j", "b'1'", "len", "numpy.ones(2)", "{(1, 2): 3}", "{1}")


@pytest.mark.parametrize(
    ("text", "error", "says"),
    [
        (
            "x = 1\n\ny = 1 / 0\n",
            CaseError,
            r"case .*broken\.py, line 3: ZeroDivisionError: division by zero",
        ),
        ("def scene(:\n", CaseError, r"line 1: SyntaxError"),
        ("import nonsense_that_is_not_there\n", CaseError, "ModuleNotFoundError"),
        ("x = 1\n", CaseError, r"has no function scene\(\)"),
        ("scene = 3\n", CaseError, r"has no function scene\(\)"),
        (
            "def scene():\n    return 3\n",
            CaseError,
            r"scene\(\) returned int, expected a lagrange_casadi\.Scene",
        ),
        (
            "def scene():\n    raise ValueError('two\\nlines')\n",
            CaseError,
            r"line 2: ValueError: two lines$",
        ),
        (
            "class Odd(Exception):\n    __str__ = None\ndef scene():\n    raise Odd\n",
            CaseError,
            r"line 4: Odd$",
        ),
        *(
            (GOOD.replace("    return", f"    {line}\n    return"), CaseError, says)
            for line, says in SLIPS.items()
        ),
        *(
            (
                GOOD + DRAWN.format(value),
                DeclarationError,
                "TimePlot 'f': factor: expected a finite number, got ",
            )
            for value in STRANGE
        ),
        (
            GOOD.replace("length=1", "length='x'"),
            DeclarationError,
            "link 'a': length: expected a finite number",
        ),
    ],
)
def test_broken_cases_are_one_line(tmp_path, text, error, says):
    path = tmp_path / "broken.py"
    path.write_text(text)
    with pytest.raises(error, match=says):
        load_case(path)


def test_a_notebook_shows_the_cell_and_the_message(monkeypatch):
    cell = "m = Mechanism('x')\n\ndef arm():\n    m.link('a', length='5 kN')\n\narm()\n"
    monkeypatch.setitem(linecache.cache, "<cell>", (len(cell), None, cell.splitlines(), "<cell>"))
    with pytest.raises(DeclarationError) as raised:
        exec(compile(cell, "<cell>", "exec"), {"__name__": "__main__", "Mechanism": Mechanism})
    assert raised.value._render_traceback_() == [
        "line 4: m.link('a', length='5 kN')",
        "DeclarationError: link 'a': length: '5 kN' is a force; expected a length [m]",
    ]
