"""Motions: laws from rest to rest as books print them, moves and dwells, and what is refused."""

from __future__ import annotations

import itertools
import math

import casadi as ca
import numpy as np
import pytest
from derivatives import derivatives
from hypothesis import given, settings
from hypothesis import strategies as st

from lagrange_casadi import Mechanism, Scene, evaluate, prepare
from lagrange_casadi.errors import DeclarationError, ParameterError
from lagrange_casadi.motion import (
    Motion,
    dwell,
    expression,
    harmonic,
    move,
    moves,
    polynomial,
    s_curve,
    samples,
    trapezoid,
)

pytestmark = pytest.mark.usefixtures("interpreted")


def arm(law, t=(0.0, 1.0, 101), **parameters):
    m = Mechanism("arm")
    m.set_gravity(0, 0)
    symbols = {name: m.parameter(name, value) for name, value in parameters.items()}
    m.revolute("J", m.ground, m.link("a", length=0.6, mass=2.0))
    return Scene(m, {"J": law if isinstance(law, Motion) else law(**symbols)}, t=t)


INERTIA = 2.0 * 0.6**2 / 3


def at(law, t):
    found = evaluate(arm(law, t=(t, t, 1))).motion("J")
    return float(found.value[0]), float(found.rate[0]), float(found.acceleration[0])


CYCLE = [
    move(0.8, time=0.4, law="modified_sine", name="out"),
    dwell(0.1, name="load"),
    move(by=-0.5, time=0.2, name="half"),
    move(0.0, speed=2.0, acceleration=20.0, jerk=400.0, name="back"),
    dwell(),
]


def test_a_cycle_is_where_its_parts_say():
    scene = arm(moves(CYCLE, cyclic=True, period=1.2), t=(0, 3.6, 721))
    solution = evaluate(scene)
    assert solution.certified
    found = solution.motion("J")
    for cycle in range(3):
        for t, place in (
            (0.0, 0.0),
            (0.2, 0.4),
            (0.4, 0.8),
            (0.45, 0.8),
            (0.5, 0.8),
            (0.6, 0.55),
            (0.7, 0.3),
            (1.1, 0.0),
        ):
            k = round((t + 1.2 * cycle) / 0.005)
            assert found.value[k] == pytest.approx(place, abs=1e-14)
    rests = (solution.t % 1.2 > 0.4) & (solution.t % 1.2 < 0.499)
    assert not found.rate[rests].any()
    assert not found.acceleration[rests].any()
    # The effort is inertia times acceleration, whose largest value in "out" is 5.528 h/T^2
    # (Norton).
    assert np.abs(solution.effort("J")[:81]).max() == pytest.approx(
        INERTIA * 5.52796 * 0.8 / 0.4**2, rel=1e-3
    )


def test_the_timetable_tells_times_peaks_and_jumps():
    scene = arm(moves(CYCLE, cyclic=True, period=1.2))
    table = scene.timetable("J")
    assert table.period == 1.2
    assert [row.name for row in table.stretches] == ["out", "load", "half", "back", "part 5"]
    assert [row.start for row in table.stretches] == [
        0.0,
        0.4,
        0.5,
        0.7,
        pytest.approx(0.7 + 0.3 / 2 + 0.1 + 0.05),
    ]
    assert table.stretches[-1].stop == pytest.approx(1.2, rel=1e-15)
    out, _, half, back, rest = table.stretches
    assert (out.speed, out.acceleration) == pytest.approx(
        (1.7596 * 0.8 / 0.4, 5.52796 * 0.8 / 0.4**2), rel=1e-5
    )
    assert (half.at, half.by, half.law, half.jerk) == (
        0.8,
        -0.5,
        "polynomial_345",
        pytest.approx(60 * 0.5 / 0.2**3),
    )
    assert (back.law, back.jerk) == ("s_curve", pytest.approx(400.0))
    assert (rest.law, rest.speed, rest.at) == ("dwell", 0.0, 0.0)
    assert {jump.what for jump in table.jumps} == {"jerk"}
    assert [jump.where for jump in table.jumps][:3] == [
        "where 'out' begins",
        "from 'out' to 'load'",
        "from 'load' to 'half'",
    ]


