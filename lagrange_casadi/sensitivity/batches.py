"""A function of one output at many points: by compiled code, or by CasADi's virtual machine."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from .. import codegen
from ..base.arrays import Array


def at_points(
    function: Any,
    library: codegen.BatchLibrary | None,
    n: int,
    given: Mapping[str, tuple[Array, int]],
) -> Array:
    """A function of one output at n points, (n, result): of each argument its rows, and how many
    points one is for, 0 for all.
    """
    into = np.full((n, function.numel_out(0)), np.nan)
    if library is not None:
        library.evaluate(n, given, into)
        return into
    columns = []
    for name, (rows, every) in given.items():
        height, width = function.size_in(name)
        each = np.repeat(rows, every, axis=0)[:n] if every else rows
        columns.append(each.reshape(-1, height).T if width * height else np.zeros((height, width)))
    into[:] = np.asarray(function(*columns).full()).T.reshape(n, -1)
    return into
