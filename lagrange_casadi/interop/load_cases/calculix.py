"""Load cases as text that input files of CalculiX and Abaqus include."""

from __future__ import annotations

import math
from collections.abc import Mapping

from ..portable.text import template
from .load_case import LoadCase, listed, nodes_of, title


def calculix(case: LoadCase, number: int, nodes: Mapping[str, str]) -> str:
    """Return a file for a step of CalculiX or Abaqus."""
    found = nodes_of(case, nodes)
    weight = [g - a for g, a in zip(case.gravity, case.acceleration, strict=True)]
    size, spin = math.hypot(*weight), math.hypot(*case.omega)
    return template(
        "calculix.inp",
        title=title(case),
        file=f"{case.link}_{number}.inp",
        elements=nodes.get(case.link, case.link),
        mass=f"{case.mass:.9g}",
        centre=listed(case.centre),
        sets="\n".join(f"**   {node.set} at {listed(node.at)} m" for node in found),
        forces="\n".join(
            f"{node.set}, {k}, {x:.12g}"
            for node in found
            for k, x in enumerate(node.wrench, 1)
            if x
        ),
        moved=size or spin,
        size=f"{size:.12g}" if size else "",
        direction=listed([x / (size or 1.0) for x in weight]),
        square=f"{spin**2:.12g}" if spin else "",
        axis=listed([x / (spin or 1.0) for x in case.omega]),
        turned=any(case.alpha),
        alpha=listed(case.alpha),
    )
