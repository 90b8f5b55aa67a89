"""Disc cams: profiles that followers touch and never cut, forces of closed forms, lifts from
profiles, and what is refused.
"""

from __future__ import annotations

import math
import sys

import numpy as np
import pytest
from derivatives import derivatives

from lagrange_casadi import LagrangeCasadiError, Mechanism, Scene, evaluate, load, save
from lagrange_casadi.elements import disc_cam, profile_lift, read_profile
from lagrange_casadi.errors import DeclarationError, PathError
from lagrange_casadi.motion import dwell, move, moves, polynomial

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]

KINDS = [
    "roller",
    "knife",
    "flat",
    "swinging roller",
    "swinging knife",
    "swinging flat",
    "swinging roller -",
    "swinging flat -",
]
ROLLER, OMEGA, MASS = 0.012, 30.0, 0.8


def guided(kind, offset=0.008, pivot=(0.003, 0.001), lean=0.0):
    """A cam's disc on a shaft that is not the origin, its follower on (offset, 0) or about (0.11,
    0.02) from there, and what its cam is told.
    """
    m = Mechanism("machine")
    disc = m.link("disc", length=0.04, mass=1.5, centre=(0, 0), inertia=1e-3)
    main = m.revolute("main", m.ground.at(0.01, -0.02), disc.at(*pivot))
    options = {"flat": True} if "flat" in kind else {"roller": ROLLER} if "roller" in kind else {}
    if kind.startswith("swinging"):
        arm = m.link("arm", length=0.12, mass=MASS)
        lead = m.revolute("lead", m.ground.at(0.12, 0.0), arm)
        options |= {"side": -1 if kind.endswith("-") else 1}
        options |= {} if "flat" in kind else {"point": arm.tip}
    else:
        rod = m.link("rod", length=0.15, mass=MASS)
        c, s = math.cos(lean), math.sin(lean)
        foot = m.ground.at(0.01 + offset * c, -0.02 + offset * s)
        lead = m.prismatic("lead", foot, rod, axis=(-s, c), angle="90 deg")
    return m, main, lead, options


def rise_and_fall(size, name="polynomial_4567"):
    parts = [move(size, time=2.0, law=name), dwell(1.0), move(0.0, time=2.0, law=name), dwell()]
    return moves(parts, cyclic=True, period=2 * math.pi)


def machine(kind, offset=0.008):
    """A cam that turns steadily, its follower, and a spring."""
    m, main, lead, options = guided(kind, offset, (0.0, 0.0))
    rise, radius = m.parameter("h", 0.02), m.parameter("base", 0.05, "m")
    preload = m.parameter("preload", 400.0)
    if "side" in options:
        side = options["side"]
        m.torque("spring", m.links["arm"], -side * preload / 20)
        posture, rise = {"arm": math.pi - 0.4 * side}, 10 * rise
    else:
        push = -preload - 8e3 * (m.coordinate(lead) - 0.05)
        m.force("spring", m.links["rod"].tip, y=push)
        posture = {"rod": "90 deg"}
    lift = rise_and_fall(rise, "cycloidal")
    cam = disc_cam(m, "cam", main, lead, lift, base_radius=radius, width=0.01, **options)
    law = {"main": polynomial(0.3, OMEGA)}
    return cam, Scene(m, law, t=(0, 2 * math.pi / OMEGA, 181), posture=posture)


@pytest.mark.sampled(7)
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("values", [{}, {"h": 0.015, "base": 0.06}])
def test_followers_touch_their_profile_and_never_cut_it(kind, values):
    """The roller or the face at every angle, on the cam, against all points of the profile."""
    cam, scene = machine(kind)
    profile = cam.profile(values, count=1440)
    solution = evaluate(scene, parameters=values, over=("main", 0, "355 deg", 72))
    assert solution.certified
    turn = solution.motion("main").value
    points = np.stack([profile.x, profile.y])
    lead, body = solution.motion("lead").value, "arm" if kind.startswith("swinging") else "rod"
    pose = solution.pose(body)
    if "flat" in kind:
        # The largest of the points along the face's normal is on the face.
        side = -1 if kind.endswith("-") else 1
        lean = pose.angle + side * np.pi / 2 if body == "arm" else np.full(turn.size, np.pi / 2)
        normal = np.stack([np.cos(lean - turn), np.sin(lean - turn)])
        reach = (pose.x - 0.01) * np.cos(lean) + (pose.y + 0.02) * np.sin(lean)
        assert (normal.T @ points).max(axis=1) == pytest.approx(reach, abs=2e-7)
        return
    x, y = (
        (pose.x + 0.12 * np.cos(pose.angle), pose.y + 0.12 * np.sin(pose.angle))
        if body == "arm"
        else (pose.x, pose.y)
    )
    c, s = np.cos(turn), np.sin(turn)
    centre = np.stack([c * (x - 0.01) + s * (y + 0.02), -s * (x - 0.01) + c * (y + 0.02)])
    gaps = np.hypot(*(points[:, None] - centre[:, :, None])).min(axis=1)
    radius = ROLLER if "roller" in kind else 0.0
    assert gaps == pytest.approx(radius, abs=2e-6 if radius else 1e-4)
    base, rise = values.get("base", 0.05), values.get("h", 0.02) * (10 if body == "arm" else 1)
    assert np.hypot(profile.x, profile.y).min() == pytest.approx(base, abs=1e-9)
    assert np.ptp(lead) == pytest.approx(rise, rel=1e-3)


