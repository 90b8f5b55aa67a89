"""Robots as URDF: the dialects of loops against a mechanism declared by hand, open chains against
Pinocchio where it is installed.
"""

import re
from pathlib import Path

import numpy as np
import pytest
from internals import case_of

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, errors, evaluate, load_case, read
from lagrange_casadi.cli import main
from lagrange_casadi.motion import harmonic, polynomial

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]

LEG = Path(__file__).parents[2] / "cases" / "parallel_leg" / "leg.urdf"


def link(name, mass=1.0, centre="0.1 0 0", inertia="0.001 0.01 0.01"):
    xx, yy, zz = inertia.split()
    moments = f'ixx="{xx}" ixy="0" ixz="0" iyy="{yy}" iyz="0" izz="{zz}"'
    inside = f'<origin xyz="{centre}"/><mass value="{mass}"/><inertia {moments}/>'
    return f'<link name="{name}"><inertial>{inside}</inertial></link>\n'


def joint(name, parent, child, xyz="0 0 0", axis="0 0 1", kind="revolute", more="", rpy="0 0 0"):
    ends = f'<parent link="{parent}"/><child link="{child}"/><origin xyz="{xyz}" rpy="{rpy}"/>'
    return f'<joint name="{name}" type="{kind}">{ends}<axis xyz="{axis}"/>{more}</joint>\n'


def robot(*parts):
    return f'<?xml version="1.0"?>\n<robot name="robot">\n{"".join(parts)}</robot>\n'


@pytest.fixture
def reading(tmp_path):
    def written(*parts):
        path = tmp_path / "robot.urdf"
        path.write_text(robot(*parts))
        return path

    return written


TREE = (
    '<link name="base"/>\n',
    link("crank", 0.5),
    link("coupler", 0.8, "0.2 0 0"),
    link("rocker", 0.7, "0 0.15 0", "0.01 0.001 0.01"),
    joint("O", "base", "crank"),
    joint("A", "crank", "coupler", "0.2 0 0"),
    joint("C", "base", "rocker", "0.6 0 0"),
)
"""A four-bar, its coupler lies along x and misses the rocker's tip in the zero posture."""

CLOSED = {
    "constraint of urdfdom": (
        '<constraint name="B" type="revolute"><parent link="coupler"/>'
        '<parent_origin xyz="0.45 0 0"/><parent_axis xyz="0 0 1"/><child link="rocker"/>'
        '<child_origin xyz="0 0.35 0"/><child_axis xyz="0 0 1"/></constraint>'
    ),
    "loop of URDF+": (
        '<loop name="B" type="continuous"><predecessor link="coupler"><origin xyz="0.45 0 0"/>'
        '</predecessor><successor link="rocker"><origin xyz="0 0.35 0"/></successor>'
        '<axis xyz="0 0 1"/></loop>'
    ),
    "loop joint of Isaac Sim": (
        '<loop_joint name="B" type="spherical"><link1 link="coupler" xyz="0.45 0 0"/>'
        '<link1 link="rocker" xyz="0 0.35 0" rpy="0 0 0"/></loop_joint>'
    ),
    "loop joint with an axis": (
        '<loop_joint name="B" type="revolute"><parent link="coupler"/><child link="rocker"/>'
        '<parent_origin xyz="0.45 0 0"/><child_origin xyz="0 0.35 0"/>'
        '<axis xyz="0 0 1" frame="parent"/></loop_joint>'
    ),
    "ball constraint of Drake": (
        '<drake:ball_constraint><drake:ball_constraint_body_A name="coupler"/>'
        '<drake:ball_constraint_body_B name="rocker"/>'
        '<drake:ball_constraint_p_AP value="0.45 0 0"/>'
        '<drake:ball_constraint_p_BQ value="0 0.35 0"/></drake:ball_constraint>'
    ),
}


