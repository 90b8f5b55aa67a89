"""A scene made ready for many evaluations, one after another: what does not depend on parameters'
values is done once.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Annotated, TypeAlias

import numpy as np
import numpy.typing as npt

from ...base.arguments import LATER, Numeric, Outputs, ThreadCount, public
from ...base.arrays import Array
from ...base.status import Status
from ...base.symbolic import symbolic_property
from ...base.units import Number
from ...base.vocabulary import Compiled, PeakSearch, Precision
from ...engine.instants.evaluation_method import EvaluationMethod
from ...engine.model_data import template
from ...errors import AssemblyError, DeclarationError, UnknownNameError, check_known, listed, shown
from ...model.scene import Scene
from ...model.times import Over, Times
from ...model.wanted_names import without_fitted, without_life
from ...results.sensitivity.peak_derivatives import MeanSlopes
from ...results.solution import Solution
from ..request import Request
from .engine import DesignEngine
from .outcome import KEPT, Outcome

_Values: TypeAlias = Mapping[str, Number] | None


@dataclass(frozen=True, eq=False)
class Peaks:
    """Summary of the instants of one evaluation, and of all times between them.

    ``value``, ``t`` and ``xi``, (q,), are the peak of each quantity with its sign, its time [s] and
    its ratio xi/l, NaN off a link; ``mean`` and ``rms``, (e,), those of each effort over time.
    ``error`` (q,), of peaks that are those of the instants, is how much larger each may be between
    them.
    """

    value: Array
    t: Array
    xi: Array
    mean: Array
    rms: Array
    error: Array | None = None


@dataclass(frozen=True, eq=False)
class Gradient:
    """The peaks of q ``quantities``, and how each changes with the parameters.

    ``value``, ``t`` and ``xi``, (q,), are those of :class:`Peaks`. ``slopes`` (q, parameters) are
    the derivatives of ``value``, with its sign, by each of ``parameters``, in the quantity's unit
    over the parameter's. ``kinds`` (q,) says what each peak is at: see ``PeakKind``. Slopes
    are NaN where a peak has none: it is infinite, not determined, or at a kink or a jump that
    nothing explains. If a quantity has two peaks of equal size, the slopes are those of the
    reported peak; :attr:`tied` marks these quantities.
    """

    quantities: tuple[str, ...]
    parameters: tuple[str, ...]
    value: Array
    t: Array
    xi: Array
    slopes: Array
    kinds: npt.NDArray[np.int8]
    efforts: tuple[str, ...]
    sample: Callable[[], npt.NDArray[np.bool_]] = field(repr=False)
    add_up: Callable[[], MeanSlopes] = field(repr=False)

    @symbolic_property
    def tied(self) -> npt.NDArray[np.bool_]:
        """Return which peaks (q,) tie with another of the same quantity that changes differently:
        the larger of both has no derivative.

        It is looked for when it is first asked for, which takes longer than the gradient.
        """
        return self.sample()

    @cached_property
    def mean(self) -> dict[str, dict[str, float]]:
        """The derivatives of the means of ``efforts`` over time, by effort and parameter; made when
        they are first asked for.
        """
        return self._named(self._means.mean)

    @cached_property
    def rms(self) -> dict[str, dict[str, float]]:
        """Derivatives of the root mean squares; NaN if that is 0."""
        return self._named(self._means.rms)

    @symbolic_property
    def _means(self) -> MeanSlopes:
        return self.add_up()

    def _named(self, slopes: Array) -> dict[str, dict[str, float]]:
        return {
            name: dict(zip(self.parameters, row, strict=True))
            for name, row in zip(self.efforts, slopes.tolist(), strict=True)
        }

    def __getitem__(self, quantity: str) -> dict[str, float]:
        """The derivatives of the peak of a quantity, by the parameter's name.

        Raises :class:`UnknownNameError`.
        """
        check_known("quantity with a peak", [quantity], self.quantities)
        return dict(
            zip(self.parameters, self.slopes[self.quantities.index(quantity)].tolist(), strict=True)
        )


@dataclass(frozen=True, eq=False)
class Curvature:
    """The second derivatives of the peaks of q ``quantities`` by the ``parameters``.

    ``bends`` (q, parameters, parameters) are symmetric, of the peaks with their sign, in the
    quantity's unit over both parameters'. They are NaN where :class:`Gradient` has no slopes, and
    where a peak that is level in time would jump elsewhere.
    """

    quantities: tuple[str, ...]
    parameters: tuple[str, ...]
    bends: Array

    def __getitem__(self, quantity: str) -> dict[str, dict[str, float]]:
        """Second derivatives of the peak of a quantity, by the names of both parameters.

        Raises :class:`UnknownNameError`.
        """
        check_known("quantity with a peak", [quantity], self.quantities)
        rows = self.bends[self.quantities.index(quantity)].tolist()
        return {
            name: dict(zip(self.parameters, row, strict=True))
            for name, row in zip(self.parameters, rows, strict=True)
        }


class _Answers(threading.local):
    """The arrays that evaluations write into, and what is bound to them: made anew in each thread
    that asks for them.
    """

    def __init__(self, engine: DesignEngine, defaults: Array) -> None:
        self.p, self.status = defaults[None].copy(), np.zeros(1, np.int8)
        program, quantities, efforts = (
            engine.program,
            len(engine.kept.quantities),
            len(engine.efforts),
        )
        self.history = np.empty((1, len(program.columns), engine.count))
        self.rows = {
            str(output): self.history[0, program.outputs[output]] for output in program.outputs
        }
        self.places = {
            name: np.empty((1, quantities if k < 3 else efforts)) for k, name in enumerate(KEPT)
        }
        if engine.sampled:
            self.places["error"] = np.empty((1, quantities))
        self.kept_peaks = Peaks(*(array[0] for array in self.places.values()))
        self.near = engine.near(1)
        # Where nothing but the values changes from call to call, all that remains is the call
        # itself.
        self.calls = [self.call(engine, peaks) for peaks in (0, 1)] if engine.times.common else None

    def call(self, engine: DesignEngine, peaks: int) -> tuple[Callable[[], None], Array]:
        """A call that evaluates series, or if 1 ``peaks``, and the instants (1, t)."""
        t = engine.times.of(self.p, asked=not peaks)[1 - peaks]
        bent = engine.bent(self.p, t) if peaks else np.zeros((1, 0), bool)
        kept = {**self.places, "history": None} if peaks else dict.fromkeys(KEPT)
        results = {"status": self.status, "near": self.near, "history": self.history, **kept}
        return engine.library.bound(t, bent, self.p, results), t


class Prepared:
    """A scene that answers for values of its parameters: see :func:`prepare`.

    Any number of threads may use one. Answers lie in arrays of the thread that asks; :meth:`copy`
    has others, for the same thread.
    """

    def __init__(
        self, engine: DesignEngine, explain: Callable[[Mapping[str, float]], Solution]
    ) -> None:
        self._engine, self._explain = engine, explain
        self._declared = engine.program.data.parameters
        self._place = {name: k for k, name in enumerate(self._declared)}
        self._defaults = engine.program.data.defaults
        self._answers = _Answers(engine, self._defaults)

    def __repr__(self) -> str:
        return (
            f"<Prepared {self._engine.program.data.name}: {len(self.outputs)} outputs; parameters:"
            f" {listed(self.parameters)}>"
        )

    @property
    def parameters(self) -> tuple[str, ...]:
        """The names of the parameters."""
        return self._engine.parameters

    @property
    def outputs(self) -> tuple[str, ...]:
        """The names of the series that an evaluation gives."""
        return self._engine.columns

    @property
    def quantities(self) -> tuple[str, ...]:
        """The names of the quantities that have peaks, in their order."""
        return self._engine.quantities

    @property
    def units(self) -> tuple[str, ...]:
        """Units of the quantities."""
        return self._engine.kept.units

    @property
    def efforts(self) -> tuple[str, ...]:
        """The names of the efforts that have means, in their order."""
        return self._engine.efforts

    @property
    def t(self) -> Array:
        """The instants (t,) [s] of this thread's last evaluation; before the first one, those of
        the defaults.
        """
        instants: Array = self._engine.times.of(self._answers.p)[1][0]
        return instants

    def copy(self) -> Prepared:
        """Another one with arrays of its own, for answers that are needed side by side; nothing is
        derived or compiled for it.
        """
        return Prepared(self._engine, self._explain)

    def __call__(self, /, *values: _Values, **named: Number) -> Mapping[str, Array]:
        """The series (t,) of all outputs, by name, for values of parameters, by name or in
        mappings; the defaults for others.

        Where a joint that rubs is at rest, what depends on its friction is NaN at these instants,
        as in :func:`.evaluate`. This thread's next evaluation overwrites the arrays. Raises
        :class:`UnknownNameError` and :class:`ParameterError` for what is no parameter, or out of
        range, and :class:`AssemblyError` where there is no result.
        """
        p, answers, program = self._set(values, named), self._answers, self._engine.program
        self._evaluate(0)
        if program.loop_angles or program.indeterminate:
            self._engine.finish(answers.history, p)
        return answers.rows

    def peaks(self, /, *values: _Values, **named: Number) -> Peaks:
        """Return the peaks and means for values of the parameters.

        This thread's next evaluation overwrites the arrays. Instants at which a joint with friction
        is at rest do not count for what depends on this friction; what has no other instants is
        NaN.

        Parameters
        ----------
        *values : mapping, optional
            Values of parameters by name.
        **named : float or str
            The same by keyword; other parameters have their defaults.

        Returns
        -------
        Peaks
            Peaks of the quantities, and means of the efforts.

        Raises
        ------
        UnknownNameError
            For what is no parameter.
        ParameterError
            If a value is out of its range.
        AssemblyError
            If there is no result, or a peak cannot be located.
        """
        self._set(values, named)
        return self._evaluate(1)

    def gradient(self, /, *values: _Values, **named: Number) -> Gradient:
        """Return the peaks and their derivatives by all parameters.

        They are exact, by automatic differentiation. The first call derives and compiles them, in
        doubles; a later one takes a few times as long as :meth:`peaks` at most.

        Parameters
        ----------
        *values : mapping, optional
            Values of parameters by name.
        **named : float or str
            The same by keyword; other parameters have their defaults.

        Returns
        -------
        Gradient
            Peaks, and their derivatives in the quantity's unit over the parameter's.

        Raises
        ------
        UnknownNameError
            For what is no parameter.
        ParameterError
            If a value is out of its range.
        AssemblyError
            If :meth:`peaks` has no result.
        """
        p, value, t, xi = self._kept_peaks(values, named)
        found = self._engine.gradient(p, value, t, xi)
        return Gradient(
            self.quantities,
            self.parameters,
            value,
            t,
            xi,
            found.slopes,
            found.kinds,
            self.efforts,
            partial(self._engine.tied, p, value, found),
            partial(self._engine.mean_slopes, p),
        )

    def curvature(self, /, *values: _Values, **named: Number) -> Curvature:
        """Return the second derivatives of peaks by all parameters: how their gradient changes.

        They are exact, by automatic differentiation, as peaks move in time and along links. The
        first call derives and compiles them, in doubles.

        Parameters
        ----------
        *values : mapping, optional
            Values of parameters by name.
        **named : float or str
            The same by keyword; other parameters have their defaults.

        Returns
        -------
        Curvature
            Derivatives in the quantity's unit over both parameters'.

        Raises
        ------
        UnknownNameError
            For what is no parameter.
        ParameterError
            If a value is out of its range.
        AssemblyError
            If :meth:`peaks` has no result.
        DeclarationError
            For a motion by samples whose knots are not known.
        """
        p, value, t, xi = self._kept_peaks(values, named)
        gradient = self._engine.gradient(p, value, t, xi)
        return Curvature(
            self.quantities, self.parameters, self._engine.curvature(p, value, t, xi, gradient)
        )

    @public
    def designs(
        self, p: Numeric, *, threads: ThreadCount | None = None, histories: bool = False
    ) -> Outcome:
        """Evaluate many designs at once.

        Values are not checked against the parameters' ranges.

        Parameters
        ----------
        p : array (n, parameters)
            A design in each row, in the order of :attr:`parameters`.
        threads : int, optional
            Threads that share the designs.
        histories : bool
            True if the series over time shall be kept too.

        Returns
        -------
        Outcome
            Status, peaks and means of each; a design without a result is NaN.
        """
        return self._engine.evaluate(p, threads=threads, histories=histories)

    def _evaluate(self, peaks: int) -> Peaks:
        """Evaluate this thread's parameters: series, or if 1 ``peaks``."""
        engine, answers = self._engine, self._answers
        call, t = answers.calls[peaks] if answers.calls else answers.call(engine, peaks)
        call()
        status = int(answers.status[0])
        if answers.near is not None:  # a motion may have a corner though all have numbers
            status = int(engine.statuses(answers.p, t, answers.status, answers.near)[0])
        if status != Status.OK:
            # It says where, and why.
            self._explain(dict(zip(self.parameters, answers.p[0].tolist(), strict=True)))
            raise AssemblyError(f"no result: {Status(status).meaning}")
        return answers.kept_peaks

    def _kept_peaks(
        self, values: Sequence[_Values], named: Mapping[str, Number]
    ) -> tuple[Array, Array, Array, Array]:
        """The parameters (parameters,), and of the peaks there the values, times and ratios, as
        copies that stay.
        """
        p = self._set(values, named)
        peaks = self._evaluate(1)
        return p[0].copy(), peaks.value.copy(), peaks.t.copy(), peaks.xi.copy()

    def _set(self, values: Sequence[_Values], named: Mapping[str, Number]) -> Array:
        """Put values of parameters into this thread's row of them (1, parameters)."""
        p: Array = self._answers.p
        row = p[0]
        row[:] = self._defaults
        for given in (*values, named) if values else (named,):
            if given is None:
                continue
            if type(given) is not dict and not isinstance(given, Mapping):
                raise DeclarationError(
                    f"parameters: expected values by name, as {{'l': 0.25}}, got {shown(given)}"
                )
            for name, value in given.items():
                parameter = self._declared.get(name)
                if parameter is None:
                    raise UnknownNameError("parameter", name, self._declared)
                if not (type(value) is float and parameter.low <= value <= parameter.high):
                    parameter.check(value)
                row[self._place[name]] = value if type(value) is float else parameter.number(value)
        return p


