"""Parameters of a machine from measurements: regressors, base parameters, least squares."""

from .excitation import Excitation, excite
from .fit import Comparison
from .identification import BaseParameter, Identification, identify
from .measurements import Measurements, read_measurements

__all__ = [
    "BaseParameter",
    "Comparison",
    "Excitation",
    "Identification",
    "Measurements",
    "excite",
    "identify",
    "read_measurements",
]
