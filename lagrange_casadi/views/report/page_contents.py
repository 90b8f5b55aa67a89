"""Contents of a page, as plain numbers and texts: the one place that defines what the viewer in the
page reads.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array, Json
from ...base.quantities import Output
from ...base.tables import Table
from ...engine.instants.beyond_equilibrium import held_outputs
from ...model.description import Description, JointNumbers
from ...results.derivatives import derivatives
from ...results.ordering import error_of, ordered
from ...results.solution import Solution
from ...results.statistics import Extreme
from ...results.strength.all_parts import looked
from ...results.verification.certificate import failure, summary
from ..shapes.curves import patterns
from ..shapes.orthographic import upright
from ..shapes.poses import Poses, require_poses
from ..shapes.primitives import carried, disc_axis, drawing, size_of
from ..shapes.shapes import named_spots, shapes
from ..shapes.symbols import BODY, FOOT, INK, PAPER, PATH, STAND, SYMBOLS, Line
from .array_block import Arrays, finite
from .instants import drive_entry, mark, shown_instants
from .live import Live, live_entry
from .maps import map_entries
from .page_sections import section_entries
from .words import GROUPS, what

VERSION = 1
"""Version of a page's contents."""

_INKS = {INK: "ink", PAPER: "sheet", PATH: "path", STAND: "soft", FOOT: "faint", BODY: "body"}
"""Names of a page's colours by those of symbols."""

_LOADED = ("effort", "reaction", "stress", "utilisation", "deflection")
_CHARTED = (*_LOADED, "output", "motion", "load", "friction", "multiplier", "pose")


def contents(solution: Solution, live: Live | None = None) -> dict[str, Json]:
    """All of a page about a solution; with ``live`` the engine that evaluates its scene for other
    parameters, too.

    Raises :class:`.DeclarationError` where the solution does not have the poses of all bodies,
    which the picture is made of.
    """
    require_poses(solution)
    arrays, chosen = Arrays(), shown_instants(solution)
    description = solution.description
    found = {
        "version": VERSION,
        "case": solution.case,
        "conventions": solution.table.conventions,
        "space": description.space,
        "upright": upright(description.gravity).tolist(),
        "gravity": list(description.components(description.gravity)),
        "instants": {
            "total": solution.t.size,
            "shown": int(chosen.size),
            "t": arrays.add(solution.t[chosen]),
            "over": drive_entry(solution, chosen, arrays),
        },
        "bodies": list(_bodies(solution, chosen, arrays)),
        "joints": [_joint(joint, description) for joint in description.joints.values()],
        "named": list(named_spots(description)),
        "loads": [
            {
                "name": name,
                "kind": load.kind,
                "spots": [*map(asdict, load.points)],
                "closed": load.closed or 0.0,
                "lines": [line.tolist() for line in patterns(load)],
            }
            for name, load in description.loads.items()
        ],
        "symbols": {kind: [*map(_outline, outlines)] for kind, outlines in SYMBOLS.items()},
        "carried": list(_carried(description, Poses.of(solution))),
        "paths": [{"name": name} | asdict(spot) for name, spot in description.paths.items()],
        "series": [*series_of(solution, chosen, arrays)],
        "sections": list(section_entries(solution, chosen, arrays)),
        "maps": list(map_entries(solution, arrays)),
        "groups": GROUPS,
        "rows": [*_rows(solution)],
        "strength": list(_strength(solution)),
        "drives": [{"name": name} | asdict(use) for name, use in solution.drives_used().items()],
        "parameters": [
            {
                "name": name,
                "value": parameter.value,
                "unit": parameter.unit,
                "low": finite(parameter.low),
                "high": finite(parameter.high),
            }
            for name, parameter in description.parameters.items()
        ],
        "certificate": _certificate(solution),
        "notes": [*solution.notes, *(live.notes if live else ())],
        "undetermined": list(solution.undetermined),
        "provenance": (
            asdict(solution.provenance) | {"versions": dict(solution.provenance.versions)}
        ),
    }
    if live:
        found["live"] = live_entry(live, solution, chosen, arrays)
    return found | {"arrays": arrays.places, "numbers": arrays.block()}


def _bodies(
    solution: Solution, chosen: npt.NDArray[np.intp], arrays: Arrays
) -> Iterator[dict[str, Json]]:
    """The bodies' shapes, colours, axes of discs, and poses: in the plane x, y and the angle; in
    space a place, and three axes one by one.
    """
    poses = Poses.of(solution)
    for shape in shapes(solution.description):
        values = np.hstack([poses.bases[shape.name], poses.axes[shape.name].reshape(-1, 9)]).T
        if not solution.description.space:
            angle = solution.pose(shape.name).angle
            values = np.stack([*values[:2], 0.0 * values[0] if angle is None else angle])
        axis = disc_axis(poses, shape)
        yield asdict(shape) | {
            "colour": poses.colours[shape.name],
            "around": None if axis is None else axis.tolist(),
            "pose": [arrays.add(column[chosen]) for column in values],
        }


def _series(
    output: Output, table: Table, unit: str, values: int, **others: Json
) -> dict[str, Json]:
    """A quantity over the instants that are shown, for charts; ``values`` is the number of its
    array, ``places`` that of the ratios xi/l at which a section force is largest in size.
    """
    return {
        "name": str(output),
        "group": output.group,
        "part": output.part,
        "what": what(output, table),
        "unit": unit,
        "values": values,
        "places": None,
        **others,
    }


