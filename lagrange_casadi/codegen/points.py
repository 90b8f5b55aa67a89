"""The C of single points: one function of a scene at a time, a place and a choice of its own each,
for packs of points at once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy.typing as npt

from ..base.arrays import Array
from .calls import Call
from .compiler import Compiler, broken, loaded, packed
from .emit import START, WIDE
from .printer import print_functions

POINTS = Call(
    "lagrange_casadi_points",
    {
        "n": "long long",
        "t": "const double*",
        "z": "const double*",
        "p": "const double*",
        "xi": "const double*",
        "value": "const double*",
        "moving": "const double*",
        "chosen": "const int*",
        "found": "double*",
        "rate": "double*",
        "slopes": "double*",
    },
)
"""Arguments of the C: n points, each with a time, iterated coordinates, a ratio, and so on; and the
parameters of all.
"""

_ENTRY = "lagrange_casadi_at_points"

_LOOP = """
/* n points: t[i], z + i*{nz}, xi[i], value[i], moving[i], and chosen[i], the number of what is
   meant; for parameters p. Of each found[i] becomes its value, rate[i] its derivative by time,
   slopes + i*{np} those by the parameters. */
LAGRANGE_CASADI_EXPORT void {entry}(const {call}* call) {{
  casadi_int i, j, k, of;
  double lane[{own}][LANES], one[{many}][LANES], told[2 + {np}][LANES];
  casadi_real at[{own}], p[{np} + 1], meant[{many}], y[2 + {np}];
  const casadi_real* arg[7];
  casadi_real* res[3];
  memset(one, 0, sizeof one);
  for (k = 0; k < {np}; ++k) p[k] = call->p[k];
  for (i = 0; i < call->n; i += LANES) {{
    for (j = 0; j < LANES; ++j) {{
      /* The last pack is filled up with the last point. */
      of = i + j < call->n ? i + j : call->n - 1;
      lane[0][j] = call->t[of];
      lane[1][j] = call->xi[of];
      lane[2][j] = call->value[of];
      lane[3][j] = call->moving[of];
      for (k = 0; k < {nz}; ++k) lane[4 + k][j] = call->z[of*{nz} + k];
      one[call->chosen[of]][j] = 1;
    }}
    memcpy(at, lane, sizeof lane);
    memcpy(meant, one, sizeof one);
    arg[0] = at;
    arg[1] = at + 4;
    arg[2] = p;
    arg[3] = at + 1;
    arg[4] = at + 2;
    arg[5] = at + 3;
    arg[6] = meant;
    res[0] = y;
    res[1] = y + 1;
    res[2] = y + 2;
    at_point(arg, res);
    memcpy(told, y, sizeof told);
    for (j = 0; j < LANES && i + j < call->n; ++j) {{
      call->found[i + j] = told[0][j];
      call->rate[i + j] = told[1][j];
      for (k = 0; k < {np}; ++k) call->slopes[(i + j)*{np} + k] = told[2 + k][j];
    }}
    for (j = 0; j < LANES; ++j) one[call->chosen[i + j < call->n ? i + j : call->n - 1]][j] = 0;
  }}
}}
"""


@dataclass(frozen=True, eq=False)
class PointsLibrary:
    """The loaded code of a function ``at_point(t, z, p, xi, value, moving, chosen) -> (found, rate,
    slopes)``.
    """

    entry: Any

    def evaluate(self, given: dict[str, npt.NDArray[Any]], into: dict[str, Array]) -> None:
        """Fill ``into`` for the points that are ``given``, by the names of :data:`POINTS`."""
        arrays = given | into
        self.entry(
            POINTS.made(
                n=given["t"].size, **{name: array.ctypes.data for name, array in arrays.items()}
            )
        )


def emit_points(function: Any) -> str:
    """The C of a function at points; the same text in every process."""
    sizes = {f"n{name[0]}": function.size1_in(name) for name in ("z", "p")}
    sizes |= {"many": max(1, function.size1_in("chosen")), "own": 4 + sizes["nz"]}
    text = (
        START
        + POINTS.text()
        + WIDE
        + print_functions({"at_point": function}, "double", prefix="point", packs=True)
    )
    return text + _LOOP.format(entry=_ENTRY, call=POINTS.name, **sizes)


def load_points(function: Any, compiler: Compiler, extra: Sequence[str] = ()) -> PointsLibrary:
    """Build that, or take it from the cache, and load it. Raises :class:`CompilerError`."""
    source = packed(emit_points(function), compiler)
    library = loaded(source, compiler, tuple(extra))
    try:
        return PointsLibrary(POINTS.declare(getattr(library, _ENTRY)))
    except AttributeError as error:
        raise broken(compiler, error) from None
