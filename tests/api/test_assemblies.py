"""Assemblies of FreeCAD: held against series that OndselSolver wrote, and against closed forms."""

import re

import numpy as np
import pytest
from assembly_file import IDENTITY, assembly, turned
from conftest import CASES
from internals import case_of

from lagrange_casadi import Mechanism, Scene, errors, evaluate, load_case, read
from lagrange_casadi.motion import polynomial

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]

SLENDER = (1e-4, 0.02, 0.02)
OUT = turned("y", 90)  # z of a marker is along x
TURN = {"drive": ("RotationalMotion", "O", "2.0d*pi*time")}


@pytest.fixture
def solved(tmp_path):
    def solve(*told, count=None, **more):
        path = tmp_path / "press.asmt"
        path.write_text(assembly(*told, **more))
        scene = read(path)
        return evaluate(scene) if count is None else evaluate(scene, t=(*scene.span, count))

    return solve


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
    TURN,
)


def test_a_four_bar_has_the_forces_of_the_file(solved):
    """OndselSolver's testapp/fourbar.asmt, series of FXonI, FYonI and TZonI at three instants."""
    solution = solved(*FOUR_BAR)
    at = [10, 37, 80]
    told = {
        "A": (23.558520471336, -8.8478827575929, -4.0487681140884),
        "C": (15.045678148917, -0.14392927908564, 1.0705274917106),
        "drive": (-6.1615311736962, 5.3660632828109, -7.1272231426398),
    }
    assert np.allclose(-solution.reaction("A").fx[at], told["A"], rtol=0, atol=1e-9)
    assert np.allclose(-solution.reaction("C").fy[at], told["C"], rtol=0, atol=1e-9)
    assert np.allclose(-solution.effort("O")[at], told["drive"], rtol=0, atol=1e-9)


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
    TURN,
)


def test_a_rack_and_a_screw_have_the_forces_of_the_file(solved):
    """testapp/rackscrew.asmt; its forces are constant, for its weights are and it does not
    accelerate."""
    solution = solved(*RACK, count=11)
    assert np.allclose(solution.reaction("O").fy, 3.1722351784188, rtol=1e-11)
    assert np.allclose(solution.reaction("guide").fy, 6.7365693408657, rtol=1e-11)
    assert np.allclose(solution.reaction("guide").mx, 0.33682846704328, rtol=1e-11)
    assert np.abs(solution.effort("O")).max() < 1e-10


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


def test_gears_press_on_their_bearings(solved):
    """alpha2 = -alpha1 / 2, the torque on the second wheel is a force at radius r2."""
    gear = ("GearJoint", "one/M", "two/M", ("radiusI", 0.1), ("radiusJ", 0.2))
    solution = solved(*wheels("3.0d*time*time", gear), count=11)
    assert np.allclose(solution.effort("O"), 6.0 * (0.02 + 0.05 / 4), rtol=1e-12)
    tooth = 0.05 * 3.0 / 0.2
    assert np.allclose(solution.reaction("Q").fy, -tooth, rtol=1e-12)
    assert np.allclose(solution.reaction("O").fy, tooth, rtol=1e-12)


@pytest.mark.parametrize(
    ("radius", "place", "words"),
    [
        (0.2, "0.0\t0.0\t7.0", "GearJoint tie: the axes of its two wheels coincide"),
        (1e-90, "0.3\t0.0\t0.0", "GearJoint tie: ratio of radii: expected a finite number"),
    ],
)
def test_gears_that_are_none_are_refused(radius, place, words, tmp_path):
    gear = ("GearJoint", "one/M", "two/M", ("radiusI", 0.1), ("radiusJ", radius))
    text = assembly(*wheels("3.0d*time*time", gear)).replace("0.3\t0.0\t0.0", place)
    (path := tmp_path / "press.asmt").write_text(text)
    with pytest.raises(errors.ModelFileError, match=words):
        read(path)


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


