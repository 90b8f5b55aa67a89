"""Forces that equilibrium leaves open, by least strain energy (Menabrea 1858; Castigliano 1879), as
an expression of an instant.

All forces are f + S x: those of an equilibrium, and what is open, x. Of all equilibria the true one
has the least strain energy, where parts fit without strain (Timoshenko, *Strength of Materials*,
part I, on least work). Strain energy is the sum of squares of section forces, each times a factor
of its cross-section, over all links: a problem of least squares. Section forces are polynomials
between two marks, so Gauss's nodes sum it exactly.

Of links without a beam the stiffness is not known. What loads one of them is open, and so is
whatever else depends on it; what loads no link at all, as two bearings on one pin do, is open too.
Points and the ground are rigid.

So x is chosen along ways that load nothing firm, and that load something elastic; Gram and
Schmidt's method makes their strains orthogonal, one way after another, at every instant anew
(Björck, *Numerical Methods for Least Squares Problems*, 1996).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

from ..base.arrays import Expression
from ..base.quantities import Column, Output, force_members
from ..base.scalars import column, graph
from ..base.tables import table_of
from ..errors import DeclarationError, one_line
from ..model.declared_parts import Link
from ..model.limits import END
from ..model.link_density import Density
from ..model.mechanism import Mechanism
from ..model.scene import Wanted
from ..model.scene_arguments import Elastic
from .indeterminate import Forces
from .section_function import Place, Section
from .sizes import extent
from .strains import Moduli, moduli_of, resultants
from .utilisation import Loaded

_NONE = 1e-6
"""Relative change of forces that counts as none, in numbers of either precision."""

_MORE, _FINER = 12, 4
"""Nodes more where the cross-section changes, and more than that by which it is checked that the
energy is least.
"""

_NO_BEAM = "no beam"
_POINTS = ("revolute", "spherical", "universal", "weld")
"""Joints whose forces act at one place of both bodies."""


def feeling(mechanism: Mechanism, want: Wanted) -> Wanted:
    """Add to what is wanted all section forces and reactions, by which it is found what is open."""
    sections = tuple(
        name for name, link in mechanism.links.items() if isinstance(link.mass, Density)
    )
    return replace(want, reactions=tuple(mechanism.joints), sections=sections)


@dataclass(frozen=True, eq=False)
class LeastEnergy:
    """Statically indeterminate forces as ``x + ways y``: ``x`` is the solution of least energy,
    ``y`` what remains indeterminate; columns of ``responses`` of determined forces are zero.

    For each link without stiffness ``firm`` is the reason. ``rows`` are for each of these links
    whether an indeterminate force loads it; whether an indeterminate force loads no link; whether
    the solution determines any; and the distance of the energy from its least: the largest cosine
    between the strains of the solution and those of the whole, summed at other places.
    """

    x: Any
    responses: Any
    firm: Mapping[str, str]
    rows: Any

    def completed(
        self,
        acting: Mapping[Column, Expression],
        free: Expression,
        units: Mapping[Output, Expression],
    ) -> Forces:
        """Forces ``acting`` that are expressions of what equilibrium leaves open, ``free``, with
        what is chosen in its place; by their ``units``.
        """
        still = ca.SX.sym("still", free.numel())
        whole = ca.substitute(
            column(map(ca.SX, acting.values())), free, self.x + self.responses @ still
        )
        found = Forces.over(dict(zip(acting, ca.vertsplit(whole), strict=True)), still, units)
        return replace(found, before=Forces.over(acting, free, units).open)


@dataclass(frozen=True, eq=False)
class Completion:
    """Account of least strain energy beside the columns of a graph.

    ``function(t, d, d_rate, d_acceleration, z, p)`` has a row for each of ``doubted``, outputs, how
    much it changes with what equilibrium leaves open; for each of ``firm``, links, whether it is
    loaded by that; and what else the rows of :class:`LeastEnergy` are.
    """

    doubted: tuple[Output, ...]
    firm: Mapping[str, str]
    function: Any

    @classmethod
    def of(
        cls,
        least: LeastEnergy,
        forces: Forces,
        columns: Mapping[Column, Expression],
        inputs: Mapping[str, ca.SX],
    ) -> Completion:
        """Put together what is known of ``forces`` that are among the ``columns`` of a graph, over
        its ``inputs``.
        """
        doubted = {
            output: size for output, size in (forces.before or {}).items() if output in columns
        }
        rows = ca.vertcat(*doubted.values(), least.rows)
        return cls(tuple(doubted), least.firm, graph("completion", inputs, out=rows))

    def reasons(self, through: Iterable[bool], *, idle: bool) -> tuple[str, ...]:
        """Reasons why something stays indeterminate: by which of the firm links it goes
        ``through``, and whether some of it is ``idle``.
        """
        loaded = [
            (link, why)
            for (link, why), does in zip(self.firm.items(), through, strict=True)
            if does
        ]
        bare = [f"'{link}'" for link, why in loaded if why == _NO_BEAM]
        found = (
            [
                f"they go through {', '.join(bare)}, which"
                + (" has no beam" if len(bare) == 1 else " have no beam")
            ]
            if bare
            else []
        )
        found += [why for _, why in loaded if why != _NO_BEAM]
        return (*found, "some do not deform any link") if idle else tuple(found)


def least_energy(
    mechanism: Mechanism, elastic: Elastic, columns: Mapping[Column, Expression], free: Expression
) -> LeastEnergy:
    """Choose ``free``, which ``columns`` are linear in; ``elastic`` is as in :class:`.Scene`.

    Raises :class:`.DeclarationError` where a link that was named has no elasticity.
    """
    soft, firm = _links(mechanism, elastic)
    known = {key: ca.SX(value) for key, value in columns.items()}
    forces = {name: _loading(mechanism, mechanism.links[name], known) for name in (*soft, *firm)}
    reactions = (
        (key, value)
        for key, value in known.items()
        if isinstance(key, Output) and key.group == "reaction"
    )
    forces[""] = [value / _unit(mechanism, key.member) for key, value in reactions]
    loaded = {
        name: ca.densify(ca.jacobian(column(values), free)) for name, values in forces.items()
    }
    least = _NONE**2 * sum(ca.sumsqr(rows) for rows in loaded.values())
    beams = [
        (Loaded(mechanism.space, mechanism.links[name], known), moduli)
        for name, moduli in soft.items()
    ]

    through = [ca.sumsqr(loaded[name]) > least for name in firm]
    stiff = ca.vertcat(ca.SX(0, free.numel()), *(loaded[name] for name in firm))
    units = [(mode, ca.SX(1)) for mode in ca.horzsplit(ca.SX.eye(free.numel()))]
    apart = _apart(units, stiff, ca.SX.ones(stiff.shape[0]), stiff, least)

    strained, bent, weights = _strains(beams, free)
    bending = ca.vertcat(ca.SX(0, free.numel()), *(loaded[name] for name in soft))
    chosen = _apart(
        [(mode.response, 1 - mode.does) for mode in apart], bent, weights, bending, least
    )
    x, left = ca.SX.zeros(free.numel()), strained
    for mode in chosen:
        share = ca.dot(mode.weighed, left) * mode.inverse
        x, left = x - share * mode.response, left - share * mode.made
    residual = _residual(chosen, x, *_strains(beams, free, _FINER))

    idle = sum(
        (1 - stiffened.does) * (1 - mode.does)
        for stiffened, mode in zip(apart, chosen, strict=True)
    )
    return LeastEnergy(
        x=x,
        responses=ca.horzcat(
            *((1 - mode.does) * _relaxed(mode, chosen[k + 1 :]) for k, mode in enumerate(chosen))
        ),
        firm=firm,
        rows=column([*through, idle, sum(mode.does for mode in chosen), residual]),
    )


@dataclass(frozen=True, eq=False)
class _Response:
    """A way in which what is open may change, and what it ``made`` of rows, times their weights
    ``weighed``.

    ``does`` says whether it did anything, and ``inverse`` is one over the sum of squares, or zero.
    """

    response: Any
    made: Any
    weighed: Any
    does: Any
    inverse: Any


def _apart(
    responses: Iterable[tuple[Expression, Expression]],
    rows: Expression,
    weights: Expression,
    measure: ca.SX,
    least: Expression,
) -> list[_Response]:
    """Make what ``rows`` make of ways orthogonal, each to those before it that did something.

    A way comes with whether it may. It does something if ``measure`` makes more of it than
    ``least``, a square.
    """
    found: list[_Response] = []
    for mode, may in responses:
        made = rows @ mode
        for before in found:
            share = ca.dot(before.weighed, made) * before.inverse
            mode, made = mode - share * before.response, made - share * before.made
        does = may * (ca.sumsqr(measure @ mode) > least) if measure.numel() else ca.SX(0)
        weighed = weights * made
        found.append(
            _Response(mode, made, weighed, does, does / ca.if_else(does, ca.dot(weighed, made), 1))
        )
    return found


def _relaxed(mode: _Response, later: Sequence[_Response]) -> Expression:
    """A way, with what is chosen along later ones when it changes."""
    return mode.response - sum(
        (ca.dot(other.weighed, mode.made) * other.inverse * other.response for other in later),
        ca.SX(0),
    )


def _strains(
    beams: Sequence[tuple[Loaded, Moduli]], free: Expression, more: int = 0
) -> tuple[Expression, Expression, Expression]:
    """Return what strains links at Gauss's nodes with nothing for what is open, by each number of
    that, and weights of squares.
    """
    found, weights = [], []
    for link, moduli in beams:
        for part in link.spans:
            first, last = link.course.cells[part.cell]
            x, w = np.polynomial.legendre.leggauss(
                (link.degree + 1) // 2 + 1 + (0 if first is last else _MORE) + more
            )
            for place, weight in zip(((x + 1) / 2).tolist(), (w / 2).tolist(), strict=True):
                force = {name: link.force_within(name, part, place) for name in link.cross.forces}
                for value, soft in resultants(link.at(part, place), force, moduli).values():
                    found.append(value)
                    weights.append(weight * link.link.length * part.width * soft)
    rows = column(found)
    return (
        ca.substitute(rows, free, ca.SX.zeros(free.numel())),
        ca.densify(ca.jacobian(rows, free)),
        column(weights),
    )


def _residual(
    chosen: Sequence[_Response],
    x: Expression,
    strained: Expression,
    bent: Expression,
    weights: Expression,
) -> Expression:
    """The largest cosine between the strains of what was chosen and those of the whole."""
    whole = strained + bent @ x
    size = ca.fmax(ca.dot(weights * whole, whole), ca.dot(weights * strained, strained))
    found = ca.SX(0)
    for mode in chosen:
        made = bent @ mode.response
        product = ca.dot(weights * made, made) * size
        found = ca.fmax(
            found,
            mode.does * ca.dot(weights * made, whole) ** 2 / ca.if_else(product > 0, product, 1),
        )
    return ca.sqrt(found)


def _links(mechanism: Mechanism, elastic: Elastic) -> tuple[dict[str, Moduli], dict[str, str]]:
    """The moduli of links that give way; and the links whose stiffness is not known, with why."""
    soft, firm = dict[str, Moduli](), dict[str, str]()
    for name, link in mechanism.links.items():
        if link.beam is None or not isinstance(link.mass, Density):
            firm |= {name: _NO_BEAM} if elastic is True else {}
        elif elastic is True or name in (elastic or ()):
            try:
                soft[name] = moduli_of(link.beam, f"elastic link '{name}'", space=mechanism.space)
            except DeclarationError as error:
                if elastic is not True:
                    raise
                firm[name] = one_line(error)
    return soft, firm


def _unit(mechanism: Mechanism, member: str) -> Expression:
    """Return one for a component of a force, for a moment a length."""
    return extent(mechanism) if member.startswith(("m", "bending", "torsion")) else 1.0


def _loading(
    mechanism: Mechanism, link: Link, columns: Mapping[Column, Expression]
) -> list[Expression]:
    """Forces by which a link is loaded: by its section forces, or those of its joints, where
    they act at one place as one.
    """
    if isinstance(link.mass, Density):
        section = Section(link.name, table_of(mechanism.space), columns, link.length, link.mass)
        places = [Place(0.0), *section.marks, Place(1.0, side="base")]
        return [
            section.at(name, place, END["single"]) / _unit(mechanism, name)
            for place in places
            for name in section.table.sections
        ]
    sums: dict[tuple[str, ...], Any] = {}
    for name, joint in mechanism.joints.items():
        for point, sign in ((joint.parent, -1.0), (joint.child, 1.0)):
            if point.body is not link:
                continue
            place = tuple(str(ca.SX(x)) for x in point.place) if joint.kind in _POINTS else (name,)
            for member in force_members(mechanism.space):
                if (output := Output("reaction", name, member)) in columns:
                    key = (*place, member)
                    sums[key] = sums.get(key, 0.0) + sign * columns[output] / _unit(
                        mechanism, member
                    )
    return list(sums.values())
