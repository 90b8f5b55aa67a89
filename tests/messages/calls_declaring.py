"""Right calls of what declares mechanisms, and the parts that they are of."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any

import casadi as ca
import numpy as np
from mechanisms import links_of, pins_of

from lagrange_casadi import (
    LagrangeSystem,
    Mechanism,
    Scene,
    SpatialMechanism,
    beams,
    bearings,
    elements,
    motion,
)

STEEL = beams.material("C45+QT")
BAR = beams.rectangle(height=0.03, width=0.01)
NOTCH = beams.Notch(0.5, bending=1.5)
TURN = motion.harmonic(0.0, 0.6, 1.0)
SPAN = (0.0, 1.0, 5)

Call = tuple[Callable[..., Any], dict[str, Any]]
"""A function or a bound method, and its arguments by name; what has no name goes by ``*``, as a
tuple.
"""


def calls(prefix: str, owner: Any, table: dict[str, dict[str, Any]]) -> Iterator[tuple[str, Call]]:
    """Yield calls of an owner's functions, by prefix and name."""
    for name, given in table.items():
        yield f"{prefix}{name}", (getattr(owner, name), given)


def plane() -> SimpleNamespace:
    """A planar mechanism under declaration, and its parts."""
    m = Mechanism("m")
    length = m.parameter("l", 0.5, "m", low=0.1)
    arm = m.link("arm", length=length, mass=1.0, beam=beams.Beam(BAR, STEEL))
    rod = m.link("rod", length=1.0, mass=1.0)
    pin, other = pins_of(m, O=(m.ground, arm), A=(arm.tip, rod))
    return SimpleNamespace(m=m, l=length, arm=arm, rod=rod, pin=pin, other=other)


def space() -> SimpleNamespace:
    """A spatial one."""
    m = SpatialMechanism("s")
    arm, rod = links_of(m, arm=(0.5, 1.0), rod=(0.5, 1.0))
    bar = m.link("bar", between=((0.0, 0.0, 0.0), (0.0, 1.0, 0.0)), mass=1.0)
    return SimpleNamespace(m=m, arm=arm, rod=rod, bar=bar, pin=m.revolute("O", m.ground, arm))


def wheels() -> SimpleNamespace:
    """Wheels, a cam and what follows it."""
    m = Mechanism("w")
    first, second = (
        elements.wheel(m, name, radius=0.1, width=0.01) for name in ("first", "second")
    )
    pins_of(m, F=(m.ground, first), G=(m.ground.at(0.2, 0.0), second))
    cam, follower = links_of(m, cam=(0.1, 1.0), follower=(0.1, 1.0))
    turn = m.revolute("T", m.ground, cam)
    slide = m.prismatic("L", m.ground, follower, axis=(0.0, 1.0), angle="90 deg")
    return SimpleNamespace(m=m, first=first, second=second, turn=turn, slide=slide)


def drum() -> SimpleNamespace:
    """A cam that turns about the line along which what follows it slides."""
    m = SpatialMechanism("d")
    cam, follower = (m.link(name, length=0.1, mass=1.0) for name in ("cam", "follower"))
    turn = m.revolute("T", m.ground, cam, axis=(1.0, 0.0, 0.0))
    slide = m.prismatic("L", m.ground.at(0.1, 0.0, 0.05), follower, axis=(1.0, 0.0, 0.0))
    return SimpleNamespace(m=m, turn=turn, slide=slide)


def sized() -> Scene:
    """A scene of an arm whose bar is to be chosen."""
    m = Mechanism("sized")
    height, width = (m.parameter(name, 0.03, "m", low=1e-3) for name in ("height", "width"))
    bar = beams.Beam(beams.rectangle(height=height, width=width), STEEL)
    m.revolute("O", m.ground, m.link("arm", length=0.5, beam=bar))
    return Scene(m, {"O": TURN}, t=SPAN, xi=(0.0, 1.0, 3))


def lift(u: Any) -> Any:
    """How a follower moves."""
    return 0.01 * (2.0 - ca.cos(u))


def swing() -> Scene:
    """A scene of one arm that has a beam and a bearing."""
    m = Mechanism("swing")
    arm = m.link(
        "arm",
        length=m.parameter("l", 0.5, "m", low=0.1, high=2.0),
        mass=1.0,
        beam=beams.Beam(BAR, STEEL, [NOTCH]),
    )
    pin = m.revolute("O", m.ground, arm)
    bearings.fit(m, pin, bearings.Rolling(dynamic=1e4, hours=1e4))
    return Scene(m, {"O": TURN}, t=SPAN, xi=(0.0, 1.0, 3))


