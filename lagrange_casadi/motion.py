"""Laws of motion, for scenes: the public part of :mod:`.model.motion_laws`, :mod:`.model.moves`,
:mod:`.model.recordings`.
"""

from .model.motion_laws import Motion, expression, harmonic, polynomial, samples
from .model.moves import Dwell, Move, dwell, move, moves
from .model.recordings import read_motion, read_samples
from .model.rest_laws import s_curve, trapezoid

__all__ = [
    "Dwell",
    "Motion",
    "Move",
    "dwell",
    "expression",
    "harmonic",
    "move",
    "moves",
    "polynomial",
    "read_motion",
    "read_samples",
    "s_curve",
    "samples",
    "trapezoid",
]
