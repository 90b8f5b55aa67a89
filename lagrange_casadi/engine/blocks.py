"""The order in which loops can be solved: blocks of equations, each as small as possible, and the
count of freedoms.

Which coordinate stands in which equation is a sparse matrix. Its Dulmage-Mendelsohn decomposition
gives the blocks: a maximum matching and strongly connected components (A. Pothen and C.-J. Fan,
*Computing the block triangular form of a sparse matrix*, ACM TOMS 16, 1990). CasADi has that of
CSparse.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from ..base.arrays import Array, Expression
from ..base.scalars import column
from ..errors import MobilityError
from .iteration import place_roughly
from .legs import solve_leg
from .loops import ClosedForm, solve_loop, solves
from .multibody import Coordinate, LoopEquations, Multibody
from .released_loops import ReleasedLoops
from .sampling import Sampling, drawn
from .sizes import directs, extent
from .substitution import Numbers
from .two_force_links import idle_spins

_ABSENT = 1e-13
"""Relative slope of an equation below which a variable stands in it by rounding alone."""


@dataclass(frozen=True, eq=False)
class Equation:
    """One scalar equation of a loop or constraint, with its time derivatives, in the undriven
    coordinates that are ``present``.

    Beside its ``unit``, a length or a slope, a residual is small or large.
    """

    loop: LoopEquations
    row: int
    present: frozenset[Coordinate]
    unit: float
    residual: Any
    residual_rate: Any
    residual_acceleration: Any

    @property
    def aligns(self) -> bool:
        """True if it holds the direction of a joint's child: by its sine, which a half turn has
        too.
        """
        joint = self.loop.joint
        return joint is not None and joint.aligns and self.row == self.loop.residual.numel() - 1


@dataclass(frozen=True, eq=False)
class Block:
    """Equations solved together for ``unknown``; more equations than unknowns where the mechanism
    is over-constrained.

    ``forms`` solve them one after another; there are none where the block is iterated.
    """

    equations: tuple[Equation, ...]
    unknown: tuple[Coordinate, ...]
    forms: tuple[ClosedForm, ...]

    @property
    def residual(self) -> Expression:
        """The equations, one column."""
        return column(equation.residual for equation in self.equations)

    @property
    def residual_rate(self) -> Expression:
        """Total time derivative of the residuals."""
        return column(equation.residual_rate for equation in self.equations)

    @property
    def residual_acceleration(self) -> Expression:
        """Second total time derivative of the residuals."""
        return column(equation.residual_acceleration for equation in self.equations)

    @property
    def multipliers(self) -> Expression:
        """The symbols of their multipliers."""
        return column(equation.loop.multipliers[equation.row] for equation in self.equations)

    @property
    def loop_equations(self) -> tuple[LoopEquations, ...]:
        """The loops and constraints that they are of."""
        return tuple(dict.fromkeys(equation.loop for equation in self.equations))

    @property
    def name(self) -> str:
        """The loop or constraint that stands for the block where one name is wanted: its last."""
        return self.loop_equations[-1].name

    @property
    def joints(self) -> str:
        """The joints, bars and constraints that close the loops, for messages."""
        return ", ".join(f"{loop.kind} '{loop.name}'" for loop in self.loop_equations)

    @property
    def jacobian(self) -> Expression:
        """Phi_z, in symbols: how Phi' goes with the rates."""
        return ca.jacobian(self.residual_rate, column(c.rate for c in self.unknown))


Part = tuple[list[Equation], list[Coordinate]]
"""Equations, and the coordinates that they are solved for."""


