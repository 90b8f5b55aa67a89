"""The header of exported C that counts damage step by step, with the materials of links whose
strength is wanted.
"""

from __future__ import annotations

from ...results.strength.fatigue import line
from ..portable.naming import constants
from ..portable.source import Source
from ..portable.text import numbers, template


def counting(source: Source) -> dict[str, str]:
    """The header by its name; nothing where no link is wanted whose material has an endurance limit
    and an ultimate strength.
    """
    program = source.exported.program
    wanted = {*program.wanted.stressed, *program.wanted.used}
    found = {
        name: material
        for name, material in program.data.content.materials.items()
        if name in wanted and None not in (material.endurance, material.ultimate)
    }
    if not found:
        return {}
    c = source.contract
    rows, named = [], constants(f"{c.prefix}_fatigue_of", list(found))
    for name, material in found.items():
        endurance, start, slope = line(material)
        given = numbers((endurance, *material.needs("damage", "ultimate"), start, slope))
        rows.append(f"#define {named[name]} {{{given}, {int(material.endless)}}}")
    words = {"materials": "\n".join(rows), "example": next(iter(named.values()))}
    return {f"{c.prefix}_fatigue.h": template("fatigue.h", **c.words, **words)}