@pytest.mark.sampled(5)
@pytest.mark.parametrize(
    "law",
    [
        "trapezoid",
        "simple_harmonic",
        "s_curve",
        s_curve(0.5, 1.0),
        "cycloidal",
        "modified_trapezoid",
    ],
)
@pytest.mark.parametrize("cyclic", [False, True])
def test_jumps_are_where_the_motion_has_them_and_nowhere_else(law, cyclic):
    """Each jump by how much the motion differs beside it; between two of them nothing jumps."""
    motion = moves(
        [move(0.8, time=0.4, law=law), dwell(0.1), move(0.0, time=0.6, law=law)],
        begin=0.05,
        cyclic=cyclic,
    )
    scene = arm(motion)
    jumps, off = scene.timetable("J").jumps, 1e-9
    assert jumps
    spots = np.array([[jump.t - off, jump.t + off] for jump in jumps])
    *_, bend, sharp = derivatives(motion, spots.ravel(), 3).reshape(4, *spots.shape)
    for jump, (before, after), (bent, unbent) in zip(jumps, sharp, bend, strict=True):
        change = unbent - bent if jump.what == "acceleration" else after - before
        assert jump.by == pytest.approx(change, rel=1e-5, abs=1e-5 * abs(jump.by))
    places = [0.0, *sorted(jump.t for jump in jumps), 1.1]
    for a, b in itertools.pairwise(places):
        if b - a > 1e-6:
            t = np.linspace(a + 1e-9, b - 1e-9, 2000)
            *_, bend, sharp = derivatives(motion, t, 3)
            assert np.abs(np.diff(bend)).max() < 3.0 * max(1.0, np.abs(sharp).max()) * (t[1] - t[0])
            if law != "simple_harmonic":
                assert np.abs(np.diff(sharp)).max() < 0.1 * max(1.0, np.abs(sharp).max())


def test_an_indexing_table_advances():
    law = moves(
        [move(by="90 deg", time=0.3, law="modified_trapezoid"), dwell(0.2)],
        cyclic=True,
        advance="90 deg",
        start=0.1,
    )
    for cycle in (-3, 0, 1, 2, 1000):
        value, rate, _ = at(law, 0.5 * cycle + 0.15)
        assert value == pytest.approx(0.1 + math.pi / 2 * (cycle + 0.5), rel=1e-14, abs=1e-14)
        assert rate == pytest.approx(2.0 * math.pi / 2 / 0.3, rel=1e-11)
        assert at(law, 0.5 * cycle + 0.4)[1] == 0.0


def scene_of_parameters(t=(0.0, 1.5, 151)):
    def law(h, T, v, ratio):
        parts = [move(ratio * h, time=T, law="cycloidal", name="out"), dwell(name="rest")]
        parts.insert(1, move(0.0, speed=v, acceleration=30.0, jerk=900.0, name="back"))
        return moves(parts, cyclic=True, period=1.5)

    return arm(law, t=t, h=0.5, T=0.4, v=1.5, ratio=2.0)


VALUES = {"h": 0.3, "T": 0.5, "v": 3.0, "ratio": 1.5}


@pytest.mark.sampled(5)
@pytest.mark.parametrize("values", [VALUES, {}])
def test_parameters_change_all_of_it(values):
    """As if numbers stood in their place, here and in a sweep's engine."""
    h, T, v, ratio = ({"h": 0.5, "T": 0.4, "v": 1.5, "ratio": 2.0} | values).values()
    parts = [
        move(h * ratio, time=T, law="cycloidal"),
        move(0.0, speed=v, acceleration=30.0, jerk=900.0),
        dwell(),
    ]
    fixed = evaluate(arm(moves(parts, cyclic=True, period=1.5), t=(0, 1.5, 151)))
    scene = scene_of_parameters()
    found = evaluate(scene, parameters=values)
    for name in found.names():
        size = max(np.abs(fixed.array(name)).max(), 1e-3)
        np.testing.assert_allclose(found.array(name), fixed.array(name), rtol=0, atol=1e-11 * size)
    table = scene.timetable("J", values)
    assert table.stretches[0].speed == pytest.approx(2 * h * ratio / T)
    assert prepare(scene, wanted=["effort"])(**values)["effort:J"] == pytest.approx(
        found.effort("J"), rel=1e-12, abs=1e-12
    )


