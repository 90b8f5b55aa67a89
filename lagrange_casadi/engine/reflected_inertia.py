"""The inertia that drives see: how the kinetic energy goes with the rates whose laws are given, and
these with those of the drives.

With E = q'.M q'/2 for the rates q' whose laws are given, and v = R q' for those of the drives, a
drive alone accelerates the inertia e.(R^-T M R^-1) e, the other drives at rest. Nothing depends on
how fast the mechanism moves.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import casadi as ca

from ..base.quantities import Column, Output
from ..base.scalars import column, graph
from ..base.vectors import dot
from ..model.scene import Scene, Wanted
from .assembly import assemble
from .derive import derived
from .model_data import ModelData
from .moving import solved_motion
from .program import Program
from .tree import span


@dataclass(frozen=True, eq=False)
class ReflectedInertia:
    """A program whose columns are the matrix M (``motions``, ``motions``), row by row, and then R
    (``drives``, ``motions``).
    """

    program: Program
    motions: tuple[str, ...]
    drives: tuple[str, ...]


def reflected_inertia(scene: Scene, parameters: Mapping[str, float]) -> ReflectedInertia:
    """Compile what drives of a scene see, assembled as :func:`.compile_scene` does it.

    Raises as that does.
    """
    _, scene = derived(scene, ["motion"], parameters)
    mechanism = scene.mechanism
    drives = scene.needs_drives if scene.weights is None else tuple(scene.weights)
    body = assemble(scene.guided, span(scene.guided, scene.laws), scene.laws, ())
    laws, _, solved = solved_motion(scene, body)
    driven = laws.joints
    energy = ca.substitute(
        ca.SX(body.kinetic), column(body.velocities.symbols), column(body.velocities.graphs)
    )
    for drive in scene.guided.drives.values():
        rate = body.motion_along(drive.joint, drive.axis)[1]
        about = dot(
            body.along[drive.axis.coordinate], body.frames[drive.joint.parent.body.name].rate
        )
        energy += (drive.reflected * rate / 2 + drive.spin * about) * rate
    energy = solved.found.put_into(ca.substitute(energy, body.mobility_rates, 0))
    rates = [
        solved.found.put_into(body.motion_along(*mechanism.coordinates[name])[1]) for name in drives
    ]
    matrix = ca.hessian(energy, solved.inputs["d_rate"])[0]
    by_rate = ca.jacobian(column(rates), solved.inputs["d_rate"])
    out = ca.vertcat(ca.vec(matrix.T), ca.vec(by_rate.T))
    instant = graph("instant", solved.inputs, out=out)
    columns: list[Column] = [
        Output("output", f"{a}:{b}") for a in (*driven, *drives) for b in driven
    ]
    data, want = ModelData.of(scene, laws), Wanted.of(mechanism, ["motion"])
    return ReflectedInertia(
        Program(data, want, instant, solved.newton, tuple(columns), {}), driven, drives
    )
