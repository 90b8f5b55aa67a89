"""Strength of links: stresses, factors of safety against yielding, buckling
and fatigue, and lives.
"""
