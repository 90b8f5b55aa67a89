"""Pictures of a solution, by the specs that say what is drawn (:mod:`.results.store.specs`);
matplotlib is imported when one is drawn.
"""

from __future__ import annotations

import os
import re
import textwrap
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...base.arguments import public
from ...base.arrays import Array, every
from ...base.quantities import Output
from ...base.tables import PLANE, SPACE
from ...errors import DeclarationError, PathError, UnknownNameError, shown
from ...results.elastic.deflection import bending_of
from ...results.histories import Peak
from ...results.ordering import vanishes
from ...results.solution import Solution
from ...results.store.specs import (
    DeflectionPlot,
    MechanismDrawing,
    PolarPlots,
    SectionDiagrams,
    SectionMaps,
    SpanPlot,
    Spec,
    StrengthPlot,
    TimePlot,
    UtilisationPlot,
)
from ...results.strength.all_parts import NEEDED, fitted_in, strong_of
from ..shapes.picture_files import one_at_a_time, save, subplots
from ..shapes.readable import instant, number, scale_for
from .deflection_plot import draw_deflection
from .diagrams import draw_polar, draw_section_diagrams, polar_members
from .link_map import PIXELS, draw_map
from .mechanism_figure import draw_mechanism
from .strength_plot import draw_strength, draw_utilisation

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_LABEL = 40

_DRAWN = ("effort", "reaction", "multiplier", "load", "friction", "output")
"""Groups of outputs that are drawn over time."""

_FILE = re.compile(r"[A-Za-z0-9_-]+")


@public
def default_figures(solution: Solution) -> tuple[Spec, ...]:
    """Return the specifications of the usual figures of a solution.

    Parameters
    ----------
    solution : Solution
        Result of :func:`.evaluate`.

    Returns
    -------
    tuple of Spec
        Specifications for all that the solution has, without the welds inside bent bars.
    """
    specs: list[Spec] = []
    internal = solution.description.bends
    groups: dict[tuple[str, str], list[str]] = {}
    for output, values in solution.outputs.items():
        drawn = output.group in _DRAWN or output == Output("motion", output.part)
        if drawn and output.part not in internal and solution.determined(output) and np.any(values):
            suffix = "_own" if output.member.endswith(("u", "v", "w")) else ""
            if suffix and all(solution.determined(other) for other in _in_ground_axes(output)):
                continue
            # Force and moment of a joint are one picture, and so is all of a declared point: its
            # place, speed and acceleration.
            point = output.part.rpartition("_")[0]
            part = (
                point
                if output.group == "output" and point in solution.description.paths
                else output.part
            )
            groups.setdefault((f"{output.group}{suffix}", part), []).append(str(output))
    for (group, part), names in groups.items():
        what = part if group == "output" else f"{group.replace('_', ' ')} of {part}"
        specs.append(
            TimePlot(f"{group}_{part.replace(':', '-')}", tuple(names), f"{solution.case}: {what}")
        )
    bent = tuple(
        link
        for link in solution.links_with_sections
        if solution.determined(Output("section", link, "bending"))
    )
    specs += [SectionMaps(f"section_{link}", link) for link in bent]
    if bent:
        specs.append(SectionDiagrams("diagrams", bent))
    bearings = tuple(
        name
        for name, joint in solution.description.joints.items()
        if (joint.kind in ("revolute", "cylindrical") or joint.turning is not None)
        and polar_members(solution, name)
    )
    if bearings:
        specs.append(PolarPlots("bearings", bearings))
    specs += [StrengthPlot(f"strength_{link}", link) for link in strong_of(solution)]
    links, joints = strong_of(solution, *NEEDED), fitted_in(solution)
    if links or joints:
        specs.append(UtilisationPlot("utilisation", links, joints))
    specs += [DeflectionPlot(f"deflection_{link}", link) for link in bending_of(solution)]
    overlay = (
        () if solution.table is SPACE else (MechanismDrawing("positions", count=8, overlay=True),)
    )
    return (*specs, *overlay, MechanismDrawing())


def _in_ground_axes(output: Output) -> Iterator[Output]:
    """The components in ground axes of a reaction that is given on the joint's own."""
    return (Output(output.group, output.part, output.member[0] + component) for component in "xyz")


