"""Laws of motion, for scenes: the public part of :mod:`.declare.motion`, :mod:`.declare.moves`,
:mod:`.declare.recordings`.
"""

from .declare.motion import Motion, expression, harmonic, polynomial, samples
from .declare.moves import Dwell, Move, dwell, move, moves
from .declare.recordings import read_motion, read_samples
from .declare.rest_laws import s_curve, trapezoid

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
