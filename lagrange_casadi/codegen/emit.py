"""The C of a scene: CasADi's code for each function, and functions of ours that run them over instants.

One file serves two compilers. As C every value is a double. As C++, with ``lanes.h`` put before it, what is done for each instant
is done for a pack of instants at once; what depends on the instant before (iterated loops), or is read from a table (a spline),
stays with doubles.
"""

from __future__ import annotations

import re

import casadi as ca

from ..scene_graph import SceneGraph
from .split import split

EVALUATE, FOLLOW = "lagrange_casadi_evaluate", "lagrange_casadi_follow"
NEWTON_STEPS = 50
NEWTON_DONE = 1e-9

NEWTON_RATE = 1e-2
NEWTON_ROUNDING = 1e-13

OK, NOT_CONVERGED, NOT_FINITE, SLOW = 0, 1, 2, 3
"""Status of an instant."""

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
  casadi_int i, j, k, many, iw[{iw}];
  double lanes[LANES];
  casadi_real at[{inputs}], y[{rows}], w[{w}], sum[4];
  casadi_real *time = at, *d = at + 1, *place = d + 3*{nd}, *parameters = place + {nz}, *constants = parameters + {np};
  const casadi_real* arg[{arg}];
  casadi_real* res[{res}];
  for (k = 0; k < {np}; ++k) parameters[k] = p[k];
  arg[0] = parameters;
  res[0] = constants;
  constants_of(arg, res, iw, w, 0);
  for (i = 0; i < n; i += LANES) {{
    many = n - i < LANES ? n - i : LANES;
    if (many == LANES) {{
      memcpy(time, t + i, sizeof lanes);
      for (k = 0; k < {nz}; ++k) memcpy(place + k, z + k*stride + i, sizeof lanes);
    }} else {{
      /* The last pack is filled up with the last instant. */
      for (j = 0; j < LANES; ++j) lanes[j] = t[i + (j < many ? j : many - 1)];
      memcpy(time, lanes, sizeof lanes);
      for (k = 0; k < {nz}; ++k) {{
        for (j = 0; j < LANES; ++j) lanes[j] = z[k*stride + i + (j < many ? j : many - 1)];
        memcpy(place + k, lanes, sizeof lanes);
      }}
    }}
{motion}    arg[0] = time;
    arg[1] = d;
    arg[2] = d + {nd};
    arg[3] = d + 2*{nd};
    arg[4] = place;
    arg[5] = constants;
    res[0] = y;
    instant(arg, res, iw, w, 0);
    if (many == LANES) {{
      for (k = 0; k < {columns}; ++k) memcpy(out + k*stride + i, y + k, sizeof lanes);
    }} else {{
      for (k = 0; k < {columns}; ++k) memcpy(out + k*stride + i, y + k, (size_t) many*sizeof(double));
    }}
    /* One value that is not finite makes their sum so; four sums, for each addition waits for the one before. */
    for (j = 0; j < 4; ++j) sum[j] = 0;
    for (k = 0; k + 4 <= {columns}; k += 4) {{
      for (j = 0; j < 4; ++j) sum[j] = sum[j] + y[k + j];
    }}
    for (; k < {columns}; ++k) sum[0] = sum[0] + y[k];
    sum[0] = (sum[0] + sum[1]) + (sum[2] + sum[3]);
    memcpy(lanes, sum, sizeof lanes);
    for (j = 0; j < many; ++j) if (!(lanes[j] - lanes[j] == 0) && status[i + j] == {OK}) status[i + j] = {NOT_FINITE};
  }}
}}
"""

_SMOOTH = """    arg[0] = time;
    arg[1] = parameters;
    res[0] = d;
    res[1] = d + {nd};
    res[2] = d + 2*{nd};
    motion(arg, res, iw, w, 0);
"""

_SPLINE = """    {{
      double drive[3*{nd}], narrow_w[{motion_w}];
      double lane[3*{nd}][LANES];
      memcpy(lanes, time, sizeof lanes);
      for (j = 0; j < LANES; ++j) {{
        const double* narrow_arg[{motion_arg}];
        double* narrow_res[{motion_res}];
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
    constants, instant = _hoisted(graph.instant)
    wide = [*([graph.motion] if smooth else []), constants, instant]
    columns, nz, nd = len(graph.columns), graph.instant.size1_in("z"), graph.instant.size1_in("d")
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
        "inputs": 1 + 3 * nd + nz + np + constants.size1_out(0),
    }
    return text + _EVALUATE.format(evaluate=EVALUATE, motion=motion if nd else "", **sizes, **codes, **_work("", *wide, *narrow))


def _hoisted(instant: ca.Function) -> tuple[ca.Function, ca.Function]:
    """What of an instant depends on parameters alone, ``constants_of(p) -> c``, and the instant with c for p."""
    inputs = instant.sx_in()
    rest, symbols, constants = ca.extract_parametric(instant(*inputs), inputs[-1], {"extract_trivial": True})
    c = ca.vertcat(ca.SX(0, 1), *symbols)
    hoisted = ca.Function("constants_of", [inputs[-1]], [ca.densify(ca.vertcat(ca.SX(0, 1), *constants))], {"cse": True})
    return hoisted, ca.Function("instant", [*inputs[:-1], c], [ca.densify(rest)], {"cse": True})


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
