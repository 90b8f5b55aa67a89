"""Errors put into graphs: none where nothing rounds, and none over a jump."""

import math

import casadi as ca
import numpy as np
import pytest
from internals import (
    TRIALS,
    EvaluationMethod,
    Instants,
    compensated,
    effects,
    openness,
    plain,
    points,
    run,
)
from mechanisms import truss_platform

from lagrange_casadi import Mechanism, Scene, curve, derive
from lagrange_casadi.motion import harmonic, polynomial

pytestmark = pytest.mark.quick

STAGES = {
    "double": plain,
    "pairs": lambda program: compensated(program, "double"),
    "single": lambda program: compensated(program, "single"),
}


def arm(load, motion=None, t=(0.0, 1.0, 41)):
    """A link driven about its base, under a torque that depends on time, angle and rate."""
    m = Mechanism("arm")
    link = m.link("arm", length=1.0, mass=1.0)
    joint = m.revolute("J", m.ground, link)
    m.torque("t", link, load(m.time, m.coordinate(joint), m.rate(joint)))
    return Scene(m, {"J": motion or harmonic(0.3, 1.0, 1.0)}, ["effort", "load:t"], t=t)


def instants_of(scene, stages):
    """A scene's instants in an arithmetic, and the columns that the virtual machine has there."""
    program = derive(scene)
    t, p = points(scene.t), np.array(list(scene.mechanism.values().values()))
    found, _ = run(program, t, p, EvaluationMethod("vm"))
    angles = np.array([name in program.loop_angles for name in program.columns])
    return (
        program,
        Instants(STAGES[stages](program), t, p, found.iterated),
        np.array(found.out),
        angles,
    )


def of_load(scene, stages="double", change=lambda out, row: None):
    """What errors do to the load, (trials and the result, n), and the load; ``change`` has its will
    on the result's load.
    """
    program, instants, out, angles = instants_of(scene, stages)
    row = program.names.index("load:t:mz")
    change(out, row)
    changes, columns = effects(instants, out, angles)
    return changes[row], columns[row]


@pytest.mark.parametrize(
    "load",
    [
        lambda t, q, w: 0.5 * t + 0.25,
        lambda t, q, w: (t - 0.75) * (t + 2.0),
        lambda t, q, w: 1e9 * (q - q),
        lambda t, q, w: ca.cos(0.0 * t) * 3.0,
        lambda t, q, w: ca.floor(8 * q) * 2.0 + ca.sign(w + 0.3) * (q > 0.1),
        lambda t, q, w: 1e9 * ((t + 4.0) - 4.0),
        lambda t, q, w: ca.sqrt(4.0 * t * t) / 2.0,
    ],
)
def test_what_rounds_nothing_has_no_errors(load):
    """Times of few bits; numbers that are whole, and truths."""
    changes, _ = of_load(arm(load, t=(0.0, 1.0, 33)))
    assert changes.shape == (TRIALS + 1, 33)
    assert not changes[:TRIALS].any()


@pytest.mark.parametrize("stages", STAGES)
def test_what_rounds_has_errors_of_that_size(stages):
    """A product of numbers of many bits; and a difference that magnifies what a sum has rounded."""
    unit = 2.0**-24 if stages == "single" else 2.0**-53
    changes, columns = of_load(arm(lambda t, q, w: 0.1 * w), stages)
    assert 0.2 * unit < np.max(np.abs(changes[:TRIALS])) / np.max(np.abs(columns)) < 6 * unit
    changes, _ = of_load(arm(lambda t, q, w: 1e3 * ((w + 1e3) - 999.9)), stages)
    assert 0.2 * unit * 1e6 < np.max(np.abs(changes[:TRIALS])) < 2 * unit * 1e6


AT = 0.3 + math.sin(2 * math.pi * 7 / 40)
"""Where the arm is at the seventh instant, but for rounding."""

JUMPS = {
    "sign of an angle": (lambda t, q, w: 1e3 * ca.sign(q - AT), harmonic(0.3, 1.0, 1.0)),
    "sign of a rate": (lambda t, q, w: 1e3 * ca.sign(w), harmonic(0.3, 1.0, 1.0)),
    "rate above zero": (lambda t, q, w: 1e3 * (w > 0), harmonic(0.3, 1.0, 1.0)),
    "if_else of an angle": (
        lambda t, q, w: ca.if_else(q > 0.3, 1e3, -2e3 * q),
        harmonic(0.3, 1.0, 1.0),
    ),
    "floor": (lambda t, q, w: 1e3 * ca.floor(q / 0.1), polynomial(0.1, 2.0)),
    "fmod": (lambda t, q, w: 1e3 * ca.fmod(q, 0.1), polynomial(0.1, 2.0)),
    "remainder": (lambda t, q, w: 1e3 * ca.remainder(q, 0.1), polynomial(0.05, 2.0)),
    "direction at half a turn": (
        lambda t, q, w: 1e3 * ca.atan2(ca.sin(q), ca.cos(q)),
        polynomial(0.0, 2 * math.pi),
    ),
    "copysign": (lambda t, q, w: ca.copysign(1e3, w), harmonic(0.3, 1.0, 1.0)),
    "several": (
        lambda t, q, w: 1e3 * ca.sign(w) + ca.sign(q - 0.3) * 7e3 + 3e4 * (t >= 0.25),
        harmonic(0.3, 1.0, 1.0),
    ),
}


