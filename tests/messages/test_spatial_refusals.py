"""What cannot be in space, at instants or for parameters, is refused in a
line that names the part.
"""

import math
from math import cos, radians, sin

import casadi as ca
import numpy as np
import pytest
from internals import DesignEngine, EvaluationMethod, Status
from prepared import prepared

from lagrange_casadi import Scene, SpatialMechanism, evaluate, motion
from lagrange_casadi.errors import AssemblyError, DeclarationError, MobilityError, ParameterError

pytestmark = pytest.mark.usefixtures("interpreted")

LOCK = math.pi / 2


def ball(start, speed=1.0, **scene):
    """A link driven in its three turns."""
    m = SpatialMechanism("ball")
    turn = m.parameter("turn", start, "rad")
    m.spherical("A", m.ground, m.link("a", length=0.6, mass=1.0))
    laws = [
        motion.polynomial(0.3, 1.0),
        motion.polynomial(turn, speed),
        motion.polynomial(0.1, 0.3),
    ]
    return Scene(m, {"A": laws}, **{"t": (0, 1, 101), **scene})


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("start", "speed", "count", "says"),
    [
        (
            LOCK - 0.5,
            1.0,
            101,
            (
                r"joint 'A' is in gimbal lock at t = 0\.5 s, .* choose axis and second so that"
                r" turn_2 keeps away"
            ),
        ),
        (LOCK - 0.5, 1.0, 100, r"joint 'A' passes gimbal lock after t = 0\.4949"),
        (LOCK, 0.0, 3, r"joint 'A' is in gimbal lock at t = 0 s"),
        (-LOCK + 0.01, -1.0, 101, r"joint 'A' passes gimbal lock after t = 0 s"),
    ],
)
def test_gimbal_lock_of_a_driven_joint_is_named(start, speed, count, says):
    scene = ball(start, speed, t=(0, 1, count))
    for backend in ("c", "vm"):
        with pytest.raises(AssemblyError, match=says):
            evaluate(scene, backend=backend)
    designs = DesignEngine.of(ball(0.0, speed, t=(0, 1, count)), method=EvaluationMethod("c"))
    passes = "passes" in says
    assert designs.evaluate(np.array([[start], [3.0]])).status.tolist() == [
        Status.PASSES_DEAD_CENTRE if passes else Status.DEAD_CENTRE,
        Status.OK,
    ]


@pytest.mark.parametrize("start", [0.0, LOCK - 1e-3, LOCK + 1e-3, math.pi, 3 * LOCK + 0.01])
def test_beside_gimbal_lock_all_is_right(start):
    solution = evaluate(ball(start, 0.0))
    assert solution.certified


def test_a_turn_that_goes_near_gimbal_lock_and_back_is_no_passage():
    scene = ball(LOCK - 0.02, 0.0, t=(-0.5, 0.5, 21))
    m = SpatialMechanism("near")
    m.spherical("A", m.ground, m.link("a", length=0.6, mass=1.0))
    scene = Scene(
        m,
        {
            "A": [
                motion.polynomial(0.3),
                motion.polynomial(LOCK - 0.02, 0, -2.0),
                motion.polynomial(0.1),
            ]
        },
        t=scene.t,
    )
    assert evaluate(scene).certified


def test_gimbal_lock_matters_to_forces_alone_where_the_turns_are_given():
    solution = evaluate(ball(LOCK - 0.5), wanted=["motion"])
    assert np.isfinite(solution.motion("A:turn_3").acceleration).all()


def held_rod(**axes):
    """A rigid rod between two spherical joints; the turns of the first are coordinates, of which
    one is driven.
    """
    m = SpatialMechanism("held")
    crank, slider = m.link("crank", length=0.1, mass=1.0), m.link("slider", length=0.1, mass=1.0)
    rod = m.link("rod", length=0.3, mass=1.0, centre=(0.1, 0.0, 0.0), inertia=(1.0, 1.0, 1.0))
    m.revolute("O", m.ground, crank, axis=(0, 1, 0))
    m.spherical("A", crank.tip, rod, **axes)
    m.spherical("B", rod.tip, slider)
    m.prismatic("G", m.ground.at(0, 0.05, 0), slider, axis=(1, 0, 0))
    return m


ROUGH = {"G": 0.35, "A:turn_2": 0.0, "A:turn_3": 0.1}


def test_gimbal_lock_of_turns_that_loops_set_is_named():
    laws = {"O": motion.polynomial(0.0, 6.0), "A:turn_1": motion.polynomial(0.3)}
    with pytest.raises(AssemblyError, match=r"joint 'A' passes gimbal lock after t = 0\.2 s"):
        evaluate(Scene(held_rod(), laws, posture=ROUGH, t=(0, 1, 101)))
    assert evaluate(Scene(held_rod(), laws, posture=ROUGH, t=(0, 0.15, 31))).certified


def test_an_idle_spin_is_named_and_what_to_do_about_it():
    with pytest.raises(
        MobilityError,
        match=(
            "the spin of link 'rod' about the line from 'A' to 'B' is not determined: give one of"
            " their rotations"
        ),
    ):
        evaluate(Scene(held_rod(), {"O": motion.polynomial(0.0, 6.0)}, posture={"G": 0.35}))


