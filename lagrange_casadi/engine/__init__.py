"""Derivation of graphs from a declaration: kinematics of loops, Lagrange's terms, internal
forces.
"""
