"""Designs that are known: published, or by a closed form, or by least squares on efforts that are
linear in masses.
"""

import math

import casadi as ca
import numpy as np
import pytest

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, evaluate, optimise
from lagrange_casadi.motion import expression, harmonic, polynomial

pytestmark = pytest.mark.usefixtures("interpreted")


def hoeken(half):
    """A crank of 1, and a coupler point as far beyond its pin as that is from the crank's; straight
    where the crank points back.
    """
    m = Mechanism("hoeken")
    ground = m.parameter("ground", 2.3)
    side = m.parameter("side", 2.9)
    level = m.parameter("level", 5.0)
    crank = m.link("crank", length=1.0, mass=1.0)
    coupler = m.link("coupler", length=2 * side, mass=1.0)
    rocker = m.link("rocker", length=side, mass=1.0)
    m.revolute("O", m.ground, crank)
    m.revolute("A", crank.tip, coupler)
    m.revolute("C", m.ground.at(ground, 0.0), rocker)
    m.revolute("B", coupler.at(side), rocker.tip)
    m.output("off", m.place(coupler.tip)[1] - level, unit="m")
    posture = {"coupler": 0.9, "rocker": 2.2}
    return Scene(
        m,
        {"O": polynomial(math.pi - half, 2 * half)},
        t=(0, 1, 73),
        posture=posture,
        wanted=["output:off"],
    )


def straightness(ground, side, half):
    """How far the path of that point is from a straight line, and how long it is, by plain
    geometry.
    """
    angle = math.pi + np.linspace(-half, half, 20001)
    pin = np.array([np.cos(angle), np.sin(angle)])
    across = np.array([[ground], [0.0]]) - pin
    size = np.hypot(*across)
    height = np.sqrt(side**2 - (size / 2) ** 2)
    joint = pin + across / 2 + height * np.array([-across[1], across[0]]) / size
    point = 2 * joint - pin
    return np.ptp(point[1]), np.ptp(point[0])


@pytest.mark.parametrize(
    ("degrees", "ground", "side", "percent", "length"),
    [
        (180, 2.2, 2.8, 0.096, 4.181),
        pytest.param(120, 2.625, 3.438, 0.010, 3.238, marks=pytest.mark.long),
    ],
)
def test_the_straightest_path_of_a_four_bar(degrees, ground, side, percent, length):
    """Hoeken's linkage: Norton, Design of Machinery, table 3-1, has the ratios of the straightest
    path for ranges of the crank.
    """
    half = math.radians(degrees / 2)
    # The table is right, to the digits that it has.
    off, long = straightness(ground, side, half)
    assert 100 * off / long == pytest.approx(percent, abs=5e-4)
    assert long == pytest.approx(length, abs=1e-3)
    over = {"ground": (1.9, 2.9), "side": (2.5, 3.9), "level": (4.0, 7.0)}
    found = optimise(hoeken(half), minimise="peak:output:off", over=over, starts=2, screen=8)
    assert found.converged
    best, _ = straightness(found.values["ground"], found.values["side"], half)
    assert 2 * found.objective == pytest.approx(best, rel=1e-6)
    assert best <= off
    assert [found.values["ground"], found.values["side"]] == pytest.approx([ground, side], abs=0.05)
    for step in (-1e-3, 1e-3):
        assert straightness(found.values["ground"] + step, found.values["side"], half)[0] > best
        assert straightness(found.values["ground"], found.values["side"] + step, half)[0] > best


def test_a_spring_balances_an_arm():
    """A spring without free length, from a m above the pin to b m along the arm, balances it where
    k a b = m g l/2 (Carwardine).
    """
    m = Mechanism("lamp")
    stiffness = m.parameter("k", 50.0, "N/m", low=0.0)
    arm = m.link("arm", length=0.8, mass=2.0)
    m.revolute("O", m.ground, arm)
    m.spring("balance", m.ground.at(0.0, 0.3), arm.at(0.4), stiffness=stiffness, length=0.0)
    scene = Scene(m, {"O": harmonic(0.3, 0.9, 0.01)}, t=(0.0, 100.0, 65), wanted=["effort"])
    found = optimise(scene, minimise="rms:effort:O", over={"k": (0.0, 200.0)}, starts=2, screen=8)
    assert found.values["k"] == pytest.approx(2.0 * 9.81 * 0.4 / (0.3 * 0.4), rel=1e-4)
    assert found.objective <= 1e-2


def test_a_torsion_spring_takes_the_torque_of_an_oscillation():
    """Where stiffness over inertia is the square of the circular frequency, nothing is left to the
    drive.
    """
    m = Mechanism("balance_wheel")
    m.set_gravity(0.0, 0.0)
    stiffness = m.parameter("k", 5.0, "N m/rad", low=0.0)
    joint = m.revolute("O", m.ground, m.link("arm", length=0.6, mass=1.5))
    m.torsion_spring("hair", joint, stiffness=stiffness)
    scene = Scene(m, {"O": harmonic(0.0, 0.7, 2.0)}, t=(0.0, 0.5, 41), wanted=["effort"])
    found = optimise(scene, minimise="peak:effort:O", over={"k": (0.0, 100.0)}, starts=2, screen=8)
    assert found.values["k"] == pytest.approx(1.5 * 0.6**2 / 3 * (4 * math.pi) ** 2, rel=1e-6)
    assert found.objective <= 1e-6