def by_hand():
    m = Mechanism("by_hand")
    crank = m.link("crank", length=0.2, mass=0.5, centre=(0.1, 0), inertia=0.01)
    coupler = m.link("coupler", length=0.45, mass=0.8, centre=(0.2, 0), inertia=0.01)
    rocker = m.link("rocker", length=0.35, mass=0.7, centre=(0.15, 0), inertia=0.01)
    m.revolute("O", m.ground, crank)
    m.revolute("A", crank.tip, coupler)
    m.revolute("C", m.ground.at(0.6, 0), rocker)
    m.revolute("B", coupler.tip, rocker.tip)
    m.set_gravity(0.0, 0.0)
    posture = {"rocker": "100 deg", "coupler": "45 deg"}
    return evaluate(Scene(m, {"O": harmonic(0.4, 0.3, 0.5)}, t=(0.0, 1.0, 9), posture=posture))


@pytest.mark.parametrize("dialect", CLOSED)
def test_loops_of_every_dialect_are_the_loop_by_hand(dialect, reading):
    """The loop is open in the zero posture: so a motion near zero needs a rough posture."""
    scene = read(reading(*TREE, CLOSED[dialect]))
    laws, posture = {"O": harmonic(0.4, 0.3, 0.5)}, {"A": 0.5, "C": 0.2}
    solution = evaluate(
        Scene(scene.mechanism, laws, t=(0.0, 1.0, 9), posture=posture, wanted=["effort"])
    )
    assert np.allclose(solution.effort("O"), by_hand().effort("O"), rtol=1e-10, atol=1e-12)


def test_a_second_joint_of_a_link_closes_a_loop(reading):
    tree = [part for part in TREE if 'name="C"' not in part]
    upright = [
        joint("B", "coupler", "rocker", "0.45 0.1 0"),
        joint("C", "base", "rocker", "0.65 0.1 0"),
    ]
    scene = read(reading(*tree, *upright))
    assert evaluate(scene, t=(0.0, 0.0, 1)).certified
    assert {"O", "A", "B", "C"} == set(scene.mechanism.joints)


def test_a_chain_is_the_chain_by_hand(reading):
    """Turned origins, a slide, a frame without mass between links, and one at the end."""
    path = reading(
        '<link name="world"/><link name="flange"/><link name="tool"/>',
        link("upper", 2.0, "0 0 -0.2", "0.03 0.03 0.001"),
        link("fore", 1.0, "0.1 0 0"),
        joint("shoulder", "world", "upper", "0 0 1", "0 1 0"),
        joint("bolted", "upper", "flange", "0 0 -0.4", kind="fixed", rpy="0 0 1.5707963267948966"),
        joint("slide", "flange", "fore", "0 0 0", "1 0 0", "prismatic"),
        joint("end", "fore", "tool", "0.2 0 0", kind="fixed"),
    )
    laws = {"shoulder": harmonic(0.2, 0.5, 1.0), "slide": harmonic(0.1, 0.05, 2.0)}
    one = evaluate(Scene(read(path).mechanism, laws, t=(0.0, 1.0, 7)))
    m = SpatialMechanism("by_hand")
    upper = m.link("upper", length=0.4, mass=2.0, centre=(0, 0, -0.2), inertia=(0.03, 0.03, 0.001))
    fore = m.link("fore", length=0.2, mass=1.0, centre=(0.1, 0, 0), inertia=(0.001, 0.01, 0.01))
    m.revolute("shoulder", m.ground.at(0, 0, 1), upper, axis=(0, 1, 0))
    m.prismatic("slide", upper.at(0, 0, -0.4), fore, axis=(0, 1, 0), turned=((0, 1, 0), (-1, 0, 0)))
    other = evaluate(Scene(m, laws, t=(0.0, 1.0, 7)))
    for name in laws:
        assert np.allclose(one.effort(name), other.effort(name), rtol=1e-12, atol=1e-12)
    for of in ("fx", "fy", "fz", "mx", "my", "mz"):
        there, back = (getattr(solution.reaction("slide"), of) for solution in (other, one))
        assert np.allclose(back, there, rtol=1e-10, atol=1e-12)
    assert "# Frames without mass are left out: flange, tool." in case_of(path)


