"""Drives at other joints than those whose motion is given."""

import itertools
import math

import casadi as ca
import numpy as np
import pytest
from balance import assert_balanced
from five_bars import five_bar
from hypothesis import given, settings
from hypothesis import strategies as st
from internals import DesignEngine, EvaluationMethod, Status
from internals import derive_derive as derive
from mechanisms import block, four_bar, slider_crank, truss_platform

from lagrange_casadi import Mechanism, Scene, evaluate, motion
from lagrange_casadi.errors import AssemblyError, DeclarationError, UnknownNameError

pytestmark = pytest.mark.usefixtures("interpreted")

PAIRS = list(itertools.combinations("OCADP", 2))


@pytest.mark.sampled(11)
@pytest.mark.parametrize("pair", PAIRS, ids=map("".join, PAIRS))
def test_any_two_joints_of_a_five_bar_can_drive_it(pair):
    """Pins of the tree and pins that close its loop, at bodies that bear sections: all forces are
    those of free bodies.
    """
    loads = [lambda place: [(("c", 0.5, 0), -20.0, 5.0, 0.0)]]
    assert_balanced(five_bar(pair), t=0.3, loads=loads)
    solution = evaluate(five_bar(pair))
    assert solution.certified
    assert {"balance", "power", "ends"} <= set(solution.certificate)
    assert {q.part for q in solution.outputs if q.group == "effort"} == set(pair)


@pytest.mark.sampled(7)
@pytest.mark.parametrize("pair", PAIRS, ids=map("".join, PAIRS))
def test_drives_do_the_power_of_the_motion(pair):
    """The power is the motion's and the loads', whoever does it."""
    usual, other = evaluate(five_bar()), evaluate(five_bar(pair))
    power = [
        sum(s.effort(j) * s.motion(j).rate for j in joints)
        for s, joints in ((usual, "OC"), (other, pair))
    ]
    assert np.abs(power[1] - power[0]).max() < 1e-12 * np.abs(power[0]).max()


@pytest.mark.parametrize("slides", [False, True], ids=["carried", "closing"])
def test_a_slide_drives_where_the_crank_moves(slides):
    """The crank's motion is given, the piston drives: F x' = M q'."""
    made = block() if slides else slider_crank(t=(0.005, 0.03, 51))
    joint = "P" if slides else "guide"
    scene = Scene(
        made.mechanism,
        made.motion,
        posture=made.posture,
        t=(0.3, 0.4, 21) if slides else made.t,
        drives=[joint],
    )
    found = evaluate(scene)
    first = evaluate(Scene(scene.mechanism, scene.motion, posture=scene.posture, t=scene.t))
    assert found.certified
    work = found.effort(joint) * found.motion(joint).rate
    moved = first.effort("O") * first.motion("O").rate
    assert np.abs(work - moved).max() < 1e-12 * np.abs(moved).max()
    with pytest.raises(UnknownNameError):
        found.effort("O")
    assert_balanced(scene, t=0.3 if slides else 0.02)


@settings(max_examples=3, deadline=None)
@given(st.lists(st.floats(0.01, 100.0), min_size=3, max_size=5))
def test_of_more_drives_the_efforts_are_the_least(weights):
    """Efforts times weights are a combination of what the motions do at the drives (Lagrange's
    condition of the least).
    """
    drives = dict(zip("OCADP", weights, strict=False))
    found = evaluate(five_bar(drives, t=(0.2, 0.8, 3)))
    assert found.certified
    for i, t in enumerate(found.t):
        rates = []
        for turning in "OC":
            m = five_bar(t=(t, t, 1))
            laws = {
                j: motion.polynomial(float(found.motion(j).value[i]), float(j == turning))
                for j in "OC"
            }
            posture = {b: float(found.pose(b).angle[i]) for b in "abcd"}
            one = evaluate(
                Scene(m.mechanism, laws, ["motion"], t=(0, 0, 1), posture=posture), backend="vm"
            )
            rates.append([one.motion(j).rate[0] for j in drives])
        pull = np.array([w * found.effort(j)[i] for j, w in drives.items()])
        left = pull - np.array(rates).T @ np.linalg.lstsq(np.array(rates).T, pull, rcond=None)[0]
        assert np.abs(left).max() < 1e-10 * np.abs(pull).max()


