"""Companions of the source: build files, a self-test with golden vectors, an example, and a
README.
"""

from __future__ import annotations

import numpy as np

from ..portable.contract import CORNERS, Contract, Member
from ..portable.exported_slopes import in_readme, selftest_function, selftest_numbers
from ..portable.golden import RATIOS, remainder
from ..portable.sections import comparisons
from ..portable.source import Source
from ..portable.text import listed, markdown, number_rows, numbers, quoted, template
from .damage_header import counting
from .matlab import matlab

_ROWS = 12
"""Number of rows that the example prints."""


def companions(source: Source) -> dict[str, str]:
    """The other files of the folder, by name."""
    c = source.contract
    words, (drive, effort) = source.words, c.shown
    link = c.links[0] if c.links else None
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
                skip=(
                    f"    if (k%{steps} != 0) continue; /* the loops are followed in small steps"
                    " */\n"
                    if steps > 1
                    else ""
                ),
                count=_ROWS * steps,
                coordinate=drive.name,
                coordinate_unit=quoted(drive.unit),
                output=effort.name,
                output_unit=quoted(effort.unit),
                declared=f"  {c.prefix}_forces forces;\n" if link else "",
                section=(
                    template("example_section.c", **words, link=link.constant, half=number(0.5))
                    if link
                    else ""
                ),
                heading=f'"   {link.name}, bending at 0.5 [N m]' + '"' if link else '""',
            ),
            "selftest.c": _selftest(source, words),
            "README.md": template(
                "README.md",
                **words | {"name": markdown(c.name)},
                story=source.story,
                inputs=_table(c.inputs),
                outputs=_table(c.outputs),
                parameters=_settings(c),
                links=", ".join(f"`{k.constant}`" for k in c.links) or "none",
                mapped=_mapped(c) + (in_readme(c, source.slopes) if source.slopes else ""),
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


def _settings(c: Contract) -> str:
    if not c.settings:
        return "There are none: every number of the scene is fixed.\n"
    rows = "\n".join(f"| `{m.name}` | {markdown(m.unit)} | {m.range} |" for m in c.settings)
    return (
        f"`{c.prefix}_defaults` holds the defaults. {CORNERS}\n\n| member | unit | range |\n| --- |"
        f" --- | --- |\n{rows}\n"
    )


def _mapped(c: Contract) -> str:
    if not c.mapped:
        return ""
    rows = "\n".join(f"| {markdown(name)} | `{called}` |" for name, called in c.mapped.items())
    return (
        "\nSome names cannot stand in C as they are:\n\n| in the scene | here |\n| --- | ---"
        f" |\n{rows}\n"
    )


def _selftest(source: Source, words: dict[str, str]) -> str:
    g, c = source.golden, source.contract
    places = {m.name: k for k, m in enumerate(c.inputs)}
    rests = remainder(g.times) if c.rests else np.zeros_like(g.times)
    return template(
        "selftest.c",
        **words,
        instants=len(g.times),
        n_inputs=len(c.inputs),
        n_outputs=len(c.outputs),
        n_links=len(c.links),
        n_ratios=len(RATIOS),
        steps=g.steps,
        times=number_rows(zip(g.times, rests, strict=True)),
        inputs=number_rows(g.inputs),
        inputs_off=numbers(g.inputs_off),
        outputs=number_rows(g.outputs),
        outputs_off=numbers(g.outputs_off),
        forces=(_forces(source) if c.links else "")
        + (selftest_numbers(source.slopes) if source.slopes else ""),
        given="\n".join(
            f"  inputs->{m.name} = ({c.prefix}_real) row[{k}];" for k, m in enumerate(c.inputs)
        ),
        taken_inputs="\n".join(_taken(c, m, places) for m in c.inputs if not m.rest_of),
        taken_outputs="\n".join(
            f'  compare("{m.name}", row[{k}], (double) outputs->{m.name}, outputs_off[{k}],'
            f" {int(m.wrapped)});"
            for k, m in enumerate(c.outputs)
        ),
        sections=(_sections(source) if c.links else "")
        + (selftest_function(c, source.slopes) if source.slopes else ""),
        check_sections=("  check_sections(&model, &outputs, k);\n" if c.links else "")
        + ("  check_sensitivity(&model, k);\n" if source.slopes else ""),
        first_input=c.shown[0].name,
        first_output=c.outputs[0].name,
        time_rest=f", ({c.prefix}_real) times[k][1]" if c.rests else "",
        no_rest=", 0" if c.rests else "",
        bad_parameter=(
            template("selftest_parameter.c", **words, parameter=c.settings[0].name)
            if c.settings
            else ""
        ),
        bad_ratio=(
            template("selftest_ratio.c", **words, link=c.links[0].constant, links=len(c.links))
            if c.links
            else ""
        ),
    )


def _taken(c: Contract, m: Member, places: dict[str, int]) -> str:
    parts = c.parts_of(m.source)
    given = " + ".join(f"inputs_at[k][{places[part]}]" for part in parts)
    value = " + ".join(f"(double) inputs.{part}" for part in parts)
    off = f"inputs_off[{places[m.name]}]"
    return f'    compare("motion: {m.name}", {given}, {value}, {off}, 0);'


def _forces(source: Source) -> str:
    """Expected values of section forces."""
    golden, table = source.golden, source.contract.table
    words = listed(table.row("section", force).long_name for force in table.forces)
    return template(
        "selftest_forces.c",
        forces=f"{words[0].upper()}{words[1:]}",
        many=len(table.forces),
        rows=number_rows(golden.forces.reshape(len(golden.times), -1)),
        off=numbers(golden.forces_off.ravel()),
        ratios=", ".join(map(str, RATIOS)),
    )


def _sections(source: Source) -> str:
    """Comparisons of section forces."""
    c = source.contract
    return template(
        "selftest_sections.c",
        **source.words,
        links=",\n".join(f"  {link.constant}" for link in c.links),
        many=len(c.table.forces),
        comparisons=comparisons(c.table),
    )
