"""Section forces in an exported program: the functions that give them, and the members of their
struct.
"""

from __future__ import annotations

from ...base.quantities import Output
from ...base.tables import ON_INBOARD, PLANE, Table
from .contract import Contract
from .exported_program import ExportedProgram
from .text import template


def law_in_words(c: Contract) -> str:
    """Meaning of the members of a section law."""
    outputs = [Output.of(m.source) for m in c.outputs]
    along = {output.member for output in outputs if output.group == "spread"}
    return template(
        "section_law.h",
        space=c.table is not PLANE,
        loaded=along.intersection(c.table.distributed),
        thick=along.intersection(c.table.couples),
    ).rstrip()


def functions(exported: ExportedProgram) -> str:
    """The C functions that give the forces inside links."""
    c = exported.contract
    names = {Output.of(m.source): m.name for m in c.outputs}
    links: list[str] = []
    place = int(exported.extent_first)
    for link in c.links:
        function, inputs = exported.sections[link.name]
        links.append(f"  case {link.constant}:")
        for vector, outputs in (("law", inputs.law), ("acting", inputs.acting)):
            links += [
                f"    {vector}[{i}] = outputs->{names[output]};" for i, output in enumerate(outputs)
            ]
        links += [
            f"    arg[2] = model->matter + {place};",
            f"    {function}(arg, res);",
            "    break;",
        ]
        place += exported.functions[function].size1_in("matter")
    acting = max(len(inputs.acting) for _, inputs in exported.sections.values())
    return template(
        "sections.c",
        **c.words,
        none=" = ".join(f"forces->{force}" for force in c.table.forces),
        law=len(c.table.law),
        acting=f", acting[{acting}]" if acting else "",
        given="acting" if acting else "0",
        many=len(c.table.forces),
        links="\n".join(links),
        put="\n".join(f"  forces->{force} = found[{i}];" for i, force in enumerate(c.table.forces)),
        indent=" " * (len(c.prefix) * 2 + 16),
    )


def about(table: Table, force: str) -> str:
    """A force as the header describes it: its unit, sign and range."""
    row = table.row("section", force)
    sign = row.sign.removeprefix(f"{ON_INBOARD}, ").partition(f": {ON_INBOARD}")[0]
    signed = len(table.parts("section", force)) == 1
    return f"{row.long_name} [{row.unit}]; {sign}{'; any number' if signed else ''}"


def comparisons(table: Table) -> str:
    """Comparisons of each force in the self-test."""
    return "\n".join(
        f'      compare("{table.row("section", force).long_name}", row[{k}], (double)'
        f" forces.{force}, forces_off[{len(table.forces)}*i + {k}], 0);"
        for k, force in enumerate(table.forces)
    )