def test_weights_may_be_parameters():
    told = {
        p: evaluate(five_bar(lambda h: {"O": 1.0, "C": h, "A": 3.0}), parameters={"heavier": p})
        for p in (2.0, 5.0)
    }
    for p, found in told.items():
        same = evaluate(five_bar({"O": 1.0, "C": p, "A": 3.0}))
        for joint in "OCA":
            assert np.allclose(found.effort(joint), same.effort(joint), rtol=1e-12, atol=1e-12)
    assert np.abs(told[2.0].effort("C")).max() > np.abs(told[5.0].effort("C")).max()
    assert "3 drives (O, C, A) for 2 degrees of freedom" in told[2.0].notes[0]
    assert not evaluate(five_bar(["A", "D"])).notes


def test_the_joints_of_the_motion_themselves_change_nothing():
    usual, told = evaluate(five_bar()), evaluate(five_bar(["C", "O"]))
    assert all(
        np.array_equal(usual.outputs[output], told.outputs[output]) for output in usual.outputs
    )
    assert derive(five_bar(["C", "O"])).instructions == derive(five_bar()).instructions


def test_over_constrained_mechanisms_are_driven_elsewhere():
    """What equilibrium leaves open stays open, and the efforts are none of it."""
    made = truss_platform()
    joints = [
        name
        for name, joint in made.mechanism.joints.items()
        if joint.coordinate and name not in made.motion
    ]
    usual = evaluate(made)
    for joint in joints[:4]:
        drives = [joint, *list(made.motion)[1:]]
        try:
            found = evaluate(
                Scene(made.mechanism, made.motion, posture=made.posture, t=made.t, drives=drives)
            )
        except AssemblyError:
            continue
        assert found.certified
        power = [
            sum(s.effort(j) * s.motion(j).rate for j in names)
            for s, names in ((usual, made.motion), (found, drives))
        ]
        assert np.abs(power[1] - power[0]).max() < 1e-10 * np.abs(power[0]).max()


def two_loops():
    """Two four-bars that have nothing to do with each other."""
    m = Mechanism("two_loops")
    for k, x in enumerate((0.0, 2.0)):
        a, b, c = (
            m.link(f"{name}{k}", length=l, mass=0.3)
            for name, l in zip("abc", (0.1, 0.35, 0.25), strict=True)
        )
        m.revolute(f"O{k}", m.ground.at(x, 0), a)
        m.revolute(f"A{k}", a.tip, b)
        m.revolute(f"B{k}", b.tip, c.tip)
        m.revolute(f"C{k}", m.ground.at(x + 0.3, 0.05), c)
    return (
        m,
        {f"O{k}": motion.polynomial(0.2, 3.0, 4.0) for k in range(2)},
        {f"c{k}": 1.5 for k in range(2)},
    )


def test_drives_that_depend_on_each_other_are_refused_by_name():
    m, laws, posture = two_loops()
    with pytest.raises(
        AssemblyError,
        match=r"the drives O0, C0 cannot produce the motion at t = 0"
        r" s",
    ):
        evaluate(Scene(m, laws, posture=posture, drives=["O0", "C0"]))
    assert evaluate(
        Scene(m, laws, posture=posture, drives=["C0", "B1"], t=(0.2, 0.3, 11))
    ).certified


def test_where_drives_cannot_hold_the_motion_on_the_way_there_is_no_result():
    """A piston cannot turn the crank through its dead centre."""
    made = slider_crank()
    scene = Scene(
        made.mechanism, made.motion, posture=made.posture, t=(0.01, 0.08, 71), drives=["guide"]
    )
    with pytest.raises(
        AssemblyError, match=r"the drives guide cannot produce the motion (at|after) t = 0\.0(39|4)"
    ):
        evaluate(scene)
    at = Scene(made.mechanism, made.motion, posture=made.posture, t=(0.0, 0.0, 1), drives=["guide"])
    with pytest.raises(
        AssemblyError, match="the drives guide cannot produce the motion at t = 0 s"
    ):
        evaluate(at)


