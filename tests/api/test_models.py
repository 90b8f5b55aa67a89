"""Models of other programs: what ``read`` makes of a file, what the written case says of it, and
what is refused; a file comes back from ``save_model``.
"""

import json
import random
import re
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from conftest import CASES
from drawn_models import law, text_of
from model_files import (
    IDENTITY,
    LARGE,
    SMALL,
    assembly,
    inertial,
    joint,
    link,
    mjcf,
    own,
    own_body,
    own_joint,
    sdf,
    sdf_joint,
    sdf_link,
    turned,
    urdf,
)
from places import TESTS

from lagrange_casadi import (
    Mechanism,
    Scene,
    SpatialMechanism,
    errors,
    evaluate,
    load_case,
    read,
    save_model,
)
from lagrange_casadi.cli import main
from lagrange_casadi.formats import case_of
from lagrange_casadi.motion import harmonic, polynomial

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]


@pytest.fixture
def file(tmp_path):
    """Write the text of a model, or its JSON, and return the path."""

    def written(ending, told):
        if ending == "xml":
            pytest.importorskip("mujoco", reason="MuJoCo is not installed")
        path = tmp_path / f"model.{ending}"
        path.write_text(told if isinstance(told, str) else json.dumps(told))
        return path

    return written


def efforts(scene, count=5, laws=None, **more):
    """The efforts of a scene, or of its mechanism under other laws: a row a drive."""
    if laws is not None:
        scene = Scene(scene.mechanism, laws, **more)
    found = evaluate(scene, t=(*scene.span, count), wanted=["effort"])
    return np.array(list(found.outputs.values()))


def assert_same(one, other, rtol=1e-10):
    assert np.abs(one - other).max() <= rtol * np.abs(other).max()


MOVE = {"p": polynomial(0.3, 0.4, 0.5)}  # 0.4 rad/s and 1 rad/s^2


WEIGHT, TURN = 0.1 * 9.81 * np.cos(0.3), 0.2 + 0.1**2


SDF_WEIGHT = WEIGHT / 9.81 * 9.8


AT_REST = -9.81 * 0.25


BASE = '<link name="base"/>'


P = partial(joint, "p", "base", "a", axis="0 -1 0")


def arm(*parts):
    return urdf(BASE, link("a"), *parts)


def frame(name, *more):
    return f'<link name="{name}"/>', joint("q", "a", name, kind="fixed"), *more


def sdf_arm(*inside, dynamics="", version="1.10", before="", kind="revolute", held=None):
    """A link of 1 kg that turns about y of a joint at its base, which is turned about z."""
    axis = "0 -1 0" if kind == "revolute" else "0 1 0"
    body = f'<link name="a"><pose>0 0 0 0 0 1.5707963267948966</pose>{"".join(inside)}'
    held = inertial(1.0) if held is None else held
    parts = body + held + "</link>", sdf_joint("p", "world", "a", axis, kind, dynamics)
    return sdf(*parts, world=before, version=version)


def dynamics(**told):
    return "".join(["<dynamics>", *(f"<{k}>{v}</{k}>" for k, v in told.items()), "</dynamics>"])


DRAGGED = dynamics(damping=2, spring_stiffness=5, spring_reference=0.1, friction=3)


MJCF_ARM = """
<body name="a" {} pos="0 0 1"><joint name="p" axis="0 1 0" {}/>
  <geom type="capsule" size="0.02" fromto="0 0 0 0.5 0 0" mass="1"/></body>
"""


MJCF_PLAIN = MJCF_ARM.format("", "")


MJCF_PAIR = MJCF_PLAIN + MJCF_PLAIN.replace('"p"', '"k"').replace('"a"', '"other"')


WELD = '<equality><weld body1="a" body2="b" anchor="-0.5 0.1 0.2" {}/></equality>'


HELD = MJCF_PLAIN + (
    '<body name="b" pos="1 0 1"><freejoint/><geom type="box" size="0.1 0.1 0.1" mass="2"/></body>'
)


SLIDING = HELD.replace("<freejoint/>", '<joint name="x" axis="1 0 0"/>')


READ = {
    "urdf": (arm(P()), TURN + WEIGHT, []),
    "urdf damping": (
        arm(P(more='<dynamics damping="2" friction="3"/>')),
        TURN + WEIGHT + 2.0 * 0.4,
        ["Not read of joint/dynamics: friction= (p)."],
    ),
    "urdf turnGravityOff": (
        arm(P(), '<gazebo reference="a"><turnGravityOff>1</turnGravityOff></gazebo>'), TURN, []
    ),
    "urdf gravity": (
        arm(P(), '<gazebo reference="a"><gravity>false</gravity></gazebo>'), TURN, []
    ),
    "urdf drives": (
        arm(
            P(),
            *frame("f"),
            '<transmission name="t"><joint name="q"/><type>x</type></transmission>',
            '<transmission name="u"><joint name="none"/></transmission>',
        ),
        TURN + WEIGHT,
        ["Drives of joints that are fixed or not in the file: q, none.",
         "Not read of transmission: type (t)."],
    ),
    "urdf follows none": (
        arm(P(more='<mimic joint="none" offset="1"/>')),
        TURN + WEIGHT,
        ["Joint 'p' follows 'none', which is no joint of the file: it is free."],
    ),
    "urdf lump": (
        arm(P(), link("f", 0.5, "0.1 0 0", "0 0 0"), joint("q", "a", "f", kind="fixed")),
        TURN + 1.5 * WEIGHT + 0.5 * 0.1**2,
        ["body 'f' has no inertia: its mass is a lump at its centre."],
    ),
    "urdf frame at the end": (
        arm(P(), *frame("tool")), TURN + WEIGHT, ["Frames without mass are left out: tool."]
    ),
    "urdf blanks": (
        arm(P()).replace('rpy="0 0 0"', 'rpy=""').replace('xyz="0 0 0"', 'xyz=" "').replace(
            'ixy="0"', 'ixy=""'), TURN + WEIGHT, []
    ),
    "urdf ground": (arm(P()).replace('"a"', '"ground"'), TURN + WEIGHT, ["ground in the file"]),
    "urdf letters": (
        arm(P(), link("手", 1, "0 0 0", "0 0 0"), joint("左", "a", "手", kind="fixed")),
        TURN + WEIGHT, ["手 in the file"],
    ),
    **{
        f"urdf rounded {excess}": (
            urdf(BASE, link("a", inertia=f"0.005 {0.01 * (1 + excess)!r} 0.005"), P()),
            0.01 * (1 + excess) + 0.01 + WEIGHT, ["which is taken as rounding"],
        ) for excess in (1e-11, 1e-7, 9e-4)
    },
    "sdf": (sdf_arm(), TURN + SDF_WEIGHT, []),
    "sdf no gravity": (sdf_arm("<gravity>false</gravity>"), TURN, []),
    "sdf gravity": (sdf_arm(before="<gravity>0 0 -1.96</gravity>"), TURN + SDF_WEIGHT / 5, []),
    "sdf physics": (sdf_arm(before="<physics><gravity>0 0 0</gravity></physics>"), TURN, []),
    "sdf dynamics": (
        sdf_arm(dynamics=DRAGGED),
        TURN + SDF_WEIGHT + 2.0 * 0.4 + 5.0 * (0.3 - 0.1),
        ["Not read of world/model/joint/axis/dynamics: friction (p)."],
    ),
    "sdf slide": (
        sdf_arm(dynamics=DRAGGED, kind="prismatic"), 1.0 + 2.0 * 0.4 + 5.0 * (0.3 - 0.1), []
    ),
    "sdf static": (
        sdf_arm(before='<model name="ground_plane"><static>true</static></model>'),
        TURN + SDF_WEIGHT, ["Not read of world: model (ground_plane)."],
    ),
    "sdf 1.4": (sdf_arm(version="1.4"), 0.1, []),  # its axis is on the frame of the model
    "sdf blank moment": (
        sdf_arm(held=inertial(1.0, inertia="1 5 1").replace("<iyy>5</iyy>", "<iyy> </iyy>")),
        1.01 + SDF_WEIGHT, ["Not given, so as the format says: iyy 1 (a)."],
    ),
    "sdf no mass": (
        sdf_arm(held=""), 1.0, ["Not given, so as the format says: mass 1, ixx 1, iyy 1, izz 1"]
    ),
    "sdf follows none": (
        sdf_arm(dynamics="<mimic joint='K'/>"), TURN + SDF_WEIGHT,
        ["Joint 'p' follows 'K', which is no joint of the file: it is free."],
    ),
    "sdf stands on nothing": (
        sdf_arm().replace("<parent>world", "<parent>base").replace(
            '<link name="a">', sdf_link("base") + '<link name="a">'),
        TURN + SDF_WEIGHT, ["No joint leads to the world: 'base' is fixed."],
    ),
    "xml": (mjcf(MJCF_PLAIN), AT_REST, []),
    "xml weld": (mjcf(HELD, more=WELD.format("")), AT_REST - 2 * 9.81, []),
    "xml weld pose": (  # the anchor, at (-0.5, 0.1, 0.2) of b, is at (1, 0, 0) of a
        mjcf(HELD, more=WELD.format('relpose="1 0 0 1 0 0 0"')), AT_REST - 2 * 9.81 * 1.5, []
    ),
    "xml weld without torque": (
        mjcf(SLIDING, more=WELD.format('torquescale="0" active="false"')), AT_REST, []
    ),
    "xml no gravity": (
        mjcf(MJCF_PLAIN, more='<option><flag gravity="disable"/></option>'), 0.0, []
    ),
    "xml half of the weight": (mjcf(MJCF_ARM.format('gravcomp="0.5"', "")), AT_REST / 2, []),
    "xml weight that nothing bears": (
        mjcf(MJCF_ARM.format('gravcomp="1"', ""),
             more='<option><flag spring="disable" damper="disable"/></option>'), AT_REST, [],
    ),
    "xml spring": (
        mjcf(MJCF_ARM.format("", 'stiffness="3" springref="0.2" ref="0.5"')),
        AT_REST + 3 * 0.3, [],
    ),
    "xml no equalities": (
        mjcf(SLIDING, more=WELD.format("") + '<option><flag equality="disable"/></option>'),
        AT_REST, [],
    ),
    "xml not read": (
        mjcf(MJCF_ARM.format("", 'frictionloss="1" armature="0.1" range="-1 1"'),
             '<body mocap="true"/>',
             more='<option density="1000"/><actuator><motor joint="p"/></actuator>'),
        AT_REST,
        [f"{words}: not read." for words in (
            "Friction of joints", "Armature, the inertia of motors at joints", "Limits of joints",
            "Actuators, except which joints they drive", "Motion of mocap bodies",
            "Forces of a medium (density, viscosity, wind)")],
    ),
    "json": (
        own([{"name": "a", "mass": 3.0, "rod": [[0, 0, 0], [0.5, 0, 0]]}],
            [own_joint("p", "ground", "a")], gravity=[0, -9.81, 0]),
        3.0 * 0.25 / 3 + 3.0 * 9.81 * 0.25 * np.cos(0.3),
        ["The file gives no motion of p: here it rests."],
    ),
}  # fmt: skip
"""Texts of files, efforts by hand, and what notes say; MuJoCo's at rest."""


