"""From a profile to its follower's motion: closed forms, the way back from every kind of cam,
noise, and what is refused.
"""

import math

import casadi as ca
import numpy as np
import pytest

from lagrange_casadi import Mechanism, Scene, evaluate
from lagrange_casadi.elements import disc_cam, profile_lift, read_profile
from lagrange_casadi.errors import DeclarationError, PathError
from lagrange_casadi.motion import dwell, move, moves, polynomial

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]

ROLLER = 0.012
KINDS = [
    "roller",
    "knife",
    "flat",
    "swinging roller",
    "swinging flat",
    "swinging roller -",
    "swinging flat -",
]


def machine(kind, offset=0.008):
    """A cam on a shaft that is not the origin, its follower, and what its cam is told."""
    m = Mechanism("machine")
    disc = m.link("disc", length=0.04, mass=1.5, centre=(0, 0), inertia=1e-3)
    main = m.revolute("main", m.ground.at(0.01, -0.02), disc.at(0.003, 0.001))
    options = {"flat": True} if "flat" in kind else {"roller": ROLLER} if "roller" in kind else {}
    if kind.startswith("swinging"):
        arm = m.link("arm", length=0.12, mass=0.8)
        lead = m.revolute("lead", m.ground.at(0.12, 0.0), arm)
        options |= {"side": -1 if kind.endswith("-") else 1} | (
            {} if "flat" in kind else {"point": arm.tip}
        )
    else:
        rod = m.link("rod", length=0.15, mass=0.8)
        lead = m.prismatic(
            "lead", m.ground.at(0.01 + offset, -0.02), rod, axis=(0, 1), angle="90 deg"
        )
    return m, main, lead, options


def law(size, name="polynomial_4567"):
    parts = [move(size, time=2.0, law=name), dwell(1.0), move(0.0, time=2.0, law=name), dwell()]
    return moves(parts, cyclic=True, period=2 * math.pi)


def values_of(lift, angles):
    """A lift's values, slopes and bends."""
    x = ca.SX.sym("x")
    rows = [ca.SX(lift(x))]
    rows += [ca.jacobian(rows[-1], x)]
    rows += [ca.jacobian(rows[-1], x)]
    return ca.Function("lift", [x], [ca.densify(ca.vertcat(*rows))])(
        np.asarray(angles)[None]
    ).full()


def circle(radius, eccentric, count, phase=0.0):
    angle = phase + np.arange(count) * math.tau / count
    return np.column_stack([eccentric + radius * np.cos(angle), radius * np.sin(angle)])


@pytest.mark.parametrize("turned", [1, -1])
@pytest.mark.parametrize("offset", [0.0, 0.008])
def test_an_eccentric_disc_lifts_a_roller_as_a_slider_crank(turned, offset):
    """Its centre is a crank's pin, and both radii are the rod."""
    m, main, lead, options = machine("roller", offset)
    radius, e = 0.05, 0.01
    found = profile_lift(m, main, lead, circle(radius, e, 360, 0.3)[::turned], **options)
    angle = np.linspace(-4.0, 9.0, 701)
    height = e * np.sin(angle) + np.sqrt((radius + ROLLER) ** 2 - (e * np.cos(angle) - offset) ** 2)
    least = math.sqrt((radius + ROLLER - e) ** 2 - offset**2)
    assert values_of(found, angle)[0] == pytest.approx(height - least, abs=1e-10)
    assert found.base_radius == pytest.approx(radius - e, abs=1e-10)
    bend = np.gradient(np.gradient(height, angle), angle)[2:-2]
    assert values_of(found, angle)[2, 2:-2] == pytest.approx(bend, abs=2e-5)


def test_an_eccentric_disc_lifts_a_face_by_a_sine():
    m, main, lead, options = machine("flat")
    found = profile_lift(
        m, main, lead, np.vstack([circle(0.05, 0.01, 360), circle(0.05, 0.01, 360)[:1]]), **options
    )
    angle = np.linspace(0.0, 7.0, 301)
    value, slope, bend = values_of(found, angle)
    assert value == pytest.approx(0.01 * (1 + np.sin(angle)), abs=1e-11)
    assert slope == pytest.approx(0.01 * np.cos(angle), abs=1e-8)
    assert bend == pytest.approx(-0.01 * np.sin(angle), abs=1e-6)
    assert found.base_radius == pytest.approx(0.04, abs=1e-12)


@pytest.mark.parametrize("kind", KINDS)
def test_the_way_back_from_a_cam_is_as_exact_as_interpolation(kind):
    """Twice the points have a sixteenth of the error of the lift, an eighth of the slope's, a
    quarter of the bend's.
    """
    m, main, lead, options = machine(kind)
    lift = law(0.2 if kind.startswith("swinging") else 0.02)
    cam = disc_cam(m, "cam", main, lead, lift, base_radius=0.05, **options)
    angles = np.linspace(0.0, math.tau, 2001)
    true = values_of(lift, angles)
    errors = []
    for count in (180, 360):
        profile = cam.profile(count=count)
        found = profile_lift(m, main, lead, np.column_stack([profile.x, profile.y]), **options)
        errors.append(
            np.abs(values_of(found, angles) - true).max(axis=1) / np.abs(true).max(axis=1)
        )
        assert found.base_radius == pytest.approx(0.05, abs=1e-8)
    assert (errors[0] < [8e-7, 4e-5, 4e-3]).all()
    assert (errors[1] < errors[0] / [14, 7, 3.5]).all()