@public
def draw(
    solution: Solution,
    specs: Sequence[Spec],
    folder: str | os.PathLike[str],
    si: bool = False,
    svg: bool = False,
) -> Iterator[tuple[Spec, Path | None]]:
    """Draw figures of a solution into a folder, one by one.

    Parameters
    ----------
    solution : Solution
        Result of :func:`.evaluate`.
    specs : sequence of Spec
        Specifications of the figures; the usual ones if there are none.
    folder : path
        An existing folder.
    si : bool
        Show SI units without prefixes, in place of readable ones such as kN and mm.
    svg : bool
        Write SVG in place of PNG.

    Yields
    ------
    tuple of Spec and Path
        Each specification with its file, or None if the solution lacks what it shows.

    Raises
    ------
    DeclarationError
        For what is not a specification.
    PathError
        If the folder does not exist.
    """
    chosen, folder = specs or default_figures(solution), Path(folder)
    ending = ".svg" if svg else ".png"
    for spec in chosen:
        if not _FILE.fullmatch(spec.name) or sum(other.name == spec.name for other in chosen) > 1:
            raise DeclarationError(
                f"figure '{spec.name}': expected letters, digits, underscores and hyphens, each"
                " name once"
            )
        _check_parts(solution, spec)
    if not os.path.isdir(folder):
        raise PathError(f"draw: expected an existing folder, got {shown(folder)}")
    for spec in chosen:
        path = folder / f"{spec.name}{ending}" if _has(solution, spec) else None
        if path:
            save(spec.draw(solution, si), path, ending, dpi=120)
        yield spec, path


def _check_parts(solution: Solution, spec: Spec) -> None:
    """Raise :class:`UnknownNameError` for a quantity of a part that the mechanism does not have."""
    parts = solution.description.parts
    for name in spec.needs():
        part = Output.of(name).part
        if part.partition(":")[0] not in parts:
            raise UnknownNameError(f"part in figure '{spec.name}'", part, parts)


def _has(solution: Solution, spec: Spec) -> bool:
    if isinstance(spec, MechanismDrawing):
        return all(
            Output("pose", body, "x") in solution.outputs for body in solution.description.bodies
        )
    names = set(solution.names())
    return all(
        str(component) in names
        for name in spec.needs()
        for component in Output.of(name).components(solution.table)
    )


@one_at_a_time()
def drawn(spec: Spec, solution: Solution, si: bool = False) -> Figure:
    """The figure of a spec."""
    return _FIGURES[type(spec)](spec, solution, si)


def _time(spec: TimePlot, solution: Solution, si: bool) -> Figure:
    units: dict[str, list[str]] = {}
    for name in spec.quantities:
        units.setdefault(solution.unit(name), []).append(name)
    tall = 4.2 if len(units) == 1 else 2.8 * len(units) + 0.6
    figure, plots = subplots((7.0, tall), len(units), sharex=True)
    for axes, names in zip(plots, units.values(), strict=True):
        for name in names:
            _draw_time(spec, axes, solution, name)
        _finish(axes, solution, names, si)
    plots[0].set_title(spec.title or spec.quantities[0], fontsize=11)
    plots[-1].set_xlabel(_along(solution)[1])
    return _noted(figure, spec.note)


def _draw_time(spec: TimePlot, axes: Axes, solution: Solution, name: str) -> None:
    output = Output.of(name)
    label = name.partition(":")[2].replace(":", " ") if len(spec.quantities) > 1 else None
    factor = 0.0 if vanishes(solution, output) else spec.factor
    if output.group != "section":
        axes.plot(_along(solution)[0], factor * solution.array(output), label=label)
        return
    values = solution.section(output.part).law.on_grid(output.member, np.array(spec.xi))
    for xi, curve in zip(spec.xi, values.T, strict=True):
        of = f"{label}, " if label else ""
        axes.plot(_along(solution)[0], factor * curve, label=rf"{of}$\xi/l$ = {xi:g}")


def _span(spec: SpanPlot, solution: Solution, si: bool) -> Figure:
    figure, (axes,) = subplots((7.0, 4.2))
    i = int(np.argmin(np.abs(solution.t - spec.t)))
    output = Output.of(spec.quantity)
    values = (
        solution.section(output.part)
        .law.during(slice(i, i + 1))
        .on_grid(output.member, solution.xi)
    )
    axes.plot(solution.xi, (0.0 if vanishes(solution, output) else spec.factor) * values[0])
    at = instant(solution, i)
    _finish(axes, solution, [spec.quantity], si)
    axes.set_title(f"{spec.title}, {at}" if spec.title else at, fontsize=11)
    axes.set_xlabel(r"$\xi/l$")
    return _noted(figure, spec.note)


