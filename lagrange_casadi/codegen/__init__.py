"""From a scene's graphs to C, and from C to a loaded library."""

from .compiler import Compiler, find_compiler
from .emit import emit
from .library import Library, load

__all__ = ["Compiler", "Library", "emit", "find_compiler", "load"]
