"""Derivatives of a scene's quantities at points, for values of its parameters: by compiled code, or
by CasADi's virtual machine.
"""

from __future__ import annotations

import functools
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from ...base.brief import Brief
from ...base.quantities import Output
from ...base.symbolic import symbolic_property
from ...engine import codegen
from ...engine.codegen.stages import plain
from ...engine.instants.backends import Interpreter, begun, compiled, evaluator
from ...engine.instants.evaluation_method import EvaluationMethod
from ...engine.program import Program
from ...engine.sharpness import Sharpness
from .jacobian import PointFunction

if TYPE_CHECKING:
    import casadi as ca

Numbers = npt.NDArray[np.intc]


@dataclass(frozen=True, eq=False)
class Batch:
    """A ``function`` of one output at many points: by the code of a ``library``, or by CasADi's
    virtual machine.
    """

    function: Any
    library: codegen.BatchLibrary | None = None

    @classmethod
    def of(cls, function: ca.Function, method: EvaluationMethod) -> Batch:
        """Compile it by the compiler of a method; always in doubles."""
        flags = tuple(shlex.split(method.flags))
        found = compiled(method, lambda compiler: codegen.load_batch(function, compiler, flags))
        return cls(function, None if found is None else found[1])

    def at(self, n: int, given: Mapping[str, tuple[npt.NDArray[np.generic], int]]) -> Array:
        """Result at n points, (n, result): of each argument its rows, and the number of points that
        one is for, 0 for all. Of what is ``chosen`` the numbers are given.
        """
        into = np.full((n, self.function.numel_out(0)), np.nan)
        if not n:
            return into
        if self.library is not None:
            self.library.evaluate(n, given, into)
            return into
        columns = []
        for name, (rows, every) in given.items():
            each = np.repeat(rows, every, axis=0)[:n] if every else rows
            height, width = self.function.size_in(name)
            if name == codegen.CHOSEN:
                each = np.eye(height)[each]
            columns.append(
                each.reshape(-1, height).T if width * height else np.zeros((height, width))
            )
        into[:] = np.asarray(self.function(*columns).full()).T.reshape(n, -1)
        return into


@dataclass(frozen=True, eq=False)
class Loops:
    """The iterated coordinates of a graph, if it has any, at places between instants."""

    program: Program
    library: codegen.Library | Interpreter | None

    @classmethod
    def of(cls, program: Program, method: EvaluationMethod) -> Loops:
        """Compile what follows them by the compiler of a method; always in doubles."""
        if program.newton is None:
            return cls(program, None)
        doubles = EvaluationMethod(method.backend, flags=method.flags)
        return cls(program, evaluator(program, plain(program), doubles)[0])

    def at(self, t: Array, p: Array, places: Array) -> Array:
        """Iterated coordinates (n, z) at ``places`` (n,) between the rising instants ``t``, from
        which they are followed.
        """
        if self.library is None:
            return np.zeros((places.size, 0))
        count = self.program.instant.size1_in("z")
        times, back = np.unique(np.concatenate([t, places]), return_inverse=True)
        guess = np.array(begun(self.program, float(times[0]), tuple(p.tolist())), float)
        z = np.zeros((count, times.size))
        self.library.follow(times, p, guess, z, np.zeros(times.size, np.intc))
        return np.ascontiguousarray(z[:, back[t.size :]].T)


class AtPoints(NamedTuple):
    """Value of n points (n,), and its derivatives by time, xi/l and all parameters, (n, 2 +
    parameters).
    """

    value: Array
    gradient: Array

    @property
    def rate(self) -> Array:
        """The derivative by time, (n,)."""
        return self.gradient[:, 0]

    @property
    def slopes(self) -> Array:
        """The derivatives by all parameters, (n, parameters)."""
        return self.gradient[:, 2:]


class Bends(NamedTuple):
    """Gradient at n points by time, xi/l and all parameters, (n, 2 + parameters), and its change
    along w directions, (n, w, 2 + parameters).
    """

    gradient: Array
    changes: Array


