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
from importlib import resources

import numpy as np
import numpy.typing as npt

from ..base.arrays import Array
from ..base.space import require
from ..base.threads import in_threads
from ..codegen import find_compiler
from ..codegen.calls import Call
from ..codegen.compiler import loaded
from ..declare.limits import END
from ..equations.section_function import edge
from ..errors import CompilerError, DeclarationError, warn

WORTH_COMPILING = 1 << 14
"""Values from which on compiled code fills a grid."""

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
GRID = Call(
    "lagrange_casadi_grid_call", {"n": "long long", "k": "long long", **_SUM, "streams": "int"}
)
LARGEST = Call(
    "lagrange_casadi_largest_call",
    {"designs": "long long", "n": "long long", "k": "long long", **_SUM},
)
"""Arguments of the functions of ``grids.c``, which describes each."""

Load = tuple[Array, Array, Array]
"""Station, constant and slope of what acts there: sections on its base side carry constant + slope
(station - u).
"""


def fill(
    columns: Sequence[Array],
    basis: Array,
    loads: Sequence[Load],
    u: Array,
    out: Array,
    threads: int = 1,
    planes: int = 1,
    slack: float = END["double"],
) -> None:
    """Fill ``out`` (t, xi) with the sum of columns (t) times basis functions (xi), and with what
    acts at stations.

    The rows of ``basis`` are one or more, and ``columns`` as many; ``u`` are the ratios. With two
    ``planes`` there are as many columns for each, one plane's after the other's, as loads are, and
    ``out`` is the size of both sums. ``slack`` is that of :func:`.edge`. Raises
    :class:`DeclarationError` for an ``out`` of another shape.
    """
    if out.shape != (columns[0].size, u.size):
        raise DeclarationError(
            f"out: expected an array of shape {(columns[0].size, u.size)}, got {out.shape}"
        )
    plain = out.flags.c_contiguous and out.dtype == np.float64
    library = (
        _compiled() if plain and out.size >= WORTH_COMPILING and len(columns) <= _MOST else None
    )
    if library is None:
        _fill_in_blocks(columns, basis, loads, u, out, planes, slack)
        return
    n, k = out.shape
    functions = empty("the functions along a link", (len(basis), -(-k // _LINE) * _LINE))
    functions[:, :k], functions[:, k:] = basis, 0.0
    flat, ratios = _flat(columns, loads), np.ascontiguousarray(u, dtype=np.float64)
    beyond = edge(ratios, slack)
    shares = max(1, min(threads, out.size // _SHARE, n))
    size = -(-n // shares)

    def run(start: int) -> None:
        rows = (ctypes.c_void_p * len(flat))(
            *(row.ctypes.data + start * row.itemsize for row in flat)
        )
        here = _sum(len(columns), planes, rows, functions, ratios, beyond) | {
            "out": out[start:].ctypes.data
        }
        library.lagrange_casadi_grid(
            GRID.made(n=min(size, n - start), k=k, streams=int(out.nbytes >= _STREAMING), **here)
        )

    in_threads(run, range(0, n, size), shares)


def largest(
    columns: Sequence[Array],
    basis: Array,
    loads: Sequence[Load],
    u: Array,
    planes: int = 1,
    slack: float = END["double"],
) -> Array:
    """Over the instants of n designs the value largest in size at each ratio, with its sign: (n,
    xi).

    ``columns`` and what ``loads`` consist of are (n, t), ``basis`` is (terms, n, xi); see
    :func:`fill`. Of values of one size the positive one is given; a design whose columns or loads
    are not all finite has NaN.
    """
    n, t = columns[0].shape
    out = np.empty((n, u.size))
    finite = np.all(
        [
            np.isfinite(row).all(axis=1)
            for row in (*columns, *(row for load in loads for row in load))
        ],
        axis=0,
    )
    library = _compiled() if t * out.size >= WORTH_COMPILING and len(columns) <= _MOST else None
    if library is None:
        for i in range(n):
            grid = np.empty((t, u.size))
            acting = [(a[i], b[i], c[i]) for a, b, c in loads]
            _fill_in_blocks(
                [column[i] for column in columns], basis[:, i], acting, u, grid, planes, slack
            )
            high, low = grid.max(axis=0), grid.min(axis=0)
            out[i] = np.where(high >= -low, high, low)
        out[~finite] = np.nan
        return out
    flat, ratios = _flat(columns, loads), np.ascontiguousarray(u, dtype=np.float64)
    functions = np.ascontiguousarray(basis, dtype=np.float64).reshape(len(basis), -1)
    rows = (ctypes.c_void_p * len(flat))(*(array.ctypes.data for array in flat))
    beyond = edge(ratios, slack)
    whole = _sum(len(columns), planes, rows, functions, ratios, beyond) | {"out": out.ctypes.data}
    library.lagrange_casadi_largest(LARGEST.made(designs=n, n=t, k=u.size, **whole))
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


def _flat(columns: Sequence[Array], loads: Sequence[Load]) -> list[Array]:
    """Columns and loads one after another, as C takes them."""
    return [
        np.ascontiguousarray(row, dtype=np.float64)
        for row in (*columns, *(row for load in loads for row in load))
    ]


def _sum(
    columns: int,
    planes: int,
    rows: ctypes.Array[ctypes.c_void_p],
    functions: Array,
    ratios: Array,
    beyond: Array,
) -> dict[str, int]:
    """Arguments of a call: ``rows`` are the addresses of the columns, so many, and of the loads'
    parts; functions have a row each.
    """
    first = ctypes.addressof(rows)
    return {
        "planes": planes,
        "terms": columns // planes,
        "columns": first,
        "stride": functions.shape[1],
        "basis": functions.ctypes.data,
        "loads": (len(rows) - columns) // (3 * planes),
        "acting": first + columns * ctypes.sizeof(ctypes.c_void_p),
        "u": ratios.ctypes.data,
        "beyond": beyond.ctypes.data,
    }


def _fill_in_blocks(
    columns: Sequence[Array],
    basis: Array,
    loads: Sequence[Load],
    u: Array,
    out: Array,
    planes: int,
    slack: float,
) -> None:
    height = max(1, _BLOCK // max(1, out.shape[1]))
    terms, many = len(columns) // planes, len(loads) // planes
    for start in range(0, out.shape[0], height):
        block = slice(start, start + height)
        rows = out[block]
        for plane in range(planes):
            values = np.empty(rows.shape) if plane else rows
            terms_here = [column[block] for column in columns[plane * terms : (plane + 1) * terms]]
            _sum_up(
                terms_here,
                basis,
                [_cut(load, block) for load in loads[plane * many : (plane + 1) * many]],
                u,
                values,
                slack,
            )
            if plane:
                np.sqrt(rows * rows + values * values, out=rows)


def _cut(load: Load, block: slice) -> Load:
    load_point, constant, slope = load
    return load_point[block], constant[block], slope[block]


def _sum_up(
    columns: Sequence[Array],
    basis: Array,
    loads: Sequence[Load],
    u: Array,
    rows: Array,
    slack: float,
) -> None:
    np.multiply(columns[0][:, None], basis[0], out=rows)
    for column, function in zip(columns[1:], basis[1:], strict=True):
        rows += column[:, None] * function
    for load_point, constant, slope in loads:
        at = load_point[:, None]
        rows += np.where(edge(u, slack) < at, constant[:, None] + slope[:, None] * (at - u), 0.0)


@functools.cache
def _compiled() -> ctypes.CDLL | None:
    """The C functions, or None where there is no compiler that takes them."""
    functions = resources.files("lagrange_casadi.codegen").joinpath("grids.c").read_text()
    source = (
        f"#define MOST {_MOST}\n#define LINE {_LINE}\n" + GRID.text() + LARGEST.text() + functions
    )
    try:
        compiler = find_compiler()
        if compiler is None:
            return None
        library = loaded(source, compiler, _OPTIONS)
    except CompilerError as error:
        warn(f"{error}; NumPy fills the grids")
        return None
    for name, call in (("lagrange_casadi_grid", GRID), ("lagrange_casadi_largest", LARGEST)):
        call.declare(getattr(library, name))
    return library
