"""Forces inside a mechanism that must make a given motion: efforts, reactions, and the section forces of every link."""

from . import interrupts, standard_streams  # noqa: F401 - before all that takes long, or opens a file

# isort: split
from . import density, figures, motion
from .case import Case, load_case
from .curves import table
from .derive import derive
from .errors import LagrangeCasadiError
from .evaluate import evaluate
from .export import export
from .lagrange import LagrangeSystem
from .mechanism import Mechanism
from .peaks import refine
from .scene import Scene
from .solution import Peak, Solution
from .store import check, load, save
from .sweep import Sweep, best, read_designs, sweep
from .version import __version__

__all__ = [
    "Case",
    "LagrangeCasadiError",
    "LagrangeSystem",
    "Mechanism",
    "Peak",
    "Scene",
    "Solution",
    "Sweep",
    "__version__",
    "best",
    "check",
    "density",
    "derive",
    "evaluate",
    "export",
    "figures",
    "load",
    "load_case",
    "motion",
    "read_designs",
    "refine",
    "save",
    "sweep",
    "table",
]
