"""Motions of points and of poses: what guides them bears nothing, and what drives them is
elsewhere.
"""

import numpy as np
import pytest
from five_bars import five_bar
from internals import DesignEngine, EvaluationMethod

from lagrange_casadi import Mechanism, Scene, derive, evaluate, motion
from lagrange_casadi.errors import AssemblyError, DeclarationError, UnknownNameError

pytestmark = pytest.mark.usefixtures("interpreted")

CIRCLE = (motion.harmonic(0.05, 0.1, 1.0), motion.harmonic(0.6, 0.05, 1.0, 1.0))
ROUGH = {"a": 2.0, "b": 1.0, "c": 2.0, "d": 1.0}
POSE = (
    motion.harmonic(0.0, 0.03, 1.0),
    motion.harmonic(0.0, 0.02, 1.0, 0.5),
    motion.harmonic(0.1, 0.1, 1.0),
)


def guided(drives=("O", "C"), laws=CIRCLE, **keywords):
    """A five-bar whose tool goes round."""
    made = five_bar(path=True).mechanism
    return Scene(
        made, {"tool": laws}, **({"posture": ROUGH, "t": (0, 1, 101), "drives": drives} | keywords)
    )


def platform(**keywords):
    """3-RRR: a plate on three legs of two links."""
    m = Mechanism("platform")
    plate = m.link("plate", length=0.2, mass=2.0, centre=(0.1, 0.05), inertia=0.02)
    for i, (x, y, px, py) in enumerate(
        ((-0.4, -0.3, 0, 0), (0.6, -0.3, 0.2, 0), (0.1, 0.6, 0.1, 0.17))
    ):
        upper, lower = m.link(f"u{i}", length=0.35, mass=0.5), m.link(f"l{i}", length=0.4, mass=0.4)
        m.revolute(f"M{i}", m.ground.at(x, y), upper)
        m.revolute(f"K{i}", upper.tip, lower)
        m.revolute(f"E{i}", lower.tip, plate.at(px, py))
    posture = {"u0": 1.5, "u1": 2.5, "u2": -2.0}
    return Scene(
        m,
        {"plate": POSE},
        **({"t": (0, 1, 41), "posture": posture, "drives": ["M0", "M1", "M2"]} | keywords),
    )


def test_the_point_is_where_its_laws_say():
    """And the pose of a plate, both in closed form."""
    assert derive(guided()).newton is None
    assert derive(platform()).newton is None
    found = evaluate(guided())
    x, y = 0.05 + 0.1 * np.sin(2 * np.pi * found.t), 0.6 + 0.05 * np.sin(2 * np.pi * found.t + 1.0)
    assert np.abs(found.output("tool_x") - x).max() < 1e-15
    assert np.abs(found.output("tool_y") - y).max() < 1e-15
    assert np.abs(found.output("tool_vx") - 0.2 * np.pi * np.cos(2 * np.pi * found.t)).max() < 1e-13
    assert (
        np.abs(found.output("tool_ay") + 0.2 * np.pi**2 * np.sin(2 * np.pi * found.t + 1.0)).max()
        < 1e-12
    )
    pose = evaluate(platform()).pose("plate")
    assert np.abs(pose.angle - 0.1 - 0.1 * np.sin(2 * np.pi * np.linspace(0, 1, 41))).max() < 1e-15


