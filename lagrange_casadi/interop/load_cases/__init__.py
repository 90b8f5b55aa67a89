"""Load cases of links, in equilibrium with their inertia, for programs of finite elements, and load
spectra.
"""

from .equilibrium import link_load_cases
from .files import write_load_cases
from .loads import Load, LoadCase
from .spectra import write_spectrum

__all__ = [
    "Load",
    "LoadCase",
    "link_load_cases",
    "write_load_cases",
    "write_spectrum",
]
