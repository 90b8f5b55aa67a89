"""IPOPT, a solver of nonlinear programs that comes with CasADi."""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca

from ..errors import DeclarationError
from .arrays import Expression


def ipopt(name: str, program: Mapping[str, Expression], **options: object) -> ca.Function:
    """Return the solver of a program, with options of IPOPT. It prints nothing, and only its
    statistics say if it failed.

    Raises :class:`.DeclarationError` if CasADi has no IPOPT.
    """
    if not ca.has_nlpsol("ipopt"):
        raise DeclarationError(
            f"{name}: the CasADi at hand has no IPOPT; install CasADi from PyPI, whose wheel"
            " contains it"
        )
    quiet: dict[str, object] = dict.fromkeys(
        ("print_time", "error_on_fail", "show_eval_warnings"), False
    )
    quiet["ipopt"] = {"print_level": 0, "sb": "yes", **options}
    return ca.nlpsol(name, "ipopt", program, quiet)
