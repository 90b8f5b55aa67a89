"""Many designs of one scene at once: of each parameter set the peaks, means, and whether there is a result at all.

Instants of a design are evaluated several at once, by SIMD, and reduced in C to what is kept. Between instants peaks are sought by
evaluating the same graph at a few more instants there. A design depends on nothing but its own parameters: its row has the same
bytes whatever stands beside it.
"""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from .. import codegen
from ..codegen.stages import Stages
from ..declare.density import Array
from ..declare.even_points import EvenPoints
from ..declare.scene import Scene
from ..equations.derive import derive
from ..equations.scene_graph import SceneGraph
from ..errors import DeclarationError
from ..evaluate import checked_laws, checked_span, outputs_of
from ..instants.backends import compiled, provenance
from ..instants.cost import seconds
from ..instants.determinacy import determinate, undetermined
from ..instants.rung import Rung
from ..instants.section_law import made_of
from ..instants.solution import Provenance
from ..quantities import Output
from ..summits.sharpness import bent, with_watched
from ..system.room import cores, require
from .interpreted import outcome
from .reduction import KeptOutputs, stages_of
from .witness import failures

_LOOKS = 32
"""At about so many more instants is the peak of a quantity sought."""


@dataclass(frozen=True, eq=False)
class Outcome:
    """What is kept of n designs, a row each; rows of designs without a result hold NaN.

    ``status`` (n) is a :class:`.Status`. ``value``, ``t`` and ``xi``, (n, q), are the peak of each quantity with its sign, its time
    [s] and its ratio xi/l, NaN off a link; ``mean`` and ``rms``, (n, e), those of each effort over time. ``series`` (n, columns, t)
    are whole histories, where they were asked for.
    """

    status: npt.NDArray[np.int8]
    value: Array
    t: Array
    xi: Array
    mean: Array
    rms: Array
    series: Array | None


