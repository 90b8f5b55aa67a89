"""Robots beside Pinocchio and MuJoCo: drives, payloads, feet."""

import numpy as np
import pytest
from internals import case_of

from lagrange_casadi import Mechanism, Scene, evaluate, free, read
from lagrange_casadi.actuators import inertia_at
from lagrange_casadi.errors import ModelFileError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("interpreted")
AT = {"t": (0.0, 0.0, 1)}
AXES = {
    "q1": (0.0, 0.6, 0.8),
    "q2": (1.0, 0.0, 0.0),
    "q3": (0.0, 0.28, 0.96),
    "q4": (0.6, 0.0, 0.8),
}
MOVES = {"q1": (0.3, 0.7, -1.1), "q2": (-0.4, 1.3, 0.9), "q3": (0.05, -0.2, 0.4),
         "q4": (0.8, -0.6, 1.7)}  # fmt: skip
"""Coordinates, rates and accelerations."""

ROTORS = {"q1": (3e-4, 40.0), "q2": (1e-4, -60.0), "q3": (2e-4, 300.0), "q4": (5e-5, 80.0)}
LOADS = {
    "q1": '<dynamics damping="0.7" friction="1.5"/>',
    "q2": '<dynamics damping="0.4"/>',
    "q3": '<dynamics friction="2.5"/>',
}


def link(name, mass, centre, inertia):
    six = " ".join(f'{k}="{x}"' for k, x in zip(("ixx", "iyy", "izz"), inertia, strict=True))
    return (
        f'<link name="{name}"><inertial><origin xyz="{centre}"/><mass value="{mass}"/>'
        f'<inertia {six} ixy="0" ixz="0" iyz="0"/></inertial></link>'
    )


def urdf(losses=None, more=""):
    """An arm of three turns and a slide, with a frame without mass at its end."""
    inertia = 0.02, 0.03, 0.04
    bodies = [link(f"b{k}", 3.0 - k / 2, f"0.1 {0.05 * k} 0.03", inertia) for k in range(5)]
    joints = [
        f'<joint name="q{k}" type="{"prismatic" if k == 3 else "revolute"}">'
        f'<parent link="b{k - 1}"/><child link="b{k}"/>'
        f'<origin xyz="0.{k} 0.1 0.2" rpy="0.3 -0.2 0.{k}"/>'
        f'<axis xyz="{" ".join(map(str, AXES[f"q{k}"]))}"/>'
        f'<limit effort="60" velocity="1.4" lower="-3" upper="3"/>'
        f'{(losses or {}).get(f"q{k}", "")}</joint>'
        for k in range(1, 5)
    ]  # fmt: skip
    tool = '<link name="tool0"/><joint name="t" type="fixed"><parent link="b4"/>'
    tool += '<child link="tool0"/><origin xyz="0.2 0 0.1" rpy="0.5 0 0.7"/></joint>'
    return f'<robot name="arm">{"".join(bodies + joints)}{tool}{more}</robot>'


@pytest.fixture
def arm(tmp_path):
    def scene(text, name="arm.urdf", **more):
        path = tmp_path / name
        path.write_text(text)
        found = read(path, **more)
        given = {name: MOVES[name] for name in found.mechanism.joints if name in MOVES}
        laws = {name: polynomial(q, v, a / 2) for name, (q, v, a) in given.items()}
        return Scene(found.mechanism, laws, **AT)

    return scene


def moved(pinocchio, model, **more):
    """Efforts by Pinocchio, of coordinates in its order."""
    rows = np.array([{**MOVES, **more}[name] for name in model.names[1:]]).T
    return pinocchio.rnea(model, model.createData(), *rows)


def efforts(solution, names=tuple(MOVES)):
    return np.array([solution.effort(name)[0] for name in names])


def geared(more=""):
    return "".join(
        f'<transmission name="t{name}"><joint name="{name}"/><actuator name="m{name}">'
        f"<mechanicalReduction>{ratio}</mechanicalReduction>"
        f'<drake:rotor_inertia value="{inertia}"/></actuator></transmission>'
        for name, (inertia, ratio) in ROTORS.items()
    )


def test_rotors_are_those_of_transmissions(arm):
    """What they do is drawn elsewhere: bodies that turn behind gears (test_spatial_evaluate)."""
    drives = arm(urdf(more=geared())).mechanism.drives
    told = {name: drives[f"{name}_drive"] for name in ROTORS}
    assert {name: (one.rotor_inertia, one.ratio) for name, one in told.items()} == ROTORS


