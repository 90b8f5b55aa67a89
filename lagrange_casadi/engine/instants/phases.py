"""The angles of an evaluation without their whole turns, to more digits than they are reported
with.

An angle of many turns is reported to the digits that its turns leave. What is made of it knows it
better (:mod:`.stages`), and so must whoever checks that.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...base.arrays import Array
from ...base.interpret import followable, interpret, numpy_arithmetic
from ...base.quantities import Output
from ..program import Program

_TURN = np.longdouble("6.283185307179586476925286766559005768")


def phases(program: Program, out: Array, t: Array, p: Array) -> dict[Output, Array]:
    """The angles of drives from their laws of motion, and of loops from the columns ``out``
    (columns, t).
    """
    laws, coordinates = program.laws, program.data.kinds.coordinates
    rows = {angle: out[program.outputs[angle]] for angle in program.loop_angles}
    driven = [np.longdouble(row) for row in np.atleast_2d(program.motion(t[None], p)[0].full())]
    if followable(laws.motion):
        known = numpy_arithmetic()
        # A turn is meant, not the double that is nearest to it.
        exact = replace(
            known, constant=lambda value: _TURN if value == math.tau else known.constant(value)
        )
        driven = list(
            interpret(laws.motion, [[np.longdouble(t)], [np.longdouble(x) for x in p]], exact)[0]
        )
    for name, angle in zip(program.driven, driven, strict=True):
        if coordinates[name] == "angle" and Output("motion", name) in program.outputs:
            whole = np.broadcast_to(
                np.asarray(angle - _TURN * np.rint(angle / _TURN), float), t.shape
            )
            rows[Output("motion", name)] = np.asarray(whole)
    return {angle: np.array(row, float) for angle, row in rows.items()}


def outputs_of(program: Program, out: Array) -> dict[Output, Array]:
    """The outputs among the columns ``out`` (columns, ..., t) of a graph; angles go on where they
    would jump by a turn.

    They are those columns, not copies: in ``out`` too angles go on after this.
    """
    unwind(program, out)
    return {output: out[k] for output, k in program.outputs.items()}


def unwind(program: Program, out: Array) -> None:
    """Let angles go on where they would jump by a turn, in the columns ``out`` (columns, ..., t)
    of a graph.
    """
    parts, angles = program.loop_rows
    add_turns(
        program,
        out,
        [math.tau * (out[k] - out[k][..., :1]) if whole else _jumps(out[k]) for k, whole in parts],
    )
    rows = [k for k, _ in angles]
    whole = np.ceil(out[rows, ..., :1] / math.tau - 0.5)
    if whole.any():
        out[rows] -= math.tau * whole


def add_turns(program: Program, out: Array, turns: Sequence[Array | None]) -> None:
    """Add to the angles that loops set, in the columns ``out`` (columns, ..., t) of a graph, the
    turns [rad] of their parts; None is said for a part without turns.
    """
    for k, signs in program.loop_rows[1]:
        for number, sign in signs:
            if (turn := turns[number]) is not None:
                out[k] += sign * turn


def _jumps(angle: Array) -> Array | None:
    """The turns [rad] that let an angle (..., t) go on where it jumps; None where it never does."""
    jumps = not np.abs(angle[..., 1:] - angle[..., :-1]).max(initial=0.0) < math.pi
    return np.unwrap(angle) - angle if jumps else None
