"""Declarations: mechanisms, their parts and conditions on these, motions, scenes."""