def test_axes_that_stay_at_right_angles_are_hookes_joint(solved):
    """tan(second) = tan(first) / cos(30 deg) or its like: all power goes into the second shaft."""
    solution = solved(*shafts("PerpendicularJoint"), count=41)
    rate = 2.0 * np.cos(np.pi / 6) / (1 - np.sin(np.pi / 6) ** 2 * np.cos(2 * solution.t) ** 2)
    other = 2.0 * np.cos(np.pi / 6) / (1 - np.sin(np.pi / 6) ** 2 * np.sin(2 * solution.t) ** 2)
    found = np.abs(solution.motion("Q").rate)
    assert min(np.abs(found - rate).max(), np.abs(found - other).max()) < 1e-12
    power = 0.05 * solution.motion("Q").rate * solution.motion("Q").acceleration
    assert np.allclose(2.0 * solution.effort("O"), power, rtol=1e-10, atol=1e-12)


def test_a_joint_of_constant_velocity(solved):
    solution = solved(*shafts("ConstantVelocityJoint"), count=11)
    assert np.allclose(np.abs(solution.motion("Q").rate), 2.0, rtol=1e-12)
    assert np.abs(solution.effort("O")).max() < 1e-12


def test_a_distance_is_a_rod_without_mass(solved):
    """A crank and a rocker, between them a distance or a part without mass on two ball joints."""
    crank = (0.5, (0.1, 0.0, 0.0), SLENDER, {"O": (0.0, 0.0, 0.0), "A": (0.2, 0.0, 0.0)})
    rocker = (
        0.8,
        (0.0, 0.2, 0.0),
        SLENDER,
        {"Q": (0.0, 0.0, 0.0), "B": (0.0, 0.5, 0.1)},
        (0.6, 0, 0),
    )
    joints = {"O": ("RevoluteJoint", "P", "crank/O"), "Q": ("RevoluteJoint", "R", "rocker/Q")}
    motions = {"drive": ("RotationalMotion", "O", "4*time")}
    points = {"P": (0.0, 0.0, 0.0), "R": (0.6, 0.0, 0.0)}
    length = float(np.linalg.norm(np.array([0.6, 0.5, 0.1]) - np.array([0.2, 0.0, 0.0])))
    tie = {"rod": ("SphSphJoint", "crank/A", "rocker/B", ("distanceIJ", length))}
    parts = {"crank": crank, "rocker": rocker}
    one = solved(points, parts, joints | tie, motions, count=11)
    rod = (0.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), {"A": (0.2, 0.0, 0.0), "B": (0.6, 0.5, 0.1)})
    balls = {
        "A": ("SphericalJoint", "crank/A", "rod/A"),
        "B": ("SphericalJoint", "rod/B", "rocker/B"),
    }
    other = solved(points, parts | {"rod": rod}, joints | balls, motions, count=11)
    assert np.allclose(one.effort("O"), other.effort("O"), rtol=1e-10)
    assert np.allclose(one.reaction("Q").fz, other.reaction("Q").fz, rtol=1e-9, atol=1e-10)


def test_a_body_that_ties_alone_hold_is_free_but_for_them(solved):
    """A slider on no joint: in two planes, without rotation; moved by a crank and a distance."""
    crank = (0.5, (0.1, 0.0, 0.0), SLENDER, {"O": (0.0, 0.0, 0.0), "A": (0.2, 0.0, 0.0)})
    block = (2.0, (0.0, 0.0, 0.0), (0.01, 0.01, 0.01), {"M": (0.0, 0.0, 0.0)}, (0.7, 0.1, 0.0))
    length = float(np.hypot(0.5, 0.1))
    points = {"P": (0.0, 0.0, 0.0), "G": ((0.0, 0.1, 0.0), OUT), "H": (0.0, 0.1, 0.0)}
    joints = {"O": ("RevoluteJoint", "P", "crank/O")}
    distance = {"rod": ("SphSphJoint", "crank/A", "block/M", ("distanceIJ", length))}
    ties = {
        "flat": ("PointInPlaneJoint", "H", "block/M"),
        "straight": ("NoRotationJoint", "H", "block/M"),
        "height": ("PointInPlaneJoint", "Up", "block/M", ("offset", 0.1)),
    }
    points |= {"Up": ((0.0, 0.0, 0.0), turned("x", -90))}
    guide = {"guide": ("TranslationalJoint", "G", "block/G")}
    motions = {"drive": ("RotationalMotion", "O", "4*time")}
    span = (0.0, 0.3, 0.1)
    one = solved(
        points, {"crank": crank, "block": block}, joints | distance | ties, motions, span=span
    )
    guided = (*block[:3], {"M": (0.0, 0.0, 0.0), "G": ((0.0, 0.0, 0.0), OUT)}, block[4])
    other = solved(
        points, {"crank": crank, "block": guided}, joints | distance | guide, motions, span=span
    )
    assert np.allclose(one.effort("O"), other.effort("O"), rtol=1e-10)


