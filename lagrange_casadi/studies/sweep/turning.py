"""Whether the drives of a sweep's designs make whole turns, and the same in all."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...declare.description import kinds_of_described
from ...declare.scene import Scene
from ...declare.times import Timing
from ...declare.turned import note
from ...equations.described import template
from .axes import designs_of

_LOOKED_AT = 1024
"""Designs, evenly spread over all of them."""


def turning_note(scene: Scene, timing: Timing, grid: Any, fixed: Mapping[str, float]) -> str:
    """A line where the drive turns, and makes less than a turn, or not the same in every design of a ``grid``."""
    designs, values = designs_of(grid), scene.values(fixed)
    numbers = np.unique(np.linspace(0, designs.size - 1, min(designs.size, _LOOKED_AT)).astype(np.int64))
    p = np.tile(np.array(list(values.values())), (numbers.size, 1))
    columns = [list(values).index(name) for name in designs.names]
    for row, number in zip(p, numbers.tolist(), strict=True):
        row[columns] = designs.block(number, number + 1)[0]
    return note(scene.prescribed, kinds_of_described(template(scene).content), timing, p)