def test_moves_that_cannot_be_are_refused_everywhere():
    scene = scene_of_parameters()
    refused = {
        "no time is left for the part without one: the others take .* s of the period of 1.5": {
            "T": 2.0
        },
        "move 'out': its time must be positive, got -0.1 s": {"T": -0.1},
        "move 'back': its distance is zero, so limits give no duration; expected a dwell": {
            "h": 0.0
        },
        "move 'back': speed must be positive, got 0": {"v": 0.0},
    }
    for says, values in refused.items():
        for ask in (lambda v: evaluate(scene, parameters=v), lambda v: scene.timetable("J", v)):
            with pytest.raises(ParameterError, match=says):
                ask(values)
    usual = {"h": 0.5, "T": 0.4, "v": 1.5, "ratio": 2.0}
    rows = [[*(usual | values).values()] for values in ({}, *refused.values())]
    assert (prepare(scene).designs(np.array(rows)).status == 0).tolist() == [True, *[False] * 4]


SOON = {"speed": 4.0, "acceleration": 60.0}


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: moves([]), r"expected a list of move\(\.\.\.\) and dwell\(\.\.\.\), got \[\]"),
        (lambda: moves([1.0]), "expected a list of move"),
        (
            lambda: moves([dwell(1.0)]),
            r"there are only dwells; expected a move, or polynomial\(VALUE\) for a joint at rest",
        ),
        (
            lambda: moves([move(1.0)]),
            "move 1 of the moves: expected a time, or limits of speed, acceleration or jerk",
        ),
        (lambda: move(), "move: expected either to=, an end value, or by=, a distance"),
        (
            lambda: move(1.0, by=2.0, name="up"),
            "move 'up': expected either to=, an end value, or by=, a distance",
        ),
        (lambda: move(1.0, time=1.0, name="a b"), "move name 'a b' must be a letter followed by"),
        (
            lambda: moves([move(1.0, time=0.0)]),
            "move 1 of the moves: its time must be positive, got 0 s",
        ),
        (
            lambda: moves([move(1.0, time=1.0), dwell(-1.0, name="wait")]),
            "dwell 'wait': its time must be positive, got -1 s",
        ),
        (lambda: moves([move(1.0, time=math.inf)]), "move 1 of the moves: time must be finite"),
        (lambda: moves([move("1 lap", time=1.0)]), "move: to: expected a number"),
        (
            lambda: moves([move(1.0, time=1.0), dwell()]),
            "dwell 2 of the moves: expected its time, or a period of all moves",
        ),
        (
            lambda: moves([move(1.0, time=1.0), dwell(), dwell()], period=3.0),
            "2 dwells have no time; expected a time for all but one",
        ),
        (
            lambda: moves([move(1.0, time=1.0)], period=3.0),
            "the times add up to 1 s, but the period is 3 s",
        ),
        (
            lambda: moves([move(1.0, time=4.0), dwell()], period=3.0),
            "the others take 4 s of the period of 3 s",
        ),
        (
            lambda: moves([move(1.0, time=1.0)], cyclic=True),
            r"must end where it starts, at 0, but it ends at 1; .* advance=1",
        ),
        (
            lambda: moves([move(1.0, time=1.0)], cyclic=True, advance=2.0),
            "at 0, 2 beyond it, but it ends at 1",
        ),
        (
            lambda: moves([move(1.0, time=1.0)], advance=1.0),
            "advance= needs cyclic=True",
        ),
        (
            lambda: moves([move(by="10 mm", time=1.0), move(by="3 deg", time=1.0)]),
            "moves: mixes angles and lengths; expected the unit of one coordinate",
        ),
        (lambda: trapezoid(2.0), r"trapezoid: share must be above 0 and at most 0\.5, got 2\.0"),
        (
            lambda: moves([move(1.0, time=0.2, law="cycloidal", **SOON)]),
            (
                r"1 in 0\.2 s by the law cycloidal breaks its limits \(speed 4, acceleration 60\):"
                r" it takes 0\.5 s or more"
            ),
        ),
        (
            lambda: moves([move(1.0, time=0.3)], **SOON),
            r"law trapezoid breaks its limits .* it takes 0\.316667 s or more",
        ),
        (
            lambda: moves([move(1.0, time=1.0, jerk=5.0, law="trapezoid")]),
            "accelerations of the law trapezoid jump, so its jerk is infinite",
        ),
        (
            lambda: moves([move(1.0, speed=-1.0)]),
            "move 1 of the moves: speed must be positive, got -1",
        ),
        (
            lambda: moves([move(0.0, speed=1.0)]),
            "its distance is zero, so limits give no duration; expected a dwell",
        ),
        (
            lambda: moves([move(1.0, time=1.0, name="a"), dwell(1.0, name="a")]),
            "two parts are called 'a'",
        ),
        (
            lambda: arm(moves(CYCLE[:2])).timetable(["J"]),
            r"timetable: name: expected a text, got \['J'\]",
        ),
        (
            lambda: arm(moves(CYCLE[:2])).parameter_constraints([]),
            r"parameter_constraints: precision: expected a text, got \[\]",
        ),
        (
            lambda: arm(polynomial(0.0, 1.0)).timetable("J"),
            "joint 'J' is not made of moves, so it has no timetable; expected a motion by moves()",
        ),
    ],
)
def test_misuse_is_named(make, says):
    with pytest.raises(DeclarationError, match=says):
        make()


