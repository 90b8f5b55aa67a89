"""How outputs change with parameters: exact derivatives of series, section
forces, peaks and means.
"""
