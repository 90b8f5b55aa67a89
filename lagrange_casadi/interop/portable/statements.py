"""The statements of C around the functions of an exported program: what prepares a model, moves its
drives, and evaluates an instant.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

from ...base.status import Status
from ...engine.codegen.emit import newton_rule
from ...engine.codegen.printer import function_name
from ...engine.codegen.reduction import centre
from ...engine.dead_centres import POINTS
from ...model.beyond_ends import BEYOND
from .contract import Contract
from .data import table_call
from .exported_calls import INSTANT, MODEL, PREPARE, call, given
from .exported_program import ExportedProgram
from .text import indented, template


def put(exported: ExportedProgram) -> Iterator[str]:
    """Yield what fills the outputs from the columns."""
    for m in exported.contract.outputs:
        value = exported.column(m.source)
        yield f"outputs->{m.name} = {f'direction({value})' if m.wrapped else value};"


def closing_loops(exported: ExportedProgram) -> str:
    """Return the function that closes loops."""
    c, number, newton = exported.contract, exported.number, exported.program.newton
    rule = newton_rule(c.precision, exported.newton)
    assert newton is not None
    return template(
        "loops.c",
        **c.words,
        nz=exported.sizes["loops"],
        turning=", ".join(str(int(turning)) for turning in newton.turning),
        turn=number(math.tau),
        inverse=number(1.0 / math.tau),
        half=number(0.5),
        floor=function_name("floor", c.precision),
        rate=number(rule["rate"]),
        rounding=number(rule["rounding"]),
        given=indented(given(exported.functions, "loops")),
    ).rstrip()


def between(exported: ExportedProgram) -> str:
    """Return the function of what is between two instants, with what it calls."""
    c, sizes = exported.contract, exported.sizes
    loops, drives = sizes["loops"], len(c.drives)
    return template(
        "between.c",
        **c.words,
        many=sizes["squares"],
        limits=", ".join(map(exported.number, exported.zeros)),
        moment=max(1, sizes["moment"]),
        counted=max(1, sizes["counted"]),
        drives=drives,
        kept=f"  casadi_real kept[{loops}];\n" if loops else "",
        given=indented(_between(exported)),
        slopes=1 + drives,
        all=sizes["slopes"],
        points=POINTS,
        rule=centre(1 + drives),
        sum=" + ".join(f"{at}->{m.name}" for at in ("before", "after") for m in c.inputs),
    )


def _between(exported: ExportedProgram) -> Iterator[str]:
    """Yield the statements that evaluate ``closing`` at a fraction x of a step."""
    c, functions = exported.contract, exported.functions
    model = {name: f"step->model->{name}" for name in MODEL}
    many = 1 + len(c.drives)
    for k, member in enumerate(c.moment[:many]):
        rest = c.moment[many + k] if c.rests else ""
        if k == 0:
            yield "gone = x*h;"
        else:
            v, a = (names[k - 1] for names in c.motion[1:])
            change = " + ".join(f"(after->{m} - before->{m})" for m in (member, rest) if m)
            yield (
                f"gone = come(x, h, {change}, before->{v}, after->{v}, before->{a}, after->{a},"
                f" rate + {k - 1}, acceleration + {k - 1});"
            )
        yield f"moment[{k}] = {f'before->{member} + gone' if member else '0'};"
        if c.rests:
            left = f"(before->{member} - moment[{k}]) + gone + before->{rest}"
            yield f"moment[{many + k}] = {left if member else '0'};"
    if "count" in functions:
        yield from call(functions, "count", **model)
    if "loops" in functions:
        words = {"nz": exported.sizes["loops"], "limits": _limits(exported, None)}
        yield template("between_loops.c", **c.words, **words).rstrip()
    yield from call(functions, "closing", **model)
    if "loops" in functions:
        yield f"for (k = 0; k < {words['nz']}; ++k) step->model->loops[k] = kept[k];"


def _limits(exported: ExportedProgram, newton: int | None) -> str:
    """Return the steps, and what done and lost mean, of so many Newton steps, or of all."""
    rule, number = newton_rule(exported.contract.precision, newton), exported.number
    return f"{int(rule['steps'])}, {number(rule['done'])}, {number(rule['lost'])}"


def prepare(exported: ExportedProgram) -> Iterator[str]:
    """Yield what checks parameters, and computes what they alone set."""
    c = exported.contract
    for k, m in enumerate(c.settings):
        value = f"values->{m.name}"
        ends = _ends(exported, value, (">=", m.low), ("<=", m.high))
        within = " && ".join([f"is_finite({value})", *ends])
        yield f"if (!({within})) return {c.words['P']}_BAD_PARAMETER;"
        yield f"model->parameters[{k}] = {value};"
    for name in exported.called(PREPARE):
        yield from call(exported.functions, name)
        if name == "sound":
            yield from _refused_parts(exported)
    if exported.newton is not None:
        yield "model->closed = 0;"
    for k, start in enumerate(exported.guess):
        yield f"model->loops[{k}] = {exported.number(start)};"


def _refused_parts(exported: ExportedProgram) -> Iterator[str]:
    """Refuse parameters for which a margin is not positive, or a later one negative."""
    ends = (0, exported.positive, exported.sizes["sound_of"])
    for (start, stop), test in zip(itertools.pairwise(ends), (">", ">="), strict=True):
        if stop > start:
            words = exported.contract.words
            yield template("sound.c", **words, start=start, stop=stop, test=test).rstrip()


def motion(exported: ExportedProgram) -> Iterator[str]:
    """Yield what fills the inputs with the motion of the drives at a time."""
    c, functions, drives = exported.contract, exported.functions, len(exported.contract.drives)
    at = ["time", "time_rest"] if c.rests else ["time"]
    yield _refused(c, "model->seal != SEAL", "NOT_PREPARED")
    time, (low, high) = " + ".join(at), exported.program.laws.span
    untimely = [f"!is_finite({time})", *_ends(exported, time, ("<", low), (">", high))]
    yield _refused(c, " || ".join(untimely), "BAD_TIME")
    yield from (f"at[{k}] = {one};" for k, one in enumerate(at))
    yield from call(functions, "law")
    if "beyond" in functions:
        yield from call(functions, "beyond")
        limit = exported.number(BEYOND[c.precision])
        far = (f"!(far[{k}] <= {limit})" for k in range(exported.sizes["far"]))
        yield _refused(c, " || ".join(far), "BAD_TIME")
    values = [
        value
        for i, one in enumerate(at)
        for value in (one, *(f"d[{i * drives + k}]" for k in range(drives)))
    ]
    values += [f"{vector}[{k}]" for vector in ("rate", "acceleration") for k in range(drives)]
    _, rates, accelerations = c.motion
    known = dict(zip([*c.moment, *rates, *accelerations], values, strict=True))
    yield from (f"inputs->{m.name} = {known[m.name]};" for m in c.inputs)


def _refused(c: Contract, condition: str, status: str) -> str:
    """Return what gives nothing but a status, where a condition holds."""
    nothing = indented(f"inputs->{m.name} = nothing;" for m in c.inputs)
    return f"if ({condition}) {{\n{nothing}\n  return {c.words['P']}_{status};\n}}"


def _ends(exported: ExportedProgram, value: str, *ends: tuple[str, float]) -> Iterator[str]:
    """Yield how a value is compared with those ends of a range that are finite."""
    for sign, end in ends:
        if math.isfinite(end):
            yield f"{value} {sign} {exported.number(end)}"


def instant(exported: ExportedProgram) -> Iterator[str]:
    """Yield what computes the columns of an instant, and refuses those that break a rule."""
    c, table, called = exported.contract, exported.cycle, exported.called(INSTANT)
    for k, member in enumerate(c.moment if "count" in called else ()):
        yield f"moment[{k}] = {f'inputs->{member}' if member else '0'};"
    for k, (_, rate, acceleration) in enumerate(zip(*c.motion, strict=True)):
        yield f"rate[{k}] = inputs->{rate};\nacceleration[{k}] = inputs->{acceleration};"
    total = " + ".join(f"inputs->{m.name}" for m in c.inputs)
    yield f"if (!is_finite({total})) return {c.words['P']}_BAD_INPUT;"
    evaluated = "drive" if table is not None else "y"
    for name in called:
        if name == "loops":
            yield from _close(exported)
        else:
            yield from call(exported.functions, name, evaluated=evaluated)
        if name == "instant" and table is not None:
            yield from table_call(table, exported.number)
        if name == "status":
            yield "if (rule > 0) return broken[(int) rule];"


def _close(exported: ExportedProgram) -> Iterator[str]:
    """Yield what closes loops: by all steps that these want, or first so and then by a few."""
    P, newton = exported.contract.words["P"], exported.newton
    if newton is not None:
        yield template("close_first.c", P=P, limits=_limits(exported, None)).rstrip()
    yield f"closed = close_loops(model, counted, {_limits(exported, newton)});"
    yield f"if (closed == {P}_NOT_CONVERGED) return closed;"
    if newton is None:
        yield f"if (closed == {P}_SLOW) iterated = {exported.number(float(Status.SLOW))};"
