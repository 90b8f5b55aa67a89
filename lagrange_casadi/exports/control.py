"""A header of C++ for controllers, as those of ros2_control: efforts and reflected inertia of a
scene's drives, with a self-test.
"""

from __future__ import annotations

from collections.abc import Sequence

from ..codegen.printer import literal
from ..declare.description import Description
from ..errors import DeclarationError
from ..portable.contract import REST
from ..portable.source import Source
from ..portable.text import quoted, template


def control(source: Source) -> dict[str, str]:
    """Return the files ``<prefix>_control.hpp`` and ``<prefix>_control_test.cpp``.

    Raises :class:`.DeclarationError` for a program without efforts.
    """
    c, wide = source.contract, literal("double")
    efforts = [(k, m) for k, m in enumerate(c.outputs) if m.source.startswith("effort:")]
    if not efforts:
        raise DeclarationError(f"a header for controllers needs efforts; '{c.name}' exports none")
    settings = bool(c.settings)
    content: Description = source.exported.program.data.template.content
    friction = any("friction" in load for load in content["loads"].values())
    golden = source.golden
    columns = [k for k, _ in efforts]
    words = source.words | {
        "n_coordinates": len(c.drives),
        "n_drives": len(efforts),
        "coordinates": _strings(c.drives),
        "drives": _strings([m.source.partition(":")[2] for _, m in efforts]),
        "time": ", double time" if c.timed else "",
        "time_word": ", time" if c.timed else "",
        "time_given": ", time" if c.timed else "",
        "time_pair": _pair(source, "time"),
        "parameters": f"const {c.prefix}_parameters* parameters = nullptr" if settings else "",
        "prepare": "&model_, parameters" if settings else "&model_",
        "from_inputs": "\n".join(_from_inputs(source)),
        "to_inputs": "\n".join(_to_inputs(source)),
        "to_efforts": "\n".join(
            f"    tau[{k}] = static_cast<double>(outputs.{m.name});"
            for k, (_, m) in enumerate(efforts)
        ),
        "times": ", ".join(map(wide, golden.times.tolist())),
        "efforts": ",\n".join(
            f"  {{{', '.join(map(wide, row))}}}" for row in golden.outputs[:, columns].tolist()
        ),
        "off": ", ".join(map(wide, golden.outputs_off[columns].tolist())),
        "steps": golden.steps,
        "null": "",
        "t": ", t" if c.timed else "",
        "t_before": ", before" if c.timed else "",
        "linear": "false" if friction else "true",
        "rounding": "1e-4" if c.rests else "1e-12",
    }
    return {
        f"{c.prefix}_control.hpp": template("control.hpp", **words),
        f"{c.prefix}_control_test.cpp": template("control_test.cpp", **words),
    }


def _strings(names: Sequence[str]) -> str:
    return ", ".join(f'"{quoted(name)}"' for name in names)


def _pair(source: Source, value: str) -> str:
    """Return a double as arguments: one, or in single precision two that add up to it."""
    real = f"{source.contract.prefix}_real"
    first = f"static_cast<{real}>({value})"
    if not source.contract.rests:
        return first
    return f"{first}, static_cast<{real}>({value} - static_cast<double>({first}))"


def _to_inputs(source: Source) -> list[str]:
    """Return statements that give the inputs of an instant."""
    c = source.contract
    given = [("time", "time")] if c.timed else []
    given += [(f"motion:{drive}", f"q[{k}]") for k, drive in enumerate(c.drives)]
    lines = []
    for name, value in given:
        parts = _pair(source, value).split(", ")
        lines.append(f"    inputs.{c.input_of(name)} = {parts[0]};")
        lines += [f"    inputs.{c.input_of(REST + name)} = {parts[1]};"] if c.rests else []
    for end, values in (("_rate", "dq"), ("_acceleration", "ddq")):
        lines += [
            f"    inputs.{c.input_of(f'motion:{drive}{end}')} ="
            f" static_cast<{c.prefix}_real>({values}[{k}]);"
            for k, drive in enumerate(c.drives)
        ]
    return lines


def _from_inputs(source: Source) -> list[str]:
    """Return statements that read the motion of an instant."""
    c, lines = source.contract, []
    for end, values in (("", "q"), ("_rate", "dq"), ("_acceleration", "ddq")):
        for k, drive in enumerate(c.drives):
            name = f"motion:{drive}{end}"
            sum_of = [c.input_of(name), *([c.input_of(REST + name)] if c.rests and not end else [])]
            parts = " + ".join(f"static_cast<double>(inputs.{one})" for one in sum_of)
            lines.append(f"    {values}[{k}] = {parts};")
    return lines