@pytest.mark.parametrize("what", READ)
def test_what_a_file_says_of_an_arm_is_read_or_noted(what, file):
    told, effort, notes = READ[what]
    path = file(what.split()[0], told)
    text, at = case_of(path), {"t": (0.0, 0.0, 1)}
    (case := path.with_suffix(".py")).write_text(text)
    scene = load_case(case).scene  # as read() of the path, without a second process for MuJoCo
    moving = scene if path.suffix == ".xml" else Scene(scene.mechanism, MOVE, **at)
    solution = evaluate(moving, **at)
    assert solution.certified
    assert solution.effort("p")[0] == pytest.approx(effort, rel=1e-12, abs=1e-10)
    words = " ".join(text.replace("\n#  ", "").split())
    assert [note for note in notes if note not in words] == []


@pytest.fixture(scope="module")
def four_bar_efforts():
    """By hand: the coupler rises from the crank's tip, at (0.2, 0), to (0.5, 0.4)."""
    m = Mechanism("by_hand")
    crank = m.link("crank", length=0.2, mass=0.5, centre=(0.1, 0), inertia=0.01)
    coupler = m.link("coupler", length=0.5, mass=0.8, centre=(0.25, 0), inertia=0.01)
    rocker = m.link("rocker", length=0.4, mass=0.7, centre=(0.2, 0), inertia=0.01)
    m.revolute("O", m.ground, crank)
    m.revolute("A", crank.tip, coupler)
    m.revolute("C", m.ground.at(0.5, 0), rocker)
    m.revolute("B", coupler.tip, rocker.tip)
    m.set_gravity(0.0, 0.0)
    posture = {"rocker": "90 deg", "coupler": "53 deg"}
    return efforts(Scene(m, SWING, t=(0.0, 1.0, 9), posture=posture), 9)


SWING = {"O": harmonic(0.0, 0.3, 0.5)}


MOMENTS = "0.001 0.01 0.01"


TREE = (
    BASE,
    link("crank", 0.5, "0.1 0 0", MOMENTS),
    link("coupler", 0.8, "0.25 0 0", MOMENTS),
    link("rocker", 0.7, "0 0.2 0", "0.01 0.001 0.01"),
    joint("O", "base", "crank"),
    joint("C", "base", "rocker", "0.5 0 0"),
)


OPEN = joint("A", "crank", "coupler", "0.2 0 0")


CLOSED = joint("A", "crank", "coupler", "0.2 0 0", rpy="0 0 0.9272952180016122")
"""The coupler lies along x and misses the rocker's tip in the zero posture, or does not."""


SDF_LINKS = (
    sdf_link("crank", mass=0.5, inertia=MOMENTS),
    sdf_link("coupler", "0 0 0 0 0 0.9272952180016122", ' relative_to="pin"', mass=0.8,
             inertia=MOMENTS, centre="0.25 0 0 0 0 0"),
    '<frame name="pin" attached_to="crank"><pose>0.2 0 0 0 0 0</pose></frame>',
    sdf_link("rocker", "0.5 0 0 0 0 90", ' degrees="true"', mass=0.7,
             inertia=MOMENTS, centre="0.2 0 0 0 0 0"),
    *(sdf_joint(*ends) for ends in (("O", "world", "crank"), ("A", "pin", "coupler"),
                                    ("C", "world", "rocker"))),
    sdf_joint("B", "coupler", "rocker").replace("<xyz", '<xyz expressed_in="__model__"').replace(
        "<parent", "<pose>0.4 0 0 0 0 0</pose><parent"),
    "<pose>3 2 1 0 0 0</pose>",
)  # fmt: skip


MJCF_BAR = """<body name="{}" pos="{} 0 0" euler="0 0 {}">
<inertial pos="{} 0 0" mass="{}" diaginertia="0.001 0.01 0.01"/><joint name="{}" axis="0 0 1"/>"""


MJCF_LINKS = (
    MJCF_BAR.format("crank", 0, 0, 0.1, 0.5, "O"),
    MJCF_BAR.format("coupler", 0.2, 0.9272952180016122, 0.25, 0.8, "A") + "</body></body>",
    MJCF_BAR.format("rocker", 0.5, 1.5707963267948966, 0.2, 0.7, "C") + "</body>",
)