@pytest.mark.parametrize("offset", [0.0, 0.008, -0.01])
def test_a_roller_follower_is_pressed_as_textbooks_say(offset):
    """Norton, Design of Machinery, 5th edition, equations 8.31 and 8.33: pressure angle, and radius
    of the pitch curve.
    """
    _, scene = machine("roller", offset=offset)
    solution = evaluate(scene)
    lead = solution.motion("lead")
    prime = 0.05 + ROLLER
    height = lead.value
    slope, bend = lead.rate / OMEGA, lead.acceleration / OMEGA**2
    # Here the cam turns counter-clockwise, and the offset is to the right.
    angle = np.arctan((slope - offset) / height)
    assert solution.output("cam_pressure_angle") == pytest.approx(np.abs(angle), abs=1e-12)
    pushed = MASS * (lead.acceleration + 9.81) + 400.0 + 8e3 * (lead.value - 0.05)
    assert solution.output("cam_force") == pytest.approx(pushed / np.cos(angle), rel=1e-11)
    assert solution.reaction("lead").fx == pytest.approx(
        pushed * np.tan(angle), rel=0, abs=1e-10 * pushed.max()
    )
    if not offset:
        away = height
        pitch = (away**2 + slope**2) ** 1.5 / (away**2 + 2 * slope**2 - bend * away)
        assert solution.output("cam_radius") == pytest.approx(pitch - ROLLER, rel=1e-9)
        assert prime == pytest.approx(height.min(), rel=1e-12)


def test_a_flat_follower_is_pressed_beside_its_line():
    """The radius is base + s + s'', and the guide bears the moment of a force that acts s' beside
    the cam's centre.
    """
    _, scene = machine("flat", offset=0.0)
    solution = evaluate(scene)
    lead = solution.motion("lead")
    pushed = MASS * (lead.acceleration + 9.81) + 400.0 + 8e3 * (lead.value - 0.05)
    assert solution.output("cam_force") == pytest.approx(pushed, rel=1e-12)
    assert solution.output("cam_radius") == pytest.approx(
        lead.value + lead.acceleration / OMEGA**2, rel=1e-10
    )
    assert solution.reaction("lead").mz == pytest.approx(
        -pushed * lead.rate / OMEGA, rel=0, abs=1e-10 * pushed.max()
    )
    stiffness = 210e9 / (2 * (1 - 0.3**2))
    hertz = np.sqrt(pushed * stiffness / (math.pi * 0.01 * solution.output("cam_radius")))
    assert solution.output("cam_hertz") == pytest.approx(hertz, rel=1e-11)


def test_profiles_are_written_for_workshops(here, monkeypatch):
    cam, _ = machine("roller")
    profile = cam.profile(count=180)
    profile.save_csv("cam.csv")
    heads = "angle [deg],x [m],y [m],pressure angle [deg],radius [m]"
    assert (here / "cam.csv").read_text().startswith(heads)
    rows = np.loadtxt("cam.csv", delimiter=",", skiprows=1)
    assert rows[:, 1:3] == pytest.approx(np.column_stack([profile.x, profile.y]), rel=1e-15)
    assert read_profile("cam.csv") == pytest.approx(rows[:, 1:3], rel=1e-15)
    profile.save_csv("commas.csv", decimal_comma=True)
    assert read_profile("commas.csv") == pytest.approx(rows[:, 1:3], rel=1e-15)
    with pytest.raises(PathError, match="does not exist"):
        profile.save_csv("nowhere/cam.csv")
    undercut = machine("flat")[0].profile({"base": 0.01})
    with pytest.raises(LagrangeCasadiError, match=r"cam 'cam': its profile is undercut at .* deg"):
        undercut.save_csv("cut.csv")
    ezdxf = pytest.importorskip("ezdxf")
    profile.save_dxf("cam.dxf")
    (drawn,) = ezdxf.readfile("cam.dxf").modelspace()
    places = [(vertex.dxf.location.x, vertex.dxf.location.y) for vertex in drawn.vertices]
    assert np.array(places) == pytest.approx(1e3 * rows[:, 1:3], abs=1e-5)
    monkeypatch.setitem(sys.modules, "ezdxf", None)
    with pytest.raises(LagrangeCasadiError, match="a DXF needs ezdxf; install it with"):
        profile.save_dxf("cam.dxf")


