"""The order in which a solution keeps its outputs."""

from __future__ import annotations

from collections.abc import Mapping

from ..base.arrays import Array
from ..base.quantities import Output
from ..base.tables import Table, table_of
from ..declare.description import Description, in_space, parts_of


def table_of_described(description: Description) -> Table:
    """The table of the quantities of a described mechanism: that of planar ones, or that of spatial ones, whose gravity has a z."""
    return table_of(in_space(description))


def in_order(outputs: Mapping[Output, Array], description: Description) -> dict[Output, Array]:
    """Outputs in the order in which a solution keeps them: by kind, then by part as declared, then as in the table.

    Raises ``ValueError`` for one of a part that is not declared.
    """
    table = table_of_described(description)
    rows = table.rows
    groups = list(dict.fromkeys(q.group for q in rows))
    sections = groups.index("section")
    parts = parts_of(description)

    def rank(output: Output) -> tuple[int, int, str, str, int, int]:
        group = sections if output.along else groups.index(output.group)
        part, _, axis = output.part.partition(":")
        return group, parts.index(part), axis, output.station, rows.index(output.meant(table)), output.power or 0

    return {output: outputs[output] for output in sorted(outputs, key=rank)}
