"""The one list of what a picture of a mechanism shows (``primitives.py``), and its symbols, views
and SVG; the parts that all figures share.
"""
