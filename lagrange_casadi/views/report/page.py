"""A report as one page of HTML that needs nothing else: no server, no network, no other file.

The viewer's sources in ``assets`` are what a page holds, word for word: plain JavaScript and CSS,
nothing is built. What a solution says goes beside them as JSON; the viewer makes the page's
elements of it, as texts and never as markup. A page may load nothing, and may run no script except
the viewer: its policy gives the browser the digest of the viewer.
"""

from __future__ import annotations

import base64
import hashlib
import html
import json
import os
from collections.abc import Callable, Mapping, Sequence
from importlib import resources
from pathlib import Path
from string import Template

from ...base.arrays import Json
from ...base.files import writing
from ...errors import DeclarationError
from ...interop.portable.text import template
from ...model.scene import Scene
from ...results.solution import Solution
from ...studies.evaluate import evaluate
from .live import Live, run_of
from .page_contents import contents

SCRIPTS = (
    *(
        "data",
        "dom",
        "together",
        "units",
        "switches",
        "instants",
        "law",
        "places",
        "paper",
        "solids",
        "symbols",
        "arrows",
        "ribbons",
        "stage",
        "gestures",
    ),
    *(
        "player",
        "axes",
        "chart",
        "polar",
        "heat",
        "diagrams",
        "save",
        "card",
        "cards",
        "sorted",
        "tables",
        "sliders",
        "page",
    ),
)
"""The viewer's sources, in the order in which they stand in a page."""

LIVE_SCRIPTS = ("bernstein", "along", "shapes", "posture", "alive", "drag")
"""Scripts of a live page before the others, after the engine's own wrapper."""

SWEEP_SCRIPTS = (
    "data",
    "dom",
    "units",
    "switches",
    "axes",
    "card",
    "sorted",
    "designs",
    "designs_plots",
    "designs_page",
)
"""Scripts of the page of a sweep."""

COMPARISON_SCRIPTS = (
    "data",
    "dom",
    "units",
    "switches",
    "axes",
    "card",
    "sorted",
    "save",
    "comparison",
)
"""Scripts of the page of two runs."""

ENDINGS = (".html", ".htm")


def write_report(
    solution: Solution, path: str | os.PathLike[str], live: Live | None = None
) -> None:
    """Write a page that shows a solution in a browser, replacing the file at ``path`` whole or not
    at all.

    With ``live`` the page evaluates its scene for other parameters. Raises
    :class:`.DeclarationError` where the solution lacks the motion of its bodies, and where ``path``
    does not end in .html; :class:`.PathError` and :class:`.StoreError` where the file cannot be
    written.
    """
    write_page(Path(path), lambda: page(solution, live))


def write_page(target: Path, made: Callable[[], str]) -> None:
    """Write the page that is ``made``, replacing the file whole or not at all.

    Raises what :func:`write_report` does.
    """
    if target.suffix.lower() not in ENDINGS:
        raise DeclarationError(
            f"report {target}: expected a name that ends in {' or '.join(ENDINGS)}"
        )
    text = made().encode()
    with writing(target) as file:
        file.write(text)


def page(solution: Solution, live: Live | None = None, clock: Json = None) -> str:
    """The text of the page; within a page of two runs with the ``clock`` of both."""
    content = contents(solution, live) | ({"clock": clock} if clock else {})
    return assembled(solution.case, content, viewer(bool(live)), wasm=bool(live))


def assembled(
    title: str,
    content: Mapping[str, Json],
    scripts: Sequence[str],
    *,
    wasm: bool = False,
    connect: bool = False,
    others: Sequence[Sequence[str]] = (),
) -> str:
    """A page with ``content`` as JSON, which runs ``scripts``; with ``wasm`` it may compile that,
    and with ``connect`` ask its server.

    ``others`` are the scripts that pages within it run.
    """
    data = json.dumps(content, allow_nan=False, separators=(",", ":"), ensure_ascii=True)
    return Template(asset("page.html")).substitute(
        title=html.escape(title),
        policy=policy(scripts, wasm=wasm, connect=connect, others=others),
        style=asset("page.css"),
        script=_whole(scripts),
        # No text in JSON can end the element that holds it, or begin a comment.
        data=data.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026"),
    )


def policy(
    scripts: Sequence[str],
    *,
    wasm: bool = False,
    connect: bool = False,
    others: Sequence[Sequence[str]] = (),
) -> str:
    """The policy of content of a page that runs ``scripts``: see :func:`assembled`."""
    run = [f"'sha256-{one}'" for one in map(_digest, (scripts, *others))]
    # A browser compiles WebAssembly only where a page says so.
    run += ["'wasm-unsafe-eval'"] if wasm else []
    asked = "; connect-src 'self'" if connect else ""
    return (
        f"default-src 'none'; script-src {' '.join(run)}; style-src 'unsafe-inline'; img-src data:"
        f"{asked}"
    )


def viewer(live: bool) -> list[str]:
    """The sources of the viewer, with the engine where it is ``live``."""
    alive = [template("engine.js"), *map(script, LIVE_SCRIPTS)] if live else []
    return [*alive, *map(script, SCRIPTS)]


def script(name: str) -> str:
    """A source of the viewer."""
    return asset(f"{name}.js")


def _whole(scripts: Sequence[str]) -> str:
    return "".join(["(() => {\n'use strict';\n", *scripts, "})();\n"])


def _digest(scripts: Sequence[str]) -> str:
    return base64.b64encode(hashlib.sha256(_whole(scripts).encode()).digest()).decode("ascii")


def asset(name: str, package: str = __package__) -> str:
    """A file of the viewer, or of another package's page."""
    return resources.files(package).joinpath("assets").joinpath(name).read_text(encoding="utf-8")


def scene_report(
    scene: Scene,
    path: str | os.PathLike[str],
    parameters: Mapping[str, float] | None,
    wanted: Sequence[str] | None,
    live: bool,
) -> None:
    """Evaluate a scene and write its page: see :meth:`.Scene.report`."""
    scene.wants(wanted)
    asked = with_motion(scene.wanted if wanted is None else wanted)
    alive = Live.of(scene, scene.timing(), asked, run_of(scene.name), parameters) if live else None
    found = evaluate(scene, parameters=parameters, wanted=asked, elastic=False if live else None)
    write_report(found, path, alive)


def with_motion(wanted: Sequence[str]) -> list[str]:
    """Wanted outputs with motion, without which nothing can be shown."""
    return list(wanted) if {"all", "motion"} & set(wanted) else [*wanted, "motion"]
