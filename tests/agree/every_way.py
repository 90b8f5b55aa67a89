"""Scenes that are evaluated in every way: machines from practice, random mechanisms, and two that
have all features at once, one in the plane and one in space.
"""

from __future__ import annotations

import math
from dataclasses import replace

import casadi as ca
import numpy as np
from conftest import PLANAR as PLANAR_CASES
from conftest import SPATIAL as SPATIAL_CASES
from elastic_mechanisms import made
from every_load import every_joint_and_load
from five_bars import geared_five_bar
from machines import SCENES as MACHINES
from machines import called_as_rates
from mechanisms import (
    DRAG_LINK,
    bracket,
    every_function,
    links_of,
    pins_of,
    sampled_cam,
    sprung,
    truss_platform,
)
from random_mechanisms import draw
from spatial_anyhow import anyhow
from spatial_bridge import declared, plain
from spatial_mechanisms import FAMILIES
from stepped import iterated, two_rods

from lagrange_casadi import (
    Mechanism,
    Scene,
    SpatialMechanism,
    beams,
    curve,
    density,
    load_case,
    shaking,
)
from lagrange_casadi.motion import (
    dwell,
    expression,
    harmonic,
    move,
    moves,
    polynomial,
    samples,
    trapezoid,
)

STEEL = beams.material("C45+QT").but(endurance=220e6)


def plane():
    """A slider-crank of a tapered rod: friction in all joints, wind along the rod, gas by a curve,
    a rocker without mass under a load of any shape, outputs of every kind, its shaking force.
    """
    m = Mechanism("together")
    l = m.parameter("l", 0.4, "m", low=0.2)
    mu = m.parameter("mu", 0.1, low=0.0)
    d = m.parameter("d", 0.02, "m", low=0.005)
    start = m.parameter("start", 0.1, "m", low=0.0, high=0.2)
    shape = beams.tapered(beams.rectangle(d, 0.012), beams.rectangle(0.6 * d, 0.012))
    crank = m.link("crank", length=0.1, mass=1.0)
    rod = m.link(
        "rod", length=l, beam=beams.Beam(shape, STEEL, notches=[beams.Notch(0.5, bending=1.5)])
    )
    piston = m.link("piston", length=0.06, mass=0.5, centre=(0.0, 0.0), inertia=4e-4)
    main = m.revolute("O", m.ground, crank)
    m.friction("main", main, mu=0.05, radius=0.02)
    pin = m.revolute("A", crank.tip, rod)
    m.friction("big_end", pin, mu=mu, radius=0.018, viscous=1e-3)
    m.friction("pin", m.revolute("B", rod.tip, piston), mu=mu, radius=0.01)
    guide = m.prismatic("bore", m.ground, piston, axis=(1, 0))
    m.friction("rings", guide, mu=mu, length=0.05, static=0.2, stribeck=0.05)
    m.line_load("wind", rod, y=(30.0, 60.0), between=(start, 0.25))
    round_ = np.linspace(0.0, 2 * math.pi, 9)
    gas = curve(round_, [1.0, 1.2, 1.1, 0.9, 1.0, 1.3, 0.8, 0.7, 1.0], periodic=True)
    push = m.force("gas", piston, x=-200.0 * gas(m.coordinate(main)))
    arm, rocker = m.link("arm", length=0.35, mass=0.4), m.link("rocker", length=0.25, mass=0.0)
    pins_of(m, C=(crank.tip, arm), D=(arm.tip, rocker.tip))
    swing = m.revolute("E", m.ground.at(0.3, -0.05), rocker)
    m.line_load(
        "flow",
        rocker,
        x=ca.cos(m.coordinate(swing)),
        y=lambda xi: 50 * xi - 2000 * xi**2 + 40 * m.rate(swing) * xi,
        between=(0.0, 0.1),
        turning=True,
    )
    found = m.results
    m.output("inside", found.section(rod, 0.4).bending, unit="N m")
    m.output("placed", found.section(rod, start / 0.4).shear, unit="N")
    m.output("power", found.effort(main) * m.rate(main), unit="W")
    m.output("pin_load", ca.hypot(found.reaction(pin).fx, found.reaction(pin).fy), unit="N")
    m.output("ax", found.acceleration(rod.at(0.1, 0.02))[0] + found.load(push).fx, unit="m/s^2")
    m.output("lean", m.direction(rod) + m.time, unit="rad")
    shaking(m)
    return Scene(
        m,
        {"O": polynomial(0.1, 60.0)},
        t=(0, 0.1, 31),
        posture={"rod": 0.0, "rocker": 1.5},
        xi=(0, 1, 8),
    )