def test_joints_that_follow_and_drives(reading):
    mimic = '<mimic joint="left" multiplier="-2" offset="0.1"/>'
    parts = (
        '<link name="base"/>',
        link("one"),
        link("two"),
        joint("left", "base", "one", axis="0 1 0"),
        joint("right", "base", "two", "0.5 0 0", "0 1 0", more=mimic),
    )
    path = reading(*parts)
    assert 'm.gear("right_mimic", left, right, ratio=-2.0, offset=0.1)' in case_of(path)
    scene = Scene(read(path).mechanism, {"left": polynomial(0, 0, 1)}, t=(0.0, 1.0, 5))
    solution = evaluate(scene)
    assert np.allclose(solution.motion("right").rate, -2 * solution.motion("left").rate)
    coupling = (
        '<coupling name="belt"><predecessor link="one"/><successor link="two"/><ratio value="-2"/>'
        "</coupling>"
    )
    drive = '<transmission name="t"><joint name="right"/></transmission>'
    path = reading(*parts[:3], parts[3], parts[4].replace(mimic, ""), coupling, drive)
    assert re.search(r'laws = \{\s+"right": polynomial', case_of(path))


def test_the_leg_is_what_is_read_of_its_file():
    """The shipped case is the file's, with motions: the efforts are the same."""
    shipped = load_case("parallel_leg").scene
    told = Scene(read(LEG).mechanism, shipped.motion, t=shipped.t, wanted=["effort"])
    one, other = (evaluate(scene, t=(0.0, 1.0, 5), wanted=["effort"]) for scene in (shipped, told))
    for name in shipped.motion:
        assert np.allclose(one.effort(name), other.effort(name), rtol=1e-12, atol=1e-12)


def drawn(seed):
    """A random chain as URDF."""
    random = np.random.default_rng(seed)
    parts, names = ['<link name="base"/>'], []
    for k in range(int(random.integers(2, 8))):
        above = "base" if k == 0 else f"link{int(random.integers(0, k))}"
        size = random.uniform(0.01, 0.1, 3).tolist()
        xx, yy, zz = size[1] + size[2], size[0] + size[2], size[0] + size[1]
        moments = f'ixx="{xx!r}" iyy="{yy!r}" izz="{zz!r}" ixy="0" ixz="0" iyz="0"'
        place, angles, axis, centre, turn = (
            " ".join(map(repr, map(float, random.uniform(-1, 1, 3)))) for _ in range(5)
        )
        inertial = (
            f'<origin xyz="{centre}" rpy="{turn}"/><mass value="{random.uniform(0.1, 5)!r}"/>'
        )
        parts.append(
            f'<link name="link{k}"><inertial>{inertial}<inertia {moments}/></inertial></link>'
        )
        kind = "prismatic" if random.random() < 0.3 else "revolute"
        limit = '<limit lower="-3" upper="3" effort="1" velocity="1"/>'
        parts.append(joint(f"j{k}", above, f"link{k}", place, axis, kind, limit, angles))
        names.append(f"j{k}")
    laws = {name: tuple(random.uniform(0.2, 1.0, 4)) for name in names}
    return robot(*parts), laws


@pytest.mark.parametrize("seed", range(4))
def test_open_chains_have_the_efforts_of_pinocchio(seed, tmp_path):
    pinocchio = pytest.importorskip("pinocchio", reason="Pinocchio is not installed")
    text, told = drawn(seed)
    path = tmp_path / "chain.urdf"
    path.write_text(text)
    laws = {name: harmonic(*numbers) for name, numbers in told.items()}
    solution = evaluate(Scene(read(path).mechanism, laws, t=(0.0, 1.0, 5), wanted=["effort"]))
    model = pinocchio.buildModelFromXML(text)
    data, found = model.createData(), {name: [] for name in laws}
    for t in solution.t:
        q, v, a = np.zeros((3, model.nv))
        for name, (mean, size, often, ahead) in told.items():
            k, speed = model.joints[model.getJointId(name)].idx_v, 2 * np.pi * often
            s, c = np.sin(speed * t + ahead), np.cos(speed * t + ahead)
            q[k], v[k], a[k] = mean + size * s, size * speed * c, -size * speed**2 * s
        efforts = pinocchio.rnea(model, data, q, v, a)
        for name in laws:
            found[name].append(efforts[model.joints[model.getJointId(name)].idx_v])
    largest = max(np.abs(values).max() for values in found.values())
    for name, values in found.items():
        assert np.abs(solution.effort(name) - values).max() < 1e-10 * largest


