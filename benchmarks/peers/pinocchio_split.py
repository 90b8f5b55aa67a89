"""Section forces by Pinocchio: one chain of the crank and the rod's pieces, welded by planar joints
that are held at zero.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pinocchio as pin

from .paper_case import Array, SliderCrank, Work
from .split_rod import close_loop, joint_motion


def sections(case: SliderCrank, t: Array, xi: Array, threads: int = 1) -> Work:
    """What works out axial, shear and bending of the rod, (3, t, xi), by one ``rneaInParallel``
    over the instants.

    A welded joint's efforts are the section's forces. One model with a cut at every ratio costs a
    planar joint a point, a third of what a model for each ratio does; but Pinocchio takes seconds
    to set one up with a hundred cuts. ``xi`` ascends strictly within 0 < xi < 1: a piece has a
    mass. ``threads`` is Pinocchio's own number of them.
    """
    q, v, a = joint_motion(case, t)
    n, pool = len(xi), pin.ModelPool(_model(case, xi), threads)
    held = np.zeros((len(t), 3 * n))
    identity = np.tile([0.0, 0.0, 1.0, 0.0], (len(t), n))  # x, y, cos, sin of a planar joint
    configuration, rate, acceleration = (
        np.hstack(both).T for both in ((q, identity), (v, held), (a, held))
    )  # by columns
    effort = np.zeros((2 + 3 * n, len(t)), order="F")

    def work() -> Array:
        pin.rneaInParallel(threads, pool, configuration, rate, acceleration, effort)
        return close_loop(case, q, xi, effort[1], effort[2:].reshape(n, 3, -1).transpose(1, 2, 0))

    return work


def _model(case: SliderCrank, xi: Array) -> pin.Model:
    model = pin.Model()
    model.gravity.linear = np.array([0.0, -case.g, 0.0])
    joint = model.addJoint(0, pin.JointModelRZ(), _along(0.0), "O")
    model.appendBodyToJoint(joint, _bar(case.m1, case.r), _along(0.0))
    reach = case.r
    for k, (start, stop) in enumerate(pairwise([0.0, *xi, 1.0])):
        kind = pin.JointModelPlanar() if k else pin.JointModelRZ()
        joint = model.addJoint(joint, kind, _along(reach), f"section{k}" if k else "A")
        reach = case.l * (stop - start)
        model.appendBodyToJoint(joint, _bar(case.m2 * (stop - start), reach), _along(0.0))
    model.appendBodyToJoint(
        joint, pin.Inertia(case.m3, np.zeros(3), np.zeros((3, 3))), _along(reach)
    )
    return model


def _along(x: float) -> pin.SE3:
    return pin.SE3(np.eye(3), np.array([x, 0.0, 0.0]))


def _bar(mass: float, length: float) -> pin.Inertia:
    return pin.Inertia(
        mass, np.array([length / 2, 0.0, 0.0]), np.diag([0.0, 1.0, 1.0]) * mass * length**2 / 12
    )
