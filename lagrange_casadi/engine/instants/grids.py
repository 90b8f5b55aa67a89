"""Grids of (t, xi) filled at the speed of memory: small products over a basis, written straight
into the result.

A grid worth it is filled by compiled code, on all cores; any other by NumPy, in blocks. Both take
the same operations in the same order, so they give the same bits.
"""

from __future__ import annotations

import ctypes
import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array, during
from ...base.space import cores, require
from ...errors import CompilerError, DeclarationError, warn
from ...model.limits import END
from ..codegen.calls import Call
from ..codegen.compiler import find_compiler, loaded, written
from ..section_function import edge
from ..threads import in_threads

WORTH_COMPILING = 1 << 9
"""Values from which on compiled code fills grids."""

_STREAMING = 1 << 24
"""Bytes from which on a grid goes past the caches."""

_MOST = 64
"""Columns that compiled code takes."""

_LINE = 8
"""Doubles in a cache line, and in the longest of vectors."""

_BLOCK = 1 << 14
_SHARE = 1 << 21
_OPTIONS = ("-O3", "-march=native")

_SUM = {
    "planes": "int",
    "terms": "int",
    "columns": "const double* const*",
    "stride": "long long",
    "basis": "const double*",
    "loads": "int",
    "acting": "const double* const*",
    "u": "const double*",
    "beyond": "const double*",
    "out": "double*",
}
GRID = Call("lagrange_casadi_grid_call", {"k": "long long", **_SUM, "streams": "int"})
LARGEST = Call(
    "lagrange_casadi_largest_call",
    {"designs": "long long", "n": "long long", "k": "long long", **_SUM},
)
"""Arguments of the functions of ``grids.c``, which describes each."""

Load = tuple[Array, Array, Array]
"""Station, constant and slope of what acts there: sections on its base side carry constant + slope
(station - u).
"""


