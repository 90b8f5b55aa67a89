"""Cycle tables: against the graphs that they are of, at any angle and motion, and what has none."""

import math

import casadi as ca
import numpy as np
import pytest
from mechanisms import four_bar, parallelogram, slider_crank, truss_platform
from tables import case, made, some_motion, values, worst_gap

from lagrange_casadi import Mechanism, Scene, derive, evaluate, motion
from lagrange_casadi.errors import DeclarationError


def drag_link():
    """A short frame: coupler and rocker turn with the crank."""
    return four_bar(lengths=(0.3, 0.25, 0.35), frame=(0.1, 0.0), rocker=1.0)


def triad():
    """A crank and a plate on three rods: no dyad, so it is iterated."""
    m = Mechanism("triad")
    crank, plate = m.link("crank", length=0.05, mass=0.2), m.link("plate", length=0.2, mass=0.8)
    m.revolute("O", m.ground.at(-0.35, 0.0), crank)
    posture = {"plate": 0.0}
    for i, (foot, place) in enumerate(
        (((-0.3, 0.0), (0.0, 0.0)), ((0.2, -0.4), (0.2, 0.0)), ((0.05, -0.4), (0.05, 0.1)))
    ):
        rod = m.link(f"rod{i}", length=math.dist(foot, place), mass=0.3)
        m.revolute(f"foot{i}", crank.tip if i == 0 else m.ground.at(*foot), rod)
        m.revolute(
            f"corner{i}",
            rod.tip,
            plate.base if i == 0 else plate.tip if i == 1 else plate.at(*place),
        )
        posture[f"rod{i}"] = math.atan2(place[1] - foot[1], place[0] - foot[0])
    return Scene(m, {"O": motion.polynomial(0.0, 3.0)}, posture=posture, t=(0.0, 1.0, 21))


def arm(load=None, law=None, **keywords):
    """A link on a pin, with a torque by its angle, its rate and the time."""
    m = Mechanism("arm")
    link = m.link("link", length=0.5, mass=1.2)
    pin = m.revolute("pin", m.ground, link)
    if load is not None:
        m.torque("load", link, load(m.coordinate(pin), m.rate(pin), m.time))
    return Scene(m, {"pin": law or motion.polynomial(0.1, 2.0)}, **keywords)


def geared(ratio):
    m = Mechanism("geared")
    wheel, link = m.link("wheel", length=0.05, mass=0.2), m.link("link", length=0.1, mass=0.3)
    first = m.revolute("first", m.ground.at(-0.2, 0), wheel)
    second = m.revolute("second", m.ground, link)
    m.gear("mesh", first, second, ratio=ratio)
    return Scene(m, {"first": motion.polynomial(0.2, 3.0)})


SMOOTH = {
    "slider_crank": (lambda: case("slider_crank"), 256),
    "four_bar": (lambda: case("four_bar"), 256),
    "six_bar": (lambda: case("six_bar"), 256),
    "andrews_squeezer": (lambda: case("andrews_squeezer"), 256),
    "drag_link": (drag_link, 512),
    "triad": (triad, 256),
    "redundant": (parallelogram, 1024),
    "arm": (arm, 64),
}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", SMOOTH)
def test_a_table_gives_what_the_graph_gives(name):
    """At any angle, of some turns either way, and rates of either sign; for 1e-9, of each column's
    peak.
    """
    build, most = SMOOTH[name]
    scene = build()
    table = made(scene)
    assert table.turns == 1
    assert table.nodes <= most
    assert 2e-16 < table.error <= 1e-9
    n = 40 if derive(scene).newton else 500
    assert worst_gap(scene, table, *some_motion(n)) < 1.1e-9


def test_the_error_is_the_one_there_is():
    """Of errors at thousands of places the largest is what the table says, which looks halfway
    between nodes.
    """
    scene = case("slider_crank")
    table = made(scene, 64)
    angle = np.linspace(0.0, math.tau, 64 * 33)
    gaps = [
        worst_gap(scene, table, angle, np.full_like(angle, r), np.full_like(angle, a))
        for r in (60, -60)
        for a in (900, -900)
    ]
    assert table.error == pytest.approx(max(gaps), rel=0.02)


