"""What is said of an optimum: one or several, minimum or saddle, smooth or at a jump; and the
conditions themselves.
"""

import math

import casadi as ca
import numpy as np
import pytest
from internals import conditions

from lagrange_casadi import Mechanism, Scene, optimise, shaking
from lagrange_casadi.motion import harmonic, polynomial

pytestmark = pytest.mark.usefixtures("interpreted")


def swinging(amplitude):
    """A rod that swings: its largest torque goes with the amplitude, an expression of c."""
    m = Mechanism("swing")
    m.set_gravity(0.0, 0.0)
    c = m.parameter("c", 0.3)
    m.revolute("O", m.ground, m.link("rod", length=0.3, mass=1.0))
    return Scene(m, {"O": harmonic(0.0, amplitude(c), 1.0)}, t=(0.0, 1.0, 41), wanted=["effort"])


def torque(amplitude):
    return 1.0 * 0.3**2 / 3 * amplitude * (2 * math.pi) ** 2


def test_a_convex_problem_has_one_optimum_from_random_starts():
    """The shaking force is affine in the counterweights, so its peak is convex: the same optimum
    from ten random starts.
    """
    m = Mechanism("compressor")
    weight = m.parameter("weight", 0.5, "kg", low=0.0)
    piston = m.parameter("piston", 1.0, "kg", low=0.0)
    crank, tail = m.link("crank", length=0.05, mass=0.5), m.link("tail", length=0.05, mass=0.0)
    rod, slider = m.link("rod", length=0.2, mass=0.6), m.point_mass("slider", piston)
    m.revolute("O", m.ground, crank)
    m.weld("rear", crank, tail, angle=math.pi)
    m.weld("held", tail.tip, m.point_mass("counterweight", weight))
    m.revolute("A", crank.tip, rod)
    m.revolute("B", rod.tip, slider)
    m.prismatic("guide", m.ground, slider, axis=(1, 0))
    shaking(m)
    scene = Scene(m, {"O": polynomial(0, 100)}, t=(0, 2 * math.pi / 100, 61), posture={"rod": 0.0})
    rng = np.random.default_rng(7)
    starts = [
        {"weight": w, "piston": p}
        for w, p in zip(rng.uniform(0, 3, 10), rng.uniform(0.4, 2, 10), strict=True)
    ]
    found = optimise(
        scene,
        minimise="peak:output:shaking_fx",
        over={"weight": (0.0, 3.0), "piston": (0.4, 2.0)},
        subject_to=["peak:output:shaking_fy <= 300", "piston >= 0.8"],
        starts=starts,
    )
    assert found.converged
    (one,) = found.optima
    assert one.starts == 10
    ends = np.array([list(start.end.values()) for start in found.starts])
    assert np.ptp(ends, axis=0) == pytest.approx(0.0, abs=1e-7)


def test_all_local_optima_are_named():
    """An amplitude with two valleys, the left one deeper."""

    def amplitude(c):
        return (c**2 - 1) ** 2 + 0.05 * c + 0.5

    found = optimise(
        swinging(amplitude),
        minimise="peak:effort:O",
        over={"c": (-2.0, 2.0)},
        starts=[{"c": c} for c in (-1.7, -0.4, 0.9, 1.8)],
    )
    assert found.converged
    left, right = found.optima
    roots = sorted(np.roots([4, 0, -4, 0.05]).real)
    assert [left.values["c"], right.values["c"]] == pytest.approx([roots[0], roots[2]], rel=1e-6)
    assert [left.starts, right.starts] == [2, 2]
    assert left.objective == pytest.approx(torque(amplitude(roots[0])), rel=1e-6)
    assert found.values == left.values
    # The second derivative by the share of the bounds, which are 4 apart, over the objective at the
    # first start.
    start = torque(amplitude(-1.7))
    assert found.curvature == pytest.approx(16 * torque(12 * roots[0] ** 2 - 4) / start, rel=1e-3)


def test_a_hilltop_is_no_optimum():
    for kind in ("peak", "rms"):
        found = optimise(
            swinging(lambda c: 2.0 - c**2),
            minimise=f"{kind}:effort:O",
            over={"c": (-1.0, 1.0)},
            starts=[{"c": 0.0}],
        )
        assert found.converged
        assert abs(found.values["c"]) == pytest.approx(1.0, rel=1e-7)
        assert found.history[1, 4] == pytest.approx(0.0, abs=1e-3)


