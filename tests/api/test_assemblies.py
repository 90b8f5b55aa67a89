"""Assemblies of FreeCAD: numbers of OndselSolver, closed forms, and pairs that are the same."""

import re

import model_parts
import numpy as np
import pytest
from internals import case_of
from model_files import (
    IDENTITY,
    assembly,
    turned,
)
from model_parts import (
    DRIVE,
    FOUR_BAR,
    GEAR,
    ONE,
    ORIGIN,
    PENDULUM,
    SLENDER,
    assert_same,
    changed,
    off,
    pendulum,
    wheels,
)

from lagrange_casadi import evaluate, read

pytestmark = pytest.mark.usefixtures("interpreted")

file = model_parts.file


OUT = turned("y", 90)  # z of a marker is along x


def solved(file, *told, count=None, **more):
    scene = read(file("asmt", assembly(*told, **more)))
    return evaluate(scene) if count is None else evaluate(scene, t=(*scene.span, count))


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


SLIDES = {
    "joints": {"straight": ("TranslationalJoint", "upper/A", "lower/A")},
    "motions": PENDULUM[3] | {"two": ("TranslationalMotion", "straight", "0.1*time^2")},
}


BALL = {"A": ("SphericalJoint", "upper/A", "lower/A")}


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
    "drawn only": (
        changed((*FOUR_BAR, ORIGIN, (0.0, 2.0, 0.5)), ("SimulationParameters", "Parameters"))
        + "TimeSeries\tnone\n", r"t=\(0\.0, 1\.0, 101\)",
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
