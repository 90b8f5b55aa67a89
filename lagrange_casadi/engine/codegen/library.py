"""A scene's compiled code, loaded."""

from __future__ import annotations

import ctypes
import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ...base.vocabulary import Precision
from ..compensated import DTYPES
from ..threads import in_threads
from .compiler import Compiler, entry_of, loaded, statements
from .emit import EVALUATE, FOLLOW, INSTANTS
from .peak_search import Listed, Search, Tables, load_search
from .reduction import CALL, DESIGNS, Reduction

if TYPE_CHECKING:
    from _ctypes import CFuncPtr

Array = npt.NDArray[Any]
"""Array in the precision of the emitted code."""
Status = npt.NDArray[np.int32]

_WORTH_A_THREAD = 1 << 21
"""Statements, those of an instant times the instants: about a twentieth of a millisecond, some
times what it takes to wake a thread.
"""

_BOUND = 8
"""Factor on that where each piece makes its own arguments, which takes as long as to wake some
threads.
"""

_LONGEST, _SLOWER = 1024, 4
"""Into how many threads' worth a call is cut, some tenths of a second; and how much slower is what
is done by the instant.
"""
_LINE, _DISTRIBUTED = 16, 8
"""Values of a cache line of either precision; and into how many parts a thread's share is cut, for
parts differ, and threads begin one after another.
"""

_CUT = 64
"""A multiple of any pack, so that no cut falls into one."""


@dataclass(frozen=True, eq=False)
class Designs:
    """Many designs, as the code of a scene takes them: their ``reduction``, the ``guess`` from
    which iterated loops begin, and the search for peaks.
    """

    reduction: Reduction
    guess: Array
    search: Search
    tables: Tables

    @classmethod
    def of(
        cls,
        reduction: Reduction,
        guess: Sequence[float],
        compiler: Compiler,
        extra: tuple[str, ...],
        precision: Precision,
    ) -> Designs:
        """Load the search for peaks that a reduction needs."""
        search = load_search(compiler, extra, precision)
        begin = np.array(guess, DTYPES[precision])
        return cls(reduction, begin, search, reduction.tables(precision))


