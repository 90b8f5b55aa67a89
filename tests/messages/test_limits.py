"""Stations at the ends of links: one rule for all, within rounding."""

import math

import numpy as np
import pytest
from compiled import EVALUATED, told
from hypothesis import given, settings
from hypothesis import strategies as st
from internals import DesignEngine, Status

from lagrange_casadi import Mechanism, Scene, evaluate, export
from lagrange_casadi.errors import DeclarationError, ParameterError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("interpreted")

RATIOS = (0.0, 1.0, 3)
MISSES = {
    "0.1 + 0.2 on 0.3": (0.1 + 0.2, 0.3),
    "0.3 on 0.1 + 0.2": (0.3, 0.1 + 0.2),
    "its length": (0.3, 0.3),
}


def shelf(x, length):
    """A lump on a level arm, without a mass of its own."""
    m = Mechanism("shelf")
    arm = m.link("arm", length=length(m) if callable(length) else length, mass=0.0)
    m.revolute("O", m.ground, arm)
    m.weld("lump", arm.at(x(m) if callable(x) else x), m.point_mass("mass", 2.0))
    m.force("push", arm.at(x(m) if callable(x) else x), y=-1.0)
    return Scene(m, {"O": polynomial(0.0)}, t=(0.0, 1.0, 3), xi=RATIOS)


def parametric(x, length):
    return shelf(
        lambda m: m.parameters["x"].symbol if "x" in m.parameters else m.parameter("x", x, "m"),
        lambda m: m.parameter("l", length, "m"),
    )


@pytest.mark.parametrize("scene", [shelf, parametric])
@pytest.mark.parametrize("name", MISSES)
def test_a_station_that_misses_the_tip_by_rounding_is_there(scene, name):
    """The weight is in the section at the very tip, as that of what hangs on the tip itself is; and
    all checks hold.
    """
    x, length = MISSES[name]
    solution = evaluate(scene(x, length))
    weight = 2.0 * 9.81 + 1.0
    np.testing.assert_allclose(solution.section("arm").shear, np.full((3, 3), -weight), rtol=1e-14)
    np.testing.assert_allclose(
        solution.section("arm").bending[0],
        -weight * 0.3 * np.array([1.0, 0.5, 0.0]),
        rtol=1e-14,
        atol=1e-15,
    )
    assert all(load.station[0] == 1.0 for load in solution.section("arm").law.loads)
    assert (
        max(np.max(values) for key, values in solution.certificate.items() if key != "condition")
        < 1e-14
    )


@pytest.mark.parametrize("scene", [shelf, parametric])
@pytest.mark.parametrize("x", [0.1 + 0.2 - 0.3, 0.3 - (0.1 + 0.2), 0.0])
def test_a_station_that_misses_the_base_by_rounding_is_there(scene, x):
    """What is at the base loads no section."""
    solution = evaluate(scene(x, 0.3))
    np.testing.assert_array_equal(solution.section("arm").shear, np.zeros((3, 3)))
    assert (
        max(np.max(values) for key, values in solution.certificate.items() if key != "condition")
        < 1e-14
    )


@settings(max_examples=10, deadline=None)
@given(parts=st.lists(st.integers(1, 999), min_size=2, max_size=12))
def test_sums_of_decimals(parts):
    """However a length is summed up, the station at its end is at the end."""
    forward, backward = 0.0, 0.0
    for part in parts:
        forward += part / 1000
    for part in reversed(parts):
        backward += part / 1000
    for x, length in ((forward, backward), (backward, forward), (sum(parts) / 1000, forward)):
        law = evaluate(shelf(x, length), backend="vm").section("arm").law
        assert law.at("shear", np.ones((3, 1)))[0, 0] == pytest.approx(-20.62)


