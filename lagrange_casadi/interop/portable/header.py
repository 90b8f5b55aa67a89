"""The header of an exported program: the contract, as C."""

from __future__ import annotations

import math
from collections.abc import Iterable

from .contract import Contract, Member
from .exported_slopes import changes, sensitivities
from .sections import about, law_in_words
from .source import Source
from .stack import deepest
from .statuses import STATUSES
from .text import filled, member, template


def header(source: Source) -> str:
    """The header, ``<prefix>.h``."""
    c, words, program = source.contract, source.words, source.exported.program
    (start, stop), count = program.data.span, program.data.timing.count
    low, high = program.laws.span
    described = program.data.at([*source.values.values()])
    gravity = ", ".join(f"{one:g}" for one in described.components(described.gravity))
    return template(
        "mechanism.h",
        **words,
        start=f"{start:g}",
        single="f" if c.rests else "",
        story=filled(source.story),
        conventions=filled(
            f"Conventions: {c.table.conventions}. A joint's angle is the direction of the child's"
            " axis less that of the parent's, which of the ground is x; a slide is how far the"
            " child's point is from the parent's, along the joint's axis. Gravity is"
            f" ({gravity}) m/s^2."
        ),
        law=law_in_words(c) if c.links else "",
        notes="".join(
            "\n\n   " + filled(f"{begin}: {', '.join(names)}.")
            for begin, names in (
                ("Called otherwise here", [f"{k} is {v}" for k, v in c.mapped.items()]),
                ("Not determined by equilibrium, and left out", c.undetermined),
            )
            if names
        ),
        precision=c.precision,
        stack=deepest(source.code),
        real="float" if c.rests else "double",
        statuses=",\n".join(
            f"  {words['P']}_{key} = {k} /* {text} */"
            for k, (key, text) in enumerate(STATUSES.items())
        ),
        parameters=_rows(c, c.settings),
        inputs=_rows(c, c.inputs),
        outputs_note=(
            " Angles that follow from loops are within one turn."
            if any(m.wrapped for m in c.outputs)
            else ""
        ),
        outputs=_rows(c, c.outputs),
        links=",\n".join(f"  {link.constant} = {k}" for k, link in enumerate(c.links)),
        forces="\n".join(member(c.prefix, one, about(c.table, one)) for one in c.table.forces),
        changes="\n".join(changes(c, source.slopes)),
        sensitivities="\n".join(sensitivities(c, source.slopes)),
        model="\n".join(
            f"  {c.prefix}_real {name}[{count}];" if kind == "real" else f"  {kind} {name};"
            for name, kind, count in source.model
        ),
        for_parameters=", for parameters, or 0 for the defaults" if c.settings else "",
        anew=(
            " Starts again: iterated loops start from the scene's first instant."
            if source.iterated
            else ""
        ),
        span=f", from {low:.6g} to {high:.6g} s" if math.isfinite(low) else "",
        pair_note=(
            "\n   The time is time + time_rest, because single precision has few digits;"
            " time_rest may be 0."
            if c.rests
            else ""
        ),
        near=(
            f", as instants {(stop - start) / (count - 1):.2g} s apart are in the scene's motion"
            if count > 1
            else ""
        ),
    )


def _rows(c: Contract, members: Iterable[Member]) -> str:
    return "\n".join(member(c.prefix, m.name, m.comment) for m in members)