def test_armature_damping_and_dry_friction_are_those_of_pinocchio(arm):
    pinocchio = pytest.importorskip("pinocchio")
    scene = arm(urdf(LOADS))
    model = pinocchio.buildModelFromXML(urdf(LOADS))
    order = [model.getJointId(name) - 1 for name in MOVES]
    rates = np.array([MOVES[name][1] for name in MOVES])
    resisted = np.array([0.7, 0.4, 0.0, 0.0]) * rates
    resisted += np.array([1.5, 0.0, 2.5, 0.0]) * np.sign(rates)
    solution = evaluate(scene)
    assert solution.certified
    expected = moved(pinocchio, model)[order] + resisted
    np.testing.assert_allclose(efforts(solution), expected, rtol=0, atol=1e-12 * 60)
    used = solution.drives_used()
    assert used["q2_drive"].effort.share == pytest.approx(abs(expected[1]) / 60.0)
    assert used["q1_drive"].speed.share == pytest.approx(0.5)


def test_a_payload_is_a_mass_at_a_frame(arm):
    pinocchio = pytest.importorskip("pinocchio")
    model = pinocchio.buildModelFromXML(urdf())
    frame = model.frames[model.getFrameId("tool0")]
    place = frame.placement.act(np.array([0.0, 0.02, 0.1]))
    load = pinocchio.Inertia(3.0, place, np.zeros((3, 3)))
    model.appendBodyToJoint(frame.parentJoint, load, pinocchio.SE3.Identity())
    solution = evaluate(arm(urdf(), payload=["tool0=3kg@(0,20mm,0.1)"]))
    np.testing.assert_allclose(efforts(solution), moved(pinocchio, model), rtol=0, atol=6e-11)
    heavier = evaluate(arm(urdf(), payload=["b2=1"]), parameters={"mass_b2_payload": 2.0})
    assert heavier.certified


def press(geared, inertia=3e-4, ratio=12.0):
    """A slider-crank whose drive at a passive pin turns a rotor: a body behind a gear, or not."""
    m = Mechanism("press")
    own = 2e-3 - (inertia if geared else 0.0)
    crank = m.link("crank", length=0.1, mass=1.0, centre=(0.04, 0.01), inertia=own)
    rod, slide = m.link("rod", length=0.4, mass=0.6), m.point_mass("slide", 2.0)
    m.revolute("O", m.ground, crank)
    pin = m.revolute("A", crank.tip, rod)
    m.revolute("B", rod.tip, slide)
    m.prismatic("G", m.ground, slide, axis=(1, 0))
    if geared:
        rotor = m.link("rotor", length=0.01, mass=0.0, centre=(0, 0), inertia=inertia)
        m.gear("mesh", pin, m.revolute("R", crank.tip, rotor), ratio=ratio)
    else:
        m.drive("motor", pin, rotor_inertia=inertia, ratio=ratio)
    motion = {"O": polynomial(0.3, 9.0, 20.0)}
    return Scene(m, motion, t=(0, 0.3, 7), posture={"rod": 0.0})


def test_a_rotor_is_reflected_as_a_body_behind_a_gear():
    seen = [inertia_at(press(geared), "O") for geared in (False, True)]
    np.testing.assert_allclose(*seen, rtol=1e-13)
    runs = [
        free(press(geared), drive=1.0, t=(0.0, 0.2, 5), start=(0.3, 9.0))
        for geared in (False, True)
    ]
    np.testing.assert_allclose(runs[0].speed, runs[1].speed, rtol=1e-7)


MJCF = """<mujoco><worldbody><body name="a">
<joint name="q1" axis="0 0.6 0.8" armature="0.3" actuatorfrcrange="-30 40"/>
<geom size="0.1" pos="0.3 0 0.1"/><body name="b" pos="0.5 0 0">
<joint name="q2" axis="1 0 0" type="slide" damping="0.3" armature="0.2"/>
<geom size="0.1" pos="0.1 0.2 0"/></body></body></worldbody></mujoco>"""


def test_a_drive_has_its_armature_and_the_lesser_of_two_limits(arm):
    pytest.importorskip("mujoco")
    drive = arm(MJCF, "arm.xml").mechanism.drives["q1_drive"]
    assert (drive.effort, drive.armature) == (30.0, 0.3)


LEGS = {"FL": (0.2, 1), "FR": (0.2, -1), "RL": (-0.2, 1), "RR": (-0.2, -1)}
ANGLES = dict(enumerate((0.1, 0.7, -1.4, 0.6, -0.15, 0.05), 1))
BENT = {f"{leg}_{k}": q for leg in LEGS for k, q in ANGLES.items()}
PARTS = {"hip": (0.7, "0 0.01 0"), "thigh": (1.0, "0 -0.02 -0.03"), "calf": (0.3, "0 0 -0.1")}
BASE = [f"trunk_free:{move}_{k}" for move in ("slide", "turn") for k in (1, 2, 3)]


SOLE = {"heel": "0 1 0", "ankle": "1 0 0", "sole": "0 0 1"}
CORNERS = [f"{x} {y} -0.03" for x in (-0.06, 0.1) for y in (-0.04, 0.04)]
"""Axes of the joints that lead to a wide foot, and its corners."""


