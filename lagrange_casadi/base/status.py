"""Reasons why an instant or a design has no result, by number and in words."""

from __future__ import annotations

import enum


class Status(enum.IntEnum):
    """Validity of a result, or the reason why there is none; each with its ``meaning`` in words."""

    meaning: str

    def __new__(cls, number: int, meaning: str = "") -> Status:
        """Make the status of a number."""
        status = int.__new__(cls, number)
        status._value_ = number
        status.meaning = meaning
        return status

    OK = 0, "there is a result"
    NOT_CONVERGED = 1, "the iterated loops did not converge"
    NOT_FINITE = 2, "a result is not finite: the mechanism is singular, or its numbers overflow"
    SLOW = 3, "the iterated loops converge slowly: they are near a dead centre"
    OUT_OF_REACH = 4, "a loop cannot be closed: its links do not reach"
    JUMPED = 5, "an iterated loop has jumped to another branch: take more instants"
    DEAD_CENTRE = (
        6,
        (
            "a loop is at a dead centre, a joint is in gimbal lock, a two-force link lies along"
            " its beside= direction, or the drives cannot produce the motion: forces are"
            " indeterminate"
        ),
    )
    PASSES_DEAD_CENTRE = (
        7,
        (
            "between two instants a loop passes through a dead centre, a joint through gimbal"
            " lock, a two-force link through its beside= direction, or the drives through a"
            " position in which they cannot produce the motion"
        ),
    )
    MISFIT = 8, "the loops are over-constrained and do not fit"
    ROW_VIOLATED = 9, "the motion violates a non-holonomic constraint"
    IMPOSSIBLE = (
        10,
        (
            "a part is impossible: a length is not positive, a mass or density is negative, a"
            " load point is not on its link, a move is not feasible, or gears do not fit"
        ),
    )
    INVALID = 11, "a parameter is not finite"
    NOT_CLOSED = 12, "the solution of a loop does not satisfy its equations"
    UNCERTIFIED = (
        13,
        "this design was checked in full and failed its certificate: others may be wrong too",
    )
    TURNED = (
        14,
        "a load depends on the number of revolutions of an angle, which cannot be determined",
    )
    PEAK_NOT_TOLD = (
        15,
        (
            "a peak cannot be located between the instants: what a comparison or a remainder"
            " switches there switches too often, or a quantity grows too slowly; refine one design"
            " to see which quantity and load, and smooth the load, or want other outputs"
        ),
    )
    BEYOND_ENDS = 16, "the argument of a curve is outside the curve's range"
    NO_INSTANTS = (
        17,
        (
            "there are no instants: the motion does not reach the requested range, or the range"
            " ends before it starts"
        ),
    )
    JAMS = 18, "the mechanism jams: its friction forces have no unique solution"
    AT_REST = (
        19,
        (
            "a joint with friction is at rest, so its friction is indeterminate: take instants of"
            " motion, or give the friction smooth="
        ),
    )
    CORNER = (
        20,
        (
            "the slope of a motion, a constraint or a lift jumps, where forces have no bound, or"
            " its value at a point differs from that on both sides"
        ),
    )
    STROKE = 21, "a cylinder or a strut is longer than open, or shorter than closed"
    LOST_CONTACT = 22, "a contact pulls or slides"
