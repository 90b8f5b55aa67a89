"""Gears in space: helical, bevel, worm and rack against the forces of textbooks, on the bearings
and sections of their shafts; wheels that roll.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from lagrange_casadi import Scene, SpatialMechanism, evaluate
from lagrange_casadi.elements import belt, gears
from lagrange_casadi.errors import DeclarationError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("interpreted")

TAN = math.tan(math.radians(20.0))


def frame(seed):
    """Three directions at right angles, turned at random."""
    x, y, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0].T
    return x, y, np.cross(x, y)


def shaft(m, name, place, axis, beside):
    """A shaft along an axis through a place of the ground, its joint at its base."""
    link = m.link(name, length=0.5, mass=2.0, centre=(0.1, 0, 0), inertia=(1e-3, 1e-2, 1e-2))
    turned = (tuple(map(float, axis)), tuple(map(float, beside)))
    m.revolute(
        f"{name}_bearing", m.ground.at(*map(float, place)), link, axis=turned[0], turned=turned
    )
    return link


def space(moment, driven, axis):
    """A mechanism without gravity, and how its shaft ``driven`` is loaded about its axis."""
    m = SpatialMechanism("pair")
    m.set_gravity(0, 0, 0)

    def load(link):
        m.torque("load", link, **dict(zip("xyz", (float(moment * x) for x in axis), strict=True)))

    return m, load


def borne(solution, name):
    """What a bearing does to its shaft about its base: force and moment."""
    reaction = solution.reaction(f"{name}_bearing")
    parts = [getattr(reaction, key) for key in ("fx", "fy", "fz", "mx", "my", "mz")]
    values = np.array([0.0 if part is None else part[0] for part in parts])
    return values[:3], values[3:]


def holds(solution, name, base, axis, point, force):
    """The bearing holds a force that acts at a point on its shaft, but for the moment about the
    axis.
    """
    push, moment = borne(solution, name)
    size = np.linalg.norm(force)
    assert push == pytest.approx(-force, abs=1e-12 * size)
    lever = np.cross(point - base, force)
    assert moment == pytest.approx(-(lever - np.dot(lever, axis) * axis), abs=1e-12 * size)


@pytest.mark.sampled(5)
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("moment", [50.0, -50.0])
@pytest.mark.parametrize("helix", [20.0, -35.0])
def test_helical_gears(seed, moment, helix):
    """Shigley, equations 13-38: radial W tan(phi_n)/cos(psi) and axial W tan(psi), of the
    tangential force W.
    """
    u, e, t = frame(seed)
    r1, r2, base = 0.05, 0.12, np.array([0.1, -0.2, 0.3])
    m, load = space(moment, "second", u)
    first, second = shaft(m, "first", base, u, e), shaft(m, "second", base + (r1 + r2) * e, u, e)
    mesh = gears(
        m, "mesh", first.at(0.15), second.at(0.15), radii=(r1, r2), helix_angle=f"{helix} deg"
    )
    load(second)
    solution = evaluate(Scene(m, {"first_bearing": polynomial(0.3)}, t=(0, 1, 2)))
    assert solution.certified
    assert mesh.kind == "parallel"
    psi = math.radians(helix)
    # The teeth hold the load: on the second gear about its axis -moment, at -r2 e from its centre.
    way = moment / r2
    on_second = way * t
    # A right-handed first gear pushes along -u where it is pushed along t.
    on_first = -on_second + way * math.tan(psi) * u - abs(way) * TAN / math.cos(psi) * e
    point = base + 0.15 * u + r1 * e
    holds(solution, "first", base, u, point, on_first)
    holds(solution, "second", base + (r1 + r2) * e, u, point, -on_first)
    assert solution.output("mesh_radial")[0] == pytest.approx(abs(way) * TAN / math.cos(psi))
    assert solution.output("mesh_axial")[0] == pytest.approx(way * math.tan(psi))


@pytest.mark.sampled(5)
@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("angle", [90.0, 60.0, 110.0])
@pytest.mark.parametrize("moment", [50.0, -50.0])
def test_bevel_gears(seed, angle, moment):
    """Shigley, equations 13-36 and 13-37: radial W tan(phi) cos(gamma), axial W tan(phi) sin(gamma)
    off the apex.
    """
    x, y, _ = frame(seed + 10)
    sigma, z = math.radians(angle), (20, 33)
    apex, v = np.array([0.3, 0.1, -0.2]), math.cos(sigma) * x + math.sin(sigma) * y
    gamma = (
        math.atan2(math.sin(sigma), z[1] / z[0] + math.cos(sigma)),
        math.atan2(math.sin(sigma), z[0] / z[1] + math.cos(sigma)),
    )
    assert sum(gamma) == pytest.approx(sigma)
    radii = [0.002 * count for count in z]
    heights = [r / math.tan(one) for r, one in zip(radii, gamma, strict=True)]
    m, load = space(moment, "second", v)
    first = shaft(m, "first", apex, x, y)
    second = shaft(m, "second", apex, v, np.cross(v, np.cross(x, y)))
    mesh = gears(m, "mesh", first.at(heights[0]), second.at(heights[1]), teeth=z, module=0.004)
    load(second)
    solution = evaluate(
        Scene(m, {"first_bearing": polynomial(0.3, 2.0)}, t=(0, 1, 2)), wanted=["all"]
    )
    assert solution.certified
    assert mesh.kind == "bevel"
    assert abs(solution.motion("second_bearing").rate[0]) == pytest.approx(
        2.0 * z[0] / z[1], rel=1e-13
    )
    point = apex + heights[0] * x + radii[0] * y
    across = np.cross(v, point - apex) / radii[1]  # the way of the second gear at the pitch point
    on_second = -moment / radii[1] * across
    size, toward = abs(moment) / radii[1] * TAN, -(point - apex - heights[1] * v) / radii[1]
    on_second = on_second + size * (math.cos(gamma[1]) * toward + math.sin(gamma[1]) * v)
    # Gyroscopic moments of rotors that are round about their axes are none.
    holds(solution, "first", apex, x, point, -on_second)
    holds(solution, "second", apex, v, point, on_second)


@pytest.mark.parametrize("hand", ["right", "left"])
@pytest.mark.parametrize("moment", [50.0, -50.0])
def test_a_worm_and_its_wheel(hand, moment):
    """Shigley, equations 13-39 to 13-41 without friction: W cos(phi) sin(lead), W sin(phi), W
    cos(phi) cos(lead).
    """
    u, e, v = frame(5)
    r1, r2, base = 0.02, 0.08, np.array([0.0, 0.1, 0.2])
    m, load = space(moment, "wheel", v)
    worm = shaft(m, "worm", base, u, e)
    turned = shaft(m, "wheel", base + 0.1 * u + (r1 + r2) * e - 0.2 * v, v, e)
    mesh = gears(m, "mesh", worm.at(0.1), turned.at(0.2), radii=(r1, r2), teeth=(2, 40), hand=hand)
    load(turned)
    solution = evaluate(Scene(m, {"worm_bearing": polynomial(0.3, 1.0)}, t=(0, 1, 2)))
    assert solution.certified
    assert mesh.kind == "crossed"
    lead = math.atan(2 * 2 * math.pi * r2 / 40 / (2 * math.pi * r1))
    tangential, radial, axial = (
        solution.output(f"mesh_{name}")[0] for name in ("tangential", "radial", "axial")
    )
    assert abs(axial) == pytest.approx(50.0 / r2, rel=1e-12)
    assert abs(tangential) == pytest.approx(50.0 / r2 * math.tan(lead), rel=1e-12)
    assert radial == pytest.approx(50.0 / r2 * TAN / math.cos(lead), rel=1e-12)
    # A right-handed worm that turns forward moves its thread backward along its axis as seen at a
    # fixed place, and the wheel there.
    rate = solution.motion("wheel_bearing").rate[0]
    there = rate * np.dot(np.cross(v, -r2 * e), u)
    assert there == pytest.approx(
        (-1 if hand == "right" else 1) * 2 * 2 * math.pi * r2 / 40 / (2 * math.pi), rel=1e-12
    )
    point = base + 0.1 * u + r1 * e
    on_worm = tangential * np.cross(u, e) - radial * e + axial * u
    holds(solution, "worm", base, u, point, on_worm)
    holds(solution, "wheel", base + 0.1 * u + (r1 + r2) * e - 0.2 * v, v, point, -on_worm)
    assert abs(solution.effort("worm_bearing")[0]) == pytest.approx(50.0 * 2 / 40, rel=1e-12)


def worm(mu, driven, speed=3.0, hand="right", moment=-50.0):
    m = SpatialMechanism("worm")
    m.set_gravity(0, 0, 0)
    r1, r2, z = 0.02, 0.08, 40
    kwargs = {"mass": 0.0, "centre": (0, 0, 0)}
    screw = m.link("screw", length=0.1, inertia=(1e-12, 1e-12, 1e-12), **kwargs)
    turned = m.link(
        "turned", length=0.1, inertia=(1e-12, 1e-12, 1e-12), **(kwargs | {"mass": 1e-9})
    )
    m.revolute("worm", m.ground, screw, axis=(1, 0, 0))
    m.revolute("wheel", m.ground.at(0, r1 + r2, 0), turned, axis=(0, 0, 1))
    gears(
        m, "mesh", screw, turned, radii=(r1, r2), teeth=(4, z), hand=hand, mu=m.parameter("mu", mu)
    )
    m.torque(
        "load",
        turned if driven == "worm" else screw,
        **({"z": moment} if driven == "worm" else {"x": moment}),
    )
    return Scene(m, {driven: polynomial(0.0, speed)}, t=(0, 1, 3)), math.atan(4 * r2 / (z * r1))


@pytest.mark.sampled(4)
@pytest.mark.parametrize("mu", [0.0, 0.03, 0.1])
@pytest.mark.parametrize("hand", ["right", "left"])
def test_a_worm_drives_its_wheel(mu, hand):
    """Shigley, equation 13-46: (cos(phi) - mu tan(lead))/(cos(phi) + mu cot(lead))."""
    cosine = math.cos(math.radians(20.0))
    for speed in (3.0, -3.0):
        scene, lead = worm(mu, "worm", speed, hand)
        solution = evaluate(scene)
        assert solution.certified
        given, taken = solution.effort("worm") * speed, 50.0 * solution.motion("wheel").rate
        efficiency = (cosine - mu * math.tan(lead)) / (cosine + mu / math.tan(lead))
        if taken[0] > 0.0:
            assert taken / given == pytest.approx(np.full(3, efficiency), rel=1e-9)
        else:
            # The wheel pushes: with the sign of mu the other way, less is given back, or it must be
            # driven.
            back = (cosine - mu / math.tan(lead)) / (cosine + mu * math.tan(lead))
            assert given / taken == pytest.approx(np.full(3, back), rel=1e-9)
        assert given - taken == pytest.approx(solution.output("mesh_loss"), rel=1e-9, abs=1e-9)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("at", "more", "says"),
    [
        ({"second": 0.04}, {}, "gear 1 is 0.1 m from where the axes meet; expected 0.06 m"),
        ({"third": 0.0}, {}, "0.1 m along the axis"),
        ({"worm": 0.0}, {}, "crossed axes need teeth= and radii= of both"),
        ({"worm": 0.02}, {"teeth": (1, 40)}, "0.02 m along its axis from the common perpendicular"),
        ({"third": 0.1}, {"helix_angle": "80 deg"}, "must be from -75 to 75 deg, got 80 deg"),
        ({"second": 0.0}, {"of": belt}, "parallel axes"),
        (
            {"askew": 0.0},
            {"teeth": (60, 20), "radii": (0.05, 0.05)},
            "radii and numbers of teeth do not fit the angle between its axes",
        ),
        ({"rack": 0.0}, {"radii": (0.1,)}, "rack must slide at right angles to the axis of its"),
    ],
)
def test_bad_gears_in_space_are_refused_by_name(at, more, says):
    m = SpatialMechanism("bad")
    shafts = {
        "first": shaft(m, "first", (0, 0, 0), (1, 0, 0), (0, 1, 0)),
        "second": shaft(m, "second", (0, 0, 0), (0, 1, 0), (0, 0, 1)),
        "third": shaft(m, "third", (0, 0.1, 0), (1, 0, 0), (0, 1, 0)),
        "worm": shaft(m, "worm", (0, 0, 0.1), (0, 1, 0), (0, 0, 1)),
        "askew": shaft(m, "askew", (0, 0, 0.1), (0.9, 0.3, 0), (-0.3, 0.9, 0)),
        "rack": m.link("rack", length=0.1, mass=1.0),
    }
    m.prismatic("way", m.ground.at(0, 0, 0.1), shafts["rack"], axis=(1, 1, 0))
    ((name, place),) = at.items()
    first = shafts["first"].at(0.0 if name in ("worm", "askew") else 0.1)
    make = more.get("of", gears)
    options = {"radii": (0.04, 0.06)} | {k: v for k, v in more.items() if k != "of"}
    with pytest.raises(DeclarationError, match=says):
        make(m, "mesh", first, shafts[name].at(place), **options)
