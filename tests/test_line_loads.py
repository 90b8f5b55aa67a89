"""Loads along links: exact in every section, by statics, by vector Newton-Euler,
and at free tips.
"""

import math

import casadi as ca
import numpy as np
import pytest
from balance import columns_at, oracle_of, postures
from exported import by_c99, compare, expected, exported, instants, solve
from hypothesis import given, settings
from hypothesis import strategies as st
from internals import DesignEngine, EvaluationMethod, Status

from lagrange_casadi import (
    Mechanism,
    Scene,
    curve,
    density,
    derive,
    evaluate,
    load,
    motion,
    refine,
    save,
)
from lagrange_casadi.errors import DeclarationError, ParameterError

pytestmark = pytest.mark.usefixtures("interpreted")

RATIOS = (0.0, 0.1234567, 0.5, 0.8176543, 1.0)


def beam(x=0.0, y=0.0, angle=0.0, turning=False, length=2.0, mass=3.0):
    """A cantilever at rest, without gravity."""
    m = Mechanism("beam")
    m.set_gravity(0.0, 0.0)
    arm = m.link("arm", length=length, mass=mass)
    m.revolute("wall", m.ground, arm)
    m.line_load("wind", arm, x=x, y=y, turning=turning)
    return Scene(m, {"wall": motion.polynomial(angle)}, t=(0, 1, 3), xi=(0, 1, 9))


def test_a_cantilever_of_the_textbooks():
    """Under an even load q: shear -q (l - xi) on the tip's side, bending -q (l - xi)^2/2, both
    nothing at the free tip.
    """
    solution = evaluate(beam(y=-7.0))
    free = 2.0 * (1.0 - solution.xi)
    section = solution.section("arm")
    np.testing.assert_allclose(section.shear[0], -7.0 * free, rtol=0, atol=1e-14 * 14)
    np.testing.assert_allclose(section.bending[0], -7.0 * free**2 / 2, rtol=0, atol=1e-14 * 14)
    np.testing.assert_array_equal(section.axial, 0.0)
    assert solution.effort("wall")[0] == pytest.approx(7.0 * 2.0**2 / 2, rel=1e-14)
    assert solution.reaction("wall").fy[0] == pytest.approx(14.0, rel=1e-14)
    assert solution.array("load:wind:fy")[0] == pytest.approx(-14.0, rel=1e-15)
    np.testing.assert_array_equal(solution.array("load:wind:mz"), 0.0)


def test_a_triangular_load_and_a_load_along_the_axis():
    """From nothing at the base to q at the tip: the moment at the wall is q l^2/3.

    Along the axis the sum beyond the section.
    """
    solution = evaluate(beam(y=(0.0, 6.0), x=(4.0, -2.0), angle=0.7, turning=True))
    u, l, section = solution.xi, 2.0, solution.section("arm")
    np.testing.assert_allclose(section.shear[0], 6.0 * l * (1 - u**2) / 2, rtol=0, atol=1e-13)
    np.testing.assert_allclose(
        section.bending[0], 6.0 * l * l * (1 / 3 - u / 2 + u**3 / 6), rtol=0, atol=1e-13
    )
    np.testing.assert_allclose(
        section.axial[0], l * (4.0 * (1 - u) - 6.0 * (1 - u**2) / 2), rtol=0, atol=1e-13
    )
    assert solution.section("arm").bending[0, 0] == pytest.approx(6.0 * l * l / 3, rel=1e-14)
    assert solution.array("load:wind:mz")[0] == pytest.approx(6.0 * l * l / 12, rel=1e-14)
    np.testing.assert_array_equal(
        [section.shear[:, -1], section.bending[:, -1], section.axial[:, -1]], 0.0
    )


