"""A header of C++ for controllers, as those of ros2_control: efforts and reflected inertia of a
scene's drives, with a self-test.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...errors import DeclarationError
from ..portable.contract import Contract
from ..portable.source import Source
from ..portable.text import number_rows, numbers, quoted, template


def control(source: Source) -> dict[str, str]:
    """Return the files ``<prefix>_control.hpp`` and ``<prefix>_control_test.cpp``.

    Raises :class:`.DeclarationError` for a program without efforts.
    """
    c, golden = source.contract, source.golden
    efforts = [(k, m) for k, m in enumerate(c.outputs) if m.source.startswith("effort:")]
    if not efforts:
        raise DeclarationError(f"a header for controllers needs efforts; '{c.name}' exports none")
    loads = source.exported.program.data.content.loads.values()
    columns = [k for k, _ in efforts]
    words = source.words | {
        "n_coordinates": len(c.drives),
        "n_drives": len(efforts),
        "coordinates": _strings(c.drives),
        "drives": _strings([m.source.partition(":")[2] for _, m in efforts]),
        "time": ", double time" if c.timed else "",
        "time_given": ", time" if c.timed else "",
        "time_pair": ", ".join(c.split("time")),
        "parameters": f"const {c.prefix}_parameters* parameters = nullptr" if c.settings else "",
        "prepare": "&model_, parameters" if c.settings else "&model_",
        "or_between": ", or at a dead centre" if source.closing else "",
        "from_before": (
            " A dead centre on the straight way from the last call fails too."
            if source.closing
            else ""
        ),
        "from_inputs": "\n".join(_from_inputs(source)),
        "to_inputs": "\n".join(_to_inputs(source)),
        "to_efforts": "\n".join(
            f"    tau[{k}] = static_cast<double>(outputs.{m.name});"
            for k, (_, m) in enumerate(efforts)
        ),
        "times": numbers(golden.times),
        "efforts": number_rows(golden.outputs[:, columns]),
        "off": numbers(golden.outputs_off[columns]),
        "steps": golden.steps,
        "t": ", t" if c.timed else "",
        "t_before": ", before" if c.timed else "",
        "linear": "false" if any(load.friction for load in loads) else "true",
        "rounding": "1e-4" if c.rests else "1e-12",
    }
    return {
        f"{c.prefix}_control.hpp": template("control.hpp", **words),
        f"{c.prefix}_control_test.cpp": template("control_test.cpp", **words),
    }


def _strings(names: Sequence[str]) -> str:
    return ", ".join(f'"{quoted(name)}"' for name in names)


def _moved(c: Contract) -> Iterator[tuple[str, str]]:
    """Yield positions, rates and accelerations in C++, each with the full name of its input."""
    for values, names in zip(("q", "dq", "ddq"), c.moved, strict=True):
        yield from ((f"{values}[{k}]", name) for k, name in enumerate(names))


def _to_inputs(source: Source) -> Iterator[str]:
    """Yield statements that give the inputs of an instant."""
    c = source.contract
    for value, name in (*([("time", "time")] if c.timed else []), *_moved(c)):
        yield from c.given("    inputs.", name, value)


def _from_inputs(source: Source) -> Iterator[str]:
    """Yield statements that read the motion of an instant."""
    c = source.contract
    for value, name in _moved(c):
        parts = (f"static_cast<double>(inputs.{member})" for member in c.parts_of(name))
        yield f"    {value} = {' + '.join(parts)};"
