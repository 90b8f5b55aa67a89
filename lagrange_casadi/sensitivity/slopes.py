"""Derivatives of a scene's quantities at points, for values of its parameters: by compiled code, or
by CasADi's virtual machine.
"""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from .. import codegen
from ..base.arrays import Array
from ..base.quantities import Output
from ..base.symbolic import symbolic_property
from ..codegen.stages import plain
from ..equations.program import Program
from ..instants.backends import compiled
from ..instants.rung import Rung
from ..summits.sharpness import Sharpness
from .following import iterated
from .points import PointFunction

Numbers = npt.NDArray[np.intc]


class AtPoints(NamedTuple):
    """Value of n points (n,), its derivative by time (n,), and those by all parameters (n,
    parameters).
    """

    value: Array
    rate: Array
    slopes: Array


@dataclass(frozen=True, eq=False)
class Slopes:
    """Quantities of a scene and their derivatives by all parameters, at points: by ``library``, or
    by the virtual machine.
    """

    graph: Program
    points: PointFunction
    library: codegen.PointsLibrary | None
    following: codegen.Library | None

    @classmethod
    def of(
        cls, graph: Program, quantities: Sequence[Output], sharpness: Sharpness, rung: Rung
    ) -> Slopes:
        """Derive and compile those of some quantities, by the compiler of a rung; always in
        doubles.
        """
        points, extra = (
            PointFunction.of(graph, quantities, sharpness),
            tuple(shlex.split(rung.flags)),
        )

        def build(
            compiler: codegen.Compiler,
        ) -> tuple[codegen.PointsLibrary, codegen.Library | None]:
            followed = (
                None
                if graph.newton is None
                else codegen.load(codegen.emit(graph, plain(graph)), compiler, extra)
            )
            return codegen.load_points(points.function, compiler, extra), followed

        found = compiled(rung, build)
        return cls(graph, points, *((None, None) if found is None else found[1]))

    @cached_property
    def numbers(self) -> Mapping[Output, int]:
        """The number of each quantity."""
        return {quantity: k for k, quantity in enumerate(self.points.quantities)}

    def at(
        self, t: Array, z: Array, p: Array, chosen: Numbers, xi: Array, value: Array | None = None
    ) -> AtPoints:
        """Evaluate the ``chosen`` quantities at times ``t`` and ratios ``xi``, (n,) each, with
        iterated coordinates ``z`` (n, z) there.

        With ``value`` (n,) a place along a link moves with the station that is there, on the side
        on which the force is nearer to that; else it stands still. A ratio of what is not along a
        link may be NaN.
        """
        n = t.size
        found = AtPoints(np.empty(n), np.empty(n), np.empty((n, p.size)))
        moving = np.full(n, 0.0 if value is None else 1.0)
        ratios = np.where(np.isnan(xi), 0.0, xi)
        values = np.zeros(n) if value is None else np.where(np.isfinite(value), value, 0.0)
        given: dict[str, Any] = {
            "t": t,
            "z": z,
            "p": p,
            "xi": ratios,
            "value": values,
            "moving": moving,
        }
        given = {name: np.ascontiguousarray(array, float) for name, array in given.items()}
        if self.library is not None:
            numbers = {"chosen": np.ascontiguousarray(chosen, np.intc)}
            self.library.evaluate(
                given | numbers, {"found": found.value, "rate": found.rate, "slopes": found.slopes}
            )
        else:
            _interpreted(self.points, given, chosen, found, np.arange(n))
        # A sum over all quantities, of which one has a weight, is no number where any of them is
        # none: as where friction rests that the chosen one has nothing to do with.
        broken = ~np.isfinite(np.column_stack(found)).all(axis=1) & (
            chosen < len(self.points.quantities)
        )
        for k in np.unique(chosen[broken]):
            here = np.flatnonzero(broken & (chosen == k))
            _interpreted(self._alone(int(k)), given, np.zeros(here.size, np.intc), found, here)
        return found

    def _alone(self, number: int) -> PointFunction:
        """The function of one quantity alone, which nothing else has a part in."""
        if number not in self._single:
            self._single[number] = PointFunction.of(
                self.graph, self.points.quantities[number : number + 1]
            )
        return self._single[number]

    @symbolic_property
    def _single(self) -> dict[int, PointFunction]:
        """Requested parameters, by number."""
        return {}

    def iterated(self, t: Array, p: Array, places: Array) -> Array:
        """The iterated coordinates (n, z) at ``places`` (n,) between the rising instants ``t``,
        from which they are followed.
        """
        return iterated(self.graph, self.following, t, p, places)


def _interpreted(
    points: PointFunction,
    given: Mapping[str, Array],
    chosen: Numbers,
    found: AtPoints,
    here: npt.NDArray[np.intp],
) -> None:
    """Put into ``found`` what is ``chosen`` at the points ``here``, by CasADi's virtual machine."""
    ones = np.zeros((points.function.size1_in("chosen"), here.size))
    ones[chosen, np.arange(here.size)] = 1.0
    rows = (given[name][None, here] for name in ("xi", "value", "moving"))
    columns = points.function(given["t"][None, here], given["z"][here].T, given["p"], *rows, ones)
    for array, column in zip(found, columns, strict=True):
        array[here] = column.full().T if array.ndim > 1 else column.full().ravel()