def test_it_does_not_depend_on_how_the_mass_is_told_or_how_large_it_is():
    solutions = [evaluate(beam(y=(3.0, 5.0), mass=mass)) for mass in (3.0, 1e-6, 1e6)]
    m = Mechanism("told")
    m.set_gravity(0.0, 0.0)
    arm = m.link("arm", length=2.0, density=density.polynomial(1.5))
    m.revolute("wall", m.ground, arm)
    m.line_load("wind", arm, y=(3.0, 5.0))
    solutions.append(
        evaluate(Scene(m, {"wall": motion.polynomial(0.0)}, t=(0, 1, 3), xi=(0, 1, 9)))
    )
    for other in solutions[1:]:
        assert other.certified
        for force in ("shear", "bending"):
            expected_, found = (
                getattr(solutions[0].section("arm"), force),
                getattr(other.section("arm"), force),
            )
            np.testing.assert_allclose(
                found, expected_, rtol=0, atol=1e-13 * np.abs(expected_).max()
            )


def linkage(wind=(20.0, 60.0), lift=(-30.0, 10.0), **keywords):
    """A crank-rocker whose coupler and rocker are loaded along their length, by time, motion,
    parameters and a curve.
    """
    m = Mechanism("linkage")
    gust = m.parameter("gust", 1.0)
    a, b, c = (
        m.link(n, length=l, mass=w)
        for n, l, w in (("a", 0.1, 0.3), ("b", 0.35, 0.5), ("c", 0.25, 0.4))
    )
    m.revolute("O", m.ground, a)
    m.revolute("A", a.tip, b)
    m.revolute("B", b.tip, c.tip)
    rocker = m.revolute("C", m.ground.at(0.3, 0.05), c)
    shape = curve(
        np.linspace(0, 2 * math.pi, 9), [1.0, 1.2, 1.1, 0.9, 1.0, 1.3, 0.8, 0.7, 1.0], periodic=True
    )
    m.line_load("wind", b, x=tuple(gust * q * (1 + 0.2 * ca.sin(5 * m.time)) for q in wind), y=lift)
    m.line_load(
        "flow", c, y=(8.0 * shape(m.coordinate(rocker)), -3.0 * m.rate(rocker)), turning=True
    )
    m.force("pull", b.at(0.2, 0.03), x=5.0, y=-9.0)
    return (
        Scene(
            m,
            {"O": motion.polynomial(0.2, 3.0, 4.0)},
            posture={"c": 1.5},
            **({"t": (0.1, 0.9, 5)} | keywords),
        ),
        shape,
    )


def gaps(scene, shape, t, wind, lift):
    """The largest difference from the oracle, over the largest force: its loads are at Gauss's
    points on either side of a cut.
    """
    m, program = scene.mechanism, derive(scene)
    values = m.values()
    found, drives = columns_at(program, t, values)
    rough, nodes = postures(m, found, drives, 0.02), np.polynomial.legendre.leggauss(4)
    solution = evaluate(scene, t=(t, t, 1), backend="vm")
    worst = 0.0

    def spread(link, length, cut, at):
        for low, high in ((0.0, cut), (cut, 1.0)):
            for node, weight in zip(*nodes, strict=True):
                u = (low + high) / 2 + (high - low) / 2 * node
                fx, fy = at(u)
                share = length * (high - low) / 2 * weight
                yield (link, u * length, 0.0), share * fx, share * fy, 0.0

    for cut in (0.1234567, 0.5, 0.8176543):

        def loads(place, cut=cut):
            gust = 1 + 0.2 * math.sin(5 * t)
            yield from spread(
                "b",
                0.35,
                cut,
                lambda u: [a + (b - a) * u for a, b in ((gust * wind[0], gust * wind[1]), lift)],
            )
            angle = place(("c", 0.0, 0.0))[2]
            q, r = 8.0 * shape(float(angle.v)), -3.0 * angle.d
            c, s = math.cos(angle.v), math.sin(angle.v)
            yield from spread(
                "c", 0.25, cut, lambda u: (-s * (q + (r - q) * u), c * (q + (r - q) * u))
            )
            yield ("b", 0.2, 0.03), 5.0, -9.0, 0.0

        solved = oracle_of(m, values, loads=[loads]).solve(drives, rough)
        size = max(abs(x) for forces in solved.reactions.values() for x in forces)
        for link in "abc":
            law = solution.section(link).law
            pairs = zip(("axial", "shear", "bending"), solved.sections[link](cut), strict=True)
            worst = max(
                worst,
                *(
                    abs(law.at(force, np.array([[cut]]))[0, 0] - value) / size
                    for force, value in pairs
                ),
            )
        worst = max(worst, abs(found["effort:O"] - solved.efforts["O"]) / size)
        for joint, (fx, fy, _) in solved.reactions.items():
            worst = max(
                worst,
                abs(found[f"reaction:{joint}:fx"] - fx) / size,
                abs(found[f"reaction:{joint}:fy"] - fy) / size,
            )
    return worst


