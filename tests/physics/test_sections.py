"""Forces inside links under loads along them and at points: the beams of the textbooks, signs,
ends and peaks.
"""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from mechanisms import links_of, pins_of

from lagrange_casadi import (
    Mechanism,
    Scene,
    SpatialMechanism,
    curve,
    density,
    evaluate,
    motion,
    prepare,
)
from lagrange_casadi.errors import DeclarationError, ParameterError
from lagrange_casadi.motion import harmonic

pytestmark = pytest.mark.usefixtures("interpreted")

LENGTH, AT, LOAD = 2.0, 0.25, 10.0


def cantilever(tip):
    """The forces in a beam from a wall along x, without gravity, whose tip bears the force ``tip``
    along y.
    """
    m = Mechanism("cantilever")
    m.set_gravity(0, 0)
    beam = m.link("beam", length=LENGTH, mass=1.0)
    m.weld("wall", m.ground, beam)
    m.force("load", beam.tip, y=tip)
    return evaluate(Scene(m, {}, t=(0, 1, 2), xi=(0, 1, 5))).section("beam")


def fibre(side, tip, height=0.1, reach=0.3):
    """The moment that a fibre at ``side`` (1: that of n) bears, by its tension: what the pin in the
    other fibre cannot.
    """
    m = Mechanism("fibres")
    m.set_gravity(0, 0)
    beam, bar = links_of(m, beam=(LENGTH * (1 - AT), 1.0), bar=(reach, 1.0))
    pins_of(
        m,
        pin=(m.ground.at(LENGTH * AT, -side * height / 2), beam.at(0, -side * height / 2)),
        back=(m.ground.at(LENGTH * AT - reach, side * height / 2), bar),
        front=(bar.tip, beam.at(0, side * height / 2)),
    )
    m.force("load", beam.tip, y=tip)
    solution = evaluate(Scene(m, {}, t=(0, 1, 2), posture={"bar": 0.0, "beam": 0.0}))
    return height * solution.section("bar").axial[0, 0]


@pytest.mark.parametrize("tip", [-LOAD, LOAD])
def test_a_positive_moment_stretches_the_fibres_away_from_n(tip):
    section = cantilever(tip)
    bending = section.bending[0, np.searchsorted(section.xi, AT)]
    assert bending == pytest.approx(tip * LENGTH * (1 - AT), rel=1e-12)
    assert fibre(-1, tip) == pytest.approx(bending, rel=1e-12)
    assert fibre(1, tip) == pytest.approx(-bending, rel=1e-12)


def declared(place="rod", **spread):
    """A rod and a ball, and a load along one of them, from ``low`` to 0.6 m where asked."""
    m = Mechanism("refused")
    bodies = {"rod": m.link("rod", length=1.0, mass=1.0), "ball": m.point_mass("ball", 1.0)}
    low = m.parameter("low", 0.2, "m")
    if spread.get("between") == "low":
        spread["between"] = (low, 0.6)
    if spread.get("between") == "time":
        spread["between"] = (0.0, m.time)
    m.line_load("wind", bodies.get(place, m.ground), **{"y": 1.0, **spread})
    m.revolute("J", m.ground, bodies["rod"])
    m.weld("W", bodies["rod"].tip, bodies["ball"])
    return Scene(m, {"J": motion.polynomial(0.0)}, t=(0, 1, 3))


ONE = "expected one value, two values at its start and end, or a function of the distance .*, got"

DEGREE = "must be a polynomial of the distance from the base, of degree 7 at most; use one"

FOREIGN = ca.SX.sym("foreign")


@pytest.mark.parametrize(
    ("spread", "says"),
    [
        ({"place": "ball"}, "expected a link for a line load, got 'ball'; use a force"),
        ({"place": "ground"}, "expected a link for a line load, got 'ground'; use a force"),
        ({"y": (1.0, 2.0, 3.0)}, ONE),
        ({"y": ()}, ONE),
        ({"y": "strong"}, r"expected a finite number \[N/m\]"),
        ({"y": FOREIGN}, "depends on 'foreign'"),
        ({"y": lambda xi: xi * FOREIGN}, "depends on 'foreign'"),
        ({"y": ca.sin}, DEGREE),
        ({"y": curve([0.0, 0.3, 0.6, 1.0], [1.0, 2.0, 1.5, 0.0])}, DEGREE),
        ({"y": lambda xi: xi**8}, DEGREE),
        ({"y": lambda xi: 1 / (1 + xi)}, DEGREE),
        ({"y": lambda xi: ca.if_else(xi < 0.5, 1.0, 2.0)}, DEGREE),
        ({"y": lambda xi: 2**xi}, DEGREE),
        ({"y": lambda xi: xi * (1 / 0)}, "cannot be made .*: ZeroDivisionError"),
        ({"y": lambda xi: xi if xi > 0 else 0}, "cannot be .*: a symbol has no truth"),
        ({"y": lambda xi: ca.vertcat(xi, xi)}, r"must be a scalar, got one of shape \(2, 1\)"),
        ({"between": 0.3}, "between must be two distances from the base of 'rod'"),
        ({"between": "time"}, "between depends on 't', not a parameter"),
        ({"between": (0.5, 0.5)}, r"between must be two increasing distances .*, got 0\.5"),
    ],
)
def test_what_is_no_line_load_is_refused_by_name(spread, says):
    with pytest.raises(DeclarationError, match=f"load 'wind':? {says}"):
        declared(**spread)


