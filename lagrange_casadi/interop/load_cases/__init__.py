"""Load cases of links, in equilibrium with their inertia, for programs of finite elements, and load
spectra.
"""

from .equilibrium import link_load_cases
from .load_case import Load, LoadCase
from .load_case_files import write_load_cases
from .spectra import write_spectrum

__all__ = [
    "Load",
    "LoadCase",
    "link_load_cases",
    "write_load_cases",
    "write_spectrum",
]