def space():
    """One in space that rubs, of a thick crank and a tube, with a spring, wind, outputs inside and
    its shaking force.
    """
    m = SpatialMechanism("together_in_space")
    l = m.parameter("l", 0.4, "m", low=0.2)
    mu = m.parameter("mu", 0.1, low=0.0)
    d = m.parameter("d", 0.02, "m", low=0.005)
    thick = density.thick(
        density.tabulated((0.0, 0.4, 1.0), (8.0, 9.0, 10.0)),
        yy=1e-3,
        zz=density.polynomial(1e-3, 1e-4),
        yz=2e-4,
    )
    crank = m.link("crank", length=0.1, density=thick)
    rod = m.link("rod", length=l, beam=beams.Beam(beams.tube(d, 0.003), STEEL))
    slider = m.link(
        "slider", length=0.06, mass=0.5, centre=(0.0, 0.0, 0.01), inertia=(1e-4, 2e-4, 2e-4)
    )
    O = m.revolute("O", m.ground.at(0.0, 0.02, 0.03), crank, axis=(0.1, 0.3, 1))
    m.spherical("A", crank.tip, rod)
    m.universal("B", slider, rod.tip, axis=(0, 0, 1), second=(0, 1, 0))
    guide = m.prismatic("G", m.ground, slider, axis=(1, 0, 0.1))
    m.friction("main", O, mu=mu, radius=0.02, length=0.05)
    m.friction("seal", guide, coulomb=30.0 * mu, viscous=2.0)
    m.drive("motor", O, rotor_inertia=1e-4 * mu, ratio=30.0, effort=50.0)
    m.drive("spindle", guide, rotor_inertia=1e-5, ratio=40.0)
    m.line_load("wind", rod, y=(30.0, 60.0), z=5.0, between=(0.1, 0.25))
    m.line_load("own", crank, z=lambda xi: m.rate(O) * (3 - 80 * xi), turning=True)
    m.force("pull", rod.at(0.2, 0.02, -0.03), x=3.0, y=-2.0, z=5.0)
    m.spring("coil", m.ground.at(0.5, 0, 0.1), slider, stiffness=200.0, length=0.1)
    m.force("gas", slider, x=-200.0)
    m.output(
        "inside",
        m.results.section(rod, 0.4).bending_y + m.results.section(crank, 0.3).torsion,
        unit="N m",
    )
    shaking(m)
    rough = {"G": 0.4, "B:turn_1": 0.1, "B:turn_2": 0.1}
    return Scene(m, {"O": harmonic(0.1, 2.0, 5.0)}, t=(0, 0.2, 31), posture=rough, xi=(0, 1, 8))


def laws():
    """Arms on arms, each driven by a law of another kind, of parameters."""
    m = Mechanism("laws")
    stroke = m.parameter("stroke", 0.9, "rad")
    ratio = m.parameter("ratio", 1.3)
    pace = m.parameter("pace", 1.1, "s", low=0.5)
    times = np.linspace(0.0, 1.0, 14)
    lift = moves(
        [
            move(stroke, time=0.37 * pace, law=trapezoid(0.21)),
            dwell(0.13 * pace),
            move(0.0, time=0.41 * pace, law="cycloidal"),
        ],
        cyclic=True,
    )
    driven = {
        "moved": lift,
        "sampled": samples(pace * times, [ratio * x for x in 0.4 * np.sin(5 * times) + times**2]),
        "swung": harmonic(0.1, stroke, 1 / pace, ratio),
        "told": expression(lambda t: ratio * ca.sin(t / pace) + stroke),
    }
    outer = m.ground
    for name in driven:
        arm = m.link(f"{name}_arm", length=0.3, mass=0.4)
        joint = m.revolute(name, outer, arm)
        m.drive(f"{name}_motor", joint, rotor_inertia=1e-4 * ratio, ratio=-20.0, armature=0.01)
        outer = arm.tip
    return Scene(m, driven, t=(0.0, 1.0, 57))


