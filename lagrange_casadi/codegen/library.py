"""A scene's compiled code, loaded."""

from __future__ import annotations

import ctypes
import functools
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ..arithmetic.compensated import DTYPES
from ..base.vocabulary import Precision
from ..peak_search.intervals import Listed
from .calls import Call
from .compiler import Compiler, broken, loaded, packed, statements
from .designs import CALL, DESIGNS, Reduction
from .emit import EVALUATE, FOLLOW, INSTANTS
from .search import Search, Tables, load_search

if TYPE_CHECKING:
    from _ctypes import CFuncPtr

Array = npt.NDArray[Any]
"""Array in the precision of the emitted code."""
Status = npt.NDArray[np.int32]

_WORTH_A_THREAD = 1 << 24
"""Statements, those of an instant times the instants: about a millisecond, some times what it takes
to start a thread.
"""

_LONGEST, _SLOWER = 128, 4
"""Into how many threads' worth a call is cut, some tenths of a second; and how much slower is what
is done by the instant.
"""
_LINE, _DISTRIBUTED = 16, 8
"""Values of a cache line of either precision; and into how many parts a thread's share of designs
is cut, for they differ.
"""

_CUT = 64
"""A multiple of any pack, so that no cut falls into one."""


@dataclass(frozen=True, eq=False)
class Library:
    """The loaded code of one scene graph. Its calls release the interpreter and allocate nothing.

    ``share`` is how many instants are worth a thread of their own, ``reach`` how many are followed
    in a call.
    """

    entry: Any
    entry_follow: Any | None
    flags: tuple[str, ...]
    share: int
    reach: int

    def follow(self, t: Array, p: Array, guess: Array, z: Array, status: Status) -> None:
        """Fill the iterated coordinates ``z`` (k, n), each instant from the one before; ``guess``
        (k) begins, and moves along.
        """
        if self.entry_follow is None:
            status[:] = 0
            return
        for start in range(0, t.shape[-1], self.reach):
            cut = slice(start, start + self.reach)
            self._call(
                self.entry_follow,
                z,
                t=t[..., cut],
                p=p,
                guess=guess,
                z=z[:, cut],
                out=None,
                status=status[cut],
            )

    def evaluate(
        self, t: Array, p: Array, z: Array, out: Array, status: Status, threads: int = 1
    ) -> None:
        """Fill ``out`` (columns, n) for the instants ``t``, where the iterated coordinates are
        ``z`` (k, n).

        ``t`` is (n,), in single precision (2, n): rounded, and the rest; ``p`` likewise. All rows
        are equally far apart. ``status`` (n) is what :meth:`follow` left; what is not finite is
        noted there. The bytes do not depend on ``threads``.
        """
        assert all(
            rows.ndim == 1 or rows.strides == out.strides or not rows.size for rows in (t, z)
        )
        n = t.shape[-1]
        shares = max(1, min(threads, n // self.share))
        size = min(self._stretch, -(-n // (shares * _CUT)) * _CUT)
        if size >= n:
            self._call(self.entry, out, t=t, p=p, guess=None, z=z, out=out, status=status)
            return

        def run(start: int) -> None:
            cut = slice(start, start + size)
            self._call(
                self.entry,
                out,
                t=t[..., cut],
                p=p,
                guess=None,
                z=z[:, cut],
                out=out[:, cut],
                status=status[cut],
            )

        _share(run, range(0, n, size), shares)

    @property
    def _stretch(self) -> int:
        """Instants of one call: between calls an interrupt comes through."""
        return _LONGEST * self.share // _CUT * _CUT

    @staticmethod
    def _call(
        entry: CFuncPtr,
        rows: Array,
        *,
        t: Array,
        p: Array,
        guess: Array | None,
        z: Array,
        out: Array | None,
        status: Status,
    ) -> None:
        """Call with :data:`INSTANTS`; all rows are as far apart as those of ``rows``."""
        call = INSTANTS.made(
            n=t.shape[-1],
            stride=rows.strides[0] // rows.itemsize,
            t=t.ctypes.data,
            p=p.ctypes.data,
            guess=None if guess is None else guess.ctypes.data,
            z=z.ctypes.data,
            out=None if out is None else out.ctypes.data,
            apart=rows.strides[0] // rows.itemsize,
            status=status.ctypes.data,
        )
        entry(call)


@dataclass(frozen=True, eq=False)
class DesignsLibrary:
    """The loaded code of many designs of one scene over ``count`` instants.

    Its calls release the interpreter and allocate nothing.

    ``share`` is how many designs are worth a thread of their own.
    """

    entry: Any
    flags: tuple[str, ...]
    share: int
    reduction: Reduction
    count: int
    guess: npt.NDArray[np.float64]
    search: Search
    tables: Tables

    def evaluate(
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
        n = p.shape[0]
        shares = max(1, min(threads, n // self.share))
        size = max(
            1, min(_LONGEST * self.share, -(-n // (_DISTRIBUTED * shares)) if shares > 1 else n)
        )

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

        _share(run, range(0, n, size), shares)

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
        t - 1) tells in which steps between them the motion bends more than they show; one row of
        either serves all designs. ``history`` may be None; or all but that and the status may be
        None: then no peaks are sought, and instants need not be in equal steps. ``iterated`` and
        ``tops``, of which ``listed`` tells, may be left out. The bytes of a row do not depend on
        other rows.
        """
        stride = (-(-self.count // _LINE) | 1) * _LINE + 2 * _LINE
        hidden = np.zeros((len(bent), stride), np.int8)
        hidden[:, : bent.shape[1]] = bent
        dtype = DTYPES[self.search.precision]
        room = np.zeros((self.reduction.rows + self.guess.size + 2) * stride + _LINE, dtype)
        room = room[-room.ctypes.data // room.itemsize % _LINE :]
        status, hiding = np.zeros(stride, np.int32), np.zeros(2 * stride, np.int8)
        arrays: dict[str, npt.NDArray[Any] | None] = {
            "t": t,
            "bent": hidden,
            "p": p,
            "guess": self.guess,
            "room": room,
        }
        arrays |= {"statuses": status, "hiding": hiding, "iterated": None, "tops": None, **results}
        single = {
            name: np.empty(array.shape, dtype)
            for name in ("history", "iterated")
            if (array := arrays.get(name)) is not None and array.dtype != dtype
        }
        rounded = [
            (array, own) for name, own in single.items() if (array := arrays[name]) is not None
        ]
        arrays |= single
        search, within = self.search.call(self.tables, _CUT)
        call = CALL.made(
            search=ctypes.addressof(search),
            find=self.search.address,
            designs=p.shape[0],
            n=self.count,
            stride=stride,
            t_apart=self.count if len(t) > 1 else 0,
            bent_apart=stride if len(bent) > 1 else 0,
            way=listed.way if listed else 0,
            share=listed.share if listed else 0.0,
            **{
                name: None if array is None else array.ctypes.data for name, array in arrays.items()
            },
        )
        return functools.partial(_enter, self.entry, call, rounded, (arrays, search, within))


def _share(run: Callable[[int], None], starts: Iterable[int], threads: int) -> None:
    """Run what begins at each of the starts, by so many threads."""
    if threads == 1:
        for start in starts:
            run(start)
        return
    pool = ThreadPoolExecutor(threads)
    try:
        list(pool.map(run, starts))
    finally:
        pool.shutdown(cancel_futures=True)


def _enter(
    entry: CFuncPtr,
    call: ctypes.Structure,
    rounded: Sequence[tuple[Array, Array]],
    _kept: object,
) -> None:
    """Call, with what must live as long as the call's addresses; then widen what was rounded."""
    entry(call)
    for array, own in rounded:
        array[...] = own


def load(source: str, compiler: Compiler, extra: tuple[str, ...] = (), steps: int = 1) -> Library:
    """Build an emitted file, as C or with packs as C++, or take it from the cache, and load it.

    ``extra`` flags come after the package's own; loops take up to so many ``steps``. Raises
    :class:`CompilerError`.
    """
    library = loaded(packed(source, compiler), compiler, extra)
    entry, follow = _entry(library, compiler, EVALUATE, INSTANTS), None
    if hasattr(library, FOLLOW):
        follow = _entry(library, compiler, FOLLOW, INSTANTS)
    share, size = (
        max(_CUT, _WORTH_A_THREAD // statements(source)),
        statements(source) * steps * _SLOWER,
    )
    return Library(
        entry,
        follow,
        (*compiler.flags(source), *extra),
        share,
        max(1, _LONGEST * _WORTH_A_THREAD // size),
    )


def load_designs(
    source: str,
    compiler: Compiler,
    extra: tuple[str, ...],
    reduction: Reduction,
    count: int,
    guess: npt.NDArray[np.float64],
    precision: Precision,
) -> DesignsLibrary:
    """Load a file for many designs over ``count`` instants, whose iterated loops begin from
    ``guess``.
    """
    search = load_search(compiler, extra, precision)
    entry = _entry(loaded(packed(source, compiler), compiler, extra), compiler, DESIGNS, CALL)
    share = max(1, _WORTH_A_THREAD // (statements(source) * count))
    flags = (*compiler.flags(source), *extra)
    return DesignsLibrary(
        entry, flags, share, reduction, count, guess, search, reduction.tables(precision)
    )


def _entry(library: ctypes.CDLL, compiler: Compiler, name: str, call: Call) -> CFuncPtr:
    try:
        return call.declare(getattr(library, name))
    except AttributeError as error:
        raise broken(compiler, error) from None
