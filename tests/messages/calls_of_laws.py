"""Right calls of what makes motions, densities, cross-sections, notches, bearings, figures, and
designs.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterator

import casadi as ca
import numpy as np
from calls_declaring import BAR, STEEL, TURN, Call, calls, lift

from lagrange_casadi import (
    actuators,
    animation,
    beams,
    bearings,
    density,
    figures,
    motion,
    strength,
)
from lagrange_casadi.studies.optimise import Constraint, Term
from lagrange_casadi.studies.sweep import Condition, Grid, Listed, Range, Values

BALL = {"name": "B", "bore": 0.02, "outer": 0.04, "width": 0.01, "dynamic": 9e3, "static": 5e3}
"""A ball bearing's numbers."""


def laws() -> Iterator[tuple[str, Call]]:
    """Calls of what makes motions, densities, cross-sections, notches, bearings, figures."""
    points = {"x": [0.0, 0.3, 0.7, 1.0], "y": [1.0, 2.0, 2.0, 1.0]}
    curve = importlib.import_module("lagrange_casadi").curve
    bend = curve(**points)
    yield from {
        "curve": (curve, points),
        "Curve.__call__": (bend, {"x": 0.5}),
        "table": (
            importlib.import_module("lagrange_casadi").table,
            {"x": ca.SX.sym("x"), "places": [0, 1], "values": [0, 1]},
        ),
    }.items()
    move = motion.move("90 deg", time=1.0)
    yield from calls(
        "motion.",
        motion,
        {
            "polynomial": {"*": (0.0, 1.0)},
            "harmonic": {"mean": 0.0, "amplitude": 1.0, "frequency": 1.0},
            "expression": {"law": lift},
            "samples": {"times": [0.0, 1.0, 2.0, 3.0], "values": [0.0, 1.0, 0.0, 1.0]},
            "dwell": {"time": 1.0},
            "move": {"to": 1.0, "time": 1.0},
            "moves": {"parts": [move, motion.dwell(1.0)]},
            "read_samples": {"path": "samples.csv"},
            "read_motion": {"path": "samples.csv", "columns": {"J": 2}},
            "s_curve": {"share": 0.3, "rounding": 0.5},
            "trapezoid": {"share": 0.3},
        },
    )
    yield "Motion.__call__", (TURN, {"x": ca.SX.sym("t")})
    even = density.uniform(1.0)
    yield from calls(
        "density.",
        density,
        {
            "uniform": {"mass": 1.0},
            "polynomial": {"*": (1.0, 1.0)},
            "tabulated": {"ratios": [0.0, 1.0], "values": [1.0, 2.0]},
            "along": {"curve": bend},
            "thick": {"density": even, "yy": 1e-4, "zz": 1e-4},
        },
    )
    flat = {"height": 0.03, "width": 0.02}
    walls = {**flat, "web": 0.002, "flange": 0.002}
    wide = beams.rectangle(height=0.04, width=0.01)
    yield from calls(
        "beams.",
        beams,
        {
            "rectangle": flat,
            "ellipse": flat,
            "round_bar": {"diameter": 0.02},
            "tube": {"diameter": 0.02, "wall": 0.002},
            "i_section": walls,
            "t_section": walls,
            "c_section": walls,
            "box": walls,
            "hollow_section": {**flat, "wall": 2e-3, "outer_radius": 3e-3, "inner_radius": 2e-3},
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
        },
    )
    yield from {
        "Profile.shape": (beams.Profile("p", flat).shape, {"kind": "rectangle"}),
        "Material.but": (STEEL.but, {"density": 7000.0}),
        "Shape.properties": (BAR.properties, {}),
    }.items()
    yield from calls(
        "bearings.",
        bearings,
        {
            "Pin": {"diameter": 0.01, "eye": 0.01, "cheek": 0.01, "material": STEEL},
            "Plain": {"bore": 0.01, "width": 0.01},
            "Rolling": {"dynamic": 1e4, "hours": 1e4},
            "bending_of_pin": {"force": 100.0, "eye": 0.01, "cheek": 0.01},
            "equivalent_load": {"load": [1.0, 2.0], "turned": [1.0, 1.0]},
            "rated_hours": {"dynamic": 1e4, "load": 10.0, "rpm": 100.0},
            "RollingBearing": BALL,
            "deep_groove": {"series": "62"},
            "dynamic_rating": {"element": 0.01, "pitch": 0.05, "count": 8},
            "static_rating": {"element": 0.01, "pitch": 0.05, "count": 8},
            "read_bearings": {"path": "bearings.csv"},
        },
    )
    ball = bearings.RollingBearing(**BALL)
    yield "RollingBearing.rolling", (ball.rolling, {"hours": 1e4})
    yield from calls(
        "figures.",
        figures,
        {
            "DeflectionPlot": {"name": "f", "link": "arm"},
            "MechanismDrawing": {},
            "PolarPlots": {"name": "f", "joints": ("O",)},
            "SectionDiagrams": {"name": "f", "links": ("arm",)},
            "SectionMaps": {"name": "f", "link": "arm"},
            "SpanPlot": {"name": "f", "quantity": "section:arm:bending", "t": 0.5},
            "StrengthPlot": {"name": "f", "link": "arm"},
            "TimePlot": {"name": "f", "quantities": ("effort:O",)},
            "UtilisationPlot": {"name": "f", "links": ("arm",)},
        },
    )
    yield "Film", (animation.Film, {})
    speeds = {"rated_speed": 100.0, "max_speed": 200.0}
    motor = {"stall_torque": 9.0, "rated_torque": 8.0, "peak_torque": 20.0, "inertia": 1e-5}
    yield from {
        "Motor": (actuators.Motor, {"name": "M", **motor, **speeds}),
        "read_motors": (actuators.read_motors, {"path": "motors.csv"}),
    }.items()
    amplitude = {"amplitude": 1e8, "material": STEEL}
    yield from calls(
        "strength.",
        strength,
        {
            "critical_plane": {"values": np.ones((3, 4))},
            "plane_factor": {"plane": strength.critical_plane(np.eye(3, 4)), "material": STEEL},
            "critical_stress": {"slenderness": 50.0, "elasticity": 2e11, "strength": 3e8},
            "factor": {**amplitude, "mean": 0.0},
            "reversed_amplitude": {**amplitude, "mean": 0.0},
            "cycles": amplitude,
            "rainflow": {"history": [0.0, 1.0, -1.0, 0.5]},
        },
    )
    yield from {
        "Range": (Range, {"start": 0.1, "stop": 0.2, "count": 3}),
        "Values": (Values, {"values": (0.1, 0.2)}),
        "Grid": (Grid, {"axes": {"l": Values((0.1, 0.2))}}),
        "Listed": (Listed, {"names": ("l",), "rows": np.array([[0.1], [0.2]])}),
        "Condition": (Condition, {"name": "l", "relation": "<", "value": 1.0}),
        "Condition.parse": (Condition.parse, {"text": "l<0.3"}),
        "Term.parse": (Term.parse, {"text": "l", "parameters": {"l": 0.5}}),
    }.items()
    bound = {"text": "l<0.3", "parameters": {"l": 0.5}}
    yield "Constraint.parse", (Constraint.parse, bound)
