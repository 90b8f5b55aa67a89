"""The search for peaks between instants, in C (``search.c`` and its neighbours): one library for
every scene, which takes curves as tables, and a function that evaluates the curves.

The compiled code of many designs calls the library with a pointer to its own function of times;
:meth:`Search.peaks` calls the library with a function of Python's.
"""

from __future__ import annotations

import ctypes
import functools
import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array, Flags
from ...base.vocabulary import Precision
from ..compensated import DTYPES
from ..sharpness import Kind, Watch
from .calls import Call
from .compiler import Compiler, entry_of, loaded, start, written
from .printer import defined

FUNCTION = "lagrange_casadi_search"

CURVES = Call(
    "lagrange_casadi_curves",
    {
        **dict.fromkeys(
            ("quantities", "curves", "places", "watches", "knots", "units"), "long long"
        ),
        "quantity": "const int*",
        "first": "const int*",
        "unit": "const int*",
        "link": "const int*",
        "placed": "const int*",
        "watch": "const int*",
        "watch_first": "const int*",
        "watch_at": "const real*",
        "knot": "const double*",
        "depends": "const signed char*",
    },
)
"""Curves of a search. For each curve its ``quantity``, its ``link`` or -1, and where along that it
is ``placed``: a row of places, or :data:`BASE`, :data:`TIP`, :data:`OFF`; for each quantity its
``first`` curve, and the number of its ``unit``; for each watched function its kind and the
``watch_first`` of the numbers ``watch_at``. ``depends`` says for each watched function, one after
another, which quantities depend on it.
"""

BASE, TIP, OFF = -1, -2, -3

AT = """\
typedef int lagrange_casadi_at(void* of, long long count, const double* t, unsigned long long need,
                               lanes_real* out, long long apart);
"""
"""Function that evaluates curves: at given times, for the links whose bits ``need`` sets, into rows
that lie ``apart``: of curves, of their places, of watched functions. It returns 0, or another
number to end the search.
"""

CALL = Call(
    "lagrange_casadi_search_call",
    {
        "curves": "const lagrange_casadi_curves*",
        "n": "long long",
        "stride": "long long",
        "t": "const double*",
        "rows": "real*",
        "most": "real*",
        "scales": "const real*",
        "open": "const signed char*",
        "rests": "int",
        "together": "int",
        "way": "int",
        "share": "double",
        "tops": "double*",
        "error": "double*",
        "hiding": "signed char*",
        "at": "lagrange_casadi_at*",
        "of": "void*",
        "room": "char*",
        "size": "long long",
        "value": "double*",
        "peak_t": "double*",
        "xi": "double*",
        "located": "signed char*",
    },
)
"""Arguments of the search; the C says which members it reads and writes."""

SIDE: dict[Precision, float] = {"double": 2e-13, "single": 1e-5}
"""Distance of the sides of a kink or a jump, in steps between instants."""

SPACING = 4 * float(np.finfo(float).eps)
"""Shortest step, relative to the time."""

NOTHING = 1e-12
"""Relative size, of the largest of a unit, that is zero within rounding."""

TOPS = 24
"""Largest number of local peaks of a quantity that are listed: the largest ones."""

_FILES = ("numbers.c", "intervals.c", "between.c", "fits.c", "samples.c", "within.c", "search.c")
_LINE = 16
"""Values of a cache line of either precision."""

_TOGETHER = 64
"""Times at which Python evaluates at once."""


def interface() -> str:
    """The C of what crosses to the search and back."""
    return (
        f"{AT}{CURVES.text()}{CALL.text()}typedef void lagrange_casadi_find({CALL.name}* call);\n"
    )


def source(precision: Precision) -> str:
    """The C of the search."""
    macros: dict[str, object] = {
        "SIDE": SIDE[precision],
        "SPACING": SPACING,
        "NOTHING": f"((search_real) {NOTHING})",
        "TOPS": TOPS,
        **{f"IS_{kind.name}": int(kind) for kind in Kind},
    }
    text = start(precision) + interface() + defined("SEARCH", macros)
    return f"{text}\n{written(*_FILES)}"