def _maps(spec: SectionMaps, solution: Solution, si: bool) -> Figure:
    names = [Output("section", spec.link, force) for force in solution.table.forces]
    names = [name for name in names if solution.determined(name)]
    across = 1 if solution.table is PLANE else 2
    down = -(-len(names) // across)
    instants, ratios = (every(size, PIXELS) for size in (solution.t.size, solution.xi.size))
    law, xi = solution.section(spec.link).law.during(instants), solution.xi[ratios]
    places, along = _along(solution)
    figure, plots = subplots((8.0 * across, 2.8 * down), down, across, sharex=True)
    for axes, name in zip(plots, names, strict=False):
        values, peak = law.on_grid(name.member, xi), solution.peak(name)
        nothing = vanishes(solution, name)
        if nothing:
            values, peak = np.zeros_like(values), replace(peak, value=0.0)
        bound, signed = abs(peak.value) or 1.0, len(name.components(solution.table)) == 1
        scale = scale_for(peak.unit, abs(peak.value), si)
        (x, at), what = _place_of(peak, solution), name.meant(solution.table).long_name
        said = rf"peak {scale.said(peak.value)} at {at}, $\xi/l$ = {peak.xi:.3f}"
        draw_map(
            axes,
            (places[instants], xi),
            values,
            (-bound if signed else 0.0, bound),
            scale,
            what,
            f"{what}: {'zero everywhere' if nothing else said}",
            None if nothing else (x, peak.xi),
        )
    for axes in plots[-across:]:
        axes.set_xlabel(along)
    for axes in plots[len(names) :]:
        axes.set_axis_off()
    figure.suptitle(
        f"{solution.case}: section forces of {spec.link}, as the tip's side acts on the base's"
    )
    return figure


_FIGURES: dict[type[Spec], Callable[[Any, Solution, bool], Figure]] = {
    TimePlot: _time,
    SpanPlot: _span,
    SectionMaps: _maps,
    SectionDiagrams: lambda spec, drawn, si: draw_section_diagrams(drawn, spec.links, si),
    PolarPlots: lambda spec, drawn, si: draw_polar(drawn, spec.joints, si),
    MechanismDrawing: lambda spec, drawn, si: draw_mechanism(drawn, spec, si),
    StrengthPlot: lambda spec, drawn, si: draw_strength(drawn, spec.link, *_along(drawn), si),
    UtilisationPlot: lambda spec, drawn, _: draw_utilisation(drawn, (*spec.links, *spec.joints)),
    DeflectionPlot: lambda spec, drawn, si: draw_deflection(drawn, spec.link, *_along(drawn), si),
}


def _along(solution: Solution) -> tuple[Array, str]:
    """Abscissa of figures: times, or the coordinate by which instants were defined, an angle in
    degrees.
    """
    if solution.over is None:
        return solution.t, "t [s]"
    return solution.over.drawn(solution.over.values), solution.over.label


def _place_of(peak: Peak, solution: Solution) -> tuple[float, str]:
    """Abscissa of a peak, and its description."""
    if solution.over is None or peak.over is None:
        return peak.t, f"t = {number(peak.t)} s"
    return float(solution.over.drawn(peak.over)), solution.over.shown(peak.over)


def _noted(figure: Figure, note: str) -> Figure:
    """A figure with a note below it."""
    if note:
        figure.supxlabel(note, fontsize=8, color="0.35")
    return figure


def _finish(axes: Axes, solution: Solution, names: Sequence[str], si: bool) -> None:
    """Name and scale the axis of curves of one unit."""
    words = [
        o.part if o.group == "output" else o.meant(solution.table).long_name.partition(":")[0]
        for o in map(Output.of, names)
    ]
    curves = axes.get_lines()
    if len(curves) > 1:
        words = list(dict.fromkeys(word.partition(",")[0] for word in words))
    sizes = (float(np.nanmax(np.abs(curve.get_ydata()), initial=0.0)) for curve in curves)
    scale = scale_for(solution.unit(names[0]), max(sizes, default=0.0), si)
    scale.put(axes.yaxis)
    axes.set_ylabel("\n".join(textwrap.wrap(f"{', '.join(words)} [{scale.unit}]", _LABEL)))
    axes.axhline(0.0, color="0.6", linewidth=0.8, zorder=0)
    axes.grid(True, color="0.9")
    axes.margins(x=0.0)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(fontsize=10)