def _carried(description: Description, poses: Poses) -> Iterator[dict[str, Json]]:
    """The lines that move with a body or stand on the ground, in the axes of that."""
    first = poses.during([0])
    for body, line in carried(first, poses, size_of(drawing(first, poses))):
        yield {
            "body": body,
            "points": ((line.points[0] - first.bases[body][0]) @ first.axes[body][0].T).tolist(),
            "of": line.body,
            "width": line.width,
            "closed": line.closed,
            "filled": line.opacity > 0.0,
            "dashed": line.dashed,
        }


def _outline(one: Line) -> dict[str, Json]:
    """An outline of a symbol, its colours by the names that they have in a page."""
    return {
        "points": one.points.round(2).tolist(),
        "closed": one.closed,
        "width": one.width,
        "fill": _INKS.get(one.fill, ""),
        "ink": _INKS[one.colour],
    }


def series_of(
    solution: Solution, chosen: npt.NDArray[np.intp], arrays: Arrays
) -> Iterator[dict[str, Json]]:
    """The quantities of a solution that can be charted, at the instants that are chosen."""
    table = solution.table
    resultants = (
        output
        for output in ordered(solution)
        if len(output.components(table)) > 1 and output.group in ("reaction", "load")
    )
    outputs = [output for output in solution.quantities() if output.group in (*_CHARTED, "section")]
    for output in sorted(
        [*outputs, *resultants], key=lambda output: list(GROUPS).index(output.group)
    ):
        if not solution.determined(output):
            continue
        values, places = solution.extremes(output)
        along = None if places is None else arrays.add(places[chosen])
        of = map(str, solution.made_of(output)) if places is None else ()
        unit = solution.unit(output)
        yield _series(output, table, unit, arrays.add(values[chosen], *of), places=along)
    for slope in derivatives(solution, solution.sensitivities):
        if slope.values.ndim == 1 and slope.output.group in _CHARTED:
            by = f"{what(slope.output, table) or slope.output.part}, by {slope.name.split(':')[1]}"
            yield _series(
                slope.output,
                table,
                slope.unit,
                arrays.add(slope.values[chosen]),
                name=slope.name,
                group="sensitivity",
                what=by,
            )
    for output, values in held_outputs(solution.holding).items():
        unit = solution.unit(output)
        yield _series(output, table, unit, arrays.add(values[chosen]), group="holding")
    for output, values in _residuals(solution):
        yield _series(output, table, "1", arrays.add(values[chosen]))


def _rows(solution: Solution) -> Iterator[dict[str, Json]]:
    """The quantities over all instants: their peaks, how far these may be off, ends and means; only
    the names of those that are ``open``.
    """

    def marked(extreme: Extreme) -> dict[str, Json]:
        return mark(solution, extreme.value, extreme.t, extreme.xi)

    for output in ordered(solution):
        row: dict[str, Json] = {
            "name": str(output),
            "group": output.group,
            "part": output.part,
            "what": what(output, solution.table),
            "unit": solution.unit(output),
        }
        if not solution.determined(output):
            nothing = ("peak", "error", "smallest", "largest", "mean", "rms")
            yield row | {"open": True} | dict.fromkeys(nothing)
            continue
        statistics = solution.statistics(output)
        yield {
            **row,
            "open": False,
            "peak": marked(statistics.peak),
            "error": error_of(solution, output),
            "smallest": marked(statistics.smallest),
            "largest": marked(statistics.largest),
            "mean": finite(statistics.mean),
            "rms": finite(statistics.rms),
        }


def _strength(solution: Solution) -> Iterator[dict[str, Json]]:
    """Utilisation of links and joints for each mode of failure, and whether that governs; infinite
    factors are none.

    What is ``open`` has its reason.
    """
    for found in looked(solution):
        for verdict in found.verdicts:
            yield {
                "part": found.link,
                "against": verdict.against,
                "where": verdict.where,
                "open": False,
                "factor": finite(verdict.factor),
                "used": 1.0 / verdict.factor if verdict.factor else None,
                "governs": verdict is found.governs,
            }
        for why in found.not_evaluated:
            yield {
                "part": found.link,
                "against": "",
                "where": why,
                "open": True,
                "factor": None,
                "used": None,
                "governs": False,
            }


def _joint(joint: JointNumbers, description: Description) -> dict[str, Json]:
    axes = [axis.direction for axis in joint.axes] if description.space else joint.triad[:1]
    return {
        "name": joint.name,
        "kind": joint.kind,
        "parent": asdict(joint.parent),
        "child": asdict(joint.child),
        "axes": axes,
        "second": joint.carried,
        "coordinates": [(axis.coordinate, axis.kind) for axis in joint.axes],
        "driven": [a.coordinate for a in joint.axes if a.coordinate in description.drives],
    }


def _residuals(solution: Solution) -> Iterator[tuple[Output, Array]]:
    """The certificate in the order of the table, which a file does not keep."""
    for row in solution.table.rows:
        if row.group == "certificate" and row.member in solution.certificate:
            yield Output("certificate", "", row.member), solution.certificate[row.member]


def _certificate(solution: Solution) -> dict[str, Json]:
    """The certificate in words, and its residuals."""
    state = "certified" if solution.certified else "failed" if solution.failed else "none"
    residuals = [
        {
            "name": output.member,
            "what": what(output, solution.table),
            "largest": finite(float(np.max(values))),
        }
        for output, values in _residuals(solution)
    ]
    words = (
        failure(solution)
        if solution.failed
        else summary({output.member: values for output, values in _residuals(solution)})
    )
    return {
        "state": state,
        "words": words,
        "tolerance": finite(solution.tolerance),
        "residuals": residuals,
    }
