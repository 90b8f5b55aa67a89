"""What equilibrium leaves open, by least strain energy, as an expression of an instant (see :mod:`..elastic.least_energy`).

All forces are f + S x, and the strain energy of links is a quadratic of x: its Hessian H and its gradient g at x = 0 give
x = -H^-1 g. That is told where H is regular at the first instant, so where every number that is open bends some link, and what
links without a beam bear does not change with it. Else all of it stays open. Later, and for other parameters, forces are open
where H is singular.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

from ..base.quantities import Output
from ..declare.density import Density
from ..declare.giving import Elastic
from ..declare.mechanism import Mechanism
from ..declare.parts import Link
from ..declare.scene import Wanted
from ..errors import DeclarationError
from .checks import Check, Column
from .linear import LinearSystem
from .multibody import column
from .strains import moduli, strains
from .strength import Loaded

_REGULAR, _NONE = 1e-8, 1e-9
"""The least volume of a regular Hessian, scaled to a diagonal of ones; and what is no change, beside all changes."""

_MORE = 6
"""More nodes where the cross-section changes."""


@dataclass(frozen=True, eq=False)
class Told:
    """What is open, ``x``, by least strain energy, and whether it is ``singular`` at an instant."""

    x: Any
    singular: Any

    def completed(self, columns: Mapping[Column, Any], free: Any) -> dict[Column, Any]:
        """Columns that are linear in ``free`` with what is told in its place, and checks where they are open."""
        forces = column(map(ca.SX, columns.values()))
        slopes = ca.jacobian(forces, free)
        found = dict(zip(columns, ca.vertsplit(ca.substitute(forces, free, self.x)), strict=True))
        doubted = [(key, slopes[k, :]) for k, key in enumerate(columns) if slopes[k, :].nnz() and isinstance(key, Output)]
        return found | {Check("open", output): self.singular * ca.sum2(ca.fabs(slope)) for output, slope in doubted}

    def doubts(self, columns: Mapping[Column, Any]) -> dict[Column, Any]:
        """Checks where what is made of completed forces is open."""
        return {Check("open", output): self.singular for output in columns if isinstance(output, Output)}


def feeling(mechanism: Mechanism, want: Wanted) -> Wanted:
    """What is wanted, and all section forces and reactions, by which it is found what is open."""
    sections = tuple(name for name, link in mechanism.links.items() if isinstance(link.mass, Density))
    return replace(want, reactions=tuple(mechanism.joints), sections=sections)


def least_work(
    mechanism: Mechanism, elastic: Elastic, columns: Mapping[Column, Any], free: Any, begins: Callable[[Any], Any]
) -> Told | None:
    """What the beams of links tell of ``free``, which ``columns`` are linear in; None where they do not tell all of it.

    ``begins`` puts the first instant and the parameters of assembly into an expression.
    """
    giving = [link for name, link in mechanism.links.items() if _gives(link) and (elastic is True or name in (elastic or ()))]
    rigid = [link for link in mechanism.links.values() if link not in giving] if elastic is True else []
    if not giving or any(_bears(mechanism, link, columns, free, begins) for link in rigid):
        return None
    try:
        energy = sum(_energy(Loaded(mechanism.space, link, columns)) for link in giving)
    except DeclarationError:
        if elastic is True:
            return None
        raise
    gradient = ca.gradient(energy, free)
    hessian, rest = ca.jacobian(gradient, free), ca.substitute(gradient, free, ca.SX.zeros(free.numel()))
    size = ca.sqrt(ca.diag(hessian))
    if not np.all(np.array(begins(size)) > 0.0):
        return None
    system = LinearSystem.of(hessian / (size @ size.T))
    if not abs(float(begins(system.volume))) > _REGULAR:
        return None
    return Told(-system.solve(rest / size) / size, ca.fabs(system.volume) <= _REGULAR)


def _gives(link: Link) -> bool:
    return isinstance(link.mass, Density) and link.beam is not None


def _bears(mechanism: Mechanism, link: Link, columns: Mapping[Column, Any], free: Any, begins: Callable[[Any], Any]) -> bool:
    """Whether what a link bears changes with what is open."""
    changes = column(ca.SX(columns[output]) for output in _borne(mechanism, link, columns))
    slopes = np.abs(np.array(begins(ca.densify(ca.jacobian(changes, free)))))
    return bool(slopes.size and slopes.max() > _NONE)


def _borne(mechanism: Mechanism, link: Link, columns: Mapping[Column, Any]) -> Iterator[Output]:
    """What tells how a link is loaded: its section law, or the reactions of its joints."""
    joints = [joint.name for joint in mechanism.joints.values() if link.name in (joint.parent.body.name, joint.child.body.name)]
    for output in columns:
        if isinstance(output, Output):
            own = output.group in ("law", "station") and output.part == link.name
            if own or (not isinstance(link.mass, Density) and output.group == "reaction" and output.part in joints):
                yield output


def _energy(link: Loaded) -> Any:
    """The strain energy of a link, summed as closely as its cross-section is a polynomial: exactly where it is constant."""
    pair, found = moduli(link, f"elastic link '{link.link.name}'"), ca.SX(0)
    for part in link.parts:
        first, last = link.course.cells[part.cell]
        nodes, weights = np.polynomial.legendre.leggauss(link.degree + 1 + (0 if first is last else _MORE))
        for x, weight in zip(((nodes + 1) / 2).tolist(), (weights / 4).tolist(), strict=True):
            work = sum(part.force(name, x) * strain for name, strain in strains(link, part, x, *pair).items())
            found += weight * link.link.length * part.width * work
    return found
