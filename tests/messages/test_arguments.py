"""Numbers and texts with units, wherever a declaration takes a number; and what solutions give to
NumPy, notebooks and printers.
"""

import math
import sys
from types import ModuleType

import numpy as np
import pytest
from internals import public, typed
from internals import units_number as number

from lagrange_casadi import Mechanism, Scene, evaluate, optimise, prepare, save
from lagrange_casadi.errors import DeclarationError, ParameterError, PathError, warn
from lagrange_casadi.motion import harmonic, polynomial, samples

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("100 mm", "m", 0.1),
        ("0.3mm", "m", 0.0003),
        ("500 g", "kg", 0.5),
        ("20 ms", "s", 0.02),
        ("90 deg/s", "rad/s", math.pi / 2),
    ],
)
def test_texts_are_numbers_of_their_unit(text, unit, value):
    assert number(text, unit) == value
    assert typed(text) == (value, unit)


@pytest.mark.parametrize(
    "value",
    [
        True,
        np.True_,
        "3",
        "3 deg",
        b"3",
        10**400,
        None,
        [1.0],
        np.ones(1),
        1j,
        np.datetime64("2020"),
    ],
)
def test_what_is_no_length_is_refused(value):
    m = Mechanism("m")
    with pytest.raises(DeclarationError):
        m.link("a", length=value, mass=1.0)
    m.parameter("p", 1.0, "m")
    with pytest.raises(ParameterError):
        m.values({"p": value})


def swing(law, t=(0, 1, 5), **texts):
    m = Mechanism("swing")
    m.revolute("O", m.ground, m.link("arm", **({"length": 0.1, "mass": 0.5} | texts)))
    return Scene(m, {"O": law}, t=t)


def test_texts_give_the_same_forces_to_the_bit():
    plain = evaluate(swing(polynomial(math.pi / 4, 2 * math.pi)))
    told = evaluate(
        swing(
            polynomial("45 deg", "360 deg/s"),
            t=("0 s", "1000 ms", 5),
            length="100 mm",
            mass="500 g",
        )
    )
    np.testing.assert_array_equal(told.effort("O"), plain.effort("O"))
    for law in (
        harmonic("1 deg", "2 deg", 1.0),
        samples([0, 1, 2, 3], ["0 deg", "1 deg", "3 deg", "2 deg"]),
    ):
        assert law.unit == "rad"
    with pytest.raises(DeclarationError, match="the law is in m, but the coordinate is in rad"):
        swing(polynomial("10 mm"))
    with pytest.raises(DeclarationError, match="name them: length=, mass="):
        Mechanism("m").link("a", 0.1, 1.0)


def test_degrees_over_a_drive_are_questioned():
    scene = swing(polynomial(0.0, 400.0))
    with pytest.raises(DeclarationError, match="more than two turns; '360 deg' is 360 degrees"):
        evaluate(scene, over=("O", 0, 360, 7))
    assert evaluate(scene, over=("O", 0, "360 rad", 7)).over[-1] == 360.0


def test_what_a_solution_gives(tmp_path):
    solution = evaluate(swing(polynomial(0.0, 2 * math.pi)), over=("O", 0, "350 deg", 8))
    np.testing.assert_array_equal(np.degrees(solution.over), np.degrees(solution.over.values))
    assert (2 * solution.over + 1).shape == (8,)
    reaction = solution.reaction("O")
    assert not hasattr(reaction, "fz")
    for shown in (reaction, solution.motion("O"), solution.pose("arm"), solution.over):
        assert len(repr(shown)) < 400
    with pytest.raises(PathError, match="results are kept as HDF5"):
        save(solution, tmp_path / "x.csv")
    assert "<img" in solution.animate(tmp_path / "a.svg")._repr_html_()


def test_a_warning_is_at_the_users_line(monkeypatch):
    """However many functions of the package are between, as those that look at arguments."""
    monkeypatch.setitem(
        sys.modules, "lagrange_casadi.made", made := ModuleType("lagrange_casadi.made")
    )
    inner = vars(made)
    inner.update(warn=warn, public=public)
    exec("@public\ndef outer(n: int):\n    inside()\ndef inside():\n    warn('so it is')", inner)
    with pytest.warns(UserWarning, match="so it is") as caught:
        inner["outer"](3)
    assert caught[0].filename == __file__


def test_arrays_of_names_and_huge_counts():
    scene = swing(polynomial(0.0, 1.0))
    assert prepare(scene, wanted=np.array(["effort"]), backend="vm").outputs == ("effort:O",)
    with pytest.raises(
        DeclarationError, match=r"wanted: expected a list of output names, got array"
    ):
        prepare(scene, wanted=np.array([1.0, 2.0]), backend="vm")
    m = Mechanism("m")
    m.revolute("O", m.ground, m.link("arm", length=m.parameter("l", 0.1, "m"), mass=0.5))
    with pytest.raises(
        DeclarationError, match="starts: expected a whole number from 1 to 16777216"
    ):
        optimise(
            Scene(m, {"O": polynomial(0.0, 1.0)}),
            minimise="l",
            over={"l": (0.1, 0.2)},
            starts=10**40,
        )