def walker(legs, wide=False):
    """A trunk with legs of three joints each, whose feet are frames without mass; or of six, with
    a wide foot, whose corners are these frames.
    """

    def joint(name, parent, child, at, axis):
        ends = f'<parent link="{parent}"/><child link="{child}"/><origin xyz="{at}"/>'
        kind = "revolute" if axis else "fixed"
        more = f'<axis xyz="{axis}"/><limit effort="9" velocity="9"/>' if axis else ""
        return f'<joint name="{name}" type="{kind}">{ends}{more}</joint>'

    found = [link("trunk", 6.0, "0.01 0.005 0.02", (0.02, 0.05, 0.06))]
    for leg, (x, side) in ((leg, LEGS[leg]) for leg in legs):
        hip, thigh, calf, foot = (f"{leg}_{part}" for part in (*PARTS, "foot"))
        found += [link(f"{leg}_{part}", *of, (0.003, 0.004, 0.002)) for part, of in PARTS.items()]
        found += [joint(f"{leg}_1", "trunk", hip, f"{x} {0.05 * side} 0", "1 0 0")]
        found += [joint(f"{leg}_2", hip, thigh, f"0 {0.08 * side} 0", "0 1 0")]
        found += [joint(f"{leg}_3", thigh, calf, "0 0 -0.2", "0 1 0")]
        end = calf
        for k, (part, axis) in enumerate(SOLE.items() if wide else (), 4):
            found += [link(f"{leg}_{part}", 0.3, "0.02 0 -0.01", (0.002, 0.003, 0.004))]
            found += [
                joint(
                    f"{leg}_{k}",
                    end,
                    end := f"{leg}_{part}",
                    f"0 0 {-0.2 if k == 4 else 0.0}",
                    axis,
                )
            ]
        for k, place in enumerate(CORNERS if wide else ("0 0 -0.21",)):
            found += [f'<link name="{foot}{k or ""}"/>']
            found += [joint(f"{leg}_tip{k or ''}", end, f"{foot}{k or ''}", place, "")]
    return f'<robot name="walker">{"".join(found)}</robot>'


def freed(pinocchio, text):
    """A robot whose base slides along and turns about x, y and z."""
    root = pinocchio.JointModelComposite(pinocchio.JointModelTranslation())
    for one in (pinocchio.JointModelRX(), pinocchio.JointModelRY(), pinocchio.JointModelRZ()):
        root.addJoint(one)
    return pinocchio.buildModelFromXML(text, root)


def motions(solution, names):
    moves = [solution.motion(name) for name in names]
    return (
        np.array([getattr(one, word)[0] for one in moves])
        for word in ("value", "rate", "acceleration")
    )


def least(pinocchio, text, solution, feet, weights):
    """Efforts by weights that make a motion, and the forces on feet, by Pinocchio's inverse
    dynamics and Jacobians: the least sum of weight effort^2 with effort = needed - J' force.
    """
    model = freed(pinocchio, text)
    data, names = model.createData(), [*BASE, *model.names[2:]]
    q, v, a = motions(solution, names)
    needed = pinocchio.rnea(model, data, q, v, a)
    pinocchio.computeJointJacobians(model, data, q)
    pinocchio.updateFramePlacements(model, data)
    frame = pinocchio.ReferenceFrame.LOCAL_WORLD_ALIGNED
    rows = [
        pinocchio.getFrameJacobian(model, data, model.getFrameId(foot), frame)[:3] for foot in feet
    ]
    jacobian, free = np.vstack(rows), [name not in weights for name in names]
    scale = np.sqrt([weights.get(name, 0.0) for name in names])
    held, many = jacobian[:, free].T, jacobian.shape[0]  # whose efforts are zero
    left = np.block(
        [[scale**2 * jacobian @ jacobian.T, held.T], [held, np.zeros((sum(free),) * 2)]]
    )
    right = np.concatenate([jacobian @ (scale**2 * needed), needed[free]])
    force = np.linalg.lstsq(left, right, rcond=1e-13)[0][:many]
    found = needed - jacobian.T @ force
    return dict(zip(names, found, strict=True)), force.reshape(-1, 3)


