"""How the first and the last instant move with the parameters, where they do."""

from __future__ import annotations

import casadi as ca
import numpy as np

from ..declare.density import Array
from ..declare.motion import motion_function
from ..declare.scene import Scene
from ..declare.times import Timing


def end_slopes(scene: Scene, timing: Timing, first: float, last: float, p: Array) -> Array:
    """The derivatives by all parameters of the first and the last instant, (2, parameters) [s].

    Where instants are asked for by a drive, that of coordinate = bound at its time.
    """
    if timing.shared or not p.size:
        return np.zeros((2, p.size))
    bounds = timing.bound_slopes(p)
    if not timing.joint:
        return bounds
    symbols, law = scene.mechanism.symbols, {timing.joint: scene.laws[timing.joint]}
    motion = motion_function(law, symbols)
    rates = np.array([float(motion(time, p)[1]) for time in (first, last)])
    own = np.zeros((2, p.size))
    if motion.is_a("SXFunction"):  # samples are numbers
        t, values = motion.sx_in()
        slope = ca.Function("slope", [t, values], [ca.densify(ca.jacobian(motion(t, values)[0], values))])
        own = np.stack([slope(time, p).full().ravel() for time in (first, last)])
    return np.asarray((bounds - own) / rates[:, None])