PENDULUM = (
    {"G": (0.0, 0.0, 0.0)},
    {
        "upper": (0.5, (0.1, 0.0, 0.0), SLENDER, {"O": (0.0, 0.0, 0.0), "A": (0.2, 0.0, 0.0)}),
        "lower": (0.8, (0.2, 0.0, 0.0), SLENDER, {"A": (0.0, 0.0, 0.0)}, (0.2, 0.0, 0.0)),
    },
    {"O": ("RevoluteJoint", "G", "upper/O"), "A": ("RevoluteJoint", "upper/A", "lower/A")},
    {"one": ("RotationalMotion", "O", "2*time"), "two": ("RotationalMotion", "A", "time^2")},
)


def pendulum(solved, **lower):
    """Efforts at O and A, if the lower part, its marker or its place are other ones."""
    points, parts, joints, motions = PENDULUM
    mass, centre, moments, marks, place = parts["lower"]
    marks = {"A": lower.get("mark", marks["A"])}
    own = (mass, centre, moments, marks, *lower.get("place", (place,)))
    solution = solved(points, parts | {"lower": own}, joints, motions, count=7)
    return np.array([solution.effort(name) for name in joints])


def test_axes_of_markers_may_point_against_each_other(solved):
    """OndselSolver holds axes at right angles: z of one marker may be opposite to the other's."""
    there, back = pendulum(solved), pendulum(solved, mark=((0.0, 0.0, 0.0), turned("x", 180)))
    assert np.allclose(back, there, rtol=1e-12, atol=1e-14)
    points, parts, joints, motions = PENDULUM
    guides = {"straight": ("TranslationalJoint", "upper/A", "lower/A")}
    slide = {"one": motions["one"], "two": ("TranslationalMotion", "straight", "0.1*time^2")}
    one = solved(points, parts, {"O": joints["O"]} | guides, slide, count=5)
    lower = (*parts["lower"][:3], {"A": ((0.0, 0.0, 0.0), turned("z", 180))}, parts["lower"][4])
    other = (points, parts | {"lower": lower}, {"O": joints["O"]} | guides, slide)
    assert np.allclose(solved(*other, count=5).effort("O"), one.effort("O"), rtol=1e-12, atol=1e-14)


def test_a_part_whose_joints_are_all_open_is_moved(solved, tmp_path):
    """A drawing that is not assembled: the part keeps its angle, and a comment says so."""
    there = pendulum(solved)
    assert np.allclose(pendulum(solved, place=((0.5, 0.3, -0.2),)), there, rtol=1e-12, atol=1e-14)
    assert "# body 'lower' is moved so that joint 'A' is closed" in case_of(tmp_path / "press.asmt")
    tilted = (0.5, 0.3, -0.2), turned("x", 40)
    assert np.allclose(pendulum(solved, place=tilted), there, rtol=1e-12, atol=1e-14)


def test_a_loop_that_is_open_at_the_ground(solved):
    """The last joint's marker J is on the ground, 1 cm off: the loop closes in another posture."""
    points, parts, joints, motions = FOUR_BAR
    moved = points | {"Marker1": (2.01, 0.0, 0.0)}
    posture = solved(moved, parts, joints, motions, count=5)
    other = {**joints, "C": ("RevoluteJoint", "Marker1", "Part3/Marker2")}
    assert posture.certified
    assert np.allclose(
        posture.effort("O"), solved(moved, parts, other, motions, count=5).effort("O"), rtol=1e-10
    )


