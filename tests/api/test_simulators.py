"""Models of Gazebo and of MuJoCo: against declarations by hand, and MuJoCo's own efforts."""

import re

import numpy as np
import pytest
from internals import case_of

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, errors, evaluate, read
from lagrange_casadi.motion import harmonic, polynomial

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]


def inertial(mass=1.0, pose="0.1 0 0 0 0 0", inertia="0.001 0.01 0.01"):
    xx, yy, zz = inertia.split()
    moments = f"<ixx>{xx}</ixx><iyy>{yy}</iyy><izz>{zz}</izz>"
    return (
        f"<inertial><pose>{pose}</pose><mass>{mass}</mass><inertia>{moments}</inertia></inertial>"
    )


def link(name, **told):
    return f'<link name="{name}">{inertial(**told)}</link>\n'


def joint(name, kind, parent, child, inside="<axis><xyz>0 0 1</xyz></axis>"):
    ends = f"<parent>{parent}</parent><child>{child}</child>"
    return f'<joint name="{name}" type="{kind}">{ends}{inside}</joint>\n'


def model(*parts, gravity="0 0 0", pose=""):
    start = f'<sdf version="1.10"><world name="w"><gravity>{gravity}</gravity>'
    return f'{start}<model name="model">{pose}\n{"".join(parts)}</model></world></sdf>\n'


@pytest.fixture
def reading(tmp_path):
    def written(text, name="model.sdf"):
        path = tmp_path / name
        path.write_text(text)
        return path

    return written


def four_bar():
    """By hand: its coupler rises from the crank's tip, at (0.2, 0), to (0.5, 0.4)."""
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
    laws = {"O": harmonic(0.0, 0.3, 0.5)}
    return evaluate(Scene(m, laws, t=(0.0, 1.0, 9), posture=posture, wanted=["effort"]))


def test_a_loop_of_joints(reading):
    turn = float(np.arctan2(4, 3))
    path = reading(
        model(
            link("crank", mass=0.5),
            f'<link name="coupler"><pose relative_to="pin">0 0 0 0 0 {turn!r}</pose>'
            + inertial(0.8, "0.25 0 0 0 0 0") + "</link>",
            '<frame name="pin" attached_to="crank"><pose>0.2 0 0 0 0 0</pose></frame>',
            '<link name="rocker"><pose degrees="true">0.5 0 0 0 0 90</pose>'
            + inertial(0.7, "0.2 0 0 0 0 0") + "</link>",
            joint("O", "revolute", "world", "crank"),
            joint("A", "revolute", "pin", "coupler"),
            joint("C", "revolute", "world", "rocker"),
            joint("B", "revolute", "coupler", "rocker", '<pose>0.4 0 0 0 0 0</pose>'
                  '<axis><xyz expressed_in="__model__">0 0 1</xyz></axis>'),
            pose="<pose>3 2 1 0 0 0</pose>",
        )
    )  # fmt: skip
    laws = {"O": harmonic(0.0, 0.3, 0.5)}
    solution = evaluate(Scene(read(path).mechanism, laws, t=(0.0, 1.0, 9), wanted=["effort"]))
    assert np.allclose(solution.effort("O"), four_bar().effort("O"), rtol=1e-11, atol=1e-12)


def test_joints_of_several_freedoms_and_a_screw(reading):
    """Ball and universal joints hold a bar; a screw moves a nut by its lead."""
    path = reading(
        model(
            link("nut", mass=2.0, pose="0 0 0 0 0 0", inertia="0.01 0.01 0.01"),
            joint("screw", "screw", "world", "nut",
                  "<axis><xyz>0 0 1</xyz></axis><screw_thread_pitch>0.01</screw_thread_pitch>"),
            link("yoke", mass=1.0, pose="0 0 0 0 0 0", inertia="0.02 0.02 0.02"),
            joint("cardan", "universal", "nut", "yoke",
                  "<axis><xyz>1 0 0</xyz></axis><axis2><xyz>0 1 0</xyz></axis2>"),
            gravity="0 0 -9.81",
        )
    )  # fmt: skip
    text = case_of(path)
    assert "lead=0.01" in text
    assert "second=(0.0, 1.0, 0.0)" in text
    laws = {name: harmonic(0.1, 0.2, 1.0) for name in ("screw", "cardan:turn_1", "cardan:turn_2")}
    solution = evaluate(Scene(read(path).mechanism, laws, t=(0.0, 1.0, 5)))
    m = SpatialMechanism("by_hand")
    nut = m.link("nut", length=0.1, mass=2.0, centre=(0, 0, 0), inertia=(0.01, 0.01, 0.01))
    yoke = m.link("yoke", length=0.1, mass=1.0, centre=(0, 0, 0), inertia=(0.02, 0.02, 0.02))
    m.screw("screw", m.ground, nut, axis=(0, 0, 1), lead=0.01)
    m.universal("cardan", nut, yoke, axis=(1, 0, 0), second=(0, 1, 0))
    other = evaluate(Scene(m, laws, t=(0.0, 1.0, 5)))
    for name in laws:
        assert np.allclose(solution.effort(name), other.effort(name), rtol=1e-12, atol=1e-13)


