"""Motions made of moves and dwells: where they are when, what they refuse, and the same in every
way of evaluating them.
"""

import itertools
import math

import numpy as np
import pytest
from internals import DesignEngine, Status

from lagrange_casadi import Mechanism, Scene, evaluate, prepare, refine
from lagrange_casadi.cli import main
from lagrange_casadi.errors import AssemblyError, DeclarationError, ParameterError, UnknownNameError
from lagrange_casadi.motion import (
    Motion,
    dwell,
    move,
    moves,
    polynomial,
    s_curve,
    samples,
    trapezoid,
)

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]


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


@pytest.mark.sampled(3)
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
    program = derivatives(motion)
    sharp, bend = (program(spots.ravel())[k].reshape(spots.shape) for k in (3, 2))
    for jump, (before, after), (bent, unbent) in zip(jumps, sharp, bend, strict=True):
        change = unbent - bent if jump.what == "acceleration" else after - before
        assert jump.by == pytest.approx(change, rel=1e-5, abs=1e-5 * abs(jump.by))
    places = [0.0, *sorted(jump.t for jump in jumps), 1.1]
    for a, b in itertools.pairwise(places):
        if b - a > 1e-6:
            t = np.linspace(a + 1e-9, b - 1e-9, 2000)
            _, _, bend, sharp = program(t)
            assert np.abs(np.diff(bend)).max() < 3.0 * max(1.0, np.abs(sharp).max()) * (t[1] - t[0])
            if law != "simple_harmonic":
                assert np.abs(np.diff(sharp)).max() < 0.1 * max(1.0, np.abs(sharp).max())


def derivatives(motion):
    import casadi as ca

    t = ca.SX.sym("t")
    rows = [motion(t)]
    for _ in range(3):
        rows.append(ca.jacobian(rows[-1], t))
    function = ca.Function("law", [t], [ca.densify(row) for row in rows])
    return lambda times: [row.full().ravel() for row in function(np.asarray(times)[None])]


def test_before_and_after_it_rests():
    law = moves([move("90 deg", time=0.5)], start="30 deg", begin=0.2)
    for t, angle in ((-5.0, 30.0), (0.1, 30.0), (0.7, 90.0), (100.0, 90.0)):
        assert at(law, t) == (pytest.approx(math.radians(angle), rel=1e-15), 0.0, 0.0)
    assert at(law, 0.45)[:2] == pytest.approx(
        (math.radians(60), 1.875 * math.radians(60) / 0.5), rel=1e-14
    )


def test_a_drive_that_rests_most_of_the_time():
    """What rounding leaves at its seams is no jump beside its moves."""
    law = moves(
        [move(0.02, time=0.5), move(0.0, time=0.5), dwell()], cyclic=True, period=2 * math.pi
    )
    assert evaluate(arm(law, t=(-2 * math.pi, 4 * math.pi, 301))).certified


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
    for values, says in (
        (
            {"T": 2.0},
            r"no time is left for the part without one: the others take .* s of the period of 1\.5",
        ),
        ({"T": -0.1}, r"move 'out': its time must be positive, got -0\.1 s"),
        (
            {"h": 0.0},
            "move 'back': its distance is zero, so limits give no duration; expected a dwell",
        ),
        ({"v": 0.0}, "move 'back': speed must be positive, got 0"),
    ):
        with pytest.raises(ParameterError, match=says):
            evaluate(scene, parameters=values)
        with pytest.raises(ParameterError, match=says):
            scene.timetable("J", values)
    engine = DesignEngine.of(scene)
    rows = [
        [0.5, 0.4, 1.5, 2.0],
        [0.5, 2.0, 1.5, 2.0],
        [0.5, -0.1, 1.5, 2.0],
        [0.0, 0.4, 1.5, 2.0],
        [0.5, 0.4, 0.0, 2.0],
    ]
    assert engine.evaluate(np.array(rows)).status.tolist() == [Status.OK, *[Status.IMPOSSIBLE] * 4]


def test_peaks_are_found_beside_jumps():
    """The trapezoid's acceleration jumps between instants; the effort then is that of one side."""
    law = moves(
        [
            move(1.0, time=0.37, law=trapezoid(0.21)),
            dwell(0.13),
            move(0.0, time=0.41, law=s_curve(0.3, 0.4)),
        ],
        cyclic=True,
    )
    scene = arm(law, t=(0, 1.0, 41))
    (peak,) = refine(scene, evaluate(scene), ["effort:J"])
    assert abs(peak.value) == pytest.approx(INERTIA / (0.21 * 0.79) / 0.37**2, rel=1e-12)
    designs = DesignEngine.of(scene)
    found = designs.evaluate(np.zeros((1, 0)))
    effort = [str(quantity) for quantity in designs.quantities].index("effort:J")
    assert abs(found.value[0, effort]) == pytest.approx(abs(peak.value), rel=1e-12)


def test_instants_over_a_move():
    law = moves(
        [move(1.0, time=0.4, law="cycloidal"), dwell(0.2), move(0.0, time=0.4)], cyclic=True
    )
    solution = evaluate(arm(law), over=("J", 0.1, 0.9, 9))
    assert solution.motion("J").value == pytest.approx(np.linspace(0.1, 0.9, 9), abs=1e-13)
    assert solution.t[4] == pytest.approx(0.2, abs=1e-13)