BASE = '<link name="base"/>'
MISUSE = {
    "no XML": ("<robot", "line 1: no XML"),
    "document type": (
        '<!DOCTYPE robot [<!ENTITY a "b">]><robot name="&a;"/>',
        "line 1: document types and entities are refused",
    ),
    "another root": ("<sdf/>", "line 1, <sdf>: expected <robot>"),
    "macros": (
        '<robot xmlns:xacro="x"><xacro:arm name="a"/></robot>',
        "line 1, <xacro:arm name='a'>: is a macro of xacro; expand it first: xacro robot.urdf >",
    ),
    "two roots": (robot(BASE, link("a")), "expected one root link, found 'base', 'a'"),
    "no root": (
        robot(link("a"), link("b"), joint("p", "a", "b"), joint("q", "b", "a")),
        "expected one root link, found none: each link is the child of a joint",
    ),
    "an island": (
        robot(BASE, link("a"), link("b"), joint("p", "a", "b"), joint("q", "b", "a")),
        "line 5, <joint name='p'>: its links are not connected to the root",
    ),
    "no link": (robot(), "expected one root link, found no link"),
    "unknown link": (
        robot(BASE, joint("p", "base", "a")),
        "line 3, <joint name='p'>: unknown link 'a'; valid: base",
    ),
    "unknown parent": (
        robot(BASE, joint("p", "world", "base")),
        "line 3, <joint name='p'>: unknown link 'world'; valid: base",
    ),
    "unknown type": (
        robot(BASE, link("a"), joint("p", "base", "a", kind="hinge")),
        "line 4, <joint name='p'>: unknown type 'hinge'; valid: revolute, continuous",
    ),
    "no axis": (
        robot(BASE, link("a"), joint("p", "base", "a", axis="0 0 0")),
        "line 4, <axis>: expected a direction, got zero",
    ),
    "no inertia": (
        robot(BASE, '<link name="a"><inertial><mass value="2"/></inertial></link>\n').replace(
            "</robot>", joint("p", "base", "a") + "</robot>"
        ),
        "line 3, <link name='a'>: body 'a' has a mass of 2 kg and no inertia",
    ),
    "no number": (
        robot(BASE, link("a", "heavy"), joint("p", "base", "a")),
        "<mass>: mass: expected a finite number of at most 1e+12, got 'heavy'",
    ),
    "no damping": (
        robot(BASE, link("a"), joint("p", "base", "a", more='<dynamics damping="much"/>')),
        "line 4, <dynamics>: damping: expected a finite number of at most 1e+12, got 'much'",
    ),
    "an axis that is too short": (
        robot(BASE, link("a"), joint("p", "base", "a", axis="1e-300 0 0")),
        "line 4, <axis>: expected a direction, got zero",
    ),
    "mimic of itself": (
        robot(BASE, link("a"), joint("p", "base", "a", more='<mimic joint="p"/>')),
        "line 4, <mimic>: couples joint 'p' to itself",
    ),
    "twice": (robot(BASE, BASE), "<link name='base'>: the name is taken"),
}


def test_names_of_other_letters_are_told_apart(reading):
    path = reading(BASE, link("手"), link("足"), joint("右", "base", "手"), joint("左", "手", "足"))
    assert evaluate(read(path), t=(0.0, 0.0, 1)).certified
    assert "# 足 in the file" in case_of(path)


@pytest.mark.parametrize("what", MISUSE)
def test_misuse_names_line_and_element(what, tmp_path):
    text, words = MISUSE[what]
    path = tmp_path / "robot.urdf"
    path.write_text(text)
    with pytest.raises(errors.ModelFileError, match=re.escape(words)) as error:
        read(path)
    assert re.match(r"robot\.urdf: line \d+", str(error.value))


