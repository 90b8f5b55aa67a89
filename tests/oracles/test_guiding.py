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
