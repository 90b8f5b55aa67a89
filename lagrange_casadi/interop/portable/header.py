"""The header of an exported program: the contract, as C."""

from __future__ import annotations

import math
from collections.abc import Iterable

from .contract import CORNERS, Contract, Member
from .exported_slopes import types
from .sections import about, law_in_words
from .source import Source
from .stack import deepest
from .statuses import STATUSES
from .text import filled, member, template


def header(source: Source) -> str:
    """The header, ``<prefix>.h``."""
    c, span, words = source.contract, source.span, source.words
    described = source.exported.program.data.at([*source.values.values()])
    gravity = ", ".join(f"{one:g}" for one in described.components(described.gravity))
    return template(
        "mechanism.h",
        **words,
        begin=_begin(source),
        story=filled(source.story),
        conventions=filled(
            f"Conventions: {c.table.conventions}. {_ZERO} Gravity is ({gravity}) m/s^2."
        ),
        law=law_in_words(c),
        notes="".join(
            filled(f"{begin}: {', '.join(names)}.", "\n\n")
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
        parameters=_parameters(source),
        inputs=_rows(c, c.inputs),
        outputs_note=(
            " Angles that follow from loops are within one turn."
            if any(m.wrapped for m in c.outputs)
            else ""
        ),
        outputs=_rows(c, c.outputs),
        links=_links(source) + (types(c, source.slopes) if source.slopes else ""),
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
        span=f", from {span[0]:.6g} to {span[1]:.6g} s" if math.isfinite(span[0]) else "",
        pair_note=(
            "\n   The time is time + time_rest, because single precision has few digits;"
            " time_rest may be 0."
            if c.rests
            else ""
        ),
        follows=_follows(source),
        sections=(template("between.h", **words) if source.closing else "")
        + (template("mechanism_sections.h", **words) if c.links else "")
        + (template("sensitivity.h", **words) if source.slopes else ""),
    )


_ZERO = (
    "A joint's angle is the direction of the child's axis less that of the parent's, which of the"
    " ground is x; a slide is how far the child's point is from the parent's, along the joint's"
    " axis."
)


def _begin(source: Source) -> str:
    """First lines of the header's example."""
    c, start = source.contract, source.exported.program.data.span[0]
    if source.iterated:
        return f"status = {c.prefix}_motion(&model, {start:g}{', 0' if c.rests else ''}, &inputs);"
    return f"inputs.{c.shown[0].name} = 0.3{'f' if c.rests else ''};"


def _follows(source: Source) -> str:
    if not source.iterated:
        return ""
    data = source.exported.program.data
    (start, stop), count = data.span, data.timing.count
    near = (
        f", as instants {(stop - start) / (count - 1):.2g} s apart are in the scene's motion"
        if count > 1
        else ""
    )
    return (
        f" Iterated loops are followed from the instant before, which must be near{near};\n   where"
        " a call fails they stay where they stood. To begin elsewhere than the scene does, go"
        " there in small steps."
    )


def _parameters(source: Source) -> str:
    c = source.contract
    if not c.settings:
        return ""
    rows = _rows(c, c.settings)
    return template("mechanism_parameters.h", **source.words, corners=CORNERS, rows=rows)


def _rows(c: Contract, members: Iterable[Member]) -> str:
    return "\n".join(member(c.prefix, m.name, m.comment) for m in members)


def _links(source: Source) -> str:
    c = source.contract
    if not c.links:
        return ""
    return template(
        "mechanism_links.h",
        **source.words,
        links=",\n".join(f"  {link.constant} = {k}" for k, link in enumerate(c.links)),
        forces="\n".join(member(c.prefix, one, about(c.table, one)) for one in c.table.forces),
    )