@public
def prepare(
    scene: Scene,
    *,
    t: Times | None = None,
    over: Over | None = None,
    wanted: Outputs | None = None,
    backend: Compiled = "auto",
    precision: Precision = "double",
    newton: Annotated[int | None, LATER] = None,
    flags: Annotated[str, LATER] = "",
    peaks: PeakSearch = "exact",
) -> Prepared:
    """Make a scene ready for many evaluations one after another, as in an optimiser.

    It is compiled once; an evaluation is then a call of the compiled code, with the statuses of
    :func:`.sweep`. There is no certificate and no estimate of errors: :func:`.evaluate` the design
    that is chosen.

        f = prepare(scene, wanted=["effort"])
        largest = abs(f(l=0.25)["effort:O"]).max()
        peaks = dict(zip(f.quantities, f.peaks(l=0.25).value))

    Parameters
    ----------
    scene
        The scene.
    t, over, wanted, backend, precision, newton, flags
        As in :func:`.evaluate`.
    peaks
        ``exact``, sought between the instants; or ``sampled``, those of the instants, each with an
        error. These have no derivatives.

    Returns
    -------
    Prepared
        A function of parameters by name.

    Raises
    ------
    CompilerError
        If a backend needs a compiler, and there is none or it fails.
    LagrangeCasadiError
        As :func:`.evaluate`, for mistakes in the arguments.
    """
    named = () if wanted is None else wanted
    without_life(named, "prepared scenes")
    without_fitted(template(scene).content.fitted, named, "prepared scenes")
    method = EvaluationMethod(backend, precision, newton, None, flags)
    request = Request(t=t, over=over, wanted=wanted, method=method)

    def explain(values: Mapping[str, float]) -> Solution:
        from ..solving import solve

        return solve(scene, replace(request, parameters=values), certificate=False)

    engine = DesignEngine.of(
        scene, wanted, method=method, timing=scene.timing(t, over), peaks=peaks
    )
    return Prepared(engine, explain)
