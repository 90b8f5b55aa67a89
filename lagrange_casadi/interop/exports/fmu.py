"""A unit of FMI 2.0, for simulation tools: an archive with the description, a library, the sources,
golden vectors and a page to read.
"""

from __future__ import annotations

import ctypes
import io
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ...base.cache import working_folder
from ...base.packages import check_installed
from ...base.quantities import motion_names
from ...engine.codegen import find_compiler, no_compiler
from ...engine.codegen.compiler import Compiler, broken, built
from ...errors import DeclarationError, StoreError, check_known
from ..portable.golden import motions_at
from ..portable.header import header
from ..portable.source import Source
from .fmu_description import Description, page
from .fmu_golden import FILE, golden_script, golden_vectors
from .fmu_wrapper import wrapper

_HEADERS = ("fmi2Functions.h", "fmi2FunctionTypes.h", "fmi2TypesPlatform.h")


def tools() -> tuple[Any, Compiler]:
    """Return FMPy and the C compiler.

    Raises :class:`LagrangeCasadiError` where FMPy is missing, :class:`CompilerError` where a C
    compiler is.
    """
    check_installed("FMPy", "an FMU", "fmu")
    import fmpy
    import fmpy.validation

    if (compiler := find_compiler()) is None:
        raise no_compiler("an FMU needs a C compiler", "c")
    return fmpy, compiler


def fmu(source: Source, by: str = "") -> dict[str, bytes]:
    """Return the archive ``<prefix>.fmu`` of a program, and the script that tests it; ``by`` says
    what moves it, see :class:`.Description`.

    The same program gives the same bytes, as far as the compiler does. Raises
    :class:`CompilerError` for what it refuses, :class:`StoreError` for what FMPy finds wrong, and
    :class:`.DeclarationError` for a coordinate that goes back and forth.
    """
    fmpy, compiler = tools()
    prefix = source.contract.prefix
    if by not in ("", "time"):
        _check_way(source, by)
    description = Description(source, (f"{prefix}.c", f"{prefix}_fmi2.c"), by)
    headers = Path(fmpy.__file__).parent / "c-code"
    sources = {file: (headers / file).read_text() for file in _HEADERS}
    sources |= {
        f"{prefix}.h": header(source),
        f"{prefix}.c": source.code,
        f"{prefix}_fmi2.c": wrapper(description),
    }
    library = f"{prefix}{fmpy.sharedLibraryExtension}"
    flags = compiler.flags("".join(sources.values()))
    command = [*compiler.command, *flags, *description.sources, "-o", library, "-lm"]
    files = {f"sources/{file}": text.encode() for file, text in sources.items()}
    files["modelDescription.xml"] = description.text(description.guid).encode()
    files["documentation/index.html"] = page(description).encode()
    files[FILE] = golden_vectors(description).encode()
    files[f"binaries/{fmpy.platform}/{library}"] = built(
        compiler, command, sources, library, lambda path: _check_loads(path, compiler)
    )
    archive = _archive(files)
    with working_folder() as work:
        path = work / "unit.fmu"
        path.write_bytes(archive)
        findings = list(fmpy.validation.validate_fmu(str(path)))
    if findings:
        raise StoreError(f"FMPy reports an error in {prefix}.fmu: {' '.join(findings[0].split())}")
    return {
        f"{prefix}.fmu": archive,
        f"{prefix}_fmu_test.py": golden_script(description).encode(),
    }


def _check_way(source: Source, by: str) -> None:
    """Raise :class:`UnknownNameError` for a coordinate whose motion is not given, and
    :class:`DeclarationError` for one that does not rise or fall at all instants.
    """
    program = source.exported.program
    check_known("coordinate", [by], ["time", *program.driven])
    times = np.linspace(*program.data.span, max(2, 4 * program.data.timing.count))
    _, (name,), _ = motion_names([by])
    rates = motions_at(program, times, source.p)[name]
    if not (np.all(rates > 0.0) or np.all(rates < 0.0)):
        raise DeclarationError(
            f"an FMU by '{by}': this coordinate stops or reverses, so it does not determine the"
            " time; use 'time'"
        )


def _check_loads(library: Path, compiler: Compiler) -> None:
    """Raise :class:`CompilerError` unless the library loads here."""
    try:
        ctypes.CDLL(str(library))
    except OSError as error:
        raise broken(compiler, error) from None


def _archive(files: Mapping[str, bytes]) -> bytes:
    """A zip without a clock, in order."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        for name in sorted(files):
            entry = zipfile.ZipInfo(name)
            entry.create_system = 3
            entry.external_attr = (0o755 if name.startswith("binaries/") else 0o644) << 16
            archive.writestr(entry, files[name], zipfile.ZIP_DEFLATED)
    return out.getvalue()