def test_gearboxes_and_joints_that_follow(reading):
    shafts = [link(name, pose="0 0 0 0 0 0", inertia="0.1 0.1 0.1") for name in ("a", "b", "c")]
    follow = "<axis><xyz>0 0 1</xyz><mimic joint='B'><multiplier>3</multiplier></mimic></axis>"
    box = "<gearbox_ratio>2</gearbox_ratio><gearbox_reference_body>world</gearbox_reference_body>"
    path = reading(
        model(
            *shafts,
            joint("A", "revolute", "world", "a"),
            joint("B", "revolute", "world", "b"),
            joint("C", "revolute", "world", "c", follow),
            joint("box", "gearbox", "a", "b", box),
        )
    )
    scene = Scene(read(path).mechanism, {"A": harmonic(0.0, 1.0, 1.0)}, t=(0.0, 1.0, 7))
    solution = evaluate(scene)
    assert np.allclose(solution.motion("B").rate, -2.0 * solution.motion("A").rate)
    assert np.allclose(solution.motion("C").rate, -6.0 * solution.motion("A").rate)
    moment = 0.1 * (1 + 4 + 36) * solution.motion("A").acceleration
    assert np.allclose(solution.effort("A"), moment, rtol=1e-11)


def test_a_model_that_stands_on_nothing_is_fixed(reading):
    path = reading(model(link("base"), link("arm"), joint("A", "revolute", "base", "arm")))
    assert "# No joint leads to the world: 'base' is fixed." in case_of(path)
    assert evaluate(read(path), t=(0.0, 0.0, 1)).certified


SDF_MISUSE = {
    "no model": ('<sdf version="1.7"/>', "<sdf>: lacks <model>"),
    "static": (model("<static>true</static>", link("a")), "has no model that moves"),
    "a switch": (
        model(f'<link name="a">{inertial()}<gravity>off</gravity></link>'),
        "<link name='a'>: unknown gravity 'off'; valid: true, 1, false, 0",
    ),
    "automatic": (
        model('<link name="a"><inertial auto="true"/></link>'),
        "<inertial>: auto: is not supported; give mass and inertia",
    ),
    "unknown type": (
        model(link("a"), joint("J", "piston", "world", "a")),
        "<joint name='J'>: unknown type 'piston'; valid: revolute",
    ),
    "unknown link": (
        model(link("a"), joint("J", "revolute", "world", "b")),
        "<child>: unknown link 'b'; valid: world, a",
    ),
    "circle": (
        model(
            '<frame name="f"><pose relative_to="g">0 0 0 0 0 0</pose></frame>'
            '<frame name="g"><pose relative_to="f">0 0 0 0 0 0</pose></frame>'
            '<link name="a"><pose relative_to="f">0 0 0 0 0 0</pose>' + inertial() + "</link>"
        ),
        "its pose is relative to itself",
    ),
    "a long chain": (
        model(
            '<frame name="f0"/>',
            *(
                f'<frame name="f{k}"><pose relative_to="f{k - 1}">0 0 0 0 0 0</pose></frame>'
                for k in range(1, 999)
            ),
            '<link name="a"><pose relative_to="f998">0 0 0 0 0 0</pose>' + inertial() + "</link>",
        ),
        "its pose is relative to too many others",
    ),
    "unknown frame": (
        model('<link name="a"><pose relative_to="x">0 0 0 0 0 0</pose>' + inertial() + "</link>"),
        "<link name='a'>: unknown frame 'x'; valid: world, a",
    ),
    "oblique": (
        model(
            link("a"),
            joint("J", "universal", "world", "a",
                  "<axis><xyz>0 0 1</xyz></axis><axis2><xyz>0 1 1</xyz></axis2>"),
        ),
        "its two axes are not at right angles",
    ),
    "nested": (model(link("a"), "<include><uri>b</uri></include>"), "<include>: is not supported"),
}  # fmt: skip


