"""The C of one function at many points, for packs of points at once: each of its arguments has a
row for every point, for every few, or one for all.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from .calls import Call
from .compiler import WIDE, Compiler, entry_of, loaded, start
from .printer import print_functions

if TYPE_CHECKING:
    import casadi as ca

CHOSEN = "chosen"
"""The argument that is a row of a unit matrix; the number of the row is given in its place."""

_ENTRY = "lagrange_casadi_batch"

_LOOP = """
/* n points. Of each argument NAME the row of point i is NAME + i/NAME_every times its size, the
   first where NAME_every is 0. */
static casadi_int row(casadi_int i, long long every) {{
  return every > 1 ? i/every : every*i;
}}

LAGRANGE_CASADI_EXPORT void {entry}(const {call}* call) {{
  casadi_int i, j, k, of;
  double lane[{given} + 1][LANES], rows[{found}][LANES];
  casadi_real at[{given} + 1], y[{found}];
  const casadi_real* arg[{many}];
  casadi_real* res[1];
  memset(lane, 0, sizeof lane);
{arguments}
  res[0] = y;
  for (i = 0; i < call->n; i += LANES) {{
    for (j = 0; j < LANES; ++j) {{
      /* The last pack is filled up with the last point. */
      of = i + j < call->n ? i + j : call->n - 1;
{rows}
    }}
    memcpy(at, lane, sizeof lane);
    at_once(arg, res);
    memcpy(rows, y, sizeof rows);
    for (j = 0; j < LANES; ++j) {{
      of = i + j < call->n ? i + j : call->n - 1;
      for (k = 0; k < {found}; ++k) call->found[of*{found} + k] = rows[k][j];{cleared}
    }}
  }}
}}
"""
_ROW = (
    "      for (k = 0; k < {size}; ++k)"
    " lane[{first} + k][j] = call->{name}[row(of, call->{name}_every)*{size} + k];"
)
_ONE = "lane[{first} + call->{name}[row(of, call->{name}_every)]][j] = {value};"


@dataclass(frozen=True, eq=False)
class BatchLibrary:
    """The loaded code of a function ``at_once``, whose arguments and result are dense columns."""

    call: Call
    entry: Any

    def evaluate(
        self, n: int, given: Mapping[str, tuple[npt.NDArray[np.generic], int]], into: Array
    ) -> None:
        """Fill ``into`` (n, result) for n points: of each argument, by name, its rows and for how
        many points one is.
        """
        arrays = {
            name: np.ascontiguousarray(rows, np.intc if name == CHOSEN else float)
            for name, (rows, _) in given.items()
        }
        self.bound(n, arrays, {name: each for name, (_, each) in given.items()}, into)()

    def bound(
        self, n: int, arrays: Mapping[str, Array], every: Mapping[str, int], into: Array
    ) -> Callable[[], None]:
        """Return a function that does so for what is in the ``arrays`` when it is called."""
        pointers = {name: array.ctypes.data for name, array in arrays.items()}
        each = {f"{name}_every": number for name, number in every.items()}
        return partial(self.entry, self.call.made(n=n, **pointers, **each, found=into.ctypes.data))


def _call(function: ca.Function) -> Call:
    members = {"n": "long long"}
    for name in function.name_in():
        members |= {
            name: "const int*" if name == CHOSEN else "const double*",
            f"{name}_every": "long long",
        }
    return Call("lagrange_casadi_batch_call", members | {"found": "double*"})


def emit_batch(function: ca.Function) -> str:
    """The C of a function of one output at many points; the same text in every process."""
    arguments, rows, cleared, first = list[str](), list[str](), "", 0
    for k, name in enumerate(function.name_in()):
        arguments.append(f"  arg[{k}] = at + {first};")
        size = function.numel_in(k)
        if name == CHOSEN:
            rows.append(f"      {_ONE.format(first=first, name=name, value=1)}")
            cleared = f"\n      {_ONE.format(first=first, name=name, value=0)}"
        else:
            rows.append(_ROW.format(first=first, name=name, size=size))
        first += size
    call = _call(function)
    text = (
        start("double")
        + call.text()
        + WIDE
        + print_functions({"at_once": function}, "double", prefix="batch", packs=True)
    )
    return text + _LOOP.format(
        entry=_ENTRY,
        call=call.name,
        given=first,
        found=function.numel_out(0),
        many=len(arguments),
        arguments="\n".join(arguments),
        rows="\n".join(rows),
        cleared=cleared,
    )


def load_batch(
    function: ca.Function, compiler: Compiler, extra: Sequence[str] = ()
) -> BatchLibrary:
    """Build that, or take it from the cache, and load it. Raises :class:`CompilerError`."""
    library, call = loaded(emit_batch(function), compiler, tuple(extra)), _call(function)
    return BatchLibrary(call, call.declare(entry_of(library, _ENTRY, compiler)))
