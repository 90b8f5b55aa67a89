"""Forces inside a mechanism that must make a given motion: efforts, reactions, and the section forces of every link."""

from .base import interrupts, standard_streams  # noqa: F401 - before all that takes long, or opens a file

# isort: split
from . import beams, bearings, density, figures, motion, strength
from .base.symbolic import symbolic
from .case import Case, load_case
from .declare.curves import Curve, curve, table
from .declare.mechanism import Mechanism
from .declare.scene import Scene
from .declare.shaking import shaking
from .declare.spatial import SpatialMechanism
from .elastic.vibration import vibration
from .equations.derive import derive
from .equations.lagrange import LagrangeSystem
from .errors import LagrangeCasadiError
from .exports import export
from .instants.holding import holding
from .instants.solution import Peak, Solution
from .store.runs import check, load, save
from .studies.designs.prepared import Prepared, prepare
from .studies.evaluate import evaluate
from .studies.optimise import Front, Optimum, optimise
from .studies.peaks import refine
from .studies.sensitivities import Sensitivities, sensitivities
from .studies.sweep import Sweep, best, read_designs, sweep
from .studies.tolerances import tolerances
from .studies.tool import tool_deflection
from .version import __version__

__all__ = [
    "Case",
    "Curve",
    "Front",
    "LagrangeCasadiError",
    "LagrangeSystem",
    "Mechanism",
    "Optimum",
    "Peak",
    "Prepared",
    "Scene",
    "Sensitivities",
    "Solution",
    "SpatialMechanism",
    "Sweep",
    "__version__",
    "beams",
    "bearings",
    "best",
    "check",
    "curve",
    "density",
    "derive",
    "evaluate",
    "export",
    "figures",
    "holding",
    "load",
    "load_case",
    "motion",
    "optimise",
    "prepare",
    "read_designs",
    "refine",
    "save",
    "sensitivities",
    "shaking",
    "strength",
    "sweep",
    "symbolic",
    "table",
    "tolerances",
    "tool_deflection",
    "vibration",
]
