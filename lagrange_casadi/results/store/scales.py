"""Dimension scales: which axis of a dataset runs along which, stated as HDF5's own library does,
but each list written once.

``H5DSattach_scale`` writes the list of all that a scale belongs to anew with each that joins: a
file grows with the square of its datasets, and from some 4000 on the list does not fit into where
that library puts it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import h5py
import numpy as np

_LIST = h5py.vlen_dtype(h5py.ref_dtype)
_BELONGING = np.dtype([("dataset", h5py.ref_dtype), ("dimension", np.uint32)])

LARGE = {"track_order": True}
"""Options with which a dataset is created that becomes a scale: its attributes may be large."""


class Scales:
    """The scales of a file, each a dataset of its root by name."""

    def __init__(self, file: h5py.File) -> None:
        self._file = file
        self._references: dict[str, Any] = {}
        self._belonging: dict[str, list[tuple[Any, int]]] = {}

    def attach(self, dataset: h5py.Dataset, names: Sequence[str]) -> None:
        """Say which scale each axis of a dataset has."""
        scales = np.empty(len(names), object)
        for axis, name in enumerate(names):
            if name not in self._references:
                self._references[name] = np.array([self._file[name].ref], h5py.ref_dtype)
                self._belonging[name] = []
            scales[axis] = self._references[name]
            self._belonging[name].append((dataset.ref, axis))
        dataset.attrs.create("DIMENSION_LIST", scales, dtype=_LIST)

    def finish(self) -> None:
        """Say of each scale what it belongs to."""
        for name, places in self._belonging.items():
            self._file[name].attrs.create("REFERENCE_LIST", np.array(places, _BELONGING))
