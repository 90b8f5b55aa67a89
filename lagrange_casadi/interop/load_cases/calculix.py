"""Load cases as text that input files of CalculiX and Abaqus include."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from .load_case import LoadCase, listed, nodes_of, title

_HEAD = """\
** {title}
** SI units, on the axes of the link, from its origin. Within a step: *INCLUDE, INPUT={file}
** Element set {elements}: mass {mass:.9g} kg, centre {centre} m
** Node sets, each of the one node that takes a joint's load:
{sets}
** Moments are on degrees of freedom 4 to 6 of that node. Of a *RIGID BODY of CalculiX
** they are on 1 to 3 of its ROT NODE.
*CLOAD"""
_GRAVITY = """\
** gravity less the acceleration of the origin
{elements}, GRAV, {size:.12g}, {direction}"""
_SPIN = """\
** square of the angular velocity, a point of its axis, its direction
{elements}, CENTRIF, {square:.12g}, 0., 0., 0., {axis}"""
_ANGULAR = """\
** Angular acceleration [rad/s^2]: {alpha}
** CalculiX has no load for it: add the force -m (alpha x r) on the mass m of each
** node at r. Without it the loads are not in equilibrium."""


def calculix(case: LoadCase, number: int, nodes: Mapping[str, str]) -> Iterator[str]:
    """Yield the lines of a file for a step of CalculiX or Abaqus."""
    found, elements = nodes_of(case, nodes), nodes.get(case.link, case.link)
    yield _HEAD.format(
        title=title(case),
        file=f"{case.link}_{number}.inp",
        elements=elements,
        mass=case.mass,
        centre=listed(case.centre),
        sets="\n".join(f"**   {node.set} at {listed(node.at)} m" for node in found),
    )
    for node in found:
        yield from (f"{node.set}, {k}, {x:.12g}" for k, x in enumerate(node.wrench, 1) if x)
    weight = [g - a for g, a in zip(case.gravity, case.acceleration, strict=True)]
    size, spin = math.hypot(*weight), math.hypot(*case.omega)
    if size or spin:
        yield "*DLOAD"
    if size:
        direction = listed([x / size for x in weight])
        yield _GRAVITY.format(elements=elements, size=size, direction=direction)
    if spin:
        axis = listed([x / spin for x in case.omega])
        yield _SPIN.format(elements=elements, square=spin**2, axis=axis)
    if any(case.alpha):
        yield _ANGULAR.format(alpha=listed(case.alpha))
