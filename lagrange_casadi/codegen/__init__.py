"""From a scene's graphs to C, and from C to a loaded library."""

from .compiler import Compiler, Language, find_compiler
from .emit import emit
from .library import Library, cores, load

__all__ = ["Compiler", "Language", "Library", "cores", "emit", "find_compiler", "load"]
