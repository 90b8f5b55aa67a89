"""Rounding error of an operation, to the last bit, from operands and result: arrays of doubles or
singles.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from ...base.arrays import Array

_SPLITTER = 134217729.0
_LEAST = 1e-280


def rounding_error(code: int, result: Array, *operands: Array) -> Array:
    """Rounding error of an operation, one of CasADi's ``OP_`` codes: exact value less result; zero
    if it is exact, NaN if unknown.

    Of a sum by Knuth's error-free sum; of the others by the product that they undo, without error
    (Dekker, *A floating-point technique for extending the available precision*, Numer. Math. 18,
    1971).
    """
    if code in (ca.OP_ADD, ca.OP_SUB):
        a, b = operands[0], operands[1] if code == ca.OP_ADD else -operands[1]
        most = result - a
        return (a - (result - most)) + (b - most)
    if code == ca.OP_MUL:
        return _product(operands[0], operands[1], result)
    if code == ca.OP_SQ:
        return _product(operands[0], operands[0], result)
    if code == ca.OP_DIV:
        return np.asarray(-_product(result, operands[1], operands[0]) / operands[1])
    if code == ca.OP_INV:
        return np.asarray(-_product(result, operands[0], np.ones_like(result)) / operands[0])
    if code == ca.OP_SQRT:
        return np.asarray(
            -_product(result, result, operands[0]) / np.where(result == 0.0, 1.0, 2.0 * result)
        )
    # The sine of nothing, and its cosine.
    exact = np.all([operand == 0.0 for operand in operands], axis=0) & (
        (result == 0.0) | (result == 1.0)
    )
    return np.where(exact, 0.0, np.nan)


def _product(a: Array, b: Array, c: Array) -> Array:
    """Return a b - c, where that is but the rounding of a product or quotient; NaN where it
    underflows.
    """
    if a.dtype == np.float32:
        return np.asarray(a.astype(float) * b - c)
    (a_high, a_low), (b_high, b_low) = _halves(a), _halves(b)
    rest = ((a_high * b_high - c) + a_high * b_low + a_low * b_high) + a_low * b_low
    return np.where((np.abs(c) > _LEAST) | (a == 0.0) | (b == 0.0), rest, np.nan)


def _halves(x: Array) -> tuple[Array, Array]:
    shifted = _SPLITTER * x
    high = shifted - (shifted - x)
    return high, x - high
