"""Reasons why an instant or a design has no result, by number and in words."""

from __future__ import annotations

import enum


class Status(enum.IntEnum):
    """Validity of a result, or the reason why there is none."""

    OK = 0
    NOT_CONVERGED = 1
    NOT_FINITE = 2
    SLOW = 3
    OUT_OF_REACH = 4
    JUMPED = 5
    DEAD_CENTRE = 6
    PASSES_DEAD_CENTRE = 7
    MISFIT = 8
    ROW_VIOLATED = 9
    IMPOSSIBLE = 10
    INVALID = 11
    NOT_CLOSED = 12
    UNCERTIFIED = 13
    TURNED = 14
    PEAK_NOT_TOLD = 15
    BEYOND_ENDS = 16
    NO_INSTANTS = 17
    JAMS = 18
    AT_REST = 19
    CORNER = 20

    @property
    def meaning(self) -> str:
        """Meaning of the status in words."""
        return _MEANINGS[self]


_MEANINGS = {
    Status.OK: "there is a result",
    Status.NOT_CONVERGED: "the iterated loops did not converge",
    Status.NOT_FINITE: (
        "a result is not finite: the mechanism is singular, or its numbers overflow"
    ),
    Status.SLOW: "the iterated loops converge slowly: they are near a dead centre",
    Status.OUT_OF_REACH: "a loop cannot be closed: its links do not reach",
    Status.JUMPED: "an iterated loop has jumped to another branch: take more instants",
    Status.DEAD_CENTRE: (
        "a loop is at a dead centre, a joint is in gimbal lock, a two-force link lies along its"
        " beside= direction, or the drives cannot produce the motion: forces are indeterminate"
    ),
    Status.PASSES_DEAD_CENTRE: (
        "between two instants a loop passes through a dead centre, a joint through gimbal lock, a"
        " two-force link through its beside= direction, or the drives through a position in which"
        " they cannot produce the motion"
    ),
    Status.MISFIT: "the loops are over-constrained and do not fit",
    Status.ROW_VIOLATED: "the motion violates a non-holonomic constraint",
    Status.IMPOSSIBLE: (
        "a part is impossible: a length is not positive, a mass or density is negative, a load"
        " point is not on its link, a move is not feasible, or gears do not fit"
    ),
    Status.INVALID: "a parameter is not finite",
    Status.NOT_CLOSED: "the solution of a loop does not satisfy its equations",
    Status.UNCERTIFIED: (
        "this design was checked in full and failed its certificate: others may be wrong too"
    ),
    Status.TURNED: (
        "a load depends on the number of revolutions of an angle, which cannot be determined"
    ),
    Status.PEAK_NOT_TOLD: (
        "a peak cannot be located between the instants: what a comparison or a remainder switches"
        " there switches too often, or a quantity grows too slowly; refine one design to see which"
        " quantity and load, and smooth the load, or want other outputs"
    ),
    Status.BEYOND_ENDS: "the argument of a curve is outside the curve's range",
    Status.JAMS: "the mechanism jams: its friction forces have no unique solution",
    Status.AT_REST: (
        "a joint with friction is at rest, so its friction is indeterminate: take instants of"
        " motion, or give the friction smooth="
    ),
    Status.CORNER: (
        "the slope of a motion, a constraint or a lift jumps, where forces have no bound, or its"
        " value at a point differs from that on both sides"
    ),
    Status.NO_INSTANTS: (
        "there are no instants: the motion does not reach the requested range, or the range ends"
        " before it starts"
    ),
}
