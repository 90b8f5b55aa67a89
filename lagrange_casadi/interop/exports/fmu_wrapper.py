"""The C that makes a unit of FMI 2.0 of an exported program's functions."""

from __future__ import annotations

import math
from collections.abc import Iterator

from ...base.quantities import motion_names
from ..portable.text import double, indented, template
from .fmu_description import Description


def wrapper(description: Description) -> str:
    """The C that makes a unit of the exported functions."""
    source, c = description.source, description.source.contract
    words = source.words | (_reach(description) if description.place else {})
    values = [(v.member.path, v.start) for v in description.variables if v.start is not None]
    return template(
        "fmu.c",
        **words,
        guid=description.guid,
        parameters=len(c.settings),
        values=max(1, len(values)),
        outputs=len(c.outputs),
        timed=int(description.timed),
        start=",\n".join(f"  {double(value)} /* {name} */" for name, value in values) or "  0.0",
        turning=",\n".join(f"  {int(m.wrapped)} /* {m.path} */" for m in c.outputs),
        start_time=double(source.exported.program.data.span[0]),
        limits=",\n".join(
            f'  {{"{m.path}", {double(m.low)}, {double(m.high)}}}' for m in c.settings
        ),
        set="\n".join(
            f"  parameters.{m.name} = ({c.prefix}_real) state->values[{k}];"
            for k, m in enumerate(c.settings)
        ),
        carried="".join(
            f"  if (state->begun) memcpy(&model.{m}, &state->model.{m}, sizeof model.{m});\n"
            for m, *_ in source.model
            if m in ("loops", "closed")
        ),
        inside=description.by,
        place=description.place,
        time=", ".join(c.split("time")),
        give=indented(_given(description)),
        take="\n".join(
            f"  found[{k}] = (double) outputs->{m.name};" for k, m in enumerate(c.outputs)
        ),
        functions=template("fmu_functions.c", **words),
    )


def _given(description: Description) -> Iterator[str]:
    """Statements that make inputs of a state; in single precision a number's rest is that of the
    double.
    """
    c = description.source.contract
    if description.place:
        yield f"return reach(&state->model, state->values[{len(c.settings)}], inputs);"
    elif description.by:
        yield "return motion(&state->model, state->time, inputs);"
    else:
        values = {one.name: f"state->values[{k}]" for k, one in enumerate(description.variables)}
        values["time"] = "state->time"
        for m in c.inputs:
            if not m.rest_of:
                yield from c.given("inputs->", m.source, values[m.source])
        yield f"return {c.words['P']}_OK;"


def _reach(description: Description) -> dict[str, object]:
    """Words of the function that finds the place of a coordinate in the scene's motion."""
    c, program = description.source.contract, description.source.exported.program
    (name,), (rate,), _ = motion_names([description.by])
    least, most = (x if math.isfinite(x) else math.copysign(1e300, x) for x in program.laws.span)
    start, stop = program.data.span
    return {
        "sought": description.by,
        "value": " + ".join(f"(double) inputs->{member}" for member in c.parts_of(name)),
        "put": indented(c.given("inputs->", name, "place")),
        "sign": "" if description.start[rate] > 0.0 else "-",
        "low": double(start),
        "high": double(stop),
        "least": double(least),
        "most": double(most),
    }
