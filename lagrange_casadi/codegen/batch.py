"""The C of one function at many points: each of its arguments has a row for every point, for every
few, or one for all.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..base.arrays import Array
from .calls import Call
from .compiler import Compiler, broken, loaded, packed
from .emit import START
from .printer import print_functions

_ENTRY = "lagrange_casadi_batch"

_LOOP = """
/* n points. Of each argument NAME the row of point i is NAME + i/NAME_every times its size, the
   first where NAME_every is 0. */
LAGRANGE_CASADI_EXPORT void {entry}(const {call}* call) {{
  casadi_int i;
  const double* arg[{arg}];
  double* res[1];
  for (i = 0; i < call->n; ++i) {{
{lines}
    at_once(arg, res);
  }}
}}
"""


@dataclass(frozen=True, eq=False)
class BatchLibrary:
    """The loaded code of a function ``at_once``, whose arguments and result are dense columns."""

    function: Any
    call: Call
    entry: Any

    def evaluate(self, n: int, given: Mapping[str, tuple[Array, int]], into: Array) -> None:
        """Fill ``into`` (n, result) for n points: of each argument, by name, its rows and for how
        many points one is.
        """
        arrays = {name: np.ascontiguousarray(rows, float) for name, (rows, _) in given.items()}
        every = {f"{name}_every": each for name, (_, each) in given.items()}
        pointers = {name: array.ctypes.data for name, array in arrays.items()}
        self.entry(self.call.made(n=n, **pointers, **every, found=into.ctypes.data))


def _names(function: Any) -> list[str]:
    return [function.name_in(k) for k in range(function.n_in())]


def _call(function: Any) -> Call:
    members = {"n": "long long"}
    for name in _names(function):
        members |= {name: "const double*", f"{name}_every": "long long"}
    return Call("lagrange_casadi_batch_call", members | {"found": "double*"})


def emit_batch(function: Any) -> str:
    """The C of a function of one output at many points; the same text in every process."""
    lines = [
        f"    arg[{k}] = call->{name} + (call->{name}_every ? i/call->{name}_every :"
        f" 0)*{function.numel_in(k)};"
        for k, name in enumerate(_names(function))
    ]
    lines.append(f"    res[0] = call->found + i*{function.numel_out(0)};")
    call = _call(function)
    text = START + call.text() + print_functions({"at_once": function}, "double", prefix="batch")
    return text + _LOOP.format(
        entry=_ENTRY, call=call.name, lines="\n".join(lines), arg=len(_names(function))
    )


def load_batch(function: Any, compiler: Compiler, extra: Sequence[str] = ()) -> BatchLibrary:
    """Build that, or take it from the cache, and load it. Raises :class:`CompilerError`."""
    source = packed(emit_batch(function), compiler)
    library, call = loaded(source, compiler, tuple(extra)), _call(function)
    try:
        return BatchLibrary(function, call, call.declare(getattr(library, _ENTRY)))
    except AttributeError as error:
        raise broken(compiler, error) from None
