"""Equations across a line in space, told in the plane in which it moves.

A slot or a cylindrical joint that closes a loop holds its points together along two lines across its own, and its directions
as well. What moves in a plane has one of them for each: that across the line in the plane. Out of the plane nothing may be off, and
the two lines lie anyhow to it. So each two equations are summed to the one in the plane, with weights that no motion changes.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca

from ..declare.joints import Joint
from ..geometry.vectors import cross, dot
from .legs import in_fewest
from .loops import ClosedForm, solve_in_turn, solves
from .multibody import Coordinate, Multibody


def solve_line(
    joint: Joint, rows: Sequence[int], phi: Any, unknown: Sequence[Coordinate], multibody: Multibody
) -> tuple[ClosedForm, ...]:
    """The closed forms, one after another, of the ``rows`` of a joint that are Phi.

    None where it does not close a loop along a line, where what is unknown does not turn in a plane with it, or none were verified.
    """
    if joint.directions is None or sum(freedom.move == "slide" for freedom in joint.lets) != 1:
        return ()
    turn = next((c.name for c in unknown if c.name in multibody.axes), None)
    pairs = [(k, k + 1) for k in rows if k % 2 == 0]
    if turn is None or [k for pair in pairs for k in pair] != list(rows):
        return ()
    line, first, second = joint.triad
    across = cross(multibody.frames[joint.parent.body.name].rotation.resolve(multibody.axes[turn]), line)
    weights = in_fewest(ca.vertcat(dot(across, first), dot(across, second)), (), multibody.coordinates)
    if weights is None:
        return ()
    equations = [weights.T @ phi[2 * k : 2 * k + 2] for k in range(len(pairs))]
    forms = solve_in_turn(equations, unknown, multibody.coordinates)
    return forms if forms and solves(forms, phi, multibody.coordinates) else ()
