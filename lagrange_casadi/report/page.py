"""A report as one page of HTML that needs nothing else: no server, no network, no other file.

The viewer's sources in ``assets`` are what a page holds, word for word: plain JavaScript and CSS, nothing is built. What a solution
says goes beside them as JSON; the viewer makes the page's elements of it, as texts and never as markup. A page may run no other
script than the viewer, whose digest it tells the browser, and may load nothing.
"""

from __future__ import annotations

import base64
import hashlib
import html
import json
import os
from importlib import resources
from pathlib import Path
from string import Template

from ..errors import DeclarationError
from ..export.wasm import engine
from ..instants.solution import Solution
from ..system.publish import writing
from .contents import contents
from .live import Live

SCRIPTS = (
    *("data", "dom", "units", "law", "places", "paper", "solids", "symbols", "arrows", "ribbons", "stage", "gestures"),
    *("player", "axes", "chart", "polar", "heat", "cards", "tables", "sliders", "page"),
)
"""The viewer's sources, in the order in which they stand in a page."""

LIVE_SCRIPTS = ("chebyshev", "along", "shapes", "alive")
"""Those that a live page has beside, after the engine's own wrapper."""

ENDINGS = (".html", ".htm")


def write_report(solution: Solution, path: str | os.PathLike[str], live: Live | None = None) -> None:
    """Write a page that shows a solution in a browser, replacing the file at ``path`` whole or not at all.

    With ``live`` the page evaluates its scene for other parameters.

    Raises :class:`.DeclarationError` where the solution lacks the motion of its bodies, and where ``path`` does not end in .html;
    :class:`.PathError` and :class:`.StoreError` where the file cannot be written.
    """
    if not isinstance(solution, Solution) or not isinstance(path, (str, os.PathLike)):
        raise DeclarationError(f"report: expected a solution and a path, got {solution!r} and {path!r}")
    target = Path(path)
    if target.suffix.lower() not in ENDINGS:
        raise DeclarationError(f"report {target}: expected a name that ends in {' or '.join(ENDINGS)}")
    text = page(solution, live).encode()
    with writing(target) as (file,):
        file.write(text)


def page(solution: Solution, live: Live | None = None) -> str:
    """The text of the page."""
    alive = [engine(), *(_asset(f"{name}.js") for name in LIVE_SCRIPTS)] if live else []
    script = "".join(["(() => {\n'use strict';\n", *alive, *(_asset(f"{name}.js") for name in SCRIPTS), "})();\n"])
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode("ascii")
    data = json.dumps(contents(solution, live), allow_nan=False, separators=(",", ":"), ensure_ascii=True)
    return Template(_asset("page.html")).substitute(
        title=html.escape(solution.case),
        # A browser compiles WebAssembly only where a page says so.
        run=f"'sha256-{digest}'" + (" 'wasm-unsafe-eval'" if live else ""),
        style=_asset("page.css"),
        script=script,
        # No text in JSON can end the element that holds it, or begin a comment.
        data=data.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026"),
    )


def _asset(name: str) -> str:
    return resources.files(__package__).joinpath("assets").joinpath(name).read_text(encoding="utf-8")