def test_a_peak_at_a_jump_is_told():
    m = Mechanism("brake")
    m.set_gravity(0.0, 0.0)
    drag = m.parameter("drag", 2.0, "N m", low=0.0)
    arm = m.link("arm", length=0.3, mass=1.0)
    m.revolute("O", m.ground, arm)
    m.torque("brake", arm, -ca.if_else(m.time > 0.5, drag * ca.exp(0.5 - m.time), 0.0))
    scene = Scene(m, {"O": polynomial(0.0, 1.0)}, t=(0.0, 1.0, 42), wanted=["effort"])
    found = optimise(scene, minimise="peak:effort:O", over={"drag": (1.0, 3.0)}, starts=1)
    assert found.objective == pytest.approx(1.0, rel=1e-6)
    (note,) = found.notes
    assert note.startswith("peak:effort:O is at a kink or a jump, at t = 0.5")


@pytest.mark.parametrize("start", [0.35, 0.5, 0.8])
def test_a_jump_that_goes_with_what_is_chosen_is_followed(start):
    """The brake sets in at a time of its own, and pulls least where that is 0.6 s."""
    m = Mechanism("brake")
    m.set_gravity(0.0, 0.0)
    at = m.parameter("at", 0.5, "s", low=0.0)
    arm = m.link("arm", length=0.3, mass=1.0)
    m.revolute("O", m.ground, arm)
    m.torque(
        "brake",
        arm,
        -ca.if_else(m.time > at, (1 + 10 * (at - 0.6) ** 2) * ca.exp(at - m.time), 0.0),
    )
    scene = Scene(m, {"O": polynomial(0.0, 1.0)}, t=(0.0, 1.0, 42), wanted=["effort"])
    found = optimise(
        scene, minimise="peak:effort:O", over={"at": (0.3, 0.9)}, starts=[{"at": start}]
    )
    assert found.converged
    assert found.values["at"] == pytest.approx(0.6, rel=1e-6)
    assert found.objective == pytest.approx(1.0, rel=1e-9)


def program(f, g):
    """What :func:`conditions` asks of a program, of two variables in 0 to 1."""
    x, by = ca.SX.sym("x", 2), ca.SX.sym("by", g(ca.SX.sym("x", 2)).numel())
    slope = ca.gradient(f(x) + ca.dot(by, g(x)), x)
    parts = ca.horzcat(ca.gradient(f(x), x), ca.jtimes(g(x), x, by, True))
    hessian = ca.densify(ca.jacobian(slope, x))
    return ca.Function(
        "slopes", [x, by, ca.SX.sym("p", 1)], [slope, parts, g(x), ca.jacobian(g(x), x), hessian]
    )


@pytest.mark.parametrize("formed", [True, False])
def test_conditions_of_the_second_order(formed):
    """A saddle is one; along an active limit it may be a minimum; at a corner nothing is free."""

    def told(f, g, at, by_g, by_x=(0.0, 0.0)):
        at, by_g, by_x = (np.array(value, float) for value in (at, by_g, by_x))
        value = float(ca.Function("f", [x := ca.SX.sym("x", 2)], [f(x)])(at))
        return conditions(program(f, g), at, value, by_g, by_x, np.zeros(1), 2, formed=formed)

    def saddle(x):
        return (x[0] - 0.5) ** 2 - (x[1] - 0.5) ** 2 + 1

    apart = told(saddle, lambda x: ca.vertcat(x[0] - 5), (0.5, 0.5), [0.0])
    assert apart.turns_down
    assert [apart.curvature, apart.least] == pytest.approx([-2.0, -2.0], rel=1e-6)
    # Held at x1 = 0.5 by a limit that is active and costs nothing: it may still be a minimum.
    weak = told(saddle, lambda x: ca.vertcat(x[1] - 0.5), (0.5, 0.5), [0.0])
    assert not weak.turns_down
    assert weak.curvature == pytest.approx(-2.0, rel=1e-6)
    assert weak.least == pytest.approx(2.0, rel=1e-6)
    held = told(saddle, lambda x: ca.vertcat(x[1] - 0.7), (0.5, 0.7), [0.4])
    assert held.residual <= 1e-12
    assert held.curvature == pytest.approx(2.0, rel=1e-6)
    corner = told(
        lambda x: x[0] + x[1], lambda x: ca.vertcat(x[0] - 5), (0.0, 0.0), [0.0], (-1.0, -1.0)
    )
    assert corner.curvature == corner.least == math.inf
    wrong = told(lambda x: x[0] + x[1], lambda x: ca.vertcat(x[0] - 5), (0.5, 0.5), [0.0])
    assert wrong.residual == pytest.approx(1.0)
