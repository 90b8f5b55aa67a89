"""The C of a scene: CasADi's code for each function, and one function of ours that runs them over n instants."""

from __future__ import annotations

import casadi as ca

from ..scene import SceneGraph

ENTRY = "lagrange_casadi_evaluate"
NEWTON_STEPS = 50
NEWTON_DONE = 1e-9

NEWTON_RATE = 1e-2
NEWTON_ROUNDING = 1e-13

OK, NOT_CONVERGED, NOT_FINITE, SLOW = 0, 1, 2, 3
"""Status of an instant."""

_BATCH = """
/* n instants: t has n values, p the parameters; out is filled row by row, out[k*n + i] being column k at instant i.
   z holds the iterated loop coordinates: on entry the guess for the first instant, on return their last good values.
   status[i] is 0, or 1 where a loop did not converge, 2 where a value is not finite, 3 where a loop did not converge
   quadratically. */
CASADI_SYMBOL_EXPORT void {entry}(casadi_int n, const casadi_real* t, const casadi_real* p, casadi_real* z,
                                  casadi_real* out, int* status) {{
  casadi_int i, k, iw[{iw}];
  casadi_real d[{nd}], d_rate[{nd}], d_acceleration[{nd}], y[{ny}], w[{w}], finite;
  const casadi_real* arg[{arg}];
  casadi_real* res[{res}];
  for (i = 0; i < n; ++i) {{
    status[i] = {OK};
    arg[0] = t + i;
    arg[1] = p;
    res[0] = d;
    res[1] = d_rate;
    res[2] = d_acceleration;
    motion(arg, res, iw, w, 0);
{newton}    arg[0] = t + i;
    arg[1] = d;
    arg[2] = d_rate;
    arg[3] = d_acceleration;
    arg[4] = z;
    arg[5] = p;
    res[0] = y;
    instant(arg, res, iw, w, 0);
    finite = 0;
    for (k = 0; k < {columns}; ++k) {{
      out[k*n + i] = y[k];
      finite += y[k] - y[k];
    }}
    if (!(finite == 0) && status[i] == {OK}) status[i] = {NOT_FINITE};
  }}
}}
"""

_NEWTON = """    {{
      casadi_real correction[{nz}], last[{nz}], size = 1, before = 1;
      int step;
      for (k = 0; k < {nz}; ++k) last[k] = z[k];
      for (step = 0; step < {steps} && !(size < {done:.17g}); ++step) {{
        arg[0] = z;
        arg[1] = t + i;
        arg[2] = d;
        arg[3] = p;
        before = size;
        res[0] = correction;
        res[1] = &size;
        loops(arg, res, iw, w, 0);
        if (!(size - size == 0)) break;
        for (k = 0; k < {nz}; ++k) z[k] += correction[k];
      }}
      if (!(size < {done:.17g})) {{
        status[i] = {NOT_CONVERGED};
        for (k = 0; k < {nz}; ++k) z[k] = last[k];
      }} else if (size > {rate:.17g}*before && size > {rounding:.17g}) {{
        status[i] = {SLOW};
      }}
    }}
"""


def emit(graph: SceneGraph) -> str:
    """The whole C file of a scene; the same text in every process, on every machine, for the same version of CasADi."""
    functions = [graph.motion, graph.instant, *([graph.newton.step] if graph.newton else [])]
    generator = ca.CodeGenerator("scene", {"with_header": False})
    for function in functions:
        generator.add(function)
    nz = graph.instant.size1_in("z")
    codes = {"OK": OK, "NOT_CONVERGED": NOT_CONVERGED, "NOT_FINITE": NOT_FINITE, "SLOW": SLOW}
    limits = {"steps": NEWTON_STEPS, "done": NEWTON_DONE, "rate": NEWTON_RATE, "rounding": NEWTON_ROUNDING}
    newton = _NEWTON.format(nz=nz, **limits, **codes) if graph.newton else ""
    batch = _BATCH.format(
        entry=ENTRY,
        newton=newton,
        columns=len(graph.columns),
        nd=max(1, graph.instant.size1_in("d")),
        ny=max(1, len(graph.columns)),
        arg=max(f.sz_arg() for f in functions),
        res=max(f.sz_res() for f in functions),
        iw=max(1, *(f.sz_iw() for f in functions)),
        w=max(1, *(f.sz_w() for f in functions)),
        **codes,
    )
    return str(generator.dump()) + batch
