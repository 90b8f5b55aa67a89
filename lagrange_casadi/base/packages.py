"""Packages that are optional: most are an extra of this one."""

from __future__ import annotations

import importlib.util

from ..errors import LagrangeCasadiError


def check_installed(package: str, what: str, extra: str = "") -> None:
    """Raise :class:`LagrangeCasadiError` where a package is missing, which ``what`` needs; its
    module is called as it is, in small letters. Without an ``extra`` it is installed by itself.
    """
    if importlib.util.find_spec(package.lower()) is None:
        wanted = f"'lagrange_casadi[{extra}]'" if extra else package
        raise LagrangeCasadiError(f"{what} needs {package}; install it with: pip install {wanted}")
