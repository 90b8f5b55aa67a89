"""Types of values: arrays, expressions, what may be either, and what JSON holds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
"""Numbers in double precision."""

Expression: TypeAlias = Any
"""An expression of CasADi, or a number in its place. CasADi's own types have no such union: its
functions take one or the other.
"""

Operand: TypeAlias = Any
"""A number, an array or an expression, for formulas that are written once for all of them."""

Json: TypeAlias = str | float | Sequence["Json"] | Mapping[str, "Json"] | None
"""A value that JSON holds."""


def spread(size: int, most: int) -> npt.NDArray[np.intp]:
    """The numbers of so many things, or of at most so many of them that are evenly spread, the
    first and the last among them.
    """
    return np.linspace(0, size - 1, min(size, most)).astype(np.intp)