@pytest.mark.parametrize("what", SDF_MISUSE)
def test_misuse_of_sdf_names_line_and_element(what, reading):
    text, words = SDF_MISUSE[what]
    with pytest.raises(errors.ModelFileError, match=re.escape(words)) as error:
        read(reading(text))
    assert re.match(r"model\.sdf: line \d+", str(error.value))


def arm(*inside, dynamics="", version="1.10", before="", inertia=None):
    """A link of 1 kg that turns about y of a joint at its base, which is turned about z."""
    held = inertial(pose="0.1 0 0 0 0 0") if inertia is None else inertia
    axis = f"<axis><xyz>0 -1 0</xyz><dynamics>{dynamics}</dynamics></axis>"
    return (
        f'<sdf version="{version}"><world name="w">{before}<model name="m">'
        f'<link name="a"><pose>0 0 0 0 0 1.5707963267948966</pose>{held}{"".join(inside)}</link>'
        f"{joint('J', 'revolute', 'world', 'a', axis)}</model></world></sdf>"
    )


WEIGHT, TURN, ACROSS = 0.1 * 9.8 * np.cos(0.3), 0.01 + 0.1**2, 0.001
"""Of the arm's effort: that of gravity, and moments of inertia about its joint across and along."""


@pytest.mark.parametrize(
    ("text", "effort", "notes"),
    [
        (arm(), TURN + WEIGHT, []),
        (arm("<gravity>false</gravity>"), TURN, []),
        (arm(before="<gravity>0 0 -1.96</gravity>"), TURN + WEIGHT / 5, []),
        (arm(before="<physics><gravity>0 0 0</gravity></physics>"), TURN, []),
        (
            arm(dynamics="<damping>2</damping><spring_stiffness>5</spring_stiffness>"
                         "<spring_reference>0.1</spring_reference><friction>3</friction>"),
            TURN + WEIGHT + 2.0 * 0.4 + 5.0 * (0.3 - 0.1),
            ["Not read of world/model/joint/axis/dynamics: friction (J)."],
        ),
        (
            arm(before='<model name="ground_plane"><static>true</static></model>'),
            TURN + WEIGHT,
            ["Not read of world: model (ground_plane)."],
        ),
        # On the frame of the model, so along the arm.
        (arm(version="1.4"), ACROSS, []),
        (arm(inertia=inertial(inertia="1 5 1").replace("<iyy>5</iyy>", "<iyy> </iyy>")),
         1.01 + WEIGHT, ["Not given, so as the format says: iyy 1 (a)."]),
        (arm(inertia="<inertial><pose>0.1 0 0 0 0 0</pose></inertial>"), 1.01 + WEIGHT,
         ["Not given, so as the format says: mass 1, ixx 1, iyy 1, izz 1 (a)."]),
        (arm(inertia=""), 1.0, ["Not given, so as the format says: mass 1, ixx 1, iyy 1, izz 1"]),
    ],
)  # fmt: skip
def test_what_a_file_says_of_an_arm_is_read_or_noted(text, effort, notes, reading):
    """The joint moves with 0.4 rad/s and 1 rad/s^2 at 0.3 rad; the joint's frame is the link's."""
    path = reading(text)
    laws = {"J": polynomial(0.3, 0.4, 0.5)}
    solution = evaluate(Scene(read(path).mechanism, laws, t=(0.0, 0.0, 1)))
    assert solution.certified
    assert solution.effort("J")[0] == pytest.approx(effort, rel=1e-12)
    written = " ".join(case_of(path).split())
    assert [note for note in notes if note not in written] == []


