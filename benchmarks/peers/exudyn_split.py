"""Section forces by Exudyn: a kinematic tree for each ratio, the rod's halves welded by three
joints that are held at zero.
"""

from __future__ import annotations

import sys

import numpy as np

from .paper_case import Array, SliderCrank, Work
from .split_rod import close_loop, joint_motion

sys.exudynFast = True  # type: ignore[attr-defined]  # its module without range checks, if this is the first import
import exudyn as exu  # noqa: E402
from exudyn.itemInterface import NodeGenericODE2, ObjectKinematicTree  # noqa: E402

JOINTS = (
    *[exu.JointType.RevoluteZ] * 2,
    exu.JointType.PrismaticX,
    exu.JointType.PrismaticY,
    exu.JointType.RevoluteZ,
)
SIZE = len(JOINTS)


def sections(case: SliderCrank, t: Array, xi: Array) -> Work:
    """What works out axial, shear and bending of the rod, (3, t, xi), by a loop over the instants.

    Exudyn has no inverse dynamics, but M a - f, the residual of its implicit solver's equations of
    motion at a given state and acceleration, is the efforts, times the Newmark factor beta h^2 of a
    step h. The trees of all ratios are one system of a sparse mass matrix; one tree with a cut at
    every ratio is slower, as its mass matrix is full. 0 < xi < 1, strictly.
    """
    q, v, a = joint_motion(case, t)
    container = exu.SystemContainer()
    system = container.AddSystem()
    for ratio in xi:
        _add_tree(system, case, float(ratio))
    system.Assemble()
    settings = exu.SimulationSettings()
    settings.solution.file.write = False
    settings.timeIntegration.generalizedAlpha.computeInitialAccelerations = (
        False  # they would be those of the free fall
    )
    settings.linearSolver.solverType = exu.LinearSolverType.EigenSparse
    solver = exu.MainSolverImplicitSecondOrder()
    solver.InitializeSolver(system, settings)
    solver.it.currentStepSize = 1.0
    states = [np.pad(x, ((0, 0), (0, SIZE - 2))) for x in (q, v, a)]
    states = [np.tile(x, (1, len(xi))) for x in states]

    def work() -> Array:
        now = container.GetSystem(
            0
        ).systemData  # of the container, which has to outlive its systems
        effort = np.empty((len(t), SIZE * len(xi)))
        for i, (q_i, v_i, a_i) in enumerate(zip(*states, strict=True)):
            now.SetODE2Coordinates(q_i)
            now.SetODE2Coordinates_t(v_i)
            now.SetODE2Coordinates_tt(a_i)
            solver.ComputeMassMatrix(system)
            solver.ComputeNewtonResidual(system, settings)
            effort[i] = solver.GetSystemResidual()
        by_tree = effort.reshape(len(t), len(xi), SIZE) / solver.newmarkBeta
        return close_loop(case, q, xi, by_tree[:, 0, 1], by_tree[..., 2:].transpose(2, 0, 1))

    return work


def _add_tree(system: exu.MainSystem, case: SliderCrank, ratio: float) -> None:
    near, far = case.l * ratio, case.l * (1.0 - ratio)
    inner, outer = case.m2 * ratio, case.m2 * (1.0 - ratio)
    centre = far * (outer / 2 + case.m3) / (outer + case.m3)  # of the outer half and the slider
    about_centre = outer * (far**2 / 12 + (far / 2 - centre) ** 2) + case.m3 * (far - centre) ** 2
    moments = (case.m1 * case.r**2 / 12, inner * near**2 / 12, 0.0, 0.0, about_centre)
    zeros = [0.0] * SIZE
    node = NodeGenericODE2(
        numberOfODE2Coordinates=SIZE,
        referenceCoordinates=zeros,
        initialCoordinates=zeros,
        initialCoordinates_t=zeros,
    )
    tree = ObjectKinematicTree(
        nodeNumber=system.AddNode(node),
        gravity=[0.0, -case.g, 0.0],
        jointTypes=list(JOINTS),
        linkParents=list(range(-1, SIZE - 1)),
        jointTransformations=exu.Matrix3DList([np.eye(3)] * SIZE),
        jointOffsets=exu.Vector3DList([[x, 0.0, 0.0] for x in (0.0, case.r, near, 0.0, 0.0)]),
        linkInertiasCOM=exu.Matrix3DList([np.diag([0.0, 0.0, moment]) for moment in moments]),
        linkCOMs=exu.Vector3DList(
            [[x, 0.0, 0.0] for x in (case.r / 2, near / 2, 0.0, 0.0, centre)]
        ),
        linkMasses=[case.m1, inner, 0.0, 0.0, outer + case.m3],
    )
    system.AddObject(tree)
