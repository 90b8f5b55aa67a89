"""The C of a scene: CasADi's code for each function, and functions of ours that run them over instants.

One file serves two compilers. As C every value is a double. As C++, with ``lanes.h`` put before it, what is done for each instant
is done for a pack of instants at once; what depends on the instant before (iterated loops), or is read from a table (a spline),
stays with doubles.
"""

from __future__ import annotations

import re

import casadi as ca

from ..scene import SceneGraph
from .split import split

EVALUATE, FOLLOW = "lagrange_casadi_evaluate", "lagrange_casadi_follow"
NEWTON_STEPS = 50
NEWTON_DONE = 1e-9

NEWTON_RATE = 1e-2
NEWTON_ROUNDING = 1e-13

OK, NOT_CONVERGED, NOT_FINITE, SLOW = 0, 1, 2, 3
"""Status of an instant."""

_LARGEST_BLOCK = 32768
_BLOCK = 64

_START = """\
#include <string.h>
#ifdef LANES
#define LAGRANGE_CASADI_C extern "C"
#else
#define LANES 1
#define LAGRANGE_CASADI_C
#define lanes_pack double
#define lanes_choose(where, a) ((where) ? (a) : 0)
#define lanes_sign(x) ((x) < 0 ? -1 : (x) > 0 ? 1 : (x))
#endif
#ifdef __GNUC__
#define LAGRANGE_CASADI_EXPORT LAGRANGE_CASADI_C __attribute__((visibility("default")))
#define LAGRANGE_CASADI_PART __attribute__((noinline))
#else
#define LAGRANGE_CASADI_PART
#define LAGRANGE_CASADI_EXPORT LAGRANGE_CASADI_C CASADI_SYMBOL_EXPORT
#endif
"""

_WIDE = """
#undef CASADI_PREFIX
#undef casadi_real
#define casadi_real lanes_pack
"""

_EVALUATE = """
/* n instants t, for parameters p. out[k*stride + i] becomes column k at instant i, z[k*stride + i] is iterated coordinate k there.
   status[i], 0 where there is nothing to say against the instant, becomes {NOT_FINITE} where a value is not finite. */
LAGRANGE_CASADI_EXPORT void {evaluate}(casadi_int n, casadi_int stride, const double* t, const double* p, const double* z,
                                       double* out, int* status) {{
  casadi_int first, i, j, k, size, many, iw[{iw}];
  double block[{rows}][{block}], finite[{block}], lanes[LANES];
  casadi_real at[{inputs}], y[{rows}], w[{w}];
  casadi_real *time = at, *d = at + 1, *place = d + 3*{nd}, *parameters = place + {nz};
  const casadi_real* arg[{arg}];
  casadi_real* res[{res}];
  for (k = 0; k < {np}; ++k) parameters[k] = p[k];
  for (first = 0; first < n; first += {block}) {{
    size = n - first < {block} ? n - first : {block};
    for (i = 0; i < size; i += LANES) {{
      /* The last pack of all is filled up with its last instant. */
      many = size - i < LANES ? size - i : LANES;
      for (j = 0; j < LANES; ++j) lanes[j] = t[first + i + (j < many ? j : many - 1)];
      memcpy(time, lanes, sizeof lanes);
      for (k = 0; k < {nz}; ++k) {{
        for (j = 0; j < LANES; ++j) lanes[j] = z[k*stride + first + i + (j < many ? j : many - 1)];
        memcpy(place + k, lanes, sizeof lanes);
      }}
{motion}      arg[0] = time;
      arg[1] = d;
      arg[2] = d + {nd};
      arg[3] = d + 2*{nd};
      arg[4] = place;
      arg[5] = parameters;
      res[0] = y;
      instant(arg, res, iw, w, 0);
      for (k = 0; k < {columns}; ++k) memcpy(&block[k][i], y + k, sizeof lanes);
    }}
    for (i = 0; i < size; ++i) finite[i] = 0;
    for (k = 0; k < {columns}; ++k) {{
      for (i = 0; i < size; ++i) finite[i] += block[k][i] - block[k][i];
      memcpy(out + k*stride + first, block[k], (size_t) size*sizeof(double));
    }}
    for (i = 0; i < size; ++i) if (!(finite[i] == 0) && status[first + i] == {OK}) status[first + i] = {NOT_FINITE};
  }}
}}
"""

_SMOOTH = """      arg[0] = time;
      arg[1] = parameters;
      res[0] = d;
      res[1] = d + {nd};
      res[2] = d + 2*{nd};
      motion(arg, res, iw, w, 0);
"""

_SPLINE = """      {{
        double drive[3*{nd}], narrow_w[{motion_w}];
        double lane[3*{nd}][LANES];
        for (j = 0; j < LANES; ++j) {{
          const double* narrow_arg[{motion_arg}];
          double* narrow_res[{motion_res}];
          memcpy(lanes, time, sizeof lanes);
          narrow_arg[0] = lanes + j;
          narrow_arg[1] = p;
          narrow_res[0] = drive;
          narrow_res[1] = drive + {nd};
          narrow_res[2] = drive + 2*{nd};
          motion(narrow_arg, narrow_res, iw, narrow_w, 0);
          for (k = 0; k < 3*{nd}; ++k) lane[k][j] = drive[k];
        }}
        memcpy(d, lane, sizeof lane);
      }}
"""