def test_parameters_that_move_a_load_off_its_link_are_refused():
    scene = declared(between="low")
    for low, says in (
        (-0.1, "acts between -0.1 and 0.6 m, but link 'rod' is from 0 to 1 m"),
        (0.7, r"acts between 0\.7 and 0\.6 m; expected an end greater than the start"),
    ):
        with pytest.raises(ParameterError, match=f"load 'wind': it {says}"):
            evaluate(scene, parameters={"low": low})
    found = prepare(scene).designs(np.array([[0.2], [-0.1], [0.6], [0.7]]))
    assert (found.status == 0).tolist() == [True, False, False, False]


SPAN = 3.0


def supported(mass=0.0, **spread):
    """A beam at rest on a pin and on a roller, without gravity; at its base it stands on a
    carriage.
    """
    m = Mechanism("supported")
    m.set_gravity(0.0, 0.0)
    carriage, beam = m.point_mass("carriage", 1.0), m.link("beam", length=SPAN, mass=mass)
    m.prismatic("rail", m.ground, carriage, axis=(1, 0))
    m.revolute("pin", carriage, beam)
    m.slot("roller", m.ground, beam.tip)
    m.line_load("q", beam, **spread)
    scene = Scene(
        m, {"rail": motion.polynomial(0.0)}, t=(0, 1, 3), xi=(0, 1, 61), posture={"beam": 0.0}
    )
    return evaluate(scene)


@pytest.mark.quick
def test_a_short_load_is_a_force():
    """However short it is, it loses no digits; a millionth of the link carries as much as the force
    that it is.
    """
    force, end = 40.0, 1.0 + 1e-6 * SPAN
    width = end - 1.0
    solution = supported(y=-force / width, between=(1.0, end))
    middle = (1.0 + width / 2) / SPAN
    far = np.abs(solution.xi - middle) > 1e-3
    shear = -force * np.where(solution.xi < middle, 1 - middle, -middle)
    bending = (
        force
        * SPAN
        * np.where(solution.xi < middle, (1 - middle) * solution.xi, middle * (1 - solution.xi))
    )
    np.testing.assert_allclose(
        solution.section("beam").shear[0][far], shear[far], rtol=0, atol=1e-14 * force
    )
    np.testing.assert_allclose(
        solution.section("beam").bending[0][far], bending[far], rtol=0, atol=1e-14 * force * SPAN
    )


@pytest.mark.parametrize(
    ("moments", "says"),
    [
        (
            {"yy": -1e-3, "zz": 1e-3},
            (
                "link 'a': impossible second moments of slices: yy, zz and yy zz - yz yz must not"
                " be negative"
            ),
        ),
        ({"yy": 1e-3, "zz": 1e-3, "yz": 2e-3}, "link 'a': impossible second moments of slices"),
        (
            {"yy": 1e-3, "zz": density.polynomial(1e-3, -3e-3)},
            "link 'a': impossible second moments of slices",
        ),
    ],
)
def test_slices_that_cannot_be_are_refused(moments, says):
    m = SpatialMechanism("m")
    m.revolute(
        "O",
        m.ground,
        m.link("a", length=0.5, density=density.thick(density.polynomial(1.0), **moments)),
    )
    with pytest.raises(ParameterError, match=says):
        evaluate(Scene(m, {"O": motion.polynomial(0.0, 1.0)}, t=(0, 1, 3)))


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (
            lambda: Mechanism("m").link(
                "a", length=0.5, density=density.thick(density.polynomial(1.0), yy=1e-3, zz=1e-3)
            ),
            "link 'a': second moments of slices are for links in space",
        ),
        (
            lambda: density.thick(3.0, yy=1e-3, zz=1e-3),
            r"density thick: expected a density of lagrange_casadi\.density, got 3\.0",
        ),
        (
            lambda: density.thick(density.polynomial(1.0), yy=density.uniform(1e-3), zz=1e-3),
            "density thick: second moments are numbers, or along the link by polynomial",
        ),
    ],
)
def test_what_has_no_slices_is_named(make, says):
    with pytest.raises(DeclarationError, match=says):
        make()


def loaded(place, ratios):
    """A bar at rest with a force at a place, and outputs of what sections feel of it."""
    m = Mechanism("bar")
    bar = m.link("bar", length=0.3, mass=1e-12)
    m.revolute("O", m.ground, bar)
    m.force("F", bar.at(place), y=-10.0)
    for k, ratio in enumerate(ratios):
        m.output(f"shear_{k}", m.results.section(bar, ratio).shear, unit="N")
    return evaluate(Scene(m, {"O": harmonic(0.0, 0.0, 1.0)}, t=(0.0, 1.0, 2)), xi=(0, 1, 4))


@pytest.mark.parametrize(
    ("place", "rest"),
    [(0.1, [-10, 0, 0, 0]), (0.2, [-10, -10, 0, 0]), (0.3, [-10] * 4), (0.0, [0] * 4)],
)
def test_a_section_at_a_load_point_is_on_its_tip_s_side_whatever_rounding_says(place, rest):
    """A tenth of a metre over three tenths is not one third in doubles."""
    assert np.linspace(0, 1, 4)[1] != 0.1 / 0.3
    found = loaded(place, np.linspace(0, 1, 4).tolist())
    np.testing.assert_allclose(found.section("bar").shear[0], rest, atol=1e-9)
    np.testing.assert_allclose([found.output(f"shear_{k}")[0] for k in range(4)], rest, atol=1e-9)