SHORT = moves([move(0.02, time=0.5), move(0.0, time=0.5), dwell()], cyclic=True, period=2 * math.pi)


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (
            {"cam": "lead", "follower": "main"},
            (
                "cam 'cam': expected a revolute joint whose parent is the ground, in a plane, got"
                " 'lead'"
            ),
        ),
        ({"flat": True, "roller": 0.01}, "a flat face has neither a roller nor a point"),
        ({"side": 2}, "side must be 1 or -1, got 2"),
        ({"point": "disc"}, "its point must be on 'rod', which joint 'lead' guides"),
        (
            {"lift": lambda x: 0.001 * x},
            "its lift must be the same after a turn of the cam; expected a period of 2 pi",
        ),
        ({"lift": SHORT, "roller": 0.02}, "is undercut at"),
        ({"lift": lambda x: "high"}, "lift cannot be made as an expression of the cam's angle"),
        ({"base_radius": -0.05}, r"base_radius must be positive, got -0\.05 m"),
        ({"roller": 0.0}, r"roller must be positive, got 0 m"),
        ({"offset": 0.06}, "cannot touch the base circle, because the follower is too short or"),
    ],
)
def test_misuse_is_named(options, says):
    options = {"offset": 0.0, **options}
    m, main, lead, _ = guided("knife", options.pop("offset"), (0.0, 0.0))
    parts = m.joints | m.links
    told = {"cam": main, "follower": lead, "lift": lambda x: 0.0 * x, "base_radius": 0.05}
    told |= {word: parts[x] if isinstance(x, str) else x for word, x in options.items()}
    with pytest.raises(DeclarationError, match=says):
        disc_cam(m, "cam", **told)


def circle(radius, eccentric, count, phase=0.0):
    angle = phase + np.arange(count) * math.tau / count
    return np.column_stack([eccentric + radius * np.cos(angle), radius * np.sin(angle)])


@pytest.mark.parametrize("turned", [1, -1])
@pytest.mark.parametrize(("offset", "lean"), [(0.0, 0.0), (0.008, 0.4)])
def test_an_eccentric_disc_lifts_a_roller_as_a_slider_crank(turned, offset, lean):
    """Its centre is a crank's pin, and both radii are the rod."""
    m, main, lead, options = guided("roller", offset, lean=lean)
    radius, e = 0.05, 0.01
    found = profile_lift(m, main, lead, circle(radius, e, 360, 0.3)[::turned], **options)
    angle = np.linspace(-4.0, 9.0, 701)
    height = e * np.sin(angle - lean) + np.sqrt(
        (radius + ROLLER) ** 2 - (e * np.cos(angle - lean) - offset) ** 2
    )
    least = math.sqrt((radius + ROLLER - e) ** 2 - offset**2)
    assert derivatives(found, angle)[0] == pytest.approx(height - least, abs=1e-10)
    assert found.base_radius == pytest.approx(radius - e, abs=1e-10)
    bend = np.gradient(np.gradient(height, angle), angle)[2:-2]
    assert derivatives(found, angle)[2, 2:-2] == pytest.approx(bend, abs=2e-5)


@pytest.mark.parametrize("kind", KINDS)
def test_the_way_back_from_a_cam_is_as_exact_as_interpolation(kind):
    """Twice the points have a sixteenth of the error of the lift, an eighth of the slope's, a
    quarter of the bend's.
    """
    m, main, lead, options = guided(kind)
    lift = rise_and_fall(0.2 if kind.startswith("swinging") else 0.02)
    cam = disc_cam(m, "cam", main, lead, lift, base_radius=0.05, **options)
    angles = np.linspace(0.0, math.tau, 2001)
    true = derivatives(lift, angles)
    errors = []
    for count in (180, 360):
        profile = cam.profile(count=count)
        found = profile_lift(m, main, lead, np.column_stack([profile.x, profile.y]), **options)
        errors.append(
            np.abs(derivatives(found, angles) - true).max(axis=1) / np.abs(true).max(axis=1)
        )
        assert found.base_radius == pytest.approx(0.05, abs=1e-8)
    assert (errors[0] < [8e-7, 4e-5, 4e-3]).all()
    assert (errors[1] < errors[0] / [14, 7, 3.5]).all()


