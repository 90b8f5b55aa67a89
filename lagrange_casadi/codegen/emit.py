"""The C of a scene: each function of its graph, and functions that run them over instants.

One file serves two compilers. As C every value is a double. As C++, with ``lanes.h`` put before it,
what is done for each instant is done for a pack of instants at once; what depends on the instant
before (iterated loops) stays with doubles.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca

from ..base.status import Status
from ..base.symbolic import symbolic
from ..base.vocabulary import Precision
from ..equations.program import Program
from .calls import Call
from .compiler import LANES_PLACE
from .printer import function_name, literal, print_functions
from .stages import Stages, plain

EVALUATE, FOLLOW = "lagrange_casadi_evaluate", "lagrange_casadi_follow"
NEWTON_STEPS = 50
NEWTON_DONE, NEWTON_DONE_SINGLE = 1e-9, 1e-4
"""A correction after which the next one would be rounding."""

NEWTON_RATE, NEWTON_RATE_SINGLE = 1e-2, 0.25
"""Least ratio of one correction to the one before from which corrections shrink too slowly to be
quadratic. At a dead centre it is 1/2; if corrections end early, as in single precision, their
square is not far below them.
"""

NEWTON_ROUNDING, NEWTON_ROUNDING_SINGLE = 1e-13, 1e-5
NEWTON_LOST = 0.1
"""A last correction, of a fixed number, after which nothing is known."""

INSTANTS = Call(
    "lagrange_casadi_instants",
    {
        "n": "long long",
        "stride": "long long",
        "t": "const real*",
        "p": "const real*",
        "guess": "real*",
        "z": "real*",
        "out": "real*",
        "apart": "long long",
        "status": "int*",
    },
)
"""Arguments of :data:`EVALUATE` and :data:`FOLLOW`; the C says which it reads and writes."""

START = f"""\
{LANES_PLACE}#include <math.h>
#include <string.h>
#define casadi_int long long
#ifndef casadi_real
#define casadi_real double
#endif
#ifdef LANES
#define LAGRANGE_CASADI_C extern "C"
#else
#define LANES 1
#define LANES_INLINE static inline
#define LAGRANGE_CASADI_C
#ifdef LANES_SINGLE
#define lanes_real float
#else
#define lanes_real double
#endif
#define lanes_pack lanes_real
#define lanes_choose(where, a) ((where) ? (a) : 0)
#define lanes_sign(x) ((x) < 0 ? -1 : (x) > 0 ? 1 : (x))
#define lanes_less(x, y, a, b) ((x) < (y) ? (a) : (b))
#define lanes_larger(x, y) ((x) < (y) ? (y) : (x))
#define lanes_where_less(x, y) ((x) < (y))
#define lanes_any_nan(x) ((x) != (x))
#endif
#ifdef __GNUC__
#define LAGRANGE_CASADI_EXPORT LAGRANGE_CASADI_C __attribute__((visibility("default")))
#define LAGRANGE_CASADI_PART __attribute__((noinline))
#else
#define LAGRANGE_CASADI_PART
#define LAGRANGE_CASADI_EXPORT LAGRANGE_CASADI_C
#endif
"""

_START_SINGLE = """\
#define LANES_SINGLE
#define casadi_real float
"""

WIDE = """
#undef casadi_real
#define casadi_real lanes_pack
"""
"""Definitions for packs of instants."""

_PACK = """
/* A pack that lies in rows; compilers copy memory in halves, and read what they wrote at once. */
LANES_INLINE casadi_real scene_load(const {real}* from) {{
  casadi_real pack;
  memcpy(&pack, from, sizeof pack);
  return pack;
}}

LANES_INLINE void scene_store({real}* to, casadi_real pack) {{ memcpy(to, &pack, sizeof pack); }}

/* The columns y of a pack of instants: at begins with its times; its iterated coordinates come
   after what the drive gives. */
static void scene_columns(const casadi_real* parameters, const casadi_real* constants,
                          casadi_real* at, casadi_real* y) {{
  casadi_real *counted = at + {nt}, *rates = counted + {nc}, *place = rates + 2*{nd};
  const casadi_real* arg[5];
  casadi_real* res[3];
  (void) parameters;
{drive}  arg[0] = counted;
  arg[1] = rates;
  arg[2] = rates + {nd};
  arg[3] = place;
  arg[4] = constants;
  res[0] = y;
  instant(arg, res);
}}