@settings(max_examples=10, deadline=None)
@given(
    st.tuples(*[st.floats(-100, 100)] * 2),
    st.tuples(*[st.floats(-100, 100)] * 2),
    st.sampled_from([0.1, 0.37, 0.9]),
)
def test_newton_and_euler_agree(wind, lift, t):
    scene, shape = linkage(wind, lift)
    assert gaps(scene, shape, t, wind, lift) < 1e-12


def test_every_way_of_evaluating_agrees(tmp_path):
    scene, _ = linkage()
    expected_ = evaluate(scene, backend="vm")
    assert expected_.certified
    for way in ({"backend": "c"}, {"backend": "lanes"}, {"precision": "single"}):
        found = evaluate(scene, **way)
        assert found.certified
        for name in expected_.names():
            gap, size = (
                np.abs(found.array(name) - expected_.array(name)).max(),
                np.abs(expected_.array(name)).max(),
            )
            assert gap <= (1e-12 if "backend" in way else 1e-4) * max(size, 1.0), (way, name)
    save(expected_, tmp_path / "linkage.h5")
    assert (
        load(tmp_path / "linkage.h5").section("b").bending.tolist()
        == expected_.section("b").bending.tolist()
    )


@pytest.mark.parametrize("precision", ["double", "single"])
def test_exported_c_has_the_numbers_of_the_api(precision, tmp_path):
    scene, _ = linkage(t=(0.1, 0.9, 41))
    made, told = exported(scene, tmp_path, precision=precision)
    solution = solve(scene, precision)
    compare(
        by_c99(tmp_path, told, instants(solution.t, precision)),
        expected(scene, told, solution),
        told,
        made,
        solution,
    )


@pytest.mark.long
def test_sweeps_find_the_peaks_along_the_links():
    scene, _ = linkage(t=(0.1, 0.9, 81))
    for backend in ("vm", "lanes"):
        engine = DesignEngine.of(scene, method=EvaluationMethod(backend))
        found = engine.evaluate(np.array([[1.0], [2.5]]))
        assert found.status.tolist() == [Status.OK] * 2
        names = [str(quantity) for quantity in engine.quantities]
        for k, gust in enumerate((1.0, 2.5)):
            solution = evaluate(scene, parameters={"gust": gust})
            for peak in refine(
                scene, solution, ["section:b:bending", "section:c:bending", "section:b:axial"]
            ):
                assert abs(found.value[k, names.index(peak.name)] - peak.value) <= 1e-9 * abs(
                    peak.value
                )
                fine = evaluate(scene, parameters={"gust": gust}, t=(0.1, 0.9, 4001))
                assert fine.peak(peak.name).value == pytest.approx(peak.value, rel=1e-5)


