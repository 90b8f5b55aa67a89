"""Steps between instants in which a loop passes a dead centre (:mod:`.engine.dead_centres`)."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from typing import TypeAlias

import casadi as ca
import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from ..dead_centres import CLOSURES, passes, steps_near
from ..program import Program

Placed: TypeAlias = tuple[float, Array, Sequence[ca.DM], Array]
"""Width of a step [s]; times (k,) in it, the motion of the drives there as :attr:`.Program.motion`
gives it, and iterated coordinates (z, k).
"""


def dead_steps(
    program: Program,
    t: Array,
    out: Array,
    closed: npt.NDArray[np.bool_],
    most: Sequence[float],
    p: Array,
    place: Callable[[int, Array], Placed],
) -> Array:
    """Return ones (bounds, t) for instants after which a closure passes a dead centre before the
    next instant, else zeros; from instants ``t``, columns ``out`` (columns, t), whether loops are
    ``closed`` (t,), and the limits ``most`` of bounds. ``place`` takes the number of a step and
    fractions (k,) of the step.
    """
    found, closing = np.zeros((len(program.bounds), out.shape[1])), 0
    for k, (bound, limit) in enumerate(zip(program.bounds, most, strict=True)):
        if bound.beside not in CLOSURES:
            continue
        squares = np.where(closed, out[bound.column], np.nan)
        if bound.beside == "BRANCH":
            squares, limit = squares * np.abs(squares), limit * limit
        for i in steps_near(squares, t, limit):
            path = functools.partial(_closing, program, p, closing, place, int(i))
            found[k, i] = passes(path, limit)
        closing += 1
    return found


def _closing(
    program: Program,
    p: Array,
    closing: int,
    place: Callable[[int, Array], Placed],
    i: int,
    x: Array,
) -> tuple[Array, Array, Array]:
    """C, C' and slopes of a closure by its number, in doubles: see :data:`..dead_centres.Path`."""
    width, t, motion, z = place(i, x)
    squares, rates, slopes = (found.full() for found in program.closing(t[None], *motion, z, p))
    size = slopes.shape[0] // squares.shape[0]
    own = slice(closing * size, (closing + 1) * size)
    return squares[closing], width * rates[closing], slopes[own]
