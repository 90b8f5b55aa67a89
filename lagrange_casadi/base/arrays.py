"""Types of numbers: arrays, expressions, and what may be either."""

from __future__ import annotations

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