@dataclass(frozen=True, eq=False, repr=False)
class Slopes(Brief):
    """Quantities of a scene and their derivatives by all parameters, at points."""

    points: PointFunction
    method: EvaluationMethod
    first: Batch
    loops: Loops

    @classmethod
    def of(
        cls,
        program: Program,
        quantities: Sequence[Output],
        sharpness: Sharpness | None,
        method: EvaluationMethod,
    ) -> Slopes:
        """Derive and compile those of some quantities, by the compiler of a method; always in
        doubles.
        """
        points = PointFunction.of(program, quantities, sharpness)
        return cls(points, method, Batch.of(points.function, method), Loops.of(program, method))

    @functools.cached_property
    def numbers(self) -> Mapping[Output, int]:
        """The number of each quantity."""
        return {quantity: k for k, quantity in enumerate(self.points.quantities)}

    def at(
        self, t: Array, z: Array, p: Array, chosen: Numbers, xi: Array, value: Array | None = None
    ) -> AtPoints:
        """Evaluate the ``chosen`` quantities at times ``t`` and ratios ``xi``, (n,) each, with
        iterated coordinates ``z`` (n, z) there.

        With ``value`` (n,) a place along a link moves with the station that is there, on the side
        on which the force is nearer to that, unless it is NaN; else it stands still. A ratio of
        what is not along a link may be NaN.
        """
        given = _given(t, z, p, chosen, xi, value)
        found = self.first.at(t.size, given)
        # A sum over all quantities, of which one has a weight, is no number where any of them is
        # none: as where friction rests that the chosen one has nothing to do with.
        finite = np.isfinite(found)
        if finite.all():
            return AtPoints(found[:, 0], found[:, 1:])
        broken = ~finite.all(axis=1) & (chosen < len(self.points.quantities))
        for k in set(chosen[broken].tolist()):
            here = np.flatnonzero(broken & (chosen == k))
            local = {
                name: (rows[here] if each else rows, each) for name, (rows, each) in given.items()
            }
            local[codegen.CHOSEN] = np.zeros(here.size, np.intc), 1
            alone = _alone(self.points.program, self.points.quantities[k])
            found[here] = Batch(alone.function).at(here.size, local)
        return AtPoints(found[:, 0], found[:, 1:])

    def bends(
        self,
        t: Array,
        z: Array,
        p: Array,
        chosen: Numbers,
        xi: Array,
        value: Array | None,
        directions: Array,
    ) -> Bends:
        """Derivatives of :meth:`at` along each of ``directions`` (w, 2 + parameters) in time, in
        xi/l and in the parameters. The iterated coordinates must close the loops.

        They are derived and compiled when they are first asked for.
        """
        n, w = t.size, len(directions)
        given = _given(t, z, p, chosen, xi, value)
        given = {name: (rows, each * w) for name, (rows, each) in given.items()}
        found = self._second.at(n * w, given | {"way": (np.tile(directions, (n, 1)), 1)})
        found = found.reshape(n, w, 2, 2 + p.size)
        return Bends(found[:, 0, 0], found[:, :, 1])

    @symbolic_property
    def _second(self) -> Batch:
        return Batch.of(self.points.further(), self.method)


@functools.lru_cache(maxsize=64)
def _alone(program: Program, quantity: Output) -> PointFunction:
    """The function of one quantity alone, which nothing else has a part in."""
    return PointFunction.of(program, [quantity])


def _given(
    t: Array, z: Array, p: Array, chosen: Numbers, xi: Array, value: Array | None
) -> dict[str, tuple[npt.NDArray[np.generic], int]]:
    """The arguments of a :class:`.PointFunction` at n points."""
    known = np.zeros(t.size, bool) if value is None else np.isfinite(value)
    return {
        "t": (t[:, None], 1),
        "z": (z, 1),
        "p": (p[None], 0),
        "xi": (np.where(np.isnan(xi), 0.0, xi)[:, None], 1),
        "value": (np.where(known, 0.0 if value is None else value, 0.0)[:, None], 1),
        "moving": (known.astype(float)[:, None], 1),
        codegen.CHOSEN: (np.asarray(chosen, np.intc), 1),
    }