def test_a_drawn_cam_runs_by_its_file(here):
    """The forces of the cam that was declared, from the points that it
    has written for a workshop.
    """
    m, main, lead, options = machine("roller")
    made = disc_cam(m, "cam", main, lead, law(0.02), base_radius=0.05, **options)
    made.profile(count=720).save_csv("cam.csv")
    assert read_profile("cam.csv") == pytest.approx(
        np.column_stack([made.profile().x, made.profile().y]), rel=1e-15
    )

    def forces(lift, base):
        m, main, lead, options = machine("roller")
        disc_cam(
            m,
            "cam",
            main,
            lead,
            lift or profile_lift(m, main, lead, "cam.csv", **options),
            base_radius=base,
            **options,
        )
        scene = Scene(m, {"main": polynomial(0.3, 30.0)}, t=(0, 0.2, 61), posture={"lead": 0.06})
        return evaluate(scene, wanted=["effort", "output"])

    drawn, told = forces(None, 0.05), forces(law(0.02), 0.05)
    assert drawn.effort("main") == pytest.approx(
        told.effort("main"), abs=1e-3 * np.abs(told.effort("main")).max()
    )
    assert drawn.output("cam_force") == pytest.approx(told.output("cam_force"), rel=1e-3)
    assert drawn.output("cam_pressure_angle") == pytest.approx(
        told.output("cam_pressure_angle"), abs=1e-6
    )


def test_smoothing_takes_the_noise_of_a_measurement_out_of_accelerations():
    """A micrometre at every degree: as it is, it makes several times the true acceleration."""
    m, main, lead, options = machine("roller")
    cam = disc_cam(m, "cam", main, lead, law(0.02), base_radius=0.05, **options)
    profile = cam.profile(count=360)
    points = np.column_stack([profile.x, profile.y])
    points *= (
        1 + 1e-6 * np.random.default_rng(5).normal(size=360)[:, None] / np.hypot(*points.T)[:, None]
    )
    angles = np.linspace(0.0, math.tau, 2001)
    true = values_of(law(0.02), angles)
    size = np.abs(true[2]).max()
    off = [
        np.sqrt(
            np.mean(
                (
                    values_of(
                        profile_lift(m, main, lead, points, smoothing=noise, **options), angles
                    )
                    - true
                )
                ** 2,
                axis=1,
            )
        )
        for noise in (0.0, 1e-6)
    ]
    assert off[0][2] > 0.1 * size
    assert off[1][2] < 0.03 * size
    assert off[1][0] < 2e-6


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
    m, main, lead, options = machine(kind, offset=0.03)
    with pytest.raises(DeclarationError, match=says):
        profile_lift(m, main, lead, points, **options)


def test_a_follower_that_is_none_is_told():
    m, main, lead, options = machine("roller")
    with pytest.raises(
        DeclarationError, match="profile: expected a revolute joint whose parent is the ground"
    ):
        profile_lift(m, lead, main, circle(0.05, 0.0, 40), **options)
    with pytest.raises(DeclarationError, match="profile: curve: a smoothing of 1 leaves"):
        profile_lift(m, main, lead, circle(0.05, 0.01, 40), smoothing=1.0, **options)


@pytest.mark.parametrize(
    ("text", "error", "says"),
    [
        (
            "x,z\n1,2\n",
            DeclarationError,
            r"p\.csv, line 1: expected one column 'y', as in x \[mm\], got x, z",
        ),
        (
            "x [in],y\n1,2\n",
            DeclarationError,
            r"p\.csv, line 1: column 'x' cannot be in 'in'; valid: m, mm, um",
        ),
        (
            "# cam\nx,y\n1,2\n1,\n",
            DeclarationError,
            r"p\.csv, line 4: expected a finite number for y, got ''",
        ),
        (
            "x,y\n1,two\n",
            DeclarationError,
            r"p\.csv, line 2: expected a finite number for y, got 'two'",
        ),
        (None, PathError, r"p\.csv: no such file"),
    ],
)
def test_a_file_that_is_no_profile_is_told(here, text, error, says):
    if text is not None:
        (here / "p.csv").write_text(text)
    with pytest.raises(error, match=says):
        read_profile("p.csv")


def test_other_units_and_columns_are_read(here):
    (here / "p.csv").write_text("point;x [mm];y [um]\n1;40,5;-12\n2;-0,25;1e3\n")
    assert read_profile("p.csv").tolist() == [[0.0405, -1.2e-5], [-0.00025, 1e-3]]
