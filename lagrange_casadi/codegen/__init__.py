"""Translation of a scene's graphs to C, and of C to a loaded library."""

from .batch import CHOSEN, BatchLibrary, load_batch
from .compiler import Compiler, Language, find_compiler
from .designs import emit_designs
from .emit import emit
from .library import DesignsLibrary, Library, load, load_designs
from .search import Search, load_search

__all__ = [
    "CHOSEN",
    "BatchLibrary",
    "Compiler",
    "DesignsLibrary",
    "Language",
    "Library",
    "Search",
    "emit",
    "emit_designs",
    "find_compiler",
    "load",
    "load_batch",
    "load_designs",
    "load_search",
]