def test_a_drawing_that_is_far_from_assembled(solved, tmp_path):
    """Every part of the four-bar lies elsewhere, turned: the assembled one has the same efforts."""
    points, parts, joints, motions = FOUR_BAR
    away = {"Part1": (0.02, -0.03, 0.05), "Part2": (0.1, 0.2, -0.1), "Part3": (-0.1, 0.1, 0.2)}
    scattered = {}
    for name, (*told, place, rows) in ((one, (*part, IDENTITY)[:6]) for one, part in parts.items()):
        turn = np.array(turned("x", 5)) @ np.array(rows)
        moved = tuple(a + b for a, b in zip(place, away[name], strict=True))
        scattered[name] = (*told, moved, tuple(map(tuple, turn.tolist())))
    there = solved(points, parts, joints, motions, count=5)
    back = solved(points, scattered, joints, motions, count=5)
    assert back.certified
    assert np.allclose(back.effort("O"), there.effort("O"), rtol=1e-10, atol=1e-10)
    text = case_of(tmp_path / "press.asmt").replace("\n#  ", "")
    assert re.search(
        r"# joint '\w' is open by \d\.\d+ m and \S+ rad in the drawing: parts are", text
    )


@pytest.mark.parametrize("kind", ["SphSphJoint", "CylSphJoint", "RevCylJoint", "RevRevJoint"])
def test_distances_are_closed_in_a_drawing(kind, solved):
    """Of OndselSolver's testapp/SphSphJt.asmt and its like: a part is 60 m off, and is to be 2 m
    off: in space, or across z; with two revolute axes also in one plane.
    """
    near = np.array([-26.0, 7.0, 11.0])
    part = (1.0, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), {"M": (0.0, 0.0, 0.0)}, (58.0, 25.0, 23.0))
    joints = {"tie": (kind, "G", "part/M", ("distanceIJ", 2.0))}
    pose = solved({"G": tuple(near)}, {"part": part}, joints, {}, count=2).pose("part")
    x, y, z = np.array([pose.x[0], pose.y[0], pose.z[0]]) - near
    assert np.hypot(np.hypot(x, y), z if kind == "SphSphJoint" else 0.0) == pytest.approx(2.0)
    assert (abs(z) < 1e-12) == (kind == "RevRevJoint")


def test_an_angle_between_axes_that_are_parallel_in_a_drawing(solved):
    """The cosine of the angle has no slope there."""
    part = (1.0, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), {"M": (0.0, 0.0, 0.0)}, (5.0, 2.0, 1.0))
    joints = {"tie": ("AngleJoint", "G", "part/M", ("theIzJz", float(np.radians(10.0))))}
    solution = solved({"G": (0.0, 0.0, 0.0)}, {"part": part}, joints, {}, count=2)
    assert solution.certified


def test_parts_that_cannot_be_assembled(tmp_path):
    """The second part's pivot is at most 0.2 m from the first one's: 5 m are too much."""
    points, parts, joints, motions = PENDULUM
    far = {"rod": ("SphSphJoint", "G", "lower/A", ("distanceIJ", 5.0))}
    path = tmp_path / "press.asmt"
    path.write_text(assembly(points, parts, joints | far, {"one": motions["one"]}))
    words = (
        r"press\.asmt: line \d+, SphSphJoint rod: joint 'rod' is open by 4\.8 m and 0 rad in the"
        r" drawing, and by \d.* if parts are moved to close all joints: assemble them first"
    )
    with pytest.raises(errors.ModelFileError, match=words):
        read(path)


def test_long_names_of_ties(solved):
    """The lines of a case are broken where they are long, and are the same Python."""
    long = "wheel_with_a_name_that_does_not_fit_into_one_line_of_the_case_with_all_its_arguments"
    points, parts, joints, motions, gravity = wheels(
        "3*time", ("GearJoint", f"{long}/M", "two/M", ("radiusI", 0.1), ("radiusJ", 0.2))
    )
    parts = {long: parts["one"], "two": parts["two"]}
    joints |= {"O": ("RevoluteJoint", "A", f"{long}/M")}
    assert solved(points, parts, joints, motions, gravity, count=3).certified


