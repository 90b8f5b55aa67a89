"""Where gaps that are affine in unknowns are zero, at each instant by least squares."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..base.arrays import Array


def affine_zero(gaps: Callable[[Array], Array], count: int, instants: int, decided: Callable[[Array], Array]) -> Array | None:
    """The ``count`` unknowns (unknowns, t) at which ``gaps`` of them, (gaps, t), are zero; None where they are not decided.

    The slopes of gaps are differences. ``decided`` tells of their triangles (t, unknowns, unknowns) whether they decide, (t,).
    """
    rest = gaps(np.zeros((count, instants)))
    if len(rest) < count:
        return None
    ones = (np.broadcast_to(row[:, None], (count, instants)) for row in np.eye(count))
    slopes = np.stack([gaps(one) - rest for one in ones], axis=1)
    q, r = np.linalg.qr(np.moveaxis(slopes, -1, 0))
    if not decided(r).all():
        return None
    return np.asarray(np.linalg.solve(r, np.swapaxes(q, 1, 2) @ -rest.T[..., None])[..., 0].T)


def rates_and_changes(
    gaps: Callable[[Array | None, Array], Array], count: int, instants: int, decided: Callable[[Array], Array]
) -> tuple[Array, Array] | None:
    """Rates at which ``gaps(None, rates)`` are zero, and then accelerations at which ``gaps(rates, accelerations)`` are."""
    rates = affine_zero(lambda x: gaps(None, x), count, instants, decided)
    changes = None if rates is None else affine_zero(lambda x: gaps(rates, x), count, instants, decided)
    return None if rates is None or changes is None else (rates, changes)
