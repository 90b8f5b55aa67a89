"""The header of exported C that counts damage step by step, with the materials of links whose
strength is wanted.
"""

from __future__ import annotations

from collections.abc import Mapping

from ...model.beams.material import Material
from ...results.strength.fatigue import line
from ..portable.naming import constants
from ..portable.source import Source
from ..portable.text import numbers, template


def counting(source: Source) -> dict[str, str]:
    """The header by its name; nothing where no link is wanted whose material has an endurance limit
    and an ultimate strength.
    """
    program = source.exported.program
    materials = program.data.content.materials
    found = {}
    for name in dict.fromkeys((*program.wanted.stressed, *program.wanted.used)):
        material = materials.get(name)
        if (
            material is not None
            and material.endurance is not None
            and material.ultimate is not None
        ):
            found[name] = material
    prefix = source.contract.prefix
    return {f"{prefix}_fatigue.h": counter(prefix, found)} if found else {}


def counter(prefix: str, materials: Mapping[str, Material]) -> str:
    """The header of some materials, by the names of their links."""
    rows, named = [], constants(f"{prefix}_fatigue_of", list(materials))
    for name, material in materials.items():
        endurance, start, slope = line(material)
        given = numbers((endurance, *material.needs("damage", "ultimate"), start, slope))
        rows.append(f"#define {named[name]} {{{given}, {int(material.endless)}}}")
    return template(
        "fatigue.h",
        p=prefix,
        P=prefix.upper(),
        materials="\n".join(rows),
        example=next(iter(named.values())),
    )
