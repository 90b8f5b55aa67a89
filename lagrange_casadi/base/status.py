"""Reasons why an instant, or a design, has no result: their numbers, and the same in words."""

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
    Status.NOT_FINITE: "a result is not finite: the mechanism is singular, or its numbers overflow",
    Status.SLOW: "the iterated loops converge slowly: they are near a dead centre",
    Status.OUT_OF_REACH: "a loop cannot be closed: its links do not reach",
    Status.JUMPED: "an iterated loop has jumped to another branch: more instants may help",
    Status.DEAD_CENTRE: (
        "a loop is at a dead centre, a joint in gimbal lock, a bar along its beside, or drives"
        " cannot make the motion: forces are open"
    ),
    Status.PASSES_DEAD_CENTRE: (
        "a loop passes a dead centre between two instants, a joint gimbal lock, a bar its beside,"
        " or drives such a place"
    ),
    Status.MISFIT: "loops are over-constrained and do not fit",
    Status.ROW_VIOLATED: "the motion violates a non-holonomic constraint",
    Status.IMPOSSIBLE: (
        "a length is not positive, a mass or density is negative, a station is off its link, a move"
        " cannot be, or gears do not fit"
    ),
    Status.INVALID: "a parameter is not finite",
    Status.NOT_CLOSED: "what was found for a loop does not satisfy its equations",
    Status.UNCERTIFIED: (
        "the design was checked in full, and fails its certificate: others may be wrong as well"
    ),
    Status.TURNED: "an angle that a load sees with its turns might be a turn further",
    Status.PEAK_NOT_TOLD: (
        "a peak cannot be told: too much may hide between the instants; more instants may help"
    ),
    Status.BEYOND_ENDS: "what is put into a curve is beyond its ends",
    Status.JAMS: "the mechanism jams: friction has no force that holds its law, or several",
    Status.AT_REST: (
        "a joint that rubs is at rest: its friction is open; take instants that move, or smooth"
        " friction"
    ),
    Status.CORNER: (
        "the slope of a motion, a constraint or a lift jumps, and forces there are without bound;"
        " or one is other at a place than on both sides"
    ),
    Status.NO_INSTANTS: (
        "its instants cannot be: the motion does not go where they are asked for, or they end"
        " before they start"
    ),
}
