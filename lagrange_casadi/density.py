"""Densities of links: the public part of :mod:`.model.link_density`."""

from .model.link_density import Density, Slices, along, polynomial, tabulated, thick, uniform

__all__ = ["Density", "Slices", "along", "polynomial", "tabulated", "thick", "uniform"]
