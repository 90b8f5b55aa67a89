"""The C that makes a unit of FMI 2.0 of an exported program's functions."""

from __future__ import annotations

import math
from collections.abc import Iterable

from ...base.quantities import motion_names
from ...engine.codegen.printer import literal
from ..portable.text import indented, template
from .fmu_description import Description


def wrapper(description: Description) -> str:
    """The C that makes a unit of the exported functions."""
    source, c = description.source, description.contract
    wide = literal("double")
    values = [(v.member.path, v.start) for v in description.variables if v.start is not None]
    return template(
        "fmu.c",
        **source.words,
        guid=description.guid,
        parameters=len(c.settings),
        values=max(1, len(values)),
        outputs=len(c.outputs),
        timed=int(description.timed),
        start=",\n".join(f"  {wide(value)} /* {name} */" for name, value in values) or "  0.0",
        turning=",\n".join(f"  {int(m.wrapped)} /* {m.path} */" for m in c.outputs),
        start_time=wide(source.exported.program.data.span[0]),
        limits=_limits(description),
        given=f"  {c.prefix}_parameters parameters;\n" if c.settings else "",
        set="".join(
            f"  parameters.{m.name} = ({c.prefix}_real) state->values[{k}];\n"
            for k, m in enumerate(c.settings)
        ),
        prepared="&model, &parameters" if c.settings else "&model",
        carried="".join(
            f"  if (state->begun) memcpy(&model.{m}, &state->model.{m}, sizeof model.{m});\n"
            for m, *_ in source.model
            if m in ("loops", "closed")
        ),
        reached=_reached(description),
        **_between(description),
        give=indented(_given(description)),
        take="\n".join(
            f"  found[{k}] = (double) outputs->{m.name};" for k, m in enumerate(c.outputs)
        ),
        functions=template("fmu_functions.c", check=_CHECK if c.settings else ""),
    )


_CHECK = """\
    if (vr[i] < PARAMETERS) {
      if (refused(unit, vr[i], value[i])) return fmi2Error;
      state->prepared = 0;
    }
"""


def _between(description: Description) -> dict[str, str]:
    """Members and statements that look for a dead centre between two instants."""
    p, P = description.contract.prefix, description.contract.words["P"]
    if not description.source.closing:
        return dict.fromkeys(("last", "between", "kept"), "")
    step = f"({p}_real) (state->time - state->last_time)"
    return {
        "last": f"  {p}_inputs last; /* those of the last instant that has outputs */\n"
        "  double last_time;\n",
        "between": f"  if (status == {P}_OK && state->begun) {{\n"
        f"    status = {p}_between(&state->model, &state->last, &inputs, {step});\n  }}\n",
        "kept": "  state->last = inputs;\n  state->last_time = state->time;\n",
    }


def _limits(description: Description) -> str:
    """The limits of parameters, and the message for a value beyond them."""
    c, wide = description.contract, literal("double")
    if not c.settings:
        return ""
    rows = ",\n".join(f'  {{"{m.path}", {wide(m.low)}, {wide(m.high)}}}' for m in c.settings)
    return template("fmu_limits.c", **description.source.words, rows=rows)


def _given(description: Description) -> Iterable[str]:
    """Statements that make inputs of a state; in single precision a number's rest is that of the
    double.
    """
    c = description.contract
    if description.by:
        if description.by == "time":
            yield "return motion(&state->model, state->time, inputs);"
        else:
            yield f"return reach(&state->model, state->values[{len(c.settings)}], inputs);"
        return
    values = {one.name: f"state->values[{k}]" for k, one in enumerate(description.variables)}
    values["time"] = "state->time"
    for m in c.inputs:
        if not m.rest_of:
            yield from c.given("inputs->", m.source, values[m.source])
    yield f"return {c.words['P']}_OK;"


def _reached(description: Description) -> str:
    """C of the motion that is inside: at a time, and at the place of a coordinate."""
    c, source = description.contract, description.source
    if not description.by:
        return ""
    text = template("fmu_motion.c", **source.words, time=", ".join(c.split("time")))
    if description.by == "time":
        return text
    data, wide = source.exported.program.data, literal("double")
    (name,), (rate,), _ = motion_names([description.by])
    limits = [x if math.isfinite(x) else math.copysign(1e300, x) for x in source.span]
    rising = description.start[rate] > 0.0
    return text + template(
        "fmu_reach.c",
        **source.words,
        coordinate=description.by.replace("*/", ""),
        value=" + ".join(f"(double) inputs->{member}" for member in c.parts_of(name)),
        put=indented(c.given("inputs->", name, "place")),
        sign="" if rising else "-",
        start=wide(data.span[0]),
        stop=wide(data.span[1]),
        least=wide(limits[0]),
        most=wide(limits[1]),
    )
