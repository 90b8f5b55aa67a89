"""Models of this package come back from their files; what is refused; files that are large, damaged
or hostile.
"""

import json
import random
import re
import subprocess
import sys
from functools import partial
from pathlib import Path

import model_parts
import numpy as np
import pytest
from drawn_models import text_of
from internals import case_of
from mechanisms import pins_of
from model_files import (
    SMALL,
    joint,
    link,
    mjcf,
    sdf,
    sdf_joint,
    sdf_link,
    urdf,
)
from model_parts import (
    BASE,
    FOUR_BAR,
    GEAR,
    MJCF_PLAIN,
    MOVE,
    ONE,
    PENDULUM,
    TENDON,
    WEIGHT,
    P,
    arm,
    assert_same,
    changed,
    efforts,
    moved,
    pendulum,
    wheels,
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
from lagrange_casadi.motion import harmonic, polynomial

pytestmark = pytest.mark.usefixtures("interpreted")

file = model_parts.file


MJCF_PAIR = MJCF_PLAIN + MJCF_PLAIN.replace('"p"', '"k"').replace('"a"', '"other"')


ROD_BODY = {"name": "arm", "mass": 2.0, "rod": [[0, 0, 0], [0.5, 0, 0]]}


HINGE = {"name": "hinge", "kind": "revolute", "parent": "ground", "child": "arm"}


ARM = {"schema": "lagrange_casadi.model", "version": 1, "bodies": [ROD_BODY], "joints": [HINGE]}


def knuckle():
    """Links that meet at a point mass, whose pins have no angle."""
    m = Mechanism("knuckle")
    lengths = {"crank": 0.1, "rod": 0.3, "rocker": 0.25}
    crank, rod, rocker = (m.link(name, length=l, mass=1.0) for name, l in lengths.items())
    pin = m.point_mass("pin", 0.4)
    pins_of(m, O=(m.ground, crank), A=(crank.tip, rod), B=(rod.tip, pin), C=(rocker.tip, pin))
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


BELT = (
    '<coupling name="belt"><predecessor link="a"/><successor link="{}"/><ratio value="2"/>'
    "</coupling>"
)


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
    "comment": ("t # 1", "expected an expression of t"),
    "tower": ("9^9^9^9*t", "'9**9**9' is no number of at most 1e+12"),
    "large": ("1e12*1e12*t", "is no number of at most 1e+12"),
    "by zero": ("t/(2-2)", "'t/(2-2)' is no number"),
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
    "urdf nameless": (urdf("<link/>"), "<link>: lacks name="),
    "urdf belt of the root": (
        arm(P(), BELT.format("base")), "<coupling name='belt'>: link 'base' has no joint"
    ),
    "urdf belt of a train": (
        arm(P(), link("b"), joint("q", "a", "b"), BELT.format("b")),
        "<coupling name='belt'>: is supported only if both its links have the same parent",
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
    "sdf name of the ground": (
        sdf(sdf_link("world")),
        "<link name='world'>: the name is that of the ground; expected another one",
    ),
    "sdf unknown link": (
        sdf(sdf_link("a"), sdf_joint("J", "world", "b")),
        "<child>: unknown link 'b'; valid: world, a",
    ),
    "sdf circle": (
        sdf(POSED.format("f", "g"), POSED.format("g", "f"), sdf_link("a", more=' relative_to="f"')),
        "its pose is relative to itself",
    ),
    "sdf circle of bodies": (
        sdf(POSED.format("f", "a").replace("><", ' attached_to="f"><', 1), sdf_link("a"),
            sdf_joint("J", "world", "f")),
        "<child>: unknown link 'f'; valid: world, a",
    ),
    "sdf no carrier": (
        sdf(sdf_link("a"), sdf_link("b"), sdf_joint("J", "world", "a"), sdf_joint("K", "a", "b"),
            sdf_joint("box", "a", "b", "", "gearbox",
                      "<gearbox_reference_body>world</gearbox_reference_body>")),
        "<joint name='box'>: its child has no joint on the reference body 'world'",
    ),
    "sdf quaternion": (
        sdf(sdf_link("a", more=' rotation_format="quat_xyzw"')),
        "<pose>: rotation_format: expected euler_rpy",
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
    "xml tendon": (
        mjcf(MJCF_PLAIN, more=TENDON + '<equality><tendon tendon1="t"/></equality>'),
        "equality 'equality_0': is not supported; valid: connect, weld, joint",
    ),
    "xml many files": (
        mjcf(more="".join(f'<include file="{k}"/>' for k in range(3001))),
        "names too many files or folders",
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
    "asmt two axes": (
        changed(FOUR_BAR, ("\t0.0\t0.0\t1.0\n", "\n")), "RotationMatrix: expected three"
    ),
    "asmt no part": (
        changed(FOUR_BAR, ("\tPart\n", "\tGroup\n")), "Group: is not supported here; expected a"
    ),
    "asmt order of turns": (
        changed((*FOUR_BAR[:3],
                 {"drive": ("GeneralMotion", "Marker1", "Part3/Marker2", "000", "000")}),
                ("1\t2\t3", "3\t2\t1")),
        "GeneralMotion drive: is supported only with the RotationOrder 1 2 3",
    ),
    "asmt no wheel": (
        changed(wheels("time", (*GEAR[:4], ("radiusJ", 0.0)))),
        "GearJoint tie: a radius of zero is impossible",
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
    "json units": (own_arm(units="mm"), """units: expected "SI", got 'mm'"""),
    "json no body": (own_arm(bodies=[], joints=[]), "has no body that moves"),
    "json no list": (own_arm(notes="one"), "notes: expected a list, got 'one'"),
    "json no object": (own_arm(bodies=["arm"]), "bodies[0]: expected an object, got 'arm'"),
    "json no text": (own_arm(notes=[3]), "notes: expected a text, got 3"),
    "json one place": (
        own_arm(bodies=[ROD_BODY | {"rod": [[0, 0, 0]]}]), "bodies[0].rod: expected two places"
    ),
    "json askew inertia": (
        own_arm(bodies=[{"name": "arm", "mass": 2, "inertia": [[1, 0, 1], [0, 1, 0], [0, 0, 1]]}]
        ),
        "bodies[0].inertia: expected three moments or three rows, symmetric",
    ),
    "json no instants": (
        own_arm(time={"start": 0, "stop": 1, "count": 0}),
        "time.count: expected 1 to 1000000, got 0",
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
    "json lead of no screw": (
        own_arm(joints=[HINGE | {"lead": 0.01}]), "a revolute joint has no lead; only a screw has"
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
    path, case, at = file("urdf", arm(P(), *IMPOSSIBLE)), tmp_path / "case", {"t": (0.0, 0.0, 1)}
    inertia = 0.2 + 0.002 + 0.02 + 3 * 0.1**2
    assert [main(["new", str(case), *more]) for more in (
        ["--from", str(path)], ["--accept-inertias"], ["--from", str(path), "--accept-inertias"]
    )] == [2, 2, 0]  # fmt: skip
    out, err = capfd.readouterr()
    assert "take them as they are by --accept-inertias" in err
    assert "--accept-inertias needs --from FILE of a model" in err
    words = " ".join(out.split())
    end = ": no body has such principal moments of inertia; they are as in the file."
    assert f"{BAD_BODIES[0]}{end} body" in words
    assert f"{BAD_BODIES[1]}{end} The energy of this one may be negative." in words
    for scene in (read(path, accept_inertias=True), load_case(case).scene):
        found = evaluate(Scene(scene.mechanism, MOVE, **at)).effort("p")[0]
        assert found == pytest.approx(inertia + 3 * WEIGHT, rel=1e-12)


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


@pytest.mark.parametrize("seed", range(40))
def test_laws_have_the_values_of_their_texts(seed, file):
    """Python's own, as far as all parts without t are numbers of a machine."""
    text = text_of(random.Random(seed))
    names = {"sin": np.sin, "cos": np.cos, "pi": np.pi}
    for t, found in zip((0.3, 1.7), moved(file, text), strict=True):
        there = eval(text.replace("^", "**"), names | {"t": t})
        assert abs(found - there) < 1e-9 * (abs(there) + 1.0), text


@pytest.mark.parametrize("what", FAR_TERMS)
def test_laws_of_many_terms_come_back(what, file, tmp_path):
    """In the file each term has its pair of parentheses, more than a reader takes: samples."""
    scene = read(file("json", own_arm(motions={"hinge": FAR_TERMS[what]})))
    at = {"t": (0.0, 1.0 if what == "many terms" else 1e-4, 5)}
    save_model(Scene(scene.mechanism, scene.motion, **at), tmp_path / "again.json")
    scenes = (scene, read(tmp_path / "again.json"))
    there, back = (evaluate(one, **at).motion("hinge").value for one in scenes)
    assert_same(back - back[0], there - there[0], 1e-6)


PARTS = [pytest.param(300 * k, marks=pytest.mark.long) for k in range(1, 10)]


@pytest.mark.parametrize("first", [0, *PARTS])
def test_hostile_files_are_read_or_refused(first, tmp_path):
    """In a program of its own, which says a line of whatever is neither."""
    program = [sys.executable, str(TESTS), "drawn_models", str(first), "300" if first else "110"]
    done = subprocess.run(program, cwd=tmp_path, capture_output=True, text=True, timeout=3000)
    said = done.stdout.splitlines()
    assert [line for line in said if not line.isdigit() and line != "accepted"] == []
    assert done.returncode == 0, f"{said[-1:]}: {done.stderr[-300:]}"
    assert said.count("accepted") > 5
