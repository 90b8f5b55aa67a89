"""What an exported function may answer, in the order of the enumeration in C."""

from __future__ import annotations

STATUSES = {
    "OK": "everything is well",
    "NOT_PREPARED": "the model was not prepared",
    "BAD_PARAMETER": "a parameter is not finite, or out of its range, or leaves a link without length or with a negative mass",
    "BAD_INPUT": "an input is not finite",
    "BAD_TIME": "the time is not finite, or outside the samples of the motion",
    "BAD_RATIO": "a ratio xi/l is outside 0 to 1",
    "NO_LINK": "there is no such link",
    "NOT_ASSEMBLED": "a loop cannot be closed: its links do not reach",
    "DEAD_CENTRE": "a loop is at a dead centre: the forces are not determined",
    "NOT_CONVERGED": "the iteration of the loops did not converge",
    "JUMPED": "an iterated loop has jumped to another branch",
    "SLOW": "the iteration of the loops converges slowly: they are near a dead centre",
    "INCONSISTENT": "the motion violates a loop that is over-constrained, or a non-holonomic row",
    "NOT_CLOSED": "what was found for a loop does not satisfy its equations",
    "UNDETERMINED": "equilibrium does not determine all outputs: the mechanism has more constraints than it needs",
    "NOT_FINITE": "a result is not finite: the mechanism is singular there, or its numbers overflow",
    "TURNED": "an angle that a load sees with its turns might be a turn further",
}
