"""Motion laws: values and rates, and what is refused."""

import math

import casadi as ca
import numpy as np
import pytest
from internals import Laws, laws, motion

from lagrange_casadi import Mechanism, Scene, evaluate
from lagrange_casadi.errors import DeclarationError

pytestmark = pytest.mark.quick


def at(law, t):
    f = laws.motion_function({"J": law}, ca.SX(0, 1))
    return [float(x) for x in f(t, [])]


def test_polynomial():
    assert at(motion.polynomial(1.0, -2.0, 0.5, 3.0), 2.0) == [1 - 4 + 2 + 24, -2 + 2 + 36, 1 + 36]
    assert at(motion.polynomial(0.7), 5.0) == [0.7, 0.0, 0.0]


def test_harmonic():
    w = 2 * math.pi * 3.0
    found = at(motion.harmonic(0.2, 0.5, 3.0, 0.1), 0.4)
    expected = [
        0.2 + 0.5 * math.sin(w * 0.4 + 0.1),
        0.5 * w * math.cos(w * 0.4 + 0.1),
        -0.5 * w**2 * math.sin(w * 0.4 + 0.1),
    ]
    assert found == pytest.approx(expected, rel=1e-13)


def test_expression():
    found = at(motion.expression(lambda t: ca.exp(-t) * t), 1.5)
    assert found == pytest.approx(
        [1.5 * math.exp(-1.5), -0.5 * math.exp(-1.5), -0.5 * math.exp(-1.5)], rel=1e-14
    )


def test_samples_are_interpolated_twice_continuously():
    times = np.linspace(0, 2, 81)
    law = motion.samples(times, np.sin(3 * times))
    for node in times[5:-5:7]:
        left, right = at(law, node - 1e-9), at(law, node + 1e-9)
        assert at(law, node)[0] == pytest.approx(math.sin(3 * node), abs=1e-12)
        np.testing.assert_allclose(left, right, atol=1e-6)
    middle = at(law, 1.0123)
    exact = [math.sin(3.0369), 3 * math.cos(3.0369), -9 * math.sin(3.0369)]
    np.testing.assert_allclose(middle, exact, atol=[1e-6, 1e-4, 1e-2][2])


def test_samples_of_a_cubic_are_exact():
    times = [0.0, 0.3, 0.5, 1.1, 1.4, 2.0]
    law = motion.samples(times, [t**3 - 2 * t for t in times])
    assert at(law, 0.8) == pytest.approx([0.8**3 - 1.6, 3 * 0.64 - 2, 4.8], rel=1e-10)


def test_third_derivatives():
    """Of a polynomial with a parameter, an expression, and a spline, whose second derivative is a
    polygon; also at its knots.
    """
    p, times = ca.SX.sym("c"), np.array([0.0, 0.3, 0.5, 1.1, 1.4, 2.0])
    spline = motion.samples(times, np.sin(3 * times))
    laws = {
        "P": motion.polynomial(1, 2, 3, p),
        "E": motion.expression(lambda t: ca.sin(2 * t)),
        "S": spline,
    }
    jerk = Laws.of(laws, p).jerk()
    for t in (0.1, 0.3, 0.7, 1.1, 1.9):
        nodes = times[np.searchsorted(times, t, side="right") - 1 :][:2]
        bends = [at(spline, node)[2] for node in nodes]
        expected = [6 * 0.4, -8 * math.cos(2 * t), (bends[1] - bends[0]) / (nodes[1] - nodes[0])]
        assert jerk(t, 0.4).full().ravel() == pytest.approx(expected, rel=1e-12)


def test_laws_of_both_kinds_run_together():
    """A spline beside a polynomial with a parameter, compiled and by the virtual machine."""
    m = Mechanism("arm")
    speed = m.parameter("speed", 2.0, "rad/s")
    a, b = m.link("a", length=1, mass=1), m.link("b", length=1, mass=1)
    m.revolute("J", m.ground, a)
    m.revolute("K", a.tip, b)
    times = np.linspace(0, 1, 30)
    scene = Scene(
        m, {"J": motion.samples(times, times**2), "K": motion.polynomial(0, speed)}, t=(0, 1, 11)
    )
    compiled, machine = (
        evaluate(scene, backend=backend, parameters={"speed": 3.0}) for backend in ("c", "vm")
    )
    np.testing.assert_allclose(compiled.motion("J").value, compiled.t**2, atol=1e-12)
    np.testing.assert_allclose(compiled.motion("K").value, 3.0 * compiled.t, atol=1e-15)
    for name in compiled.names():
        np.testing.assert_allclose(
            compiled.array(name), machine.array(name), rtol=1e-12, atol=1e-12
        )


def test_samples_cover_their_span_only():
    m = Mechanism("arm")
    m.revolute("J", m.ground, m.link("a", length=1, mass=1))
    scene = Scene(m, {"J": motion.samples([0, 1, 2, 3], [0, 1, 4, 9])}, t=(0, 3, 4))
    with pytest.raises(
        DeclarationError, match=r"joint 'J' cover t from 0 to 3 s, but t from 0 to 3\.5 s"
    ):
        evaluate(scene, t=(0, 3.5, 4))


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: motion.polynomial(), "at least one coefficient"),
        (lambda: motion.expression(3.0), "expression: law: expected a function, got"),
        (lambda: motion.samples([0, 1, 2], [0, 1, 2]), "at least 4, got 3"),
        (
            lambda: motion.samples([0, 1, 1, 2], [0, 1, 2, 3]),
            "places must increase, but entry 2 is at 1 after 1",
        ),
        (lambda: motion.samples([0, 1, 2, 3], [0, 1, math.nan, 3]), "must be finite"),
        (lambda: motion.samples([0, 1, 2, 3], [0, 1, 2]), "of one length"),
        (
            lambda: at(motion.expression(lambda t: ca.vertcat(t, t)), 1.0),
            "the motion of joint 'J' must be a scalar",
        ),
        (
            lambda: at(motion.expression(lambda t: math.sin(t)), 1.0),
            "joint 'J' is not a number; use CasADi's functions",
        ),
        (lambda: motion.samples("abcd", "abcd"), "times: expected a row of numbers, got 'abcd'"),
    ],
)
def test_misuse_is_named(make, says):
    with pytest.raises(DeclarationError, match=says):
        make()