@dataclass(frozen=True, eq=False)
class DesignEngine:
    """A scene compiled for many designs.

    ``parameters`` are the columns of what :meth:`evaluate` takes; ``quantities``, with ``units``, and ``efforts`` those of what it
    gives; ``columns`` those of histories. ``left_open`` are the outputs that equilibrium leaves open for the parameters'
    defaults, which are left out; what it leaves open for some design is NaN there.
    """

    scene: Scene
    rung: Rung
    t: Array
    kept: KeptOutputs
    graph: SceneGraph
    stages: Stages
    library: codegen.DesignsLibrary | None
    left_open: tuple[Output, ...]
    provenance: Provenance

    @classmethod
    def of(
        cls, scene: Scene, wanted: Sequence[str] | None = None, t: EvenPoints | None = None, rung: Rung | None = None
    ) -> DesignEngine:
        """Derive and compile: ``wanted`` outputs, instants ``t`` and ``rung`` as in :func:`.evaluate`."""
        rung = rung or Rung()
        if rung.table is not None:
            raise DeclarationError("designs are not read from a table: each would need a table of its own")
        graph = derive(scene, wanted, iterate=rung.newton is not None)
        timing, values = scene.timing(t), scene.mechanism.values()
        checked_laws(scene, checked_span(scene, timing, values), tuple(values.values()))
        instants = scene.instants(timing, values).t
        p = np.array(list(values.values()))
        _, left_open = determinate(graph, instants, p)
        kept = KeptOutputs.of(graph, rung, left_open)
        require("the instants of a design", (kept.reduction.rows, instants.size))
        watched = with_watched(graph, kept.sharpness)
        stages = stages_of(watched, rung, instants)
        guess = np.array(graph.newton.guess if graph.newton else (), float)

        def build(compiler: codegen.Compiler) -> codegen.DesignsLibrary:
            source = codegen.emit_designs(watched, stages, rung.newton, kept.reduction)
            hidden = bent(graph, kept.sharpness, instants, p)
            return codegen.load_designs(
                source, compiler, tuple(shlex.split(rung.flags)), kept.reduction, instants, guess, hidden, rung.precision
            )

        found = compiled(rung, build)
        if found is None:
            return cls(scene, rung, instants, kept, graph, stages, None, left_open, provenance("vm", "", "", rung))
        compiler, library = found
        backend = "lanes" if compiler.language == "c++" else "c"
        made = provenance(backend, compiler.version, " ".join(library.flags), rung)
        return cls(scene, rung, instants, kept, graph, stages, library, left_open, made)

    @property
    def parameters(self) -> tuple[str, ...]:
        """The names of the parameters."""
        return tuple(self.scene.mechanism.parameters)

    @property
    def quantities(self) -> tuple[str, ...]:
        """The names of the quantities that have peaks."""
        return tuple(str(self.kept.quantities[k]) for k in self._shown)

    @property
    def units(self) -> tuple[str, ...]:
        """Their units."""
        return tuple(self.kept.units[k] for k in self._shown)

    @property
    def efforts(self) -> tuple[str, ...]:
        """The names of the efforts that have means."""
        return tuple(map(str, self.kept.efforts))

    @property
    def undetermined(self) -> tuple[str, ...]:
        """The names of the outputs that are left open for the parameters' defaults."""
        return tuple(map(str, self.left_open))

    @property
    def doubtful(self) -> tuple[str, ...]:
        """The names of the quantities, and the outputs in histories, that equilibrium may leave open for some designs."""
        numbers = sorted({quantity for _, quantity in self.kept.reduction.doubts})
        return tuple(dict.fromkeys(map(str, [*(self.kept.quantities[k] for k in numbers), *self.graph.doubtful])))

    @property
    def columns(self) -> tuple[str, ...]:
        """The names of the outputs that histories have."""
        return tuple(map(str, self.outputs))

    @cached_property
    def outputs(self) -> tuple[Output, ...]:
        """The outputs that histories have."""
        found = self.graph.outputs
        return tuple(o for o in found if (o.part in self.kept.links if o.along else o not in self.left_open))

    @property
    def cost(self) -> float:
        """Seconds that a core takes for a design, within a factor of three or so: counted, not measured, the same everywhere."""
        return seconds(self.graph, self.t.size + _LOOKS * len(self.quantities), self.rung, interpreted=self.library is None)

    @property
    def room(self) -> int:
        """Bytes of memory that a core takes while it evaluates."""
        return 8 * self.kept.reduction.rows * self.t.size

    def evaluate(self, p: Any, *, threads: int | None = None, histories: bool = False) -> Outcome:
        """The outcome of designs ``p``, (n, parameters), in the order of :attr:`parameters`; with ``histories``, its series too.

        Values are not checked against the parameters' ranges. ``threads`` share the designs, by default one a core; no byte depends
        on them. Raises :class:`DeclarationError` for another shape, :class:`SizeError` where the outcome does not fit into memory.
        """
        p = np.ascontiguousarray(p, float)
        if p.ndim != 2 or p.shape[1] != len(self.parameters):
            raise DeclarationError(f"designs: expected an array of shape (n, {len(self.parameters)}), got {p.shape}")
        n, q, e = p.shape[0], len(self.kept.quantities), len(self.efforts)
        history = (n, len(self.graph.columns), self.t.size)
        require("the peaks of the designs", (n, 3 * q + 2 * e))
        if histories:
            require("the histories of the designs", history)
        columns = np.empty(history) if histories else None
        peaks, means = (np.empty((3, n, q)), np.empty((2, n, e)))
        found = Outcome(np.zeros(n, np.int8), peaks[0], peaks[1], peaks[2], means[0], means[1], columns)
        if self.library is not None:
            peaks_of = {"value": found.value, "peak_t": found.t, "xi": found.xi}
            results = {"status": found.status, **peaks_of, "mean": found.mean, "rms": found.rms, "history": found.series}
            self.library.evaluate(p, results, threads or cores())
        else:
            self._interpret(p, found)
        if len(self._shown) < q:
            found = replace(found, **{name: getattr(found, name)[:, self._shown] for name in ("value", "t", "xi")})
        if columns is None:
            return found
        with np.errstate(invalid="ignore"):
            for row, out in zip(p, columns, strict=True):
                out[[self.graph.outputs[output] for output in undetermined(self.graph, out, row, self.rung)]] = np.nan
            series = outputs_of(self.graph, np.moveaxis(columns, 1, 0))
        return replace(found, series=np.stack([series[output] for output in self.outputs], axis=1))

    @cached_property
    def _shown(self) -> list[int]:
        """The quantities that are given: of a link that has some forces determined, all are made, and these are shown."""
        found = enumerate(self.kept.quantities)
        return [k for k, q in found if q.group != "section" or not made_of(self.left_open, q.part, q.member)]

    def failures(self, p: Array) -> dict[str, float]:
        """What fails of one design that has a result, (parameters,), looked at with all its outputs: see :mod:`.witness`."""
        series = self.evaluate(p[None], threads=1, histories=True).series
        assert series is not None
        return failures(self.scene, p, self.t, self.rung, self.outputs, series[0])

    def _interpret(self, p: Array, found: Outcome) -> None:
        kept = (found.value, found.t, found.xi, found.mean, found.rms)
        for i, row in enumerate(p):
            found.status[i], design = outcome(self.graph, self.kept, self.t, row, self.rung.newton)
            for array, values in zip(kept, (*design.peaks, *design.means) if design else [np.nan] * 5, strict=True):
                array[i] = values
            if found.series is not None:
                found.series[i] = design.columns if design else np.nan
