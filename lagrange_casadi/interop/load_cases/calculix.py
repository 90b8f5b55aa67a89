"""Load cases as text that input files of CalculiX and Abaqus include."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from .load_case import LoadCase, listed, nodes_of, title


def calculix(case: LoadCase, number: int, nodes: Mapping[str, str]) -> Iterator[str]:
    """Yield the lines of a file for a step of CalculiX or Abaqus."""
    found, elements = nodes_of(case, nodes), nodes.get(case.link, case.link)
    yield f"** {title(case)}"
    use = f"Within a step: *INCLUDE, INPUT={case.link}_{number}.inp"
    yield f"** SI units, on the axes of the link, from its origin. {use}"
    yield f"** Element set {elements}: mass {case.mass:.9g} kg, centre {listed(case.centre)} m"
    yield "** Node sets, each of the one node that takes a joint's load:"
    yield from (f"**   {node.set} at {listed(node.at)} m" for node in found)
    yield "** Moments are on degrees of freedom 4 to 6 of that node. Of a *RIGID BODY of CalculiX"
    yield from ("** they are on 1 to 3 of its ROT NODE.", "*CLOAD")
    for node in found:
        yield from (f"{node.set}, {k}, {x:.12g}" for k, x in enumerate(node.wrench, 1) if x)
    weight, size, spin = _field(case)
    if size or spin:
        yield "*DLOAD"
    if size:
        yield "** gravity less the acceleration of the origin"
        yield f"{elements}, GRAV, {size:.12g}, {listed([x / size for x in weight])}"
    if spin:
        yield "** square of the angular velocity, a point of its axis, its direction"
        axis = [x / spin for x in case.omega]
        yield f"{elements}, CENTRIF, {spin**2:.12g}, 0., 0., 0., {listed(axis)}"
    if any(case.alpha):
        yield f"** Angular acceleration [rad/s^2]: {listed(case.alpha)}"
        yield "** CalculiX has no load for it: add the force -m (alpha x r) on the mass m of each"
        yield "** node at r. Without it the loads are not in equilibrium."


def _field(case: LoadCase) -> tuple[list[float], float, float]:
    """Return gravity less the acceleration of the origin, its size, and the angular speed."""
    weight = [g - a for g, a in zip(case.gravity, case.acceleration, strict=True)]
    return weight, math.hypot(*weight), math.hypot(*case.omega)