def test_drives_where_there_is_nothing_to_drive_are_named():
    m = SpatialMechanism("m")
    crank, rod, slider = (
        m.link(name, length=length, mass=1.0)
        for name, length in (("crank", 0.1), ("rod", 0.3), ("slider", 0.1))
    )
    m.revolute("O", m.ground, crank, axis=(0, 1, 0))
    m.spherical("A", crank.tip, rod)
    m.spherical("B", rod.tip, slider)
    m.prismatic("G", m.ground, slider, axis=(1, 0, 0))
    with pytest.raises(
        DeclarationError,
        match="drive 'A:turn_1': the spin of two-force link 'rod' about its own axis moves"
        " nothing; drive another",
    ):
        evaluate(
            Scene(m, {"O": motion.polynomial(0.5, 6.0)}, posture={"G": 0.35}, drives=["A:turn_1"])
        )
    laws = {"O": motion.polynomial(0.5, 1.0), "A:turn_1": motion.polynomial(0.3)}
    with pytest.raises(
        DeclarationError,
        match="drive 'B:turn_1': the joint closes a loop, where its rotations are not evaluated",
    ):
        evaluate(Scene(held_rod(), laws, posture=ROUGH, drives=["O", "B:turn_1"]))


def test_what_a_posture_lacks_to_be_counted_is_named():
    m = SpatialMechanism("m")
    a, b, c = (
        m.link(name, length=length, mass=1.0)
        for name, length in (("a", 0.1), ("b", 0.3), ("c", 0.25))
    )
    m.revolute("O", m.ground, a)
    m.revolute("A", a.tip, b)
    m.revolute("B", b.tip, c)
    m.revolute("C", c.tip, m.ground.at(0.3, 0.0, 0.0))
    with pytest.raises(
        MobilityError,
        match=(
            r"could not be assembled to count by rank\) and 1 drive\(s\); also give a rough"
            r" posture of C, A"
        ),
    ):
        evaluate(Scene(m, {"O": motion.polynomial(0.0, 1.0)}))


def leaning(second):
    m = SpatialMechanism("leaning")
    lean, size = m.parameter("lean", 0.0, "rad"), m.parameter("size", 1.0)
    a = m.link("a", length=0.3, mass=1.0)
    if second:
        m.universal(
            "J", m.ground, a, axis=(0, 0, 1), second=(size * ca.cos(lean), 0, size * ca.sin(lean))
        )
        return Scene(m, {"J": (motion.polynomial(0, 1), motion.polynomial(0, 0.3))}, t=(0, 1, 5))
    m.revolute(
        "J", m.ground, a, turned=((1, 0, 0), (size * ca.sin(lean), size * ca.cos(lean), 0.0))
    )
    return Scene(m, {"J": motion.polynomial(0, 1)}, t=(0, 1, 5))


@pytest.mark.sampled(2)
@pytest.mark.parametrize(("second", "what"), [(True, ""), (False, " turned:")])
def test_axes_that_parameters_set_are_at_right_angles(second, what, tmp_path):
    """Where an evaluation refuses, a sweep and exported C do."""
    scene = leaning(second)
    told = [({}, None), ({"lean": 0.3}, "its axes must be at right angles, and are at 72.8113 deg")]
    told += [
        ({"lean": 1e-3}, "and are at 89.9427 deg"),
        ({"size": 0.0}, "its axes must not be of length zero"),
        ({"size": 7.0}, None),
    ]
    for values, says in told:
        if says is None:
            assert evaluate(scene, parameters=values).certified
            continue
        with pytest.raises(ParameterError, match=f"joint 'J':{what} .*{says}"):
            evaluate(scene, parameters=values)
    rows = np.array([list(({"lean": 0.0, "size": 1.0} | values).values()) for values, _ in told])
    fine = [says is None for _, says in told]
    assert (
        DesignEngine.of(scene, method=EvaluationMethod("c")).evaluate(rows).status == Status.OK
    ).tolist() == fine
    assert prepared(scene, rows, tmp_path) == fine


def platform(aside, *, bars):
    """Six cranks and rods hold a platform whose pose is given."""
    m, posture = SpatialMechanism("platform"), {}
    top = m.link("top", length=0.2, mass=2.0, centre=(0, 0, 0), inertia=(0.1, 0.1, 0.1))
    m.free("pose", m.ground, top, axis=(0, 0, 1), second=(0, 1, 0))
    for k, (low, high) in enumerate(
        zip((12, 108, 132, 228, 252, 348), (48, 72, 168, 192, 288, 312), strict=True)
    ):
        a, b = radians(low), radians(high)
        crank = m.link(f"crank{k}", length=0.2, mass=0.5)
        rod = m.link(f"rod{k}", length=0.6, mass=0.5)
        m.revolute(
            f"M{k}", m.ground.at(0.5 * cos(a), 0.5 * sin(a), 0), crank, axis=(-sin(a), cos(a), 0)
        )
        posture[f"M{k}"] = 0.2
        if bars:
            m.spherical(f"U{k}", crank.tip, rod)
        else:
            m.universal(f"U{k}", crank.tip, rod, axis=(0, 1, 0), second=(0, 0, 1))
            posture |= {f"U{k}:turn_1": -1.5, f"U{k}:turn_2": 0.0}
        m.spherical(f"S{k}", rod.tip, top.at(0.3 * cos(b), 0.3 * sin(b), 0))
    laws = [
        motion.polynomial(*law)
        for law in ((0.55,), (0.0, aside), (0.0, 1.0), (0.0,), (0.0,), (0.0,))
    ]
    return Scene(
        m, {"pose": laws}, t=(0, 1, 21), posture=posture, drives=[f"M{k}" for k in range(6)]
    )


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("bars", "says"),
    [
        (True, r"the loop closed by two-force link 'rod3' cannot be closed at t = 0\.1 s"),
        (
            False,
            (
                r"the loops closed by joint 'S3' did not converge at t = 0\.1 s, .*their links do"
                r" not reach"
            ),
        ),
    ],
)
def test_a_platform_out_of_reach_says_which_leg(bars, says):
    with pytest.raises(AssemblyError, match=says):
        evaluate(platform(0.2, bars=bars), wanted=["effort"])
