"""Densities of links: the public part of :mod:`.model.density`."""

from .model.density import Density, Slices, along, polynomial, tabulated, thick, uniform

__all__ = ["Density", "Slices", "along", "polynomial", "tabulated", "thick", "uniform"]
