"""Densities of links: the public part of :mod:`.declare.density`."""

from .declare.density import Density, along, polynomial, tabulated, uniform

__all__ = ["Density", "along", "polynomial", "tabulated", "uniform"]
