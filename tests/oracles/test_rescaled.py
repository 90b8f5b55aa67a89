"""Results do not depend on units: a scene in other ones has the same verdicts, and results that are
the former ones times the sizes of their units.
"""

import drawings
import numpy as np
import pytest
import random_mechanisms
import spatial_anyhow
import spatial_bridge
import spatial_mechanisms
from conftest import CASES
from mechanisms import PLAIN
from rescaled import Rescaling, Units

from lagrange_casadi import Scene, SpatialMechanism, evaluate, load_case
from lagrange_casadi.errors import LagrangeCasadiError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("interpreted")

OTHER = [
    Units(**{unit: 2.0**power}) for power in (40, -40) for unit in ("metre", "kilogram", "second")
]
SPATIAL = [
    spatial_anyhow.anyhow,
    *(
        getattr(spatial_mechanisms, name)
        for name in (
            "tree",
            "arm",
            "rssr",
            "rsur",
            "rssp",
            "rsup",
            "stewart",
            "planar_four_bar",
            "planar_slider_crank",
            "bennett",
            "bricard",
            "loop",
            "suspension",
        )
    ),
]
ROUNDED = 1e-10
"""Of the largest quantity of its kind: iterated loops are closed by other roundings."""
AT_REST = 1e-15
"""Rates and accelerations [SI] of mechanisms of about a metre that stand still."""
MANY_DIGITS = 1.0 + 2.0**-20 / 3.0
"""Instants between ends of few decimals are rounded to decimals, which other units do not share."""


def result(scene, **keywords):
    """A solution, or the kind of the error."""
    try:
        return evaluate(scene, **keywords)
    except LagrangeCasadiError as error:
        return type(error)


def assert_the_same(scene, units, keywords=None, rescaled=None):
    """The same verdicts, residuals, errors and results in other units."""
    here = result(scene, **(keywords or {}))
    there = result(units.scene(scene), **(rescaled or {}))
    if isinstance(here, type) or isinstance(there, type):
        assert here is there
        return
    indeterminate = [output for output in here.indeterminate if output.group != "output"]
    assert indeterminate == [*there.indeterminate]
    assert here.certified == there.certified
    assert {*here.failed} == {*there.failed}
    for name, residuals in here.certificate.items():
        np.testing.assert_allclose(
            there.certificate[name], residuals, rtol=3.0, atol=1e-13, err_msg=name
        )
    peaks, exact = {}, True
    for output, values in here.outputs.items():
        unit = here.unit(output)
        peaks[unit] = max(peaks.get(unit, 0.0), np.max(np.abs(values), initial=0.0))
    for output, values in here.outputs.items():
        if output.group != "output":
            size = units.of(scene, here, output)
            again = there.outputs[output] / size
            exact &= np.array_equal(again, values, equal_nan=True)
            atol = max(ROUNDED * peaks[here.unit(output)], AT_REST * (output.group == "motion"))
            np.testing.assert_allclose(again, values, rtol=0, atol=atol, err_msg=str(output))
    for output, error in here.errors.items():
        if exact and output in here.outputs and output.group != "output":
            size = units.of(scene, here, output)
            assert there.errors[output] / size == pytest.approx(error, rel=1e-6), output


@pytest.mark.sampled(29)
@pytest.mark.parametrize("units", OTHER, ids=str)
@pytest.mark.parametrize("name", PLAIN)
def test_cases_do_not_depend_on_units(name, units):
    assert_the_same(load_case(CASES / name).scene, units)


def assert_drawn_the_same(seed):
    drawn, units = random_mechanisms.draw(seed), OTHER[seed % len(OTHER)]
    scene = drawn.scene()
    rescaling = Rescaling(units, scene)
    times = {
        name: (*told[:-2], told[-2] * MANY_DIGITS, told[-1])
        for name, told in drawn.keywords.items()
        if name in ("t", "over")
    }
    again = drawn.keywords | rescaling.timing(**times)
    assert_the_same(scene, units, drawn.keywords | times, again)


@pytest.mark.sampled(151)
@pytest.mark.parametrize("seed", range(1200))
def test_random_mechanisms_do_not_depend_on_units(seed):
    assert_drawn_the_same(seed)


@pytest.mark.parametrize("seed", [9, 12, 21, 27, 41, 468, 687, 835, 863, 870, 997])
def test_nor_do_these_that_did(seed):
    """By a misfit, a dead centre, a rank twice, and a bar between slots at a steady rate; a length
    with which a constraint holds exactly, constraints of another size beside joints, slides askew
    by a parameter, and rest.
    """
    assert_drawn_the_same(seed)


def assert_drawn_the_same_in_space(seed, units):
    drawn = spatial_bridge.plain(SPATIAL[seed % len(SPATIAL)](seed))
    assert_the_same(spatial_bridge.declared(drawn), units)


@pytest.mark.sampled(347)
@pytest.mark.parametrize("seed", range(1200))
def test_random_mechanisms_in_space_do_not_depend_on_units(seed):
    # Every kind of mechanism in each of the units: their numbers are both even.
    assert_drawn_the_same_in_space(seed, OTHER[seed // 2 % len(OTHER)])


@pytest.mark.parametrize(("seed", "power"), [(12, -40), (714, 40)])
def test_nor_do_these_in_space_that_did(seed, power):
    """By sines beside gaps, and slides among the inputs at places of two loads."""
    assert_drawn_the_same_in_space(seed, Units(metre=2.0**power))


@pytest.mark.parametrize("name", ["bricard", "screw_lift"])
def test_nor_do_drawings_that_are_rounded(name):
    """Nor the least gaps of what does not close, and what is lost where equilibrium leaves it."""
    assert_the_same(drawings.drawn(name, 1e-9), Units(metre=2.0**20))


@pytest.mark.parametrize("speed", [1e-6, 1.0, 3e3, 1e5, 1e8])
def test_a_two_force_link_is_certified_at_any_speed(speed):
    """A spatial four-bar of 0.1 to 0.5 m: its residuals are those of rounding."""
    m = SpatialMechanism("rssr")
    lengths = {"crank": 0.1, "rod": 0.5, "rocker": 0.3}
    crank, rod, rocker = (m.link(name, length=x, mass=0.5) for name, x in lengths.items())
    m.revolute("A", m.ground, crank, axis=(0, 0, 1))
    m.spherical("B", crank.tip, rod)
    m.spherical("C", rod.tip, rocker.tip)
    m.revolute("D", m.ground.at(0.4, 0.2, 0.0), rocker, axis=(0, 1, 0))
    law = polynomial(0.3, speed, 0.1 * speed**2)
    scene = Scene(m, {"A": law}, t=(0.0, 2.0 / speed, 61), posture={"D": 1.36})
    residuals = evaluate(scene).certificate
    assert max(np.max(residuals[name]) for name in residuals if name != "condition") < 1e-14
