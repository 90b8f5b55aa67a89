"""Derivatives of a solution's outputs by the parameters: series over time, section forces over time
and xi/l, means, peaks.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..base.arguments import public
from ..base.arrays import Array
from ..base.quantities import Output
from ..base.vocabulary import Backend
from ..engine.codegen.peak_search import Listed
from ..engine.instants.evaluation_method import EvaluationMethod
from ..engine.sharpness import Sharpness
from ..errors import DeclarationError, check_known, listed
from ..model.scene import Scene
from ..results.sensitivity.ends import Ends
from ..results.sensitivity.peak_derivatives import (
    AS_LARGE,
    MovingPeaks,
    PeakKind,
    faint,
    mean_slopes,
)
from ..results.sensitivity.slopes import Numbers, Slopes
from ..results.solution import Solution
from ..results.statistics import shares
from .peaks_between import ContinuousSolution, resultants

_BLOCK = 1 << 16


@dataclass(frozen=True, eq=False)
class Changes:
    """Derivatives of one number by each parameter: ``value`` in its unit, ``slopes`` by the
    parameter's name.

    ``kind`` says what a peak is at, None of a mean. A peak is ``tied`` where another one of the
    quantity is as large and changes otherwise: the largest of both has no derivative.
    """

    value: float
    slopes: dict[str, float]
    kind: PeakKind | None = None
    tied: bool = False


@public
@dataclass(frozen=True, eq=False, repr=False)
class Sensitivities:
    """The derivatives of a ``solution`` by the parameters of its scene, each made when it is asked
    for.

    They are total and exact: of loops, motions and densities too. Instants and ratios xi/l stand
    still. Methods raise :class:`.UnknownNameError` for a quantity or a parameter that there is not,
    :class:`.DeclarationError` for a quantity that equilibrium leaves open.
    """

    solution: Solution
    slopes: Slopes
    p: Array
    continuous: ContinuousSolution

    def __repr__(self) -> str:
        return f"<Sensitivities of {self.solution.case} by {listed(self.parameters)}>"

    @property
    def parameters(self) -> tuple[str, ...]:
        """The names of the parameters."""
        return tuple(self.slopes.points.program.data.parameters)

    def array(self, name: str, parameter: str) -> Array:
        """Return the derivative of a quantity by a parameter.

        At a station, a section force is that on its tip's side.

        Parameters
        ----------
        name : str
            Full name of a quantity, as ``effort:O``.
        parameter : str
            Name of the parameter.

        Returns
        -------
        array (t,), or (t, xi) of a section force
            The derivative, in the quantity's unit over the parameter's.
        """
        return self._all(name)[1][..., self._number(parameter)]

    def curvature(self, name: str, parameter: str, other: str) -> Array:
        """Return the second derivative of a quantity by two parameters.

        Parameters
        ----------
        name : str
            Full name of a quantity, as ``effort:O``.
        parameter, other : str
            Names of the parameters, which may be the same.

        Returns
        -------
        array (t,), or (t, xi) of a section force
            The derivative, in the quantity's unit over both parameters'.

        Raises
        ------
        DeclarationError
            If a motion is by samples whose knots are not known.
        """
        row, direction = self._number(parameter), np.zeros((1, 2 + self.p.size))
        direction[0, 2 + self._number(other)] = 1.0

        def second(t: Array, z: Array, chosen: Numbers, xi: Array) -> Array:
            return self.slopes.bends(t, z, self.p, chosen, xi, None, direction).changes[
                :, 0, 2 + row
            ]

        return self._made(name, second, ())

    def mean(self, name: str) -> Changes:
        """Return the derivatives of the mean of a quantity over the instants.

        Parameters
        ----------
        name : str
            Full name of a quantity, as ``effort:O``.

        Returns
        -------
        Changes
            The mean, and its derivatives by parameter.

        Raises
        ------
        DeclarationError
            If it is a section force, which has one at every ratio.
        """
        values, changes = self._over_time(name)
        slopes = mean_slopes(self.solution.t, values, changes).mean
        return Changes(float(values @ shares(self.solution.t)), self._named(slopes))

    def rms(self, name: str) -> Changes:
        """Return the derivatives of the root mean square of a quantity.

        Parameters
        ----------
        name : str
            Full name of a quantity, as ``effort:O``.

        Returns
        -------
        Changes
            The root mean square and its derivatives by parameter, NaN if it is zero.

        Raises
        ------
        DeclarationError
            If it is a section force, which has one at every ratio.
        """
        values, changes = self._over_time(name)
        slopes = mean_slopes(self.solution.t, values, changes).rms
        return Changes(float(np.sqrt(values**2 @ shares(self.solution.t))), self._named(slopes))

    def peak(self, name: str) -> Changes:
        """Return the derivatives of the peak of a quantity, between the instants too.

        Parameters
        ----------
        name : str
            Full name of a quantity, as ``effort:O``.

        Returns
        -------
        Changes
            The peak as of :func:`.refine`, with its sign; its slopes are NaN if it has no
            derivative.
        """
        return self.peaks([name])[0]

    def peaks(self, names: Sequence[str]) -> list[Changes]:
        """Return the derivatives of the peaks of several quantities: see :meth:`peak`.

        Parameters
        ----------
        names : sequence of str
            Their full names.

        Returns
        -------
        list of Changes
            One for each name, in order.
        """
        outputs = [self._known(name) for name in names]
        sampled = [self.solution.peak(name) for name in names]
        found, others = self.continuous.refined(sampled, Listed(1.0 - AS_LARGE["double"]))
        values, t = np.array([peak.value for peak in found]), np.array([peak.t for peak in found])
        xi = np.array([np.nan if peak.xi is None else peak.xi for peak in found])
        chosen = np.array([self.slopes.numbers[output] for output in outputs], np.intc)
        units, scales = self.continuous.scales(outputs)
        nothing = faint(values, np.array(scales)[units])
        moving = MovingPeaks(
            self.slopes, Ends(self.slopes.points.program.laws, None, self.solution.t, self.p)
        )
        changes = moving.gradient(chosen, (values, t, xi), nothing)
        tied = moving.ties(chosen, values, changes, others) & ~nothing
        every = zip(
            values.tolist(), changes.slopes, changes.kinds.tolist(), tied.tolist(), strict=True
        )
        return [
            Changes(value, self._named(slopes), PeakKind(kind), two)
            for value, slopes, kind, two in every
        ]

    @cached_property
    def _iterated(self) -> Array:
        return self.slopes.loops.at(self.solution.t, self.p, self.solution.t)

    def _named(self, slopes: Array) -> dict[str, float]:
        return dict(zip(self.parameters, slopes.tolist(), strict=True))

    def _known(self, name: str) -> Output:
        unit = self.solution.unit(name)  # it refuses what is none
        output = Output.of(name)
        if not self.solution.determined(output):
            raise DeclarationError(
                f"'{name}' [{unit}] has no sensitivities: equilibrium does not determine it"
            )
        return output

    def _over_time(self, name: str) -> tuple[Array, Array]:
        if self._known(name).group == "section":
            raise DeclarationError(
                f"'{name}': a section force has a mean at every ratio; compute it from array(...)"
            )
        return self._all(name)

    def _all(self, name: str) -> tuple[Array, Array]:
        """A quantity and its derivatives by all parameters, (t, parameters)
        or (t, xi, parameters).
        """

        def first(t: Array, z: Array, chosen: Numbers, xi: Array) -> Array:
            found = self.slopes.at(t, z, self.p, chosen, xi)
            return np.column_stack([found.value, found.slopes])

        both = self._made(name, first, (1 + self.p.size,))
        return both[..., 0], both[..., 1:]

    def _made(
        self, name: str, at: Callable[[Array, Array, Numbers, Array], Array], size: tuple[int, ...]
    ) -> Array:
        """Derivatives of a ``size`` at points, over the instants, of a section force over (t,
        xi).
        """
        output, solution = self._known(name), self.solution
        along = solution.xi if output.group == "section" else np.full(1, np.nan)
        rows, xi = (
            np.repeat(np.arange(solution.t.size), along.size),
            np.tile(along, solution.t.size),
        )
        found = np.empty((rows.size, *size))
        for start in range(0, rows.size, _BLOCK):
            some = slice(start, start + _BLOCK)
            chosen = np.full(rows[some].size, self.slopes.numbers[output], np.intc)
            found[some] = at(solution.t[rows[some]], self._iterated[rows[some]], chosen, xi[some])
        return (
            found
            if output.group != "section"
            else found.reshape(solution.t.size, along.size, *size)
        )

    def _number(self, parameter: str) -> int:
        check_known("parameter", [parameter], self.parameters)
        return self.parameters.index(parameter)


@public
def sensitivities(scene: Scene, solution: Solution, *, backend: Backend = "auto") -> Sensitivities:
    """Return the derivatives of a scene's solution by its parameters.

        changes = sensitivities(scene, solution)
        changes.array("effort:O", "l")  # (t,) [N m/m]
        changes.peak("section:rod:bending").slopes["r"]

    Parameters
    ----------
    scene
        The scene.
    solution
        A solution of it.
    backend
        Backend that evaluates them, as in :func:`.evaluate`; always in doubles.

    Returns
    -------
    Sensitivities
        Derivatives of arrays, peaks, means and root mean squares. Forces that least strain energy
        determines have none here.

    Raises
    ------
    DeclarationError
        If the solution is not of this scene.
    """
    solution = solution.by_equilibrium
    continuous = ContinuousSolution.of(scene, solution)
    program = continuous.program
    quantities = [o for o in solution.quantities() if solution.determined(o)]
    quantities += [o for o in map(Output.of, resultants(solution)) if o not in quantities]
    made = {part for o in quantities if o.group != "section" for part in solution.made_of(o)}
    columns = sorted(
        {program.outputs[part] for part in made}
        | {k for o, k in program.outputs.items() if o.along}
    )
    slopes = Slopes.of(
        program, quantities, Sharpness.of(program, columns), EvaluationMethod(backend)
    )
    return Sensitivities(solution, slopes, continuous.p, continuous)