def test_a_point_mass_may_be_guided():
    m = Mechanism("carried")
    arm = m.link("arm", length=1.0, mass=2.0)
    load = m.point_mass("load", 5.0)
    m.revolute("swing", m.ground, arm)
    m.prismatic("reach", arm, load, axis=(1, 0))
    line = (motion.polynomial(0.8), motion.polynomial(-0.5, 1.0))
    found = evaluate(
        Scene(
            m,
            {"load": line},
            t=(0, 1, 21),
            posture={"arm": 0.0, "reach": 0.9},
            drives=["swing", "reach"],
        )
    )
    assert found.certified
    angle = np.arctan2(-0.5 + found.t, 0.8)
    assert np.abs(found.motion("swing").value - angle).max() < 1e-14
    assert np.abs(found.effort("reach") - (5.0 * 9.81 * np.sin(angle))).max() < 1e-12
    weight = (
        9.81 * (5.0 * 0.8 + 2.0 * 0.5 * np.cos(angle))
        + 2.0 / 3.0 * found.motion("swing").acceleration
    )
    assert np.abs(found.effort("swing") - weight).max() < 1e-12


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    "method", [EvaluationMethod("lanes"), EvaluationMethod("c", "single")], ids=["lanes", "single"]
)
def test_a_quantity_that_is_zero_where_it_is_looked_at_condemns_no_design(method):
    """The power of a tool that goes to and fro is rounding at each of
    the instants of the witness.
    """
    made = five_bar(path=True, power=True).mechanism
    line = {"tool": (motion.harmonic(0.05, 0.1, 1.0), motion.polynomial(0.6))}
    scene = Scene(made, line, ["output:still"], t=(0, 1, 101), posture=ROUGH, drives=["O", "C"])
    designs = DesignEngine.of(scene, method=method)
    assert not designs.failures(np.array(list(made.values().values())), derive(scene, ["all"]))


def test_where_links_do_not_reach_the_path_is_named():
    laws = (motion.polynomial(0.0, 1.0), motion.polynomial(0.6))
    with pytest.raises(
        AssemblyError,
        match=r"the loop closed by .* cannot be closed at t = 0\.\d+ s, where tool\.x = 0\.\d+ m",
    ):
        evaluate(guided(laws=laws))


@pytest.mark.parametrize(
    ("laws", "error", "told"),
    [
        (
            {"tool": CIRCLE[0]},
            DeclarationError,
            "motion of path 'tool': expected two laws, of x and y, got 1",
        ),
        (
            {"tool": POSE},
            DeclarationError,
            "motion of path 'tool': expected two laws, of x and y, got 3",
        ),
        (
            {"a": CIRCLE},
            DeclarationError,
            "motion of body 'a': expected three laws, of x, y and the angle, got 2",
        ),
        ({"O": CIRCLE}, DeclarationError, "motion of joint 'O': expected one law, got 2"),
        (
            {"tool": (CIRCLE[0], 3.0)},
            DeclarationError,
            "motion of path 'tool': expected a law of lagrange_casadi.motion, got 3.0",
        ),
        (
            {"tol": CIRCLE},
            UnknownNameError,
            "unknown joint, path or body in motion 'tol' .*valid: O, C, A, D, P, tool, a, b",
        ),
        ({"ground": POSE}, UnknownNameError, "unknown joint, path or body in motion 'ground'"),
    ],
)
def test_misuse_is_told(laws, error, told):
    with pytest.raises(error, match=told):
        Scene(five_bar(path=True).mechanism, laws, drives=["O", "C"])


@pytest.mark.parametrize(
    ("drives", "told"),
    [
        (None, "motion of 'tool': a guided point .* has no effort; list the joints that drive it"),
        (["O"], r"drives: 1 cannot make 2 independent motions; .* motion of tool\.x, tool\.y"),
    ],
)
def test_who_drives_must_be_said(drives, told):
    with pytest.raises(DeclarationError, match=told):
        guided(drives=drives)


def test_a_path_has_a_name_of_its_own():
    m = Mechanism("fresh")
    link = m.link("link", length=1.0, mass=1.0)
    m.path("tip", link.tip)
    with pytest.raises(DeclarationError, match="path 'tip' is declared twice"):
        m.path("tip", link.tip)
    with pytest.raises(DeclarationError, match="joint 'tip': the name is taken by a path"):
        m.revolute("tip", m.ground, link)
    with pytest.raises(DeclarationError, match="path 'fixed': a point of the ground does not move"):
        m.path("fixed", m.ground.at(1, 0))