_FOLLOW = """
/* Iterated loops, each instant from the one before: z[k*stride + i] becomes coordinate k at instant i, and guess, on entry that for
   the first instant, the last good one. status[i] becomes {OK}, or {NOT_CONVERGED} where a loop did not converge, {SLOW} where not
   quadratically. */
LAGRANGE_CASADI_EXPORT void {follow}(casadi_int n, casadi_int stride, const double* t, const double* p, double* guess, double* z,
                                     int* status) {{
  casadi_int i, k, step, iw[{iw}];
  double correction[{nz}], at[{nz}], w[{w}], size, before;
  const double* arg[{arg}];
  double* res[{res}];
  for (i = 0; i < n; ++i) {{
    size = before = 1;
    for (k = 0; k < {nz}; ++k) at[k] = guess[k];
    for (step = 0; step < {steps} && !(size < {done:.17g}); ++step) {{
      arg[0] = at;
      arg[1] = t + i;
      arg[2] = p;
      before = size;
      res[0] = correction;
      res[1] = &size;
      loops(arg, res, iw, w, 0);
      if (!(size - size == 0)) break;
      for (k = 0; k < {nz}; ++k) at[k] += correction[k];
    }}
    status[i] = !(size < {done:.17g}) ? {NOT_CONVERGED} : size > {rate:.17g}*before && size > {rounding:.17g} ? {SLOW} : {OK};
    for (k = 0; k < {nz}; ++k) {{
      if (status[i] != {NOT_CONVERGED}) guess[k] = at[k];
      z[k*stride + i] = guess[k];
    }}
  }}
}}
"""


def emit(graph: SceneGraph) -> str:
    """The whole C file of a scene; the same text in every process, on every machine, for the same version of CasADi."""
    smooth = bool(graph.motion.is_a("SXFunction"))
    loops = _loops(graph, smooth)
    narrow = [*([loops] if loops else []), *([] if smooth else [graph.motion])]
    wide = [*([graph.motion] if smooth else []), graph.instant]
    columns, nz, nd = len(graph.columns), graph.instant.size1_in("z"), graph.instant.size1_in("d")
    block = _BLOCK
    while block > 8 and 8 * block * columns > _LARGEST_BLOCK:
        block //= 2
    codes = {"OK": OK, "NOT_CONVERGED": NOT_CONVERGED, "NOT_FINITE": NOT_FINITE, "SLOW": SLOW}
    motion = _SMOOTH.format(nd=nd) if smooth else _SPLINE.format(nd=nd, **_work("motion_", graph.motion))
    np = graph.instant.size1_in("p")
    text = _START
    if narrow:
        text += _dump("follow", narrow)
    if loops:
        limits = {"steps": NEWTON_STEPS, "done": NEWTON_DONE, "rate": NEWTON_RATE, "rounding": NEWTON_ROUNDING}
        text += _FOLLOW.format(follow=FOLLOW, nz=nz, **limits, **codes, **_work("", loops))
    text += _WIDE + _dump("scene", wide)
    sizes = {
        "columns": columns,
        "rows": max(1, columns),
        "nz": nz,
        "nd": nd,
        "np": np,
        "block": block,
        "inputs": max(1, 1 + 3 * nd + nz + np),
    }
    return text + _EVALUATE.format(evaluate=EVALUATE, motion=motion if nd else "", **sizes, **codes, **_work("", *wide, *narrow))


def _loops(graph: SceneGraph, smooth: bool) -> ca.Function | None:
    """One Newton step from the time alone: ``loops(z, t, p) -> (correction, size)``."""
    if graph.newton is None:
        return None
    inputs = [ca.MX.sym(name, graph.instant.size1_in(name)) for name in ("z", "t", "p")]
    z, t, p = inputs
    step = ca.Function("loops", inputs, graph.newton.step(z, t, graph.motion(t, p)[0], p))
    return step.expand() if smooth else step


def _dump(name: str, functions: list[ca.Function]) -> str:
    generator = ca.CodeGenerator(name, {"with_header": False})
    for function in functions:
        generator.add(function)
    text = re.sub(r"\((a\d+)\?(a\d+):0\)", r"lanes_choose(\1,\2)", str(generator.dump()))
    text = re.sub(r"if \(res\[(\d+)\]!=0\) ", "", text)
    text = re.sub(r"arg\[(\d+)\]\? (arg\[\1\]\[\d+\]) : 0", r"\2", text)
    text = split(text)
    return text.replace("return x<0 ? -1 : x>0 ? 1 : x;", "return lanes_sign(x);")


def _work(prefix: str, *functions: ca.Function) -> dict[str, int]:
    """The largest sizes of the working arrays of some functions."""
    sizes = {name: max(getattr(f, f"sz_{name}")() for f in functions) for name in ("arg", "res", "iw", "w")}
    return {f"{prefix}{name}": max(1, size) for name, size in sizes.items()}