def test_a_slide_has_a_damper_and_a_spring(reading):
    dynamics = "<dynamics><damping>2</damping><spring_stiffness>5</spring_stiffness></dynamics>"
    axis = f"<axis><xyz>1 0 0</xyz>{dynamics}</axis>"
    path = reading(model(link("a"), joint("J", "prismatic", "world", "a", axis)))
    laws = {"J": polynomial(0.3, 0.4, 0.5)}
    solution = evaluate(Scene(read(path).mechanism, laws, t=(0.0, 0.0, 1)))
    assert solution.effort("J")[0] == pytest.approx(1.0 + 2.0 * 0.4 + 5.0 * 0.3, rel=1e-13)


def test_a_joint_that_follows_none_is_free(reading):
    follow = "<axis><xyz>0 0 1</xyz><mimic joint='K'/></axis>"
    path = reading(model(link("a"), joint("J", "revolute", "world", "a", follow)))
    assert "# Joint 'J' follows 'K', which is no joint of the file: it is free." in case_of(path)


@pytest.mark.parametrize("seed", range(3))
def test_a_tree_is_the_same_as_urdf_and_as_sdf(seed, reading):
    """Random places, turns, axes, dampers and links without weight, written in both formats."""
    random = np.random.default_rng(seed)
    urdf, sdf, laws = ['<link name="base"/>'], [], {}
    for k in range(4):
        place, turn, axis, centre, angles = (
            " ".join(map(repr, random.uniform(-1, 1, 3).tolist())) for _ in range(5)
        )
        sizes, mass, damping = random.uniform(0.01, 0.1, 3), *random.uniform(0.1, 3, 2).tolist()
        xx, yy, zz = (sizes.sum() - sizes).tolist()
        above, off = f"l{int(random.integers(k))}" if k else "base", bool(random.integers(2))
        moments = f'ixx="{xx!r}" iyy="{yy!r}" izz="{zz!r}" ixy="0" ixz="0" iyz="0"'
        kind = ("revolute", "prismatic")[int(random.integers(2))]
        urdf.append(
            f'<link name="l{k}"><inertial><origin xyz="{centre}" rpy="{angles}"/>'
            f'<mass value="{mass!r}"/><inertia {moments}/></inertial></link>'
            f'<joint name="j{k}" type="{kind}"><parent link="{above}"/><child link="l{k}"/>'
            f'<origin xyz="{place}" rpy="{turn}"/><axis xyz="{axis}"/>'
            f'<dynamics damping="{damping!r}"/></joint><gazebo reference="l{k}">'
            f"<turnGravityOff>{str(off).lower()}</turnGravityOff></gazebo>"
        )
        on = "" if above == "base" else f' relative_to="{above}"'
        held = inertial(repr(mass), f"{centre} {angles}", f"{xx!r} {yy!r} {zz!r}")
        sdf.append(
            f'<link name="l{k}"><pose{on}>{place} {turn}</pose>{held}'
            f"<gravity>{str(not off).lower()}</gravity></link>"
        )
        axis = f"<xyz>{axis}</xyz><dynamics><damping>{damping!r}</damping></dynamics>"
        parent = "world" if above == "base" else above
        sdf.append(joint(f"j{k}", kind, parent, f"l{k}", f"<axis>{axis}</axis>"))
        laws[f"j{k}"] = harmonic(*random.uniform(0.1, 1.0, 4).tolist())
    paths = (
        reading(f'<robot name="r">{"".join(urdf)}</robot>', "robot.urdf"),
        reading(model(*sdf, gravity="0 0 -9.81")),
    )
    one, other = (evaluate(Scene(read(path).mechanism, laws, t=(0.0, 1.0, 4))) for path in paths)
    for name in laws:
        assert np.allclose(one.effort(name), other.effort(name), rtol=1e-11, atol=1e-11)


def mjcf(body, after="", compiler=""):
    options = '<option gravity="0 0 -9.81"/>'
    return (
        f'<mujoco model="robot"><compiler angle="radian" {compiler}/>{options}'
        f"<worldbody>{body}</worldbody>{after}</mujoco>"
    )