/* Parameters as packs, and what they alone decide. */
static void scene_constants(const {real}* p, casadi_real* parameters, casadi_real* constants) {{
  const casadi_real* arg[1];
  casadi_real* res[1];
  casadi_int k;
  for (k = 0; k < {nt}*{np}; ++k) parameters[k] = p[k];
  arg[0] = parameters;
  res[0] = constants;
  constants_of(arg, res);
}}

/* A sum that is finite if all so many columns are; four sums, for each addition waits for the one
   before. */
LANES_INLINE casadi_real scene_sum(const casadi_real* y, casadi_int columns) {{
  casadi_real sum[4];
  casadi_int j, k;
  for (j = 0; j < 4; ++j) sum[j] = 0;
  for (k = 0; k + 4 <= columns; k += 4) {{
    for (j = 0; j < 4; ++j) sum[j] = sum[j] + y[k + j];
  }}
  for (; k < columns; ++k) sum[0] = sum[0] + y[k];
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}}

/* So many rows of a pack of instants that begins at i; the last pack is filled up with the last
   instant. */
LANES_INLINE void scene_taken(const lagrange_casadi_instants* call, const {real}* from,
                              casadi_int rows, casadi_int i, casadi_real* pack) {{
  const casadi_int many = call->n - i, stride = call->stride;
  {real} lanes[LANES];
  casadi_int j, k;
  for (k = 0; k < rows; ++k, from += stride) {{
    if (many >= LANES) {{
      pack[k] = scene_load(from + i);
    }} else {{
      for (j = 0; j < LANES; ++j) lanes[j] = from[i + (j < many ? j : many - 1)];
      pack[k] = scene_load(lanes);
    }}
  }}
}}

/* The columns y of a pack of instants t that begins at i, where iterated coordinates are z. Unless
   out is NULL, out[k*apart + i] becomes column k at instant i. status[i], {OK} where there is
   nothing to say against the instant, becomes {NOT_FINITE} where a value is not finite. */
LANES_INLINE void scene_pack(const lagrange_casadi_instants* call, const casadi_real* parameters,
                             const casadi_real* constants, casadi_int i, casadi_real* y) {{
  const casadi_int many = call->n - i < LANES ? call->n - i : LANES, apart = call->apart;
  {real} *out = call->out ? call->out + i : 0, lanes[LANES];
  casadi_real at[{inputs}], sum;
  casadi_int j, k;
  scene_taken(call, call->t, {nt}, i, at);
  scene_taken(call, call->z, {nz}, i, at + {place});
  scene_columns(parameters, constants, at, y);
  if (out && many == LANES) {{
    for (k = 0; k < {outputs}; ++k) scene_store(out + k*apart, y[k]);
  }} else if (out) {{
    for (k = 0; k < {outputs}; ++k) memcpy(out + k*apart, y + k, (size_t) many*sizeof *out);
  }}
  sum = scene_sum(y, {outputs});
  sum = sum - sum;
  if (!lanes_any_nan(sum)) return;
  scene_store(lanes, sum);
  for (j = 0; j < many; ++j)
    if (lanes[j] != lanes[j] && call->status[i + j] == {OK}) call->status[i + j] = {NOT_FINITE};
}}
"""

_DRIVE = """  arg[0] = at;
  arg[1] = parameters;
  res[0] = counted;
  res[1] = rates;
  res[2] = rates + {nd};
  drive(arg, res);
"""

_EVALUATE = """
/* The columns of n instants, for parameters p.{single} */
LAGRANGE_CASADI_EXPORT void {evaluate}(const {call}* call) {{
  casadi_real y[{rows}], parameters[{given}], constants[{fixed}];
  casadi_int i;
  scene_constants(call->p, parameters, constants);
  for (i = 0; i < call->n; i += LANES) scene_pack(call, parameters, constants, i, y);
}}
"""

_IN_PAIRS = """
   Times and parameters are pairs, a value rounded to single and what that leaves of it: t[stride
   + i] is the rest of t[i], p[{np} + k] that of p[k]."""

_FOLLOW = """
/* Iterated loops, each instant from the one before: z[k*stride + i] becomes coordinate k at instant
   i, and guess, on entry that for the first instant, the last good one. {told} */
