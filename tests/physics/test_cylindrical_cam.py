"""Cylindrical cams: forces of closed forms on bodies cut free, the groove that the roller leaves,
and what is refused.
"""

from __future__ import annotations

import math

import casadi as ca
import numpy as np
import pytest
from derivatives import derivatives

from lagrange_casadi import Scene, SpatialMechanism, evaluate
from lagrange_casadi.elements import cylindrical_cam
from lagrange_casadi.errors import DeclarationError
from lagrange_casadi.motion import dwell, move, moves, polynomial

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]

RADIUS, OMEGA, MASS, DRUM, G = 0.06, 25.0, 0.9, 3.0, 9.81
C, S = math.cos(math.radians(70.0)), math.sin(math.radians(70.0))
AXES = np.array([[C, S, 0.0], [-S, C, 0.0], [0.0, 0.0, 1.0]])
"""What turns a vector into the carriage's axes."""

ARM = AXES @ [-(0.15 - RADIUS), 0.0, 0.03]
"""The roller of the carriage, in its axes."""


def law(size):
    parts = [
        move(size, time=2.0, law="modified_sine"),
        dwell(0.8),
        move(0.0, time=2.4, law="polynomial_345"),
        dwell(),
    ]
    return moves(parts, cyclic=True, period=2 * math.pi)


def sliding(axis=(0.0, 0.0, 1.0), lift=None, across=(1.0, 0.0, 0.0), **more):
    """A drum about an axis through (0.1, 0.2, 0.3), and a carriage beside it that slides along
    that.
    """
    m = SpatialMechanism("sliding")
    h = m.parameter("h", 0.05, "m")
    u, r = np.array(axis), np.array(across)
    drum = m.link(
        "drum", length=0.2, mass=DRUM, centre=(0.02, 0.0, 0.01), inertia=(6e-3, 7e-3, 8e-3)
    )
    cart = m.link(
        "cart", length=0.1, mass=MASS, centre=(0.01, 0.02, 0.03), inertia=(1e-3, 2e-3, 3e-3)
    )
    centre = np.array([0.1, 0.2, 0.3])
    main = m.revolute(
        "main",
        m.ground.at(*centre),
        drum.at(0.0, 0.0, 0.04),
        axis=axis,
        turned=[("x", "40 deg"), ("y", "25 deg")],
    )
    lead = m.prismatic(
        "lead",
        m.ground.at(*(centre + 0.15 * r + 0.02 * u)),
        cart,
        axis=axis,
        turned=[("z", "70 deg")],
    )
    arm = AXES @ (-(0.15 - RADIUS) * r + 0.03 * u)
    cam = cylindrical_cam(
        m, "cam", main, lead, lift or law(h), start=0.01, point=cart.at(*arm), **more
    )
    return cam, Scene(
        m, {"main": polynomial(0.2, OMEGA, 3.0)}, t=(0, 0.24, 61), posture={"lead": 0.02}
    )


ROLLER, WIDTH, YOUNG, POISSON = 0.01, 0.012, 180e9, 0.28
GROOVE = {"roller": ROLLER, "width": WIDTH}
TILTED = tuple(np.array([1.0, 2.0, 2.0]) / 3), tuple(np.array([2.0, 1.0, -2.0]) / 3)


@pytest.mark.parametrize(("axis", "across"), [((0.0, 0.0, 1.0), (1.0, 0.0, 0.0)), TILTED])
def test_a_carriage_is_pressed_as_textbooks_say(axis, across):
    """Norton: tan(pressure angle) = s'/R; the force is that of inertia and
    weight over its cosine.
    """
    _, scene = sliding(axis, across=across)
    solution = evaluate(scene)
    assert solution.certified
    lead, main = solution.motion("lead"), solution.motion("main")
    value, slope, bend = derivatives(law(0.05), main.value)
    assert lead.value == pytest.approx(0.01 + value, abs=1e-13)
    assert lead.acceleration == pytest.approx(
        bend * main.rate**2 + slope * main.acceleration, abs=1e-9
    )
    lean = np.arctan(slope / RADIUS)
    assert solution.output("cam_pressure_angle") == pytest.approx(np.abs(lean), abs=1e-7)
    force = solution.output("cam_force")
    along = MASS * (lead.acceleration + G * axis[2])
    assert force * np.cos(lean) == pytest.approx(along, abs=1e-10 * np.abs(along).max())


