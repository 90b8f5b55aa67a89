"""A right call of every public function, class and method: what walks over them start from."""

from __future__ import annotations

import importlib
import inspect
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import casadi as ca
import numpy as np

from lagrange_casadi import (
    LagrangeSystem,
    Mechanism,
    Scene,
    SpatialMechanism,
    actuators,
    animation,
    beams,
    bearings,
    density,
    elements,
    evaluate,
    figures,
    motion,
    optimise,
    prepare,
    save,
    sensitivities,
    strength,
    sweep,
)
from lagrange_casadi.optimise import Term
from lagrange_casadi.sweep import Condition, Grid, Listed, Range, Values

DOORS = (
    "lagrange_casadi",
    *(
        f"lagrange_casadi.{name}"
        for name in (
            "actuators",
            "animation",
            "beams",
            "bearings",
            "density",
            "elements",
            "figures",
            "motion",
            "optimise",
            "peaks",
            "strength",
            "sweep",
        )
    ),
)
"""Where users import from."""

STEEL = beams.material("C45+QT")
BAR = beams.rectangle(height=0.03, width=0.01)
ROUND = beams.round_bar(diameter=0.02)
TURN = motion.harmonic(0.0, 0.6, 1.0)
SPAN = (0.0, 1.0, 5)

Call = tuple[Callable[..., Any], dict[str, Any]]
"""A function or a bound method, and its arguments by name; what has no name goes by ``*``, as a tuple."""


def plane() -> SimpleNamespace:
    """A planar mechanism under declaration, and its parts."""
    m = Mechanism("m")
    length = m.parameter("l", 0.5, "m", low=0.1)
    arm = m.link("arm", length=length, mass=1.0, beam=beams.Beam(BAR, STEEL))
    rod = m.link("rod", length=1.0, mass=1.0)
    pin = m.revolute("O", m.ground, arm)
    other = m.revolute("A", arm.tip, rod)
    return SimpleNamespace(m=m, l=length, arm=arm, rod=rod, pin=pin, other=other)


def space() -> SimpleNamespace:
    """A spatial one."""
    m = SpatialMechanism("s")
    arm = m.link("arm", length=0.5, mass=1.0)
    rod = m.link("rod", length=0.5, mass=1.0)
    bar = m.link("bar", between=((0.0, 0.0, 0.0), (0.0, 1.0, 0.0)), mass=1.0)
    return SimpleNamespace(m=m, arm=arm, rod=rod, bar=bar, pin=m.revolute("O", m.ground, arm))


def wheels() -> SimpleNamespace:
    """Wheels, a cam and what follows it."""
    m = Mechanism("w")
    first, second = (elements.wheel(m, name, radius=0.1, width=0.01) for name in ("first", "second"))
    m.revolute("F", m.ground, first)
    m.revolute("G", m.ground.at(0.2, 0.0), second)
    cam = m.link("cam", length=0.1, mass=1.0)
    follower = m.link("follower", length=0.1, mass=1.0)
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
    arm = m.link("arm", length=m.parameter("l", 0.5, "m", low=0.1, high=2.0), mass=1.0, beam=beams.Beam(BAR, STEEL))
    pin = m.revolute("O", m.ground, arm)
    bearings.fit(m, pin, bearings.Rolling(dynamic=1e4, hours=1e4))
    return Scene(m, {"O": TURN}, t=SPAN, xi=(0.0, 1.0, 3))


def solved() -> SimpleNamespace:
    """What is made of a scene, which no call changes."""
    scene = swing()
    solution = evaluate(scene, backend="vm", certificate=False)
    save(solution, "run.h5")
    duty = actuators.duty_of(solution, "O")
    motor = actuators.Motor("M", 9.0, 8.0, 100.0, 20.0, 200.0, 1e-5)
    return SimpleNamespace(
        scene=scene,
        solution=solution,
        duty=duty,
        motor=motor,
        stress=solution.stress("arm"),
        prepared=prepare(scene, wanted=["effort"], backend="vm"),
        sensitivities=sensitivities(scene, solution, backend="vm"),
        swept=sweep(scene, {"l": (0.2, 0.3, 2)}, wanted=["effort"], backend="vm", out="swept.h5", workers=1),
        plane=plane(),
    )


