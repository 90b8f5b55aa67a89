"""The columns of a scene graph over instants: by SIMD, by scalar C,
or by CasADi's virtual machine.
"""

from __future__ import annotations

import functools
import math
import shlex
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import casadi as ca
import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from ...base.space import cores
from ...base.status import Status
from ...base.vocabulary import Backend
from ...errors import CompilerError, warn
from ...version import __version__
from .. import codegen
from ..codegen.emit import NEWTON_STEPS, newton_rule
from ..codegen.stages import Stages, plain, stages_for
from ..compensated import DTYPES
from ..program import Program
from . import grids
from .cycle_table import CycleTable
from .evaluation_method import EvaluationMethod, Provenance

_LANGUAGES: dict[Backend, tuple[codegen.Language, ...]] = {
    "auto": ("c++", "c"),
    "lanes": ("c++",),
    "c": ("c",),
    "vm": (),
}
_VM_BLOCK = 4096
_FEWEST_STEPS, _MOST_STEPS = 50, 5000
"""Least and largest number of steps from the scene's start to an evaluation that begins
elsewhere.
"""

Built = TypeVar("Built")


@dataclass(frozen=True, eq=False)
class Evaluated:
    """The columns of a scene graph over instants: ``out`` (columns, t) and the status of each
    instant (t).

    ``iterated`` (k, t) are the coordinates of iterated loops; ``stages`` say what was evaluated,
    ``cycle`` what the rest was read from, if it was.
    """

    out: Array
    status: npt.NDArray[np.int32]
    iterated: Array
    stages: Stages
    cycle: CycleTable | None = None


def run(
    program: Program,
    t: Array,
    p: Array,
    method: EvaluationMethod | None = None,
    threads: int | None = None,
    *,
    into: Evaluated | None = None,
) -> tuple[Evaluated, Provenance]:
    """The columns of a graph at instants ``t`` and parameters ``p``, by a method; nothing is
    checked.

    ``into`` is what an earlier run gave on the same method and as many instants, to be filled anew.
    Raises :class:`CompilerError` where the backend needs a compiler and there is none, or it fails.
    """
    method = method or EvaluationMethod()
    stages = stages_for(program, method.precision, t, p)
    library, made = evaluator(program, stages, method)
    evaluated = into or unevaluated(program, stages, t.size)
    dtype = DTYPES[method.precision]
    guess = np.array(begun(program, t[0], tuple(p), counted=method.newton is not None), dtype)
    if method.precision == "single":
        t, p = _paired(t, rows(2, t.size, dtype)), _paired(p, np.empty((2, p.size), dtype))
    z, out, status = evaluated.iterated, evaluated.out, evaluated.status
    library.evaluation(t, p, guess, z, out, status, threads or cores())()
    return evaluated, made


@functools.lru_cache(maxsize=256)
def begun(
    program: Program, t: float, p: tuple[float, ...], *, counted: bool = False
) -> tuple[float, ...]:
    """The iterated coordinates that the first instant begins from, as the motion leads there from
    the scene's own start; closed there where steps are ``counted``; none without loops.

    The motion is followed from the scene's own start, as far from which another branch may be
    nearer; by many steps, unless they were too many.
    """
    if program.newton is None:
        return ()
    (start, stop), count = program.data.span, program.data.timing.count
    if t == start and not counted:
        return program.newton.guess
    wanted = (
        max(abs(t - start) / (stop - start) * (count - 1), _FEWEST_STEPS)
        if stop > start
        else math.inf
    )
    steps = math.ceil(wanted) if t != start and wanted <= _MOST_STEPS else 1
    guess, times = np.array(program.newton.guess), np.linspace(start, t, steps + 1)[1:]
    z, status = np.empty((guess.size, steps)), np.empty(steps, np.int32)
    Interpreter(program, plain(program)).follow(times, np.array(p), guess, z, status)
    return (
        tuple(z[:, -1]) if counted or status[-1] != Status.NOT_CONVERGED else program.newton.guess
    )


