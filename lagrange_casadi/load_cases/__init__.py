"""Load cases of links, in equilibrium with their inertia, for programs of finite elements, and load
spectra.
"""

from .equilibrium import link_load_cases
from .files import write_load_cases
from .loads import Load, LoadCase
from .spectra import BearingLoads, bearing_loads, write_bearing_loads, write_spectrum

__all__ = [
    "BearingLoads",
    "Load",
    "LoadCase",
    "bearing_loads",
    "link_load_cases",
    "write_bearing_loads",
    "write_load_cases",
    "write_spectrum",
]
