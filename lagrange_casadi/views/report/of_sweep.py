"""A sweep as a page for browsers: maps, fronts, a table of designs, and the mechanism of the design
that is looked at, in motion.

The mechanism is a live page within the page: it evaluates the design that is chosen.
"""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import Any

import numpy as np

from ...base.arrays import Array, as_json
from ...base.units import vocabulary
from ...engine.derive import compile_scene
from ...engine.identity import identity_of, sources
from ...engine.model_data import template
from ...errors import DeclarationError
from ...model.scene import Scene, Wanted
from ...model.wanted_names import SENSITIVITY
from ...results.store.untrusted import reported_as, structured
from ...studies.evaluate import evaluate
from ...studies.sweep.axes import DESIGN
from ...studies.sweep.best import best
from ...studies.sweep.meanings import STATUS
from ...studies.sweep.reading import Sweep
from ..charts.panels import varied
from ..charts.usual_designs import usual_pair
from . import Live, assembled, page, with_motion, write_page
from .array_block import Arrays
from .live import run_of
from .page import SWEEP_SCRIPTS, script, viewer

MOST = 300_000
"""Numbers that a page holds at most: 8 bytes each, 11 in the page."""

_LEAST = 500
"""Designs that it shows at least, where there are so many."""

_NO_SCENE = "For the mechanism in motion, make the page with the case that was swept."


def write_sweep_report(
    sweep: Sweep, path: str | os.PathLike[str], scene: Scene | None = None, command: str = ""
) -> None:
    """Write a page that shows a sweep, replacing the file at ``path`` whole or not at all.

    With its ``scene`` the mechanism of each design moves; ``command`` is how a command line begins
    that evaluates it. Raises :class:`.DeclarationError` for the scene of another sweep, for a sweep
    without columns to show, and what :func:`.write_report` raises.
    """
    write_page(Path(path), lambda: _page(sweep, scene, command))


def is_of(sweep: Sweep, scene: Scene) -> bool:
    """Return whether a sweep is of a scene: its parts are those that were swept, and, if the same
    code wrote them, its expressions too.
    """
    values = sweep.description.values
    if (
        values.keys() != scene.parameters.keys()
        or template(scene).at([*values.values()]) != sweep.description
    ):
        return False
    known = identity_of(scene, _wanted(sweep))
    return (
        known is None or sweep.identity["sources"] != sources() or known == sweep.identity["scene"]
    )


def _page(sweep: Sweep, scene: Scene | None, command: str) -> str:
    if scene is not None and not is_of(sweep, scene):
        raise DeclarationError(
            f"{sweep.path}: the sweep was made with another scene; give the case that was swept,"
            " without later changes"
        )
    names = [name for name, column in sweep.columns.items() if not column.axes and name != STATUS]
    if not names:
        raise DeclarationError(
            f"{sweep.path}: there is nothing to show: it keeps no column with one value for each"
            " design"
        )
    pair = next(iter(usual_pair(sweep, {})), tuple(names[:2]))
    front = [design.number for design in best(sweep, minimise=pair)] if len(pair) == 2 else []
    arrays, values = Arrays(), _shown(sweep, [*sweep.parameters, *names, STATUS], front)
    content: dict[str, Any] = {
        "case": sweep.case,
        "parameters": [
            {
                "name": name,
                "title": name,
                "unit": unit,
                "sized": False,
                "values": arrays.add(values[name]),
            }
            for name, unit in sweep.parameters.items()
        ],
        "columns": [
            {
                "name": name,
                "title": name,
                "unit": sweep.unit(name),
                "sized": name.startswith("peak:"),
                "values": arrays.add(values[name]),
            }
            for name in names
        ],
        "varied": varied(sweep),
        "units": vocabulary(),
        "pair": list(pair),
        "counts": [
            [f"without: {sweep.statuses[status][1]}" if status else "with a result", count]
            for status, count in sweep.counts().items()
            if count
        ],
        "statuses": {str(number): words for number, (_, words) in sweep.statuses.items()},
        "command": command or run_of(sweep.case),
        "note": _NO_SCENE,
        "frame": None if scene is None else _frame(sweep, scene, front, command),
        "designs": {
            "shown": values[DESIGN].size,
            "total": sweep.size,
            "grid": DESIGN not in sweep.dimensions,
            "numbers": arrays.add(values[DESIGN]),
            "status": arrays.add(values[STATUS]),
        },
        "arrays": arrays.places,
        "numbers": arrays.block(),
    }
    return assembled(
        f"{sweep.case}: a sweep",
        content,
        [script(name) for name in SWEEP_SCRIPTS],
        wasm=scene is not None,
        others=[viewer(live=True)] if scene is not None else [],
    )


def _shown(sweep: Sweep, names: list[str], front: list[int]) -> dict[str, Array]:
    """Columns of the designs that are shown, by name, and their numbers: all, or evenly spread ones
    and those of the front.
    """
    stride = math.ceil(sweep.size / max(_LEAST, MOST // (len(names) + 1)))
    before, parts = 0, []
    for numbers, values in sweep.blocks(names):
        places = before + np.arange(numbers.size)
        there = (places % stride == 0) | np.isin(numbers, front)
        parts.append([column[there] for column in (numbers, *values.values())])
        before += numbers.size
    columns = (np.concatenate(blocks).astype(float) for blocks in zip(*parts, strict=True))
    return dict(zip((DESIGN, *names), columns, strict=True))


def _frame(sweep: Sweep, scene: Scene, front: list[int], command: str) -> str:
    """The live page of the mechanism, which begins with a design that has a result."""
    first = (
        front[0]
        if front
        else next(
            (int(n) for numbers, v in sweep.blocks([STATUS]) for n in numbers[v[STATUS] == 0]), None
        )
    )
    if first is None:
        raise DeclarationError(f"{sweep.path}: no design has a result: there is nothing to show")
    asked, design = sweep.identity["t"], sweep.design(first)
    wanted = with_motion(_wanted(sweep).names)
    program = compile_scene(scene, wanted, parameters=design)
    own = as_json(scene.timing().words(program.data.symbols))
    words: dict[str, Any] = {}
    if own != asked:
        if any(isinstance(bound, str) for bound in (*asked[:2], *asked[4:])):
            raise DeclarationError(
                f"{sweep.path}: its instants are not those of the scene: {asked}"
            )
        words = {"over": (asked[3], *asked[:3])} if len(asked) > 3 else {"t": tuple(asked)}
    live = Live.of(scene, scene.timing(**words), wanted, command, design)
    return page(evaluate(scene, parameters=design, wanted=wanted, elastic=False, **words), live)


def _wanted(sweep: Sweep) -> Wanted:
    """The outputs that were wanted. Raises :class:`.StoreError` where the file does not say."""
    # Of sensitivities the graph knows nothing.
    content = {
        name: value for name, value in sweep.identity["wanted"].items() if name != SENSITIVITY
    }
    with reported_as("the outputs of the sweep", sweep.path):
        found: Wanted = structured(Wanted, content, "wanted")
    return found
