"""The efforts that hold a mechanism where joints that rub are at rest: from the least that may be
needed to the largest.

At rest a friction s is anything with |s| <= mu P(s), and P, the sum of sizes of what presses,
follows from all frictions: it is a norm of what is linear in them. Efforts are linear in them too.
An effort is largest where each friction at rest is at a limit: let it be largest at s*, and put in
place of each P that is reached its tangent at s*, which is nowhere above it. Of that linear
programme s* is a solution too, for near s* it asks for more. If the effort changes with a limit
that is reached, that limit is reached at all solutions; with the other frictions the effort then
does not change at all, and these may go to limits as well. They can: I - B is an M-matrix (see
:mod:`.engine.friction`), so for every choice of signs there are such frictions, and only one. So
all choices of signs are tried.

This is not so where a friction that slides changes with one at rest, for it is bound to one side of
its law; nor where a joint at rest may slide along two coordinates, or turn any way, for its
friction is then bound by a circle or a ball.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt

from ..base.arguments import public
from ..base.arrays import Array, Flags
from ..base.quantities import Check, Output
from ..engine.derive import derived
from ..engine.friction import SLIP
from ..engine.held_efforts import HeldEfforts, held_efforts
from ..engine.instants.backends import run
from ..engine.instants.beyond_equilibrium import Holding
from ..engine.instants.evaluation_method import EvaluationMethod
from ..engine.program import Program
from ..engine.verdicts import OPEN
from ..model.scene import Scene
from .histories import Histories
from .solution import Solution

_MOST = 10
"""Frictions at rest of which all choices of signs are tried."""

_BENDS, _JAMS = 1e-9, 1e-14


@public
def holding(scene: Scene, solution: Solution) -> dict[str, Holding]:
    """Return the range of each drive's effort that holds the mechanism where joints are at rest.

    Parameters
    ----------
    scene
        The scene.
    solution
        A solution of it that has efforts.

    Returns
    -------
    dict of str to Holding
        By joint the least and the largest effort, by sign, at each instant (t,) [N m or N].

    Raises
    ------
    DeclarationError
        For what is no scene or no solution.
    """
    determined = {
        output.part: Holding(values, values, solution.unit(output))
        for output, values in solution.outputs.items()
        if output.group == "effort"
    }
    return determined | held_at_rest(scene, solution)


def held_at_rest(scene: Scene, histories: Histories) -> dict[str, Holding]:
    """The ranges of those efforts that friction at rest leaves open at some instant."""
    open_at = {
        output.part: histories.resting & np.isnan(values)
        for output, values in histories.outputs.items()
        if output.group == "effort"
    }
    open_at = {name: instants for name, instants in open_at.items() if instants.any()}
    if not open_at:
        return {}
    at = np.flatnonzero(np.any([*open_at.values()], axis=0))
    values = histories.description.values
    program, near = derived(scene, ["effort"], values)
    held, p = held_efforts(near), np.array([*values.values()])
    tried, why = _tried(held, _inputs(program, histories.t, p, at))
    ranges = {}
    for name, instants in open_at.items():
        output, reasons = Output("effort", name), list(why)
        found = tried[:, held.columns.index(output)]
        if (doubt := Check("open", output)) in held.columns:
            reasons.append(
                (
                    (tried[:, held.columns.index(doubt)] > OPEN["double"]).any(axis=0),
                    "equilibrium does not determine it",
                )
            )
        reasons.append((~np.isfinite(found).all(axis=0), "it is not finite"))
        known = ~np.any([wrong for wrong, _ in reasons], axis=0)
        there = instants[at]
        least, largest = (histories.outputs[output].copy() for _ in range(2))
        least[at[there]] = np.where(known, found.min(axis=0), np.nan)[there]
        largest[at[there]] = np.where(known, found.max(axis=0), np.nan)[there]
        reason = next((words for wrong, words in reasons if wrong[there].any()), "")
        ranges[name] = Holding(least, largest, histories.unit(output), reason)
    return ranges


_FAULTS: dict[str, tuple[Callable[[Array], Flags], str]] = {
    "bend": (lambda bends: bends > _BENDS, "slides, and depends on those at rest"),
    "jam": (lambda margins: ~(margins > _JAMS), "may jam"),
    "slip": (lambda slips: ~(slips <= SLIP["double"]), "may jam"),
}
"""Checks of a friction: where it is at fault, and what it does."""

_Reasons = list[tuple[Any, str]]
"""Instants (t,) at which a range is not available, and the reasons."""


def _inputs(program: Program, t: Array, p: Array, at: npt.NDArray[np.intp]) -> list[ca.DM]:
    """Arguments of a scene's columns, for some of the instants ``t``."""
    z = (
        np.zeros((0, at.size))
        if program.newton is None
        else run(program, t, p, EvaluationMethod("vm"))[0].iterated[:, at]
    )
    moved = program.motion(ca.DM(t[at]).T, ca.DM(p))
    return [ca.DM(t[at]).T, *moved, ca.DM(z), ca.DM(p)]


def _tried(held: HeldEfforts, inputs: list[ca.DM]) -> tuple[Array, _Reasons]:
    """The columns for all choices of signs of the frictions that rest, (choices, columns, t); and
    where these are not enough.
    """

    def columns(signs: Array) -> Array:
        return np.asarray(held.instant(*inputs, ca.DM(signs)).full())

    signs = np.ones(len(held.frictions))
    first = columns(signs)
    checks = {(c.kind, str(c.part)): k for k, c in enumerate(held.columns) if isinstance(c, Check)}
    rests = {name: first[k] > 0.5 for (kind, name), k in checks.items() if kind == "rest"}
    why: _Reasons = [
        (rest, f"friction '{name}' may hold its joint in more than one direction")
        for name, rest in rests.items()
        if name in held.every_way
    ]
    resting = [held.frictions.index(name) for name, rest in rests.items() if rest.any()]
    if len(resting) > _MOST:
        return first[None], [
            *why,
            (
                np.ones(first.shape[1], bool),
                (f"{len(resting)} frictions are at rest, at most {_MOST} are supported"),
            ),
        ]
    found = []
    for chosen in itertools.product((1.0, -1.0), repeat=len(resting)):
        signs[resting] = chosen
        found.append(columns(signs))
    tried = np.array(found)
    for (kind, name), k in checks.items():
        if kind in _FAULTS:
            wrong, words = _FAULTS[kind]
            why.append((wrong(tried[:, k]).any(axis=0), f"friction '{name}' {words}"))
    return tried, why