def declarations() -> Iterator[tuple[str, Call]]:
    """Calls of what declares a mechanism, on mechanisms of their own."""
    p, s, w, d = plane(), space(), wheels(), drum()
    two = {"parent": p.rod.tip, "child": p.m.point_mass("end", 1.0)}
    yield "Mechanism", (Mechanism, {"name": "new"})
    yield "SpatialMechanism", (SpatialMechanism, {"name": "new"})
    for name, given in {
        "parameter": {"name": "new", "default": 1.0, "unit": "m", "low": 0.0, "high": 2.0},
        "link": {"name": "new", "length": 0.1, "mass": 1.0},
        "point_mass": {"name": "new", "mass": 1.0},
        "revolute": {"name": "new", **two},
        "prismatic": {"name": "new", **two, "axis": (1.0, 0.0)},
        "slot": {"name": "new", **two},
        "weld": {"name": "new", **two},
        "constraint": {"name": "new", "phi": p.m.coordinate(p.other)},
        "nonholonomic": {"name": "new", "expression": p.m.rate(p.other), "replaces": p.pin},
        "gear": {"name": "new", "first": p.pin, "second": p.other, "ratio": 2.0},
        "force": {"name": "new", "point": p.arm.tip, "x": 1.0},
        "torque": {"name": "new", "point": p.arm, "value": 1.0},
        "spring": {"name": "new", "first": p.m.ground.at(1.0, 1.0), "second": p.arm.tip, "stiffness": 1.0, "length": 1.0},
        "damper": {"name": "new", "first": p.m.ground.at(1.0, 1.0), "second": p.arm.tip, "damping": 1.0},
        "torsion_spring": {"name": "new", "joint": p.pin, "stiffness": 1.0},
        "friction": {"name": "new", "joint": p.pin, "mu": 0.1, "radius": 0.01},
        "line_load": {"name": "new", "link": p.arm, "y": 1.0},
        "output": {"name": "new", "expression": p.m.coordinate(p.pin)},
        "path": {"name": "new", "point": p.arm.tip},
        "coordinate": {"joint": p.pin},
        "rate": {"joint": p.pin},
        "place": {"point": p.arm.tip},
        "velocity": {"point": p.arm.tip},
        "direction": {"link": p.arm},
        "number": {"expression": p.l, "values": {"l": 0.5}},
        "values": {"overrides": {"l": 0.5}},
        "set_gravity": {"x": 0.0, "y": -9.81},
    }.items():
        yield f"Mechanism.{name}", (getattr(p.m, name), given)
    both = {"parent": s.arm.tip, "child": s.rod}
    axis = {"axis": (0.0, 0.0, 1.0)}
    for name, given in {
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
        "free": {"name": "new", **both},
        "weld": {"name": "new", **both},
        "force": {"name": "new", "point": s.arm.tip, "z": 1.0},
        "torque": {"name": "new", "point": s.arm, "z": 1.0},
        "line_load": {"name": "new", "link": s.arm, "z": 1.0},
        "set_gravity": {"x": 0.0, "y": 0.0, "z": -9.81},
    }.items():
        yield f"SpatialMechanism.{name}", (getattr(s.m, name), given)
    yield "Link.at", (p.arm.at, {"x": 0.1})
    yield "Ground.at", (p.m.ground.at, {"x": 0.1, "y": 0.1})
    steel = {"mechanism": w.m, "name": "new"}
    corners = [(0.0, 0.0), (0.1, 0.0), (0.1, 0.1)]
    plate = elements.plate(w.m, "plate", corners, mass=1.0)
    bent = elements.bent_bar(w.m, "bent", corners, mass=1.0)
    cam = elements.disc_cam(w.m, "cams", w.turn, w.slide, lift, base_radius=0.05)
    groove = elements.cylindrical_cam(d.m, "groove", d.turn, d.slide, lift)
    points = [(0.05 * np.cos(a), 0.05 * np.sin(a)) for a in np.linspace(0.0, 6.0, 20)]
    for name, given in {
        "wheel": {**steel, "radius": 0.1, "width": 0.01},
        "gears": {**steel, "first": w.first, "second": w.second, "radii": (0.1, 0.1)},
        "belt": {**steel, "first": w.first, "second": w.second, "radii": (0.05, 0.05)},
        "plate": {**steel, "corners": corners, "mass": 1.0},
        "bent_bar": {**steel, "corners": corners, "mass": 1.0},
        "disc_cam": {**steel, "cam": w.turn, "follower": w.slide, "lift": lift, "base_radius": 0.05},
        "cylinder": {**steel, "rear": w.m.ground, "front": w.first, "closed": 0.3, "bore": 0.05},
        "cylindrical_cam": {"mechanism": d.m, "name": "new", "cam": d.turn, "follower": d.slide, "lift": lift},
        "profile_lift": {"mechanism": w.m, "cam": w.turn, "follower": w.slide, "points": points},
        "read_profile": {"path": "profile.csv"},
    }.items():
        yield name, (getattr(elements, name), given)
    e = Mechanism("e")
    sun = elements.wheel(e, "sun", teeth=18, radius=0.018, width=0.01)
    arm = e.link("carrier", length=0.1, mass=1.0)
    e.revolute("S", e.ground, sun)
    e.revolute("C", e.ground, arm)
    given: dict[str, Any] = {"mechanism": e, "name": "new", "sun": sun, "carrier": arm, "ring": e.ground, "teeth": (18, 18, 54), "module": 0.002}
    yield "planetary", (elements.planetary, {**given, "mass": 0.1})
    yield "Plate.at", (plate.at, {"x": 0.0, "y": 0.0})
    yield "Plate.corner", (plate.corner, {"number": 1})
    yield "Bent.corner", (bent.corner, {"number": 1})
    yield "Cam.profile", (cam.profile, {"count": 36})
    yield "CylindricalCam.groove", (groove.groove, {"count": 36})
    yield "CamProfile.save_csv", (cam.profile(count=36).save_csv, {"path": "cam.csv"})
    yield "CamProfile.save_dxf", (cam.profile(count=36).save_dxf, {"path": "cam.dxf"})
    rolling = bearings.Rolling(dynamic=1e4, hours=1e4)
    yield "fit", (bearings.fit, {"*": (p.m, p.pin, rolling)})
    yield "shaking", (importlib.import_module("lagrange_casadi").shaking, {"mechanism": p.m, "about": (0.0, 0.0)})
    x = ca.SX.sym("x")
    rates, speeds = ca.SX.sym("v"), ca.SX.sym("a")
    system = {"kinetic": rates**2, "force_function": -x, "coordinates": x, "rates": rates, "accelerations": speeds}
    yield "LagrangeSystem", (LagrangeSystem, system)
    scene = {"mechanism": plane().m, "motion": {"O": TURN, "A": TURN}, "t": SPAN, "xi": (0.0, 1.0, 3)}
    yield "Scene", (Scene, scene)


