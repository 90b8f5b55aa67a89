"""Efforts of an open chain of uniform links by Pinocchio's recursion as a graph of CasADi, which
PyPI's wheels leave out.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from .paper_case import Array, Work
from .pinocchio_chain import model, motion

MISSING = (
    "this Pinocchio has no pinocchio.casadi, as the wheels of PyPI have none: build it with"
    " BUILD_WITH_CASADI_SUPPORT"
)


def efforts(n: int, t: Array) -> Work:
    """What works out the joints' efforts, (n, t), in CasADi's virtual machine, called once with an
    instant a column.
    """
    try:
        import pinocchio.casadi as cpin
    except ImportError:
        raise RuntimeError(MISSING) from None
    chain = cpin.Model(model(n))
    inputs = [ca.SX.sym(name, n) for name in "qva"]
    function = ca.Function(
        "rnea", inputs, [cpin.rnea(chain, chain.createData(), *inputs)], {"cse": True}
    )
    values = [ca.DM(x) for x in motion(n, t)]
    return lambda: np.asarray(function(*values).full(), dtype=np.float64)
