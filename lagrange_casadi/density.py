"""Densities of links: the public part of :mod:`.declare.density`."""

from .declare.density import Density, polynomial, tabulated, uniform

__all__ = ["Density", "polynomial", "tabulated", "uniform"]