def _paired(values: Array, out: Array) -> Array:
    """Doubles as the nearest singles, and what these leave of them; infinite beyond them."""
    with np.errstate(over="ignore", invalid="ignore"):
        out[0] = values
        out[1] = values - out[0]
    return out


def evaluator(
    program: Program, stages: Stages, method: EvaluationMethod
) -> tuple[codegen.Library | Interpreter, Provenance]:
    """The code that a backend takes for instants, or what interprets them in its place."""
    found = compiled(
        method, lambda compiler: _library(program, stages, method.newton, method.flags, compiler)
    )
    if found is None and method.backend == "auto":
        warn(
            "no C or C++ compiler found: using CasADi's virtual machine, which is slow;"
            f" {codegen.INSTALL}"
        )
    made = provenance(method, found)
    return (Interpreter(program, stages, method.newton) if found is None else found[1]), made


def compiled(
    method: EvaluationMethod, build: Callable[[codegen.Compiler], Built]
) -> tuple[codegen.Compiler, Built] | None:
    """Result of ``build`` with the compiler of a method's backend, and that compiler; None for the
    virtual machine, and where there is no compiler and ``auto`` needs none.
    """
    backend = method.backend
    for language in _LANGUAGES[backend]:
        compiler = codegen.find_compiler(language)
        if compiler is None:
            continue
        try:
            return compiler, build(compiler)
        except CompilerError as error:
            if backend != "auto" or language == "c":
                raise
            warn(f"{error}; using scalar C")
    if backend in ("lanes", "c"):
        (language,) = _LANGUAGES[backend]
        needs = f"backend '{backend}' needs a {language.upper()} compiler"
        raise codegen.no_compiler(needs, language)
    if method.precision == "single":
        raise codegen.no_compiler("precision 'single' needs a compiler")
    return None


def peak_search() -> codegen.Search:
    """The compiled search for peaks. Raises :class:`CompilerError` where there is no compiler."""
    found = compiled(EvaluationMethod(), codegen.load_search)
    if found is None:
        raise codegen.no_compiler("peaks between instants need a compiler")
    return found[1]


@functools.lru_cache(maxsize=32)
def _library(
    program: Program, stages: Stages, newton: int | None, flags: str, compiler: codegen.Compiler
) -> codegen.Library:
    return codegen.load(
        codegen.emit(program, stages, newton),
        compiler,
        tuple(shlex.split(flags)),
        newton or NEWTON_STEPS,
    )


def unevaluated(program: Program, stages: Stages, size: int) -> Evaluated:
    """Empty arrays of an evaluation."""
    dtype = DTYPES[stages.precision]
    out, iterated = (
        rows(count, size, dtype) for count in (len(program.columns), program.instant.size1_in("z"))
    )
    return Evaluated(out, np.full(size, Status.OK, dtype=np.int32), iterated, stages)


