"""Laws of motion, for scenes: the public part of :mod:`.declare.motion`."""

from .declare.motion import Motion, expression, harmonic, polynomial, samples

__all__ = ["Motion", "expression", "harmonic", "polynomial", "samples"]
