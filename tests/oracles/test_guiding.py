"""Motions of points and of poses: what guides them bears nothing, and what drives them is
elsewhere.
"""

import numpy as np
import pytest
from balance import assert_balanced
from five_bars import five_bar
from internals import DesignEngine, EvaluationMethod, figures

from lagrange_casadi import Mechanism, Scene, check, derive, evaluate, load, motion, save
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


def the_same(scene, k, motors):
    """The same instant, with the motors' motion given instead."""
    found = evaluate(scene)
    laws = {}
    for joint in motors:
        m = found.motion(joint)
        laws[joint] = motion.polynomial(
            float(m.value[k]), float(m.rate[k]), float(m.acceleration[k]) / 2
        )
    posture = {
        body.name: float(found.pose(body.name).angle[k])
        for body in scene.mechanism.moving
        if body.oriented
    }
    return found, Scene(scene.mechanism, laws, posture=posture, t=(0, 0, 1))


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("scene", "motors", "loads"),
    [
        (guided, ["O", "C"], [lambda place: [(("c", 0.5, 0), -20.0, 5.0, 0.0)]]),
        (platform, ["M0", "M1", "M2"], []),
    ],
    ids=["tool", "plate"],
)
def test_it_is_the_motion_of_the_motors(scene, motors, loads):
    """A tool on its path, and a plate in its pose, in closed form; the same forces where the
    motors' motion is given.
    """
    scene = scene()
    program = derive(scene)
    assert program.newton is None
    kinds = program.data.kinds
    for k in (3, 17, 38):
        found, other = the_same(scene, k, motors)
        one = evaluate(other, backend="vm")
        assert_balanced(other, t=0, loads=loads)
        assert found.certified
        assert one.certified
        for output, values in one.outputs.items():
            if output.group in ("effort", "reaction", "pose", "law"):
                unit = output.unit(kinds)
                size = max(
                    np.abs(v).max() for o, v in found.outputs.items() if o.unit(kinds) == unit
                )
                assert abs(values[0] - found.outputs[output][k]) < 1e-12 * size, output


def test_a_point_is_led_of_a_link_that_hangs_on_nothing_else():
    """The arm slides on a beam that two slots guide, so it is placed by its point."""
    m = Mechanism("trammel")
    beam, arm = m.link("beam", length=1.0, mass=2.0), m.link("arm", length=0.4, mass=1.0)
    left, right = m.point_mass("left", 0.5), m.point_mass("right", 0.5)
    m.revolute("A", left, beam)
    m.revolute("B", right, beam.tip)
    m.slot("x", m.ground, left, axis=(1, 0))
    m.slot("y", m.ground, right, axis=(0, 1))
    m.prismatic("along", beam, arm.tip, axis=(1, 0), angle="-90 deg")
    m.path("tool", arm.tip)
    laws = {"tool": (motion.harmonic(-0.2, 0.03, 1.0), motion.harmonic(0.3, 0.03, 1.0, 0.5))}
    rough = {"beam": 0.9, "x": -0.6, "y": 0.8, "along": 0.4, "arm": -0.7}
    scene = Scene(m, laws, t=(0, 0.5, 21), posture=rough, drives=["x", "along"])
    assert_balanced(scene)
    assert evaluate(scene).certified


def test_the_point_is_where_its_laws_say():
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


def test_more_drives_than_freedoms_serve_too():
    found = evaluate(guided({"O": 1.0, "C": 1.0, "A": 2.0}))
    assert found.certified
    assert "3 drives (O, C, A) for 2 degrees of freedom" in found.notes[0]
    assert not evaluate(guided()).notes


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


def test_a_file_of_it_is_checked(tmp_path):
    """Over a guide's coordinate too."""
    for number, keywords in enumerate(({}, {"over": ("plate.angle", 0.11, 0.19, 9)})):
        path = tmp_path / f"{number}.h5"
        found = evaluate(platform(), **keywords)
        save(found, path)
        assert check(path) == []
        assert load(path).description == found.description
    assert load(path).over.joint == "plate.angle"
    np.testing.assert_allclose(found.pose("plate").angle, np.linspace(0.11, 0.19, 9), rtol=1e-14)


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


def test_who_drives_must_be_said():
    with pytest.raises(
        DeclarationError,
        match=r"motion of 'tool': a guided point or pose has no effort; list the joints that drive"
        r" it in drives",
    ):
        guided(drives=None)
    with pytest.raises(
        DeclarationError,
        match=r"drives: 1 cannot make 2 independent motions; .* for the motion of tool\.x, tool\.y",
    ):
        guided(drives=["O"])


def test_a_path_has_a_name_of_its_own():
    m = five_bar(path=True).mechanism
    with pytest.raises(DeclarationError, match="frozen"):
        m.path("other", m.links["a"].tip)
    fresh = Mechanism("fresh")
    link = fresh.link("link", length=1.0, mass=1.0)
    fresh.path("tip", link.tip)
    with pytest.raises(DeclarationError, match="path 'tip' is declared twice"):
        fresh.path("tip", link.tip)
    with pytest.raises(DeclarationError, match="joint 'tip': the name is taken by a path"):
        fresh.revolute("tip", fresh.ground, link)
    with pytest.raises(DeclarationError, match="path 'fixed': a point of the ground does not move"):
        fresh.path("fixed", fresh.ground.at(1, 0))


def test_a_path_is_drawn():
    found = evaluate(guided(t=(0, 1, 21)))
    place = figures.MechanismDrawing().draw(found).axes[0]
    drawn = [line.get_xydata() for line in place.get_lines()]
    path = np.column_stack([found.output("tool_x"), found.output("tool_y")])
    assert any(line.shape == path.shape and np.abs(line - path).max() < 1e-12 for line in drawn)
    assert "tool" in " ".join(text.get_text() for text in place.texts)


def test_a_plate_is_drawn_to_a_point_beside_the_axis():
    m = Mechanism("arm")
    link = m.link("link", length=1.0, mass=1.0)
    m.revolute("O", m.ground, link)
    m.path("nose", link.at(0.5, 0.3))
    place = (
        figures.MechanismDrawing(count=1)
        .draw(evaluate(Scene(m, {"O": motion.polynomial(0.0, 1.0)}, t=(0, 1, 5))))
        .axes[0]
    )
    plate = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, 0.3], [0.0, 0.0]])
    assert any(
        line.get_xydata().shape == plate.shape and np.allclose(line.get_xydata(), plate)
        for line in place.get_lines()
    )
