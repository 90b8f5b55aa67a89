"""Maxima between instants: bounds of curves, sharp points, and the search."""