def test_the_flywheel_of_least_peak_torque():
    """A load takes an energy E more and less than is even, speeds vary by a share k: the torque is
    even where the inertia is E/(k w^2) (Norton, Design of Machinery, the section on flywheels)."""
    m = Mechanism("press")
    m.set_gravity(0.0, 0.0)
    inertia = m.parameter("inertia", 1.0, "kg m^2", low=0.0)
    wheel = m.link("wheel", length=0.3, mass=1.0, centre=(0.0, 0.0), inertia=inertia)
    m.revolute("shaft", m.ground, wheel)
    speed, varies, even, swing = 20.0, 0.05, 80.0, 60.0
    m.torque("load", wheel, -even - swing * ca.sin(2 * speed * m.time))
    law = expression(lambda t: speed * t + varies / 4 * ca.sin(2 * speed * t))
    scene = Scene(m, {"shaft": law}, t=(0.0, 2 * math.pi / speed, 73), wanted=["effort"])
    found = optimise(
        scene, minimise="peak:effort:shaft", over={"inertia": (0.0, 20.0)}, starts=2, screen=8
    )
    # E is the integral of swing sin 2a over a quarter of a turn.
    assert found.values["inertia"] == pytest.approx(swing / (varies * speed**2), rel=1e-6)
    assert found.objective == pytest.approx(even, rel=1e-6)


def test_the_motion_of_least_rms_torque_is_the_cubic():
    """Of inertia alone, from rest to rest: the rms torque is sqrt(12) I h/T^2, by the calculus of
    variations.
    """
    m = Mechanism("index")
    m.set_gravity(0.0, 0.0)
    c = [m.parameter(f"c{k}", value, "1") for k, value in enumerate((3.0, -5.0))]
    m.revolute("O", m.ground, m.link("arm", length=0.6, mass=1.5))

    def law(t):
        s = t / 0.4
        return 1.2 * (3 * s**2 - 2 * s**3 + s**2 * (1 - s) ** 2 * (c[0] + c[1] * (s - 0.5)))

    scene = Scene(m, {"O": expression(law)}, t=(0.0, 0.4, 401), wanted=["effort"])
    found = optimise(
        scene,
        minimise="rms:effort:O",
        over={"c0": (-8.0, 8.0), "c1": (-8.0, 8.0)},
        starts=2,
        screen=8,
    )
    assert found.converged
    assert found.curvature > 0.0
    assert found.objective == pytest.approx(math.sqrt(12) * 1.5 * 0.36 / 3 * 1.2 / 0.4**2, rel=1e-5)
    assert [found.values[name] for name in ("c0", "c1")] == pytest.approx([0.0, 0.0], abs=1e-3)


def arm6():
    """An arm of six revolute joints whose upper arm and forearm have counterweights behind their
    joints.
    """
    m = SpatialMechanism("arm6")
    first, second = (
        m.parameter(name, 1.0, "kg", low=0.0) for name in ("behind_shoulder", "behind_elbow")
    )
    lengths, masses = (0.16, 0.42, 0.39, 0.12, 0.1, 0.08), (3.7, 8.4, 2.3, 1.2, 1.2, 0.2)
    links = [
        m.link(f"link{k}", length=l, mass=mass)
        for k, (l, mass) in enumerate(zip(lengths, masses, strict=True), 1)
    ]
    along, up = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)
    m.revolute("turn", m.ground, links[0], axis=up, turned=[("y", "-90 deg")])
    for name, one, other, axis in zip(
        ("shoulder", "elbow", "roll", "pitch", "flange"),
        links,
        links[1:],
        (up, up, along, up, along),
        strict=False,
    ):
        m.revolute(name, one.tip, other, axis=axis)
    for name, link, reach, mass in (
        ("rear", links[1], 0.3, first),
        ("back", links[2], 0.2, second),
    ):
        tail = m.link(name, length=reach, mass=0.0)
        m.weld(f"{name}_end", link, tail, turned=[("z", "180 deg")])
        m.weld(f"{name}_held", tail.tip, m.point_mass(f"{name}_weight", mass))
    laws = {
        "turn": harmonic(0.0, 1.0, 0.5),
        "shoulder": harmonic(0.6, 0.4, 0.5, math.pi / 3),
        "elbow": harmonic(1.0, 0.5, 0.5, math.pi / 2),
        "roll": harmonic(0.0, 1.2, 0.5, 0.4),
        "pitch": harmonic(0.7, 0.5, 1.0),
        "flange": harmonic(0.0, 2.0, 0.5, 1.0),
    }
    return Scene(m, laws, t=(0.0, 2.0, 41), wanted=["effort"])


def test_masses_of_an_arm_of_six_joints_are_those_of_least_squares():
    """Efforts are linear in masses: three designs tell all, and the least mean square follows by
    normal equations.
    """
    scene = arm6()

    def effort(first, second):
        return evaluate(
            scene, parameters={"behind_shoulder": first, "behind_elbow": second}
        ).effort("shoulder")

    none, columns = effort(0, 0), []
    for masses in ((1, 0), (0, 1)):
        columns.append(effort(*masses) - none)
    assert effort(2, 3) == pytest.approx(none + 2 * columns[0] + 3 * columns[1], rel=1e-9, abs=1e-9)
    weights = np.sqrt(np.r_[0.5, np.ones(39), 0.5])
    best, *_ = np.linalg.lstsq(np.array(columns).T * weights[:, None], -none * weights, rcond=None)
    over = {"behind_shoulder": (0.0, 60.0), "behind_elbow": (0.0, 60.0)}
    found = optimise(scene, minimise="rms:effort:shoulder", over=over, starts=2, screen=16)
    # A mass cannot be negative.
    least = np.maximum(best, 0.0)
    if (best < 0.0).any():
        k = int(np.argmax(best))
        column = columns[k] * weights
        least[k] = -(column @ (none * weights)) / (column @ column)
    assert found.converged
    assert list(found.values.values()) == pytest.approx(least.tolist(), rel=1e-5, abs=1e-6)
