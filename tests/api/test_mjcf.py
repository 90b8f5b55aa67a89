"""Models of MuJoCo: what a file states is read, refused by name, or named in a comment."""

import re

import pytest
from internals import case_of

from lagrange_casadi import Scene, errors, evaluate, read
from lagrange_casadi.motion import harmonic

mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed")
pytestmark = pytest.mark.usefixtures("interpreted")


@pytest.fixture
def reading(tmp_path):
    def written(text, name="robot.xml"):
        path = tmp_path / name
        path.write_text(text)
        return path

    return written


def mjcf(body, after="", compiler=""):
    return (
        f'<mujoco model="robot"><compiler angle="radian" {compiler}/>'
        f"<worldbody>{body}</worldbody>{after}</mujoco>"
    )


HELD = """
<body name="a" pos="0 0 1"><joint name="j1" axis="0 1 0"/>
  <geom type="capsule" size="0.02" fromto="0 0 0 0.5 0 0" mass="1"/></body>
<body name="b" pos="1 0 1"><freejoint/><geom type="box" size="0.1 0.1 0.1" mass="2"/></body>
"""
WELD = '<equality><weld body1="a" body2="b" anchor="-0.5 0.1 0.2" {}/></equality>'
ARM = """
<body name="arm" {} pos="0 0 1"><joint name="j" axis="0 1 0" {}/>
  <geom type="capsule" size="0.02" fromto="0 0 0 0.5 0 0" mass="1"/></body>
"""
WEIGHT = -9.81 * 0.25
ARMS = ARM.format("", ""), ARM.format("", "").replace('"j"', '"k"').replace("arm", "other")
TWO = "".join(ARMS)
READ = {  # the effort at rest, by hand
    "weight of an arm": (mjcf(ARM.format("", "")), "j", WEIGHT),
    "a weld's anchor": (mjcf(HELD, WELD.format("")), "j1", WEIGHT - 2 * 9.81),
    "a weld's anchor and pose": (  # the anchor, at (-0.5, 0.1, 0.2) of b, is at (1, 0, 0) of a
        mjcf(HELD, WELD.format('relpose="1 0 0 1 0 0 0"')), "j1", WEIGHT - 2 * 9.81 * 1.5,
    ),
    "a weld without torque": (
        mjcf(HELD.replace('<freejoint/>', '<joint name="x" axis="1 0 0"/>'),
             WELD.format('torquescale="0" active="false"')), "j1", WEIGHT,
    ),
    "no gravity": (mjcf(ARM.format("", ""), '<option><flag gravity="disable"/></option>'), "j", 0),
    "half of the weight": (mjcf(ARM.format('gravcomp="0.5"', "")), "j", WEIGHT / 2),
    "weight that nothing bears": (
        mjcf(ARM.format('gravcomp="1"', ""),
             '<option><flag spring="disable" damper="disable"/></option>'), "j", WEIGHT,
    ),
    "a spring": (
        mjcf(ARM.format("", 'stiffness="3" springref="0.2" ref="0.5"')), "j", WEIGHT + 3 * 0.3,
    ),
    "no equalities": (
        mjcf(ARM.format("", "") + HELD.replace("<freejoint/>", '<joint name="x" axis="1 0 0"/>'),
             WELD.format("") + '<option><flag equality="disable"/></option>'), "j1", WEIGHT,
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", READ)
def test_what_a_model_states_is_read(what, reading):
    text, joint, effort = READ[what]
    solution = evaluate(read(reading(text)), t=(0, 0, 1))
    assert solution.certified
    assert abs(solution.effort(joint)[0] - effort) < 1e-12 * 40


def test_coordinates_of_coupled_joints_are_counted_from_their_references(reading):
    """MuJoCo couples q - ref: q2 = 0.2 - 2 q1."""
    first, second = (
        part.replace("axis", f'ref="{ref}" axis')
        for part, ref in zip(ARMS, (0.4, -3.5), strict=True)
    )
    pair = '<equality><joint joint1="k" joint2="j" polycoef="0.2 -2 0 0 0"/></equality>'
    scene = read(reading(mjcf(first + second, pair)))
    solution = evaluate(Scene(scene.mechanism, {"j": harmonic(0.3, 0.0, 1.0)}, t=(0, 0, 1)))
    assert abs(solution.motion("k").value[0] + 0.4) < 1e-12


def test_what_is_not_read_is_named(reading):
    joint = 'frictionloss="1" armature="0.1" range="-1 1"'
    motor = '<dcmotor joint="j" motorconst="1" resistance="1" input="pos vel" controller="1 0 1"/>'
    general = '<general joint="j" gainprm="1" biasprm="0 1 1"/>'
    option = '<option density="1000"/>'
    body = f"{ARM.format('', joint)}<body mocap='true'/>"
    for actuator in (motor, general) if hasattr(mujoco.MjModel, "nactuator") else (general,):
        more = f"{option}<actuator>{actuator}</actuator>"
        text = re.sub(r"\n#   ", " ", case_of(reading(mjcf(body, more))))
        for words in (
            *("Friction of joints", "Armature, the inertia of motors at joints"),
            *("Limits of joints", "Actuators, except which joints they drive"),
            *("Motion of mocap bodies", "Forces of a medium (density, viscosity, wind)"),
        ):
            assert f"# {words}: not read." in text
    assert '"j": polynomial(0.0)' in text


def test_every_attribute_that_names_files_is_looked_at():
    """MuJoCo's own list of attributes: of later versions too."""
    found = set(
        re.findall(r"\b\w*(?:file|dir|path|uri|url)\w*", mujoco.mj_printSchema(False, False))
    )
    known = {name for name in found if name.startswith("file")} | {"assetdir", "meshdir"}
    assert found - known == {"texturedir", "dir", "directional", "strippath"}


MJCF_MISUSE = {
    "another root": ("<robot/>", "line 1, <robot>: expected <mujoco>"),
    "entities": ('<!DOCTYPE mujoco SYSTEM "x"><mujoco/>', "line 1: document types and entities"),
    "gigantic": (
        mjcf('<body><inertial mass="1e300" pos="0 0 0" diaginertia="1 1 1"/></body>'),
        "body 'body_1': mass: expected a finite number of at most 1e+12, got 1e+300",
    ),
    **{
        f"{what} of {number}": (
            mjcf(
                f'<body name="a"><joint name="j" axis="{axis} 1 0"/><inertial pos="0 0 0"'
                f' mass="{mass}" diaginertia="{moment} 1 1"/></body>'
            ),
            part,
        )
        for number in ("inf", "nan", "1e+300")
        for what, part, axis, mass, moment in (
            ("mass", "'a'", 0, number, 1),
            ("inertia", "'a'", 0, 1, number),
            ("axis", "'j'", number, 1, 1),
        )
    },
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
        mjcf(TWO, '<equality><joint joint1="k" joint2="j" polycoef="0 0 1 0 0"/></equality>'),
        "equality 'equality_0': is not supported: it does not couple two joints linearly",
    ),
}


@pytest.mark.parametrize("what", MJCF_MISUSE)
def test_misuse_of_mjcf(what, reading):
    text, words = MJCF_MISUSE[what]
    with pytest.raises(errors.ModelFileError, match=re.escape(words)):
        read(reading(text))


def test_what_is_included_stays_in_the_folder_too(reading, tmp_path):
    (tmp_path / "more.xml").write_text(
        '<mujocoinclude><include file="../out.xml"/></mujocoinclude>'
    )
    path = reading(mjcf("", '<include file="more.xml"/>'))
    with pytest.raises(errors.ModelFileError, match=r"file '../out.xml' leads out of its folder"):
        read(path)


def test_without_mujoco_it_is_refused_by_name(reading, monkeypatch):
    missing = reading("raise ModuleNotFoundError()", "mujoco.py")
    monkeypatch.setenv("PYTHONPATH", str(missing.parent))
    with pytest.raises(
        errors.MissingPackageError, match=r"robot.xml: a model .* by MuJoCo: pip install mujoco$"
    ):
        read(reading(mjcf(TWO)))


def test_a_broken_mujoco_is_refused_by_name(reading, monkeypatch):
    broken = reading('raise ImportError("its core\\nis missing")\n', "mujoco.py")
    monkeypatch.setenv("PYTHONPATH", str(broken.parent))
    words = "pip install mujoco; it is broken here: its core is missing"
    with pytest.raises(errors.MissingPackageError, match=words):
        read(reading(mjcf(TWO)))
