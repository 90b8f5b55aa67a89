"""Disc cams: profiles that their followers touch and never cut, forces of closed forms, textbooks'
radii, and what is refused.
"""

import math

import numpy as np
import pytest
from internals import DesignEngine, Status

from lagrange_casadi import LagrangeCasadiError, Mechanism, Scene, curve, evaluate
from lagrange_casadi.elements import disc_cam
from lagrange_casadi.errors import AssemblyError, DeclarationError, PathError
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


def machine(kind, law="cycloidal", h=0.02, base=0.05, offset=0.008, lift=None):
    """A cam that turns steadily, its follower, and a spring; the follower stands on (offset, 0) or
    swings about (0.11, 0.02).
    """
    m, swinging = Mechanism("machine"), kind.startswith("swinging")
    rise = m.parameter("h", h)
    radius = m.parameter("base", base, "m")
    preload = m.parameter("preload", 400.0)
    disc = m.link("disc", length=0.04, mass=1.5, centre=(0, 0), inertia=1e-3)
    main = m.revolute("main", m.ground.at(0.01, -0.02), disc)
    high = 10 * rise if swinging else rise
    parts = [move(high, time=2.0, law=law), dwell(1.0), move(0.0, time=2.0, law=law), dwell()]
    lift = lift or moves(parts, cyclic=True, period=2 * math.pi)
    options = {"flat": True} if "flat" in kind else {"roller": ROLLER} if "roller" in kind else {}
    if swinging:
        side = -1 if kind.endswith("-") else 1
        arm = m.link("arm", length=0.12, mass=MASS)
        lead = m.revolute("lead", m.ground.at(0.12, 0.0), arm)
        m.torque("spring", arm, -side * preload / 20)
        options |= {"side": side} | ({} if "flat" in kind else {"point": arm.tip})
        posture = {"arm": math.pi - 0.4 * side}
    else:
        rod = m.link("rod", length=0.15, mass=MASS)
        lead = m.prismatic(
            "lead", m.ground.at(0.01 + offset, -0.02), rod, axis=(0, 1), angle="90 deg"
        )
        m.force("spring", rod.tip, y=-preload - 8e3 * (m.coordinate(lead) - 0.05))
        posture = {"rod": "90 deg"}
    cam = disc_cam(m, "cam", main, lead, lift, base_radius=radius, width=0.01, **options)
    return cam, Scene(
        m, {"main": polynomial(0.3, OMEGA)}, t=(0, 2 * math.pi / OMEGA, 181), posture=posture
    )


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
    assert solution.effort("main") == pytest.approx(pushed * slope, rel=0, abs=1e-11 * pushed.max())
    assert solution.reaction("main").fy == pytest.approx(pushed + 1.5 * 9.81, rel=1e-11)
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


@pytest.mark.parametrize("kind", ["swinging roller", "swinging flat", "swinging flat -"])
def test_a_swinging_follower_bears_what_free_bodies_say(kind):
    """The pin's reaction and the contact balance the arm, by its poses alone; where the contact is,
    the profile tells.
    """
    cam, scene = machine(kind)
    solution = evaluate(scene, over=("main", 0, "350 deg", 36))
    profile, lead, pose = cam.profile(count=36), solution.motion("lead"), solution.pose("arm")
    turn = solution.motion("main").value
    c, s = np.cos(turn), np.sin(turn)
    contact = np.stack(
        [0.01 + c * profile.x - s * profile.y, -0.02 + s * profile.x + c * profile.y]
    )
    along = np.stack([np.cos(pose.angle), np.sin(pose.angle)])
    pull = np.stack([-along[1], along[0]]) * lead.acceleration - along * lead.rate**2
    side = -1 if kind.endswith("-") else 1
    # What the contact must give: momentum less weight and the pin's reaction.
    push = (
        MASS * 0.06 * pull
        + np.array([[0.0], [MASS * 9.81]])
        - np.stack([solution.reaction("lead").fx, solution.reaction("lead").fy])
    )
    assert np.hypot(*push) == pytest.approx(solution.output("cam_force"), rel=1e-10)
    arm = contact - np.stack([pose.x, pose.y])
    turned = arm[0] * push[1] - arm[1] * push[0] - MASS * 9.81 * 0.06 * along[0] - side * 20.0
    assert turned == pytest.approx(
        MASS * 0.12**2 / 3 * lead.acceleration, abs=1e-9 * np.abs(turned).max() + 1e-9
    )


def test_designs_and_laws_of_curves():
    """Many cams at once, and a lift that is a curve through points."""
    _, scene = machine("roller")
    engine = DesignEngine.of(scene)
    found = engine.evaluate(
        np.array([[0.02, 0.05, 400.0], [0.01, 0.06, 300.0], [0.02, 0.002, 400.0]])
    )
    assert found.status.tolist()[:2] == [Status.OK, Status.OK]
    alone = evaluate(scene, parameters={"h": 0.01, "base": 0.06, "preload": 300.0}, t=scene.t)
    place = [str(quantity) for quantity in engine.quantities].index("output:cam_force")
    assert found.value[1, place] >= alone.output("cam_force").max() * (1 - 1e-12)
    angles = np.linspace(0.0, 2 * np.pi, 61)
    _, other = machine("roller", lift=curve(angles, 0.01 * (1 - np.cos(angles)), periodic=True))
    assert evaluate(other).certified


