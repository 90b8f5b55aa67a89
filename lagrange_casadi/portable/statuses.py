"""Answers of an exported function, in the order of the enumeration in C, and the statuses of an
instant that each stands for.
"""

from __future__ import annotations

from ..base.status import Status

SHARED = {
    "NOT_ASSEMBLED": (Status.OUT_OF_REACH,),
    "DEAD_CENTRE": (Status.DEAD_CENTRE,),
    "NOT_CONVERGED": (Status.NOT_CONVERGED,),
    "JUMPED": (Status.JUMPED,),
    "SLOW": (Status.SLOW,),
    "INCONSISTENT": (Status.MISFIT, Status.ROW_VIOLATED),
    "NOT_CLOSED": (Status.NOT_CLOSED,),
    "NOT_FINITE": (Status.NOT_FINITE,),
    "TURNED": (Status.TURNED,),
    "BEYOND_ENDS": (Status.BEYOND_ENDS,),
    "JAMS": (Status.JAMS,),
    "AT_REST": (Status.AT_REST,),
}
"""Answers in the words of :class:`.Status`."""

ANSWERS = {status: name for name, statuses in SHARED.items() for status in statuses}
"""Answer for a status of an instant; an exported function has no neighbours of an instant, so some
never occur.
"""

_OWN = {
    "OK": "there is a result",
    "NOT_PREPARED": "the model was not prepared",
    "BAD_PARAMETER": (
        "a parameter is not finite, or out of its range, or gives a link no length or a negative"
        " mass"
    ),
    "BAD_INPUT": "an input is not finite",
    "BAD_TIME": "the time is not finite, or outside the samples or beyond the curves of the motion",
    "BAD_RATIO": "a ratio xi/l is outside 0 to 1",
    "NO_LINK": "there is no such link",
    "UNDETERMINED": (
        "equilibrium does not determine all outputs: the mechanism is over-constrained"
    ),
}

_ORDER = (
    *(
        "OK",
        "NOT_PREPARED",
        "BAD_PARAMETER",
        "BAD_INPUT",
        "BAD_TIME",
        "BAD_RATIO",
        "NO_LINK",
        "NOT_ASSEMBLED",
        "DEAD_CENTRE",
    ),
    *(
        "NOT_CONVERGED",
        "JUMPED",
        "SLOW",
        "INCONSISTENT",
        "NOT_CLOSED",
        "UNDETERMINED",
        "NOT_FINITE",
        "TURNED",
    ),
    *("BEYOND_ENDS", "JAMS", "AT_REST"),
)

STATUSES = {
    name: _OWN.get(name) or ", or ".join(status.meaning for status in SHARED[name])
    for name in _ORDER
}