def test_kinks_of_a_load_cost_the_order():
    """The engine's gas follows a table, linear between its values: errors fall with the distance
    only.
    """
    scene = case("engine")
    with pytest.raises(
        DeclarationError,
        match=(
            r"table: an accuracy of 1e-09 is not possible; the best is \S+e-0[45], with 16384"
            r" nodes, and (the \w+ of )?'[^_]"
        ),
    ):
        made(scene, wanted=["effort"])
    coarse, fine = made(scene, 1024, ["effort"]), made(scene, 4096, ["effort"])
    assert 2.5 < coarse.error / fine.error < 6.0
    # Four strokes are two turns. Where the declared load ends, before the start, the table goes on.
    assert fine.turns == 2
    assert (
        worst_gap(
            scene, fine, math.pi / 2 + 4 + np.abs(some_motion())[0], *some_motion()[1:], ["effort"]
        )
        < 2 * fine.error
    )
    everything = made(scene, 64)
    gains = {
        name: gain for name, gain in zip(everything.columns, everything.drift, strict=True) if gain
    }
    assert gains == {"motion:main": 1.0, "pose:crank:angle": 1.0, "motion:big_end": -1.0}


def test_another_law_of_motion_is_served():
    """A table of a scene that turns steadily gives a scene that swings."""
    swinging = motion.harmonic(0.4, 2.0, 3.0, 0.3)
    other = Scene(
        case("four_bar").mechanism, {"O": swinging}, posture={"rocker": 1.5}, t=(0.0, 0.7, 301)
    )
    table = made(case("four_bar"))
    t = np.linspace(*other.t)
    angle, rate, acceleration = (
        row.full().ravel() for row in derive(other).motion(t[None], values(other))
    )
    assert rate.min() < 0.0 < rate.max()
    assert worst_gap(other, table, angle, rate, acceleration) < 1.1e-9


@pytest.mark.parametrize("turns", [-100_000, -1, 1, 1000, 100_000])
def test_after_many_turns_all_is_as_before(turns):
    """The angle as it is decides: nothing is lost of it but its own last digits."""
    scene = case("slider_crank")
    table = made(scene, 1e-12)
    angle, rate, acceleration = some_motion(turns=1.0)
    assert worst_gap(scene, table, turns * math.tau + angle, rate, acceleration) < 2e-12


def unreachable():
    return Scene(
        four_bar().mechanism, {"C": motion.polynomial(1.5, 1.0)}, posture={"a": 1.0}, t=(0, 0.1, 3)
    )


def flat_parallelogram():
    return four_bar(lengths=(0.2, 0.4, 0.2), frame=(0.4, 0.0), rocker=0.9)


def driven_slide():
    m = slider_crank().mechanism
    return Scene(m, {"guide": motion.polynomial(0.25, 0.1)}, posture={"crank": 0.7, "rod": -0.4})


def fixed():
    m = Mechanism("shelf")
    m.weld("wall", m.ground, m.link("board", length=1.0, mass=1.0))
    return Scene(m, {})


def two_drives():
    m = Mechanism("arm")
    first, second = m.link("first", length=0.5, mass=1.2), m.link("second", length=0.5, mass=1.2)
    m.revolute("near", m.ground, first)
    m.revolute("far", first.tip, second)
    return Scene(m, {"near": motion.polynomial(0, 1), "far": motion.polynomial(0, 1)})


def rubbing():
    m = Mechanism("rubbing")
    m.friction(
        "rub", m.revolute("pin", m.ground, m.link("bar", length=0.3, mass=1.0)), mu=0.1, radius=0.02
    )
    return Scene(m, {"pin": motion.polynomial(0, 1)})


