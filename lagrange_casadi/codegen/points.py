"""The C of single points: one function of a scene at a time, a place and a choice of its own each, one point after another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from importlib import resources
from typing import Any

import numpy as np
import numpy.typing as npt

from .calls import Call
from .compiler import Compiler, broken, loaded
from .emit import LANES_PLACE, START, dump, work

Array = npt.NDArray[np.float64]

POINTS = Call(
    "lagrange_casadi_points",
    {
        "n": "long long",
        "t": "const double*",
        "drives": "const double*",
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
"""What the C takes: n points, each with a time, drives, iterated coordinates, a ratio, and so on; and the parameters of all."""

_ENTRY = "lagrange_casadi_at_points"

_LOOP = """
/* n points: t[i], drives + i*{nd}, z + i*{nz}, xi[i], value[i], moving[i], and chosen[i], the number of what is meant; for
   parameters p. Of each found[i] becomes its value, rate[i] its derivative by time, slopes + i*{np} those by the parameters. */
LAGRANGE_CASADI_EXPORT void {entry}(const {call}* call) {{
  casadi_int i, iw[{iw}];
  double w[{w}], one[{many}];
  const double* arg[{arg}];
  double* res[{res}];
  memset(one, 0, sizeof one);
  for (i = 0; i < call->n; ++i) {{
    one[call->chosen[i]] = 1;
    arg[0] = call->t + i;
    arg[1] = call->drives + i*{nd};
    arg[2] = call->z + i*{nz};
    arg[3] = call->p;
    arg[4] = call->xi + i;
    arg[5] = call->value + i;
    arg[6] = call->moving + i;
    arg[7] = one;
    res[0] = call->found + i;
    res[1] = call->rate + i;
    res[2] = call->slopes + i*{np};
    at_point(arg, res, iw, w, 0);
    one[call->chosen[i]] = 0;
  }}
}}
"""


@dataclass(frozen=True, eq=False)
class PointsLibrary:
    """The loaded code of a function ``at_point(t, drives, z, p, xi, value, moving, chosen) -> (found, rate, slopes)``."""

    entry: Any

    def evaluate(self, given: dict[str, npt.NDArray[Any]], into: dict[str, Array]) -> None:
        """Fill ``into`` for the points that are ``given``, by the names of :data:`POINTS`."""
        arrays = given | into
        self.entry(POINTS.made(n=given["t"].size, **{name: array.ctypes.data for name, array in arrays.items()}))


def emit_points(function: Any) -> str:
    """The C of a function at points; the same text in every process."""
    sizes = {f"n{name[0]}": function.size1_in(name) for name in ("drives", "z", "p")}
    sizes |= {"many": max(1, function.size1_in("chosen"))}
    text = START + POINTS.text() + dump("points", [function])
    return text + _LOOP.format(entry=_ENTRY, call=POINTS.name, **sizes, **work("", function))


def load_points(function: Any, compiler: Compiler, extra: Sequence[str] = ()) -> PointsLibrary:
    """Build that, or take it from the cache, and load it. Raises :class:`CompilerError`."""
    source = emit_points(function)
    if compiler.language == "c++":
        source = source.replace(LANES_PLACE, resources.files(__package__).joinpath("lanes.h").read_text(), 1)
    library = loaded(source, compiler, tuple(extra))
    try:
        return PointsLibrary(POINTS.declare(getattr(library, _ENTRY)))
    except AttributeError as error:
        raise broken(compiler, error) from None
