"""Derivatives of functions: exact ones of one symbol, and differences of what is evaluated."""

import casadi as ca
import numpy as np


def derivatives(function, at, order=2):
    """The function's values and its derivatives up to an order: an array (order + 1, places)."""
    x = ca.SX.sym("x")
    rows = [ca.SX(function(x))]
    for _ in range(order):
        rows.append(ca.jacobian(rows[-1], x))
    program = ca.Function("rows", [x], [ca.densify(ca.vertcat(*rows))])
    return program(np.asarray(at)[None]).full()


def steps(values_at, x, share=1e-4):
    """The derivative of values at a number, by four of them about it."""
    step = share * (abs(x) or 1.0)
    four = {k: values_at(x + k * step).copy() for k in (-2, -1, 1, 2)}
    return (8 * (four[1] - four[-1]) - (four[2] - four[-2])) / (12 * step)
