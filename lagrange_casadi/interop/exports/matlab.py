"""A mex function for MATLAB and Octave: its source, what builds it, and an example."""

from __future__ import annotations

from collections.abc import Iterable

from ..portable.contract import Contract, Member
from ..portable.naming import taken_words
from ..portable.source import Source
from ..portable.text import double, listed, octave, template


def matlab(source: Source) -> dict[str, str]:
    """The files by name."""
    c, (coordinate, output) = source.contract, source.contract.shown
    unit, forces = octave(output.unit), c.table.forces
    words = source.words
    start, stop = source.exported.program.data.span
    return {
        f"{c.prefix}_mex.c": template(
            "mex.c",
            **words,
            rests=c.rests,
            inputs=_members(c, "inputs", [m for m in c.inputs if not m.rest_of]),
            outputs=_members(c, "outputs", c.outputs),
            parameters=_members(c, "parameters", c.settings),
            time=", ".join(c.split("t")),
            links=", ".join(f'"{link.name}"' for link in c.links),
            pointers=", ".join(f"*{force}" for force in forces),
            added="\n".join(
                f'  {force} = added(found, "{force}", many, width, mxDOUBLE_CLASS);'
                for force in forces
            ),
            filled="\n".join(
                f"      {force}[j*many + i] = (double) forces.{force};" for force in forces
            ),
            matrices=listed(forces),
        ),
        "build_mex.m": template("build_mex.m", **words),
        "mex_example.m": template(
            "mex_example.m",
            **words,
            start=double(start),
            step=double((stop - start) / 12),
            coordinate_unit=octave(coordinate.unit),
            coordinate_field=_field(coordinate),
            output_unit=unit,
            unit_in_format=unit.replace("\\", "\\\\").replace("%", "%%"),
            output_field=_field(output),
            default="".join(double(m.default) for m in c.settings[:1]),
        ),
    }


def _field(member: Member) -> str:
    """Expression by which a script reads a member of a struct."""
    plain = member.name[0].isalpha() and member.name not in taken_words("matlab")
    return f".{member.name}" if plain else f".('{member.name}')"


def _members(c: Contract, struct: str, members: Iterable[Member]) -> str:
    rests = {m.rest_of: m.name for m in c.inputs if m.rest_of} if struct == "inputs" else {}

    def place(name: str) -> str:
        return f"offsetof({c.prefix}_{struct}, {name})"

    rows = (
        (m.name, place(m.name), place(rests[m.source]) if m.source in rests else "0")
        for m in members
    )
    return "\n".join(f'  {{"{name}", {at}, {rest}}},' for name, at, rest in rows)
