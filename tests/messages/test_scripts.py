"""A mistake with a symbol in a script of the user's own is answered below Python's traceback."""

import subprocess
import sys

import pytest

SCRIPT = "from lagrange_casadi import Mechanism\nlength = Mechanism('press').parameter('l', 0.3)\n"
CELL = """from IPython.core.interactiveshell import InteractiveShell
InteractiveShell.instance().run_cell({!r})"""


def ended(script):
    """Exit status, and the last line that is printed as an error."""
    ran = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    return ran.returncode, ran.stderr.splitlines()[-1]


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("max(length, 0.2)", "lagrange_casadi: a symbol has no truth value: use casadi.if_else"),
        ("int(length)", "lagrange_casadi: a symbol has no number while"),
        ("length - '5 mm'", "lagrange_casadi: a text with a unit goes into no formula"),
        (
            "import numpy; numpy.polyval([1, 2], length)",
            "lagrange_casadi: NumPy's polyval takes no",
        ),
        ("1 / 0", "ZeroDivisionError: division by zero"),
    ],
)
def test_a_mistake_with_a_symbol_is_answered(line, says):
    status, last = ended(SCRIPT + line)
    assert status == 1
    assert last.startswith(says)


def test_and_in_a_notebook():
    pytest.importorskip("IPython")
    assert ended(CELL.format(SCRIPT + "max(length, 0.2)"))[1].endswith("fmax for 'min' and 'max'")
