"""What people are told: of symbols that Python cannot use, of what a run replaced, in numbers that
can be read.
"""

import math
import os

import numpy as np
import pytest
from internals import peak_line

from lagrange_casadi import Mechanism, Peak, Scene, evaluate, load_case, sweep
from lagrange_casadi.cli import main
from lagrange_casadi.errors import DeclarationError, ParameterError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.quick

CASE = """
import math
import numpy as np
from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.motion import expression, polynomial
def scene():
    m = Mechanism("pendulum")
    arm = m.link("arm", length=0.3, mass=1.0)
    O = m.revolute("O", m.ground, arm)
    m.force("push", arm.tip, x={x})
    return Scene(m, {{"O": {law}}}, t=(0, 1, 5))
"""


def swinging(x=lambda t: 0.0, law=None):
    m = Mechanism("pendulum")
    arm = m.link("arm", length=0.3, mass=1.0)
    m.revolute("O", m.ground, arm)
    m.force("push", arm.tip, x=x(m.time))
    return Scene(m, {"O": law or polynomial(0, 1.0)}, t=(0.2, 1, 9))


@pytest.mark.parametrize(
    "function", [math.sin, float, lambda t: math.atan2(t, 0.5), lambda t: np.array(t)]
)
def test_functions_of_math_name_casadis(function):
    with pytest.raises(
        DeclarationError,
        match=(
            r"load 'push' must be finite, got nan; the functions of math .* use casadi\.sin,"
            r" casadi\.fmax and the like$"
        ),
    ):
        swinging(function)


FUNCTIONS = {
    "sin": np.sin,
    "hypot": lambda t: np.hypot(t, 0.4),
    "arctan2": lambda t: np.arctan2(t, -0.3),
    "where": lambda t: np.where(t > 0.55, 3.0 * t, -1.0),
    "interp": lambda t: np.interp(t, [0.3, 0.5, 0.9], [1.0, 4.0, -2.0]),
    "heaviside": lambda t: np.heaviside(t - 0.5, 0.25),
    "clip": lambda t: np.clip(t, 0.35, 0.75),
    "deg2rad": np.deg2rad,
    "maximum": lambda t: np.maximum(t, 0.5) - np.minimum(t, 0.4),
    "power": lambda t: (
        np.power(t, 3) + np.sqrt(t) + np.abs(t - 0.5) + np.floor(3 * t) + np.mod(t, 0.3)
    ),
}


@pytest.mark.sampled(7)
@pytest.mark.filterwarnings("ignore::FutureWarning")
@pytest.mark.parametrize("name", FUNCTIONS)
def test_numpys_functions_of_symbols_are_what_they_are_of_numbers(name):
    """They go into the graph as CasADi's own: the load at every instant
    is NumPy's own value there.
    """
    function = FUNCTIONS[name]
    solution = evaluate(swinging(function), wanted=["load"])
    np.testing.assert_allclose(
        solution.array("load:push:fx"), function(solution.t), rtol=1e-15, atol=1e-15
    )


def test_a_note_about_numpy_does_not_fill_the_screen(here, capfd):
    (here / "case.py").write_text(
        CASE.format(x="np.sin(m.time)", law="expression(lambda t: np.sin(t))")
    )
    assert main(["run", "case.py", "--no-figures"]) == 0
    assert capfd.readouterr().err == ""


def test_no_minus_zero_is_told():
    solution = evaluate(swinging(), wanted=["effort"])
    assert "-0 " not in peak_line(solution, Peak("effort:O", -0.0, "N m", 0.2))


def test_numbers_are_told_as_they_are_read():
    m = Mechanism("m")
    m.parameter("a", 0.3, "m", low=0.1, high=0.35)
    b = m.parameter("b", 0.1, "m")
    m.revolute("O", m.ground, m.link("arm", length=b / 3, mass=1.0))
    for value, says in (
        (0.36, "= 0.36 m is out of its range [0.1, 0.35]"),
        (0.35000000001, "= 0.35000000001 m is out of its range"),
    ):
        with pytest.raises(ParameterError) as error:
            m.values({"a": value})
        assert says in str(error.value)
    with pytest.raises(
        ParameterError, match=r"link 'arm': length must be positive, got -0\.0333333 m$"
    ):
        m.values({"b": -0.1})


def test_run_says_what_it_replaced(here, capsys):
    arguments = ["run", "four_bar", "--t", "0:0.1:21", "--want", "effort"]
    assert main(arguments) == 0
    assert "replaced" not in capsys.readouterr().out
    assert main(arguments) == 0
    out = capsys.readouterr().out
    assert "replaced four_bar.h5 and 1 figure in four_bar_figures/\n" in out
    assert "older" not in out
    assert main([*arguments, "--no-figures"]) == 0
    out = capsys.readouterr().out
    assert "replaced four_bar.h5\n" in out
    older = "note: figures in four_bar_figures/ that are older than four_bar.h5: effort_O.png; "
    assert (
        f"{older}lagrange-casadi plot four_bar.h5 --out four_bar_figures draws them anew\n" in out
    )
    assert main(["run", "four_bar", "--t", "0:0.1:21", "--want", "reaction:O"]) == 0
    out = capsys.readouterr().out
    assert (
        "note: figures in four_bar_figures/ that are older than four_bar.h5: effort_O.png\n" in out
    )
    assert main([*arguments, "--out", "other.h5", "--no-figures"]) == 0
    assert "older" not in capsys.readouterr().out


def test_a_command_is_told_commands(here, capfd):
    assert main(["run", "four_bar", "--t", "0:0.1:5", "--want", "effort", "--no-figures"]) == 0
    capfd.readouterr()
    assert main(["table", "four_bar.h5"]) == 1
    says = (
        "not the file of a sweep, but that of a run, which the commands info, plot and check read\n"
    )
    assert capfd.readouterr().err == f"error: four_bar.h5: {says}"
    sweep(
        load_case("four_bar"),
        {"a": [0.1]},
        wanted=["effort"],
        t=(0, 0.1, 5),
        out=os.path.join(here, "s.h5"),
    )
    assert main(["run", "four_bar", "--out", "s.h5"]) == 2
