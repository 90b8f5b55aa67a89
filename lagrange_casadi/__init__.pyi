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
from .engine.derive import compile_scene, derive
from .engine.lagrange import LagrangeSystem
from .errors import LagrangeCasadiError
from .interop.exports import export
from .interop.formats import read, save_model
from .interop.load_cases import LoadCase, link_load_cases, write_load_cases, write_spectrum
from .model.curves import Curve, curve, table
from .model.mechanism import Mechanism
from .model.scene import Scene
from .model.shaking import shaking
from .model.spatial import SpatialMechanism
from .results.elastic.vibration import vibration
from .results.histories import Peak
from .results.holding import holding
from .results.solution import Solution
from .results.store.runs import check, load, save
from .results.strength.bearing_life import BearingLoads, bearing_loads
from .studies.case import Case, load_case
from .studies.designs.prepared import Prepared, prepare
from .studies.evaluate import evaluate
from .studies.forward.running import flywheel, free
from .studies.identification import (
    Identification,
    Measurements,
    excite,
    identify,
    read_measurements,
)
from .studies.optimise import Front, Optimum, optimise
from .studies.peaks_between import refine
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
