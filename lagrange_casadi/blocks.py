"""The order in which loops can be solved: blocks of equations, each as small as possible, and the count of freedoms."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from .errors import MobilityError
from .loops import ClosedForm, solve_loop
from .multibody import Closure, Coordinate, Multibody, column

_STEPS = 200
_CLOSED = 1e-11
_DEPENDENT = 1e-9


@dataclass(frozen=True, eq=False)
class Block:
    """Loop equations solved together for ``unknown``; more equations than unknowns where the mechanism is over-constrained."""

    closures: tuple[Closure, ...]
    unknown: tuple[Coordinate, ...]
    gap: Any
    form: ClosedForm | None

    @property
    def gap_rate(self) -> Any:
        """The total time derivative of the equations."""
        return column(closure.gap_rate for closure in self.closures)

    @property
    def gap_acceleration(self) -> Any:
        """Their second one."""
        return column(closure.gap_acceleration for closure in self.closures)

    @property
    def name(self) -> str:
        """The closure that stands for the block where one name is wanted: its last."""
        return self.closures[-1].name

    @property
    def joints(self) -> str:
        """The joints and constraints that close the loops, for messages."""
        return ", ".join(f"{'joint' if closure.joint else 'constraint'} '{closure.name}'" for closure in self.closures)

    @property
    def jacobian(self) -> Any:
        """Phi_z, in symbols: how Phi' goes with the rates."""
        return ca.jacobian(self.gap_rate, column(c.rate for c in self.unknown))


def plan(multibody: Multibody, start: Mapping[str, Any]) -> tuple[Block, ...]:
    """The blocks in the order of solution, smallest first among those that can be solved next.

    Where the equations do not match the unknowns in number, the rank of their Jacobian decides, at the assembled start: equations
    that repeat what others say are kept, as blocks with more equations than unknowns. ``start`` holds numbers at the start:
    ``posture`` (by coordinate), ``inputs`` (symbols) and ``values``.

    Raises :class:`MobilityError`, with the count of freedoms, where the drives do not match them.
    """
    driven = sum(c.driven for c in multibody.coordinates)
    equations = sum(closure.gap.numel() for closure in multibody.closures)
    by_count = len(multibody.coordinates) - equations
    blocks = _arrange(multibody, redundant=False) if by_count == driven else None
    if blocks is not None:
        return blocks
    freedom = _freedom(multibody, start)
    if freedom is None:
        freedom, how = by_count, "counted by joints; it could not be assembled to count by rank"
    else:
        how = "by the rank of its loops at the start"
    if freedom == driven:
        blocks = _arrange(multibody, redundant=True)
    if blocks is None:
        movable = [name for name, joint in multibody.mechanism.joints.items() if joint.coordinate]
        advice = (
            f"drive {freedom} of the joints {', '.join(movable)}" if freedom > 0 else "take a joint, a constraint or a link away"
        )
        if freedom == driven:
            advice = "but these over-determine some loops and leave others loose; drive other joints"
        raise MobilityError(
            f"mechanism '{multibody.mechanism.name}' has {freedom} degree(s) of freedom ({how}) and {driven} drive(s); {advice}"
        )
    return blocks


def _arrange(multibody: Multibody, *, redundant: bool) -> tuple[Block, ...] | None:
    """Blocks in order, or None where the structure of the equations does not allow it.

    Where some equations repeat others, all that hang together are one block: taken apart, a part could be singular where the
    whole is not, as a parallelogram is when its links lie on one line.
    """
    unknown = [c for c in multibody.coordinates if not c.driven]
    blocks: list[Block] = []
    for closures in _components(multibody, unknown) if redundant else [list(multibody.closures)]:
        touched = [c for c in unknown if any(ca.depends_on(closure.gap, c.variables) for closure in closures)]
        if redundant and sum(closure.gap.numel() for closure in closures) > len(touched):
            blocks.append(Block(tuple(closures), tuple(touched), column(closure.gap for closure in closures), None))
            unknown = [c for c in unknown if c not in touched]
            continue
        while closures:
            block = _next(closures, unknown, _counted(multibody))
            if block is None:
                return None
            blocks.append(block)
            closures = [closure for closure in closures if closure not in block.closures]
            unknown = [c for c in unknown if c not in block.unknown]
    return None if unknown else tuple(blocks)


def _components(multibody: Multibody, unknown: Sequence[Coordinate]) -> list[list[Closure]]:
    """Closures that share unknown coordinates, directly or through others."""
    groups: list[tuple[list[Closure], set[Coordinate]]] = []
    for closure in multibody.closures:
        own = {c for c in unknown if ca.depends_on(closure.gap, c.variables)}
        joined = [group for group in groups if group[1] & own]
        groups = [group for group in groups if group not in joined]
        groups.append(([c for group in joined for c in group[0]] + [closure], own.union(*(group[1] for group in joined))))
    return [group[0] for group in groups]


def _next(waiting: Sequence[Closure], unknown: Sequence[Coordinate], counted: Any) -> Block | None:
    for size in range(1, len(waiting) + 1):
        for chosen in itertools.combinations(waiting, size):
            gap = ca.vertcat(*(closure.gap for closure in chosen))
            touched = tuple(c for c in unknown if ca.depends_on(gap, c.variables))
            if len(touched) == gap.numel():
                form = solve_loop(gap, touched)
                # An angle whose turns some constraint counts must not come back from its cosine and sine.
                if form is not None and form.closure is not None and any(ca.depends_on(counted, c.value) for c in touched):
                    form = None
                return Block(chosen, touched, gap, form)
            if len(touched) < gap.numel():
                return None
    return None


def _counted(multibody: Multibody) -> Any:
    """The users' constraints, which take angles with their turns."""
    return column(closure.gap for closure in multibody.closures if closure.joint is None)


def _freedom(multibody: Multibody, start: Mapping[str, Any]) -> int | None:
    """Coordinates less the rank of the loops' Jacobian, at a posture found from the rough one; None where there is none."""
    unknown = [c for c in multibody.coordinates if not c.driven]
    free = ca.SX.sym("u", len(unknown))
    values = column(
        ca.vertcat(ca.cos(free[i]), ca.sin(free[i]), free[i]) if c.kind == "angle" else free[i] for i, c in enumerate(unknown)
    )
    gaps = ca.substitute(column(c.gap for c in multibody.closures), column(c.variables for c in unknown), values)
    f = ca.Function("gaps", [free, *start["inputs"]], [gaps, ca.jacobian(gaps, free)])
    u = np.array([start["posture"].get(c, 0.0) for c in unknown])
    for _ in range(_STEPS):
        gap, slope = (x.full() for x in f(u, *start["values"]))
        step = np.linalg.lstsq(slope, -gap.ravel(), rcond=1e-10)[0] if u.size else u
        u = u + step * min(1.0, 0.5 / (np.max(np.abs(step), initial=0.0) + 1e-300))
        if np.max(np.abs(gap), initial=0.0) < _CLOSED:
            scaled = slope / (np.linalg.norm(slope, axis=0) + 1e-300)
            return len(multibody.coordinates) - int(np.linalg.matrix_rank(scaled, tol=_DEPENDENT) if scaled.size else 0)
    return None
