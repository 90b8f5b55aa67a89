"""Equations of many unknowns in blocks that have none in common: each is solved on its own."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from ...base.arrays import Array
from .record import Model

MOST = 2_000_000
"""Factors of a block, at most: its rank is found in seconds."""

Rows = dict[str, Array]
"""Equations: their factors by the names of unknowns, a row for each equation and a column for each
number that an unknown has; all have as many.
"""


def check_size(model: Model, factors: int) -> None:
    """Raise :class:`.ModelFileError` for equations with more factors than :data:`MOST`."""
    if factors > MOST:
        raise model.refuse(
            "",
            f"its loops have so many joints in common that {factors} factors relate these;"
            f" expected at most {MOST}",
        )


def blocks(
    model: Model, equations: Sequence[Rows], order: Sequence[str]
) -> list[tuple[Array, list[str], list[int]]]:
    """Return blocks of equations: the matrix, the names of its unknowns in an order, and the
    numbers of the equations in it.

    Raises :class:`.ModelFileError` for a block that is too large.
    """
    number = {name: k for k, name in enumerate(order)}
    both = [(number[next(iter(rows))], number[name]) for rows in equations for name in rows]
    one, other = np.array(both, int).reshape(-1, 2).T
    joined = coo_array((np.ones(one.size), (one, other)), (len(order), len(order)))
    label = connected_components(joined, directed=False)[1].tolist()
    names, groups = dict[int, list[str]](), dict[int, list[int]]()
    for name in order:
        names.setdefault(label[number[name]], []).append(name)
    for k, rows in enumerate(equations):
        groups.setdefault(label[number[next(iter(rows))]], []).append(k)
    return [
        (_matrix(model, [equations[k] for k in group], names[at]), names[at], group)
        for at, group in groups.items()
    ]


def _matrix(model: Model, equations: Sequence[Rows], names: list[str]) -> Array:
    """Return the factors of equations, a group of columns for each unknown."""
    shapes = [next(iter(rows.values())).shape for rows in equations]
    check_size(model, sum(height * width for height, width in shapes) * len(names))
    parts = []
    for rows, shape in zip(equations, shapes, strict=True):
        nothing = np.zeros(shape)
        parts.append(np.hstack([rows.get(name, nothing) for name in names]))
    return np.vstack(parts)
