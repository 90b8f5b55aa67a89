"""Packages that are optional: each is an extra of this one."""

from __future__ import annotations

import importlib.util

from ..errors import LagrangeCasadiError


def check_installed(package: str, what: str, extra: str) -> None:
    """Raise :class:`LagrangeCasadiError` where a package is missing, which ``what`` needs; its
    module is called as it is, in small letters.
    """
    if importlib.util.find_spec(package.lower()) is None:
        raise LagrangeCasadiError(
            f"{what} needs {package}; install it with: pip install 'lagrange_casadi[{extra}]'"
        )
