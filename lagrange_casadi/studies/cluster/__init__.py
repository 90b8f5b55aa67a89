"""Dask's workers, for sweeps and for searches."""