@pytest.mark.parametrize(
    ("legs", "feet", "base", "wide"),
    [
        ("FL FR RL RR", "FL FR RL RR", None, False),
        ("FL FR RL RR", "FL RR", 30.0, False),
        ("FL FR", "FL FR", 30.0, False),
        ("FL FR", "FL FR", None, True),
    ],
    ids=["standing", "trotting", "biped", "on wide feet"],
)
def test_legs_bear_a_robot_with_the_least_efforts(legs, feet, base, wide, tmp_path):
    """The base moves; feet stay. On two points the base's own efforts are weighted heavily. How
    the corners of a wide foot share its force is open.
    """
    pinocchio = pytest.importorskip("pinocchio")
    legs, corners = legs.split(), ("", 1, 2, 3) if wide else ("",)
    feet = [f"{leg}_foot{corner}" for leg in feet.split() for corner in corners]
    (path := tmp_path / "walker.urdf").write_text(text := walker(legs, wide))
    posture = {name: q for name, q in BENT.items() if name[:2] in legs and (wide or name[3] < "4")}
    scene = read(path, floating=True, posture=posture, contacts=feet)
    moved = {"slide": (0.01, 0.2, -0.7), "turn": (0.05, -0.3, 1.1)}
    laws = {}
    for k, name in enumerate(scene.motion):
        q, v, a = moved["slide" if "slide" in name else "turn"]
        laws[name] = polynomial(q + posture.get(name, 0.0), v + 0.1 * k, a + 0.2 * k)
    weights = {name: 1.0 + 0.1 * k for k, name in enumerate(posture)}
    weights |= dict.fromkeys(BASE, base) if base else {}
    rough = scene.posture
    scene = Scene(scene.mechanism, laws, posture=rough, drives=weights, **AT)
    solution = evaluate(scene)
    assert solution.certified
    assert bool(solution.undetermined) == wide
    expected, forces = least(pinocchio, text, solution, feet, weights)
    size = max(map(abs, expected.values()))
    for name in weights:
        assert solution.effort(name)[0] == pytest.approx(expected[name], abs=1e-12 * size)
    for foot, force in () if wide else zip(feet, forces, strict=True):
        margin = (0.6 * force[2] - np.hypot(*force[:2])) / np.sqrt(1.36)
        given = solution.series[f"output:{foot}_contact_margin"][0]
        assert given == pytest.approx(margin, abs=1e-10)


def pendulum(links, joints):
    """A robot of rows: of links centre, of joints parent, child, origin, axis."""
    text = "".join(link(name, 2.0, at, (0.02, 0.03, 0.04)) for name, at in links.items())
    for name, (parent, child, at, axis) in joints.items():
        ends = f'<parent link="{parent}"/><child link="{child}"/><origin xyz="{at}"/>'
        ends += f'<axis xyz="{axis}"/><limit effort="9" velocity="9"/>'
        text += f'<joint name="{name}" type="revolute">{ends}</joint>'
    return f'<robot name="pendulum">{text}</robot>'


def test_any_link_may_be_the_free_base(tmp_path):
    """Pinocchio has the same robot with its joints the other way round."""
    pinocchio = pytest.importorskip("pinocchio")
    (path := tmp_path / "pendulum.urdf").write_text(pendulum(
        {"a": "0.1 0.2 0", "b": "0.3 0 0.1", "c": "0 0.1 0.4"},
        {"q1": ("a", "b", "0.2 0.5 0", "0 0.6 0.8"), "q2": ("b", "c", "0.7 0 0.1", "1 0 0")},
    ))  # fmt: skip
    other = pendulum(
        {"c": "0 0.1 0.4", "b": "-0.4 0 0", "a": "-0.1 -0.3 0"},
        {"q2": ("c", "b", "0 0 0", "-1 0 0"), "q1": ("b", "a", "-0.7 0 -0.1", "0 -0.6 -0.8")},
    )
    scene = read(path, floating="c", posture={"q1": 0.4, "c_free:slide_3": 0.2})
    law = {name: polynomial(0.1 * k, 0.7, 0.3 - k / 9) for k, name in enumerate(scene.motion, 1)}
    solution = evaluate(Scene(scene.mechanism, law, **AT))
    assert solution.certified
    model = freed(pinocchio, other)
    names = [*(name.replace("trunk", "c") for name in BASE), *model.names[2:]]
    expected = pinocchio.rnea(model, model.createData(), *motions(solution, names))
    assert efforts(solution, names) == pytest.approx(expected, abs=1e-12 * abs(expected).max())


def test_a_base_is_freed_once(tmp_path):
    """A file whose base hangs on a floating joint frees it already."""
    file = tmp_path / "dog.urdf"
    free = '<joint name="wj" type="floating"><parent link="world"/><child link="trunk"/></joint>'
    trunk = link("trunk", 6.0, "0 0 0", (0.02, 0.05, 0.06))
    file.write_text(f'<robot name="dog"><link name="world"/>{trunk}{free}</robot>')
    for floating in (True, "trunk"):
        with pytest.raises(ModelFileError, match="frees 'trunk' already: leave floating out"):
            case_of(file, floating=floating)


def test_a_free_base_must_be_there(tmp_path):
    pytest.importorskip("mujoco")
    (path := tmp_path / "fixed.xml").write_text(MJCF)
    with pytest.raises(ModelFileError, match="expected joints from 'b' to one base that is free"):
        read(path, floating="b")
