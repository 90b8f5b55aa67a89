"""Efforts of an open chain of uniform links by Pinocchio's compiled recursion."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from .paper_case import Array, Work

LENGTH, MASS, GRAVITY = 0.5, 1.0, 9.81


def efforts(n: int, t: Array, threads: int = 1) -> Work:
    """What works out the joints' efforts, (n, t), by ``rneaInParallel`` over the instants; the
    array is the same at every call.
    """
    q, v, a = (np.asfortranarray(x) for x in motion(n, t))  # an instant a column
    pool, effort = pin.ModelPool(model(n), threads), np.empty((n, len(t)), order="F")

    def work() -> Array:
        pin.rneaInParallel(threads, pool, q, v, a, effort)
        return effort

    return work


def motion(n: int, t: Array) -> tuple[Array, Array, Array]:
    """The angles of the joints, each relative to the link before, their rates and accelerations:
    (n, t) each.
    """
    q = 0.1 * np.arange(n)[:, None] + t + 0.2 * t**2
    return q, np.broadcast_to(1.0 + 0.4 * t, q.shape).copy(), np.full_like(q, 0.4)


def model(n: int) -> pin.Model:
    """The chain."""
    model = pin.Model()
    model.gravity.linear = np.array([0.0, -GRAVITY, 0.0])
    bar = pin.Inertia(
        MASS, np.array([LENGTH / 2, 0.0, 0.0]), np.diag([0.0, 1.0, 1.0]) * MASS * LENGTH**2 / 12
    )
    for i in range(n):
        place = pin.SE3(np.eye(3), np.array([LENGTH if i else 0.0, 0.0, 0.0]))
        model.appendBodyToJoint(
            model.addJoint(i, pin.JointModelRZ(), place, f"joint{i}"), bar, pin.SE3.Identity()
        )
    return model