@dataclass(frozen=True, eq=False)
class Library:
    """The loaded code of one scene: for the instants of a design, or for ``many`` designs. Its
    calls release the interpreter and allocate nothing.

    ``weight`` is the number of statements of an instant, ``steps`` the largest number of Newton
    steps that loops take there.
    """

    entries: Mapping[str, Any] = field(repr=False)
    flags: tuple[str, ...]
    weight: int
    steps: int
    many: Designs | None = None

    def share(self, instants: int = 1, worth: int = 1) -> int:
        """Number of runs of so many instants that are ``worth`` threads of their own."""
        return max(1, worth * _WORTH_A_THREAD // (self.weight * instants))

    def follow(self, t: Array, p: Array, guess: Array, z: Array, status: Status) -> None:
        """Fill the iterated coordinates ``z`` (k, n), each instant from the one before, the first
        from ``guess`` (k).
        """
        self._follow(_instants(t, p, guess, z, None, status), guess, status)

    def evaluation(
        self,
        t: Array,
        p: Array,
        guess: Array,
        z: Array,
        out: Array,
        status: Status,
        threads: int = 1,
    ) -> Callable[[], None]:
        """Return a function that fills ``out`` (columns, n) for the instants ``t``, and the
        iterated coordinates ``z`` as :meth:`follow` does, from the contents of the arrays when it
        is called.

        ``t`` is (n,), in single precision (2, n): rounded, and the rest; ``p`` likewise. All rows
        are equally far apart. ``status`` (n) says where loops do not close, and what is not
        finite. The bytes do not depend on ``threads``.
        """
        assert t.ndim == 1 or t.strides == out.strides or not t.size
        assert not z.size or z.strides == out.strides
        n = t.shape[-1]
        call, entry = _instants(t, p, guess, z, out, status), self.entries[EVALUATE]
        share = max(_CUT, self.share())
        shares = max(1, min(threads, n // share))
        # Between calls an interrupt comes through.
        pieces = min(shares * _DISTRIBUTED, 2 * n // share) if shares > 1 else 1
        size = min(_LONGEST * share // _CUT * _CUT, -(-n // (pieces * _CUT)) * _CUT)

        def evaluate(_kept: object = (t, p, z, out)) -> None:
            self._follow(call, guess, status)
            if size >= n:
                entry(call, 0, n)
                return
            in_threads(lambda i: entry(call, i, min(i + size, n)), range(0, n, size), shares)

        return evaluate

    def _follow(self, call: ctypes.Structure, guess: Array, status: Status) -> None:
        if not guess.size:
            status.fill(0)
            return
        reach = max(1, _LONGEST * _WORTH_A_THREAD // (self.weight * self.steps * _SLOWER))
        for i in range(0, call.n, reach):
            self.entries[FOLLOW](call, i, min(i + reach, call.n))

    def designs(
        self,
        t: npt.NDArray[np.float64],
        bent: npt.NDArray[np.bool_],
        p: npt.NDArray[np.float64],
        results: Mapping[str, Array | None],
        threads: int = 1,
        listed: Listed | None = None,
    ) -> None:
        """Fill ``results`` for designs ``p``, as :meth:`bound` does.

        The bytes of a row do not depend on ``threads``.
        """
        n, instants = p.shape[0], t.shape[1]
        shares = max(1, min(threads, n // self.share(instants, _BOUND)))
        size = -(-n // (_DISTRIBUTED * shares)) if shares > 1 else n
        size = max(1, min(_LONGEST * self.share(instants), size))

        def run(start: int) -> None:
            cut = slice(start, start + size)
            rows = {name: None if array is None else array[cut] for name, array in results.items()}
            self.bound(
                t[cut] if len(t) > 1 else t,
                bent[cut] if len(bent) > 1 else bent,
                p[cut],
                rows,
                listed,
            )()

        in_threads(run, range(0, n, size), shares)

    def bound(
        self,
        t: npt.NDArray[np.float64],
        bent: npt.NDArray[np.bool_],
        p: npt.NDArray[np.float64],
        results: Mapping[str, Array | None],
        listed: Listed | None = None,
    ) -> Callable[[], None]:
        """Return a function that fills ``results`` for designs ``p``, (n, parameters), from the
        contents of the arrays when it is called.

        They are arrays by their names in :data:`CALL`. ``t`` are instants (n, t), and ``bent`` (n,
        t - 1) says in which steps between them the motion bends more than they show; one row of
        either serves all designs. ``history`` may be None; or all but that and the status may be
        None: then no peaks are sought, and instants need not be in equal steps. ``iterated``,
        ``tops``, which ``listed`` describes, and ``near`` may be left out. With ``error`` peaks are
        those at the instants: it becomes how much larger they may be between them. The bytes of a
        row do not depend on other rows.
        """
        assert self.many is not None
        many, n = self.many, t.shape[1]
        stride = (-(-n // _LINE) | 1) * _LINE + 2 * _LINE
        hiding = np.zeros((2 + len(bent), stride), np.int8)
        hiding[2:, : bent.shape[1]] = bent
        dtype = DTYPES[many.search.precision]
        iterated = 2 + many.reduction.rows
        room = np.zeros((iterated + many.guess.size) * stride + _LINE, dtype)
        begin = -room.ctypes.data // room.itemsize % _LINE
        room = room[begin : begin - _LINE].reshape(-1, stride)
        own, status = np.zeros((2, p.shape[1]), dtype), np.zeros(stride, np.int32)
        instants = _instants(room[:2, :n], own, many.guess, room[iterated:], None, status)
        arrays: dict[str, Array | None] = {"t": t, "p": p, "hiding": hiding}
        arrays |= dict.fromkeys(("iterated", "tops", "error", "near")) | dict(results)
        rounded = [
            (name, array, np.empty(array.shape, dtype))
            for name in ("history", "iterated")
            if (array := arrays.get(name)) is not None and array.dtype != dtype
        ]
        arrays |= {name: converted for name, _, converted in rounded}
        search, within = many.search.call(many.tables, listed)
        call = CALL.made(
            search=ctypes.addressof(search),
            find=many.search.address,
            designs=p.shape[0],
            instants=ctypes.addressof(instants),
            t_apart=n if len(t) > 1 else 0,
            bent_apart=stride if len(bent) > 1 else 0,
            **{
                name: None if array is None else array.ctypes.data for name, array in arrays.items()
            },
        )
        kept = (self, arrays, room, own, status, instants, search, within)
        return functools.partial(_enter, self.entries[DESIGNS], call, rounded, kept)


def _instants(
    t: Array, p: Array, guess: Array, z: Array, out: Array | None, status: Status
) -> ctypes.Structure:
    """Arguments of what runs over instants; all rows are equally far apart."""
    rows = z if out is None else out
    apart = rows.strides[0] // rows.itemsize
    return INSTANTS.made(
        n=t.shape[-1],
        stride=apart,
        t=t.ctypes.data,
        p=p.ctypes.data,
        guess=guess.ctypes.data if guess.size else None,
        z=z.ctypes.data if z.size else None,
        out=None if out is None else out.ctypes.data,
        apart=apart,
        status=status.ctypes.data,
    )


def _enter(
    entry: CFuncPtr,
    call: ctypes.Structure,
    rounded: Sequence[tuple[str, Array, Array]],
    _kept: object,
) -> None:
    """Call, with what must live as long as the call's addresses; then widen what was rounded."""
    entry(call)
    for _, array, converted in rounded:
        array[...] = converted


def load(
    source: str,
    compiler: Compiler,
    extra: tuple[str, ...] = (),
    steps: int = 1,
    designs: Designs | None = None,
) -> Library:
    """Build an emitted file, as C or with packs as C++, or take it from the cache, and load it.

    ``extra`` flags come after the package's own; loops take up to so many ``steps``. A file with a
    reduction is for ``designs``. Raises :class:`CompilerError`.
    """
    library = loaded(source, compiler, extra)
    some = (ctypes.c_longlong, ctypes.c_longlong)
    calls = (
        {FOLLOW: (INSTANTS, *some), EVALUATE: (INSTANTS, *some)}
        if designs is None
        else {DESIGNS: (CALL,)}
    )
    entries = {
        name: call.declare(entry_of(library, name, compiler), *more)
        for name, (call, *more) in calls.items()
    }
    flags = (*compiler.flags(source), *extra)
    return Library(entries, flags, statements(source), steps, designs)