TURN = np.arange(90) * math.tau / 90


HOLLOW = (0.05 + 0.008 * np.cos(12 * TURN))[:, None] * np.column_stack([np.cos(TURN), np.sin(TURN)])


@pytest.mark.parametrize(
    ("kind", "points", "says"),
    [
        ("roller", circle(0.05, 0.0, 12), "profile: expected at least 16 points, got 12"),
        (
            "roller",
            circle(0.05, 0.0, 40)[:, :1],
            r"profile: expected points \(x, y\), finite numbers, got an array of shape \(40, 1\)",
        ),
        ("roller", circle(math.nan, 0.0, 40), "profile: expected points"),
        ("roller", circle(0.05, 0.0, 15)[[*range(15), 0]], "at least 16 points, got 15"),
        (
            "roller",
            circle(0.05, 0.06, 40),
            r"profile: its points do not enclose the cam's shaft, which is at \(0, 0\)",
        ),
        (
            "roller",
            np.repeat(circle(0.05, 0.0, 40), 2, axis=0),
            "profile: points 1 and the next coincide",
        ),
        (
            "roller",
            HOLLOW,
            (
                r"profile: the follower cannot touch it near its point \d+, counted"
                r" counter-clockwise: the profile is hollow"
            ),
        ),
        ("flat", HOLLOW, r"profile: the follower cannot touch it near its point \d+"),
        (
            "swinging roller",
            circle(0.3, 0.0, 40),
            "profile: the follower does not reach the whole profile: its end can be from",
        ),
        (
            "swinging flat",
            circle(0.2, 0.0, 40),
            "profile: the follower's pivot is .* m from .* shaft, but the profile reaches 0.2 m",
        ),
        ("roller", circle(0.001, 0.0, 40) * 1e-3, "profile: "),
    ],
)
def test_what_is_no_profile_is_told(kind, points, says):
    m, main, lead, options = guided(kind, offset=0.03)
    with pytest.raises(DeclarationError, match=says):
        profile_lift(m, main, lead, points, **options)


@pytest.mark.parametrize(
    ("text", "error", "says"),
    [
        (
            "x,z\n1,2\n",
            DeclarationError,
            r"p\.csv, line 1: expected one column 'y' of x, y, got x, z",
        ),
        (
            "x [in],y\n1,2\n",
            DeclarationError,
            r"p\.csv, line 1: column 'x' is in 'in'; expected a length \[m\]",
        ),
        (
            "# cam\nx,y\n1,2\n1,\n",
            DeclarationError,
            r"p\.csv, line 4, column 'y': expected a finite number, got ''",
        ),
        (
            "x,y\n1,two\n",
            DeclarationError,
            r"p\.csv, line 2, column 'y': expected a finite number, got 'two'",
        ),
        ("x,y\n1,\xe9\n", PathError, r"p\.csv: cannot be read as text"),
        (None, PathError, r"p\.csv: no such file"),
    ],
)
def test_a_file_that_is_no_profile_is_told(here, text, error, says):
    if text is not None:
        (here / "p.csv").write_text(text, encoding="latin-1")
    m, main, lead, options = guided("roller")
    with pytest.raises(error, match=says):
        profile_lift(m, main, lead, "p.csv", **options)


def test_other_units_and_columns_are_read(here):
    (here / "p.csv").write_text("point;x [mm];y [um]\n1;40,5;-12\n2;-0,25;1e3\n")
    assert read_profile("p.csv").tolist() == [[0.0405, -1.2e-5], [-0.00025, 1e-3]]


def test_it_is_said_where_a_follower_lifts_off(tmp_path):
    _, scene = machine("roller")
    kept, loose = (evaluate(scene, parameters={"preload": x}) for x in (400.0, -400.0))
    assert kept.notes == ()
    (note,) = loose.notes
    force = loose.output("cam_force")
    assert note.startswith(
        f"cam 'cam': the follower lifts off at t = {loose.t[force < 0][0]:.6g} s"
    )
    assert f"{force.min():.6g} N at least" in note
    save(loose, tmp_path / "loose.h5")
    assert load(tmp_path / "loose.h5").notes == loose.notes
