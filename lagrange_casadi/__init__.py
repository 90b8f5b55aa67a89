"""Forces inside a mechanism that must make a given motion: efforts, reactions, and the section
forces of every link.

A public name is imported when it is first asked for: ``__init__.pyi`` lists them, and where each is
defined.
"""

# Before all that takes long, or opens a file.
from .base import interrupts, standard_streams  # noqa: F401

# isort: split
import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
