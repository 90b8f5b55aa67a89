"""Models of Gazebo and of MuJoCo: against declarations by hand, and MuJoCo's own efforts."""

import re
import sys

import numpy as np
import pytest
from internals import case_of

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, errors, evaluate, read
from lagrange_casadi.motion import harmonic

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
    "no inertia": (model('<link name="a"/>'), "<link name='a'>: lacks <inertia>, in place of"),
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
        "<link name='a'>: unknown frame 'x'; valid: a",
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
    "mimic of none": (
        model(link("a"), joint("J", "revolute", "world", "a",
              "<axis><xyz>0 0 1</xyz><mimic joint='K'/></axis>")),
        "<mimic>: unknown joint 'K'; valid: J",
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", SDF_MISUSE)
def test_misuse_of_sdf_names_line_and_element(what, reading):
    text, words = SDF_MISUSE[what]
    with pytest.raises(errors.ModelFileError, match=re.escape(words)) as error:
        read(reading(text))
    assert re.match(r"model\.sdf: line \d+", str(error.value))


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


MJCF_MISUSE = {
    "another root": ("<robot/>", "line 1, <robot>: expected <mujoco>"),
    "entities": ('<!DOCTYPE mujoco SYSTEM "x"><mujoco/>', "line 1: document types and entities"),
    "gigantic": (
        mjcf('<body><inertial mass="1e300" pos="0 0 0" diaginertia="1 1 1"/></body>'),
        "<inertial>: mass: expected numbers of at most 1e+12, got '1e300'",
    ),
    "what it refuses": (mjcf('<body><joint type="hinge"/></body>'), "MuJoCo refuses it: "),
    "out of the folder": (
        mjcf("", '<asset><mesh name="m" file="../../m.stl"/></asset>'),
        "<mesh name='m'>: file '../../m.stl' leads out of its folder",
    ),
    "absolute": (
        mjcf("", "", 'meshdir="/etc"'),
        "<compiler>: meshdir '/etc' leads out of its folder",
    ),
    "included": (
        mjcf("", '<include file="/etc/passwd"/>'),
        "<include>: file '/etc/passwd' leads out",
    ),
    "no place": (
        mjcf('<body name="a" pos="nan 0 0"><geom size="1"/><joint/></body>'),
        "body 'a': place: expected a finite number of at most 1e+12, got nan",
    ),
    "distance": (
        mjcf(LINKS, '<equality><joint joint1="C" joint2="O" polycoef="0 0 1 0 0"/></equality>'),
        "is not supported: its polynomial is not linear",
    ),
}


@pytest.mark.parametrize("what", MJCF_MISUSE)
def test_misuse_of_mjcf(what, reading):
    pytest.importorskip("mujoco", reason="MuJoCo is not installed")
    text, words = MJCF_MISUSE[what]
    with pytest.raises(errors.ModelFileError, match=re.escape(words)):
        read(reading(text, "robot.xml"))


def test_what_is_included_stays_in_the_folder_too(reading, tmp_path):
    (tmp_path / "more.xml").write_text(
        '<mujocoinclude><include file="../out.xml"/></mujocoinclude>'
    )
    path = reading(mjcf("", '<include file="more.xml"/>'), "robot.xml")
    with pytest.raises(errors.ModelFileError, match=r"file '../out.xml' leads out of its folder"):
        read(path)


def test_without_mujoco_it_is_refused_by_name(reading, monkeypatch):
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(
        errors.MissingPackageError, match="is compiled by MuJoCo: pip install mujoco"
    ):
        read(reading(mjcf(LINKS), "robot.xml"))


def test_a_broken_mujoco_is_refused_by_name(reading, monkeypatch, tmp_path):
    (tmp_path / "mujoco.py").write_text('raise ImportError("its core\\nis missing")\n')
    monkeypatch.delitem(sys.modules, "mujoco", raising=False)
    monkeypatch.syspath_prepend(tmp_path)
    words = "pip install mujoco; it is broken here: its core is missing"
    with pytest.raises(errors.MissingPackageError, match=words):
        read(reading(mjcf(LINKS), "robot.xml"))