def namesake():
    """A slider-crank whose names are those that files and C give to other things; a driven bob is
    in the middle of its rod, at which two loads act twice.
    """
    m = Mechanism("namesake")
    size = m.parameter("law_rate", 0.3)
    crank, rod = links_of(m, crank=(size, 1.0), rod=(0.9, 2.0))
    bob = m.link("rod_acceleration", length=0.2, mass=0.5)
    m.revolute("O", m.ground, crank)
    m.revolute("O_rate", crank.tip, rod)
    m.slot("guide", m.ground, rod.tip, axis=(1.0, 0.0))
    m.revolute("law", rod.at(0.45), bob)
    m.spring("pull", rod.at(0.2), rod.at(0.7), stiffness=100.0, length=0.1)
    m.force("pull_2", rod.at(0.5), y=-7.0)
    motion = {"O": polynomial(0.3, 5.0), "law": harmonic(0.0, 0.5, 3.0, 0.0)}
    return Scene(m, motion, t=(0.0, 1.0, 41), posture={"rod": 0.0}, xi=(0.0, 1.0, 5))


def cranks():
    """Three cranks on one bar, whose forces least strain energy tells; the outer ones may be of any
    thickness.
    """
    m = Mechanism("cranks")
    d = m.parameter("d", 0.01, "m", low=0.0)
    bar = m.link("bar", length=1.0, beam=made(beams.rectangle(0.02, 0.01)))
    for k, place in enumerate((bar.base, bar.at(0.5), bar.tip)):
        shape = beams.round_bar(d if k else 0.01)
        crank = m.link(f"c{k}", length=0.2, beam=made(shape))
        m.revolute(f"G{k}", m.ground.at(0.5 * k, 0.0), crank)
        m.revolute(f"B{k}", crank.tip, place)
    posture = {"c0": 1.2, "c1": 1.2, "c2": 1.2, "bar": 0.0}
    wanted = ["effort", "reaction:B1", "section:bar", "deflection:bar"]
    law = harmonic(1.2, 0.3, 1.0)
    return Scene(m, {"G0": law}, wanted, posture=posture, t=(0, 1, 33), elastic=True)


def planar(seed):
    """A random mechanism as it is looked at elsewhere, its parameters' values as defaults."""
    drawn = draw(seed)
    return replace(drawn.scene(), t=drawn.grid)


def spatial(family, seed):
    return declared(plain((FAMILIES | {"anyhow": anyhow})[family](seed)))


PLANAR = (3, 4, 6, 7, 1, 5, 12, 21)
SPATIAL = [("tree", 3), ("loop", 1), ("rssr", 1), ("suspension", 0), ("anyhow", 3)]
RANDOM = {f"random-{seed}": lambda seed=seed: planar(seed) for seed in PLANAR} | {
    f"{family}-{seed}": lambda family=family, seed=seed: spatial(family, seed)
    for family, seed in SPATIAL
}
DECLARED = {
    "plane": plane,
    "space": space,
    "every_joint_and_load": every_joint_and_load,
    "laws": laws,
    "two_rods": two_rods,
    "geared": lambda: geared_five_bar("OABCD", rubs=True),
    "sprung": lambda: sprung("ABC", **DRAG_LINK, count=401),
    "namesake": namesake,
    "rates": called_as_rates,
    "functions": every_function,
    "cranks": cranks,
    "truss_platform": truss_platform,
    "iterated": iterated,
    "bracket": bracket,
    "sampled_cam": sampled_cam,
} | MACHINES
CASES = {name: lambda name=name: load_case(name).scene for name in [*PLANAR_CASES, *SPATIAL_CASES]}
# Not where a piston is at rest but for rounding, which alone would tell the way that it rubs.
CASES["v_twin"] = lambda: replace(load_case("v_twin").scene, t=(1e-4, 0.04, 361))
SCENES = DECLARED | RANDOM | CASES
TABLED = ["two_rods", "sampled_cam", "random-3", "random-5"]
TABLED += ["slider_crank", "four_bar", "six_bar", "andrews_squeezer", "rssr"]
"""Scenes that a cycle table may have."""