def test_moves_of_an_angle_lift_a_follower():
    """The same law of a cam's angle: accelerations are those of time, by the speed of the cam
    squared.
    """
    m = Mechanism("cam")
    h = m.parameter("h", 0.02, "m")
    disc, rod = m.link("disc", length=0.04, mass=1.0), m.link("rod", length=0.1, mass=0.3)
    main = m.revolute("main", m.ground, disc)
    guide = m.prismatic("guide", m.ground, rod, axis=(0, 1), angle="90 deg")
    parts = [
        move(h, time=2.0, law="cycloidal"),
        dwell(1.0),
        move(0.0, time=2.0, law="cycloidal"),
        dwell(),
    ]
    lift = moves(parts, cyclic=True, period=2 * math.pi)
    m.constraint("contact", m.coordinate(guide) - 0.04 - lift(m.coordinate(main)))
    scene = Scene(
        m, {"main": polynomial(0.0, 30.0)}, t=(0, 4 * math.pi / 30, 241), posture={"rod": 1.5}
    )
    solution = evaluate(scene, parameters={"h": 0.03})
    assert solution.certified
    assert solution.motion("guide").acceleration.max() == pytest.approx(
        2 * math.pi * 0.03 * (30 / 2.0) ** 2, rel=1e-3
    )
    assert solution.motion("guide").value[[0, 120, 240]] == pytest.approx(0.04, abs=1e-14)


def test_what_moves_use_beyond_their_demands_has_no_value():
    """Where the law is part of a constraint, no scene asks for its demands: its value is none, and
    nothing is returned.
    """
    m = Mechanism("cam")
    T = m.parameter("T", 2.0)
    disc, rod = m.link("disc", length=0.04, mass=1.0), m.link("rod", length=0.1, mass=0.3)
    main = m.revolute("main", m.ground, disc)
    guide = m.prismatic("guide", m.ground, rod, axis=(0, 1), angle="90 deg")
    lift = moves(
        [move(0.02, time=T), move(0.0, time=2.0), dwell()], cyclic=True, period=2 * math.pi
    )
    m.constraint("contact", m.coordinate(guide) - 0.04 - lift(m.coordinate(main)))
    scene = Scene(m, {"main": polynomial(0.0, 30.0)}, t=(0, 0.2, 41), posture={"rod": 1.5})
    evaluate(scene)
    with pytest.raises(AssemblyError, match=r"not finite|cannot be closed"):
        evaluate(scene, parameters={"T": 5.0})
    with pytest.raises(DeclarationError, match="depends on the time alone"):
        samples([0, 1, 2, 3], [0, 1, 4, 9])(m.coordinate(main))


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
            lambda: arm(polynomial(0.0, 1.0)).timetable("J"),
            "joint 'J' is not made of moves, so it has no timetable; expected a motion by moves()",
        ),
    ],
)
def test_misuse_is_named(make, says):
    with pytest.raises(DeclarationError, match=says):
        make()


def test_a_timetable_of_another_joint():
    with pytest.raises(UnknownNameError, match="unknown driven joint 'K'; valid: J"):
        arm(moves(CYCLE[:2])).timetable("K")


def test_a_move_slower_than_its_limits_keeps_its_time():
    law = moves([move(1.0, time=0.5, **SOON)])
    row = arm(law).timetable("J").stretches[0]
    assert (row.stop, row.law) == (0.5, "trapezoid")
    assert row.speed <= 4.0
    assert row.acceleration <= 60.0


CASE = """
from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.motion import dwell, move, moves

def scene():
    m = Mechanism("arm")
    m.revolute("J", m.ground, m.link("a", length=0.6, mass=2.0))
    parts = [move(0.5, time=0.25, law="trapezoid", name="out"), dwell(0.5, name="hold"), move(0.0, time=0.25)]
    return Scene(m, {"J": moves(parts, cyclic=True)}, t=(0, 1, 11))
"""  # noqa: E501


def test_info_tells_moves_and_jumps(here, capsys):
    (here / "arm.py").write_text(CASE)
    assert main(["info", "arm.py"]) == 0
    lines = capsys.readouterr().out.splitlines()
    for line in (
        ("  drive J: 3 moves and dwells, repeated; within 0 rad (0 deg) and 0.5 rad (28.6479 deg)"),
        "    out: from 0 to 0.25 s, from 0 by 0.5 rad (trapezoid), at most 3 rad/s, 36 rad/s^2",
        "    hold: from 0.25 to 0.75 s, rests at 0.5 rad",
        (
            "    part 3: from 0.75 to 1 s, from 0.5 by -0.5 rad (polynomial_345), at most 3.75"
            " rad/s, 46.188 rad/s^2, 1920 rad/s^3"
        ),
        (
            "    the acceleration jumps at 0 s where 'out' begins, 0.0833333 s within 'out',"
            " 0.166667 s within 'out'"
        ),
    ):
        assert any(
            found.replace("from 0 rad (0 deg) to 0 rad (0 deg), ", "").startswith(line)
            for found in lines
        ), line


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
    assert prepare(scene, **options)()["motion:J_acceleration"][seams] == pytest.approx(
        size, rel=1e-6
    )
