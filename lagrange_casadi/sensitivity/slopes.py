"""Derivatives of a scene's quantities at points, for values of its parameters: by compiled code, or by CasADi's virtual machine."""

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
from ..codegen.stages import plain
from ..equations.scene_graph import SceneGraph
from ..instants.backends import compiled
from ..instants.rung import Rung
from ..summits.sharpness import Sharpness
from .following import iterated
from .points import PointFunction

Numbers = npt.NDArray[np.intc]


class AtPoints(NamedTuple):
    """Of n points the value (n,), its derivative by time (n,), and those by all parameters (n, parameters)."""

    value: Array
    rate: Array
    slopes: Array


@dataclass(frozen=True, eq=False)
class Slopes:
    """Quantities of a scene and their derivatives by all parameters, at points: by ``library``, or by the virtual machine."""

    graph: SceneGraph
    points: PointFunction
    library: codegen.PointsLibrary | None
    following: codegen.Library | None

    @classmethod
    def of(cls, graph: SceneGraph, quantities: Sequence[Output], sharpness: Sharpness, rung: Rung) -> Slopes:
        """Derive and compile those of some quantities, by the compiler of a rung; always in doubles."""
        points, extra = PointFunction.of(graph, quantities, sharpness), tuple(shlex.split(rung.flags))

        def build(compiler: codegen.Compiler) -> tuple[codegen.PointsLibrary, codegen.Library | None]:
            followed = None if graph.newton is None else codegen.load(codegen.emit(graph, plain(graph)), compiler, extra)
            return codegen.load_points(points.function, compiler, extra), followed

        found = compiled(rung, build)
        return cls(graph, points, *((None, None) if found is None else found[1]))

    @cached_property
    def numbers(self) -> Mapping[Output, int]:
        """The number of each quantity."""
        return {quantity: k for k, quantity in enumerate(self.points.quantities)}

    def at(self, t: Array, z: Array, p: Array, chosen: Numbers, xi: Array, value: Array | None = None) -> AtPoints:
        """What is ``chosen`` at times ``t`` and ratios ``xi``, (n,) each, with iterated coordinates ``z`` (n, z) there.

        With ``value`` (n,) a place along a link moves with the station that is there, on the side on which the force is nearer to
        that; else it stands still. A ratio of what is not along a link may be NaN.
        """
        n = t.size
        found = AtPoints(np.empty(n), np.empty(n), np.empty((n, p.size)))
        moving = np.full(n, 0.0 if value is None else 1.0)
        ratios = np.where(np.isnan(xi), 0.0, xi)
        values = np.zeros(n) if value is None else np.where(np.isfinite(value), value, 0.0)
        given: dict[str, Any] = {
            "t": t,
            "drives": self._drives(t, p),
            "z": z,
            "p": p,
            "xi": ratios,
            "value": values,
            "moving": moving,
        }
        given = {name: np.ascontiguousarray(array, float) for name, array in given.items()}
        if self.library is not None:
            given["chosen"] = np.ascontiguousarray(chosen, np.intc)
            self.library.evaluate(given, {"found": found.value, "rate": found.rate, "slopes": found.slopes})
            return found
        ones = np.zeros((self.points.function.size1_in("chosen"), n))
        ones[chosen, np.arange(n)] = 1.0
        rows = (given[name][None] for name in ("xi", "value", "moving"))
        columns = self.points.function(t[None], given["drives"].T, given["z"].T, p, *rows, ones)
        for array, column in zip(found, columns, strict=True):
            array[:] = column.full().T if array.ndim > 1 else column.full().ravel()
        return found

    def _drives(self, t: Array, p: Array) -> Array:
        """What motions by samples give at times, (n, drives)."""
        return np.zeros((t.size, 0)) if self.points.lead is None else np.asarray(self.points.lead(t[None], p).full().T)

    def iterated(self, t: Array, p: Array, places: Array) -> Array:
        """The iterated coordinates (n, z) at ``places`` (n,) between the rising instants ``t``, from which they are followed."""
        return iterated(self.graph, self.following, t, p, places)
