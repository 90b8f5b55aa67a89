"""Figures: what a case may want drawn, and the drawing of it."""