@pytest.mark.parametrize(
    "options", [{}, {"backend": "vm"}, {"backend": "c"}, {"precision": "single"}]
)
def test_at_the_seam_the_next_cycle_begins(options):
    """An acceleration jumps there: each seam shows what the first one does, by every way of
    evaluation.
    """
    m = Mechanism("indexed")
    takt = m.parameter("takt", 1.475, "s")
    m.revolute("J", m.ground, m.link("arm", length=0.4, mass=3.0))
    parts = [
        move("60 deg", time=0.4, law="simple_harmonic"),
        dwell(0.1),
        move(0, time=0.5),
        dwell(),
    ]
    law = moves(parts, cyclic=True, period=takt)
    scene = Scene(m, {"J": law}, wanted=["motion"], t=(0, 3 * takt, 61))
    solution, seams = evaluate(scene, **options), [0, 20, 40, 60]
    size = math.pi / 3 / 2 * (math.pi / 0.4) ** 2
    assert solution.motion("J").acceleration[seams] == pytest.approx(size, rel=1e-6)
    if options.get("backend") != "vm":
        series = prepare(scene, **options)()
        assert series["motion:J_acceleration"][seams] == pytest.approx(size, rel=1e-6)


PRINTED = {
    # Norton, Cam Design and Manufacturing Handbook, 2nd edition, table 3-5, and VDI 2143, part 1:
    # to the digits that are printed.
    "cycloidal": (2.000, 6.283, 39.5),
    "modified_sine": (1.760, 5.528, 69.5),
    "modified_trapezoid": (2.000, 4.888, 61.4),
    "polynomial_345": (1.875, 5.774, 60.0),
    "polynomial_4567": (2.188, 7.513, 52.5),
    "simple_harmonic": (1.571, 4.935, math.inf),
    "trapezoid": (1.5, 4.5, math.inf),
}


@pytest.mark.parametrize("name", PRINTED)
def test_coefficients_are_those_that_books_print(name):
    row = arm(moves([move(1.0, time=1.0, law=name)])).timetable("J").stretches[0]
    found = row.speed, row.acceleration, row.jerk
    for mine, printed in zip(found, PRINTED[name], strict=True):
        assert mine == pytest.approx(printed, abs=0.06 if printed > 20 else 6e-4)


