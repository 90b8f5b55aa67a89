"""The iterated coordinates at places between instants, for derivatives there."""

from __future__ import annotations

import numpy as np

from .. import codegen
from ..base.arrays import Array
from ..equations.program import Program
from ..instants.backends import begun, follow


def iterated(
    graph: Program, following: codegen.Library | None, t: Array, p: Array, places: Array
) -> Array:
    """Iterated coordinates (n, z) at ``places`` (n,) between the rising instants ``t``, from which
    they are followed; by compiled code, if any.
    """
    if graph.newton is None:
        return np.zeros((places.size, 0))
    count = graph.instant.size1_in("z")
    times, back = np.unique(np.concatenate([t, places]), return_inverse=True)
    guess = np.array(begun(graph, float(times[0]), p), float)
    z = np.zeros((count, times.size))
    if following is not None:
        following.follow(times, p, guess, z, np.zeros(times.size, np.intc))
    else:
        z[:] = follow(graph, times, p, guess)[0]
    return np.ascontiguousarray(z[:, back[t.size :]].T)
