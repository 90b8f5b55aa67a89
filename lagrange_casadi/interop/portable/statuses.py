"""Answers of an exported function, in the order of the enumeration in C, and the statuses of an
instant that each stands for.
"""

from __future__ import annotations

from ...base.status import Status

_MEANINGS: dict[str, str | tuple[Status, ...]] = {
    "OK": "there is a result",
    "NOT_PREPARED": "the model was not prepared",
    "BAD_PARAMETER": "a parameter is not finite, or out of its range, or gives a link no length or"
    " a negative mass",
    "BAD_INPUT": "an input is not finite",
    "BAD_TIME": "the time is not finite, or outside the samples or beyond the curves of the motion",
    "BAD_RATIO": "a ratio xi/l is outside 0 to 1",
    "NO_LINK": "there is no such link",
    "NOT_ASSEMBLED": (Status.OUT_OF_REACH,),
    "DEAD_CENTRE": (Status.DEAD_CENTRE,),
    "NOT_CONVERGED": (Status.NOT_CONVERGED,),
    "JUMPED": (Status.JUMPED,),
    "SLOW": (Status.SLOW,),
    "INCONSISTENT": (Status.MISFIT, Status.ROW_VIOLATED),
    "NOT_CLOSED": (Status.NOT_CLOSED,),
    "UNDETERMINED": "equilibrium does not determine all outputs: the mechanism is over-constrained",
    "NOT_FINITE": (Status.NOT_FINITE,),
    "TURNED": (Status.TURNED,),
    "BEYOND_ENDS": (Status.BEYOND_ENDS,),
    "JAMS": (Status.JAMS,),
    "AT_REST": (Status.AT_REST,),
    "PASSES_DEAD_CENTRE": (Status.PASSES_DEAD_CENTRE,),
    "STROKE": (Status.STROKE,),
    "LOST_CONTACT": (Status.LOST_CONTACT,),
}
"""Meanings of all answers, or the statuses in whose words they are, in the order of C."""

ANSWERS = {
    status: name
    for name, known in _MEANINGS.items()
    if isinstance(known, tuple)
    for status in known
}
"""Answer for a status of an instant."""

STATUSES = {
    name: known if isinstance(known, str) else ", or ".join(status.meaning for status in known)
    for name, known in _MEANINGS.items()
}
"""Meaning of each answer."""
