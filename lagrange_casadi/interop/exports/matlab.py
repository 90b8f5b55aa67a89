"""A mex function for MATLAB and Octave: its source, what builds it, and an example."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from ...engine.codegen.printer import literal
from ..portable.contract import Contract, Member
from ..portable.naming import taken_words
from ..portable.source import Source
from ..portable.text import listed, octave, template

_RESTS = """
   Numbers are doubles here: what single precision would round off a coordinate or a time is kept,
   without a member of its own."""

_SECTION = "plhs[0] = section(prhs[1], prhs[2], prhs[3], nrhs > 4 ? prhs[4] : 0)"
_NO_SECTION = 'mexErrMsgIdAndTxt("{}:name", "there is no link with sections.")'


def matlab(source: Source) -> dict[str, str]:
    """The files by name."""
    c, (coordinate, output) = source.contract, source.contract.shown
    words = source.words | {
        "coordinate": coordinate.name,
        "coordinate_unit": octave(coordinate.unit),
        "coordinate_field": _field(coordinate),
        "output": output.name,
        "output_unit": octave(output.unit),
        "output_field": _field(output),
    }
    start, stop = source.exported.program.data.span
    number = literal("double")
    return {
        f"{c.prefix}_mex.c": template(
            "mex.c",
            **words,
            rests=_RESTS if c.rests else "",
            inputs=_members(c, "inputs", [m for m in c.inputs if not m.rest_of]),
            outputs=_members(c, "outputs", c.outputs),
            parameters=_members(c, "parameters", c.settings),
            prepare=_prepare(c, words),
            time=", ".join(c.split("t")),
            section=_section(c, words) if c.links else "",
            sections=_SECTION if c.links else _NO_SECTION.format(c.prefix),
            matrices=listed(c.table.forces),
        ),
        "build_mex.m": template("build_mex.m", **words),
        "mex_example.m": template(
            "mex_example.m",
            **words,
            start=number(start),
            step=number((stop - start) / 12),
            more="\n".join(_more(c, output)),
        ),
    }


def _field(member: Member) -> str:
    """Expression by which a script reads a member of a struct."""
    plain = member.name[0].isalpha() and member.name not in taken_words("matlab")
    return f".{member.name}" if plain else f".('{member.name}')"


def _members(c: Contract, struct: str, members: Iterable[Member]) -> str:
    rests = {m.rest_of: m.name for m in c.inputs if m.rest_of} if struct == "inputs" else {}

    def place(name: str) -> str:
        return f"offsetof({c.prefix}_{struct}, {name})"

    rows = (
        (m.name, place(m.name), place(rests[m.source]) if m.source in rests else "0")
        for m in members
    )
    return "\n".join(f'  {{"{name}", {at}, {rest}}},' for name, at, rest in rows)


def _prepare(c: Contract, words: Mapping[str, str]) -> str:
    """Statements that give the parameters that were given, and prepare the model."""
    check = '  if (given) check_struct(given, "parameters", members_of_parameters, "");\n'
    if not c.settings:
        return f"{check}  status = {c.prefix}_prepare(model);"
    return template("mex_prepare.c", **words, check=check)


def _section(c: Contract, words: Mapping[str, str]) -> str:
    forces = c.table.forces
    return template(
        "mex_section.c",
        **words,
        links=", ".join(f'"{link.name}"' for link in c.links),
        pointers=", ".join(f"*{force}" for force in forces),
        added="\n".join(
            f'  {force} = added(found, "{force}", many, width, mxDOUBLE_CLASS);' for force in forces
        ),
        filled="\n".join(
            f"      {force}[j*many + i] = (double) forces.{force};" for force in forces
        ),
    )


def _more(c: Contract, output: Member) -> Iterable[str]:
    """Links and parameters in the example."""
    if c.links:
        link = c.links[0].name
        yield f"forces = {c.prefix}_mex('section', outputs, '{link}', linspace(0, 1, 5));"
        yield (
            f"fprintf('largest bending moment of {link}: %g N m\\n', max(abs(forces.bending(:))));"
        )
    if c.settings:
        first = c.settings[0]
        yield f"parameters = struct('{first.name}', 1.01*{literal('double')(first.default)});"
        yield f"other = {c.prefix}_mex({c.prefix}_mex('motion', t, parameters), parameters);"
        unit = octave(output.unit).replace("\\", "\\\\").replace("%", "%%")  # in a format
        yield (
            f"fprintf('{output.name} changes by at most %g {unit} where {first.name} is 1 %%"
            " larger\\n', ..."
        )
        yield f"        max(abs(other{_field(output)} - outputs{_field(output)})));"
