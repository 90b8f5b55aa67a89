"""The inertia of what a drive moves, reflected to the drive, at every instant of a motion."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...base.arguments import public
from ...base.arrays import Array
from ...engine.instants.backends import run
from ...engine.instants.evaluation_method import EvaluationMethod
from ...engine.instants.refusing import refuse
from ...engine.reflected_inertia import ReflectedInertia, reflected_inertia
from ...errors import DeclarationError, check_known
from ...model.scene import Scene
from ...model.times import Over, Times, instants_of

_VM = EvaluationMethod("vm")


@public
def inertia_at(
    scene: Scene,
    joint: str,
    *,
    parameters: Mapping[str, float] | None = None,
    t: Times | None = None,
    over: Over | None = None,
) -> Array:
    """Return the inertia reflected to a drive, at every instant.

    Parameters
    ----------
    scene : Scene
        A mechanism and its motion.
    joint : str
        The driven joint.
    parameters : mapping, optional
        Values of parameters, by name.
    t, over : tuple, optional
        Other instants, as of :func:`.evaluate`.

    Returns
    -------
    array
        Inertia (t,) [kg m^2; kg of a drive that slides]: twice the kinetic energy of everything
        that moves if the drive moves at unit rate and the other drives are at rest. It does not
        depend on the rates of the motion, nor on friction. It is infinite at a dead centre, at
        which the drive cannot move the mechanism.

    Raises
    ------
    UnknownNameError
        If the joint is not a drive.
    DeclarationError
        If there are not as many drives as motions, and as :func:`.evaluate` does.
    """
    values = scene.values(parameters)
    reflected = reflected_inertia(scene, values)
    check_known("drive", [joint], reflected.drives)
    several = len(reflected.motions) > 1
    rows = reflected.program.data.content.rows
    if rows or (several and len(reflected.drives) != len(reflected.motions)):
        why = (
            "non-holonomic constraints"
            if rows
            else f"{len(reflected.drives)} drives for {len(reflected.motions)} motions"
        )
        raise DeclarationError(
            f"inertia at '{joint}': with {why} no drive can move alone while the others are at rest"
        )
    times = instants_of(scene.prescribed, scene.timing(t, over), values).t
    p = np.array(list(values.values()))
    found, _ = run(reflected.program, times, p, _VM)
    refuse(reflected.program, found, times, p, _VM)
    return _alone(reflected, np.asarray(found.out, float), reflected.drives.index(joint))


def _alone(reflected: ReflectedInertia, out: Array, drive: int) -> Array:
    """Inertia at one drive alone, from the columns M and R (columns, t)."""
    count = len(reflected.motions)
    matrix, by_rate = (
        part.reshape(-1, count, out.shape[1]).transpose(2, 0, 1)
        for part in (out[: count * count], out[count**2 :])
    )
    if count == 1:
        with np.errstate(divide="ignore"):
            return np.asarray(matrix[:, 0, 0] / by_rate[:, drive, 0] ** 2)
    found = np.full(out.shape[1], np.inf)
    moved = np.linalg.det(by_rate) != 0.0
    unit = np.linalg.solve(by_rate[moved], np.eye(count)[:, [drive]])[:, :, 0]
    found[moved] = np.einsum("ti,tij,tj->t", unit, matrix[moved], unit)
    return found
