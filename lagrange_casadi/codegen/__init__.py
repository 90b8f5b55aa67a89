"""Translation of a scene's graphs to C, and of C to a loaded library."""

from .batch import BatchLibrary, load_batch
from .compiler import Compiler, Language, find_compiler
from .designs import emit_designs
from .emit import emit
from .library import DesignsLibrary, Library, load, load_designs
from .points import PointsLibrary, load_points
from .search import Search, load_search

__all__ = [
    "BatchLibrary",
    "Compiler",
    "DesignsLibrary",
    "Language",
    "Library",
    "PointsLibrary",
    "Search",
    "emit",
    "emit_designs",
    "find_compiler",
    "load",
    "load_batch",
    "load_designs",
    "load_points",
    "load_search",
]
