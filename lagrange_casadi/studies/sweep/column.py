"""One dataset of a sweep."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

MISSING = "NaN for designs for which it is indeterminate, by equilibrium or by friction at rest"
"""Attribute ``missing`` of a column that may lack a number for a design with a result."""


@dataclass(frozen=True)
class Column:
    """One dataset: its full name, the axes beyond those of the designs, their lengths, unit, type,
    and what a file says of it.
    """

    name: str
    unit: str
    attributes: Mapping[str, str]
    axes: tuple[str, ...] = ()
    lengths: tuple[int, ...] = ()
    dtype: str = "<f8"

    @property
    def place(self) -> str:
        """The dataset's path in the file."""
        return self.name.replace(":", "/")

    @property
    def width(self) -> int:
        """Bytes a design."""
        return np.dtype(self.dtype).itemsize * math.prod(self.lengths)