def rows(count: int, size: int, dtype: npt.DTypeLike = np.float64) -> Array:
    """Rows an odd number of cache lines apart: at a power of two all would share the same few lines
    of the cache.
    """
    line = 64 // np.dtype(dtype).itemsize
    stride = line * (-(-size // line) | 1)
    return grids.empty("the outputs over time", (count, stride), dtype)[:, :size]


@functools.lru_cache(maxsize=32)
def provenance(
    method: EvaluationMethod, found: tuple[codegen.Compiler, codegen.Library] | None
) -> Provenance:
    """Provenance of numbers, with the versions of the programs involved; ``found`` as
    :func:`compiled` gives it.
    """
    import h5py  # which takes its time, and is needed for files alone

    versions = {
        "lagrange_casadi": __version__,
        "casadi": ca.CasadiMeta.version(),
        "numpy": np.__version__,
        "h5py": h5py.__version__,
        "hdf5": h5py.version.hdf5_version,
    }
    backend, compiler, flags = "vm", "", ""
    if found is not None:
        backend = "lanes" if found[0].language == "c++" else "c"
        compiler, flags = found[0].version, " ".join(found[1].flags)
    return Provenance(backend, method.precision, compiler, flags, method.options, versions)


@dataclass(frozen=True, eq=False)
class Interpreter:
    """CasADi's virtual machine in the place of a :class:`.codegen.Library`, for doubles; ``newton``
    as in :class:`.EvaluationMethod`.
    """

    program: Program
    stages: Stages
    newton: int | None = None

    def evaluation(
        self,
        t: Array,
        p: Array,
        guess: Array,
        z: Array,
        out: Array,
        status: npt.NDArray[np.int32],
        threads: int = 1,
    ) -> Callable[[], None]:
        """Return a function that fills columns and iterated coordinates, by one thread, as
        :meth:`.Library.evaluation` does.
        """

        def evaluate() -> None:
            self.follow(t, p, guess, z, status)
            for block in _blocks(t.size):
                out[:, block] = self.columns(t[block], p, z[:, block])
            unclean = ~np.isfinite(out).all(axis=0) & (status == Status.OK)
            status[unclean] = Status.NOT_FINITE

        return evaluate

    def columns(self, t: Array, p: Array, z: Array) -> Array:
        """Columns (columns, t) at times, where iterated coordinates are ``z``."""
        return np.asarray(self.stages.instant(*self.stages.drive(t[None], p), z, p).full())

    def close(self, t: Array, p: Array, z: Array) -> None:
        """Close iterated loops at times (t,), each from its own column of ``z`` (k, t), which is
        NaN where they do not converge.
        """
        if self.stages.loops is None:
            return
        rule, fixed = newton_rule("double", None), ca.DM(p)
        counted = np.atleast_2d(self.stages.drive(t[None], p)[0].full())
        for i, now in enumerate(counted.T):
            status, found = self._close(z[:, i], ca.DM(now), fixed, rule)
            z[:, i] = np.nan if status == Status.NOT_CONVERGED else found

    def follow(
        self, t: Array, p: Array, guess: Array, z: Array, status: npt.NDArray[np.int32]
    ) -> None:
        """Fill the iterated coordinates ``z`` (k, t) as :meth:`.Library.follow` does."""
        status[:] = Status.OK
        if self.stages.loops is None:
            return
        rule, fixed = newton_rule("double", self.newton), ca.DM(p)  # converted once
        for block in _blocks(t.size):
            counted = np.atleast_2d(self.stages.drive(t[None, block], p)[0].full())
            for i, now in enumerate(counted.T, block.start):
                status[i], guess = self._close(guess, ca.DM(now), fixed, rule)
                z[:, i] = guess

    def _close(
        self, guess: Array, counted: ca.DM, p: ca.DM, rule: dict[str, float]
    ) -> tuple[Status, Array]:
        """Close the loops at a moment: their status, and the guess where they do not converge."""
        assert self.program.newton is not None
        assert self.stages.loops is not None
        z, size, before, step = guess, 1.0, 1.0, 0
        while step < rule["steps"] and not size < rule["done"]:
            before, step = size, step + 1
            correction, relative = (x.full().ravel() for x in self.stages.loops(z, counted, p))
            size = float(relative[0])
            if not math.isfinite(size):
                break
            z = z + correction
        if not size < rule["lost"]:
            return Status.NOT_CONVERGED, guess
        revolutions = np.where(
            self.program.newton.turning, np.floor(z * (1.0 / math.tau) + 0.5), 0.0
        )
        slow = self.newton is None and size > rule["rate"] * before and size > rule["rounding"]
        return Status.SLOW if slow else Status.OK, z - math.tau * revolutions


def _blocks(count: int) -> list[slice]:
    """Instants that are interpreted at once."""
    return [slice(i, min(i + _VM_BLOCK, count)) for i in range(0, count, _VM_BLOCK)]
