"""A scene as a folder of C that stands alone."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import casadi as ca

from ...base.arguments import LATER, Outputs, public
from ...base.arrays import Json
from ...base.files import check_writable
from ...base.folders import Manifest
from ...base.vocabulary import Precision
from ...engine.instants.evaluation_method import EvaluationMethod
from ...errors import PathError
from ...model.scene import Scene
from ...version import __version__
from ..portable.contract import Contract
from ..portable.data import LARGEST
from ..portable.header import header
from ..portable.source import Source
from ..portable.sourced import sourced
from ..portable.wasm import check_zig
from ..portable.wasm import wasm as for_pages
from .companions import companions
from .control import control as for_control
from .fmu import fmu as archive
from .fmu import tools
from .structured_text import structured_text as blocks

MANIFEST = Manifest(
    "export.json",
    "lagrange-casadi export",
    "export into",
    "an export",
    "choose another folder, or set force=True, which changes no other file",
)
_BUILD = "build"
"""Build folder in README: a new export neither stops at it nor touches it."""


@public
def export(
    scene: Scene,
    out: str | os.PathLike[str],
    *,
    name: str | None = None,
    parameters: Mapping[str, float] | None = None,
    wanted: Outputs | None = None,
    precision: Precision = "double",
    newton: Annotated[int | None, LATER] = None,
    table: Annotated[float | None, LATER] = None,
    largest: int | None = None,
    force: bool = False,
    fmu: bool | str = False,
    wasm: bool = False,
    control: bool = False,
    structured_text: bool = False,
) -> Contract:
    """Write a scene as C into a folder: header, source, self-test, example, build files, README.

    Parameters
    ----------
    scene
        The scene.
    out
        The folder.
    name
        Set the prefix of the names in C; default: the scene's name.
    parameters
        Set the default of a parameter, as l=0.25 or phi=30deg.

        With ``table`` they are fixed.
    wanted
        As of :func:`.studies.evaluate.evaluate`.
    precision, newton, table
        As of :class:`.engine.instants.evaluation_method.EvaluationMethod`.
    largest
        Limit the size of a table [bytes]; default: 16 MB, in single precision 64 kB.
    force
        Write into a folder that holds other files as well; these are left as they are.

        Files of an earlier export that were changed since may be there too. Those of the earlier
        export that are no longer written are removed, unless they were changed.
    fmu
        Also write ``<prefix>.fmu``, a unit of FMI 2.0 whose inputs are the motion of the drives,
        and a script that tests it; with ``"time"`` the scene's motion is inside, and with the name
        of a coordinate, as ``"crank"``, its place is the input. Needs FMPy and a C compiler.
    wasm
        Also write ``<prefix>.wasm`` for web pages, with a wrapper in JavaScript; needs ziglang.

        Its types and ``README.wasm.md`` are written as well.
    control
        Also write ``<prefix>_control.hpp``, a class of C++ for controllers as ros2_control's.

        Its test is written too.
    structured_text
        Also write ``<prefix>.st``, function blocks of IEC 61131-3 for PLCs.

        Their test is written too.

    Returns
    -------
    Contract
        Names, units, signs and ranges of the parameters, inputs and outputs of the C.

    Raises
    ------
    PathError
        If the folder holds other files.
    SizeError
        For a table that is too large.
    CompilerError
        For an FMU without a compiler.
    LagrangeCasadiError
        As :func:`.evaluate`.
    """
    folder = Path(out)
    method = EvaluationMethod("auto", precision, newton, table)
    check_writable(folder, folder=True)
    if fmu:
        tools()
    if wasm:
        check_zig("WebAssembly")
    source = sourced(
        scene,
        name or "",
        parameters,
        wanted,
        method,
        LARGEST[precision] if largest is None else largest,
    )
    agreed = source.contract
    texts = {f"{agreed.prefix}.h": header(source), f"{agreed.prefix}.c": source.code}
    texts |= companions(source)
    files = {file: text.encode() for file, text in texts.items()}
    if wasm:
        files |= for_pages(source)
    more = [
        writer for writer, asked in ((for_control, control), (blocks, structured_text)) if asked
    ]
    files |= {file: text.encode() for writer in more for file, text in writer(source).items()}
    units = (f"{agreed.prefix}.fmu", f"{agreed.prefix}_fmu_test.py") if fmu else ()
    known = MANIFEST.known(folder)
    allowed: dict[str, Any] = {"beside": force, "changed": force, "apart": _BUILD}
    MANIFEST.check(folder, [*files, *units], **allowed)
    if known and f"{agreed.prefix}.h" not in known and not force:
        raise PathError(
            f"cannot export into {folder}: it holds an export of another name; {MANIFEST.way_out}"
        )
    if fmu:
        by = fmu if isinstance(fmu, str) else ""
        files |= archive(source, by)
    with MANIFEST.filling(folder, _manifest(source), alone=True, **allowed) as draft:
        for file, content in files.items():
            (draft / file).write_bytes(content)
    return agreed


def _manifest(source: Source) -> dict[str, Json]:
    """Contents of the folder, for programs: names, units and places of all members."""
    agreed = source.contract
    return {
        "versions": {"lagrange_casadi": __version__, "casadi": ca.CasadiMeta.version()},
        "mechanism": agreed.name,
        "prefix": agreed.prefix,
        "precision": agreed.precision,
        "options": source.method,
        "error": {
            "largest": float(f"{source.golden.worst[0]:.0e}"),
            "output": source.golden.worst[1],
        },
        "fixed": dict(source.fixed),
        "scene": source.identity,
        "parameters": [m.described(m.meaning) | {"default": m.default} for m in agreed.settings],
        "inputs": [m.described(m.meaning) for m in agreed.inputs],
        "outputs": [m.described(m.meaning) for m in agreed.outputs],
        **({"sensitivities": [m.name for m in source.slopes.by]} if source.slopes.by else {}),
        "links": [{"name": link.name, "constant": link.constant} for link in agreed.links],
        "model": [
            {"name": name, "type": kind, "count": count} for name, kind, count in source.model
        ],
    }