REFUSED = {
    "no drive": (fixed, r"expected one driven joint, whose angle determines all, got none"),
    "two": (
        two_drives,
        r"expected one driven joint, whose angle determines all, got 'near', 'far'",
    ),
    "slides": (driven_slide, r"the driven joint 'guide' slides; expected one that turns"),
    "time": (
        lambda: arm(lambda q, w, t: ca.sin(t)),
        (
            r"on the angle of joint 'pin' alone, but these depend on the time: 'load:load:mz',"
            r" 'effort:pin'$"
        ),
    ),
    "sign": (
        lambda: arm(lambda q, w, t: -3 * ca.sign(w)),
        r"quadratic in the rate of joint 'pin', .* enters 'load:load:mz', 'effo",
    ),
    "size": (
        lambda: arm(lambda q, w, t: -1e-3 * w * ca.fabs(w)),
        r"quadratic in the rate of joint 'pin', but a load that depends on a rate's sign",
    ),
    "cube": (
        lambda: arm(lambda q, w, t: 1e-6 * w**3),
        r"sign, size or another power enters 'load:load:mz', 'effort:pin'$",
    ),
    "at rest": (
        lambda: arm(lambda q, w, t: w**2 / ca.fabs(w)),
        r"'load:load:mz' is not finite at rest, where pin = 0\.\d+ rad",
    ),
    "friction": (
        rubbing,
        r"quadratic in the rate of joint 'pin', but friction depends on its sign: 'rub'$",
    ),
    "quick_return": (
        lambda: case("quick_return"),
        r"quadratic in the rate of joint 'O', .* enters 'load:cut:fx', .* and 16 more",
    ),
    "rocker": (
        unreachable,
        (
            r"the loop closed by joint 'B' cannot be closed, where C = 2\.\d+ rad \(1\d\d\.\d+"
            r" deg\); expected a drive that can make"
        ),
    ),
    "iterated": (
        truss_platform,
        (
            r"the loops? closed by .*, where O = -?[\d.]+ rad .*; expected a drive that can make"
            r" whole revolutions"
        ),
    ),
    "bricard": (
        lambda: case("bricard"),
        (
            r"the loops closed by joint 'J3' did not converge, where J0 = 2\.1\d+ rad .*; expected"
            r" a drive that can make whole"
        ),
    ),
    "dead centre": (
        flat_parallelogram,
        r"the loop closed by joint 'B' passes a dead centre near O = 3\.\d+ rad",
    ),
    "gear": (
        lambda: geared(0.7),
        r"after at most 4 turns of joint 'first', but 'effort:first', .* and \d more do not repeat",
    ),
    "grows": (
        lambda: arm(lambda q, w, t: 2 * q**2),
        r"repeat after at most 4 turns of joint 'pin', but 'load:load:mz', 'effort:pin'",
    ),
}


@pytest.mark.sampled(9)
@pytest.mark.parametrize("name", REFUSED)
def test_what_has_no_table_is_refused_with_the_reason(name):
    build, message = REFUSED[name]
    with pytest.raises(DeclarationError, match=f"^table: .*{message}"):
        made(build(), 64)


def test_an_accuracy_beyond_rounding_is_refused_with_the_best():
    best = (
        r"\S+e-1[56], with (512|1024|2048) nodes, and (the \w+ of )?'[^_]\S*' is the worst there$"
    )
    with pytest.raises(
        DeclarationError, match=f"^table: an accuracy of 1e-17 is not possible; the best is {best}"
    ):
        made(case("slider_crank"), 1e-17)


def with_a_load(place):
    """A slider-crank whose rod bears a load between its ends."""
    m = Mechanism("loaded")
    crank, rod = m.link("crank", length=0.1, mass=1.0), m.link("rod", length=0.4, mass=1.0)
    m.revolute("O", m.ground, crank)
    m.revolute("A", crank.tip, rod)
    m.slot("guide", m.ground, rod.tip)
    m.force("load", rod.at(m.parameter("place", place)), y=-20.0)
    return Scene(
        m,
        {"O": motion.polynomial(0.0, 10.0)},
        t=(0.0, 0.6, 31),
        posture={"rod": 0.0},
        xi=(0.0, 1.0, 41),
    )


@pytest.mark.parametrize("place", [0.2, 0.13, 0.3])
def test_a_station_that_stands_still_is_on_no_other_side_of_a_section(place):
    """A spline through one number rounds it: at a ratio of the grid that is the load's own, 20 N
    would be on the other side.
    """
    scene = with_a_load(place)
    read, true = (
        evaluate(scene, backend="vm", **method).section("rod") for method in ({"table": 256}, {})
    )
    np.testing.assert_array_equal(read.law.loads[0].station, true.law.loads[0].station)
    np.testing.assert_allclose(read.shear, true.shear, rtol=0, atol=1e-9)