@dataclass(frozen=True, eq=False)
class Functions:
    """Functions along a link, a row each, (terms, xi); the first is one everywhere."""

    rows: Array

    @cached_property
    def padded(self) -> tuple[Array, int]:
        """The rows with zeros up to a whole number of lines, and their address."""
        terms, k = self.rows.shape
        whole = empty("the functions along a link", (terms, -(-k // _LINE) * _LINE))
        whole[:, :k], whole[:, k:] = self.rows, 0.0
        return whole, whole.ctypes.data


@dataclass(frozen=True, eq=False)
class Columns:
    """Factors of a grid that change over time: ``columns``, which go with functions along the link,
    and ``loads``.

    With two ``planes`` there are as many columns and loads for each, one plane's after the other's,
    and the grid is the size of both sums.
    """

    columns: Sequence[Array]
    loads: Sequence[Load] = ()
    planes: int = 1

    @cached_property
    def arrays(self) -> list[Array]:
        """Columns and loads one after another, as C takes them."""
        return [
            np.ascontiguousarray(row, dtype=np.float64)
            for row in (*self.columns, *(row for load in self.loads for row in load))
        ]

    @cached_property
    def addresses(self) -> ctypes.Array[ctypes.c_void_p]:
        """Addresses of the arrays."""
        return (ctypes.c_void_p * len(self.arrays))(*(row.ctypes.data for row in self.arrays))

    @cached_property
    def members(self) -> dict[str, int]:
        """Members of a call of C."""
        columns, first = len(self.columns), ctypes.addressof(self.addresses)
        return {
            "planes": self.planes,
            "terms": columns // self.planes,
            "columns": first,
            "loads": (len(self.arrays) - columns) // (3 * self.planes),
            "acting": first + columns * ctypes.sizeof(ctypes.c_void_p),
        }

    @cached_property
    def call(self) -> ctypes.Structure:
        """The call of ``grids.c`` for a grid, whose other members are to be set: to copy a struct
        takes a tenth of the time to make one.
        """
        return GRID.type(**self.members)


Sum: TypeAlias = tuple[Columns, Functions]
"""Columns of a grid, and functions that go with them: as many, or more."""


def fill(
    sums: Sequence[Sum],
    u: Array,
    out: Array,
    threads: int | None = 1,
    slack: float = END["double"],
) -> None:
    """Fill grids ``out`` (sums, t, xi), each with the sum of columns (t) times functions (xi), and
    with what acts at load points.

    ``u`` are the ratios; ``slack`` is that of :func:`.edge`; ``threads`` is None for one a core.
    Raises :class:`DeclarationError` for an ``out`` of another shape.
    """
    n, k = sums[0][0].columns[0].size, u.size
    if out.shape != (len(sums), n, k):
        raise DeclarationError(f"out: expected an array of shape {(n, k)}, got {out.shape[1:]}")
    grid, most = out[0], max([len(columns.columns) for columns, _ in sums])
    plain = grid.flags.c_contiguous and out.dtype == np.float64
    library = _compiled() if plain and out.size >= WORTH_COMPILING and most <= _MOST else None
    if library is None:
        for (columns, functions), rows in zip(sums, out, strict=True):
            _fill_in_blocks(columns, functions.rows, u, rows, slack)
        return
    edges: Any = None
    place, apart, streams = out.ctypes.data, out.strides[0], int(grid.nbytes >= _STREAMING)
    calls = (GRID.type * len(sums))()
    for i, (columns, functions) in enumerate(sums):
        calls[i] = columns.call
        call, (rows, basis) = calls[i], functions.padded
        call.k, call.stride, call.basis = k, rows.shape[1], basis
        call.out, call.streams = place + i * apart, streams
        if columns.loads:
            if edges is None:
                u = np.ascontiguousarray(u, dtype=np.float64)
                edges = u, edge(u, slack)
            call.u, call.beyond = (row.ctypes.data for row in edges)
    entry, shares = library.lagrange_casadi_grids, out.size // _SHARE
    if shares <= 1:
        entry(calls, len(sums), 0, n)
        return
    shares = max(1, min(shares, n, threads or cores()))
    share = -(-n // shares)
    in_threads(lambda i: entry(calls, len(sums), i, min(i + share, n)), range(0, n, share), shares)


def largest(given: Sum, u: Array, slack: float = END["double"]) -> Array:
    """Over the instants of n designs the value largest in size at each ratio, with its sign: (n,
    xi).

    Columns and what loads consist of are (n, t), functions (terms, n, xi); see :func:`fill`. Of
    values of one size the positive one is given; a design whose columns or loads are not all finite
    has NaN.
    """
    columns, basis = given[0], given[1].rows
    n, t = columns.columns[0].shape
    out = np.empty((n, u.size))
    finite = np.all([np.isfinite(row).all(axis=1) for row in columns.arrays], axis=0)
    compile_it = t * out.size >= WORTH_COMPILING and len(columns.columns) <= _MOST
    library = _compiled() if compile_it else None
    if library is None:
        for i in range(n):
            grid = np.empty((t, u.size))
            design = Columns(
                [column[i] for column in columns.columns],
                [(a[i], b[i], c[i]) for a, b, c in columns.loads],
                columns.planes,
            )
            _fill_in_blocks(design, basis[:, i], u, grid, slack)
            high, low = grid.max(axis=0), grid.min(axis=0)
            out[i] = np.where(high >= -low, high, low)
    else:
        ratios = np.ascontiguousarray(u, dtype=np.float64)
        functions = np.ascontiguousarray(basis, dtype=np.float64).reshape(len(basis), -1)
        beyond = edge(ratios, slack)
        library.lagrange_casadi_largest(
            LARGEST.made(
                designs=n,
                n=t,
                k=u.size,
                stride=functions.shape[1],
                basis=functions.ctypes.data,
                u=ratios.ctypes.data,
                beyond=beyond.ctypes.data,
                out=out.ctypes.data,
                **columns.members,
            )
        )
    out[~finite] = np.nan
    return out


def empty(what: str, shape: tuple[int, ...], dtype: npt.DTypeLike = np.float64) -> Array:
    """An array to fill, from the start of a cache line: what crosses lines is stored at half the
    speed.

    Raises :class:`SizeError` where this machine has less memory than that.
    """
    require(what, shape)
    count = math.prod(shape)
    line = 8 * _LINE // np.dtype(dtype).itemsize
    capacity = np.empty(count + line, dtype)
    first = -capacity.ctypes.data // capacity.itemsize % line
    return capacity[first : first + count].reshape(shape)


def _fill_in_blocks(columns: Columns, basis: Array, u: Array, out: Array, slack: float) -> None:
    height, planes = max(1, _BLOCK // max(1, out.shape[1])), columns.planes
    terms, many = len(columns.columns) // planes, len(columns.loads) // planes
    for start in range(0, out.shape[0], height):
        block = slice(start, start + height)
        rows = out[block]
        for plane in range(planes):
            values = np.empty(rows.shape) if plane else rows
            _sum_up(
                [c[block] for c in columns.columns[plane * terms : (plane + 1) * terms]],
                basis,
                during(columns.loads[plane * many : (plane + 1) * many], block),
                u,
                values,
                slack,
            )
            if plane:
                np.sqrt(rows * rows + values * values, out=rows)


def _sum_up(
    columns: Sequence[Array],
    basis: Array,
    loads: Sequence[Load],
    u: Array,
    rows: Array,
    slack: float,
) -> None:
    rows[:] = columns[0][:, None]
    for column, function in zip(columns[1:], basis[1:], strict=False):
        rows += column[:, None] * function
    for load_point, constant, slope in loads:
        at = load_point[:, None]
        rows += np.where(edge(u, slack) < at, constant[:, None] + slope[:, None] * (at - u), 0.0)


@functools.cache
def _compiled() -> ctypes.CDLL | None:
    """The C functions, or None where there is no compiler that takes them."""
    macros = f"#define MOST {_MOST}\n#define LINE {_LINE}\n"
    source = macros + GRID.text() + LARGEST.text() + written("grids.c")
    try:
        compiler = find_compiler()
        if compiler is None:
            return None
        library = loaded(source, compiler, _OPTIONS)
    except CompilerError as error:
        warn(f"{error}; NumPy computes the section forces along links, more slowly: same values")
        return None
    some = (ctypes.c_longlong,) * 3
    GRID.declare(library.lagrange_casadi_grids, *some)
    LARGEST.declare(library.lagrange_casadi_largest)
    return library