def laws() -> Iterator[tuple[str, Call]]:
    """Calls of what makes motions, densities, cross-sections, notches, bearings, figures."""
    points = {"x": [0.0, 0.3, 0.7, 1.0], "y": [1.0, 2.0, 2.0, 1.0]}
    curve = importlib.import_module("lagrange_casadi").curve
    bend = curve(**points)
    yield "curve", (curve, points)
    yield "Curve.__call__", (bend, {"x": 0.5})
    yield "table", (importlib.import_module("lagrange_casadi").table, {"x": ca.SX.sym("x"), "places": [0, 1], "values": [0, 1]})
    move = motion.move("90 deg", time=1.0)
    for name, given in {
        "polynomial": {"*": (0.0, 1.0)},
        "harmonic": {"mean": 0.0, "amplitude": 1.0, "frequency": 1.0},
        "expression": {"law": lift},
        "samples": {"times": [0.0, 1.0, 2.0, 3.0], "values": [0.0, 1.0, 0.0, 1.0]},
        "dwell": {"time": 1.0},
        "move": {"to": 1.0, "time": 1.0},
        "moves": {"parts": [move, motion.dwell(1.0)]},
        "read_samples": {"path": "samples.csv"},
        "s_curve": {"share": 0.3, "rounding": 0.5},
        "trapezoid": {"share": 0.3},
    }.items():
        yield f"motion.{name}", (getattr(motion, name), given)
    yield "Motion.__call__", (TURN, {"x": ca.SX.sym("t")})
    even = density.uniform(1.0)
    for name, given in {
        "uniform": {"mass": 1.0},
        "polynomial": {"*": (1.0, 1.0)},
        "tabulated": {"ratios": [0.0, 1.0], "values": [1.0, 2.0]},
        "along": {"curve": bend},
        "thick": {"density": even, "yy": 1e-4, "zz": 1e-4},
    }.items():
        yield f"density.{name}", (getattr(density, name), given)
    flat = {"height": 0.03, "width": 0.02}
    walls = {**flat, "web": 0.002, "flange": 0.002}
    wide = beams.rectangle(height=0.04, width=0.01)
    for name, given in {
        "rectangle": flat,
        "ellipse": flat,
        "round_bar": {"diameter": 0.02},
        "tube": {"diameter": 0.02, "wall": 0.002},
        "i_section": walls,
        "t_section": walls,
        "c_section": walls,
        "box": walls,
        "polygon": {"places": [(0.0, 0.0), (0.1, 0.0), (0.1, 0.1)]},
        "given": {"area": 1e-4, "iz": 1e-9, "iy": 1e-9, "top": 0.01, "side": 0.01},
        "along": {"ratios": [0.0, 1.0], "shapes": [BAR, wide]},
        "tapered": {"base": BAR, "tip": wide},
        "stepped": {"steps": [0.5], "shapes": [BAR, wide]},
        "shoulder": {"at": 0.5, "wide": 0.03, "narrow": 0.02, "radius": 0.002},
        "hole": {"at": 0.5, "height": 0.03, "diameter": 0.005},
        "keyway": {"at": 0.5},
        "sensitivity": {"radius": 0.002, "ultimate": 6e8},
        "material": {"name": "C45+QT"},
        "read_profiles": {"path": "profiles.csv"},
        "Beam": {"shape": BAR, "material": STEEL},
        "Notch": {"at": 0.5},
        "Material": {"name": "new", "density": 7850.0},
        "Profile": {"name": "new", "dimensions": flat},
        "Shape": {"kind": "rectangle", "dimensions": flat},
    }.items():
        yield f"beams.{name}", (getattr(beams, name), given)
    yield "Profile.shape", (beams.Profile("p", flat).shape, {"kind": "rectangle"})
    yield "Material.but", (STEEL.but, {"density": 7000.0})
    yield "Shape.properties", (BAR.properties, {})
    for name, given in {
        "Pin": {"diameter": 0.01, "eye": 0.01, "cheek": 0.01, "material": STEEL},
        "Plain": {"bore": 0.01, "width": 0.01},
        "Rolling": {"dynamic": 1e4, "hours": 1e4},
        "bending_of_pin": {"force": 100.0, "eye": 0.01, "cheek": 0.01},
        "equivalent_load": {"load": [1.0, 2.0], "turned": [1.0, 1.0]},
        "rated_hours": {"dynamic": 1e4, "load": 10.0, "rpm": 100.0},
    }.items():
        yield f"bearings.{name}", (getattr(bearings, name), given)
    for name, given in {
        "DeflectionPlot": {"name": "f", "link": "arm"},
        "MechanismDrawing": {},
        "SectionMaps": {"name": "f", "link": "arm"},
        "SpanPlot": {"name": "f", "quantity": "section:arm:bending", "t": 0.5},
        "StrengthPlot": {"name": "f", "link": "arm"},
        "TimePlot": {"name": "f", "quantities": ("effort:O",)},
        "UtilisationPlot": {"name": "f", "links": ("arm",)},
    }.items():
        yield f"figures.{name}", (getattr(figures, name), given)
    yield "Film", (animation.Film, {})
    motor = {"stall_torque": 9.0, "rated_torque": 8.0, "rated_speed": 100.0, "peak_torque": 20.0, "max_speed": 200.0, "inertia": 1e-5}
    yield "Motor", (actuators.Motor, {"name": "M", **motor})
    yield "read_motors", (actuators.read_motors, {"path": "motors.csv"})
    amplitude = {"amplitude": 1e8, "material": STEEL}
    for name, given in {
        "critical_plane": {"values": np.ones((3, 4))},
        "plane_factor": {"plane": strength.critical_plane(np.eye(3, 4)), "material": STEEL},
        "critical_stress": {"slenderness": 50.0, "elasticity": 2e11, "strength": 3e8},
        "factor": {**amplitude, "mean": 0.0},
        "reversed_amplitude": {**amplitude, "mean": 0.0},
        "cycles": amplitude,
        "rainflow": {"history": [0.0, 1.0, -1.0, 0.5]},
    }.items():
        yield f"strength.{name}", (getattr(strength, name), given)
    yield "Range", (Range, {"start": 0.1, "stop": 0.2, "count": 3})
    yield "Values", (Values, {"values": (0.1, 0.2)})
    yield "Grid", (Grid, {"axes": {"l": Values((0.1, 0.2))}})
    yield "Listed", (Listed, {"names": ("l",), "rows": np.array([[0.1], [0.2]])})
    yield "Condition", (Condition, {"name": "l", "relation": "<", "value": 1.0})
    yield "Condition.parse", (Condition.parse, {"text": "l<0.3"})
    yield "Term.parse", (Term.parse, {"text": "l", "parameters": {"l": 0.5}})
    yield "Constraint.parse", (optimise_constraint().parse, {"text": "l<0.3", "parameters": {"l": 0.5}})


