"""Names of quantities in a page: the table's words, as short as a chart's legend."""

from __future__ import annotations

from ...base.quantities import Output
from ...base.tables import Table

_CUT = (
    " of the joint's coordinate",
    " of the joint about its point on the child",
    " of the joint's",
    " of the joint",
    " of the drive",
    ", the largest along the link",
)

GROUPS = {
    "effort": "Efforts",
    "holding": "Efforts with rests",
    "reaction": "Reactions",
    "section": "Section forces",
    "stress": "Stresses, largest along the link",
    "utilisation": "Utilisation",
    "deflection": "Deflections",
    "output": "Own outputs",
    "motion": "Motion of joints",
    "load": "Loads",
    "friction": "Friction",
    "multiplier": "Multipliers",
    "pose": "Places of bodies",
    "sensitivity": "Sensitivities",
    "certificate": "Certificate",
}
"""The kinds of quantities, in the order in which they are offered."""


def what(output: Output, table: Table) -> str:
    """Name of a quantity within its part."""
    if output.group == "output":
        return ""
    words = output.meant(table).long_name
    if output.group != "reaction":
        words = words.partition(":")[0]
    for end in _CUT:
        words = words.replace(end, "")
    return words