@pytest.mark.parametrize(
    ("drives", "error", "told"),
    [
        ("O", DeclarationError, "drives: expected a list of joints, or weights by joint, got 'O'"),
        (["O", "O"], DeclarationError, "drives: a joint is listed twice in O, O"),
        (
            ["O"],
            DeclarationError,
            (
                "drives: 1 cannot make 2 independent motions; expected at least 2 joints for .* O,"
                " C, got O"
            ),
        ),
        ([], DeclarationError, "drives: 0 cannot make 2 independent motions; .* got none"),
        (["O", "X"], UnknownNameError, "unknown joint in drives 'X'; valid: O, C, A"),
        (
            ["O", "hung"],
            DeclarationError,
            "drives: joint 'hung' has no coordinate for an effort",
        ),
        (
            {"O": -1.0, "C": 1.0},
            DeclarationError,
            "drives: expected a positive weight of joint 'O', got -1.0",
        ),
        (
            {"O": math.nan, "C": 1.0},
            DeclarationError,
            "drives: expected a positive weight of joint 'O', got nan",
        ),
        (
            {"O": ca.SX.sym("w"), "C": 1.0},
            DeclarationError,
            "the weight of joint 'O' depends on w, which is not a parameter",
        ),
        (3, DeclarationError, "drives: expected a list of joints, or weights by joint, got 3"),
    ],
)
def test_misuse_is_told(drives, error, told):
    with pytest.raises(error, match=told):
        five_bar(drives)


def test_a_weight_that_becomes_negative_is_no_result():
    with pytest.raises(AssemblyError):
        evaluate(
            five_bar(lambda h: {"O": 1.0, "C": h - 3.0, "A": 1.0}), parameters={"heavier": 1.0}
        )


def test_a_four_bar_driven_by_its_coupler():
    scene = four_bar()
    other = Scene(scene.mechanism, scene.motion, posture=scene.posture, t=scene.t, drives=["A"])
    assert_balanced(other)


def test_sweeps_refuse_what_the_api_refuses():
    made = slider_crank()
    scene = Scene(
        made.mechanism, made.motion, posture=made.posture, t=(0.01, 0.08, 71), drives=["guide"]
    )
    for backend in ("c", "vm"):
        outcome = DesignEngine.of(scene, method=EvaluationMethod(backend)).evaluate(
            np.array([list(scene.mechanism.values().values())])
        )
        assert outcome.status.tolist() in ([Status.DEAD_CENTRE], [Status.PASSES_DEAD_CENTRE])


@pytest.mark.sampled(5)
@pytest.mark.parametrize("ratio", [1e-5, 1e-2, 1e4])
@pytest.mark.parametrize("precision", ["double", "single"])
def test_a_gear_of_any_ratio_holds(ratio, precision):
    """A drive that turns slowly or fast beside the motion bears the torque by that much more or
    less.
    """
    m = Mechanism("geared")
    arm = m.link("arm", length=1.0, mass=2.0)
    wheel = m.link("wheel", length=0.1, mass=0.0, centre=(0.0, 0.0), inertia=0.0)
    main, motor = m.revolute("main", m.ground, arm), m.revolute("motor", m.ground.at(2, 0), wheel)
    m.gear("mesh", main, motor, ratio=ratio)
    scene = Scene(m, {"main": motion.polynomial(0.3, 1.0)}, t=(0, 1, 11), drives=["motor"])
    found = evaluate(scene, precision=precision)
    torque = 2.0 * 9.81 * 0.5 * np.cos(0.3 + found.t)
    assert found.certified
    assert np.abs(found.effort("motor") * ratio / torque - 1.0).max() < (
        1e-12 if precision == "double" else 1e-5
    )