def test_parallel_axes_are_an_angle_of_zero(solved):
    """The cosine of no angle has no slope: one equation is two."""
    points, parts, joints, motions = PENDULUM
    joints = {"O": joints["O"], "A": ("SphericalJoint", "upper/A", "lower/A")}
    angle = {"flat": ("AngleJoint", "G", "lower/A", ("theIzJz", 0.0))}
    motions = {"one": motions["one"]}
    one = solved(points, parts, joints | angle, motions, count=3)
    parallel = {"flat": ("ParallelAxesJoint", "G", "lower/A")}
    other = solved(points, parts, joints | parallel, motions, count=3)
    assert np.allclose(one.effort("O"), other.effort("O"), rtol=1e-12)


def test_a_general_motion(solved):
    """Of the mass's marker: the force is mass times acceleration, less the weight."""
    part = (2.0, (0.1, 0.2, 0.3), (0.01, 0.02, 0.03), {})
    place = ("0.1 + 0.2*sin(3*time)", "0.2", '"a line"<n>0.3 +<n>time^2')
    motion = ("GeneralMotion", "G", "box/MassMarker", place, ("0", "0", "0.5*time^2"))
    solution = solved({"G": (0.0, 0.0, 0.0)}, {"box": part}, {}, {"fly": motion}, count=7)
    along = -2.0 * 1.8 * np.sin(3 * solution.t)
    assert np.allclose(solution.effort("fly:slide_1"), along, rtol=1e-12, atol=1e-12)
    assert np.allclose(solution.effort("fly:slide_2"), 2.0 * 9.81, rtol=1e-12)
    assert np.allclose(solution.effort("fly:slide_3"), 2.0 * 2.0, rtol=1e-12)
    assert np.allclose(solution.effort("fly:turn_3"), 0.03, rtol=1e-12)


def test_joints_without_a_name_and_a_drawing_without_a_duration(tmp_path):
    told = [("\t\t\t\t\tA\n", "\t\t\t\t\t\n"), ("\t\t\t\t\tB\n", "\t\t\t\t\t\n")]
    told += [("\t\t\t1.0\n\t\thout", "\t\t\t0.0\n\t\thout")]
    allow = "\t\tMotions\n\t\t\tAllowRotation\n\t\t\t\tName\n\t\t\t\t\tFree\n"
    told += [("\t\tMotions\n", allow)]
    path = tmp_path / "press.asmt"
    path.write_text(refusal(FOUR_BAR, *told))
    text = case_of(path)
    assert len(re.findall(r'"RevoluteJoint_\d+"', text)) == 2
    assert "t=(0.0, 1.0, 101)" in text
    assert re.search(r"# AllowRotation of line \d+ is ignored\.", text)
    assert evaluate(read(path), t=(0.0, 1.0, 3)).certified


def refusal(told, *replaced):
    text = assembly(*told)
    for old, new in replaced:
        assert old in text
        text = text.replace(old, new, 1)
    return text


MISUSE = {
    "another file": (("OndselSolver", "solid"), "line 1: expected the first line of an assembly"),
    "no parts": (("ConstantGravity", "Gravity"), "line 2, Assembly: lacks ConstantGravity"),
    "unknown joint": (
        ("RevoluteJoint", "CurveCurveContact"),
        "CurveCurveContact O: is not supported",
    ),
    "unknown marker": (
        ("/Press/Part1/Marker2", "/Press/Part9/M"),
        "unknown marker '/Press/Part9/M'",
    ),
    "unknown motion": (
        ("RotationalMotion", "CyclicMotion"),
        "CyclicMotion drive: is not supported; valid: RotationalMotion, TranslationalMotion, Gen",
    ),
    "motion of none": (
        ("/Press/O\n", "/Press/Z\n"),
        "RotationalMotion drive: unknown joint '/Press/Z'",
    ),
    "law": (("2.0d*pi*time", "spline(time)"), "'spline(time)' is not supported; valid: numbers"),
    "rotation": (
        ("0.0\t1.0\t0.0", "0.0\t1.0\t0.5"),
        "RotationMatrix: axes: expected three directions",
    ),
    "mass": (("\t\t\t\t\t0.2\n", "\t\t\t\t\t-0.2\n"), "body 'Part1': a mass of -0.2 kg is imp"),
    "number": (
        ("\t0.2\n", "\t1e99\n"),
        "Mass: expected a finite number of at most 1e+12, got '1e99'",
    ),
    "tabs": (("\tParts", "\t\t\t\t\t\t\tParts"), "has more tabs than the lines above it allow"),
}


