"""Efforts of an open chain of uniform links by Pinocchio: its compiled recursion, and its recursion traced by CasADi."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pinocchio as pin

from .case import Array, Work

LENGTH, MASS, GRAVITY = 0.5, 1.0, 9.81
MISSING = "this Pinocchio has no pinocchio.casadi, as the wheels of PyPI have none: build it with BUILD_WITH_CASADI_SUPPORT"


def efforts(n: int, t: Array, threads: int = 1) -> Work:
    """What works out the joints' efforts, (n, t), by ``rneaInParallel`` over the instants; the array is the same at every call."""
    q, v, a = (np.asfortranarray(x) for x in motion(n, t))  # an instant a column
    pool, effort = pin.ModelPool(_model(n), threads), np.empty((n, len(t)), order="F")

    def work() -> Array:
        pin.rneaInParallel(threads, pool, q, v, a, effort)
        return effort

    return work


def casadi_instructions(n: int) -> int:
    """The recursion's, as a function of CasADi with ``cse``. Raises :class:`ImportError` without ``pinocchio.casadi``."""
    return int(_function(n).n_instructions())


def casadi_efforts(n: int, t: Array) -> Work:
    """What works out the efforts by the same function in CasADi's virtual machine, called once with an instant a column."""
    function, inputs = _function(n), [ca.DM(x) for x in motion(n, t)]
    return lambda: np.asarray(function(*inputs).full(), dtype=np.float64)


def motion(n: int, t: Array) -> tuple[Array, Array, Array]:
    """The angles of the joints, each relative to the link before, their rates and accelerations: (n, t) each."""
    q = 0.1 * np.arange(n)[:, None] + t + 0.2 * t**2
    return q, np.broadcast_to(1.0 + 0.4 * t, q.shape).copy(), np.full_like(q, 0.4)


def _function(n: int) -> ca.Function:
    try:
        import pinocchio.casadi as cpin
    except ImportError as error:
        raise ImportError(MISSING) from error
    model = cpin.Model(_model(n))
    q, v, a = (ca.SX.sym(name, n) for name in "qva")
    return ca.Function("rnea", [q, v, a], [cpin.rnea(model, model.createData(), q, v, a)], {"cse": True})


def _model(n: int) -> pin.Model:
    model = pin.Model()
    model.gravity.linear = np.array([0.0, -GRAVITY, 0.0])
    bar = pin.Inertia(MASS, np.array([LENGTH / 2, 0.0, 0.0]), np.diag([0.0, 1.0, 1.0]) * MASS * LENGTH**2 / 12)
    for i in range(n):
        place = pin.SE3(np.eye(3), np.array([LENGTH if i else 0.0, 0.0, 0.0]))
        model.appendBodyToJoint(model.addJoint(i, pin.JointModelRZ(), place, f"joint{i}"), bar, pin.SE3.Identity())
    return model