def solving_order(
    multibody: Multibody, posture: Mapping[Coordinate, float], numbers: Numbers
) -> tuple[Block, ...]:
    """The blocks in the order of solution; among those that can be solved next, first the one that
    fewest joints close.

    Where the equations do not match the unknowns, the rank of their Jacobian decides, at the
    assembled start: equations that repeat what others say are kept, in blocks with more equations
    than unknowns. It starts from a rough ``posture``, drives included, and ``numbers`` of time and
    parameters.

    Raises :class:`MobilityError`, with the count of freedoms, where the drives do not match them.
    """
    unknown = [c for c in multibody.coordinates if not c.driven]
    equations = _equations(multibody, unknown)
    parts = _decomposed(equations, unknown)
    if any(len(rows) != len(columns) for rows, columns in parts):
        # Drives are free to give way in it, for there may be too many.
        rough = Numbers(numbers)
        place_roughly(multibody, posture, rough, {})
        released = ReleasedLoops.of(multibody, rough)
        closed = released.closed(released.first)
        slopes = None if closed is None else released.at(closed)[1]
        slopes = _require_freedom(multibody, len(equations), parts, slopes, released.rank, posture)
        parts = [piece for part in parts for piece in _pieces(part)]
        if multibody.mechanism.space:
            at = (
                {equation: k for k, equation in enumerate(equations)},
                {c: k for k, c in enumerate(multibody.coordinates)},
            )
            parts = [piece for part in parts for piece in _peeled(part, slopes, released.rank, *at)]
    counted = column(loop.residual for loop in multibody.loop_equations if loop.declared)
    ordered = _in_order(parts, multibody.loop_equations)
    return tuple(
        Block(tuple(rows), tuple(columns), _forms(multibody, rows, columns, counted))
        for rows, columns in ordered
    )


def _equations(multibody: Multibody, unknown: Sequence[Coordinate]) -> list[Equation]:
    """All scalar equations, without the coordinates that stand in them by rounding alone."""
    loops = multibody.loop_equations
    motion = [
        column(getattr(loop, name) for loop in loops)
        for name in ("residual", "residual_rate", "residual_acceleration")
    ]
    slopes = ca.jacobian(motion[1], column(c.rate for c in unknown))
    entries = drawn(column(slopes.nonzeros()), multibody.coordinates)
    sizes: list[dict[Coordinate, float]] = [{} for _ in range(slopes.size1())]
    for row, k, values in zip(*slopes.sparsity().get_triplet(), np.abs(entries), strict=True):
        largest = float(np.where(np.isnan(values), np.inf, values).max())
        sizes[row][unknown[k]] = largest * unknown[k].size
    found, mechanism = [], multibody.mechanism
    whole = mechanism.ownership.at_defaults(extent(mechanism))
    nothing = max(_ABSENT, multibody.slack)
    for k, (loop, row) in enumerate(
        (group, row) for group in loops for row in range(group.residual.numel())
    ):
        # What has no value at such points may be anything.
        unit = max((size for size in sizes[k].values() if np.isfinite(size)), default=0.0)
        if loop.joint is not None:
            unit = max(unit, 1.0 if directs(loop)[row] else whole)
        there = {c for c, size in sizes[k].items() if size > nothing * unit}
        # The three of a ball share their variables.
        sphericals = {c.spherical for c in there if c.spherical is not None}
        present = frozenset(c for c in unknown if c in there or c.spherical in sphericals)
        parts = ca.vertcat(*(expressions[k] for expressions in motion))
        written = {symbol.element_hash() for symbol in ca.symvar(parts)}
        absent = [c for c in unknown if c not in present and not written.isdisjoint(c.keys)]
        if absent:
            symbols = column(ca.vertcat(c.variables, c.rate, c.acceleration) for c in absent)
            parts = ca.substitute(parts, symbols, column(ca.DM([*c.resting, 0, 0]) for c in absent))
        found.append(Equation(loop, row, present, unit or 1.0, *ca.vertsplit(parts)))
    return found


