"""Links that give way: forces that equilibrium leaves open,
deflections, and natural frequencies.
"""