CHAIN = """
<body name="base" pos="0 0 1" quat="0.9 0.1 -0.3 0.2">
  <inertial pos="0.1 0.02 0" mass="2" fullinertia="0.02 0.05 0.06 0.002 0.001 0.003"/>
  <joint name="yaw" axis="0 0.2 1" pos="0.05 0 0"/>
  <joint name="lift" type="slide" axis="1 0 1" ref="0.1"/>
  <body name="arm" pos="0.3 0 0.1" euler="0.2 0.4 0.1">
    <joint name="elbow" axis="0 1 0" ref="0.3"/>
    <geom type="capsule" size="0.03 0.2" density="800"/>
    <body name="plate" pos="0 0 0.3"><geom type="box" size="0.1 0.05 0.01" mass="0.3"/></body>
  </body>
</body>
"""


def test_open_chains_have_the_efforts_of_mujoco(reading):
    """Two joints of one body, reference values, a part without a joint, inertia of shapes."""
    mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed")
    path = reading(mjcf(CHAIN), "robot.xml")
    compiled = mujoco.MjModel.from_xml_path(str(path))
    compiled.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    laws, told = {}, {"yaw": (0.3, 0.5, 1.0), "lift": (0.15, 0.05, 2.0), "elbow": (0.4, 0.6, 1.5)}
    for name, (mean, size, often) in told.items():
        # The case's coordinates are zero where the file's have their reference values.
        start = float(compiled.qpos0[compiled.jnt_qposadr[compiled.joint(name).id]])
        laws[name] = harmonic(mean - start, size, often, 0.4)
    solution = evaluate(Scene(read(path).mechanism, laws, t=(0.0, 1.0, 7), wanted=["effort"]))
    data, largest = mujoco.MjData(compiled), np.abs(solution.effort("yaw")).max()
    for k, t in enumerate(solution.t):
        for name, (mean, size, often) in told.items():
            j, speed = compiled.joint(name).id, 2 * np.pi * often
            s, c = np.sin(speed * t + 0.4), np.cos(speed * t + 0.4)
            data.qpos[compiled.jnt_qposadr[j]] = mean + size * s
            data.qvel[compiled.jnt_dofadr[j]] = size * speed * c
            data.qacc[compiled.jnt_dofadr[j]] = -size * speed**2 * s
        mujoco.mj_inverse(compiled, data)
        for name in told:
            effort = data.qfrc_inverse[compiled.jnt_dofadr[compiled.joint(name).id]]
            assert abs(effort - solution.effort(name)[k]) < 1e-10 * largest


LINKS = """
<body name="crank"><inertial pos="0.1 0 0" mass="0.5" diaginertia="0.001 0.01 0.01"/>
  <joint name="O" axis="0 0 1"/>
  <body name="coupler" pos="0.2 0 0" euler="0 0 0.9272952180016122">
    <inertial pos="0.25 0 0" mass="0.8" diaginertia="0.001 0.01 0.01"/>
    <joint name="A" axis="0 0 1"/></body></body>
<body name="rocker" pos="0.5 0 0" euler="0 0 1.5707963267948966">
  <inertial pos="0.2 0 0" mass="0.7" diaginertia="0.001 0.01 0.01"/>
  <joint name="C" axis="0 0 1"/></body>
"""


def test_a_loop_that_an_equality_connects(reading):
    pytest.importorskip("mujoco", reason="MuJoCo is not installed")
    connect = '<connect name="B" body1="coupler" body2="rocker" anchor="0.5 0 0"/>'
    motor = '<actuator><motor joint="C"/></actuator>'
    path = reading(mjcf(LINKS, f"<equality>{connect}</equality>{motor}"), "robot.xml")
    text = case_of(path)
    assert '"C": polynomial(0.0)' in text
    assert "# Actuators, except which joints they drive: not read." in text
    laws = {"O": harmonic(0.0, 0.3, 0.5)}
    solution = evaluate(Scene(read(path).mechanism, laws, t=(0.0, 1.0, 9), wanted=["effort"]))
    assert np.allclose(solution.effort("O"), four_bar().effort("O"), rtol=1e-10, atol=1e-11)
    gear = '<equality><joint joint1="C" joint2="O" polycoef="0 -2 0 0 0"/></equality>'
    path = reading(mjcf(LINKS, gear), "robot.xml")
    assert "ratio=-2.0" in case_of(path)
