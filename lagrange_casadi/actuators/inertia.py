"""The inertia of what a drive moves, as the drive feels it, at every instant of a motion.

With E = q'.M q'/2 for the rates q' whose laws are given, and v = R q' for those of the drives, a drive alone feels the inertia
e.(R^-T M R^-1) e, the other drives at rest. Nothing depends on how fast the mechanism moves.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import casadi as ca
import numpy as np

from ..arguments import public
from ..base.arrays import Array
from ..base.quantities import Output
from ..declare.scene import Scene, Wanted
from ..declare.spatial import reference_posture
from ..declare.times import Over, Times, instants_of
from ..equations import kinematics
from ..equations.assembly import assemble
from ..equations.checks import Column
from ..equations.derive import assembled
from ..equations.kinematics import Start
from ..equations.model_data import ModelData
from ..equations.multibody import column
from ..equations.program import Program
from ..equations.tree import span
from ..errors import DeclarationError, UnknownNameError
from ..instants.backends import run
from ..instants.refusal import refuse
from ..instants.rung import Rung

_VM = Rung("vm")


@public
def inertia_at(
    scene: Scene,
    joint: str,
    *,
    parameters: Mapping[str, float] | None = None,
    t: Times | None = None,
    over: Over | None = None,
) -> Array:
    """The inertia that a drive feels at the scene's instants, or at others, (t,) [kg m^2; kg of a drive that slides].

    It is twice the kinetic energy of all that moves where the drive moves at unit rate and other drives are at rest, whatever the
    motion: at rest too. A mechanism's varies over its cycle. It is infinite where the drive cannot move the mechanism, at a dead
    centre. Where friction is, it is without it.

    Raises :class:`.UnknownNameError` for what is no drive, :class:`.DeclarationError` where drives and motions are not as many, and
    as :func:`.evaluate` does.
    """
    values = scene.values(parameters)
    seen = seen_inertia(scene, values)
    if joint not in seen.drives:
        raise UnknownNameError("drive", joint, seen.drives)
    several = len(seen.motions) > 1
    rows = seen.program.data.template.content["rows"]
    if rows or (several and len(seen.drives) != len(seen.motions)):
        why = "non-holonomic constraints" if rows else f"{len(seen.drives)} drives for {len(seen.motions)} motions"
        raise DeclarationError(f"inertia at '{joint}': with {why} no drive moves alone, the others at rest")
    times, p = instants_of(scene.prescribed, scene.timing(t, over), values).t, np.array(list(values.values()))
    found, _ = run(seen.program, times, p, _VM)
    refuse(seen.program, found, times, p, _VM)
    return _alone(seen, np.asarray(found.out, float), seen.drives.index(joint))


def _alone(seen: SeenInertia, out: Array, drive: int) -> Array:
    """Of the columns M and R (columns, t) the inertia that one drive feels alone."""
    count = len(seen.motions)
    matrix, by_rate = (part.reshape(-1, count, out.shape[1]).transpose(2, 0, 1) for part in (out[: count * count], out[count**2 :]))
    if count == 1:
        with np.errstate(divide="ignore"):
            return np.asarray(matrix[:, 0, 0] / by_rate[:, drive, 0] ** 2)
    found = np.full(out.shape[1], np.inf)
    moved = np.linalg.det(by_rate) != 0.0
    unit = np.linalg.solve(by_rate[moved], np.eye(count)[:, [drive]])[:, :, 0]
    found[moved] = np.einsum("ti,tij,tj->t", unit, matrix[moved], unit)
    return found


@dataclass(frozen=True, eq=False)
class SeenInertia:
    """A program whose columns are the matrix M (``motions``, ``motions``), row by row, and then R (``drives``, ``motions``)."""

    program: Program
    motions: tuple[str, ...]
    drives: tuple[str, ...]


def seen_inertia(scene: Scene, parameters: Mapping[str, float]) -> SeenInertia:
    """Compile what drives of a scene see, assembled as :func:`.compile_scene` does it. Raises as that does."""
    scene = assembled(scene, parameters, ["motion"])
    mechanism = scene.mechanism
    drives = scene.needs_drives if scene.weights is None else tuple(scene.weights)
    body = assemble(scene.guided, span(scene.guided, scene.laws), scene.laws, ())
    driven = tuple(c.name for c in body.coordinates if c.driven)
    laws = scene.prescribed.only(driven)
    values = list(mechanism.values(scene.assembly).values())
    first = [float(x) for x in ca.DM(laws.motion(scene.span[0], values)[0]).full().ravel()]
    start = Start(scene.span[0], first, values)
    solved = kinematics.solve(body, reference_posture(mechanism) | dict(scene.posture), start)
    energy = ca.substitute(ca.SX(body.kinetic), column(body.velocities.symbols), column(body.velocities.graphs))
    still = body.mobility_rates
    energy = solved.evaluate(ca.substitute(energy, still, ca.SX.zeros(still.numel())))
    own = {c.name: solved.driven_rate[k] for k, c in enumerate(c for c in body.coordinates if c.driven)}
    rates = [
        own[name] if name in own else solved.evaluate(ca.SX(body.motion_along(*mechanism.coordinates[name])[1])) for name in drives
    ]
    matrix, by_rate = ca.hessian(energy, solved.driven_rate)[0], ca.jacobian(column(rates), solved.driven_rate)
    out = ca.densify(ca.vertcat(ca.vec(matrix.T), ca.vec(by_rate.T)))
    inputs = [mechanism.time, solved.driven, solved.driven_rate, solved.driven_acceleration, solved.iterated, mechanism.symbols]
    instant = ca.Function("instant", inputs, [out], ["t", "d", "d_rate", "d_acceleration", "z", "p"], ["out"], {"cse": True})
    columns: list[Column] = [Output("output", f"{a}:{b}") for a in (*driven, *drives) for b in driven]
    data, want = ModelData.of(scene, laws), Wanted.of(mechanism, ["motion"])
    return SeenInertia(Program(data, want, instant, solved.newton, tuple(columns), {}), driven, drives)