LAGRANGE_CASADI_EXPORT void {follow}(const {call}* call) {{
  static const int turns[{nz}] = {{{turns}}};
  const casadi_int n = call->n, stride = call->stride;
  const {real} *t = call->t, *p = call->p;
  {real} *guess = call->guess, *z = call->z;
  int* status = call->status;
  casadi_int i, k, step;
  {real} correction[{nz}], at[{nz}], counted[{nc} + 2*{nd}], moment[{nt}], size, before;
  const {real}* arg[3];
  {real}* res[3];
  for (i = 0; i < n; ++i) {{
    for (k = 0; k < {nt}; ++k) moment[k] = t[k*stride + i];
    arg[0] = moment;
    arg[1] = p;
    res[0] = counted;
    res[1] = counted + {nc};
    res[2] = counted + {nc} + {nd};
    lead(arg, res);
    size = before = 1;
    for (k = 0; k < {nz}; ++k) at[k] = guess[k];
    for (step = 0; step < {steps} && !(size < {done}); ++step) {{
      arg[0] = at;
      arg[1] = counted;
      arg[2] = p;
      before = size;
      res[0] = correction;
      res[1] = &size;
      loops(arg, res);
      if (!(size - size == 0)) break;
      for (k = 0; k < {nz}; ++k) at[k] += correction[k];
    }}
    status[i] = !(size < {lost}) ? {NOT_CONVERGED} : {slow} ? {SLOW} : {OK};
    for (k = 0; k < {nz}; ++k) {{
      if (turns[k]) at[k] -= {turn}*{floor}(at[k]*{inverse} + {half});
      if (status[i] != {NOT_CONVERGED}) guess[k] = at[k];
      z[k*stride + i] = guess[k];
    }}
  }}
}}
"""


def emit(program: Program, stages: Stages | None = None, newton: int | None = None) -> str:
    """The whole C file of a scene; the same text in every process, on every machine, for the same
    version of CasADi.

    ``stages`` say in which arithmetic, default: :func:`.plain`. ``newton`` is how many steps
    iterated loops take an instant, None for as many as they need.
    """
    stages = plain(program) if stages is None else stages
    parts = Parts.of(program, stages)
    single = _IN_PAIRS.format(**parts.sizes) if stages.precision == "single" else ""
    return emit_scene(program, stages, newton, parts) + _EVALUATE.format(
        **parts.sizes, single=single
    )


def emit_scene(program: Program, stages: Stages, newton: int | None, parts: Parts) -> str:
    """First part of every C file of a scene: its functions, and the loop for a pack of instants."""
    sizes = parts.sizes
    text = (
        (_START_SINGLE if stages.precision == "single" else "")
        + START
        + INSTANTS.text(sizes["real"])
    )
    text += print_functions(parts.narrow, stages.precision, prefix="follow")
    if stages.loops:
        text += following(program, stages, newton, sizes)
    text += WIDE + print_functions(parts.wide, stages.precision, prefix="scene", packs=True)
    return text + _PACK.format(
        **sizes, drive=_DRIVE.format(**sizes) if sizes["nc"] + sizes["nd"] else ""
    )


@dataclass(frozen=True)
class Parts:
    """Parts of an emitted file: functions of one instant, functions of packs, and sizes."""

    narrow: Mapping[str, ca.Function]
    wide: Mapping[str, ca.Function]
    sizes: dict[str, Any]

    @classmethod
    def of(cls, program: Program, stages: Stages, watched: int = 0) -> Parts:
        """Make the parts of a scene, whose last columns are ``watched``: no outputs."""
        constants, instant = hoisted(stages.instant)
        narrow = {"lead": stages.drive, "loops": stages.loops} if stages.loops else {}
        wide = {"drive": stages.drive, "constants_of": constants, "instant": instant}
        sizes = _sizes(program, stages) | {"constants": constants.size1_out(0)}
        place = sizes["nt"] + sizes["nc"] + 2 * sizes["nd"]
        room = {"given": sizes["nt"] * sizes["np"], "fixed": sizes["constants"]}
        sizes |= {
            "place": place,
            "inputs": place + sizes["nz"],
            "outputs": sizes["columns"] - watched,
        } | {name: max(1, size) for name, size in room.items()}
        return cls(narrow, wide, sizes)


def following(program: Program, stages: Stages, newton: int | None, sizes: dict[str, Any]) -> str:
    """The function that closes iterated loops, by so many steps an instant; its name is
    ``sizes["follow"]``.
    """
    assert program.newton is not None
    number = literal(stages.precision)
    rule = newton_rule(stages.precision, newton)
    turns = ", ".join(str(int(turning)) for turning in program.newton.turning)
    slow = (
        f"size > {number(rule['rate'])}*before && size > {number(rule['rounding'])}"
        if newton is None
        else "0"
    )
    numbers = {
        "turn": math.tau,
        "inverse": 1.0 / math.tau,
        "half": 0.5,
        "done": rule["done"],
        "lost": rule["lost"],
    }
    return _FOLLOW.format(
        **sizes,
        **{name: number(value) for name, value in numbers.items()},
        steps=int(rule["steps"]),
        floor=function_name("floor", stages.precision),
        told=_told(newton),
        turns=turns,
        slow=slow,
    )


def newton_rule(precision: Precision, steps: int | None) -> dict[str, float]:
    """Limits of Newton's method for iterated loops: the numbers that the emitted C and the virtual
    machine share.
    """
    single = precision == "single"
    done = NEWTON_DONE_SINGLE if single else NEWTON_DONE
    rule = {
        "rate": NEWTON_RATE_SINGLE if single else NEWTON_RATE,
        "rounding": NEWTON_ROUNDING_SINGLE if single else NEWTON_ROUNDING,
    }
    if steps is not None:
        return rule | {"steps": steps, "done": 0.0, "lost": NEWTON_LOST}
    return rule | {"steps": NEWTON_STEPS, "done": done, "lost": done}


def _told(newton: int | None) -> str:
    ok, lost, slow = (int(status) for status in (Status.OK, Status.NOT_CONVERGED, Status.SLOW))
    if newton is None:
        return f"""status[i] becomes {ok}, or {lost} where a loop did not converge, {slow} where not
   quadratically."""
    return f"""status[i] becomes {ok}, or {lost} where the last of {newton} steps is
   too large to believe."""


def _sizes(program: Program, stages: Stages) -> dict[str, Any]:
    """Values for the templates."""
    columns = len(program.columns)
    return {
        "evaluate": EVALUATE,
        "follow": FOLLOW,
        "call": INSTANTS.name,
        "real": "double" if stages.precision == "double" else "float",
        "columns": columns,
        "rows": max(1, columns),
        "nt": stages.drive.size1_in(0),
        "np": program.instant.size1_in("p"),
        "nc": stages.drive.size1_out(0),
        "nd": program.instant.size1_in("d"),
        "nz": program.instant.size1_in("z"),
        "OK": int(Status.OK),
        "NOT_CONVERGED": int(Status.NOT_CONVERGED),
        "NOT_FINITE": int(Status.NOT_FINITE),
        "SLOW": int(Status.SLOW),
    }


@symbolic
def hoisted(
    instant: ca.Function, rows: Sequence[int] | None = None
) -> tuple[ca.Function, ca.Function]:
    """Split an instant: ``constants_of(p) -> c``, the part that depends on parameters alone, and
    the instant with c for p; of some ``rows``.
    """
    inputs = instant.sx_in()
    out = instant(*inputs) if rows is None else instant(*inputs)[list(rows)]
    rest, symbols, constants = ca.extract_parametric(out, inputs[-1], {"extract_trivial": True})
    c = ca.vertcat(ca.SX(0, 1), *symbols)
    hoisted = ca.Function(
        "constants_of",
        [inputs[-1]],
        [ca.densify(ca.vertcat(ca.SX(0, 1), *constants))],
        {"cse": True},
    )
    return hoisted, ca.Function("instant", [*inputs[:-1], c], [ca.densify(rest)], {"cse": True})