def test_a_billion_laughs_are_refused(tmp_path):
    entities = "".join(f'<!ENTITY e{k + 1} "{f"&e{k};" * 10}">' for k in range(20))
    path = tmp_path / "robot.urdf"
    path.write_text(f'<!DOCTYPE r [<!ENTITY e0 "ha">{entities}]><robot name="&e20;"/>')
    with pytest.raises(errors.ModelFileError, match="document types and entities are refused"):
        read(path)


def effort_at(scene, laws, of):
    """The effort of a joint at the start."""
    return float(evaluate(Scene(scene.mechanism, laws, t=(0.0, 0.0, 1))).effort(of)[0])


MOVE, RATE, ACCELERATION = polynomial(0.3, 0.4, 0.5), 0.4, 1.0
ARM = joint("p", "base", "a", axis="0 -1 0")
DRIVES = """<transmission name="t"><joint name="q"/><type>x</type></transmission>
<transmission name="u"><joint name="none"/></transmission>"""
FIXED = "Drives of joints that are fixed or not in the file: q, none."
WEIGHT = 0.1 * 9.81 * np.cos(0.3)  # that of a link of 1 kg at 0.1 m, about its joint
TURN = (0.01 + 0.1**2) * ACCELERATION


@pytest.mark.parametrize(
    ("parts", "effort", "notes"),
    [
        ([ARM], TURN + WEIGHT, []),
        (
            [joint("p", "base", "a", axis="0 -1 0", more='<dynamics damping="2" friction="3"/>')],
            TURN + WEIGHT + 2.0 * RATE,
            ["Not read of joint/dynamics: friction= (p)."],
        ),
        ([ARM, '<gazebo reference="a"><turnGravityOff>1</turnGravityOff></gazebo>'], TURN, []),
        ([ARM, '<gazebo reference="a"><gravity>false</gravity></gazebo>'], TURN, []),
        (
            [ARM, '<link name="f"/>', joint("q", "a", "f", kind="fixed"), DRIVES],
            TURN + WEIGHT,
            [FIXED, "Not read of transmission: type (t)."],
        ),
        (
            [joint("p", "base", "a", axis="0 -1 0", more='<mimic joint="none" offset="1"/>')],
            TURN + WEIGHT,
            ["Joint 'p' follows 'none', which is no joint of the file: it is free."],
        ),
        (
            [ARM, link("lump", 0.5, "0.1 0 0", "0 0 0"), joint("q", "a", "lump", kind="fixed")],
            TURN + 1.5 * WEIGHT + 0.5 * 0.1**2 * ACCELERATION,
            ["body 'lump' has no inertia: its mass is a lump at its centre."],
        ),
    ],
)
def test_what_a_file_says_of_an_arm_is_read_or_noted(parts, effort, notes, reading):
    path = reading(BASE, link("a"), *parts)
    assert effort_at(read(path), {"p": MOVE}, "p") == pytest.approx(effort, rel=1e-13)
    text = case_of(path)
    assert [note for note in notes if f"# {note}" not in text] == []


def test_a_joint_that_follows_a_fixed_one_is_held(reading):
    """It is at its offset, whatever the ratio; the fixed one is a frame, or has a mass."""
    mimic = '<mimic joint="q" multiplier="2" offset="0.2"/>'
    for frame in ('<link name="f"/>', link("f")):
        path = reading(
            BASE, link("a"), ARM, frame, joint("q", "a", "f", kind="fixed"), link("finger"),
            joint("r", "f", "finger", axis="0 -1 0", more=mimic),
        )  # fmt: skip
        assert '"r": polynomial(0.2)' in case_of(path)
        assert "# Joint 'r' follows 'q', which is fixed: it is held at 0.2." in case_of(path)


