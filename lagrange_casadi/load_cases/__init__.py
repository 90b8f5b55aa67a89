"""Load cases of links, in equilibrium with their inertia, for programs of finite elements."""

from .equilibrium import Load, LoadCase, link_load_cases
from .files import write_load_cases

__all__ = ["Load", "LoadCase", "link_load_cases", "write_load_cases"]
