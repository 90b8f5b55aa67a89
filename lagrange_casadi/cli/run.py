"""``lagrange-casadi run``: evaluate a case, store it, draw it."""

from __future__ import annotations

import math
import os
from collections.abc import Collection, Iterator, Sequence
from contextlib import nullcontext, suppress
from pathlib import Path
from typing import Any

import numpy as np

from ..base.arrays import Array
from ..base.files import check_writable
from ..base.quantities import AVERAGED, Output
from ..base.streams import is_standard_output
from ..base.table_writers import aligned
from ..base.vocabulary import Backend
from ..engine.instants.backends import peak_search
from ..errors import CompilerError, DeclarationError, listed
from ..model import revolutions
from ..model.scene import Scene
from ..model.times import Timing
from ..model.wanted_names import among
from ..results.data_frames import TIME, columns
from ..results.drive_use import Use
from ..results.ordering import error_of, ordered
from ..results.sensitivity.peak_derivatives import PeakKind
from ..results.solution import Solution
from ..results.store.runs import check_target, save
from ..results.store.specs import dump_specs
from ..results.verification.certificate import refuse_failed, summary
from ..studies.case import load_case
from ..studies.evaluate import evaluate
from ..studies.peaks_between import forces, refine, resultants
from ..studies.sensitivities import Changes, sensitivities
from ..studies.sweep.axes import counted
from ..views.shapes.index import MANIFEST
from .drawing import draw_with_progress
from .echo import echo
from .options import HDF5, refuse, table_file, target
from .report import Rows, readable
from .strength_lines import not_evaluated_lines, strength_cards, strength_lines

_SCREEN = 39
"""Lines of a screen, but for that of the next prompt."""
_FEWEST = 8
"""Rows of the table, however much else there is to say."""

_BLOCK = 1024


