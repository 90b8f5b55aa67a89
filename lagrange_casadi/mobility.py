"""Internal forces from extra mobilities: multipliers and efforts, joint reactions, and the section law of a link.

The law (exact for a straight link of any density): with mu0 and mu1 the mass and the first moment, about the base, of the
material from the section to the tip,

    axial   = n0 + n1 mu0 + n2 mu1,
    shear   = f0 + f1 mu0 + f2 mu1,
    bending = m0 + f0 (l - xi) + f1 (mu1 - xi mu0) + f2 (mu2 - xi mu1).

Energy is linear in the moments, so the coefficients are derivatives of the section mobility's Lagrange terms (paper eq. 20)
by the moments. That bending repeats the coefficients of shear is the equilibrium of an element of the link,
d(bending)/d(xi) = -shear; seven numbers an instant hold a link's whole load.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca

from .kinematics import Kinematics
from .mechanism import Joint
from .multibody import Multibody, SectionCut
from .planar import Moments, Rotation, reaction

LAW = ("n0", "n1", "n2", "f0", "f1", "f2", "m0")


@dataclass(frozen=True, eq=False)
class InternalForces:
    """Every force that was asked for, as expressions in the driven motion, the iterated unknowns and the parameters."""

    efforts: dict[str, Any]
    reactions: dict[str, dict[str, Any]]
    laws: dict[str, dict[str, Any]]


def internal_forces(multibody: Multibody, kinematics: Kinematics, reactions: tuple[str, ...]) -> InternalForces:
    """Efforts of the drives, reactions of the named joints, and the laws of the links that were cut."""
    along, across = multibody.system.terms()
    moments = ca.vertcat(ca.SX(0, 1), *(cut.moments for cut in multibody.cuts.values()))
    uncut = ca.SX.zeros(moments.numel())
    along = kinematics.evaluate(ca.substitute(along, moments, uncut))
    multipliers, forces = _multipliers(multibody, kinematics, along)

    def known(expression: Any) -> Any:
        """At the moments of an undisturbed link, with the multipliers and the motion put in."""
        still = kinematics.evaluate(ca.substitute(ca.SX(expression), moments, uncut))
        return ca.substitute(still, multipliers, forces)

    efforts = {c.joint: known(along[i]) for i, c in enumerate(multibody.coordinates) if c.driven}
    sizes = [d.symbols.numel() for d in multibody.displacements]
    actions = _split(across, sizes)
    by_joint = dict(zip(multibody.joint_mobilities, actions, strict=False))
    found = {}
    for name in reactions:
        joint = multibody.mechanism.joints[name]
        found[name] = {member: known(force) for member, force in _reaction(multibody, joint, by_joint).items()}
    laws = {}
    for (name, cut), action in zip(multibody.cuts.items(), actions[len(by_joint) :], strict=True):
        laws[name] = {k: known(v) for k, v in section_law(cut, action, multibody.frames[name].rotation).items()}
    return InternalForces(efforts, found, laws)


def section_law(cut: SectionCut, action: Any, direction: Rotation) -> dict[str, Any]:
    """The coefficients of a link's law, from the generalized forces of its section mobility; to be taken at zero moments.

    ``action`` is what the side nearer the ground does to the displaced side. Where that side holds the base, the tip's side
    is the one that acts, and the moments of the displaced material are the link's less those up to the tip.
    """
    n, f = direction.resolve(action[0], action[1])
    m = action[2]
    slopes = ca.jacobian(ca.vertcat(n, f), cut.moments[:2])
    n1, n2, f1, f2 = slopes[0, 0], slopes[0, 1], slopes[1, 0], slopes[1, 1]
    if cut.toward_tip:
        return dict(zip(LAW, (-n, -n1, -n2, -f, -f1, -f2, -m), strict=True))
    link = Moments.of_uniform(cut.link.mass, cut.link.length)
    n0 = n + n1 * link.mass + n2 * link.first
    f0 = f + f1 * link.mass + f2 * link.first
    m0 = m + f1 * link.first + f2 * link.second - cut.link.length * f0
    return dict(zip(LAW, (n0, -n1, -n2, f0, -f1, -f2, m0), strict=True))


def _multipliers(multibody: Multibody, kinematics: Kinematics, along: Any) -> tuple[Any, Any]:
    """lambda from the undriven rows of R = Phi_q' lambda (paper eq. 8): the blocks of the loops, last one first."""
    rows = {c: along[i] for i, c in enumerate(multibody.coordinates)}
    symbols, values = ca.SX(0, 1), ca.SX(0, 1)
    for block, system in reversed(list(zip(kinematics.blocks, kinematics.systems, strict=True))):
        own = ca.vertcat(*(closure.multipliers for closure in block.closures))
        left = ca.vertcat(*(rows[c] for c in block.unknown))
        left = ca.substitute(left, ca.vertcat(own, symbols), ca.vertcat(ca.SX.zeros(own.numel()), values))
        symbols = ca.vertcat(own, symbols)
        values = ca.vertcat(system.solve_transposed(left), values)
    return symbols, values


def _reaction(multibody: Multibody, joint: Joint, actions: dict[str, Any]) -> dict[str, Any]:
    parent = multibody.frames[joint.parent.body.name]
    for closure in multibody.closures:
        if closure.joint is joint:
            return reaction(joint, parent, closure.multipliers, closing=True)
    branch = next(branch for branch in multibody.tree.branches if branch.joint is joint)
    return reaction(joint, parent, branch.sign * actions[joint.name], closing=False)


def _split(column: Any, sizes: list[int]) -> list[Any]:
    starts = [sum(sizes[:i]) for i in range(len(sizes))]
    return [column[start : start + size] for start, size in zip(starts, sizes, strict=True)]