def optimise_constraint() -> Any:
    """The class of limits."""
    return importlib.import_module("lagrange_casadi.optimise").Constraint


def uses(of: SimpleNamespace) -> Iterator[tuple[str, Call]]:
    """Calls of what evaluates a scene, and of what it gives."""
    root = importlib.import_module("lagrange_casadi")
    peaks = importlib.import_module("lagrange_casadi.peaks")
    scene, solution, swept = of.scene, of.solution, of.swept
    both = {"scene": scene, "solution": solution}
    lean = {"scene": scene, "wanted": ["effort"], "backend": "vm"}
    one = {"l": (0.2, 0.3, 2)}
    for name, given in {
        "derive": {"scene": scene, "wanted": ["effort"]},
        "evaluate": {**lean, "certificate": False},
        "prepare": lean,
        "refine": {**both, "names": ["effort:O"]},
        "sensitivities": {**both, "backend": "vm"},
        "holding": both,
        "tolerances": {**lean, "within": {"l": 0.01}, "samples": 10},
        "tool_deflection": {"scene": scene, "point": scene.mechanism.links["arm"].tip},
        "vibration": {"solution": solution, "link": "arm"},
        "sweep": {**lean, "grid": one, "out": "made.h5", "force": True, "workers": 1},
        "optimise": {"scene": scene, "minimise": "l", "over": {"l": (0.2, 0.3)}, "starts": 1, "screen": 2, "points": 2, "backend": "vm"},
        "best": {"sweep": swept, "minimise": "l"},
        "read_designs": {"path": "designs.csv"},
        "load": {"path": "run.h5"},
        "check": {"path": "run.h5"},
        "save": {"solution": solution, "path": "saved.h5"},
        "load_case": {"path": "slider_crank"},
        "export": {"scene": scene, "out": "exported", "wanted": ["effort"], "force": True},
    }.items():
        yield name, (getattr(root, name), given)
    for name, given in {
        "forces": {"solution": solution},
        "refine_safety": {**both, "link": "arm"},
        "refine_stress": {**both, "link": "arm"},
        "shortfall": {"scene": scene, "counts": [5, 9], "names": ["effort:O"]},
    }.items():
        yield f"peaks.{name}", (getattr(peaks, name), given)
    size = importlib.import_module("lagrange_casadi.study.sizing").size
    yield "size", (size, {"scene": sized(), "profiles": [beams.Profile("p", {"height": 0.03, "width": 0.01})]})
    for name, given in {
        "animate": {"path": "cycle.svg"},
        "array": {"name": "effort:O"},
        "deflection": {"link": "arm"},
        "determined": {"name": "effort:O"},
        "during": {"instants": slice(0, 2)},
        "effort": {"joint": "O"},
        "extremes": {"name": "effort:O"},
        "life": {"link": "arm"},
        "motion": {"joint": "O"},
        "peak": {"name": "effort:O"},
        "pose": {"body": "arm"},
        "reaction": {"joint": "O"},
        "report": {"path": "page.html"},
        "safety": {"link": "arm"},
        "section": {"link": "arm"},
        "statistics": {"name": "effort:O"},
        "stress": {"link": "arm"},
        "unit": {"name": "effort:O"},
        "view": {"height": 300},
    }.items():
        yield f"Solution.{name}", (getattr(solution, name), given)
    yield "Scene.report", (scene.report, {"path": "scene.html"})
    yield "Scene.checked", (scene.checked, {"values": {"l": 0.5}})
    yield "Scene.timing", (scene.timing, {"t": SPAN})
    yield "Deflection.at", (solution.deflection("arm").at, {"name": solution.deflection("arm").names[0], "u": 0.5})
    for name, given in {
        "at": {"xi": 0.5},
        "fibres": {"xi": 0.5},
        "grid": {"kind": "von_mises"},
        "largest": {"kind": "von_mises"},
        "largest_at_notches": {"kind": "von_mises"},
        "peak": {"kind": "von_mises"},
    }.items():
        yield f"Stress.{name}", (getattr(of.stress, name), given)
    yield "Safety.against", (solution.safety("arm").against, {"what": "yielding"})
    yield "Plane.value", (strength.critical_plane(np.eye(3, 4)).value, {})
    for name, given in {
        "safety": {"solution": solution, "link": "arm"},
        "life": {"solution": solution, "link": "arm"},
        "stress": {"solution": solution, "link": "arm"},
        "joint_safety": {"solution": solution, "joint": "O"},
        "safeties": {"solution": solution},
        "effective_lengths": {"description": solution.description, "link": "arm"},
    }.items():
        yield f"strength.{name}", (getattr(strength, name), given)
    yield "Prepared.__call__", (of.prepared, {"*": ({"l": 0.3},)})
    for name in ("peaks", "gradient", "curvature"):
        yield f"Prepared.{name}", (getattr(of.prepared, name), {"*": ({"l": 0.3},)})
    yield "Prepared.designs", (of.prepared.designs, {"p": np.array([[0.3]])})
    for name, given in {
        "array": {"name": "effort:O", "parameter": "l"},
        "curvature": {"name": "effort:O", "parameter": "l", "other": "l"},
        "mean": {"name": "effort:O"},
        "rms": {"name": "effort:O"},
        "peak": {"name": "effort:O"},
        "peaks": {"names": ["effort:O"]},
    }.items():
        yield f"Sensitivities.{name}", (getattr(of.sensitivities, name), given)
    peak = "peak:effort:O"
    for name, given in {
        "__getitem__": {"name": peak},
        "at_number": {"axis": "l", "number": 0},
        "axes_of": {"names": [peak]},
        "blocks": {"names": [peak]},
        "check_columns": {"names": [peak]},
        "column": {"name": peak},
        "design": {"number": 0},
        "open": {"path": "swept.h5"},
        "report": {"path": "sweep.html"},
        "select": {"l": 0.2},
        "thinned": {"axis": "l", "stride": 2},
        "to_xarray": {"names": [peak]},
        "unit": {"name": peak},
        "values": {"number": 0, "names": [peak]},
    }.items():
        yield f"Sweep.{name}", (getattr(swept, name), given)
    swept_room = importlib.import_module("lagrange_casadi.sweep")
    yield "chosen", (swept_room.chosen, {"sweep": swept, "names": ["l"]})
    yield "is_sweep", (swept_room.is_sweep, {"path": "swept.h5"})
    held = {"solution": solution, "joint": "O"}
    for name, given in {
        "duty_of": held,
        "inertia_at": {"scene": scene, "joint": "O"},
        "judge": {"motor": of.motor, "duty": of.duty},
        "plot_duty": {"duty": of.duty, "path": "duty.png"},
        "select": {"motors": [of.motor], "duty": lambda ratio, inertia: actuators.duty_of(**held, ratio=ratio, inertia=inertia)},
    }.items():
        yield name, (getattr(actuators, name), given)
    yield "Motor.at_most", (of.motor.at_most, {"speed": 10.0})
    yield "Motor.lasting", (of.motor.lasting, {"speed": 10.0})
    yield "write_animation", (animation.write_animation, {"solution": solution, "path": "made.svg"})
    yield "default_figures", (figures.default_figures, {"solution": solution})
    drawn = {"solution": solution, "specs": [figures.TimePlot("f", ("effort:O",))], "folder": "."}
    yield "draw", (figures.draw, drawn)
    yield "TimePlot.draw", (drawn["specs"][0].draw, {"solution": solution})


def files() -> None:
    """Put what calls read into this folder."""
    for name, text in {
        "profile.csv": "x,y\n" + "\n".join(f"{0.05 * np.cos(a):.6f},{0.05 * np.sin(a):.6f}" for a in np.linspace(0.0, 6.0, 20)),
        "samples.csv": "0,0\n1,1\n2,0\n3,1\n4,0\n5,1\n",
        "profiles.csv": "name,height,width\nflat,0.03,0.01\n",
        "designs.csv": "l\n0.2\n0.3\n",
        "motors.csv": "name,stall_torque,rated_torque,peak_torque,rated_speed,max_speed,inertia\nM,9,8,20,1000,2000,1e-5\n",
    }.items():
        Path(name).write_text(text)


def rights(of: SimpleNamespace) -> dict[str, Call]:
    """All right calls, each on what it may change alone."""
    return dict([*declarations(), *laws(), *uses(of)])
