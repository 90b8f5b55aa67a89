"""Densities of links: the public part of :mod:`.declare.density`."""

from .declare.density import Density, Slices, along, polynomial, tabulated, thick, uniform

__all__ = ["Density", "Slices", "along", "polynomial", "tabulated", "thick", "uniform"]