def test_all_programs_draw_the_line_at_the_same_place(tmp_path):
    """The API, sweeps and exported C: a part in 1e9 beyond the end is beyond it."""
    scene = parametric(0.1, 0.3)
    places = {0.3 + 1e-9: True, -1e-9: True, 0.3 + 1e-14: False, -1e-14: False}
    for x, misses in places.items():
        if not misses:
            evaluate(scene, parameters={"x": x})
            continue
        with pytest.raises(ParameterError, match=r"point at .* m is outside link 'arm', 0 to 0\.3"):
            evaluate(scene, parameters={"x": x})
    engine = DesignEngine.of(scene, ["section:arm"])
    rows = np.array([[{"x": x, "l": 0.3}[name] for name in engine.parameters] for x in places])
    assert engine.evaluate(rows).status.tolist() == [
        Status.IMPOSSIBLE if misses else Status.OK for misses in places.values()
    ]
    prepare = "parameters.x = {!r}; status = @_prepare(&model, &parameters); "
    evaluated = "@_motion(&model, 0.5, &inputs); " + EVALUATED
    tried = (
        prepare.format(x) + ("outputs.effort_O = 0;" if misses else evaluated)
        for x, misses in places.items()
    )
    found = told(tmp_path, export(scene, tmp_path), *tried)
    assert [code != 0 for code, *_ in found] == [*places.values()]


def test_in_single_precision_it_is_the_rounding_of_singles(tmp_path):
    scene = parametric(0.1, 0.3)
    made = export(scene, tmp_path, precision="single")
    prepare = "parameters.x = {}; status = @_prepare(&model, &parameters); outputs.effort_O = 0;"
    lengths = {"0.1f + 0.2f": False, "0.3f*(1 + 3e-7f)": False, "0.3f*(1 + 1e-5f)": True}
    found = told(tmp_path, made, *map(prepare.format, lengths))
    assert [code != 0 for code, *_ in found] == [*lengths.values()]


def plated():
    m = Mechanism("plated")
    rod = m.link("rod", length=0.5, mass=1.0)
    plate = m.link("plate", length=0.5, mass=1.0, centre=(0.1, 0.0), inertia=0.1)
    m.revolute("O", m.ground, rod)
    m.revolute("A", rod.tip, plate)
    m.weld("W", plate.tip, m.point_mass("lump", 1.0))
    return Scene(m, {"O": polynomial(0, 1), "A": polynomial(0, 1)}, t=(0, 1, 3))


@pytest.mark.parametrize(
    ("part", "why"),
    [
        (
            "plate",
            ("link 'plate' has sections only if its mass is given along it"),
        ),
        ("lump", "'lump' is not a link and has no sections; links: rod, plate"),
    ],
)
def test_the_same_explanation_wherever_sections_are_asked_for(part, why):
    solution = evaluate(plated())
    for ask in (
        lambda: evaluate(plated(), wanted=[f"section:{part}"]),
        lambda: solution.section(part),
        lambda: solution.peak(f"section:{part}:bending"),
        lambda: solution.array(f"section:{part}:shear"),
        lambda: solution.unit(f"section:{part}:axial"),
    ):
        with pytest.raises(DeclarationError, match=why):
            ask()


def test_sections_that_were_not_wanted_say_so():
    solution = evaluate(plated(), wanted=["effort"])
    for ask in (lambda: solution.section("rod"), lambda: solution.peak("section:rod:bending")):
        with pytest.raises(
            DeclarationError,
            match="the sections of link 'rod' were not evaluated; add section:rod",
        ):
            ask()


def test_impossible_defaults_are_told_to_be_defaults():
    m = Mechanism("m")
    arm = m.link("arm", length=m.parameter("l", 0.2, "m"), mass=1.0)
    m.revolute("O", m.ground, arm)
    m.weld("W", arm.at(0.3), m.point_mass("p", 1.0))
    with pytest.raises(
        ParameterError,
        match=(
            r"point at 0\.3 m is outside link 'arm', 0 to 0\.2 m; .*; with the default parameters l"
            r" = 0\.2"
        ),
    ):
        Scene(m, {"O": polynomial(math.pi)})