def declarations() -> Iterator[tuple[str, Call]]:
    """Calls of what declares a mechanism, on mechanisms of their own."""
    p, s, w, d = plane(), space(), wheels(), drum()
    two = {"parent": p.rod.tip, "child": p.m.point_mass("end", 1.0)}
    yield from {
        "Mechanism": (Mechanism, {"name": "new"}),
        "SpatialMechanism": (SpatialMechanism, {"name": "new"}),
    }.items()
    yield from calls(
        "Mechanism.",
        p.m,
        {
            "parameter": {"name": "new", "default": 1.0, "unit": "m", "low": 0.0, "high": 2.0},
            "link": {"name": "new", "length": 0.1, "mass": 1.0},
            "point_mass": {"name": "new", "mass": 1.0},
            "revolute": {"name": "new", **two},
            "prismatic": {"name": "new", **two, "axis": (1.0, 0.0)},
            "slot": {"name": "new", **two},
            "weld": {"name": "new", **two},
            "constraint": {"name": "new", "phi": p.m.coordinate(p.other)},
            "nonholonomic": {"name": "new", "expression": p.m.rate(p.other), "replaces": p.pin},
            "contact": {"name": "new", "point": p.rod, "friction": 0.5, "at": (0.0, 0.0)},
            "gear": {"name": "new", "first": p.pin, "second": p.other, "ratio": 2.0},
            "force": {"name": "new", "point": p.arm.tip, "x": 1.0},
            "torque": {"name": "new", "point": p.arm, "value": 1.0},
            "spring": {
                "name": "new",
                "first": p.m.ground.at(1.0, 1.0),
                "second": p.arm.tip,
                "stiffness": 1.0,
                "length": 1.0,
            },
            "damper": {
                "name": "new",
                "first": p.m.ground.at(1.0, 1.0),
                "second": p.arm.tip,
                "damping": 1.0,
            },
            "torsion_spring": {"name": "new", "joint": p.pin, "stiffness": 1.0},
            "drive": {"name": "new", "joint": p.pin, "rotor_inertia": 0.01, "effort": 1.0},
            "friction": {"name": "new", "joint": p.pin, "mu": 0.1, "radius": 0.01},
            "line_load": {"name": "new", "link": p.arm, "y": 1.0},
            "output": {"name": "new", "expression": p.m.coordinate(p.pin)},
            "path": {"name": "new", "point": p.arm.tip},
            "coordinate": {"joint": p.pin},
            "rate": {"joint": p.pin},
            "place": {"point": p.arm.tip},
            "velocity": {"point": p.arm.tip},
            "direction": {"link": p.arm},
            "values": {"overrides": {"l": 0.5}},
            "set_gravity": {"x": 0.0, "y": -9.81},
        },
    )
    own = plane()
    yield "Mechanism.number", (own.m.number, {"expression": own.l, "values": {"l": 0.5}})
    both = {"parent": s.arm.tip, "child": s.rod}
    axis = {"axis": (0.0, 0.0, 1.0)}
    yield from calls(
        "SpatialMechanism.",
        s.m,
        {
            "nonholonomic": {"name": "new", "expression": s.m.rate(s.pin), "replaces": s.pin},
            "at": {"body": s.bar, "x": 0.1, "y": 0.0, "z": 0.0},
            "link": {"name": "new", "length": 0.1, "mass": 1.0},
            "revolute": {"name": "new", **both, **axis},
            "prismatic": {"name": "new", **both, **axis},
            "cylindrical": {"name": "new", **both, **axis},
            "slot": {"name": "new", **both},
            "screw": {"name": "new", **both, **axis, "lead": 0.01},
            "universal": {"name": "new", **both, **axis, "second": (0.0, 1.0, 0.0)},
            "planar": {"name": "new", **both, **axis},
            "spherical": {"name": "new", **both},
            "contact": {"name": "new", "point": s.rod, "friction": 0.5, "at": (0.0, 0.0, 0.0)},
            "free": {"name": "new", **both},
            "weld": {"name": "new", **both},
            "force": {"name": "new", "point": s.arm.tip, "z": 1.0},
            "torque": {"name": "new", "point": s.arm, "z": 1.0},
            "line_load": {"name": "new", "link": s.arm, "z": 1.0},
            "set_gravity": {"x": 0.0, "y": 0.0, "z": -9.81},
        },
    )
    yield from {
        "Link.at": (p.arm.at, {"x": 0.1}),
        "Ground.at": (p.m.ground.at, {"x": 0.1, "y": 0.1}),
    }.items()
    steel = {"mechanism": w.m, "name": "new"}
    corners = [(0.0, 0.0), (0.1, 0.0), (0.1, 0.1)]
    plate = elements.plate(w.m, "plate", corners, mass=1.0)
    bent = elements.bent_bar(w.m, "bent", corners, mass=1.0)
    g = Mechanism("g")
    main, axle = (
        g.revolute(name, g.ground.at(x, 0), g.link(f"{name}_disc", length=0.1, mass=1.0))
        for name, x in (("main", 0.0), ("axle", 0.2))
    )
    strutted = {"first": w.m.ground, "second": w.second, "closed": 0.3, "open": 0.5}
    cam = elements.disc_cam(w.m, "cams", w.turn, w.slide, lift, base_radius=0.05)
    groove = elements.cylindrical_cam(d.m, "groove", d.turn, d.slide, lift)
    points = [(0.05 * np.cos(a), 0.05 * np.sin(a)) for a in np.linspace(0.0, 6.0, 20)]
    yield from calls(
        "",
        elements,
        {
            "wheel": {**steel, "radius": 0.1, "width": 0.01},
            "gears": {**steel, "first": w.first, "second": w.second, "radii": (0.1, 0.1)},
            "belt": {**steel, "first": w.first, "second": w.second, "radii": (0.05, 0.05)},
            "plate": {**steel, "corners": corners, "mass": 1.0},
            "bent_bar": {**steel, "corners": corners, "mass": 1.0},
            "disc_cam": {
                **steel,
                "cam": w.turn,
                "follower": w.slide,
                "lift": lift,
                "base_radius": 0.05,
            },
            "cylinder": {
                **steel,
                "rear": w.m.ground,
                "front": w.first,
                "closed": 0.3,
                "open": 0.5,
                "bore": 0.05,
            },
            "strut": {**steel, **strutted},
            "geneva": {"mechanism": g, "name": "new", "crank": main, "wheel": axle, "slots": 6},
            "gas_spring": {**steel, **strutted, "force": (200.0, 300.0)},
            "cylindrical_cam": {
                "mechanism": d.m,
                "name": "new",
                "cam": d.turn,
                "follower": d.slide,
                "lift": lift,
            },
            "two_bearings": {
                **steel,
                "housing": w.m.ground,
                "fixed": w.m.link("axle", length=0.2, mass=1.0),
                "floating": w.m.links["axle"].tip,
            },
            "two_bushes": {
                **steel,
                "rod": w.m.link("rod", length=0.2, mass=1.0),
                "first": w.m.ground,
                "second": w.m.ground.at(0.1, 0.0),
            },
            "profile_lift": {
                "mechanism": w.m,
                "cam": w.turn,
                "follower": w.slide,
                "points": points,
            },
            "read_profile": {"path": "profile.csv"},
        },
    )
    e = Mechanism("e")
    sun = elements.wheel(e, "sun", teeth=18, radius=0.018, width=0.01)
    arm = e.link("carrier", length=0.1, mass=1.0)
    pins_of(e, S=(e.ground, sun), C=(e.ground, arm))
    given: dict[str, Any] = {
        "mechanism": e,
        "name": "new",
        "sun": sun,
        "carrier": arm,
        "ring": e.ground,
        "teeth": (18, 18, 54),
        "module": 0.002,
    }
    yield from {
        "planetary": (elements.planetary, {**given, "mass": 0.1}),
        "Plate.at": (plate.at, {"x": 0.0, "y": 0.0}),
        "Plate.corner": (plate.corner, {"number": 1}),
        "Bent.corner": (bent.corner, {"number": 1}),
        "Cam.profile": (cam.profile, {"count": 36}),
        "CylindricalCam.groove": (groove.groove, {"count": 36}),
        "CamProfile.save_csv": (cam.profile(count=36).save_csv, {"path": "cam.csv"}),
        "CamProfile.save_dxf": (cam.profile(count=36).save_dxf, {"path": "cam.dxf"}),
    }.items()
    rolling = bearings.Rolling(dynamic=1e4, hours=1e4)
    yield from {
        "fit": (bearings.fit, {"*": (p.m, p.pin, rolling)}),
        "shaking": (
            importlib.import_module("lagrange_casadi").shaking,
            {"mechanism": p.m, "about": (0.0, 0.0)},
        ),
    }.items()
    x = ca.SX.sym("x")
    rates, speeds = ca.SX.sym("v"), ca.SX.sym("a")
    system = {
        "kinetic": rates**2,
        "force_function": -x,
        "coordinates": x,
        "rates": rates,
        "accelerations": speeds,
    }
    yield "LagrangeSystem", (LagrangeSystem, system)
    scene = {
        "mechanism": plane().m,
        "motion": {"O": TURN, "A": TURN},
        "t": SPAN,
        "xi": (0.0, 1.0, 3),
    }
    yield "Scene", (Scene, scene)