def accelerations(name):
    """The places between which an acceleration is smooth, and the acceleration but for its scale,
    as books draw it.
    """
    wave = lambda u: np.sin(4 * np.pi * u)  # noqa: E731
    return {
        "cycloidal": ((0, 1), lambda u: np.sin(2 * np.pi * u)),
        "modified_sine": (
            (0, 1 / 8, 7 / 8, 1),
            lambda u: np.where(
                (u < 1 / 8) | (u > 7 / 8), wave(u), np.sin(4 * np.pi * u / 3 + np.pi / 3)
            ),
        ),
        "modified_trapezoid": (
            (0, 1 / 8, 3 / 8, 5 / 8, 7 / 8, 1),
            lambda u: np.select(
                [u < 1 / 8, u < 3 / 8, u < 5 / 8, u < 7 / 8],
                [wave(u), 1.0, np.cos(4 * np.pi * (u - 3 / 8)), -1.0],
                wave(u),
            ),
        ),
        "polynomial_345": ((0, 1), lambda u: u * (1 - u) * (1 - 2 * u)),
        "polynomial_4567": ((0, 1), lambda u: (u * (1 - u)) ** 2 * (1 - 2 * u)),
        "simple_harmonic": ((0, 1), lambda u: np.cos(np.pi * u)),
        "trapezoid": (
            (0, 1 / 3, 2 / 3, 1),
            lambda u: np.select([u < 1 / 3, u < 2 / 3], [1.0, 0.0], -1.0),
        ),
        "s_curve": (
            (0, 1 / 12, 3 / 12, 4 / 12, 8 / 12, 9 / 12, 11 / 12, 1),
            lambda u: np.interp(
                u, np.array([0, 1, 3, 4, 8, 9, 11, 12]) / 12, [0, 1, 1, 0, 0, -1, -1, 0]
            ),
        ),
    }[name]


@pytest.mark.parametrize("name", [*PRINTED, "s_curve"])
def test_laws_are_their_accelerations_integrated_twice(name):
    breaks, bend = accelerations(name)
    nodes, weights = np.polynomial.legendre.leggauss(30)

    def integral(f, stop):
        total = 0.0
        for a, b in itertools.pairwise(breaks):
            a, b = min(a, stop), min(b, stop)
            total += (b - a) / 2 * (weights @ f((a + b) / 2 + (b - a) / 2 * nodes))
        return total

    # s(u) is the integral of (u - x) a(x) over x up to u.
    whole = integral(lambda x: (1 - x) * bend(x), 1.0)
    places = np.array([0.02, 0.11, 0.2, 0.37, 0.49, 0.58, 0.71, 0.86, 0.97])
    found = derivatives(moves([move(1.0, time=1.0, law=name)]), places)
    for k, u in enumerate(places):
        expected = [
            integral(lambda x, u=u: (u - x) * bend(x), u),
            integral(bend, u),
            float(bend(np.array(u))),
        ]
        told = [x / whole for x in expected]
        assert found[:, k] == pytest.approx(told, rel=0, abs=2e-13)


def slowest_top(way, v, a, j):
    """The top speed and the time of the fastest move within limits, by halving the speed at which
    no time is left to cruise.
    """

    def ramp(top):
        return top / a + a / j if top >= a * a / j else 2 * math.sqrt(top / j)

    low, high = 0.0, v
    if v * ramp(v) > way:
        for _ in range(200):
            low, high = (
                ((low + high) / 2, high)
                if (low + high) / 2 * ramp((low + high) / 2) < way
                else (low, (low + high) / 2)
            )
    return high, way / high + ramp(high)


@settings(deadline=None, max_examples=40)
@given(st.lists(st.floats(-3.0, 3.0), min_size=4, max_size=4), st.booleans())
def test_moves_within_limits_are_the_fastest(powers, sharp):
    """With a stretch of top speed or without one, rounded by a limit of the jerk or not."""
    way, v, a, j = (10.0**power for power in powers)
    j = math.inf if sharp else j
    limits = {"speed": v, "acceleration": a} | ({} if sharp else {"jerk": j})
    row = arm(moves([move(-way, **limits)])).timetable("J").stretches[0]
    top, time = slowest_top(way, v, a, j)
    assert (row.stop, row.speed) == pytest.approx((time, top), rel=1e-9)
    assert row.acceleration <= a * (1 + 1e-9)
    assert row.jerk == pytest.approx(j, rel=1e-9)


