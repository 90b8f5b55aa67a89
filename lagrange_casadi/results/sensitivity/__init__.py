"""Derivatives of outputs by parameters: exact derivatives of series, section forces, peaks and
means.
"""
