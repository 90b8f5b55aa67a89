"""Verification of results, and the number of their valid digits."""
