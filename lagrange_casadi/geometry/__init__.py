"""Frames, rotations, and what joints look like in them."""
