"""SciPy's integration of a machine: over its time, or over its angle."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ...base.arrays import Array

Watched = Callable[[float, Array], float]
"""A function of the variable and the state, that is zero at an event."""

_FINEST = 2.3e-14
"""Relative error of a step that is rounding."""


def terminal(event: Watched, direction: float = 0.0) -> Watched:
    """Let an event end the integration, where its function rises or falls, or any way."""
    vars(event).update(terminal=True, direction=direction)
    return event


def integrated(
    rates: Callable[[float, Array], Sequence[float] | Array],
    ends: tuple[float, float],
    state: Array,
    accuracy: float,
    sizes: Array | float,
    events: Sequence[Watched],
    **options: Any,
) -> Any:
    """SciPy's result of an integration; ``sizes`` are those of states that count as zero, beside
    which errors are absolute.
    """
    from scipy.integrate import DOP853, solve_ivp

    class Careful(DOP853):  # type: ignore[misc]
        """With the plain fifth-order estimate of a step's error: its own one is smaller by the
        ratio of two estimates, and passes more steps over jumps and corners of a load.
        """

        def _estimate_error_norm(self, K: Array, h: float, scale: Array) -> float:  # noqa: N803
            errors = K.T @ self.E5 / scale
            return float(abs(h) * np.linalg.norm(errors) / math.sqrt(errors.size))

    with np.errstate(invalid="ignore"):
        return solve_ivp(
            *(rates, ends, state),
            method=Careful,
            rtol=max(accuracy, _FINEST),
            atol=accuracy * sizes,
            events=events,
            **options,
        )
