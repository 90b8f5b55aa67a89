"""Python's own choices between symbols, wherever a user's function is called: the error says what
makes them instead.
"""

import pytest

from lagrange_casadi import Mechanism, Scene, elements, evaluate
from lagrange_casadi.case import load_case
from lagrange_casadi.errors import LagrangeCasadiError
from lagrange_casadi.motion import expression

pytestmark = pytest.mark.usefixtures("interpreted")

CHOICES = {
    "max": lambda x: max(0, x),
    "min": lambda x: min(0.1, x),
    "if": lambda x: x if x > 0 else 0.0,
    "and": lambda x: x > 0 and x,
    "sorted": lambda x: sorted([x, 0.1])[0],
    "clip": lambda x: 0.0 < x < 1.0,
}


def moved(choice):
    m = Mechanism("m")
    m.revolute("O", m.ground, m.link("a", length=0.1, mass=1.0))
    evaluate(Scene(m, {"O": expression(choice)}))


def loaded(choice):
    m = Mechanism("m")
    m.line_load("wind", m.link("a", length=0.1, mass=1.0), y=choice)


def lifted(choice):
    m = Mechanism("m")
    disc, stem = m.link("disc", length=0.1, mass=1.0), m.link("stem", length=0.1, mass=1.0)
    main = m.revolute("main", m.ground, disc)
    guide = m.prismatic("guide", m.ground, stem, axis=(0, 1), angle="90 deg")
    elements.disc_cam(m, "cam", main, guide, choice, base_radius=0.03)


@pytest.mark.parametrize("called", [moved, loaded, lifted], ids=lambda called: called.__name__)
@pytest.mark.parametrize("choice", CHOICES)
def test_a_function_that_chooses_is_told_what_does(called, choice):
    with pytest.raises(
        LagrangeCasadiError, match=r"casadi\.if_else.* casadi\.fmin and fmax for 'min' and 'max'"
    ):
        called(CHOICES[choice])


@pytest.mark.parametrize(
    "words", ["max(0, m.rate(pin))", "m.rate(pin) if m.rate(pin) > 0 else 0", "m.time > 1 and 2"]
)
def test_a_case_that_chooses_is_told_what_does(words, tmp_path):
    (tmp_path / "case.py").write_text(
        "from lagrange_casadi import Mechanism\n"
        "def scene():\n"
        "    m = Mechanism('m')\n"
        "    pin = m.revolute('O', m.ground, m.link('a', length=0.1, mass=1.0))\n"
        f"    m.torque('brake', m.links['a'], {words})\n"
    )
    with pytest.raises(
        LagrangeCasadiError, match=r"line 5.*casadi\.fmin and fmax for 'min' and 'max'"
    ):
        load_case(tmp_path)