def run(
    case: Path,
    *,
    wanted: Sequence[str] | None = None,
    out: Path | None = None,
    figures: Path | None = None,
    no_figures: bool = False,
    svg: bool = False,
    csv: Path | None = None,
    decimal_comma: bool = False,
    grids: bool | None = None,
    refine_peaks: bool = False,
    elastic: bool = False,
    no_certificate: bool = False,
    verbose: bool = False,
    **given: Any,
) -> None:
    """Compute efforts, reactions and section forces of CASE.

    CASE is a folder with a case.py, a Python file, or a name that the command cases lists. The
    largest values are listed, all results are written to an HDF5 file, and figures are drawn.

    Parameters
    ----------
    case : CASE
    parameters, t, over, xi
        As of :func:`.studies.evaluate.evaluate`.
    wanted
        As of :func:`.studies.evaluate.evaluate`: Compute these outputs: effort, reaction:JOINT,
        section:LINK, motion, sensitivity:PARAMETER, a kind such as section, or all; default: those
        of the case.
    backend, precision, newton, table, flags
        As of :class:`.engine.instants.evaluation_method.EvaluationMethod`.
    threads
        As of :func:`.studies.evaluate.evaluate`.
    out
        Write the results to this HDF5 file; default: <case>.h5 here.
    figures
        Draw the figures into this folder; default: <case>_figures here.
    no_figures
        Draw no figures.
    svg
        Draw figures as SVG, in place of PNG.
    csv
        Also write the results as CSV, one row per instant. A name that ends in .xlsx makes a
        workbook.
    decimal_comma
        As of :func:`.cli.table.best`.
    grids
        Store section forces at all ratios xi/l beside their laws, of all links or of none;
        default: of all but pieces of bent bars.
    refine_peaks
        Search for the listed peaks between the instants too.
    elastic
        Determine statically indeterminate forces by the elasticity of the links' beams.
    no_certificate
        Do not check the results by an independent balance of forces.
    verbose
        List all quantities, with strength and deflection in full.
    """
    refuse(
        (figures and no_figures, "--figures and --no-figures exclude each other"),
        (svg and no_figures, "--svg and --no-figures exclude each other"),
    )
    table = table_file(csv, decimal_comma)
    loaded = load_case(case)
    scene, usual = loaded.scene, Path(f"{loaded.name}.h5")
    out = target("--out", out, str(usual), HDF5)
    folder = None if no_figures else figures or Path(f"{loaded.name}_figures")
    _check_places(out, folder, csv)
    if refine_peaks:
        peak_search()  # so that a compiler that lacks is named at once
    solution = evaluate(
        scene,
        wanted=wanted,
        certificate=not no_certificate,
        elastic=(scene.elastic or True) if elastic else None,
        **given,
    )
    place = folder or (Path(f"{loaded.name}_figures") if out == usual else None)
    replaced, before, drawn = out.exists(), figures_in(place), set[str]()
    heads = columns(solution, solution.sensitivities) if table else {}
    written = (
        table.written([TIME, *heads], _rows([solution.t, *heads.values()]))
        if table
        else nullcontext()
    )
    with written, MANIFEST.filling(folder) if folder else nullcontext() as draft:
        if folder and draft:
            draw_with_progress(solution, loaded.figures, draft, svg=svg)
            drawn = figures_in(draft)
        save(solution, out, dump_specs(loaded.figures), grids=_grids(solution, grids, wanted or ()))
    names = [*forces(solution), *resultants(solution)] if refine_peaks else ()
    refined = refine(scene, solution, names) if names else ()
    rows = Rows.of(scene, solution, refined, wanted or (), verbose)
    strength = scene if refine_peaks else None
    head = [_head(solution, refine_peaks if rows.rows else None), *rows.cards()]
    shown, details = wanted or scene.wanted, list[str]()
    if wanted or verbose:
        details += strength_lines(solution, shown, strength)
    else:
        head += strength_cards(solution, shown, strength)
    head += drive_lines(solution)
    rest = [*slope_lines(solution, scene, given["backend"]), *details, *rows.notes()]
    rest += _notes(scene, solution, scene.timing(given["t"], given["over"]))
    if folder and not loaded.figures:
        parts = [*solution.description.beams, *solution.description.fitted]
        rest += not_evaluated_lines(solution, among("safety", parts, shown))
    if not no_certificate:
        rest.append(summary(solution.certificate))
    rest += replaced_lines(out, replaced, place, before if replaced else before & drawn, drawn)
    rest.append(
        f"wrote {out}"
        + (f" and the figures in {folder}/" if folder else "")
        + (f", and {csv}" if csv else "")
    )
    capacity = None if verbose else max(_SCREEN - len(head) - len(rest) - 1, _FEWEST)
    piped = csv is not None and is_standard_output(csv)
    echo(*head, *rows.table(capacity), *rest, err=piped)
    refuse_failed(solution, f"{out} is marked as not certified")


def _rows(columns: Sequence[Array]) -> Iterator[list[float]]:
    """The rows of columns of one length."""
    for start in range(0, columns[0].size, _BLOCK):
        yield from np.column_stack([column[start : start + _BLOCK] for column in columns]).tolist()


def _grids(solution: Solution, grids: bool | None, wanted: Sequence[str]) -> bool | list[str]:
    """Links whose grids are stored: pieces of bent bars where they were asked for by name."""
    pieces, links = solution.description.pieces, solution.links_with_sections
    usual = [link for link in links if link not in pieces or f"section:{link}" in wanted]
    return usual if grids is None else grids


def _check_places(out: Path, folder: Path | None, csv: Path | None) -> None:
    """Raise ``click.UsageError`` for places that are the same, and what says that one cannot be
    written.
    """
    check_target(out)
    file, figures, table = (os.path.realpath(one) if one else None for one in (out, folder, csv))
    refuse(
        (figures == file, f"--figures {folder}: expected another place than the file's"),
        (
            table and table in (file, figures),
            f"--csv {csv}: expected another place than the file's and the figures'",
        ),
    )
    if folder:
        check_writable(folder, folder=True)
        MANIFEST.check(folder)


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
    values = np.array([list(solution.description.values.values())])
    turning = revolutions.note(scene.prescribed, solution.description.kinds, timing, values)
    stamps = dict.fromkeys(law.note for law in scene.laws.values())
    yield from (f"note: {note}" for note in (*solution.notes, *stamps, turning) if note)