def _decomposed(equations: Sequence[Equation], unknown: Sequence[Coordinate]) -> list[Part]:
    """Parts that can be solved one after another: square ones, and what has too many equations, or
    too many unknowns.

    What has neither an equation nor an unknown to go with is a part as well.
    """
    number = {c: k for k, c in enumerate(unknown)}
    entries = [(row, number[c]) for row, equation in enumerate(equations) for c in equation.present]
    pattern = ca.Sparsity.triplet(
        len(equations), len(unknown), [row for row, _ in entries], [k for _, k in entries]
    )
    count, row_order, column_order, row_cuts, column_cuts, *_ = pattern.btf()
    return [
        (
            [equations[k] for k in sorted(row_order[row_cuts[i] : row_cuts[i + 1]])],
            [unknown[k] for k in sorted(column_order[column_cuts[i] : column_cuts[i + 1]])],
        )
        for i in range(count)
    ]


def _pieces(part: Part) -> list[Part]:
    """A part in pieces that share neither a coordinate nor a loop or constraint.

    A piece with too many equations is not taken apart further: what is left of a parallelogram
    without one of its cranks is singular when its links lie on one line, and the whole is not.
    """
    rows, columns = part
    if len(rows) == len(columns):
        return [part]
    groups: list[tuple[list[Equation], set[Any]]] = []
    for equation in rows:
        shared = {equation.loop, *equation.present.intersection(columns)}
        joined = [group for group in groups if group[1] & shared]
        groups = [group for group in groups if group not in joined]
        groups.append(
            (
                [e for group in joined for e in group[0]] + [equation],
                shared.union(*(group[1] for group in joined)),
            )
        )
    return [(equations, [c for c in columns if c in shared]) for equations, shared in groups]


def _peeled(
    part: Part,
    slopes: Array,
    rank_of: Callable[[Array], int],
    row: Mapping[Equation, int],
    of: Mapping[Coordinate, int],
) -> list[Part]:
    """A part that has too many equations, loop by loop: in space a planar loop has, but says all of
    what it leaves no other.

    A loop that determines its coordinates by the rank of its own equations is solved by itself, the
    fewest coordinates first.
    """
    rows, columns = part
    found: list[Part] = []
    while len(rows) > len(columns):
        loops: dict[LoopEquations, list[Equation]] = {}
        for equation in rows:
            loops.setdefault(equation.loop, []).append(equation)
        for group in sorted(
            loops.values(),
            key=lambda group: len(
                frozenset().union(*(e.present for e in group)).intersection(columns)
            ),
        ):
            covered = [c for c in columns if any(c in equation.present for equation in group)]
            block = slopes[np.ix_([row[e] for e in group], [of[c] for c in covered])]
            if covered and len(group) < len(rows) and rank_of(block) == len(covered):
                found.append((group, covered))
                rows = [e for e in rows if e not in group]
                columns = [c for c in columns if c not in covered]
                break
        else:
            break
    return [*found, (rows, columns)]


def _in_order(parts: Sequence[Part], loops: Sequence[LoopEquations]) -> list[Part]:
    """The parts in an order in which each stands on the ones before; next the one that fewest
    joints close, then as declared.
    """
    owner = {c: i for i, (_, columns) in enumerate(parts) for c in columns}
    needs = [
        {owner[c] for equation in rows for c in equation.present} - {i}
        for i, (rows, _) in enumerate(parts)
    ]
    declared = {loop: k for k, loop in enumerate(loops)}
    ranks = [sorted({declared[equation.loop] for equation in rows}) for rows, _ in parts]
    found, left = [], set(range(len(parts)))
    while left:
        ready = (i for i in left if needs[i].isdisjoint(left))
        found.append(min(ready, key=lambda i: (len(ranks[i]), ranks[i], i)))
        left.remove(found[-1])
    return [parts[i] for i in found]


