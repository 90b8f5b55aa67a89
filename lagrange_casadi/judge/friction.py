"""Frictions of a solution held to their laws, from its own arrays: what is reported to press, and how fast it slides."""

from __future__ import annotations

import numpy as np

from ..declare.density import Array
from ..declare.description import Description
from ..instants.solution import Solution
from ..quantities import Output
from .placing import Moving, axis_of

_SLOW = 1e-9
"""Of a joint's fastest rate: below, either sign may be that of its rate."""


def law_gaps(solution: Solution, bodies: dict[str, Moving]) -> tuple[Array, float] | None:
    """How far frictions are from what their laws say (t,), over what they would be under the largest reaction of the cycle.

    None where there is no friction, or what it takes is not among the outputs.
    """
    worst, found = np.zeros_like(solution.t), False
    for name, load in solution.description["loads"].items():
        if "friction" not in load:
            continue
        told, joint = load["friction"], solution.description["joints"][load["friction"]["coordinate"]]
        value, rate = (
            solution.outputs.get(output)
            for output in (Output("friction", name, "along"), Output("motion", told["coordinate"], "rate"))
        )
        if value is None or rate is None or Output("reaction", told["coordinate"], "fx") not in solution.outputs:
            continue
        found = True
        numbers = told["numbers"]
        press, most = _pressing(solution, told["coordinate"], joint, numbers, bodies)
        speed = np.abs(rate) * numbers.get("radius", 1.0)
        mu = np.full_like(rate, numbers.get("mu", 0.0))
        if "static" in numbers:
            mu += (numbers["static"] - mu) * np.exp(-((speed / numbers["stribeck"]) ** 2))
        steady = -numbers.get("viscous", 0.0) * rate
        dry, size = value - steady, mu * press
        if "smooth" in numbers:
            gap = np.abs(dry + np.tanh(rate / numbers["smooth"]) * size)
        else:
            gap = np.where(
                np.abs(rate) > _SLOW * np.max(np.abs(rate)), np.abs(dry + np.sign(rate) * size), np.abs(np.abs(dry) - size)
            )
        scale = float(np.max(mu)) * most + float(np.max(np.abs(steady)))
        worst = np.maximum(worst, np.divide(gap, scale, out=gap.copy(), where=scale > 0.0))
    return (worst, 1.0) if found else None


def _pressing(
    solution: Solution, name: str, joint: Description, numbers: dict[str, float], bodies: dict[str, Moving]
) -> tuple[Array, float]:
    """What mu is multiplied by, and what it would be under the largest reaction of all joints."""
    reaction = solution.reaction(name)
    joints = {o.part for o in solution.outputs if o.group == "reaction"}
    most = max(float(np.max(np.hypot(solution.reaction(one).fx, solution.reaction(one).fy))) for one in joints)
    if joint["coordinate"] == "angle":
        radius = numbers.get("radius", 0.0)
        return radius * np.hypot(reaction.fx, reaction.fy), radius * most
    across = 1j * axis_of(joint, bodies[joint["parent"]["body"]])
    normal = (np.conj(across) * (reaction.fx + 1j * reaction.fy)).real
    if "length" not in numbers or reaction.mz is None:
        return np.abs(normal), most
    tilt = reaction.mz / numbers["length"]
    turned = max(
        (float(np.max(np.abs(moment))) for one in joints if (moment := solution.reaction(one).mz) is not None), default=0.0
    )
    return np.abs(normal / 2 + tilt) + np.abs(normal / 2 - tilt), most + 2.0 * turned / numbers["length"]
