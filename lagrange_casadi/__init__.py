"""Forces inside a mechanism that must make a given motion: efforts, reactions, and the section
forces of every link.
"""

# Before all that takes long, or opens a file.
from .base import interrupts, standard_streams  # noqa: F401

# isort: split
from typing import Any

import lazy_loader

from .base.methods import missing

_named, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> Any:
    """A public name, imported when it is first asked for: ``__init__.pyi`` lists them, and where
    each is defined.
    """
    try:
        return _named(name)
    except ModuleNotFoundError as error:
        raise missing(error, f"lagrange_casadi.{name}") from None