def test_what_bears_no_line_load_is_refused_by_name():
    m = Mechanism("refused")
    rod, ball, low = (
        m.link("rod", length=1.0, mass=1.0),
        m.point_mass("ball", 1.0),
        m.parameter("low", 0.2, "m"),
    )
    for place in (ball, m.ground):
        with pytest.raises(
            DeclarationError,
            match=r"load 'wind': expected a link for a line load, got '\w+'; use a force",
        ):
            m.line_load("wind", place, y=1.0)
    expected_one = (
        r"load 'wind': expected one value, two values at its start and end, or a function of the"
        r" distance .*, got"
    )
    for value in ((1.0, 2.0, 3.0), ()):
        with pytest.raises(DeclarationError, match=expected_one):
            m.line_load("wind", rod, y=value)
    with pytest.raises(DeclarationError, match="load 'wind' must be a number or an expression"):
        m.line_load("wind", rod, y="strong")
    for foreign in (ca.SX.sym("foreign"), lambda xi: xi * ca.SX.sym("foreign")):
        with pytest.raises(DeclarationError, match="load 'wind' depends on 'foreign'"):
            m.line_load("wind", rod, y=foreign)
    no_polynomial = (
        "load 'wind' must be a polynomial of the distance from the base, of degree 7 at most; use"
        " one"
    )
    shape = curve([0.0, 0.3, 0.6, 1.0], [1.0, 2.0, 1.5, 0.0])
    wrong = (
        ca.sin,
        ca.fabs,
        shape,
        lambda xi: xi**8,
        lambda xi: 1 / (1 + xi),
        lambda xi: ca.if_else(xi < 0.5, 1.0, 2.0),
    )
    for function in (
        *wrong,
        lambda xi: xi**0.5,
        lambda xi: 2**xi,
        lambda xi: low**xi,
        lambda xi: ca.fmax(xi, low),
    ):
        with pytest.raises(DeclarationError, match=no_polynomial):
            m.line_load("wind", rod, y=function)
    with pytest.raises(DeclarationError, match=r"load 'wind' cannot be made .*: ZeroDivisionError"):
        m.line_load("wind", rod, y=lambda xi: xi * (1 / 0))
    with pytest.raises(
        DeclarationError,
        match=r"load 'wind' cannot be .* of the distance from the base .*: a symbol has no truth",
    ):
        m.line_load("wind", rod, y=lambda xi: xi if xi > 0 else 0)
    with pytest.raises(
        DeclarationError, match=r"load 'wind' must be a scalar, got one of shape \(2, 1\)"
    ):
        m.line_load("wind", rod, y=lambda xi: ca.vertcat(xi, xi))
    with pytest.raises(
        DeclarationError, match="load 'wind': between must be two distances from the base of 'rod'"
    ):
        m.line_load("wind", rod, y=1.0, between=0.3)
    with pytest.raises(
        DeclarationError, match="load 'wind': between depends on 't', not a parameter"
    ):
        m.line_load("wind", rod, y=1.0, between=(0.0, m.time))
    with pytest.raises(
        DeclarationError,
        match=r"load 'wind': between must be two increasing distances from the base, got 0\.5",
    ):
        m.line_load("wind", rod, y=1.0, between=(0.5, 0.5))
    m.line_load("wind", rod, y=1.0, between=(low, 0.6))
    with pytest.raises(DeclarationError, match="load 'wind' is declared twice"):
        m.line_load("wind", rod, y=1.0)
    m.revolute("J", m.ground, rod)
    m.weld("W", rod.tip, ball)
    scene = Scene(m, {"J": motion.polynomial(0.0)}, t=(0, 1, 3))
    told = r"load 'wind': it acts between {} and 0.6 m, but link 'rod' is from 0 to 1 m"
    with pytest.raises(ParameterError, match=told.format("-0.1")):
        evaluate(scene, parameters={"low": -0.1})
    with pytest.raises(
        ParameterError,
        match=r"load 'wind': it acts between 0\.7 and 0\.6 m; expected an end greater than the"
        r" start",
    ):
        evaluate(scene, parameters={"low": 0.7})
    engine = DesignEngine.of(scene, method=EvaluationMethod("vm"))
    assert engine.evaluate(np.array([[0.2], [-0.1], [0.6], [0.7]])).status.tolist() == [
        Status.OK,
        *[Status.IMPOSSIBLE] * 3,
    ]
