"""Grows the graphs of a mechanism outward from the ground, along its spanning tree."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import replace
from typing import Any

import casadi as ca

from ..declare.corners import smooth_constraint
from ..declare.joints import Axis, Joint
from ..declare.mechanism import Mechanism
from ..declare.parts import Constraint
from ..errors import DeclarationError
from ..geometry.frames import Carried, Frame, Velocities
from ..geometry.vectors import times
from .applied import applied_by, held_by, push, work
from .growing import Grown, coordinates_of
from .inertia import kinetic_energy
from .joints import closing_gaps
from .meshes import meshed_by
from .multibody import Applied, LoopEquations, Multibody, RowGraph, change, column
from .tree import Tree


def assemble(
    mechanism: Mechanism,
    tree: Tree,
    driven: Collection[str],
    reactions: Collection[str],
    pushed: Collection[str] = (),
    own: Collection[str] = (),
) -> Multibody:
    """The graphs of a frozen mechanism, with mobilities for the named joints' reactions, and for nothing else.

    ``driven`` are the joints whose motion is given, and ``pushed`` those along which efforts are unknowns of their own; ``own``
    names the user's outputs.

    The frames and gaps that positions are solved from are built without any mobility: they do not depend on what is wanted.
    Gravity is an acceleration of the ground, upward, in the frames that matter is weighed in (d'Alembert).
    """
    seen = [measure.axis.coordinate for measure in mechanism.measures.asked if measure.axis is not None]
    carried = coordinates_of(mechanism, tree, driven, {*seen, *pushed})
    upward = times(-1, mechanism.gravity)
    weighed = Carried(acceleration=upward, own=Frame(acceleration=upward)) if mechanism.space else Frame(acceleration=upward)
    resting, felt = Grown(mechanism, carried, Frame()), Grown(mechanism, carried, weighed)
    for branch in tree.branches:
        resting.hang(branch, displace=False)
        # What acts where loops close is in ground axes.
        felt.hang(branch, displace=branch.joint.name in reactions, along=not (tree.closing or tree.bars))
    loops = [_loop_equations(joint.name, joint, *closing_gaps(joint, *resting.ends(joint))) for joint in tree.closing]
    loops += [_loop_equations(bar.link.name, None, *map(ca.SX, resting.span(bar, displace=()))) for bar in tree.bars]
    loops[len(tree.closing) :] = [replace(loop, bar=bar) for loop, bar in zip(loops[len(tree.closing) :], tree.bars, strict=True)]
    for bar in tree.bars:
        felt.span(bar, displace=[joint.name for joint in bar.joints if joint.name in reactions])
    for constraint in mechanism.constraints.values():
        gap = resting.counted(constraint.phi)
        rate = change(gap, resting.coordinates, mechanism.time)
        equations = _loop_equations(constraint.name, None, gap, rate, change(rate, resting.coordinates, mechanism.time))
        smooth = smooth_constraint(mechanism, constraint)
        loops.append(equations if smooth is None else replace(equations, seen=resting.counted(ca.vertcat(*smooth.symbols))))
    rows = tuple(_row(resting, row) for row in mechanism.rows.values())
    applied = tuple(part for load in mechanism.loads.values() for part in applied_by(load, resting))
    held = [part for loop in loops if loop.declared for part in _held(resting, mechanism.constraints[loop.name], loop)]
    held += [part for graph in rows for part in held_by(resting, graph.row.name, graph.row.expression, graph)]
    velocities = Velocities()
    spun = {b.far.body for b in tree.branches if not b.joint.slides and (b.joint.name in driven or b.near.body is mechanism.ground)}
    slid = {b.far.body for b in tree.branches if b.reverse and b.joint.slides}
    energies = [
        kinetic_energy(
            body, felt.frames[body.name], velocities, space=mechanism.space, spun=body in spun and body.oriented, slid=body in slid
        )
        for body in mechanism.moving
    ]
    kinetic = sum(energies, ca.SX(0))
    work(felt, (*applied, *held), loops, velocities)
    # Where a joint with three turns closes a loop, its angles are not measured.
    open_ = [joint for joint in tree.closing if joint.turns > 2] + [joint for bar in tree.bars for joint in bar.joints]
    balls = [c.name for c in resting.coordinates if c.ball is not None]
    outputs = {name: resting.at_state(mechanism.outputs[name].expression) for name in own}
    efforts = {name: ca.SX.sym(f"tau_{name}") for name in pushed}
    for name, effort in efforts.items():
        _refuse_unmeasured(name, *mechanism.coordinates[name], tree, open_)
        push(felt, *mechanism.coordinates[name], effort, velocities)
    return Multibody(
        mechanism=mechanism,
        tree=tree,
        coordinates=resting.coordinates,
        loop_equations=tuple(loops),
        rows=rows,
        mobilities=felt.mobilities,
        own_axes=frozenset(felt.own_axes),
        frames=resting.frames,
        felt=felt.frames,
        applied=applied,
        held=tuple(held),
        efforts=efforts,
        along={
            name: resting.along(joint, axis)
            for name, (joint, axis) in mechanism.coordinates.items()
            if joint not in open_ and name not in balls
        },
        axes=resting.turning,
        own=outputs,
        turned=tuple(resting.turned.values()),
        kinetic=kinetic,
        velocities=velocities,
    )


def _held(resting: Grown, constraint: Constraint, loop: LoopEquations) -> Iterable[Applied]:
    """What a constraint's multiplier does to bodies."""
    if constraint.transmission is not None:
        return meshed_by(resting, constraint.transmission, loop.multipliers)
    return held_by(resting, constraint.name, constraint.phi, loop)


def _refuse_unmeasured(name: str, joint: Joint, axis: Axis, tree: Tree, unmeasured: Collection[Joint]) -> None:
    """Raise :class:`DeclarationError` for a drive along a turn that has no angle."""
    if axis.kind != "angle" or joint not in unmeasured:
        return
    bars = [bar.link.name for bar in tree.bars if joint in bar.joints]
    why = (
        f"the spin of bar '{bars[0]}' is idle and moves nothing"
        if bars
        else "the joint closes a loop, where its turns are not told"
    )
    raise DeclarationError(f"drive '{name}': {why}; drive another joint")


def _loop_equations(name: str, joint: Joint | None, gap: Any, rate: Any, acceleration: Any) -> LoopEquations:
    return LoopEquations(name, joint, gap, rate, acceleration, ca.SX.sym(f"lambda_{name}", gap.numel()))


def _row(resting: Grown, row: Any) -> RowGraph:
    """A row, and the size of what is added up in it: rates of coordinates, in what is measured, in the row.

    Not the size of its own terms: of a motion along which a row is idle, all of them are rounding.
    """
    residual, rates = resting.at_state(row.expression), column(c.rate for c in resting.coordinates)
    measured = resting.mechanism.measures.rates
    slopes = ca.fabs(resting.at_state(ca.jacobian(row.expression, measured)))
    going = ca.fabs(ca.jacobian(resting.at_state(measured), rates)) @ ca.fabs(rates)
    rest = ca.fabs(resting.at_state(ca.substitute(row.expression, measured, ca.SX.zeros(measured.numel()))))
    return RowGraph(row, residual, slopes @ going + rest, ca.SX.sym(f"mu_{row.name}"))
