"""Section forces in an exported program: the functions that give them, and the members of their
struct.
"""

from __future__ import annotations

from ...base.quantities import Output
from ...base.tables import ON_INBOARD, PLANE, Table
from .contract import Contract
from .exported_program import ExportedProgram
from .text import template

LAW = """ Those of a section law are for _section, which is all you need.
   They mean: axial = n0 + n1 mu0 + n2 mu1, shear = f0 + f1 mu0 + f2 mu1, bending = m0 + f0 (l - xi)
   + f1 (mu1 - xi mu0) + f2 (mu2 - xi mu1) at xi from the base, where mu0 is the mass from there to
   the tip, mu1 and mu2 its first and second moment about the base; and then what acts on the link
   at stations, where something joins or loads it between its ends, beyond xi."""
LAW_IN_SPACE = """ Those of a section law are for _section, which is all you need.
   They mean: axial = n0 + n1 mu0 + n2 mu1, shear_y = fy0 + fy1 mu0 + fy2 mu1,
   shear_z = fz0 + fz1 mu0 + fz2 mu1, torsion = mx0,
   bending_z = mz0 + fy0 (l - xi) + fy1 (mu1 - xi mu0) + fy2 (mu2 - xi mu1),
   bending_y = my0 - fz0 (l - xi) - fz1 (mu1 - xi mu0) - fz2 (mu2 - xi mu1)
   at xi from the base, where mu0 is the mass from there to the tip, mu1 and mu2 its first and
   second moment about the base; and then what acts on the link at stations, where something joins
   or loads it between its ends, beyond xi."""

LOADED = """
   And then loads along the link; those beyond a section act on it: per length the sums
   of qn0, qn1, qn2, ... and of qf0, qf1, qf2, ... (in space qfy0, ... and qfz0, ...) times 1, s,
   s^2, ..., where s = (end - xi/l)/width is between 0 and 1."""
THICK = """
   And then the rotary inertia of slices, couples along the link: per length the sums of cx0, cx1,
   ..., of cy0, ... and of cz0, ... times 1, s, ...; those beyond a section change its torsion,
   bending_y and bending_z."""


def law_in_words(c: Contract) -> str:
    """Meaning of the members of a section law; empty if there is none."""
    if not c.links:
        return ""
    law = LAW if c.table is PLANE else LAW_IN_SPACE
    return (
        law
        + (LOADED if _acts(c, c.table.distributed) else "")
        + (THICK if _acts(c, c.table.couples) else "")
    )


def functions(c: Contract, exported: ExportedProgram) -> str:
    """The C functions that give the forces inside links."""
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


def _acts(c: Contract, members: tuple[str, ...]) -> bool:
    """Return whether a distributed load of some link has one of these members."""
    outputs = (Output.of(m.source) for m in c.outputs)
    return any(output.group == "spread" and output.member in members for output in outputs)


def about(table: Table, force: str) -> str:
    """A force as the header describes it: its unit, sign and range."""
    row = table.row("section", force)
    sign = row.sign.removeprefix(f"{ON_INBOARD}, ").partition(f": {ON_INBOARD}")[0]
    signed = len(table.parts("section", force)) == 1
    return f"{row.long_name} [{row.unit}]; {sign}{'; any number' if signed else ''}"


def comparisons(table: Table) -> str:
    """Comparisons of each force in the self-test."""
    many = len(table.forces)
    return "\n".join(
        f'      compare("{table.row("section", force).long_name}", row[{k}], (double)'
        f" forces.{force}, forces_off[{many}*i + {k}], 0);"
        for k, force in enumerate(table.forces)
    )