def turned(out, row, where, load):
    """A result that has another load at an instant, and the effort that goes with it."""
    out[-1, where] += out[row, where] - load
    out[row, where] = load


@pytest.mark.sampled(9)
@pytest.mark.parametrize("stages", STAGES)
@pytest.mark.parametrize("jump", JUMPS)
def test_trials_stay_on_the_side_of_a_jump(jump, stages):
    """Rates and angles that are zero at instants but for rounding, and angles that are where the
    load jumps.
    """
    load, motion = JUMPS[jump]
    changes, _ = of_load(arm(load, motion), stages)
    unit = 2.0**-24 if stages == "single" else 2.0**-53
    assert np.max(np.abs(changes[:TRIALS])) < 100 * unit * 1e4


@pytest.mark.parametrize("load", [-1e3, 1e3])
@pytest.mark.parametrize(
    "jump",
    [lambda q: ca.sign(q - AT), lambda q: ca.copysign(1.0, q - AT), lambda q: 1 - 2 * (q < AT)],
)
def test_the_side_that_a_result_took_is_found(jump, load):
    """A result on either side of the jump, where rounding decides, is none the worse."""
    scene = arm(lambda t, q, w: 1e3 * jump(q))
    changes, columns = of_load(scene, change=lambda out, row: turned(out, row, 7, load))
    assert columns[7] == load
    assert np.max(np.abs(changes)) < 1e-9


def test_sides_that_no_instant_changes():
    """A curve of what stands still: nothing but rounding tells in which of its cells that is."""
    m = Mechanism("arm")
    link, body = m.link("arm", length=1.0, mass=1.0), m.point_mass("body", 0.1)
    m.revolute("J", m.ground, link)
    m.weld("W", m.ground.at(0.1, 0.0), body)
    knots = curve([0.0, 0.1, 0.5, 0.8], [0.2, 0.8, -0.9, 0.2], periodic=True)
    m.torque("t", link, 1e3 * knots(m.place(body)[0]))
    scene = Scene(m, {"J": harmonic(0.3, 1.0, 1.0)}, ["effort", "load:t"], t=(0.0, 1.0, 41))
    changes, columns = of_load(scene, "single", lambda out, row: turned(out, row, 7, 700.0))
    assert columns == pytest.approx(800.0, rel=1e-6)
    assert changes[TRIALS, 7] == pytest.approx(-100.0, rel=1e-3)
    assert np.max(np.abs(changes[:TRIALS])) < 1e-2


def test_what_is_on_no_side_of_a_jump_is_an_error():
    scene = arm(lambda t, q, w: 1e3 * ca.sign(q - AT))
    changes, _ = of_load(scene, change=lambda out, row: turned(out, row, 7, 400.0))
    assert 400.0 <= np.max(np.abs(changes[TRIALS])) <= 1400.0
    assert np.max(np.abs(changes[:TRIALS])) < 1e-9


@pytest.mark.parametrize("later", [0.0, 1e3])
def test_what_a_drive_hands_on_may_jump(later):
    """Whole parts of time, followed in pairs: on the side that a result took."""
    scene = arm(lambda t, q, w: 1e3 * ca.fmod(t, 0.1), t=(later, later + 1.0, 41))
    scene_t = points(scene.t)
    for side in (0.0, 100.0):

        def take(out, row, side=side):
            for i in np.flatnonzero((np.abs(out[row] - 50.0) > 49.0) & (scene_t > 0.0)):
                turned(out, row, i, side)

        changes, _ = of_load(scene, "single", take)
        assert np.max(np.abs(changes)) < 1e-4


def test_loops_that_are_open():
    """One step an instant leaves them open; so many that there is but rounding left."""
    scene = truss_platform()
    program = derive(scene)
    t, p = points(scene.t), np.array(list(scene.mechanism.values().values()))
    angles = np.array([name in program.loop_angles for name in program.columns])
    closed, _ = run(program, t, p, EvaluationMethod("vm"))
    found, _ = run(program, t, p, EvaluationMethod("vm", newton=1))
    instants = Instants(plain(program), t, p, found.iterated)
    assert np.max(openness(Instants(plain(program), t, p, closed.iterated))) < 100.0
    assert np.argmax(openness(instants)) > 0
    assert openness(instants)[0] < 100.0 < 1e6 < np.max(openness(instants))
    changes, columns = effects(instants, np.array(found.out), angles)
    true = np.array(found.out) - np.array(closed.out)
    true -= np.where(angles[:, None], math.tau * np.rint(true / math.tau), 0.0)
    scale = np.max(np.abs(columns), axis=1, keepdims=True) + 1e-3
    np.testing.assert_allclose(changes[:, TRIALS] / scale, true / scale, rtol=0.0, atol=1e-11)
    assert np.max(np.abs(changes[:, :TRIALS]) / scale[:, None]) < 1e-11


def test_many_instants_are_followed_in_blocks(monkeypatch):
    _, instants, *_ = instants_of(arm(lambda t, q, w: w), "double")
    chosen = np.arange(41)
    (whole,) = instants.blocks(chosen)
    np.testing.assert_array_equal(whole, chosen)
    monkeypatch.setattr("lagrange_casadi.verification.disturbed._AT_ONCE", 1)
    assert [block.tolist() for block in instants.blocks(chosen)] == [
        [*range(16)],
        [*range(16, 32)],
        [*range(32, 41)],
    ]
