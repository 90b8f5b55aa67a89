"""Second derivatives of quantities at single points, along ways in time, in xi/l and in the
parameters: one CasADi function.

The first derivatives of :mod:`.points` are differentiated forward. Of iterated loops those hold the
step -Phi_z^-1 Phi of Newton's method, whose derivatives are those of the solution where Phi = 0;
along the solution Phi stays 0, so that what is differentiated once more, with the iterated
coordinates going along as the implicit function theorem says, is exact too.
"""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import casadi as ca
import numpy as np

from .. import codegen
from ..base.arrays import Array
from ..base.symbolic import symbolic
from ..equations.program import Program
from ..instants.backends import compiled
from ..instants.rung import Rung
from .batches import at_points
from .points import PointFunction
from .slopes import Numbers, Slopes


class Bends(NamedTuple):
    """Gradient at n points by time, xi/l and all parameters, (n, 2 + parameters), and its change
    along w directions, (n, w, 2 + parameters).
    """

    gradient: Array
    changes: Array


@dataclass(frozen=True, eq=False)
class Curvatures:
    """Second derivatives of the functions of ``slopes`` at points: by ``library``, or by the
    virtual machine.
    """

    slopes: Slopes
    function: Any
    library: codegen.BatchLibrary | None

    @classmethod
    def of(cls, slopes: Slopes, rung: Rung) -> Curvatures:
        """Derive and compile those of what ``slopes`` are of, by the compiler of a rung; always in
        doubles.

        Raises :class:`.DeclarationError` for a motion by samples that does not tell its knots.
        """
        function, extra = (
            second_function(slopes.graph, slopes.points),
            tuple(shlex.split(rung.flags)),
        )
        made = compiled(rung, lambda compiler: codegen.load_batch(function, compiler, extra))
        return cls(slopes, function, None if made is None else made[1])

    def at(
        self, t: Array, z: Array, p: Array, chosen: Numbers, xi: Array, value: Array, ways: Array
    ) -> Bends:
        """Second derivatives of the ``chosen`` quantities at times ``t`` and ratios ``xi``, (n,)
        each, along each of ``ways`` (w, 2 + parameters).

        Places along a link move as those of :meth:`.Slopes.at` do with ``value``, unless that is
        NaN. ``z`` (n, z) are the iterated coordinates there; they must close the loops.
        """
        n, w = t.size, len(ways)
        ones = np.zeros((n, self.function.size1_in("chosen")))
        ones[np.arange(n), chosen] = 1.0
        given = {
            "t": (t[:, None], w),
            "z": (z, w),
            "p": (p[None], 0),
            "xi": (np.where(np.isnan(xi), 0.0, xi)[:, None], w),
            "value": (np.where(np.isfinite(value), value, 0.0)[:, None], w),
            "moving": (np.where(np.isfinite(value), 1.0, 0.0)[:, None], w),
            "chosen": (ones, w),
            "way": (np.tile(ways, (n, 1)), 1),
        }
        found = at_points(self.function, self.library, n * w, given).reshape(n, w, 2, 2 + p.size)
        return Bends(found[:, 0, 0], found[:, :, 1])


@symbolic
def second_function(graph: Program, points: PointFunction) -> Any:
    """``at_once(t, z, p, xi, value, moving, chosen, way) -> found``: of what
    :class:`.PointFunction` has the gradient by time, xi/l and all parameters, and how it changes
    along a ``way`` of these."""
    inner, laws = points.at_drives, graph.laws
    given = {inner.name_in(k): inner.sx_in(k) for k in range(inner.n_in())}
    t, z, p, xi = (given[name] for name in ("t", "z", "p", "xi"))
    driven = laws.motion.call([t, p])
    given |= dict(zip(("d", "d_rate", "d_acceleration"), driven, strict=True))
    given["d_jerk"] = laws.jerk()(t, p)
    found, rate, slopes = inner.call([given[inner.name_in(k)] for k in range(inner.n_in())])
    gradient = ca.vertcat(rate, ca.gradient(found, xi), slopes)
    way = ca.SX.sym("way", 2 + p.numel())
    of, along = [t, xi, p], [way[0], way[1], way[2:]]
    if graph.newton is not None:
        step = graph.newton.step(z, t, driven[0], p)[0]
        along.append(ca.jtimes(step, ca.vertcat(t, p), ca.vertcat(way[0], way[2:])))
        of.append(z)
    change = ca.jtimes(gradient, ca.vertcat(*of), ca.vertcat(*along))
    names = ["t", "z", "p", "xi", "value", "moving", "chosen"]
    every = [*(given[name] for name in names), way]
    return ca.Function(
        "at_once",
        every,
        [ca.densify(ca.vertcat(gradient, change))],
        [*names, "way"],
        ["found"],
        {"cse": True},
    )


def unit_ways(numbers: Sequence[int], parameters: int) -> Array:
    """The ways along time, along xi/l, and along some of so many parameters, by their numbers."""
    return np.eye(2 + parameters)[[0, 1, *(2 + k for k in numbers)]]