def drive_lines(solution: Solution) -> Iterator[str]:
    """Write what is used of the limits of drives."""

    def cells(use: Use | None) -> list[str]:
        if use is None:
            return ["", "", ""]
        over = ", EXCEEDED" if use.share > 1.0 else ""
        value = readable(use.value, error_of(solution, use.name), use.limit)
        return [value, use.unit, f"{100.0 * float(value) / use.limit:.3g} %{over}"]

    if found := solution.drives_used():
        heads = ["drive", "effort", "", "of limit", "speed", "", "of limit"]
        rows = [[name, *cells(one.effort), *cells(one.speed)] for name, one in found.items()]
        yield from aligned(heads, rows, left=(0, 2, 5))


_WIDTH = 13
_WORDS = {
    PeakKind.END: "at an end of the instants",
    PeakKind.SWITCH: "at a kink or a jump",
    PeakKind.LINK_END: "at an end of the link",
    PeakKind.UNKNOWN: "at a kink or a jump of unknown origin",
}


def slope_lines(solution: Solution, scene: Scene, backend: Backend) -> Iterator[str]:
    """The derivatives of the peaks and means that a run prints, if sensitivities were wanted: a
    column for each parameter.
    """
    by = solution.sensitivities.parameters
    names = [str(output) for output in ordered(solution) if solution.determined(output)]
    if not by or not names:
        return
    try:
        found = sensitivities(scene, solution, backend=backend)
        changes = found.peaks(names)
    except (CompilerError, DeclarationError) as error:  # such as of a very rough table
        yield f"derivatives of peaks are not available: {error}"
        return
    units = {name: solution.description.parameters[name].unit for name in by}
    yield "derivatives of peaks, between the instants too, per unit of"
    yield f"{'':<30}" + " ".join(f"{f'{name} [{units[name]}]':>{_WIDTH}}" for name in by)
    for name, change in zip(names, changes, strict=True):
        yield _line(name, change, by)
    averaged = [name for name in names if Output.of(name).group in AVERAGED]
    if averaged:
        yield "derivatives of means over time and of root mean squares"
    for name in averaged:
        yield _line(f"mean:{name}", found.mean(name), by)
        yield _line(f"rms:{name}", found.rms(name), by)


def _line(name: str, change: Changes, by: tuple[str, ...]) -> str:
    cells = [
        f"{slope + 0.0:.6g}" if math.isfinite(slope) else "none"
        for slope in (change.slopes[parameter] for parameter in by)
    ]
    where = _WORDS.get(change.kind) if change.kind is not None else None
    if change.tied:
        where = f"{where + ', ' if where else ''}equally large elsewhere, with other derivatives"
    return (
        f"  {name:<28}"
        + " ".join(f"{cell:>{_WIDTH}}" for cell in cells)
        + (f"  {where}" if where else "")
    )


def figures_in(folder: Path | None) -> set[str]:
    """The names of the pictures in a folder; none where there is no folder, or none that can be
    read.
    """
    with suppress(OSError):
        files = folder.iterdir() if folder else ()
        return {path.name for path in files if path.suffix in (".png", ".svg")}
    return set()


def replaced_lines(
    file: Path, replaced: bool, folder: Path | None, before: Collection[str], drawn: Collection[str]
) -> Iterator[str]:
    """Say whether the file was replaced, how many figures were, and which ones ``before`` in the
    folder are older than the file.
    """
    over = [name for name in before if name in drawn]
    what = [str(file)] if replaced else []
    if over:
        what.append(f"{counted(len(over), 'figure')} in {folder}/")
    if what:
        yield f"replaced {' and '.join(what)}"
    older = sorted(set(before) - set(drawn))
    if older:
        redraw = "" if drawn else f"; lagrange-casadi plot {file} --out {folder} draws them anew"
        yield f"note: figures in {folder}/ that are older than {file}: {listed(older)}{redraw}"