@dataclass(frozen=True, eq=False)
class Curves:
    """Curves of a search: the number of the quantity of each curve, and the number of the unit of
    each quantity.

    The peak of a quantity is that of the curve of its own that goes furthest: those of a section
    force are the force at the link's ends and load points, and where the force turns along the
    link. ``depends`` (watches, quantities) says which quantity depends on which watched function;
    ``knots`` are times [s] of kinks, ``scales`` for each unit the largest size of other quantities.
    """

    quantities: tuple[int, ...]
    units: tuple[int, ...]
    watches: tuple[Watch, ...]
    depends: Flags
    knots: tuple[float, ...] = ()
    scales: tuple[float, ...] = ()


@dataclass(frozen=True, eq=False)
class Peaks:
    """The value of each quantity (q,) that is largest in size, with its sign, its time and ratio
    xi/l, and whether the peak is located.

    A peak that is not located is the largest value that was found. ``tops``, where local peaks are
    listed, (q, :data:`TOPS`, 4), are these in no order: the number of the curve among its
    quantity's own, NaN where there are no more, time, ratio and value.
    """

    value: Array
    t: Array
    xi: Array
    resolved: Flags
    tops: Array | None = None


class Listed(NamedTuple):
    """Local peaks that are listed: those down to a ``share`` of the largest.

    Where ``sign`` is 1 or -1, peaks are those of values times ``sign``, not of sizes. These are
    counted from so far below the least at the instants that a share of little more than a half
    takes all peaks between the least and the largest.
    """

    share: float
    sign: int = 0


class Samples(NamedTuple):
    """Samples at n times: values of curves (c, n), the ratios xi/l at which they are taken (c, n),
    and values of watched functions (w, n).
    """

    values: Array
    places: Array
    watched: Array


class CurveSource(Protocol):
    """Source of curves at any times; NaN where they have no value."""

    def at(self, t: Array) -> Samples:
        """Sample times of the span."""


@dataclass(frozen=True, eq=False)
class Tables:
    """Curves as the search takes them: the struct, and the arrays that it points to."""

    struct: ctypes.Structure
    arrays: Mapping[str, npt.NDArray[Any]]

    @classmethod
    def of(
        cls,
        curves: Sequence[tuple[int, int, int]],
        units: Sequence[int],
        watches: Sequence[Watch],
        knots: Sequence[float],
        depends: Flags,
        precision: Precision = "double",
    ) -> Tables:
        """Make it from curves, each with its quantity, in order, its link and its place."""
        quantity, link, placed = zip(*curves, strict=True)
        arrays: dict[str, npt.NDArray[Any]] = {
            name: np.array([*values], np.intc)
            for name, values in {
                "quantity": quantity,
                "first": [*(quantity.index(q) for q in range(len(units))), len(quantity)],
                "unit": units,
                "link": link,
                "placed": placed,
                "watch": [watch.kind for watch in watches],
                "watch_first": itertools.accumulate(
                    (len(watch.at) for watch in watches), initial=0
                ),
            }.items()
        }
        arrays["watch_at"] = np.array([x for watch in watches for x in watch.at], DTYPES[precision])
        arrays["knot"] = np.array(knots, float)
        arrays["depends"] = np.ascontiguousarray(depends, np.int8)
        struct = CURVES.made(
            quantities=len(units),
            curves=len(quantity),
            places=1 + max(-1, *placed),
            watches=len(watches),
            knots=len(knots),
            units=max(units) + 1,
            **{name: array.ctypes.data for name, array in arrays.items()},
        )
        return cls(struct, arrays)


