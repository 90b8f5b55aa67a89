"""Views of a scene or a solution in notebooks: a drawing and the peaks at once, and the page of a
report inside them.
"""

from __future__ import annotations

from contextlib import suppress
from html import escape

from ...engine.model_data import template
from ...errors import DeclarationError, LagrangeCasadiError
from ...model.scene import Scene
from ...results.ordering import ON_PARTS, ordered
from ...results.pictures import View
from ...results.solution import Solution
from ..shapes.index import html_table
from ..shapes.poses import require_poses
from .page import page
from .still import still
from .words import what

_ROWS = 12
"""Peaks that are shown beside those of loads and friction: the largest of each unit first."""


def view(solution: Solution, height: int = 760) -> View:
    """A report's page for a notebook.

    Raises :class:`.DeclarationError` for no height, and as :func:`.page` does.
    """
    if height < 1:
        raise DeclarationError(
            f"view: expected a height in points, a whole number above 0, got {height!r}"
        )
    return View(solution.case, page(solution), height)


def scene_summary(scene: Scene) -> str:
    """A drawing of a scene at its first instant, and its parts: as HTML."""
    drawing = ""
    with suppress(LagrangeCasadiError):
        drawing = scene.draw().svg
    asked, content = scene.timing(), template(scene).at([*scene.values().values()])
    over = f"over {escape(asked.joint)}" if asked.joint else "over time"
    lines = [f"<b>{escape(content.name)}</b>: {asked.count} instants {over}"]
    parts = {
        "bodies": list(content.bodies),
        "joints": [f"{name} ({joint.kind})" for name, joint in content.joints.items()],
        "loads": list(content.loads),
        "motion of": list(scene.motion),
        "parameters": [
            f"{name} = {one.value:g} {one.unit}" for name, one in content.parameters.items()
        ],
        "wanted": list(scene.wanted),
    }
    lines += [f"{word}: {escape(', '.join(names))}" for word, names in parts.items() if names]
    return _side_by_side(drawing, "".join(f"<p>{line}</p>" for line in lines))


def summary(solution: Solution) -> str:
    """A drawing, where the solution has the motion, and the peaks: as HTML."""
    drawing = ""
    with suppress(DeclarationError):
        require_poses(solution)
        drawing = still(solution)
    state = (
        "certified"
        if solution.certified
        else "<b>the certificate fails</b>"
        if solution.failed
        else "no certificate"
    )
    span = f"{solution.t.size} instants from {solution.t[0]:.5g} to {solution.t[-1]:.5g} s"
    head = f"<p><b>{escape(solution.case)}</b>: {span}, {state}</p>"
    return _side_by_side(drawing, head + _table(solution))


def _side_by_side(drawing: str, text: str) -> str:
    return (
        '<div style="display:flex;flex-wrap:wrap;gap:1em;align-items:start">'
        f"{drawing}<div>{text}</div></div>"
    )


def _table(solution: Solution) -> str:
    """The peaks of efforts, resultants, section forces and own outputs; of many, those of loads
    and friction, and the largest of each unit.
    """
    peaks = {
        output: solution.peak(output)
        for output in ordered(solution)
        if solution.determined(output)
        and (output.group != "reaction" or output.member in solution.table.reactions)
    }
    largest: dict[str, float] = {}
    for peak in peaks.values():
        largest[peak.unit] = max(largest.get(peak.unit, 0.0), abs(peak.value))
    by_size = sorted(
        peaks, key=lambda output: -abs(peaks[output].value) / (largest[peaks[output].unit] or 1.0)
    )
    rows = []
    for output in (one for one in peaks if one.group in ON_PARTS or one in by_size[:_ROWS]):
        peak = peaks[output]
        where = f"{peak.t:.5g} s" + ("" if peak.xi is None else f", xi/l = {peak.xi:.3f}")
        value = f"{peak.value + 0.0:.5g}" + ("" if peak.unit == "1" else f" {peak.unit}")
        rows.append((output.part, what(output, solution.table), value, where))
    more = (
        f"<p>and {len(peaks) - len(rows)} more; view() shows all</p>"
        if len(peaks) > len(rows)
        else ""
    )
    return html_table(("part", "quantity", "peak", "at"), rows) + more if rows else ""
