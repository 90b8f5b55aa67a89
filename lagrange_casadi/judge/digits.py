"""What the digits of a solution leave open, and the sizes beside which its residuals are large or small."""

from __future__ import annotations

import numpy as np

from ..arithmetic.compensated import DTYPES, ROUNDING
from ..base.quantities import Output
from ..base.vocabulary import Precision
from ..declare.description import coordinates_of
from ..instants.solution import Solution

ROUNDINGS = 4.0
TOLERANCE, LOOSE = 1e-9, 1e-3
"""A residual above it means that the solution is wrong, not that it is rounded; in doubles, and where less was asked for."""


def blur(solution: Solution) -> float:
    """What the reported angles leave open of a phase: one rounding of the largest of them [rad]."""
    angles = [Output("motion", name) for name, kind in coordinates_of(solution.description).items() if kind == "angle"]
    angles += [Output("pose", name, "angle") for name in solution.description["bodies"]]
    reported = (solution.outputs[angle] for angle in angles if angle in solution.outputs)
    return rounding(solution) * max((float(np.max(np.abs(values))) for values in reported), default=0.0)


def rounding(solution: Solution) -> float:
    """The largest relative error of one rounding."""
    return ROUNDING["single" if solution.provenance.precision == "single" else "double"]


def size(solution: Solution) -> float:
    """The length of all links [m]."""
    return sum(body["length"] or 0.0 for body in solution.description["bodies"].values()) or 1.0


def extent(solution: Solution) -> float:
    """The size of the mechanism, and how far from the origin it stands: the largest of places."""
    joints = solution.description["joints"].values()
    points = [joint[side] for joint in joints for side in ("parent", "child")]
    points += [point for load in solution.description["loads"].values() for point in load["points"]]
    return size(solution) + max((abs(p[k]) for p in points if p["body"] == "ground" for k in "xyz" if k in p), default=0.0)


def least(solution: Solution) -> float:
    """The force beside which what underflows is as small as a rounding."""
    precision: Precision = "single" if solution.provenance.precision == "single" else "double"
    return float(np.finfo(DTYPES[precision]).tiny) / ROUNDING[precision]


def coarseness(solution: Solution) -> float:
    """What a rounding is of the least that fails."""
    return ROUNDINGS * rounding(solution) / (LOOSE if solution.provenance.precision == "single" else TOLERANCE)
