"""What the split-link peers share: the slider-crank as a tree that is cut open at the guide.

A tree program knows nothing of the guide. With the slider's mass on the rod's tip, the guide's
force N is what makes the pin A free of torque: N is the open tree's effort of A, by the program's
own inverse dynamics, over the rod's reach along the guide. Every effort less N times its arm is
that of the closed loop.
"""

from __future__ import annotations

import numpy as np

from .paper_case import Array, SliderCrank


def joint_motion(case: SliderCrank, t: Array) -> tuple[Array, Array, Array]:
    """Coordinates of the pins O and A, the latter relative to the crank, their rates and
    accelerations: (t, 2) each.
    """
    theta, omega, alpha = case.motion(t)
    s, c = case.r / case.l * np.sin(theta), case.r / case.l * np.cos(theta)
    phi = np.arcsin(-s)  # the rod's angle from the guide
    rate = -c * omega / np.cos(phi)
    acceleration = (rate**2 * np.sin(phi) - c * alpha + s * omega**2) / np.cos(phi)
    return (
        np.stack([theta, phi - theta], -1),
        np.stack([omega, rate - omega], -1),
        np.stack([alpha, acceleration - alpha], -1),
    )


def close_loop(case: SliderCrank, q: Array, xi: Array, pin: Array, welds: Array) -> Array:
    """Axial, shear and bending, (3, t, xi), from the open tree's efforts: of the pin A, (t,), and
    of the welds, (3, t, xi).

    A weld's effort is what the part towards A does to the part towards B, along the rod, across it
    and about the section.
    """
    phi = q.sum(axis=1)[:, None]
    guide = pin[:, None] / (case.l * np.cos(phi))
    result = np.negative(welds)
    result[0] += guide * np.sin(phi)
    result[1] += guide * np.cos(phi)
    result[2] += pin[:, None] * (1.0 - xi)
    return result