def swinging(side=1.0):
    """A drum about x, and an arm above it that swings about z; its roller goes round a circle
    beside the drum's line.
    """
    m = SpatialMechanism("swinging")
    swing = m.parameter("swing", 0.5, "rad")
    drum = m.link("drum", length=0.2, mass=DRUM, centre=(0.0, 0.0, 0.0), inertia=(6e-3, 7e-3, 7e-3))
    arm = m.link(
        "arm", length=0.12, mass=MASS, centre=(0.05, 0.0, 0.01), inertia=(1e-4, 1e-3, 1e-3)
    )
    main = m.revolute("main", m.ground, drum, axis=(1, 0, 0))
    lead = m.revolute(
        "lead",
        m.ground.at(0.1, 0.12 * side, RADIUS),
        arm,
        axis=(0, 0, 1),
        turned=[("z", f"{-90 * side} deg")],
    )
    cam = cylindrical_cam(m, "cam", main, lead, law(swing), start=-0.25, point=arm.tip)
    return cam, Scene(
        m, {"main": polynomial(0.2, OMEGA)}, t=(0, 2 * math.pi / OMEGA, 61), posture={"lead": -0.2}
    )


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_an_arm_is_pressed_across_the_way_of_its_roller_on_the_drum(side):
    """The contact, which with the pin's reaction moves the arm, is across the groove, and across
    the roller's axis.
    """
    _, scene = swinging(side)
    solution = evaluate(scene)
    assert solution.certified
    lead, turn = solution.motion("lead"), solution.motion("main").value
    value, slope, _ = derivatives(law(0.5), turn)
    assert lead.value == pytest.approx(value - 0.25, abs=1e-12)
    angle = lead.value - side * math.pi / 2
    zero = np.zeros_like(angle)
    along = np.stack([np.cos(angle), np.sin(angle), zero])
    over = np.stack([-np.sin(angle), np.cos(angle), zero])
    roller = np.array([[0.1], [0.12 * side], [RADIUS]]) + 0.12 * along
    passing = 0.12 * slope * over - np.cross([1.0, 0.0, 0.0], roller, axis=0)
    bearing = solution.reaction("lead")
    held = np.stack([bearing.fx, bearing.fy, bearing.fz])
    momentum = MASS * (
        0.05 * (lead.acceleration * over - lead.rate**2 * along) + np.array([[0.0], [0.0], [G]])
    )
    push = momentum - held
    force, size = solution.output("cam_force"), np.abs(held).max()
    assert np.abs(force) == pytest.approx(np.linalg.norm(push, axis=0), abs=1e-9 * size)
    assert push[2] == pytest.approx(zero, abs=1e-9 * size)
    assert (push * passing).sum(axis=0) == pytest.approx(zero, abs=1e-9 * size)
    pressed = np.abs(force) > 1e-3 * size
    assert (np.sign((push * over).sum(axis=0)) == np.sign(force))[pressed].all()
    cosine = (np.abs((push * over).sum(axis=0)) / np.maximum(np.abs(force), 1e-30))[pressed]
    assert np.cos(solution.output("cam_pressure_angle"))[pressed] == pytest.approx(cosine, rel=1e-9)


@pytest.mark.parametrize("machine", [sliding, swinging])
def test_the_groove_is_the_way_of_the_roller_on_the_drum(machine):
    cam, scene = machine()
    path = cam.groove(count=90)
    scene = Scene(
        scene.mechanism,
        {"main": polynomial(0.0, 1.0)},
        over=("main", 0, "356 deg", 90),
        posture=scene.posture,
    )
    solution = evaluate(scene, wanted=["motion"])
    pose = solution.pose("drum")
    body = "cart" if machine is sliding else "arm"
    follower = solution.pose(body)
    place = (0.12, 0.0, 0.0) if body == "arm" else ARM
    at = np.stack([follower.x, follower.y, follower.z]).T + np.einsum(
        "tik,i->tk", follower.axes, place
    )
    seen = np.einsum("tik,tk->ti", pose.axes, at - np.stack([pose.x, pose.y, pose.z]).T)
    assert path == pytest.approx(seen, abs=1e-12)
    assert path.shape == (90, 3)
    with pytest.raises(
        DeclarationError, match="cam 'cam': count must be a whole number of at least 16, got 3"
    ):
        cam.groove(count=3)


