"""A unit of FMI 2.0, for simulation tools: an archive with the description, a library, the sources,
golden vectors and a page to read.
"""

from __future__ import annotations

import ctypes
import io
import math
import zipfile
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ..base.arrays import Array
from ..base.cache import working_folder
from ..codegen import find_compiler
from ..codegen.compiler import Compiler, broken, built
from ..codegen.printer import literal
from ..errors import (
    CompilerError,
    DeclarationError,
    LagrangeCasadiError,
    StoreError,
    UnknownNameError,
)
from ..portable.contract import Contract
from ..portable.header import header
from ..portable.source import Source
from ..portable.text import indented, template
from .fmu_description import Description, page
from .fmu_golden import FILE, golden_script, golden_vectors

_HEADERS = ("fmi2Functions.h", "fmi2FunctionTypes.h", "fmi2TypesPlatform.h")
_EPOCH = (1980, 1, 1, 0, 0, 0)


def check_tools() -> None:
    """Raise :class:`LagrangeCasadiError` where FMPy is missing, :class:`CompilerError` where a C
    compiler is.
    """
    _fmpy()
    _compiler()


def fmu(source: Source, p: Array, by: str = "") -> dict[str, bytes]:
    """Return the archive ``<prefix>.fmu`` of a program whose parameters start with ``p``, and the
    script that tests it; ``by`` says what moves it, see :class:`.Description`.

    The same program gives the same bytes, as far as the compiler does. Raises
    :class:`CompilerError` for what it refuses, :class:`StoreError` for what FMPy finds wrong, and
    :class:`.DeclarationError` for a coordinate that goes back and forth.
    """
    fmpy, prefix = _fmpy(), source.contract.prefix
    if by not in ("", "time"):
        _check_way(source, p, by)
    description = Description(source, p, (f"{prefix}.c", f"{prefix}_fmi2.c"), by)
    headers = Path(fmpy.__file__).parent / "c-code"
    sources = {file: (headers / file).read_text() for file in _HEADERS}
    sources |= {
        f"{prefix}.h": header(source),
        f"{prefix}.c": source.code,
        f"{prefix}_fmi2.c": wrapper(description),
    }
    library, compiler = f"{prefix}{fmpy.sharedLibraryExtension}", _compiler()
    flags = compiler.flags("".join(sources.values()))
    command = [*compiler.command, *flags, *description.sources, "-o", library, "-lm"]
    files = {f"sources/{file}": text.encode() for file, text in sources.items()}
    files["modelDescription.xml"] = description.xml.encode()
    files["documentation/index.html"] = page(description).encode()
    files[FILE] = golden_vectors(description).encode()
    files[f"binaries/{fmpy.platform}/{library}"] = built(
        compiler, command, sources, library, lambda path: _check_loads(path, compiler)
    )
    archive = _archive(files)
    findings = _findings(archive)
    if findings:
        raise StoreError(f"FMPy reports an error in {prefix}.fmu: {' '.join(findings[0].split())}")
    return {
        f"{prefix}.fmu": archive,
        f"{prefix}_fmu_test.py": golden_script(description).encode(),
    }


def wrapper(description: Description) -> str:
    """The C that makes a unit of the exported functions."""
    source, c = description.source, description.contract
    wide = literal("double")
    carried = (
        ["memcpy(model.loops, state->model.loops, sizeof model.loops);"] if source.iterated else []
    )
    carried += ["model.closed = state->model.closed;"] if source.exported.newton is not None else []
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
        carried="".join(f"  if (state->begun) {line}\n" for line in carried),
        reached=_reached(description),
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
            yield from _put(c, m.source, values[m.source])
    yield f"return {c.prefix.upper()}_OK;"


def _put(c: Contract, name: str, value: str) -> Iterable[str]:
    """Statements that give an input a double; in single precision also what that leaves of it."""
    whole, *rests = c.parts_of(name)
    yield f"inputs->{whole} = ({c.prefix}_real) {value};"
    for rest in rests:
        yield f"inputs->{rest} = ({c.prefix}_real) ({value} - (double) inputs->{whole});"


def _reached(description: Description) -> str:
    """C of the motion that is inside: at a time, and at the place of a coordinate."""
    c, source = description.contract, description.source
    if not description.by:
        return ""
    rest = f", ({c.prefix}_real) (time - (double) ({c.prefix}_real) time)" if c.rests else ""
    text = template("fmu_motion.c", **source.words, rest=rest)
    if description.by == "time":
        return text
    data, wide, name = source.exported.program.data, literal("double"), f"motion:{description.by}"
    limits = [x if math.isfinite(x) else math.copysign(1e300, x) for x in source.span]
    rising = description.start[f"{name}_rate"] > 0.0
    return text + template(
        "fmu_reach.c",
        **source.words,
        coordinate=description.by.replace("*/", ""),
        value=" + ".join(f"(double) inputs->{member}" for member in c.parts_of(name)),
        put=indented(_put(c, name, "place")),
        sign="" if rising else "-",
        start=wide(data.span[0]),
        stop=wide(data.span[1]),
        least=wide(limits[0]),
        most=wide(limits[1]),
    )


def _check_way(source: Source, p: Array, by: str) -> None:
    """Raise :class:`UnknownNameError` for a coordinate whose motion is not given, and
    :class:`DeclarationError` for one that does not rise or fall at all instants.
    """
    program = source.exported.program
    if by not in program.driven:
        raise UnknownNameError("coordinate", by, ["time", *program.driven])
    times = np.linspace(*program.data.span, max(2, 4 * program.data.timing.count))
    rates = program.motion(times[None, :], p)[1].full()[program.driven.index(by)]
    if not (np.all(rates > 0.0) or np.all(rates < 0.0)):
        raise DeclarationError(
            f"an FMU by '{by}': this coordinate stops or reverses, so it does not determine the"
            " time; use 'time'"
        )


def _fmpy() -> Any:
    try:
        import fmpy
        import fmpy.validation
    except ImportError:
        raise LagrangeCasadiError(
            "an FMU needs FMPy; install it with: pip install 'lagrange_casadi[fmu]'"
        ) from None
    return fmpy


def _compiler() -> Compiler:
    found = find_compiler()
    if found is None:
        raise CompilerError(
            "an FMU needs a C compiler: install gcc, clang or the wheel ziglang, or set $CC"
        )
    return found


def _check_loads(library: Path, compiler: Compiler) -> None:
    """Raise :class:`CompilerError` unless the library loads here and says that it is a unit of FMI
    2.0.
    """
    try:
        version = ctypes.CDLL(str(library)).fmi2GetVersion
        version.restype = ctypes.c_char_p
        found = version()
    except (OSError, AttributeError) as error:
        raise broken(compiler, error) from None
    if found != b"2.0":
        raise broken(compiler, ValueError(f"fmi2GetVersion says {found!r}"))


def _archive(files: Mapping[str, bytes]) -> bytes:
    """A zip without a clock, in order."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        for name in sorted(files):
            entry = zipfile.ZipInfo(name, _EPOCH)
            entry.compress_type, entry.create_system = zipfile.ZIP_DEFLATED, 3
            entry.external_attr = (0o755 if name.startswith("binaries/") else 0o644) << 16
            archive.writestr(entry, files[name])
    return out.getvalue()


def _findings(archive: bytes) -> list[str]:
    """Objections of FMPy to an archive."""
    with working_folder() as work:
        path = work / "unit.fmu"
        path.write_bytes(archive)
        return list(_fmpy().validation.validate_fmu(str(path)))