@dataclass(frozen=True, eq=False)
class Search:
    """The loaded search."""

    entry: Any
    precision: Precision

    @property
    def address(self) -> int | None:
        """Address for compiled code."""
        return ctypes.cast(self.entry, ctypes.c_void_p).value

    def call(
        self, tables: Tables, listed: Listed | None, **members: float | None
    ) -> tuple[ctypes.Structure, npt.NDArray[np.int8]]:
        """A call for some curves, and its room; other members are left out."""
        made = CALL.type(curves=ctypes.addressof(tables.struct), **members)
        if listed:
            made.way, made.share = listed.sign, listed.share
        self.entry(made)
        room = np.empty(made.size + 4 * _LINE, np.int8)
        made.room = room.ctypes.data + -room.ctypes.data % (4 * _LINE)
        return made, room

    def peaks(
        self,
        source: CurveSource,
        curves: Curves,
        t: Array,
        samples: Samples,
        hiding: Flags,
        listed: Listed | None = None,
    ) -> Peaks:
        """Find the peaks of quantities over the span of equally spaced instants ``t`` (n,), of
        which ``samples`` are; an exception of ``source`` is raised.

        ``hiding`` (n - 1,) marks the steps in which samples are known to miss something. No peak is
        below the largest sample. Of several peaks that are equal within rounding the first is
        reported; otherwise rounding would choose the sign. A quantity that is NaN at all instants,
        because of friction at rest, has no peak. ``listed`` says which local peaks are listed.
        """
        values, places, watched = samples
        t = np.ascontiguousarray(t, float)
        n, count, quantities = t.size, len(values), len(curves.units)
        along = np.flatnonzero(np.isfinite(places).any(axis=1))
        placed = np.full(count, OFF)
        placed[along] = np.arange(along.size)
        tables = Tables.of(
            [(q, -1, k) for q, k in zip(curves.quantities, placed.tolist(), strict=True)],
            curves.units,
            curves.watches,
            curves.knots,
            curves.depends,
        )
        # What is before the first value and beyond the last is the search's to write; packs go on
        # beyond the last.
        rows = np.zeros((count + along.size + len(watched), n + 4 * _LINE))
        lines = rows[:, _LINE : -2 * _LINE]
        lines[:] = np.pad(
            np.concatenate([values, places[along], watched]), ((0, 0), (0, _LINE)), mode="edge"
        )
        scales = np.zeros(max(curves.units) + 1)
        scales[: len(curves.scales)] = curves.scales
        hidden = np.zeros((2, rows.shape[1]), np.int8)
        hidden[0, : n - 1] = hiding
        asked = _Asked(source, along)
        found = np.empty((3, quantities))
        located = np.zeros(quantities, np.int8)
        begin = rows.ctypes.data + _LINE * rows.itemsize
        tops = np.full((quantities, TOPS, 4), np.nan) if listed else None
        most = np.fmax.reduce(np.abs(values), axis=1, initial=0.0)
        call, room = self.call(
            tables,
            listed,
            n=n,
            stride=rows.shape[1],
            t=t.ctypes.data,
            rows=begin,
            most=most.ctypes.data,
            scales=scales.ctypes.data,
            rests=int(np.isnan(values).any()),
            together=_TOGETHER,
            tops=None if tops is None else tops.ctypes.data,
            hiding=hidden.ctypes.data,
            at=ctypes.cast(asked.entry, ctypes.c_void_p).value,
            value=found[0].ctypes.data,
            peak_t=found[1].ctypes.data,
            xi=found[2].ctypes.data,
            located=located.ctypes.data,
        )
        self.entry(call)
        del room  # until here the call has used it
        if asked.error is not None:
            raise asked.error
        return Peaks(found[0], found[1], found[2], located.astype(bool), tops)


_FUNCTION_OF_TIMES = ctypes.CFUNCTYPE(
    ctypes.c_int,
    ctypes.c_void_p,
    ctypes.c_longlong,
    ctypes.POINTER(ctypes.c_double),
    ctypes.c_ulonglong,
    ctypes.POINTER(ctypes.c_double),
    ctypes.c_longlong,
)


class _Asked:
    """A function of times for the search, which keeps what it raises."""

    def __init__(self, source: CurveSource, along: npt.NDArray[np.intp]) -> None:
        self.source, self.along = source, along
        self.error: BaseException | None = None
        self.entry = _FUNCTION_OF_TIMES(self)

    def __call__(
        self,
        _: None,
        count: int,
        t: ctypes._Pointer[ctypes.c_double],
        need: int,
        out: ctypes._Pointer[ctypes.c_double],
        apart: int,
    ) -> int:
        try:
            values, places, watched = self.source.at(np.ctypeslib.as_array(t, (count,)).copy())
            rows = np.concatenate([values, places[self.along], watched])
            np.ctypeslib.as_array(out, (len(rows), apart))[:, :count] = rows
        except BaseException as error:  # it must not go through C
            self.error = error
            return 1
        return 0


_LEVEL = "-O2"
"""Optimization of the search: -O3 takes half as long again to compile, and searches no faster."""


@functools.lru_cache(maxsize=8)
def load_search(
    compiler: Compiler, extra: tuple[str, ...] = (), precision: Precision = "double"
) -> Search:
    """Build the search, or take it from the cache, and load it; ``extra`` flags come after the
    package's own.

    Raises :class:`CompilerError`.
    """
    library = loaded(source(precision), compiler, extra, _LEVEL)
    return Search(CALL.declare(entry_of(library, FUNCTION, compiler)), precision)