LOOPS = {
    "urdf constraint of urdfdom": urdf(
        *TREE, OPEN,
        '<constraint name="B" type="revolute"><parent link="coupler"/>'
        '<parent_origin xyz="0.5 0 0"/><parent_axis xyz="0 0 1"/><child link="rocker"/>'
        '<child_origin xyz="0 0.4 0"/><child_axis xyz="0 0 1"/></constraint>',
    ),
    "urdf loop of URDF+": urdf(
        *TREE, OPEN,
        '<loop name="B" type="continuous"><predecessor link="coupler"><origin xyz="0.5 0 0"/>'
        '</predecessor><successor link="rocker"><origin xyz="0 0.4 0"/></successor>'
        '<axis xyz="0 0 1"/></loop>',
    ),
    "urdf loop joint of Isaac Sim": urdf(
        *TREE, OPEN,
        '<loop_joint name="B" type="spherical"><link1 link="coupler" xyz="0.5 0 0"/>'
        '<link1 link="rocker" xyz="0 0.4 0" rpy="0 0 0"/></loop_joint>',
    ),
    "urdf loop joint with an axis": urdf(
        *TREE, OPEN,
        '<loop_joint name="B" type="revolute"><parent link="coupler"/><child link="rocker"/>'
        '<parent_origin xyz="0.5 0 0"/><child_origin xyz="0 0.4 0"/>'
        '<axis xyz="0 0 1" frame="parent"/></loop_joint>',
    ),
    "urdf ball constraint of Drake": urdf(
        *TREE, OPEN,
        '<drake:ball_constraint><drake:ball_constraint_body_A name="coupler"/>'
        '<drake:ball_constraint_body_B name="rocker"/>'
        '<drake:ball_constraint_p_AP value="0.5 0 0"/>'
        '<drake:ball_constraint_p_BQ value="0 0.4 0"/></drake:ball_constraint>',
    ),
    "urdf joint of Gazebo": urdf(
        *TREE, CLOSED,
        f"<gazebo>{sdf_joint('B', 'coupler', 'rocker')}</gazebo>".replace(
            "<parent", "<pose>0 0.4 0 0 0 0</pose><parent"),
    ),
    "sdf": sdf(*SDF_LINKS, world="<gravity>0 0 0</gravity>"),
    "xml connect": mjcf(
        *MJCF_LINKS,
        more='<equality><connect name="B" body1="coupler" body2="rocker" anchor="0.5 0 0"/>'
             "</equality>",
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", LOOPS)
def test_a_loop_of_every_dialect_is_the_loop_by_hand(what, file, four_bar_efforts):
    """If the loop is open in the zero posture, a motion near zero needs a rough posture."""
    scene = read(file(what.split()[0], LOOPS[what]))
    posture = {"A": 0.9, "C": 0.1} if OPEN in LOOPS[what] else {"A": 0.0, "C": 0.0}
    found = efforts(scene, 9, SWING, t=(0.0, 1.0, 9), posture=posture)
    assert_same(found, four_bar_efforts)


def numbers(chance):
    return " ".join(map(repr, chance.uniform(-1, 1, 3).tolist()))


def drawn_tree(seed):
    """A random tree as URDF and as SDF, its laws, and its dampers: frames between links, and in
    every other tree bodies without weight.
    """
    chance, parts, told, laws, dampers = np.random.default_rng(seed), [BASE], [], {}, {}
    for k in range(int(chance.integers(2, 7))):
        sizes, mass, damping = chance.uniform(0.01, 0.1, 3), *chance.uniform(0.1, 3, 2).tolist()
        moments, centre, turn = (sizes.sum() - sizes).tolist(), numbers(chance), numbers(chance)
        above = f"l{int(chance.integers(k))}" if k else "base"
        at = [numbers(chance) for _ in range(4)]
        axis, off = numbers(chance), bool(seed % 2 and chance.integers(2))
        kind = ("revolute", "prismatic")[int(chance.integers(2))]
        held = link(f"l{k}", repr(mass), centre, " ".join(map(repr, moments)))
        parts += [
            held.replace(f'xyz="{centre}"', f'xyz="{centre}" rpy="{turn}"'),
            f'<link name="f{k}"/>',
            joint(f"fixed{k}", above, f"f{k}", at[0], kind="fixed", rpy=at[1]),
            joint(f"j{k}", f"f{k}", f"l{k}", at[2], axis, kind, rpy=at[3],
                  more=f'<dynamics damping="{damping!r}"/><limit effort="1" velocity="1"/>'),
            f'<gazebo reference="l{k}"><gravity>{int(not off)}</gravity></gazebo>',
        ]  # fmt: skip
        world = "world" if above == "base" else above
        told += [
            f'<frame name="f{k}" attached_to="{world}"><pose>{at[0]} {at[1]}</pose></frame>',
            sdf_link(f"l{k}", f"{at[2]} {at[3]}", f' relative_to="f{k}"', mass=repr(mass),
                     centre=f"{centre} {turn}", inertia=" ".join(map(repr, moments)),
                     inside=f"<gravity>{str(not off).lower()}</gravity>"),
            sdf_joint(f"j{k}", f"f{k}", f"l{k}", axis, kind, dynamics(damping=repr(damping))),
        ]  # fmt: skip
        laws[f"j{k}"], dampers[f"j{k}"] = chance.uniform(0.2, 1.0, 4).tolist(), damping
    return urdf(*parts), sdf(*told, world="<gravity>0 0 -9.81</gravity>"), laws, dampers


@pytest.mark.parametrize("seed", range(6))
def test_a_tree_is_the_same_as_urdf_as_sdf_and_in_pinocchio(seed, file):
    text, told, laws, dampers = drawn_tree(seed)
    motion = {name: harmonic(*law) for name, law in laws.items()}
    one, other = (read(file(*each)).mechanism for each in (("urdf", text), ("sdf", told)))
    solution = evaluate(Scene(one, motion, t=(0.0, 1.0, 5), wanted=["motion", "effort"]))
    found = np.array([solution.effort(name) for name in laws])
    there = evaluate(Scene(other, motion, t=(0.0, 1.0, 5), wanted=["effort"]))
    assert_same(np.array([there.effort(name) for name in laws]), found)
    pinocchio = pytest.importorskip("pinocchio", reason="Pinocchio is not installed")
    model = pinocchio.buildModelFromXML(text)
    data, places = model.createData(), [model.joints[model.getJointId(name)].idx_v for name in laws]
    if seed % 2 == 0:
        for k in range(solution.t.size):
            q, v, a = np.zeros((3, model.nv))
            for name, at in zip(laws, places, strict=True):
                moved = solution.motion(name)
                q[at], v[at], a[at] = moved.value[k], moved.rate[k], moved.acceleration[k]
            expected = pinocchio.rnea(model, data, q, v, a)
            expected = expected[places] + np.array(list(dampers.values())) * v[places]
            assert np.abs(found[:, k] - expected).max() < 1e-10 * np.abs(found).max()


MIMIC = '<mimic joint="one" multiplier="{}" offset="{}"/>'


SHAFTS = [sdf_link(name, centre="0 0 0 0 0 0", inertia="0.1 0.1 0.1") for name in "abc"]


FOLLOWING = {
    "urdf mimic": (
        urdf(BASE, link("a"), link("b"), joint("one", "base", "a", axis="0 1 0"),
             joint("two", "base", "b", "0.5 0 0", "0 1 0", more=MIMIC.format(-2, 0.1))),
        {"two": (0.1, -2.0)},
    ),
    "urdf coupling": (
        urdf(BASE, link("a"), link("b"), joint("one", "base", "a"), joint("two", "base", "b"),
             '<coupling name="belt"><predecessor link="a"/><successor link="b"/>'
             '<ratio value="-2"/></coupling>'), {"two": (0.0, -2.0)},
    ),
    "sdf gearbox": (
        sdf(*SHAFTS, sdf_joint("one", "world", "a"), sdf_joint("two", "world", "b"),
            sdf_joint("three", "world", "c",
                      more="<mimic joint='two'><multiplier>3</multiplier></mimic>"),
            sdf_joint("box", "a", "b", "", "gearbox", "<gearbox_ratio>2</gearbox_ratio>"
                      "<gearbox_reference_body>world</gearbox_reference_body>")),
        {"two": (0.0, -2.0), "three": (0.0, -6.0)},
    ),
    "xml references": (  # MuJoCo couples q - ref: two = 0.2 - 2 one
        mjcf(MJCF_ARM.format("", 'ref="0.4"').replace('"p"', '"one"'),
             MJCF_ARM.format("", 'ref="-3.5"').replace('"p"', '"two"').replace('"a"', '"b"'),
             more='<equality><joint joint1="two" joint2="one" polycoef="0.2 -2 0 0 0"/>'
                  "</equality>"), {"two": (0.2, -2.0)},
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", FOLLOWING)
def test_joints_that_follow(what, file):
    told, followers = FOLLOWING[what]
    scene = read(file(what.split()[0], told))
    solution = evaluate(Scene(scene.mechanism, {"one": harmonic(0.3, 0.5, 1)}, t=(0.0, 1.0, 5)))
    for name, (offset, ratio) in followers.items():
        one, other = solution.motion("one"), solution.motion(name)
        assert np.allclose(other.value, offset + ratio * one.value, rtol=0, atol=1e-12)
        assert np.allclose(other.rate, ratio * one.rate, rtol=0, atol=1e-12)


def test_a_joint_that_follows_a_fixed_one_is_held(file):
    """At its offset, whatever the ratio; the fixed one is a frame, or has a mass."""
    for flange in (frame("f"), (link("f"), joint("q", "a", "f", kind="fixed"))):
        follower = joint("r", "f", "b", more=MIMIC.format(2, 0.2).replace("one", "q"))
        path = file("urdf", arm(P(), *flange, link("b"), follower))
        assert "# Joint 'r' follows 'q', which is fixed: it is held at 0.2." in case_of(path)
        assert evaluate(read(path), t=(0.0, 0.0, 1)).motion("r").value[0] == 0.2


def test_joints_of_several_freedoms_and_a_screw(file):
    """A universal joint on a nut, which a screw moves by its lead."""
    across = "<axis2><xyz>0 1 0</xyz></axis2></joint>"
    pitch = "<screw_thread_pitch>0.01</screw_thread_pitch></joint>"
    cardan = sdf_joint("cardan", "a", "b", "1 0 0", "universal").replace("</joint>", across)
    screw = sdf_joint("screw", "world", "a", kind="screw").replace("</joint>", pitch)
    path = file("sdf", sdf(*SHAFTS[:2], screw, cardan, world="<gravity>0 0 -9.81</gravity>"))
    laws = {name: harmonic(0.1, 0.2, 1.0) for name in ("screw", "cardan:turn_1", "cardan:turn_2")}
    m = SpatialMechanism("by_hand")
    told = {"length": 0.1, "mass": 1.5, "centre": (0, 0, 0), "inertia": (0.1, 0.1, 0.1)}
    nut, yoke = m.link("nut", **told), m.link("yoke", **told)
    m.screw("screw", m.ground, nut, axis=(0, 0, 1), lead=0.01)
    m.universal("cardan", nut, yoke, axis=(1, 0, 0), second=(0, 1, 0))
    expected = efforts(Scene(m, laws, t=(0.0, 1.0, 5)))
    assert_same(efforts(read(path), laws=laws, t=(0.0, 1.0, 5)), expected)


SLENDER = (1e-4, 0.02, 0.02)


ORIGIN = (0.0, 0.0, 0.0)


OUT = turned("y", 90)  # z of a marker is along x


DRIVE = {"drive": ("RotationalMotion", "O", "2.0d*pi*time")}


def solved(file, *told, count=None, **more):
    scene = read(file("asmt", assembly(*told, **more)))
    return evaluate(scene) if count is None else evaluate(scene, t=(*scene.span, count))


FOUR_BAR = (
    {"Marker1": (2.0, 0.0, 0.0), "Marker2": (0.0, 0.0, 0.0)},
    {
        "Part1": (
            *(0.2, (0.5, 0.1, 0.05), (8.3333333333333e-4, 0.016833333333333, 0.017333333333333)),
            *({"Marker1": (0.1, 0.1, 0.1), "Marker2": (0.9, 0.1, 0.1)}, (-0.1, -0.1, -0.1)),
        ),
        "Part2": (
            *(0.4, (1.0, 0.1, 0.05), (0.0016666666666667, 0.13366666666667, 0.13466666666667)),
            {"Marker1": (0.1, 0.1, 0.0), "Marker2": (1.9, 0.1, 0.0)},
            (0.80296435866847, -0.1413902845944, -4.8572257327351e-17),
            (
                (0.69212962962963, -0.72177321631434, -4.0768415228988e-17),
                (0.72177321631434, 0.69212962962963, 3.7688895158774e-17),
                (1.0141930549436e-18, -5.5511151231258e-17, 1.0),
            ),
        ),
        "Part3": (
            *(0.3, (0.75, 0.1, 0.05), (0.00125, 0.0565, 0.05725)),
            {"Marker1": (0.1, 0.1, 0.1), "Marker2": (1.4, 0.1, 0.1)},
            (1.9494211444078, 1.4026552603427, -0.1),
            (
                (-0.035256410256409, 0.99937829951217, -4.2098016992882e-17),
                (-0.99937829951217, -0.035256410256409, -3.0814879110196e-33),
                (-1.4842249580823e-18, 4.2071844635181e-17, 1.0),
            ),
        ),
    },
    {
        "O": ("RevoluteJoint", "Marker2", "Part1/Marker1"),
        "A": ("RevoluteJoint", "Part1/Marker2", "Part2/Marker1"),
        "B": ("RevoluteJoint", "Part2/Marker2", "Part3/Marker1"),
        "C": ("RevoluteJoint", "Part3/Marker2", "Marker1"),
    },
    DRIVE,
)


RACK = (
    {
        "Shaft": ((3.0, 0.0, 0.0), OUT),
        "Pinion": (0.0, 0.0, 0.0),
        "Guide": ((-1.7712954438145, 0.34642512144607, 0.0), ((0, 0, 1), (1, 0, 0), (0, 1, 0))),
    },
    {
        "Screw": (
            *(
                0.0,
                (0.5, 0.0, 0.0),
                (0.0, 0.0, 0.0),
                {"M": ((1.0, 0.0, 0.0), OUT)},
                (2.0, 0.0, 0.0),
            ),
            (
                (1.0, 0.0, 0.0),
                (0.0, -0.95970564352992, -0.28100725573698),
                (0.0, 0.28100725573698, -0.95970564352992),
            ),
        ),
        "Wheel": (
            *(0.3233675003485, (0.0125, 0.0, 0.05)),
            (0.0085917337014084, 0.0085917337014084, 0.016644521568903),
            {"M": (0.0125, 0.0, 0.1)},
            (-0.0125, 0.0, -0.1),
        ),
        "Rack": (
            *(0.68670431609232, (0.052542245884331, 0.71533562625128, 0.05)),
            (0.0036566034220765, 0.50124388724643, 0.50375598347502),
            {
                "Pitch": (-1.01384629393851, 0.68184995977736, 0.1),
                "Guide": (
                    (-1.426403464485, 0.59925558503043, 0.1),
                    ((0, 0, 1), (1, 0, 0), (0, 1, 0)),
                ),
                "Nut": (
                    (1.5314879562537, 0.83141566747213, 0.0),
                    ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (-1.0, 0.0, 0.0)),
                ),
            },
            (1.0138462939386, -0.25283046358436, -0.1),
        ),
    },
    {
        "O": ("RevoluteJoint", "Pinion", "Wheel/M"),
        "screw": ("ScrewJoint", "Rack/Nut", "Screw/M", ("pitch", 1.0)),
        "teeth": ("RackPinionJoint", "Rack/Pitch", "Wheel/M", ("pitchRadius", -0.3)),
        "shaft": ("RevoluteJoint", "Shaft", "Screw/M"),
        "guide": ("TranslationalJoint", "Guide", "Rack/Guide"),
    },
    DRIVE,
)


def wheels(law, joint, *, gravity=(0.0, 0.0, 0.0)):
    """Two wheels on parallel shafts 0.3 m apart."""
    parts = {
        "one": (2.0, (0.0, 0.0, 0.0), (0.01, 0.01, 0.02), {"M": (0.0, 0.0, 0.0)}),
        "two": (3.0, (0.0, 0.0, 0.0), (0.03, 0.03, 0.05), {"M": (0.0, 0.0, 0.0)}, (0.3, 0.0, 0.0)),
    }
    joints = {
        "O": ("RevoluteJoint", "A", "one/M"),
        "Q": ("RevoluteJoint", "B", "two/M"),
        "tie": joint,
    }
    motions = {"drive": ("RotationalMotion", "O", law)}
    return {"A": (0.0, 0.0, 0.0), "B": (0.3, 0.0, 0.0)}, parts, joints, motions, gravity


def shafts(kind, *more):
    """Two shafts whose axes meet at 30 degrees."""
    tilt, parts = turned("y", 30), {}
    for name, rows, moment in (("one", IDENTITY, 0.02), ("two", tilt, 0.05)):
        # Markers whose z is across the shaft; of the second at right angles to that of the first.
        across = turned("y", 90) if name == "one" else turned("x", -90)
        marks = {"M": (0.0, 0.0, 0.0), "Across": ((0.0, 0.0, 0.0), across)}
        parts[name] = (1.0, (0.0, 0.0, 0.0), (0.04, 0.04, moment), marks, (0.0, 0.0, 0.0), rows)
    mark = "M" if kind == "ConstantVelocityJoint" else "Across"
    joints = {
        "O": ("RevoluteJoint", "A", "one/M"),
        "Q": ("RevoluteJoint", "B", "two/M"),
        "tie": (kind, f"one/{mark}", f"two/{mark}", *more),
    }
    points = {"A": (0.0, 0.0, 0.0), "B": ((0.0, 0.0, 0.0), tilt)}
    return points, parts, joints, {"drive": ("RotationalMotion", "O", "2*time")}, (0.0, 0.0, 0.0)


PENDULUM = (
    {"G": (0.0, 0.0, 0.0)},
    {
        "upper": (0.5, (0.1, 0.0, 0.0), SLENDER, {"O": (0.0, 0.0, 0.0), "A": (0.2, 0.0, 0.0)}),
        "lower": (0.8, (0.2, 0.0, 0.0), SLENDER, {"A": (0.0, 0.0, 0.0)}, (0.2, 0.0, 0.0)),
    },
    {"O": ("RevoluteJoint", "G", "upper/O"), "A": ("RevoluteJoint", "upper/A", "lower/A")},
    {"one": ("RotationalMotion", "O", "2*time"), "two": ("RotationalMotion", "A", "time^2")},
)


def test_forces_are_those_that_ondselsolver_wrote(file):
    """Its testapp/fourbar.asmt and rackscrew.asmt, series of FXonI, FYonI, TZonI and others."""
    solution, at = solved(file, *FOUR_BAR), [10, 37, 80]
    told = {
        "A": (23.558520471336, -8.8478827575929, -4.0487681140884),
        "C": (15.045678148917, -0.14392927908564, 1.0705274917106),
        "drive": (-6.1615311736962, 5.3660632828109, -7.1272231426398),
    }
    assert np.allclose(-solution.reaction("A").fx[at], told["A"], rtol=0, atol=1e-9)
    assert np.allclose(-solution.reaction("C").fy[at], told["C"], rtol=0, atol=1e-9)
    assert np.allclose(-solution.effort("O")[at], told["drive"], rtol=0, atol=1e-9)
    solution = solved(file, *RACK, count=11)  # nothing accelerates
    assert np.allclose(solution.reaction("O").fy, 3.1722351784188, rtol=1e-11)
    assert np.allclose(solution.reaction("guide").fy, 6.7365693408657, rtol=1e-11)
    assert np.allclose(solution.reaction("guide").mx, 0.33682846704328, rtol=1e-11)
    assert np.abs(solution.effort("O")).max() < 1e-10


GEAR = ("GearJoint", "one/M", "two/M", ("radiusI", 0.1), ("radiusJ", 0.2))


def test_gears_press_on_their_bearings(file):
    """alpha2 = -alpha1 / 2, the torque on the second wheel is a force at radius r2."""
    solution = solved(file, *wheels("3.0d*time*time", GEAR), count=11)
    assert np.allclose(solution.effort("O"), 6.0 * (0.02 + 0.05 / 4), rtol=1e-12)
    tooth = 0.05 * 3.0 / 0.2
    assert np.allclose(solution.reaction("Q").fy, -tooth, rtol=1e-12)
    assert np.allclose(solution.reaction("O").fy, tooth, rtol=1e-12)


def test_shafts_whose_axes_meet(file):
    """Axes that stay at right angles are Hooke's joint: tan(second) = tan(first) / cos(30 deg) or
    its like, and all power goes into the second shaft.
    """
    solution = solved(file, *shafts("PerpendicularJoint"), count=41)
    sides = (np.cos(2 * solution.t) ** 2, np.sin(2 * solution.t) ** 2)
    rates = [2.0 * np.cos(np.pi / 6) / (1 - np.sin(np.pi / 6) ** 2 * side) for side in sides]
    found = np.abs(solution.motion("Q").rate)
    assert min(np.abs(found - rate).max() for rate in rates) < 1e-12
    power = 0.05 * solution.motion("Q").rate * solution.motion("Q").acceleration
    assert np.allclose(2.0 * solution.effort("O"), power, rtol=1e-10, atol=1e-12)
    steady = solved(file, *shafts("ConstantVelocityJoint"), count=11)
    assert np.allclose(np.abs(steady.motion("Q").rate), 2.0, rtol=1e-12)
    assert np.abs(steady.effort("O")).max() < 1e-12


def test_a_general_motion(file):
    """Of the mass's marker: the force is mass times acceleration, less the weight."""
    part = (2.0, (0.1, 0.2, 0.3), (0.01, 0.02, 0.03), {})
    place = ("0.1 + 0.2*sin(3*time)", "0.2", '"a line"<n>0.3 +<n>time^2')
    motion = ("GeneralMotion", "G", "box/MassMarker", place, ("0", "0", "0.5*time^2"))
    solution = solved(file, {"G": ORIGIN}, {"box": part}, {}, {"fly": motion}, count=7)
    along = -2.0 * 1.8 * np.sin(3 * solution.t)
    for name, force in (("slide_1", along), ("slide_2", 19.62), ("slide_3", 4.0), ("turn_3", 0.03)):
        assert np.allclose(solution.effort(f"fly:{name}"), force, rtol=1e-12, atol=1e-12)


def pendulum(mark=ORIGIN, where=((0.2, 0.0, 0.0),), joints=None, motions=None):
    """The pendulum, its lower part with another marker, at another place, or on other joints."""
    points, parts, own_joints, own_motions = PENDULUM
    lower = (*parts["lower"][:3], {"A": mark}, *where)
    joints = {"O": own_joints["O"]} | (joints or {"A": own_joints["A"]})
    return points, parts | {"lower": lower}, joints, motions or own_motions


CRANK = (0.5, (0.1, 0.0, 0.0), SLENDER, {"O": ORIGIN, "A": (0.2, 0.0, 0.0)})


ROCKER = (0.8, (0.0, 0.2, 0.0), SLENDER, {"Q": ORIGIN, "B": (0.0, 0.5, 0.1)}, (0.6, 0.0, 0.0))


BLOCK = (2.0, ORIGIN, (0.01, 0.01, 0.01), {"M": ORIGIN, "G": (ORIGIN, OUT)}, (0.7, 0.1, 0.0))


FOURFOLD = {"drive": ("RotationalMotion", "O", "4*time")}


def linked(ties, parts):
    """A crank, a rocker, and what is between the two."""
    joints = {"O": ("RevoluteJoint", "P", "crank/O"), "Q": ("RevoluteJoint", "R", "rocker/Q")}
    points = {"P": ORIGIN, "R": (0.6, 0.0, 0.0)}
    return points, {"crank": CRANK, "rocker": ROCKER} | parts, joints | ties, FOURFOLD


def guided(ties):
    """A crank moves a block by a distance; ties keep the block on a line."""
    points = {"P": ORIGIN, "G": ((0.0, 0.1, 0.0), OUT), "H": (0.0, 0.1, 0.0)}
    points |= {"Up": (ORIGIN, turned("x", -90))}
    rod = ("SphSphJoint", "crank/A", "block/M", ("distanceIJ", float(np.hypot(0.5, 0.1))))
    joints = {"O": ("RevoluteJoint", "P", "crank/O"), "rod": rod} | ties
    parts = {"crank": CRANK, "block": BLOCK}
    return points, parts, joints, FOURFOLD, (0.0, -9.81, 0.0), (0.0, 0.3, 0.1)


def scattered():
    """The four-bar whose parts all lie elsewhere, turned."""
    points, parts, joints, motions = FOUR_BAR
    away = {"Part1": (0.02, -0.03, 0.05), "Part2": (0.1, 0.2, -0.1), "Part3": (-0.1, 0.1, 0.2)}
    moved = {}
    for name, part in parts.items():
        *told, place, rows = (*part, IDENTITY)[:6]
        turn = np.array(turned("x", 5)) @ np.array(rows)
        place = tuple((np.array(place) + away[name]).tolist())
        moved[name] = (*told, place, tuple(map(tuple, turn.tolist())))
    return points, moved, joints, motions


def off(last):
    """The four-bar whose ground is 1 cm off, its last joint with marker J there, or I."""
    points, parts, joints, motions = FOUR_BAR
    return points | {"Marker1": (2.01, 0.0, 0.0)}, parts, joints | {"C": last}, motions


SLIDES = {
    "joints": {"straight": ("TranslationalJoint", "upper/A", "lower/A")},
    "motions": PENDULUM[3] | {"two": ("TranslationalMotion", "straight", "0.1*time^2")},
}


BALL = {"A": ("SphericalJoint", "upper/A", "lower/A")}


ONE = {"one": PENDULUM[3]["one"]}


LONG = float(np.linalg.norm([0.4, 0.5, 0.1]))


ROD = (0.0, ORIGIN, ORIGIN, {"A": (0.2, 0.0, 0.0), "B": (0.6, 0.5, 0.1)})


ALIKE = {
    "a distance is a rod without mass on two balls": (
        linked({"rod": ("SphSphJoint", "crank/A", "rocker/B", ("distanceIJ", LONG))}, {}),
        linked({"A": ("SphericalJoint", "crank/A", "rod/A"),
                "B": ("SphericalJoint", "rod/B", "rocker/B")}, {"rod": ROD}),
    ),
    "a body on ties alone": (
        guided({"flat": ("PointInPlaneJoint", "H", "block/M"),
                "straight": ("NoRotationJoint", "H", "block/M"),
                "height": ("PointInPlaneJoint", "Up", "block/M", ("offset", 0.1))}),
        guided({"guide": ("TranslationalJoint", "G", "block/G")}),
    ),
    "axes of markers against each other": (pendulum((ORIGIN, turned("x", 180))), pendulum()),
    "a slide's axes turned": (pendulum((ORIGIN, turned("z", 180)), **SLIDES), pendulum(**SLIDES)),
    "a part whose joints are open": (pendulum(where=((0.5, 0.3, -0.2),)), pendulum()),
    "the same, tilted": (pendulum(where=((0.5, 0.3, -0.2), turned("x", 40))), pendulum()),
    "parallel axes are an angle of zero": (
        pendulum(joints=BALL | {"flat": ("AngleJoint", "G", "lower/A", ("theIzJz", 0.0))},
                 motions=ONE),
        pendulum(joints=BALL | {"flat": ("ParallelAxesJoint", "G", "lower/A")}, motions=ONE),
    ),
    "a loop that is open at the ground": (
        off(("RevoluteJoint", "Part3/Marker2", "Marker1")),
        off(("RevoluteJoint", "Marker1", "Part3/Marker2")),
    ),
    "a drawing far from assembled": (scattered(), FOUR_BAR),
}  # fmt: skip


@pytest.mark.parametrize("what", ALIKE)
def test_two_assemblies_have_the_same_efforts(what, file):
    found, expected = (solved(file, *told, count=5) for told in ALIKE[what])
    assert found.certified
    for name in (name for name in expected.names() if name.startswith("effort:")):
        assert_same(found.array(name), expected.array(name), 1e-9)


PLACED = (1.0, ORIGIN, (1.0, 1.0, 1.0), {"M": ORIGIN}, (58.0, 25.0, 23.0))


def changed(told, *replaced):
    """The text of an assembly, changed in some places."""
    text = assembly(*told)
    for old, new in replaced:
        assert old in text
        text = text.replace(old, new, 1)
    return text


ALLOW = "\t\tMotions\n\t\t\tAllowRotation\n\t\t\t\tName\n\t\t\t\t\tFree\n"


LONG_NAME = "wheel_with_a_name_that_does_not_fit_into_one_line_of_the_case_with_all_its_arguments"


NOTED = {
    "moved": (assembly(*pendulum(where=((0.5, 0.3, -0.2),))),
              r"# body 'lower' is moved so that joint 'A' is closed"),
    "scattered": (
        assembly(*scattered()),
        r"# joint '\w' is open by \d\.\d+ m and \S+ rad in the drawing: parts are",
    ),
    "no names": (
        changed(FOUR_BAR, ("\t\t\t\t\tA\n", "\t\t\t\t\t\n"), ("\t\t\t\t\tB\n", "\t\t\t\t\t\n")),
        r'"RevoluteJoint_\d+"',
    ),
    "no duration": (
        changed(FOUR_BAR, ("\t\t\t1.0\n\t\thout", "\t\t\t0.0\n\t\thout")), r"t=\(0.0, 1.0, 101\)"
    ),
    "allowed": (
        changed(FOUR_BAR, ("\t\tMotions\n", ALLOW)), r"# AllowRotation of line \d+ is ignored\."
    ),
    "a force": (
        changed(FOUR_BAR, ("\tForceTorques", "\tForceTorques\n\t\tForceTorqueInLine")),
        r"# ForceTorqueInLine of line \d+ is ignored\.",
    ),
    "rounded places": (
        changed(FOUR_BAR, ("2.0\t0.0\t0.0", "2.00000001\t0.0\t0.0")),
        r"joint 'C': its two frames differ by 1.0e-08 m",
    ),
    "rounded axes": (
        changed(FOUR_BAR, ("0.0\t1.0\t0.0", "0.0\t1.0\t5e-07")),
        r"off right angles by 2\.5e-07 \(at line \d+, RotationMatrix\) or less",
    ),
    "parallel in a drawing": (  # the cosine of an angle has no slope there
        assembly({"G": ORIGIN}, {"part": PLACED},
                 {"tie": ("AngleJoint", "G", "part/M", ("theIzJz", 0.1745))}, {}), "tie",
    ),
    "long names": (
        assembly(*wheels("3*time", GEAR)).replace("one", LONG_NAME), LONG_NAME
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", NOTED)
def test_what_is_not_as_in_a_drawing_is_said(what, file):
    told, words = NOTED[what]
    path = file("asmt", told)
    assert re.search(words, case_of(path).replace("\n#  ", ""))
    assert evaluate(read(path), t=(0.0, 1.0, 3)).certified


ROD_BODY = {"name": "arm", "mass": 2.0, "rod": [[0, 0, 0], [0.5, 0, 0]]}


HINGE = {"name": "hinge", "kind": "revolute", "parent": "ground", "child": "arm"}


ARM = {"schema": "lagrange_casadi.model", "version": 1, "bodies": [ROD_BODY], "joints": [HINGE]}


def knuckle():
    """Links that meet at a point mass, whose pins have no angle."""
    m = Mechanism("knuckle")
    lengths = {"crank": 0.1, "rod": 0.3, "rocker": 0.25}
    crank, rod, rocker = (m.link(name, length=l, mass=1.0) for name, l in lengths.items())
    pin = m.point_mass("pin", 0.4)
    m.revolute("O", m.ground, crank)
    m.revolute("A", crank.tip, rod)
    m.revolute("B", rod.tip, pin)
    m.revolute("C", rocker.tip, pin)
    m.revolute("D", m.ground.at(0.3, 0.0), rocker)
    return Scene(m, {"O": polynomial(0.3, 2.0)}, posture={"rod": 0.8, "rocker": 1.7})


def tumbling(kind):
    """A body that is turned about several axes at the start: turns have no difference."""
    m = SpatialMechanism("turned")
    told = {"mass": 2.0, "centre": (0.2, 0.01, 0.02), "inertia": (0.02, 0.03, 0.04)}
    axes = {"axis": (0, 0, 1), "second": (0, 1, 0)} if kind == "universal" else {}
    getattr(m, kind)("joint", m.ground, m.link("body", length=0.4, **told), **axes)
    laws = {
        name: harmonic(0.1 + 0.2 * k, 0.3, 0.7, 0.3 * k) for k, name in enumerate(m.coordinates)
    }
    return Scene(m, laws, t=(0.0, 1.0, 5))


def still():
    m = Mechanism("still")
    m.revolute("hinge", m.ground, m.link("arm", length=0.5, mass=2.0))
    return Scene(m, {"hinge": polynomial(0.3)}, t=(0.5, 0.5, 1))


SAVED = {
    name: partial(lambda name: load_case(name).scene, name)
    for name in ("arm6", "rrr3", "four_bar", "six_bar", "delta", "bricard")
}


SAVED |= {kind: partial(tumbling, kind) for kind in ("spherical", "free", "universal")}


SAVED |= {"knuckle": knuckle, "one instant": still}


@pytest.mark.parametrize("what", SAVED)
def test_a_scene_comes_back_from_its_file(what, tmp_path):
    """Trees, loops, guides and bars, in the plane and in space: none of these has a load."""
    scene = SAVED[what]()
    save_model(scene, tmp_path / "model.json")
    back = read(tmp_path / "model.json")
    count = scene.t[2] if what == "one instant" else 5
    assert (back.t[:2], back.t[2] == 1) == (scene.t[:2], what == "one instant")
    assert_same(efforts(back, count), efforts(scene, count), 1e-12)


@pytest.mark.parametrize("plane", ["four_bar", "slider_crank"])
def test_forces_in_the_plane_are_those_of_space(plane, tmp_path):
    """What a plane leaves out is open in space; what it has is the same."""
    scene = load_case(plane).scene
    save_model(scene, tmp_path / "model.json")
    scenes = (scene, read(tmp_path / "model.json"))
    one, other = (evaluate(each, t=(*scene.span, 5)) for each in scenes)
    for joint_name in one.description["joints"]:
        there, back = one.reaction(joint_name), other.reaction(joint_name)
        assert np.abs(back.fx - there.fx).max() < 1e-10 * max(np.abs(there.fx).max(), 1.0)
        assert np.abs(back.fy - there.fy).max() < 1e-10 * max(np.abs(there.fy).max(), 1.0)


def test_what_new_writes_gives_the_numbers_of_read(here, capfd):
    """Of a platform, whose pose has six motions and is turned about all axes at the start."""
    assert main(["export", "stewart_gough", "--model", "legs.json"]) == 0
    assert main(["new", "legs", "--from", "legs.json"]) == 0
    assert "Loads are not exported: tool, twist." in capfd.readouterr().out
    text = (here / "legs" / "case.py").read_text()
    assert 'mass_piston0 = m.parameter("mass_piston0", 0.7, "kg", low=0.0)' in text
    assert max(map(len, text.splitlines())) <= 100
    scene, there = load_case("legs").scene, load_case("stewart_gough").scene
    assert np.array_equal(efforts(scene), efforts(read("legs.json")))
    asked = {"t": (*there.span, 3), "wanted": ["motion"]}
    found, expected = (evaluate(one, **asked).motion("P3").rate for one in (scene, there))
    assert_same(found, expected, 1e-12)
    assert main(["new", "legs", "--from", "legs.json"]) == 2
    assert main(["new", "other", "--from", "legs.json", "--like", "arm"]) == 2
    assert main(["export", "arm6"]) == 2
    assert capfd.readouterr().err.splitlines() == [
        "error: legs exists: expected a new folder",
        "error: --like and --from exclude each other",
        "error: Missing option '--out' or '--model'.",
    ]


def test_shipped_cases_are_what_is_read_of_their_files():
    """The leg has motions beside; the press, declared by hand in the plane, a force too."""
    leg = load_case("parallel_leg").scene
    there = efforts(leg, laws=leg.motion, t=leg.t)
    found = efforts(read(CASES / "parallel_leg" / "leg.urdf"), laws=leg.motion, t=leg.t)
    assert_same(found, there, 1e-12)
    m = Mechanism("by_hand")
    crank = m.link("crank", length=0.04, mass=1.6, centre=(0.012, 0.0), inertia=1.6 / 12 * 0.0117)
    rod = m.link("rod", length=0.22, mass=0.9, centre=(0.1, 0.0), inertia=0.9 / 12 * 0.0585)
    ram = m.link("ram", length=0.1, mass=6.5, centre=(0.05, 0.0), inertia=0.01)
    m.revolute("O", m.ground, crank)
    m.revolute("A", crank.tip, rod)
    m.revolute("B", rod.tip, ram)
    m.prismatic("guide", m.ground, ram, axis=(0.0, -1.0), angle="-90 deg")
    m.force("work", ram.tip, y=900.0)
    asked = {"t": (0.0, 0.25, 11)}
    by_hand = Scene(m, {"O": polynomial(0.0, 8 * np.pi)}, posture={"rod": "-100 deg"}, **asked)
    found = evaluate(load_case("cad_press").scene, **asked).effort("Bearing")
    assert_same(found, evaluate(by_hand).effort("O"))
    told = evaluate(read(CASES / "cad_press" / "press.asmt"), **asked)
    work = 900.0 * told.motion("Guide").rate / (8 * np.pi)
    assert_same(found, told.effort("Bearing") - work)


def test_names_and_notes_of_a_file_are_no_code(file):
    end = '"""\nimport os\n# \u2028 \\'
    told = ARM | {"name": "a", "notes": [end], "bodies": [ROD_BODY | {"name": end}]}
    told |= {"joints": [HINGE | {"child": "b_" + re.sub(r"\W", "_", end.strip())}]}
    text = case_of(file("json", told))
    assert "\nimport os" not in text
    assert len(re.findall("import os", text)) == 2  # in comments
    read(file("json", told))


def own_arm(**change):
    return ARM | change


PLAIN = link("a")


POSED = '<frame name="{}"><pose relative_to="{}">0 0 0 0 0 0</pose></frame>'


BODY = '<body name="a"><joint name="j" axis="{} 1 0"/><inertial pos="0 0 0" mass="{}" '


BODY += 'diaginertia="{} 1 1"/></body>'


FAR_TERMS = {
    "many terms": "+".join(["sin(t)"] * 600),
    "many powers": "(((((((t+1)^3)^3)^3)^3)^3)^3)^3",
}


NO_LAWS = {
    "brackets": ("sin(" * 199 + "t" + ")" * 199, "100 pairs of parentheses"),
    "terms": ("t+" * 1100 + "t", "at most 1000 terms"),
    "signs": ("-" * 900 + "t", "100 pairs of parentheses"),
    "tower": ("9^9^9^9*t", "'9 ** 9 ** 9' is no number of at most 1e+12"),
    "large": ("1e12*1e12*t", "is no number of at most 1e+12"),
    "by zero": ("t/(2-2)", "'t / (2 - 2)' is no number"),
    "root": ("(-8)^(1/3)*t", "is no number"),
    "logarithm": ("log(0)*t", "is no number"),
    "exponential": ("exp(1000)", "is no number"),
    "code": ("__import__('os')", "'__import__('os')' is not supported; valid: numbers, pi, t"),
    **{
        told[:20]: (told, "motion of 'hinge'")
        for told in ("", "x", "t.real", "lambda: 1", "[t]", "sin", "sin(t, t)", "1e400 * t",
                     "9" * 400, "t" * 9, "-" * 20000 + "t", "t if t else 1", "'t'", "f(t)")
    },
}  # fmt: skip


IMPOSSIBLE = link("b", 1.0, "0.1 0 0", "0.001 0.002 0.02"), joint("q", "a", "b", kind="fixed")


IMPOSSIBLE += link("c", 1.0, "0.1 0 0", "-0.001 0.02 0.02"), joint("r", "a", "c", kind="fixed")


BAD_BODIES = (
    "body 'b' (0.001, 0.002, 0.02 kg m^2, of which the last is too large by 0.017)",
    "body 'c' (-0.001, 0.02, 0.02 kg m^2, of which -0.001 is negative)",
)


REFUSED = {
    "urdf no XML": ("<robot", "line 1: no XML"),
    "urdf document type": (
        '<!DOCTYPE robot [<!ENTITY a "b">]><robot name="&a;"/>',
        "line 1: document types and entities are refused",
    ),
    "urdf a billion laughs": (
        '<!DOCTYPE r [<!ENTITY e0 "ha">'
        + "".join(f'<!ENTITY e{k + 1} "{f"&e{k};" * 10}">' for k in range(20))
        + ']><robot name="&e20;"/>', "document types and entities are refused",
    ),
    "urdf another root": ("<sdf/>", "line 1, <sdf>: expected <robot>"),
    "urdf macros": (
        '<robot xmlns:xacro="x"><xacro:arm name="a"/></robot>',
        "line 1, <xacro:arm name='a'>: is a macro of xacro; expand it first: xacro model.urdf >",
    ),
    "urdf two roots": (urdf(BASE, PLAIN), "expected one root link, found 'base', 'a'"),
    "urdf no root": (
        urdf(PLAIN, link("b"), joint("p", "a", "b"), joint("q", "b", "a")),
        "expected one root link, found none: each link is the child of a joint",
    ),
    "urdf an island": (
        urdf(BASE, "\n", PLAIN, link("b"), joint("p", "a", "b"), joint("q", "b", "a")),
        "line 6, <joint name='p'>: its links are not connected to the root",
    ),
    "urdf no link": (urdf(), "expected one root link, found no link"),
    "urdf unknown link": (urdf(BASE, P()), "<joint name='p'>: unknown link 'a'; valid: base"),
    "urdf unknown parent": (
        urdf(BASE, joint("p", "world", "base")), "unknown link 'world'; valid: base"
    ),
    "urdf unknown type": (
        arm(P(kind="hinge")),
        "<joint name='p'>: unknown type 'hinge'; valid: revolute, continuous",
    ),
    "urdf no axis": (arm(P(axis="0 0 0")), "<axis>: expected a direction, got zero"),
    "urdf short axis": (arm(P(axis="1e-300 0 0")), "<axis>: expected a direction, got zero"),
    "urdf no inertia": (
        urdf(BASE, '<link name="a"><inertial><mass value="2"/></inertial></link>', P()),
        "<link name='a'>: body 'a' has a mass of 2 kg and no inertia",
    ),
    "urdf no number": (
        urdf(BASE, link("a", "heavy"), P()),
        "<mass>: mass: expected a finite number of at most 1e+12, got 'heavy'",
    ),
    "urdf no damping": (
        arm(P(more='<dynamics damping="much"/>')),
        "<dynamics>: damping: expected a finite number of at most 1e+12, got 'much'",
    ),
    "urdf mimic of itself": (
        arm(P(more='<mimic joint="p"/>')), "<mimic>: couples joint 'p' to itself"
    ),
    "urdf twice": (urdf(BASE, BASE), "<link name='base'>: the name is taken"),
    "urdf impossible inertias": (arm(P(), *IMPOSSIBLE), "; ".join(BAD_BODIES)),
    "sdf no model": ('<sdf version="1.7"/>', "<sdf>: lacks <model>"),
    "sdf static": (sdf("<static>true</static>", sdf_link("a")), "has no model that moves"),
    "sdf a switch": (
        sdf(sdf_link("a", inside="<gravity>off</gravity>")),
        "<link name='a'>: unknown gravity 'off'; valid: true, 1, false, 0",
    ),
    "sdf automatic": (
        sdf('<link name="a"><inertial auto="true"/></link>'),
        "<inertial>: auto: is not supported; give mass and inertia",
    ),
    "sdf unknown type": (
        sdf(sdf_link("a"), sdf_joint("J", "world", "a", kind="piston")),
        "<joint name='J'>: unknown type 'piston'; valid: revolute",
    ),
    "sdf unknown link": (
        sdf(sdf_link("a"), sdf_joint("J", "world", "b")),
        "<child>: unknown link 'b'; valid: world, a",
    ),
    "sdf circle": (
        sdf(POSED.format("f", "g"), POSED.format("g", "f"), sdf_link("a", more=' relative_to="f"')),
        "its pose is relative to itself",
    ),
    "sdf a long chain": (
        sdf('<frame name="f0"/>', *(POSED.format(f"f{k}", f"f{k - 1}") for k in range(1, 999)),
            sdf_link("a", more=' relative_to="f998"')),
        "its pose is relative to too many others",
    ),
    "sdf unknown frame": (
        sdf(sdf_link("a", more=' relative_to="x"')),
        "<link name='a'>: unknown frame 'x'; valid: world, a",
    ),
    "sdf oblique": (
        sdf(sdf_link("a"), sdf_joint("J", "world", "a", kind="universal").replace(
            "</joint>", "<axis2><xyz>0 1 1</xyz></axis2></joint>")),
        "its two axes are not at right angles",
    ),
    "sdf nested": (
        sdf(sdf_link("a"), "<include><uri>b</uri></include>"), "<include>: is not supported"
    ),
    "xml another root": ("<robot/>", "line 1, <robot>: expected <mujoco>"),
    "xml entities": (
        '<!DOCTYPE mujoco SYSTEM "x"><mujoco/>', "line 1: document types and entities"
    ),
    **{
        f"xml {what} of {number}": (
            mjcf(BODY.format(*(number if k == place else 1 for k in range(3)))), f"'{part}'"
        )
        for number in ("inf", "nan", "1e+300")
        for place, (what, part) in enumerate((("axis", "j"), ("mass", "a"), ("inertia", "a")))
    },
    "xml MuJoCo's own": (mjcf('<body><joint type="hinge"/></body>'), "MuJoCo refuses it: "),
    "xml out of the folder": (
        mjcf(more='<asset><mesh name="m" file="../../m.stl"/></asset>'),
        "<mesh name='m'>: file '../../m.stl' leads out of its folder",
    ),
    "xml absolute": (
        mjcf(compiler='meshdir="/etc"'), "<compiler>: meshdir '/etc' leads out of its folder"
    ),
    "xml included": (
        mjcf(more='<include file="/etc/passwd"/>'), "<include>: file '/etc/passwd' leads out"
    ),
    "xml no place": (
        mjcf('<body name="a" pos="nan 0 0"><geom size="1"/><joint/></body>'),
        "body 'a': place: expected a finite number of at most 1e+12, got nan",
    ),
    "xml distance": (
        mjcf(MJCF_PAIR,
             more='<equality><joint joint1="k" joint2="p" polycoef="0 0 1 0 0"/></equality>'),
        "equality 'equality_0': is not supported: it does not couple two joints linearly",
    ),
    "asmt another file": (
        changed(FOUR_BAR, ("OndselSolver", "solid")), "expected the first line of an assembly"
    ),
    "asmt no gravity": (
        changed(FOUR_BAR, ("ConstantGravity", "Gravity")), "Assembly: lacks ConstantGravity"
    ),
    "asmt unknown joint": (
        changed(FOUR_BAR, ("RevoluteJoint", "CurveCurveContact")),
        "CurveCurveContact O: is not supported",
    ),
    "asmt unknown marker": (
        changed(FOUR_BAR, ("/Press/Part1/Marker2", "/Press/Part9/M")),
        "unknown marker '/Press/Part9/M'",
    ),
    "asmt unknown motion": (
        changed(FOUR_BAR, ("RotationalMotion", "CyclicMotion")),
        "CyclicMotion drive: is not supported; valid: RotationalMotion, TranslationalMotion, Gen",
    ),
    "asmt motion of none": (
        changed(FOUR_BAR, ("/Press/O\n", "/Press/Z\n")),
        "RotationalMotion drive: unknown joint '/Press/Z'",
    ),
    "asmt law": (
        changed(FOUR_BAR, ("2.0d*pi*time", "spline(time)")),
        "'spline(time)' is not supported; valid: numbers",
    ),
    "asmt rotation": (
        changed(FOUR_BAR, ("0.0\t1.0\t0.0", "0.0\t1.0\t0.5")),
        "RotationMatrix: axes: expected three directions",
    ),
    "asmt mass": (
        changed(FOUR_BAR, ("\t\t\t\t\t0.2\n", "\t\t\t\t\t-0.2\n")),
        "body 'Part1': a mass of -0.2 kg is imp",
    ),
    "asmt number": (
        changed(FOUR_BAR, ("\t0.2\n", "\t1e99\n")),
        "Mass: expected a finite number of at most 1e+12, got '1e99'",
    ),
    "asmt tabs": (
        changed(FOUR_BAR, ("\tParts", "\t\t\t\t\t\t\tParts")),
        "has more tabs than the lines above it allow",
    ),
    "asmt gears on one axis": (
        changed(wheels("time", GEAR)).replace("0.3\t0.0\t0.0", "0.0\t0.0\t7.0"),
        "GearJoint tie: the axes of its two wheels coincide",
    ),
    "asmt no gear": (
        changed(wheels("time", (*GEAR[:4], ("radiusJ", 1e-90)))),
        "GearJoint tie: ratio of radii: expected a finite number",
    ),
    "asmt too far": (  # the second part's pivot is at most 0.2 m from the first one's
        changed(pendulum(joints={"A": PENDULUM[2]["A"],
                                 "rod": ("SphSphJoint", "G", "lower/A", ("distanceIJ", 5.0))},
                         motions=ONE)),
        "SphSphJoint rod: joint 'rod' is open by 4.8 m and 0 rad in the drawing, and by ",
    ),
    "json none": ("{", "no JSON"),
    "json another schema": (
        own_arm(version=2), 'expected "schema": "lagrange_casadi.model", "version"'
    ),
    "json unknown key": (own_arm(links=[]), "unknown key 'links'; valid: schema, version"),
    "json no joints": ({k: v for k, v in ARM.items() if k != "joints"}, "lacks 'joints'"),
    "json no inertia": (
        own_arm(bodies=[{"name": "arm", "mass": 2.0}]),
        "bodies[0]: body 'arm' has a mass of 2 kg and no inertia",
    ),
    "json no mass": (
        own_arm(bodies=[ROD_BODY | {"mass": 0}]),
        "no body that moves has a mass: give the bodies masses",
    ),
    "json the ground": (
        own_arm(bodies=[ROD_BODY | {"name": "ground"}]), "body 'ground': the name is taken"
    ),
    "json negative mass": (
        own_arm(bodies=[ROD_BODY | {"mass": -2}]), "a mass of -2 kg is impossible"
    ),
    "json impossible inertia": (
        own_arm(bodies=[{"name": "arm", "mass": 2.0, "inertia": [1, 1, 3]}]),
        "body 'arm' (1, 1, 3 kg m^2, of which the last is too large by 1); correct them, or take",
    ),
    "json gigantic": (
        own_arm(bodies=[ROD_BODY | {"mass": 1e300}]), "expected a finite number of at most 1e+12"
    ),
    "json not a number": (
        own_arm(bodies=[ROD_BODY | {"mass": "2_0"}]), "at most 1e+12, got '2_0'"
    ),
    "json NaN": (own_arm(gravity=[0, 0, float("nan")]), "expected a finite number"),
    "json short rod": (
        own_arm(bodies=[ROD_BODY, {"name": "far", "mass": 1, "rod": [[0, 0, 0], [1e12, 0, 0]]}],
                joints=[HINGE, HINGE | {"name": "second", "child": "far"}]),
        "body 'arm': a rod of 0.5 m in a mechanism of 5e+11 m; expected at least 1e-09 of it",
    ),
    "json unknown joint": (
        own_arm(joints=[HINGE | {"kind": "hinge"}]), "unknown kind 'hinge'; valid: rev"
    ),
    "json no kind": (
        own_arm(joints=[HINGE | {"kind": ["weld"]}]), "unknown kind ['weld']; valid: rev"
    ),
    "json unknown body": (
        own_arm(joints=[HINGE | {"child": "leg"}]), "unknown body 'leg'; valid: ground"
    ),
    "json to itself": (
        own_arm(joints=[HINGE | {"parent": "arm"}]), "joint 'hinge' joins 'arm' to itself"
    ),
    "json disconnected": (
        own_arm(bodies=[ROD_BODY, ROD_BODY | {"name": "leg"}]),
        "bodies[1]: body 'leg' is not connected to the ground",
    ),
    "json twice": (
        own_arm(bodies=[ROD_BODY, ROD_BODY]), "bodies[1]: body 'arm': the name is taken"
    ),
    "json skew axes": (
        own_arm(bodies=[ROD_BODY | {"axes": [[1, 0, 0], [1, 1, 0], [0, 0, 1]]}]),
        "bodies[0].axes: axes: expected three directions at right angles",
    ),
    "json left-handed": (
        own_arm(bodies=[ROD_BODY | {"axes": [[1, 0, 0], [0, 1, 0], [0, 0, -1]]}]),
        "bodies[0].axes: axes: expected three directions at right angles, right-handed",
    ),
    "json unknown motion": (
        own_arm(motions={"knee": "t"}), "unknown coordinate 'knee'; valid: hinge"
    ),
    "json unknown posture": (
        own_arm(posture={"knee": 1}), "posture: unknown coordinate 'knee'; valid: hinge"
    ),
    "json coupled twist": (
        own_arm(joints=[HINGE | {"kind": "planar"}], couplings=[
            {"name": "g", "first": "hinge:turn", "second": "hinge:turn", "ratio": 2}]),
        "couplings[0]: unknown coordinate 'hinge:turn'; valid: none",
    ),
    "json point of words": (
        own_arm(bodies=[ROD_BODY | {"point": "yes"}]),
        "bodies[0].point: expected true or false, got 'yes'",
    ),
    **{f"json law {what}": (own_arm(motions={"hinge": told}), words)
       for what, (told, words) in NO_LAWS.items()},
}  # fmt: skip
"""Texts of files, and words of the refusal; those of XML and assemblies have a line."""


@pytest.mark.parametrize("what", REFUSED)
def test_misuse_is_one_line_that_names_the_element(what, file):
    told, words = REFUSED[what]
    path = file(what.split()[0], told)
    with pytest.raises(errors.ModelFileError, match=re.escape(words)) as error:
        read(path)
    lined = path.suffix not in (".json", ".xml") and what != "urdf impossible inertias"
    assert re.match(rf"model\{path.suffix}: {'line [0-9]+' if lined else ''}", str(error.value))


def test_inertias_that_no_body_has_can_be_accepted(file, tmp_path, capfd):
    path = file("urdf", arm(P(), *IMPOSSIBLE))
    scene = read(path, accept_inertias=True)
    inertia = 0.2 + 0.002 + 0.02 + 3 * 0.1**2
    at = {"t": (0.0, 0.0, 1)}
    found = evaluate(Scene(scene.mechanism, MOVE, **at)).effort("p")[0]
    assert found == pytest.approx(inertia + 3 * WEIGHT, rel=1e-12)
    case = str(tmp_path / "case")
    assert main(["new", case, "--from", str(path)]) == 2
    assert main(["new", case, "--accept-inertias"]) == 2
    assert main(["new", case, "--from", str(path), "--accept-inertias"]) == 0
    out, err = capfd.readouterr()
    assert "take them as they are by --accept-inertias" in err
    assert "--accept-inertias needs --from FILE" in err
    words = " ".join(out.split())
    end = ": no body has such principal moments of inertia; they are as in the file."
    assert f"{BAD_BODIES[0]}{end} body" in words
    assert f"{BAD_BODIES[1]}{end} The energy of this one may be negative." in words
    again = Scene(load_case(case).scene.mechanism, MOVE, **at)
    assert evaluate(again).effort("p")[0] == found


def test_files_that_are_none(tmp_path):
    (tmp_path / "folder.json").mkdir()
    (tmp_path / "latin.json").write_bytes(b"\xff\xfe\xfa")
    for name, error, words in (
        ("none.json", errors.PathError, "No such file"),
        ("folder.json", errors.PathError, "not a file"),
        ("part.step", errors.ModelFileError, r"unknown format '.step'; valid: .json"),
        ("arm.urdf.xacro", errors.ModelFileError, r"first: xacro arm.urdf.xacro > arm.urdf"),
        ("latin.json", errors.ModelFileError, "no text in UTF-8"),
    ):
        with pytest.raises(error, match=words):
            read(tmp_path / name)


def test_the_schema_accepts_what_the_reader_does(tmp_path):
    """And refuses what is wrong in its shape; what no mechanism is, the reader alone sees."""
    jsonschema = pytest.importorskip("jsonschema", reason="jsonschema is not installed")
    schema = json.loads(Path("docs/model.schema.json").read_text())
    jsonschema.Draft202012Validator.check_schema(schema)
    valid = jsonschema.Draft202012Validator(schema).is_valid
    save_model(load_case("delta").scene, tmp_path / "model.json")
    for told in ((tmp_path / "model.json").read_text(), SMALL["loop.json"], SMALL["kinds.json"]):
        assert valid(json.loads(told))
    wrong = ("another schema", "unknown key", "no joints", "negative mass", "not a number")
    wrong += ("unknown joint", "no kind")
    assert [what for what in wrong if valid(REFUSED[f"json {what}"][0])] == []


def test_what_mujoco_includes_stays_in_the_folder(file, tmp_path, monkeypatch):
    pytest.importorskip("mujoco", reason="MuJoCo is not installed")
    more = '<mujocoinclude><include file="../out.xml"/></mujocoinclude>'
    (tmp_path / "more.xml").write_text(more)
    with pytest.raises(errors.ModelFileError, match=r"file '../out.xml' leads out of its folder"):
        read(file("xml", mjcf(more='<include file="more.xml"/>')))


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("raise ModuleNotFoundError()", "pip install mujoco$"),
        (
            'raise ImportError("its core\\nis missing")',
            "pip install mujoco; it is broken here: its core is missing",
        ),
    ],
)
def test_without_mujoco_a_model_is_refused_by_name(body, words, file, tmp_path, monkeypatch):
    (tmp_path / "mujoco.py").write_text(body)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    with pytest.raises(errors.MissingPackageError, match=words):
        read(file("xml", mjcf(MJCF_PLAIN)))


def test_every_attribute_that_names_files_is_looked_at():
    """MuJoCo's own list of attributes: of later versions too."""
    mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed")
    found = re.findall(r"\b\w*(?:file|dir|path|uri|url)\w*", mujoco.mj_printSchema(False, False))
    known = {name for name in found if name.startswith("file")} | {"assetdir", "meshdir"}
    assert set(found) - known == {"texturedir", "dir", "directional", "strippath"}


def moved(file, motion, times=(0.3, 1.7)):
    """The values of a law of a file."""
    told = own([own_body("arm")], [own_joint("hinge", "ground", "arm")], motions={"hinge": motion})
    scene = read(file("json", told))
    return [evaluate(scene, t=(t, t, 1), wanted=["motion"]).motion("hinge").value[0] for t in times]


@pytest.mark.parametrize("seed", range(40))
def test_laws_have_the_values_of_their_texts(seed, file):
    """Python's own, as far as all parts without t are numbers of a machine."""
    text = text_of(random.Random(seed))
    names = {"sin": np.sin, "cos": np.cos, "pi": np.pi}
    for t, found in zip((0.3, 1.7), moved(file, text), strict=True):
        there = eval(text.replace("^", "**"), names | {"t": t})
        assert abs(found - there) < 1e-9 * (abs(there) + 1.0), text


def test_no_law_hangs_or_ends_in_a_traceback(file, pytestconfig):
    """Each is refused, or is a text that Python compiles inside a case."""
    accepted = 0
    for seed in range(20_000 if pytestconfig.getoption("--long") else 300):
        try:
            text = case_of(file("json", own_arm(motions={"hinge": law(random.Random(seed))})))
        except errors.ModelFileError:
            continue
        compile(text, "case", "exec")
        accepted += 1
    assert accepted > 50


@pytest.mark.parametrize("what", FAR_TERMS)
def test_laws_of_many_terms_come_back(what, file, tmp_path):
    """In the file each term has its pair of parentheses, more than a reader takes: samples."""
    scene = read(file("json", own_arm(motions={"hinge": FAR_TERMS[what]})))
    at = {"t": (0.0, 1.0 if what == "many terms" else 1e-4, 5)}
    save_model(Scene(scene.mechanism, scene.motion, **at), tmp_path / "again.json")
    scenes = (scene, read(tmp_path / "again.json"))
    there, back = (evaluate(one, **at).motion("hinge").value for one in scenes)
    assert_same(back - back[0], there - there[0], 1e-6)


def seconds(path):
    """The processor time that the case of a file takes, the least of two."""
    found = []
    for _ in range(2):
        start = time.process_time()
        case_of(path)
        found.append(time.process_time() - start)
    return min(found)


def check_growth(file, name, few, many):
    """Check that many parts take as much longer as these are more, but for half of that; a square
    law would take as much again.
    """
    ending = name.rpartition(".")[2]
    small = seconds(file(ending, LARGE[name](few)))
    large = seconds(file(ending, LARGE[name](many)))
    assert large < 1.6 * many / few * small
    return large


@pytest.mark.parametrize("name", LARGE)
def test_time_grows_as_the_file_does(name, file):
    check_growth(file, name, 40, 240)


@pytest.mark.long
@pytest.mark.parametrize("name", LARGE)
def test_three_thousand_links_take_seconds(name, file):
    large = check_growth(file, name, 600, 3000)
    assert name in ("bars.asmt", "arms.xml") or large < 5.0


PARTS = {
    "loop.json": ["crank", "rocker", "O", "A", "B", "C"],
    "kinds.json": ["b0", "b1", "b3", "j0", "j1", "j3", "j4", "base", "tip", "gear"],
    "gears.asmt": ["crank", "rocker", "sun", "wheel", "O", "S", "V", "teeth", "rod"],
    "arm.urdf": ["one", "two", "three", "lump", "j1", "j2", "j3"],
    "loop.urdf": ["crank", "rod", "rocker", "O", "A", "C"],
    "cell.urdf": ["crank0", "rod0", "rocker0", "O0", "A0", "B0", "C0"],
    "arm.sdf": ["one", "two", "three", "four", "j1", "j2", "j3", "j4"],
    "arm.xml": ["two", "three", "j_one", "j_two", "j_three"],
}


@pytest.mark.parametrize("name", SMALL)
def test_parts_may_have_the_names_that_a_case_uses(name, file):
    """All of them in turn: the efforts are those of the file before, whatever they are called."""
    told, parts, ending = SMALL[name], PARTS[name], name.rpartition(".")[2]
    path = file(ending, told)
    words = {"ground", *re.findall(r"\w+", told)}
    found = set(re.findall(r"[A-Za-z_]\w*", re.sub(r"#.*|\"[^\"]*\"", "", case_of(path))))
    names = sorted(found - words)
    there = np.sort(efforts(read(path), 3), axis=None)
    assert {"Scene", "SpatialMechanism"} <= set(names)
    for k in range(0, len(names), len(parts)):
        text = told
        for old, new in zip(parts, names[k : k + len(parts)], strict=False):
            text = re.sub(rf"(?<!\w){old}(?!\w)", new, text)
        back = np.sort(efforts(read(file(ending, text)), 3), axis=None)
        assert np.allclose(back, there, rtol=1e-12, atol=1e-12), names[k:]


def draw(kind, first, count, folder):
    """Draw and read so many files in a program of its own; what it said, a line each."""
    folder.mkdir()
    program = [sys.executable, str(TESTS), "drawn_models", kind]
    wrong, accepted, last, most = [], 0, first + count, 60.0 + 25.0 * count
    while first < last:
        program[4:] = [str(first), str(last - first)]
        done = subprocess.run(program, cwd=folder, capture_output=True, text=True, timeout=most)
        said = done.stdout.splitlines()
        reached = [int(line) for line in said if line.isdigit()]
        accepted += said.count("accepted")
        wrong += [line for line in said if not line.isdigit() and line != "accepted"]
        if done.returncode:
            wrong.append(f"{reached[-1:]} ended with {done.returncode}: {done.stderr[-300:]}")
        first = reached[-1] + 1 if reached else last
    assert accepted > count // 20
    return wrong


@pytest.mark.parametrize(("kind", "count"), [("hostile", 110), ("damaged", 40)])
def test_files_are_read_or_refused(kind, count, tmp_path):
    assert draw(kind, 0, count, tmp_path / kind) == []


@pytest.mark.long
@pytest.mark.parametrize(("kind", "count"), [("hostile", 300), ("damaged", 100)])
@pytest.mark.parametrize("part", range(10))
def test_many_files_are_read_or_refused(kind, count, part, tmp_path):
    assert draw(kind, count * part, count, tmp_path / kind) == []
