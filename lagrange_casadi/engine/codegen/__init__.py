"""Translation of a scene's graphs to C, and of C to a loaded library."""

from .batch import CHOSEN, BatchLibrary, load_batch
from .compiler import INSTALL, Compiler, Language, find_compiler, no_compiler
from .emit import emit
from .library import Designs, Library, load
from .peak_search import Search, load_search

__all__ = [
    "CHOSEN",
    "INSTALL",
    "BatchLibrary",
    "Compiler",
    "Designs",
    "Language",
    "Library",
    "Search",
    "emit",
    "find_compiler",
    "load",
    "load_batch",
    "load_search",
    "no_compiler",
]