def broken(**options):
    m = SpatialMechanism("m")
    drum, cart = m.link("drum", length=0.1, mass=1.0), m.link("cart", length=0.1, mass=1.0)
    main = m.revolute("main", m.ground, drum, axis=(1, 0, 0))
    place = options.pop("place", (0.0, 0.0, 0.05))
    lead = m.prismatic("lead", m.ground.at(*place), cart, axis=options.pop("axis", (1, 0, 0)))
    given = {"cam": main, "follower": lead, "lift": lambda x: 0.02 * ca.sin(x)} | options
    if given["follower"] == "main":
        given |= {"cam": lead, "follower": main}
    if given.get("point") == "drum":
        given["point"] = drum.tip
    return cylindrical_cam(
        m, "cam", given.pop("cam"), given.pop("follower"), given.pop("lift"), **given
    )


@pytest.mark.parametrize(
    ("says", "options"),
    {
        "cam 'cam': expected a revolute joint whose parent is the ground, in space, got 'lead'": {
            "follower": "main"
        },
        "its point must be on 'cart', which joint 'lead' guides": {"point": "drum"},
        "joint 'lead' must be along the drum's axis": {"axis": (1, 0.1, 0)},
        (
            "cam 'cam': the drum's surface does not pass the roller; expected the roller off"
            " the"
            " axis"
        ): {"place": (0.0, 0.0, 0.0)},
        "its lift must be the same after a turn of the cam; expected a period of 2 pi": {
            "lift": lambda x: 0.01 * x
        },
        (
            "lift is no finite number at 0 deg of the cam; expected a function of CasADi's"
            " expressions, with casadi"
        ): {"lift": math.sin},
        "lift: expected a function, got 0.02": {"lift": 0.02},
        "cam 'cam': its groove is undercut at .* deg of the cam, where its path": GROOVE
        | {"roller": 0.08, "lift": law(0.05)},
        "cam 'cam': width needs roller": GROOVE | {"roller": None},
        "cam 'cam': roller must be positive, got -1 m": GROOVE | {"roller": -1.0},
        "cam 'cam': width must be positive, got 0 m": GROOVE | {"width": 0.0},
        r"cam 'cam': elastic must be .*, got \(0.0, 0.3\)": {"elastic": (0.0, 0.3)},
    }.items(),
)
def test_misuse_is_named(options, says):
    with pytest.raises(DeclarationError, match=says):
        broken(**options)


def pressed(force, radius):
    """Johnson's 4.43 and 4.45 by half the width of contact, of two bodies of one material."""
    together = YOUNG / (2 * (1 - POISSON**2))
    half = np.sqrt(4 * np.abs(force) / WIDTH * radius / (np.pi * together))
    return 2 * np.abs(force) / WIDTH / (np.pi * half)


def test_the_pressure_of_hertz_on_the_flank_that_is_touched():
    """Rothbart: the path's radius on the unrolled drum is (R^2 + s'^2)^(3/2)/(R s''); the flank's,
    more or less the roller's.
    """
    _, scene = sliding(lift=(lift := law(0.05)), **GROOVE, elastic=(YOUNG, POISSON))
    solution = evaluate(scene)
    assert solution.certified
    force = solution.output("cam_force")
    _, slope, bend = derivatives(lift, solution.motion("main").value)
    curvature = RADIUS * bend / (RADIUS**2 + slope**2) ** 1.5
    assert np.ptp(curvature) > 1.0
    with np.errstate(divide="ignore"):
        # On the flank from which it is pushed: hollow where the path curves along the force.
        flank = 1.0 / (np.sign(force) * curvature) + ROLLER
        radius = 1.0 / (1.0 / ROLLER - 1.0 / flank)
    assert solution.output("cam_hertz") == pytest.approx(pressed(force, radius), rel=1e-9)
