"""Companions of the source: build files, a self-test with golden vectors, an example, and a
README.
"""

from __future__ import annotations

import numpy as np

from ..portable.contract import Contract, Member
from ..portable.exported_slopes import compared
from ..portable.golden import RATIOS, remainder
from ..portable.sections import comparisons
from ..portable.source import Source
from ..portable.text import indented, listed, markdown, number_rows, numbers, quoted, template
from .damage_header import counting
from .matlab import matlab

_ROWS = 12
"""Number of rows that the example prints."""


def companions(source: Source) -> dict[str, str]:
    """The other files of the folder, by name."""
    c = source.contract
    words, (drive, effort) = source.words, c.shown
    data = source.exported.program.data
    (start, stop), count = data.span, data.timing.count
    steps = max(1, round((count - 1) / _ROWS)) if source.iterated else 1
    number = source.exported.number
    return (
        {
            "CMakeLists.txt": template("CMakeLists.txt", **words),
            f"{c.prefix}Config.cmake.in": template("Config.cmake.in", **words),
            "example.c": template(
                "example.c",
                **words,
                rest=f", {number(0.0)}" if c.rests else "",
                start=number(start),
                step=number((stop - start) / (_ROWS * steps)),
                skip=steps > 1,
                steps=steps,
                count=_ROWS * steps,
                coordinate_unit=quoted(drive.unit),
                output_unit=quoted(effort.unit),
                half=number(0.5),
                heading=f'"   {words["link"]}, bending at 0.5 [N m]"' if c.links else '""',
            ),
            "selftest.c": _selftest(source),
            "README.md": template(
                "README.md",
                **words | {"name": markdown(c.name)},
                story=source.story,
                inputs=_table(c.inputs),
                outputs=_table(c.outputs),
                parameters="\n".join(
                    f"| `{m.name}` | {markdown(m.unit)} | {m.range} |" for m in c.settings
                ),
                links=", ".join(f"`{k.constant}`" for k in c.links) or "none",
                mapped="\n".join(
                    f"| {markdown(name)} | `{called}` |" for name, called in c.mapped.items()
                ),
                slopes=", ".join(f"`{s.name}`" for s in source.slopes.by),
            ),
        }
        | matlab(source)
        | counting(source)
    )


def _table(members: tuple[Member, ...]) -> str:
    return "\n".join(
        f"| `{m.name}` | {markdown(m.unit)} | {m.meaning} |"
        f" {'; '.join(x for x in (m.sign, m.range) if x)} |"
        for m in members
    )


def _selftest(source: Source) -> str:
    g, c, slopes = source.golden, source.contract, source.slopes
    places = {m.name: k for k, m in enumerate(c.inputs)}
    rests = remainder(g.times) if c.rests else np.zeros_like(g.times)
    forces = listed(c.table.row("section", force).long_name for force in c.table.forces)
    return template(
        "selftest.c",
        **source.words,
        instants=len(g.times),
        n_inputs=len(c.inputs),
        n_outputs=len(c.outputs),
        n_links=len(c.links),
        n_ratios=len(RATIOS),
        n_forces=len(c.table.forces),
        n_slopes=len(slopes.off),
        steps=g.steps,
        times=number_rows(zip(g.times, rests, strict=True)),
        inputs=number_rows(g.inputs),
        inputs_off=numbers(g.inputs_off),
        outputs=number_rows(g.outputs),
        outputs_off=numbers(g.outputs_off),
        forces=f"{forces[0].upper()}{forces[1:]}",
        forces_at=number_rows(map(np.ravel, g.forces)),
        forces_off=numbers(g.forces_off.ravel()),
        ratios=", ".join(map(str, RATIOS)),
        slopes_at=number_rows(slopes.expected),
        slopes_off=numbers(slopes.off),
        given="\n".join(
            f"  inputs->{m.name} = ({c.prefix}_real) row[{k}];" for k, m in enumerate(c.inputs)
        ),
        taken_inputs="\n".join(_taken(c, m, places) for m in c.inputs if not m.rest_of),
        taken_outputs="\n".join(
            f'  compare("{m.name}", row[{k}], (double) outputs->{m.name}, outputs_off[{k}],'
            f" {int(m.wrapped)});"
            for k, m in enumerate(c.outputs)
        ),
        taken_forces=comparisons(c.table),
        taken_slopes=indented(compared(c, slopes)),
        links=",\n".join(f"  {link.constant}" for link in c.links),
        time_rest=f", ({c.prefix}_real) times[k][1]" if c.rests else "",
    )


def _taken(c: Contract, m: Member, places: dict[str, int]) -> str:
    parts = c.parts_of(m.source)
    given = " + ".join(f"inputs_at[k][{places[part]}]" for part in parts)
    value = " + ".join(f"(double) inputs.{part}" for part in parts)
    off = f"inputs_off[{places[m.name]}]"
    return f'    compare("motion: {m.name}", {given}, {value}, {off}, 0);'
