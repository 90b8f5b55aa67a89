"""What is no result, and why: the first instant at which a loop does not close, or is where its forces are not determined."""

from __future__ import annotations

import enum
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..arithmetic.compensated import DTYPES, ROUNDING, Precision
from ..codegen.designs import INSIDE, ROUNDS
from ..codegen.emit import NEWTON_LOST, NOT_CONVERGED, NOT_FINITE, OK, SLOW
from ..declare.density import Array
from ..equations.checks import Check
from ..equations.kinematics import passes_dead_centre, where
from ..equations.scene_graph import SceneGraph
from ..equations.turns import LEAP, REACH
from ..errors import AssemblyError
from .backends import Table, run
from .rung import Rung

MISFIT: dict[Precision, float] = {"double": 1e-8, "single": 1e-5}
"""How far equations that are too many may miss, of the links' length, and a row, of the size of its terms."""

_DEAD = 64.0
"""Roundings below which a closure says nothing but that it is zero."""


class Status(enum.IntEnum):
    """Whether there is a result, or why there is none."""

    OK = OK
    NOT_CONVERGED = NOT_CONVERGED
    NOT_FINITE = NOT_FINITE
    SLOW = SLOW
    OUT_OF_REACH = 4
    JUMPED = 5
    DEAD_CENTRE = 6
    PASSES_DEAD_CENTRE = 7
    MISFIT = 8
    ROW_VIOLATED = 9
    IMPOSSIBLE = 10
    INVALID = 11
    NOT_CLOSED = 12
    UNCERTIFIED = 13
    TURNED = 14
    PEAK_NOT_TOLD = 15

    @property
    def meaning(self) -> str:
        """The same in words."""
        return _MEANINGS[self]


_MEANINGS = {
    Status.OK: "there is a result",
    Status.NOT_CONVERGED: "the iterated loops did not converge",
    Status.NOT_FINITE: "a value is not finite: the mechanism is singular, or its numbers overflow",
    Status.SLOW: "the iterated loops converge slowly: they are near a dead centre",
    Status.OUT_OF_REACH: "a loop cannot be closed: its links do not reach",
    Status.JUMPED: "an iterated loop has jumped to another branch: more instants may help",
    Status.DEAD_CENTRE: "a loop is at a dead centre, within rounding: its forces are not determined there",
    Status.PASSES_DEAD_CENTRE: "a loop passes a dead centre between two instants, and can go on in two ways",
    Status.MISFIT: "loops are over-constrained and do not fit",
    Status.ROW_VIOLATED: "the motion violates a non-holonomic constraint",
    Status.IMPOSSIBLE: "a length is not positive, a mass or density is negative, or a station is outside its link",
    Status.INVALID: "a parameter is not finite",
    Status.NOT_CLOSED: "what was found for a loop does not satisfy its equations",
    Status.UNCERTIFIED: "the design was checked in full, and fails its certificate: others may be wrong as well",
    Status.TURNED: "an angle that a load sees with its turns might be a turn further",
    Status.PEAK_NOT_TOLD: "a peak cannot be told: too much may hide between the instants; more instants may help",
}


@dataclass(frozen=True)
class Refusal:
    """Why there is no result: a status, and the same in words that name the joint, the instant and the driven coordinates."""

    status: Status
    message: str


def refuse(graph: SceneGraph, table: Table, t: Array, p: Array, rung: Rung) -> None:
    """Raise :class:`AssemblyError` for the first instant that has no result."""
    found = refusal(graph, table, t, p, rung)
    if found is not None:
        raise AssemblyError(found.message)


def refusal(graph: SceneGraph, table: Table, t: Array, p: Array, rung: Rung) -> Refusal | None:
    """Why the first instant that has no result has none; None where all have."""
    precision = table.stages.precision
    bad, misfit = table.status != OK, MISFIT[precision]
    widest = gap_limit(precision, rung.newton) * graph.extent(p)
    passed: dict[str, npt.NDArray[np.bool_]] = {}
    for name, k in graph.checks("closure").items():
        bad |= ~(table.out[k] > dead_centre(graph, precision, name))
        passed[name] = passes_dead_centre(table.out[k], ends=graph.newton is None)
    for k in graph.checks("gap").values():
        bad |= ~(np.abs(table.out[k].astype(float)) <= widest)
    for k in graph.checks("turned").values():
        bad |= _turned(table.out[k])
    for k in graph.checks("misfit").values():
        bad |= ~(table.out[k] <= misfit)
    for name, k in graph.checks("row").items():
        bad |= ~(np.abs(table.out[k]) <= misfit * _largest_row(graph, table, name))
    for name, found in passed.items():
        if graph.newton is None and found.any():
            after = np.flatnonzero(found)
            found[after] = _dead_between(graph, name, t[after], t[after + 1], p, rung)
        bad |= found
    if not bad.any():
        return None
    i = int(np.argmax(bad))
    joints = graph.scene.mechanism.joints
    driven = np.atleast_1d(graph.motion(t[i], p)[0].full().ravel())
    at = where((name, joints[name].coordinate or "", value) for name, value in zip(graph.driven, driven, strict=True))
    at = f"at t = {t[i]:.6g} s{at}"
    status, why = _why(graph, table, i, at, [name for name in passed if passed[name][i]], widest)
    return Refusal(status, _beyond(graph, p, precision, at) or why)


def _turned(swing: Array) -> npt.NDArray[np.bool_]:
    """Where an angle may have made another turn: too far from the middle of its swing, or about to be as far on the other side."""
    return ~(np.abs(swing) <= REACH) | (np.abs(np.diff(swing, append=swing[-1:])) > LEAP)


