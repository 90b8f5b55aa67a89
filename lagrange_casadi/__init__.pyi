"""The public names, for type checkers and for :mod:`lazy_loader`, which imports each when it is
first asked for.
"""

from . import (
    actuators,
    animation,
    beams,
    bearings,
    density,
    elements,
    errors,
    figures,
    forward,
    motion,
    peaks,
    strength,
)
from .base.symbolic import symbolic
from .case import Case, load_case
from .declare.curves import Curve, curve, table
from .declare.mechanism import Mechanism
from .declare.scene import Scene
from .declare.shaking import shaking
from .declare.spatial import SpatialMechanism
from .elastic.vibration import vibration
from .equations.derive import compile_scene, derive
from .equations.lagrange import LagrangeSystem
from .errors import LagrangeCasadiError
from .exports import export
from .formats import read, save_model
from .forward.running import flywheel, free
from .identification import (
    Identification,
    Measurements,
    excite,
    identify,
    read_measurements,
)
from .instants.holding import holding
from .instants.solution import Peak, Solution
from .load_cases import LoadCase, link_load_cases, write_load_cases, write_spectrum
from .store.runs import check, load, save
from .strength.bearings import BearingLoads, bearing_loads
from .studies.designs.prepared import Prepared, prepare
from .studies.evaluate import evaluate
from .studies.optimise import Front, Optimum, optimise
from .studies.peaks import refine
from .studies.sensitivities import Sensitivities, sensitivities
from .studies.sizing import size
from .studies.sweep import Sweep, best, read_designs, sweep
from .studies.tolerances import tolerances
from .studies.tool import tool_deflection
from .version import __version__

__all__ = [
    "BearingLoads",
    "Case",
    "Curve",
    "Front",
    "Identification",
    "LagrangeCasadiError",
    "LagrangeSystem",
    "LoadCase",
    "Measurements",
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
    "actuators",
    "animation",
    "beams",
    "bearing_loads",
    "bearings",
    "best",
    "check",
    "compile_scene",
    "curve",
    "density",
    "derive",
    "elements",
    "errors",
    "evaluate",
    "excite",
    "export",
    "figures",
    "flywheel",
    "forward",
    "free",
    "holding",
    "identify",
    "link_load_cases",
    "load",
    "load_case",
    "motion",
    "optimise",
    "peaks",
    "prepare",
    "read",
    "read_designs",
    "read_measurements",
    "refine",
    "save",
    "save_model",
    "sensitivities",
    "shaking",
    "size",
    "strength",
    "sweep",
    "symbolic",
    "table",
    "tolerances",
    "tool_deflection",
    "vibration",
    "write_load_cases",
    "write_spectrum",
]
