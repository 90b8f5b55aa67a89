"""Points spread evenly over the unit cube: the sequence of Sobol, by the direction numbers of Joe
and Kuo.

S. Joe and F. Y. Kuo, Constructing Sobol sequences with better two-dimensional projections, SIAM
Journal on Scientific Computing 30 (2008) 2635-2654; the numbers are the first of their file
new-joe-kuo-6.
"""

from __future__ import annotations

import numpy as np

from ...base.arrays import Array
from ...errors import DeclarationError

_BITS = 32

_DIRECTIONS = (
    (0, (1,)),
    (1, (1, 3)),
    (1, (1, 3, 1)),
    (2, (1, 1, 1)),
    (1, (1, 1, 3, 3)),
    (4, (1, 3, 5, 13)),
    (2, (1, 1, 5, 5, 17)),
    (4, (1, 1, 5, 5, 5)),
    (7, (1, 1, 7, 11, 19)),
    (11, (1, 1, 5, 1, 1)),
    (13, (1, 1, 1, 3, 11)),
    (14, (1, 3, 5, 5, 31)),
    (1, (1, 3, 3, 9, 7, 49)),
    (13, (1, 1, 1, 15, 21, 21)),
    (16, (1, 3, 1, 13, 27, 49)),
    (19, (1, 1, 1, 15, 7, 5)),
    (22, (1, 3, 1, 15, 13, 25)),
    (25, (1, 1, 5, 5, 19, 61)),
    (1, (1, 3, 7, 11, 23, 15, 103)),
    (4, (1, 3, 7, 13, 13, 15, 69)),
    (7, (1, 1, 3, 13, 7, 35, 63)),
    (8, (1, 3, 5, 9, 1, 25, 53)),
    (14, (1, 3, 1, 13, 9, 35, 107)),
    (19, (1, 3, 1, 5, 27, 61, 31)),
    (21, (1, 1, 5, 11, 19, 41, 61)),
    (28, (1, 3, 5, 3, 3, 13, 69)),
    (31, (1, 1, 7, 13, 1, 19, 1)),
    (32, (1, 3, 7, 5, 13, 19, 59)),
    (37, (1, 1, 3, 9, 25, 29, 41)),
    (41, (1, 3, 5, 13, 23, 1, 55)),
    (42, (1, 3, 7, 3, 13, 59, 17)),
)
"""Inner coefficients of the primitive polynomial of each dimension but the first, as bits, and its
first direction numbers.
"""

MOST_DIMENSIONS = len(_DIRECTIONS) + 1


def sobol(count: int, dimensions: int) -> Array:
    """The first points of the sequence after the origin, (count, dimensions), each of them between
    0 and 1.

    Raises :class:`.DeclarationError` for more dimensions than there are direction numbers for.
    """
    if dimensions > MOST_DIMENSIONS:
        raise DeclarationError(
            f"over: starts are spread over {MOST_DIMENSIONS} parameters at most, got {dimensions};"
            " name the designs to start from"
        )
    directions = np.array([_binary(k) for k in range(dimensions)], np.uint64)
    numbers = np.arange(1, count + 1, dtype=np.uint64)
    gray = numbers ^ (numbers >> np.uint64(1))
    found = np.zeros((count, dimensions), np.uint64)
    for k in range(count.bit_length()):
        found ^= ((gray >> np.uint64(k)) & np.uint64(1))[:, None] * directions[:, k]
    return np.asarray(found / 2.0**_BITS)


def _binary(dimension: int) -> list[int]:
    """The direction numbers of a dimension, counted from 0, as fractions of 2^32."""
    if dimension == 0:
        return [1 << (_BITS - 1 - k) for k in range(_BITS)]
    inner, first = _DIRECTIONS[dimension - 1]
    degree = len(first)
    found = [m << (_BITS - 1 - k) for k, m in enumerate(first)]
    for k in range(degree, _BITS):
        new = found[k - degree] ^ (found[k - degree] >> degree)
        for j in range(1, degree):
            if inner >> (degree - 1 - j) & 1:
                new ^= found[k - j]
        found.append(new)
    return found
