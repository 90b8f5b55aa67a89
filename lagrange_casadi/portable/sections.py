"""What an exported program says of the forces inside links: the functions that give them, and the members of their struct."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ..base.quantities import Output
from ..base.tables import ON_INBOARD, PLANE, Table
from ..declare.limits import END
from .contract import Contract, LinkContract
from .program import Program
from .text import template

LAW = """ Those of a section law are for _section, which is all you need.
   They mean: axial = n0 + n1 mu0 + n2 mu1, shear = f0 + f1 mu0 + f2 mu1, bending = m0 + f0 (l - xi) + f1 (mu1 - xi mu0) + f2 (mu2 -
   xi mu1) at xi from the base, where mu0 is the mass from there to the tip, mu1 and mu2 its first and second moment about the base;
   and then what acts on the link at stations, where something joins or loads it between its ends, beyond xi."""
LAW_IN_SPACE = """ Those of a section law are for _section, which is all you need.
   They mean: axial = n0 + n1 mu0 + n2 mu1, shear_y = fy0 + fy1 mu0 + fy2 mu1, shear_z = fz0 + fz1 mu0 + fz2 mu1, torsion = mx0,
   bending_z = mz0 + fy0 (l - xi) + fy1 (mu1 - xi mu0) + fy2 (mu2 - xi mu1),
   bending_y = my0 - fz0 (l - xi) - fz1 (mu1 - xi mu0) - fz2 (mu2 - xi mu1)
   at xi from the base, where mu0 is the mass from there to the tip, mu1 and mu2 its first and second moment about the base;
   and then what acts on the link at stations, where something joins or loads it between its ends, beyond xi."""

LOADED = """
   And then loads along the link, of which a section feels what acts beyond it: per length the sums of qn0, qn1, qn2, ... and of
   qf0, qf1, qf2, ... (in space qfy0, ... and qfz0, ...) times 1, s, s^2, ..., where s = (end - xi/l)/width is between 0 and 1."""
THICK = """
   And then the rotary inertia of slices, couples along the link: per length the sums of cx0, cx1, ..., of cy0, ... and of cz0, ...
   times 1, s, ..., of which torsion, bending_y and bending_z feel what acts beyond the section."""


def law_in_words(c: Contract) -> str:
    """What the members of a section law mean; nothing where there is none."""
    if not c.links:
        return ""
    law = LAW if c.table is PLANE else LAW_IN_SPACE
    return law + (LOADED if _acts(c, c.table.spread) else "") + (THICK if _acts(c, c.table.couples) else "")


def functions(c: Contract, program: Program, number: Callable[[float], str], root: str) -> str:
    """The C functions that give the forces inside links."""
    bodies = program.graph.data.template.content["bodies"]
    shapes: list[str] = []
    laws: list[str] = []
    breaks: list[float] = []
    sizes: list[int] = []
    place = program.sizes["gapped"]
    names = {Output.of(m.source): m.name for m in c.outputs}
    for link in c.links:
        density = bodies[link.name]["density"]
        lengths = [len(cell) for cell in density["cells"]]
        shapes.append(f"  {{{len(lengths)}, {len(breaks)}, {len(sizes)}}}")
        breaks += density["breaks"]
        sizes += lengths
        rows = [f"  case {link.constant}:", f"    matter_of = model->matter + {place};"]
        rows.append(f"    stations = {len(link.stations)};")
        rows += [f"    law[{i}] = outputs->{names[Output('law', link.name, term)]};" for i, term in enumerate(c.table.law)]
        acting = [Output("station", link.name, term, station) for station in link.stations for term in c.table.place_first]
        rows += [f"    acting[{i}] = outputs->{names[output]};" for i, output in enumerate(acting)]
        rows += _spread_on(c, link, names)
        laws.append("\n".join([*rows, "    break;"]))
        place += 1 + sum(lengths)
    words = {"p": c.prefix, "P": c.prefix.upper()}
    tails = template(
        "tails.c",
        most=max(sizes),
        breaks=", ".join(number(u) for u in breaks),
        sizes=", ".join(map(str, sizes)),
        shapes=",\n".join(shapes),
    )
    one = template(
        "sections.c" if c.table is PLANE else "sections_in_space.c",
        **words,
        **({} if c.table is PLANE else {"root": root}),
        slack=number(END[c.precision]),
        loads=len(c.table.place_first) * max(1, *(len(link.stations) for link in c.links)),
        **_spreads(c, words),
        laws="\n".join(laws),
    )
    many = template("many_sections.c", **words, indent=" " * (len(c.prefix) * 2 + 16))
    return f"{tails}\n{one}\n{many}"


def _spreads(c: Contract, words: dict[str, str]) -> dict[str, str]:
    """What is declared for loads along links, and what is added for them; nothing where there are none."""
    many = max(len(link.spreads) for link in c.links)
    if not many:
        return {"declared": "", "spread": ""}
    directions = _directions(c)
    room = max(sum(2 + len(directions) * powers for powers in link.spreads.values()) for link in c.links)
    declared = f"""
  casadi_real spread[{room}], reach, x, lever, power, share, turning;
  const casadi_real* along;
  int powers[{many}], j, spreads = 0;"""
    added = []
    for force, terms in c.table.sections.items():
        if terms.spread:
            sign, what = "-" if terms.arm < 0 else "+", "turning" if terms.arm else "share"
            added.append(f"      {force} = {force} {sign} along[{directions.index(terms.spread)}]*{what};")
        if terms.couple in directions:
            added.append(f"      {force} = {force} + along[{directions.index(terms.couple)}]*share;")
    return {
        "declared": declared,
        "spread": template("spreads.c", **words, added="\n".join(added), directions=len(directions)),
    }


def _acts(c: Contract, members: tuple[str, ...]) -> bool:
    """Whether something along some link has one of these members."""
    outputs = (Output.of(m.source) for m in c.outputs)
    return any(output.group == "spread" and output.member in members for output in outputs)


def _directions(c: Contract) -> tuple[str, ...]:
    """The members that what acts along links may have for each power."""
    return (*c.table.spread, *(c.table.couples if _acts(c, c.table.couples) else ()))


def _spread_on(c: Contract, link: LinkContract, names: Mapping[Output, str]) -> list[str]:
    """What is taken of the outputs for the loads along a link."""
    rows = [f"    spreads = {len(link.spreads)};"] if link.spreads else []
    outputs: list[Output] = []
    for k, (load, powers) in enumerate(link.spreads.items()):
        rows.append(f"    powers[{k}] = {powers};")
        outputs += [Output("spread", link.name, member, load) for member in ("width", "end")]
        outputs += [Output("spread", link.name, member, load, power) for power in range(powers) for member in _directions(c)]
    values = (f"outputs->{names[output]}" if output in names else "0" for output in outputs)
    return rows + [f"    spread[{i}] = {value};" for i, value in enumerate(values)]


def in_words(table: Table) -> str:
    """All forces in words."""
    *words, last = (table.row("section", force).long_name for force in table.forces)
    return f"{', '.join(words)} and {last}"


def about(table: Table, force: str) -> str:
    """A force as the header tells it: its unit, sign and range."""
    row = table.row("section", force)
    sign = row.sign.removeprefix(f"{ON_INBOARD}, ").partition(f": {ON_INBOARD}")[0]
    signed = len(table.parts("section", force)) == 1
    return f"{row.long_name} [{row.unit}]; {sign}{'; any number' if signed else ''}"


def comparisons(table: Table) -> str:
    """Of the self-test: what compares each force."""
    many = len(table.forces)
    places = [f"{many}*i" if k == 0 else f"{many}*i + {k}" for k in range(many)]
    return "\n".join(
        f'      compare("{table.row("section", force).long_name}", row[{k}], (double) forces.{force}, forces_off[{place}], 0);'
        for k, (force, place) in enumerate(zip(table.forces, places, strict=True))
    )
