"""Numbers of any kind: one interpreter of graphs for all of them, and pairs of doubles that carry
their own rounding.
"""
