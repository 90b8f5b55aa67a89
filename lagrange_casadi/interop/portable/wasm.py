"""An exported program as WebAssembly, for web pages: the module, a wrapper in JavaScript, its
types, and what to read first.
"""

from __future__ import annotations

import json
import math
import re
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import partial

import numpy as np

from ...base.packages import check_installed
from ...engine.codegen.compiler import Compiler, built
from .contract import Contract
from .header import header
from .sections import about
from .source import Source
from .stack import deepest
from .text import comment, markdown, template

_FLAGS = ("-std=c99", "-Oz", "-ffp-contract=off", "-fno-math-errno")
_ALONE = ("-target", "wasm32-wasi", "-mexec-model=reactor")
_WITH_BROWSER = ("-target", "wasm32-freestanding", "-nostdlib", "-mcpu=generic+bulk_memory", "-I.")
_ERF = re.compile(r"\berf\(")
"""The one function that a browser lacks."""
_STACK = 1 << 16
"""Bytes beside those that the program states: for the C library's mathematics."""

_CALLS = ("prepare", "motion", "batch", "message")


def check_zig(what: str) -> None:
    """Raise :class:`LagrangeCasadiError` where the package that compiles is missing, which ``what``
    needs.
    """
    check_installed("ziglang", what, "live")


def page_build(
    source: Source, more: Mapping[str, str], calls: Sequence[str]
) -> Callable[[], bytes]:
    """Prepare the module of a page, which imports the browser's ``Math``; returns what compiles it.

    ziglang then need not build a C library, which takes it a minute where its cache is empty.
    ``more`` are other files of C with functions ``calls`` that are seen too. Raises as :func:`wasm`
    does.
    """
    if any(map(_ERF.search, (source.code, *more.values()))):
        return _build(source, more, _ALONE, calls)
    files = {**more, "math.h": template("browser_math.h")}
    return _build(source, files, _WITH_BROWSER, calls)


def _build(
    source: Source, more: Mapping[str, str], target: Sequence[str], calls: Sequence[str] = ()
) -> Callable[[], bytes]:
    """Prepare a module; what is returned compiles it, in any thread, by ziglang, which
    :func:`check_zig` has found.
    """
    c = source.contract
    exported = [f"{c.prefix}_{call}" for call in (*_CALLS, *(["section"] if c.links else []))]
    size, stack = places(source)["end"], -(-(deepest(source.code) + _STACK) // 16) * 16
    linked = [f"-Wl,--export={name}" for name in (*exported, *calls, "__heap_base")]
    linked += ["-Wl,--no-entry", "-Wl,--strip-all", f"-Wl,-z,stack-size={stack}"]
    files = {
        f"{c.prefix}.h": header(source),
        f"{c.prefix}.c": source.code,
        # It compiles only where a model takes as many bytes as the wrapper declares.
        "layout.c": f'#include "{c.prefix}.h"\n'
        f"typedef char as_known[sizeof({c.prefix}_model) == {size} ? 1 : -1];\n",
        **more,
    }
    code = [file for file in files if file.endswith(".c")]
    compiler = Compiler("c", (sys.executable, "-m", "ziglang", "cc"), "")
    command = [*compiler.command, *_FLAGS, *target, *linked, *code, "-o", "module.wasm"]
    return partial(built, compiler, command, files, "module.wasm")


def layout(source: Source) -> dict[str, int | str]:
    """Layout of the C's structs for the wrapper: the number of numbers in each, and the bytes of a
    model.
    """
    c = source.contract
    return {
        "prefix": c.prefix,
        "precision": c.precision,
        "model": places(source)["end"],
        "parameters": len(c.settings),
        "inputs": len(c.inputs),
        "outputs": len(c.outputs),
        "forces": len(_forces(c)),
    }


def places(source: Source) -> dict[str, int]:
    """Places of a model's members [bytes], and at ``end`` their sum."""
    kinds = {"real": "f4" if source.contract.rests else "f8", "int": "i4", "unsigned": "u4"}
    members = [(name, kinds[kind], (count,)) for name, kind, count in source.model]
    model = np.dtype(members, align=True)
    return {name: at for name, (_, at, *_) in (model.fields or {}).items()} | {
        "end": model.itemsize
    }


def wasm(source: Source) -> dict[str, bytes]:
    """The files for web pages, by name; the module imports nothing.

    The same program gives the same bytes, as far as the compiler does. Raises
    :class:`CompilerError` for what it refuses.
    """
    c, content = source.contract, _build(source, {}, _ALONE)()
    texts = {
        f"{c.prefix}.js": template(
            "wasm.js", **_words(source), contract=_contract(source), engine=template("engine.js")
        ),
        f"{c.prefix}.d.ts": _types(source),
        "README.wasm.md": _page(source, len(content)),
    }
    return {f"{c.prefix}.wasm": content} | {file: text.encode() for file, text in texts.items()}


def _words(source: Source) -> dict[str, object]:
    """Words of a comment's line."""
    return source.words | {"name": " ".join(comment(source.contract.name).split())}


def _forces(c: Contract) -> tuple[str, ...]:
    return c.table.forces if c.links else ()


def _contract(source: Source) -> str:
    c = source.contract
    content = {
        "name": c.name,
        "prefix": c.prefix,
        "precision": c.precision,
        "model": places(source)["end"],
        "parameters": [
            m.described(m.comment)
            | {
                "default": m.default,
                "low": m.low if math.isfinite(m.low) else None,
                "high": m.high if math.isfinite(m.high) else None,
            }
            for m in c.settings
        ],
        "inputs": [m.described(m.comment) for m in c.inputs],
        "outputs": [m.described(m.comment) for m in c.outputs],
        "links": [link.name for link in c.links],
        "forces": [
            {
                "name": name,
                "unit": c.table.row("section", name).unit,
                "meaning": about(c.table, name),
            }
            for name in _forces(c)
        ],
    }
    return json.dumps(content, indent=1)


def _types(source: Source) -> str:
    c = source.contract

    def members(rows: Sequence[tuple[str, str]]) -> str:
        return "\n".join(
            f"  /** {comment(described)} */\n  {name}: number;" for name, described in rows
        )

    return template(
        "wasm.d.ts",
        **_words(source),
        parameters=members([(m.name, m.comment) for m in c.settings]),
        inputs=members([(m.name, m.comment) for m in c.inputs]),
        outputs=members([(m.name, m.comment) for m in c.outputs]),
        forces=members([(name, about(c.table, name)) for name in _forces(c)]),
        links=" | ".join(json.dumps(link.name) for link in c.links) or "never",
    )


def _page(source: Source, size: int) -> str:
    c, times = source.contract, source.golden.times
    return template(
        "wasm.md",
        **source.words | {"name": markdown(c.name)},
        size=size,
        default="".join(f"{m.default:.6g}" for m in c.settings[:1]),
        first=f"{times[0]:.6g}",
        times=", ".join(f"{time:.6g}" for time in times[:3]),
        story=source.story,
    )