TIMES = [0.0, 0.3, 0.5, 1.1, 1.4, 2.0]


@pytest.mark.parametrize(
    ("law", "t", "told"),
    [
        (polynomial(1.0, -2.0, 0.5, 3.0), 2.0, (23.0, 36.0, 37.0)),
        (polynomial(0.7), 5.0, (0.7, 0.0, 0.0)),
        (
            harmonic(0.2, 0.5, 3.0, 0.1),
            0.4,
            (
                0.2 + 0.5 * math.sin(2.4 * math.pi + 0.1),
                3.0 * math.pi * math.cos(2.4 * math.pi + 0.1),
                -18.0 * math.pi**2 * math.sin(2.4 * math.pi + 0.1),
            ),
        ),
        (
            expression(lambda t: ca.exp(-t) * t),
            1.5,
            (1.5 * math.exp(-1.5), -0.5 * math.exp(-1.5), -0.5 * math.exp(-1.5)),
        ),
        (samples(TIMES, [t**3 - 2 * t for t in TIMES]), 0.8, (0.8**3 - 1.6, -0.08, 4.8)),
    ],
)
def test_laws_have_their_values_and_rates(law, t, told):
    """A cubic is its own spline."""
    assert at(law, t) == pytest.approx(told, rel=1e-10, abs=1e-12)


RISING = {
    "steady": polynomial(0.1, 3.7),
    "backwards": polynomial(0.0, -0.25),
    "run-up": polynomial(0.0, 1.0, 1.5),
    "from rest": polynomial(0.0, 0.0, 0.3),
    "from rest, and soon back": expression(lambda t: 7.0 * ca.sin(1e7 * t) ** 3),
    "nearly turning back": expression(lambda t: 3 * t - 0.999 * ca.sin(3 * t)),
    "steep": expression(lambda t: 1.0 - ca.exp(-25 * t) + 30.0 * t),
    "swing": harmonic(0.0, 9.0, 0.02),
    "a dwell at its end": expression(lambda t: ca.if_else(t < 1.0, 6 * t * t * (3 - 2 * t), 6.0)),
}


@pytest.mark.parametrize("name", RISING)
def test_instants_over_a_drive_are_met_to_their_last_bits(name):
    law, stop = RISING[name], -6.0 if name == "backwards" else 6.0
    coordinates = np.linspace(0.2, stop, 61)
    solution = evaluate(arm(law), wanted=["motion"], over=("J", 0.2, stop, 61))
    motion = solution.motion("J")
    assert (np.diff(solution.t) > 0.0).all()
    allowed = 4 * np.spacing(1 + np.abs(coordinates)) + 2 * np.abs(motion.rate) * np.spacing(
        solution.t
    )
    assert (np.abs(motion.value - coordinates) <= allowed).all()


@pytest.mark.parametrize(
    ("law", "stop", "says"),
    [
        (polynomial(0.5), 1.0, "is at rest and does not go from 0 rad"),
        (polynomial(0.0, 2.0), -1.0, "runs opposite to the range from 0 rad"),
        (harmonic(0.0, 1.0, 2.0), 1.01, r"it reverses at t = 0\.125 s, at 1 rad"),
        (expression(lambda t: t + 0.02 * ca.sin(100 * t)), 9.0, "it reverses at t = 0.0837758 s"),
        (expression(ca.tanh), 1.5, r"does not go from 0 rad \(0 deg\) to 1\.5 rad"),
        (samples([0, 1, 2, 3], [0, 1, 2, 3.5]), 3.6, "its samples end at t = 3 s, at 3.5 rad"),
    ],
)
def test_what_a_law_does_not_do_is_refused(law, stop, says):
    with pytest.raises(DeclarationError, match=f"over: the motion of joint 'J' .*{says}"):
        evaluate(arm(law), wanted=["motion"], over=("J", 0.0, stop, 9))