def test_the_preload_that_holds_the_contact():
    """The contact's force goes with the spring's preload: two evaluations tell which one is just
    enough.
    """
    _, scene = machine("roller", h=0.03)
    low, high = (
        evaluate(scene, parameters={"preload": force}).output("cam_force")
        for force in (-400.0, -300.0)
    )
    assert low.min() < 0.0
    least = float((-low / ((high - low) / 100.0)).max()) - 400.0
    held = evaluate(scene, parameters={"preload": least}).output("cam_force")
    assert held.min() == pytest.approx(0.0, abs=1e-9)


def test_profiles_are_written_for_workshops(here):
    cam, _ = machine("roller")
    profile = cam.profile(count=180)
    profile.save_csv("cam.csv")
    rows = np.loadtxt("cam.csv", delimiter=",", skiprows=1)
    assert rows[:, 1:3] == pytest.approx(np.column_stack([profile.x, profile.y]), rel=1e-15)
    assert (here / "cam.csv").read_text().splitlines()[
        0
    ] == "angle [deg],x [m],y [m],pressure angle [deg],radius [m]"
    profile.save_csv("commas.csv", decimal_comma=True)
    commas = (here / "commas.csv").read_text().replace(";", " ").replace(",", ".")
    np.testing.assert_array_equal(np.loadtxt(commas.splitlines()[1:]), rows)
    with pytest.raises(PathError, match="does not exist"):
        profile.save_csv("nowhere/cam.csv")
    ezdxf = pytest.importorskip("ezdxf")
    profile.save_dxf("cam.dxf")
    (drawn,) = ezdxf.readfile("cam.dxf").modelspace()
    assert drawn.is_closed
    assert np.array(
        [(vertex.dxf.location.x, vertex.dxf.location.y) for vertex in drawn.vertices]
    ) == pytest.approx(1e3 * rows[:, 1:3], abs=1e-5)
    before = (here / "cam.dxf").read_bytes()
    profile.save_dxf("cam.dxf")
    assert (here / "cam.dxf").read_bytes() == before


def test_a_profile_that_cuts_itself_is_told_and_not_written(here):
    cam, _ = machine("flat")
    profile = cam.profile({"base": 0.01})
    assert profile.undercut.any()
    assert (profile.radius[profile.undercut] <= 0.0).all()
    with pytest.raises(
        LagrangeCasadiError,
        match=r"cam 'cam': its profile is undercut at .* deg of the cam, .*; no profile has",
    ):
        profile.save_csv("cam.csv")
    assert not list(here.iterdir())


def test_without_ezdxf_one_line_tells_how_to_get_it(monkeypatch):
    import sys

    cam, _ = machine("roller")
    monkeypatch.setitem(sys.modules, "ezdxf.addons.r12writer", None)
    with pytest.raises(
        LagrangeCasadiError,
        match=r"a DXF needs ezdxf; install it with: pip install 'lagrange_casadi\[dxf\]'",
    ):
        cam.profile().save_dxf("cam.dxf")


def test_radii_that_parameters_make_none_have_no_result():
    _, scene = machine("roller")
    with pytest.raises(AssemblyError):
        evaluate(scene, parameters={"base": -0.05})


SHORT = moves([move(0.02, time=0.5), move(0.0, time=0.5), dwell()], cyclic=True, period=2 * math.pi)


def broken(**options):
    m = Mechanism("m")
    disc, rod = m.link("disc", length=0.1, mass=1.0), m.link("rod", length=0.1, mass=1.0)
    main = m.revolute("main", m.ground, disc)
    lead = m.prismatic("lead", m.ground, rod, axis=(0, 1), angle="90 deg")
    other = m.point_mass("other", 1.0)
    given = {
        "cam": main,
        "follower": lead,
        "lift": lambda x: 0.0 * x,
        "base_radius": 0.05,
        "point": None,
    } | options
    if given["point"] == "other":
        given["point"] = m._load_point("x", other)
    if given["follower"] == "main":
        given["cam"] = lead
        given["follower"] = main
    return disc_cam(m, "cam", given.pop("cam"), given.pop("follower"), given.pop("lift"), **given)


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (
            {"follower": "main"},
            (
                "cam 'cam': expected a revolute joint whose parent is the ground, in a plane, got"
                " 'lead'"
            ),
        ),
        ({"flat": True, "roller": 0.01}, "a flat face has neither a roller nor a point"),
        ({"side": 2}, "side must be 1 or -1, got 2"),
        ({"point": "other"}, "its point must be on 'rod', which joint 'lead' guides"),
        (
            {"lift": lambda x: 0.001 * x},
            "its lift must be the same after a turn of the cam; expected a period of 2 pi",
        ),
        ({"lift": SHORT, "roller": 0.02}, "is undercut at"),
        ({"lift": lambda x: "high"}, "lift cannot be made as an expression of the cam's angle"),
        ({"base_radius": -0.05}, r"base_radius must be positive, got -0\.05 m"),
        ({"roller": 0.0}, r"roller must be positive, got 0 m"),
    ],
)
def test_misuse_is_named(options, says):
    with pytest.raises(DeclarationError, match=says):
        broken(**options)
