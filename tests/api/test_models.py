"""Models of other programs: what ``read`` makes of a file, and what the written case says of it."""

import model_parts
import numpy as np
import pytest
from commands import run_here
from internals import case_of
from mechanisms import pins_of
from model_files import (
    inertial,
    joint,
    link,
    mjcf,
    own,
    own_joint,
    sdf,
    sdf_joint,
    sdf_link,
    urdf,
)
from model_parts import (
    BASE,
    MJCF_ARM,
    MJCF_PLAIN,
    MOVE,
    TENDON,
    TURN,
    WEIGHT,
    P,
    arm,
    assert_same,
    dynamics,
    efforts,
    frame,
    numbers,
)

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, evaluate, load_case, read
from lagrange_casadi.motion import harmonic

pytestmark = pytest.mark.usefixtures("interpreted")

file = model_parts.file


@pytest.fixture(autouse=True)
def _compiled_here(monkeypatch):
    """No file here is meant to harm: MuJoCo compiles them in this process."""
    monkeypatch.setattr("lagrange_casadi.interop.formats.mjcf.run_apart", run_here)


SDF_WEIGHT = WEIGHT / 9.81 * 9.8


AT_REST = -9.81 * 0.25


def sdf_arm(*inside, dynamics="", version="1.10", before="", kind="revolute", held=None):
    """A link of 1 kg that turns about y of a joint at its base, which is turned about z."""
    axis = "0 -1 0" if kind == "revolute" else "0 1 0"
    body = f'<link name="a"><pose>0 0 0 0 0 1.5707963267948966</pose>{"".join(inside)}'
    held = inertial(1.0) if held is None else held
    parts = body + held + "</link>", sdf_joint("p", "world", "a", axis, kind, dynamics)
    return sdf(*parts, world=before, version=version)


DRAGGED = dynamics(damping=2, spring_stiffness=5, spring_reference=0.1, friction=3)


WELD = '<equality><weld body1="a" body2="b" anchor="-0.5 0.1 0.2" {}/></equality>'


HELD = MJCF_PLAIN + (
    '<body name="b" pos="1 0 1"><freejoint/><geom type="box" size="0.1 0.1 0.1" mass="2"/></body>'
)


SLIDING = HELD.replace("<freejoint/>", '<joint name="x" axis="1 0 0"/>')


READ = {
    "urdf": (arm(P()), TURN + WEIGHT, []),
    "urdf damping": (
        arm(P(more='<dynamics damping="2" friction="3"/>')),
        TURN + WEIGHT + 2.0 * 0.4 + 3.0, [],
    ),
    "urdf turnGravityOff": (
        arm(P(), '<gazebo reference="a"><turnGravityOff>1</turnGravityOff></gazebo>'), TURN, []
    ),
    "urdf gravity": (
        arm(P(), '<gazebo reference="a"><gravity>false</gravity></gazebo>'), TURN, []
    ),
    "urdf no axis": (
        arm(P()).replace('<axis xyz="0 -1 0"/>', ""), 0.1,
        ["Not given, so as the format says: axis 1 0 0 (p)."],
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
        arm(P(), *frame("tool")), TURN + WEIGHT, ["tool = m.at(a, "]
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
        TURN + SDF_WEIGHT + 2.0 * 0.4 + 5.0 * (0.3 - 0.1) + 3.0, [],
    ),
    "sdf slide": (
        sdf_arm(dynamics=DRAGGED, kind="prismatic"), 1.0 + 2.0 * 0.4 + 5.0 * (0.3 - 0.1) + 3.0, []
    ),
    "sdf no axis": (
        sdf_arm().replace("<xyz>0 -1 0</xyz>", ""), TURN,
        ["Not given, so as the format says: axis 0 0 1 (p)."],
    ),
    "sdf no spring": (
        sdf_arm(dynamics=dynamics(damping=-1, spring_reference=0.1)), TURN + SDF_WEIGHT,
        ["Not read of world/model/joint/axis/dynamics: damping, spring_reference (p)."],
    ),
    "sdf fixed": (
        sdf_arm().replace("</model>", sdf_link("f", centre="0 0 0 0 0 0", inertia="0.3 0.3 0.3")
                          + sdf_joint("q", "a", "f", "", "fixed") + "</model>"),
        TURN + SDF_WEIGHT + 0.3, [],
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
    "xml weld sites": (
        mjcf(HELD.replace("<geom", '<site name="s" pos="1 0 0"/><geom', 1).replace(
                 "<freejoint/>", '<freejoint/><site name="t"/>'),
             more='<equality><weld site1="s" site2="t"/></equality>'), AT_REST - 2 * 9.81, [],
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
             more='<option density="1000"/><actuator><motor joint="p"/><motor tendon="t"/>'
                  "</actuator>" + TENDON),
        AT_REST,
        [f"{words}: not read." for words in (
            "Limits of joints",
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
    ends = {"O": (m.ground, crank), "A": (crank.tip, coupler), "C": (m.ground.at(0.5, 0), rocker)}
    pins_of(m, **ends, B=(coupler.tip, rocker.tip))
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


@pytest.mark.parametrize("seed", range(4))
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


def on_screw():
    """Joints of a nut on a screw, and of what a universal joint joins to it."""
    across = "<axis2><xyz>0 1 0</xyz></axis2></joint>"
    pitch = "<screw_thread_pitch>0.01</screw_thread_pitch></joint>"
    cardan = sdf_joint("cardan", "a", "b", "1 0 0", "universal").replace("</joint>", across)
    return sdf_joint("screw", "world", "a", kind="screw").replace("</joint>", pitch), cardan


def test_joints_of_several_freedoms_and_a_screw(file):
    """A universal joint on a nut, which a screw moves by its lead."""
    path = file("sdf", sdf(*SHAFTS[:2], *on_screw(), world="<gravity>0 0 -9.81</gravity>"))
    laws = {name: harmonic(0.1, 0.2, 1.0) for name in ("screw", "cardan:turn_1", "cardan:turn_2")}
    m = SpatialMechanism("by_hand")
    told = {"length": 0.1, "mass": 1.5, "centre": (0, 0, 0), "inertia": (0.1, 0.1, 0.1)}
    nut, yoke = m.link("nut", **told), m.link("yoke", **told)
    m.screw("screw", m.ground, nut, axis=(0, 0, 1), lead=0.01)
    m.universal("cardan", nut, yoke, axis=(1, 0, 0), second=(0, 1, 0))
    expected = efforts(Scene(m, laws, t=(0.0, 1.0, 5)))
    assert_same(efforts(read(path), laws=laws, t=(0.0, 1.0, 5)), expected)


def test_a_posture_is_of_joints_of_several_freedoms_and_a_screw_too(file):
    foot = '<frame name="foot" attached_to="b"><pose relative_to="b">0 0 1 0 0 0</pose></frame>'
    path = file("sdf", sdf(*SHAFTS[:2], *on_screw(), foot))
    turns = dict.fromkeys(("screw", "cardan:turn_1", "cardan:turn_2"), "90 deg")
    assert "at=(0.0, 1.0, 0.0025))" in case_of(path, posture=turns, contacts=["foot"])
