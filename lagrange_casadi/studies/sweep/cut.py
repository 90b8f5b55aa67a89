"""The designs that a figure of a sweep shows: over the axes that it draws, no finer than the
picture, the others fixed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from .axes import DESIGN
from .reading import Sweep
from .sheet import value

PIXELS, DOTS, LINES = 800, 20_000, 6
"""No more places along an axis of a map, dots, or curves of a family are drawn."""


@dataclass(frozen=True, eq=False)
class Cut:
    """The designs that are drawn: of a grid over axes ``names``, each ascending and no finer than
    the picture, or of a list.
    """

    sweep: Sweep
    names: tuple[str, ...]
    orders: tuple[npt.NDArray[np.intp], ...]
    notes: tuple[str, ...]

    @classmethod
    def of(
        cls, sweep: Sweep, over: Sequence[str], at: Mapping[str, float], family: str = ""
    ) -> Cut:
        """Cut of a grid, on which parameters that are neither ``over`` nor the ``family`` have the
        values ``at``, or those in the middle.
        """
        names = (*over, family) if family else tuple(over)
        sweep = sweep.select(**at)
        fixed: dict[str, float] = {}
        thinned = []
        for name, length in zip(sweep.dimensions, sweep.shape, strict=True):
            if name in names:
                stride = 1 + (length - 1) // PIXELS
                sweep = sweep.thinned(name, stride)
                thinned += [f"1 in {stride} values of {name} drawn"] if stride > 1 else []
            else:
                sweep = sweep.at_number(name, (length - 1) // 2)
                fixed[name] = float(sweep[name][0])
        orders = [np.argsort(sweep[name], kind="stable") for name in names]
        if family:
            orders[-1] = orders[-1][
                np.linspace(0, orders[-1].size - 1, min(LINES, orders[-1].size)).round().astype(int)
            ]
        return cls(sweep, names, tuple(orders), (*stays(sweep, fixed), *thinned))

    @classmethod
    def listed(cls, sweep: Sweep, at: Mapping[str, float]) -> Cut:
        """Designs of a list that have the values ``at``."""
        sweep = sweep.select(**at)
        stride = 1 + sweep.size // DOTS
        thinned = (f"1 in {stride} designs drawn",) if stride > 1 else ()
        return cls(sweep.thinned(DESIGN, stride), (), (), (*stays(sweep, at), *thinned))

    @property
    def axes(self) -> tuple[Array, ...]:
        """The values along each axis that is drawn."""
        return tuple(
            self.sweep[name][order] for name, order in zip(self.names, self.orders, strict=True)
        )

    @property
    def numbers(self) -> npt.NDArray[np.int64]:
        """Numbers of a list's designs."""
        return self.sweep.chosen[DESIGN]

    def __getitem__(self, column: str) -> Any:
        """A column over the axes that are drawn, in their order, and its own."""
        values, dimensions = self.sweep[column], list(self.sweep.dimensions)
        if self.names:
            values = np.squeeze(
                values, tuple(k for k, name in enumerate(dimensions) if name not in self.names)
            )
            kept = [name for name in dimensions if name in self.names]
            values = np.moveaxis(
                values, [kept.index(name) for name in self.names], range(len(kept))
            )
            for axis, order in enumerate(self.orders):
                values = np.take(values, order, axis=axis)
        return values


def stays(sweep: Sweep, at: Mapping[str, float]) -> tuple[str, ...]:
    """Values of fixed parameters, in words."""
    return (
        (f"at {', '.join(value(sweep, name, there) for name, there in at.items())}",) if at else ()
    )