def dead_centre(graph: SceneGraph, precision: Precision, closure: str) -> float:
    """Below what a closure says nothing: of a closed form it is the square of a sine, of an iterated loop as the sine itself."""
    square = _DEAD * ROUNDING[precision]
    return math.sqrt(square) if graph.iterates(closure) else square


def _largest_row(graph: SceneGraph, table: Table, row: str) -> float:
    """The largest size of a row over the instants: where all stands still, what rounding leaves of rates violates nothing."""
    sizes = table.out[graph.checks("rowsize")[row]]
    return float(np.fmax.reduce(sizes, initial=0.0))


def gap_limit(precision: Precision, newton: int | None) -> float:
    """How far what is left of a loop's equations may be from zero, of the mechanism's extent; ``newton`` as in :class:`.Rung`."""
    return MISFIT[precision] if newton is None else NEWTON_LOST


def _dead_between(graph: SceneGraph, name: str, start: Array, stop: Array, p: Array, rung: Rung) -> npt.NDArray[np.bool_]:
    """Whether a closure is zero between instants, looked for where it is lowest, ever closer."""
    lowest = np.full(start.size, np.inf)
    for _ in range(ROUNDS):
        inside = np.linspace(start, stop, INSIDE)
        table, _ = run(graph, inside.ravel(), p, Rung(rung.backend, rung.precision, flags=rung.flags))
        closure = table.out[graph.checks("closure")[name]].reshape(inside.shape)
        place = np.argmin(closure, axis=0)[None]
        lowest = np.fmin(lowest, np.take_along_axis(closure, place, 0)[0])
        start, stop = (np.take_along_axis(inside, np.clip(place + k, 0, INSIDE - 1), 0)[0] for k in (-1, 1))
    return ~(lowest > dead_centre(graph, rung.precision, name))


def _beyond(graph: SceneGraph, p: Array, precision: Precision, at: str) -> str | None:
    """What to say where a link's length cannot be squared in a precision."""
    mechanism, numbers = graph.scene.mechanism, np.finfo(DTYPES[precision])
    values = dict(zip(mechanism.parameters, p.tolist(), strict=True))
    low, high = math.sqrt(numbers.tiny), math.sqrt(numbers.max)
    for name, link in mechanism.links.items():
        length = mechanism.number(link.length, values)
        if not low <= length <= high:
            what = f"link '{name}' is {length:.3g} m long, and {precision} precision can only square {low:.1g} to {high:.1g} m"
            return f"the mechanism has no result {at}: {what}"
    return None


def _why(graph: SceneGraph, table: Table, i: int, at: str, passed: Sequence[str], widest: float) -> tuple[Status, str]:
    if table.status[i] == NOT_CONVERGED:
        assert graph.newton is not None
        cause = "their links do not reach, or the instant before is too far off"
        return Status.NOT_CONVERGED, f"the loops closed by {graph.newton.joints} did not converge {at}: {cause}"
    precision = table.stages.precision
    values = dict(zip(graph.columns, table.out[:, i], strict=True))
    misfit = MISFIT[precision]
    for column, value in values.items():
        if not isinstance(column, Check):
            continue
        kind, joint = column.kind, str(column.part)
        limit = dead_centre(graph, precision, joint)
        closed = f"{'joint' if joint in graph.scene.mechanism.joints else 'constraint'} '{joint}'"
        if kind == "closure" and value < -limit:
            if graph.newton is not None and f"'{joint}'" in graph.newton.joints:
                return Status.JUMPED, f"the loop closed by {closed} has jumped to another branch {at}: take more instants"
            return Status.OUT_OF_REACH, f"the loop closed by {closed} cannot be closed {at}: its links do not reach"
        if kind == "closure" and not value > limit:
            why = f"the loop closed by {closed} is at a dead centre {at}, within rounding: its forces are not determined there"
            return Status.DEAD_CENTRE, why
        if kind == "closure" and joint in passed:
            near = "; if it only comes near one, take more instants" if graph.newton is not None else ""
            passing = f"the loop closed by {closed} passes a dead centre after {at.removeprefix('at ')}"
            return Status.PASSES_DEAD_CENTRE, f"{passing}, and can go on in two ways{near}"
        if kind in ("gap", "misfit") and table.status[i] == SLOW:
            break
        if kind == "gap" and abs(value) > widest:
            gap = f"a gap of {abs(value):.3g} m"
            return Status.NOT_CLOSED, f"what was found for the loop closed by {closed} does not close it {at}: {gap}"
        if kind == "misfit" and value > misfit:
            gap = f"a gap of {value:.3g} of the links' length"
            return Status.MISFIT, f"the loops closed by {closed} are over-constrained and do not fit {at}: {gap}"
        if kind == "turned" and _turned(table.out[graph.columns.index(column), i : i + 2])[0]:
            what = f"the angle of '{joint}', which a load sees with its turns,"
            if abs(value) <= REACH:
                return Status.TURNED, f"{what} goes most of a turn from the instant {at} to the next: take more instants"
            swing = f"swings {math.degrees(value):.3g} deg from the middle of its swing over the scene's motion {at}"
            return (
                Status.TURNED,
                f"{what} {swing}: it might be a turn further; take defaults and a motion that show how far it goes",
            )
        if kind == "row" and not abs(value) <= misfit * _largest_row(graph, table, joint):
            return Status.ROW_VIOLATED, f"the motion violates the non-holonomic constraint '{joint}' by {value:.6g} {at}"
    if table.status[i] == SLOW:
        assert graph.newton is not None
        cause = "they are near a dead centre, or the instant before is too far off"
        return Status.SLOW, f"the loops closed by {graph.newton.joints} converge slowly {at}: {cause}"
    name = next(column for column, value in values.items() if not math.isfinite(value))
    return Status.NOT_FINITE, f"'{name}' is not finite {at}: the mechanism is singular there, or its numbers overflow"