def test_a_joint_of_gazebo_closes_a_loop(reading):
    """The same four-bar as a loop of URDF+: the joint lies on the child, in the zero posture."""
    parts = [part for part in TREE if 'name="C"' not in part]
    parts.append(joint("C", "base", "rocker", "0.65 0 0"))
    ends = (
        '<predecessor link="coupler"><origin xyz="0.45 0.1 0"/></predecessor>'
        '<successor link="rocker"><origin xyz="0 0.1 0"/></successor>'
    )
    loop = f'<loop name="B" type="continuous">{ends}<axis xyz="0 0 1"/></loop>'
    on_gazebo = (
        '<gazebo><joint name="B" type="revolute"><pose>0 0.1 0 0 0 0</pose><parent>coupler</parent>'
        "<child>rocker</child><axis><xyz>0 0 1</xyz></axis></joint></gazebo>"
    )
    # A coupler that leads off the line to the rocker, so that no link is at its dead centre.
    laws = {"O": harmonic(0.0, 0.2, 0.5)}
    one, other = (
        evaluate(Scene(read(reading(*parts, closed)).mechanism, laws, t=(0.0, 0.3, 4)))
        for closed in (loop, on_gazebo)
    )
    assert one.certified
    assert np.allclose(other.effort("O"), one.effort("O"), rtol=1e-11)


BAD = [
    BASE, link("a"), ARM,
    link("b", 1.0, "0.1 0 0", "0.001 0.002 0.02"), joint("q", "a", "b", kind="fixed"),
    link("c", 1.0, "0.1 0 0", "-0.001 0.02 0.02"), joint("r", "a", "c", kind="fixed"),
]  # fmt: skip


def test_all_impossible_inertias_are_named_and_can_be_accepted(reading, tmp_path, capfd):
    path = reading(*BAD)
    each = (
        "body 'b' (0.001, 0.002, 0.02 kg m^2, of which the last is too large by 0.017)",
        "body 'c' (-0.001, 0.02, 0.02 kg m^2, of which -0.001 is negative)",
    )
    with pytest.raises(errors.ModelFileError) as error:
        read(path)
    assert "; ".join(each) in str(error.value)
    found = effort_at(read(path, accept_inertias=True), {"p": MOVE}, "p")
    inertia = 0.01 + 0.002 + 0.02 + 3 * 0.1**2
    assert found == pytest.approx(inertia * ACCELERATION + 3 * WEIGHT, rel=1e-13)
    case = str(tmp_path / "case")
    assert main(["new", case, "--from", str(path)]) == 2
    assert main(["new", case, "--accept-inertias"]) == 2
    assert main(["new", case, "--from", str(path), "--accept-inertias"]) == 0
    out, err = capfd.readouterr()
    assert "take them as they are by --accept-inertias" in err
    assert "--accept-inertias needs --from FILE" in err
    words = " ".join(out.split())
    end = ": no body has such principal moments of inertia; they are as in the file."
    assert f"{each[0]}{end} body" in words
    assert f"{each[1]}{end} The energy of this one may be negative." in words
    assert effort_at(load_case(case).scene, {"p": MOVE}, "p") == found


@pytest.mark.parametrize("excess", [1e-11, 1e-7, 9e-4])
def test_inertia_that_is_rounded_is_taken_as_it_is(excess, reading):
    """Moments of flat parts, of which a drawing has rounded one."""
    path = reading(BASE, link("a", inertia=f"0.005 0.005 {0.01 * (1 + excess)!r}"),
                   joint("p", "base", "a", axis="0 0 1"))  # fmt: skip
    effort = (0.01 * (1 + excess) + 0.1**2) * ACCELERATION
    assert effort_at(read(path), {"p": MOVE}, "p") == pytest.approx(effort, rel=1e-13)
    assert "which is taken as rounding" in " ".join(case_of(path).split())


def test_a_link_called_ground_is_renamed(reading):
    path = reading(BASE, link("ground"), joint("p", "base", "ground", axis="0 -1 0"))
    assert effort_at(read(path), {"p": MOVE}, "p") == pytest.approx(TURN + WEIGHT, rel=1e-13)
    assert "# ground in the file" in case_of(path)


def test_blank_attributes_are_what_the_format_says(reading):
    turned = ARM.replace('rpy="0 0 0"', 'rpy=""').replace('xyz="0 0 0"', 'xyz=" "')
    path = reading(BASE, link("a").replace('ixy="0"', 'ixy=""'), turned)
    assert effort_at(read(path), {"p": MOVE}, "p") == pytest.approx(TURN + WEIGHT, rel=1e-13)
