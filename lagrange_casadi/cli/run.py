"""``lagrange-casadi run``: evaluate a case, store it, draw it."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import nullcontext
from functools import partial
from pathlib import Path

import click
import numpy as np

from ..base.publish import check_writable
from ..base.streams import is_standard_output
from ..base.table_file import TableFile
from ..base.vocabulary import Backend, Precision
from ..case import load_case
from ..declare import revolutions
from ..declare.description import beams_of, fitted_of, kinds_of_described, pieces_of, values_of
from ..declare.even_points import EvenPoints
from ..declare.scene import Scene
from ..declare.times import Over, Timing
from ..declare.wanted_names import among
from ..errors import CertificateError
from ..instants.frames import TIME, columns
from ..instants.solution import Solution
from ..shapes.index import MANIFEST
from ..shapes.kept import dump_specs
from ..store.runs import check_target, save
from ..studies.evaluate import evaluate
from ..studies.peaks import forces, refine, resultants
from ..verification.certificate import failure, summary
from .drawing import draw_with_progress
from .echo import echo
from .elastic_lines import elastic_card, elastic_lines
from .options import parameters
from .replaced import figures_in, replaced_lines
from .report import Rows
from .rows import rows_of
from .slope_lines import slope_lines
from .strength_lines import not_evaluated_lines, strength_cards, strength_lines

_SCREEN = 39
"""Lines of a screen, but for that of the next prompt."""
_FEWEST = 8
"""Rows of the table, however much else there is to say."""


def run(
    case: Path,
    settings: Sequence[tuple[str, float | str]],
    t: EvenPoints | None,
    over: Over | None,
    xi: EvenPoints | None,
    want: Sequence[str],
    backend: Backend,
    precision: Precision,
    newton: int | None,
    table: float | None,
    flags: str,
    threads: int | None,
    out: Path | None,
    figures: Path | None,
    no_figures: bool,
    svg: bool,
    csv: TableFile | None,
    grids: bool | None,
    refine_peaks: bool,
    elastic: bool,
    no_certificate: bool,
    verbose: bool,
) -> None:
    """See :func:`.commands.run`."""
    if figures and no_figures:
        raise click.UsageError("--figures and --no-figures exclude each other")
    if svg and no_figures:
        raise click.UsageError("--svg and --no-figures exclude each other")
    if out and out.suffix not in (".h5", ".hdf5"):
        raise click.UsageError(f"--out {out}: expected a name that ends in .h5 or .hdf5")
    loaded = load_case(case)
    scene = loaded.scene
    out = out or Path(f"{loaded.name}.h5")
    folder = None if no_figures else figures or Path(f"{loaded.name}_figures")
    _check_places(out, folder, csv)
    solution = evaluate(
        scene,
        parameters=parameters(settings),
        t=t,
        over=over,
        xi=xi,
        wanted=want or None,
        backend=backend,
        precision=precision,
        newton=newton,
        table=table,
        flags=flags,
        threads=threads,
        certificate=not no_certificate,
        elastic=(scene.elastic or True) if elastic else None,
    )
    usual = Path(f"{loaded.name}_figures") if out == Path(f"{loaded.name}.h5") else None
    place = folder or usual
    replaced, before, drawn = out.exists(), figures_in(place), set[str]()
    heads = columns(solution) if csv else {}
    written = (
        csv.written([TIME, *heads], rows_of([solution.t, *heads.values()]))
        if csv
        else nullcontext()
    )
    with written, MANIFEST.filling(folder) if folder else nullcontext() as draft:
        if folder and draft:
            draw_with_progress(solution, loaded.figures, draft, svg=svg)
            drawn = figures_in(draft)
        save(solution, out, dump_specs(loaded.figures), grids=_grids(solution, grids, want))
    say = partial(echo, err=csv is not None and is_standard_output(csv.path))
    asked = want or scene.wanted
    names = [*forces(solution), *resultants(solution)] if refine_peaks else ()
    rows = Rows.of(solution, refine(scene, solution, names) if names else (), want, verbose)
    strength = scene if refine_peaks else None
    head = [_head(solution, refine_peaks if rows.rows else None), *rows.cards()]
    if want or verbose:
        details = [*strength_lines(solution, asked, strength), *elastic_lines(solution, asked)]
    else:
        head += elastic_card(solution, asked)
        head += strength_cards(solution, asked, strength)
        details = []
    rest = [*slope_lines(solution, scene, backend), *details, *rows.notes()]
    rest += _notes(scene, solution, scene.timing(t, over))
    if folder and not loaded.figures:
        parts = [*beams_of(solution.description), *fitted_of(solution.description)]
        rest += not_evaluated_lines(solution, among("safety", parts, asked))
    if not no_certificate:
        rest.append(summary(solution.certificate))
    rest += replaced_lines(out, replaced, place, before if replaced else before & drawn, drawn)
    rest.append(
        f"wrote {out}"
        + (f" and the figures in {folder}/" if folder else "")
        + (f", and {csv.path}" if csv else "")
    )
    capacity = None if verbose else max(_SCREEN - len(head) - len(rest) - 1, _FEWEST)
    for line in (*head, *rows.table(capacity), *rest):
        say(line)
    if solution.failed:
        raise CertificateError(f"{failure(solution)}; {out} is marked as not certified")


def _grids(solution: Solution, grids: bool | None, want: Sequence[str]) -> bool | list[str] | None:
    """Links whose grids are stored: pieces of bent bars where they were asked for by name."""
    pieces = pieces_of(solution.description)
    links = solution.links_with_sections
    asked = {link for link in links if link in pieces and f"section:{link}" in want}
    if grids is not None or not asked:
        return grids
    return [link for link in links if link not in pieces or link in asked]


def _check_places(out: Path, folder: Path | None, csv: TableFile | None) -> None:
    """Raise ``click.UsageError`` for places that are the same, and what says that one cannot be
    written.
    """
    check_target(out)
    if folder:
        if os.path.realpath(folder) == os.path.realpath(out):
            raise click.UsageError(f"--figures {folder}: expected another place than the file's")
        check_writable(folder, folder=True)
        MANIFEST.check(folder)
    if csv:
        if os.path.realpath(csv.path) in [
            os.path.realpath(other) for other in (out, folder) if other
        ]:
            raise click.UsageError(
                f"--csv {csv.path}: expected another place than the file's and the figures'"
            )
        csv.check()


def _head(solution: Solution, refined: bool | None) -> str:
    """Write what was evaluated, above the largest values if there are any."""
    span = f" over {solution.t[-1] - solution.t[0]:.5g} s" if solution.t.size > 1 else ""
    largest = {
        None: "",
        False: "; largest at the instants:",
        True: "; largest, refined between the instants:",
    }
    return (
        f"{solution.case}: {solution.t.size} instants{span}, {solution.xi.size} ratios xi/l,"
        f" backend {solution.provenance.backend}{largest[refined]}"
    )


def _notes(scene: Scene, solution: Solution, timing: Timing) -> Iterator[str]:
    values = np.array([list(values_of(solution.description).values())])
    turning = revolutions.note(
        scene.prescribed, kinds_of_described(solution.description), timing, values
    )
    yield from (f"note: {note}" for note in (*solution.notes, turning) if note)