@pytest.mark.parametrize("what", MISUSE)
def test_misuse_names_line_and_element(what, tmp_path):
    replaced, words = MISUSE[what]
    path = tmp_path / "press.asmt"
    path.write_text(refusal(FOUR_BAR, replaced))
    with pytest.raises(errors.ModelFileError, match=re.escape(words)) as error:
        read(path)
    assert re.match(r"press\.asmt: line \d+", str(error.value))


def test_what_is_not_read_is_said(tmp_path):
    path = tmp_path / "press.asmt"
    path.write_text(refusal(FOUR_BAR, ("\tForceTorques", "\tForceTorques\n\t\tForceTorqueInLine")))
    assert re.search(r"# ForceTorqueInLine of line \d+ is ignored\.", case_of(path))


def test_markers_that_a_drawing_has_rounded(tmp_path):
    """Off by 1e-8: taken for one place, and said."""
    path = tmp_path / "press.asmt"
    path.write_text(refusal(FOUR_BAR, ("2.0\t0.0\t0.0", "2.00000001\t0.0\t0.0")))
    assert "joint 'C': its two frames differ by 1.0e-08 m" in case_of(path).replace("\n#  ", "")
    assert evaluate(read(path), t=(0.0, 1.0, 3)).certified


def test_axes_that_a_drawing_has_rounded(tmp_path):
    """Off by 5e-7, as numbers of six digits are: set at right angles, and said."""
    path = tmp_path / "press.asmt"
    path.write_text(refusal(FOUR_BAR, ("0.0\t1.0\t0.0", "0.0\t1.0\t5e-07")))
    text = case_of(path).replace("\n#  ", "")
    assert re.search(r"off right angles by 2\.5e-07 \(at line \d+, RotationMatrix\) or less", text)


def test_the_press_is_the_one_by_hand():
    """The shipped case, and its file, against a declaration in the plane."""
    m = Mechanism("by_hand")
    length = 0.22
    crank = m.link("crank", length=0.04, mass=1.6, centre=(0.012, 0.0), inertia=1.6 / 12 * 0.0117)
    rod = m.link("rod", length=length, mass=0.9, centre=(0.1, 0.0), inertia=0.9 / 12 * 0.0585)
    ram = m.link("ram", length=0.1, mass=6.5, centre=(0.05, 0.0), inertia=0.01)
    m.revolute("O", m.ground, crank)
    m.revolute("A", crank.tip, rod)
    m.revolute("B", rod.tip, ram)
    m.prismatic("guide", m.ground, ram, axis=(0.0, -1.0), angle="-90 deg")
    m.force("work", ram.tip, y=900.0)
    turning = {"O": polynomial(0.0, 8 * np.pi)}
    by_hand = Scene(m, turning, t=(0.0, 0.25, 11), posture={"rod": "-100 deg"}, wanted=["effort"])
    shipped = load_case("cad_press").scene
    found = evaluate(shipped, t=(0.0, 0.25, 11), wanted=["effort"]).effort("Bearing")
    assert np.allclose(found, evaluate(by_hand).effort("O"), rtol=1e-11, atol=1e-11)
    told = read(CASES / "cad_press" / "press.asmt")
    weight = evaluate(told, t=(0.0, 0.25, 11), wanted=["effort"]).effort("Bearing")
    moved = 900.0 * evaluate(told, t=(0.0, 0.25, 11)).motion("Guide").rate / (8 * np.pi)
    assert np.allclose(found, weight - moved, rtol=1e-10, atol=1e-10)