def row_units(multibody: Multibody, rows: Sequence[Equation]) -> Expression:
    """Factors by which equations are of one size, a column: a user's constraint is a number of any
    size, and of what is rounded the least gaps are looked for; 1 for those of joints and
    transmissions that hold, which are beside each other as they are.
    """
    mechanism, loops = multibody.mechanism, {equation.loop for equation in rows}
    alike = not mechanism.rounding and all(
        not loop.declared or mechanism.constraints[loop.name].transmission for loop in loops
    )
    if len(rows) == 1 or alike:
        return 1
    return ca.DM([1.0 / equation.unit for equation in rows])


def _forms(
    multibody: Multibody,
    rows: Sequence[Equation],
    unknown: Sequence[Coordinate],
    counted: Expression,
) -> tuple[ClosedForm, ...]:
    """The closed forms that solve a part one after another, where there are any."""
    if any(c.spherical is not None for c in unknown):
        return ()
    two_force_link = all(equation.loop.two_force_link is not None for equation in rows)
    phi, sampling = column(equation.residual for equation in rows), Sampling.of(multibody)
    beside_units = column(equation.residual / equation.unit for equation in rows)

    def verified(forms: Sequence[ClosedForm]) -> bool:
        return solves(forms, beside_units, sampling)

    form = solve_loop(
        phi,
        unknown,
        sampling,
        verified,
        units=row_units(multibody, rows),
        two_force_link=two_force_link,
    )
    forms: tuple[ClosedForm, ...] = (form,) if form is not None else ()
    if (
        not forms
        and len(unknown) in (2, 3)
        and len(rows) >= len(unknown)
        and len({equation.loop for equation in rows}) == 1
        and (joint := rows[0].loop.joint) is not None
    ):
        forms = solve_leg(joint, unknown, multibody, verified)
    # An angle whose turns some constraint counts must not come back from its cosine and sine.
    if any(form.branches for form in forms) and any(
        ca.depends_on(counted, c.value) for c in unknown
    ):
        return ()
    # The order of solution counts on what is absent from the equations: a form must not hold it
    # either, by its joint's places.
    present = {c for equation in rows for c in equation.present}
    absent = [c for c in multibody.coordinates if not c.driven and c not in present]
    return tuple(form.without(absent) for form in forms)


def _require_freedom(
    multibody: Multibody,
    equations: int,
    parts: Sequence[Part],
    slopes: Array | None,
    rank_of: Callable[[Array], int],
    given: Collection[Coordinate],
) -> Array:
    """The slopes; raise :class:`MobilityError` unless the drives are as many as the freedoms, and
    no part is loose.
    """
    driven = sum(c.driven for c in multibody.coordinates)
    how = "by the rank of its loops at the start"
    if slopes is None:
        freedom = len(multibody.coordinates) - equations
        how = "counted by joints; it could not be assembled to count by rank"
    else:
        freedom = len(multibody.coordinates) - rank_of(slopes)
        undriven = rank_of(
            slopes[:, [k for k, c in enumerate(multibody.coordinates) if not c.driven]]
        )
        if freedom == driven == len(multibody.coordinates) - undriven and all(
            len(rows) >= len(columns) for rows, columns in parts
        ):
            return slopes
    movable = list(multibody.mechanism.coordinates)
    advice = (
        f"drive {freedom} of the joints {', '.join(movable)}"
        if freedom > 0
        else "remove a joint, a constraint or a link"
    )
    lacking = [c.posture_key for c in multibody.coordinates if c not in given]
    if slopes is None and lacking:
        advice = f"also give a rough posture of {', '.join(lacking)}"
    elif freedom == driven:
        advice = (
            "but these over-determine some loops and leave others undetermined; drive other joints"
        )
    elif freedom > driven:
        advice += "".join(
            f"; {spin}"
            for spin in idle_spins(
                multibody.mechanism, [c.name for c in multibody.coordinates if c.driven]
            )
        )
    error = MobilityError(
        f"mechanism '{multibody.mechanism.name}' has {freedom} degree(s) of freedom ({how}) and"
        f" {driven} drive(s); {advice}"
    )
    error.assembled = slopes is not None
    raise error
