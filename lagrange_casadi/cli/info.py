"""``lagrange-casadi info``: what a case or a file holds."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from ..engine.derive import compile_scene
from ..engine.model_data import template
from ..engine.scene_lines import scene_lines
from ..model.description import Description, JointNumbers
from ..model.scene import Scene, kinds
from ..results.solution import Solution
from ..results.store import runs as store
from ..results.store.attributes import described
from ..studies.case import load_case
from ..studies.sweep import Sweep, is_sweep
from ..studies.sweep.axes import counted
from ..studies.sweep.checking import identity_of, progress, unfinished
from ..studies.sweep.meanings import in_words
from ..studies.sweep.plan import Identity
from .echo import echo
from .options import HDF5, refuse
from .report import Rows, asked_line
from .strength_lines import not_evaluated_lines


def info(
    target: Path,
    *,
    wanted: Sequence[str] | None = None,
) -> None:
    """Describe a case, or the file of a run or a sweep.

    For a case it lists parts, drives, loads, posture, wanted outputs and the number of
    instructions. A sweep need not be finished.

    Parameters
    ----------
    target : CASE|FILE.h5|FILE.h5.parts
    wanted
        Count the instructions of these outputs; default: those of the case.
    """
    folder = unfinished(target)
    file = folder or target.suffix in HDF5
    refuse((file and wanted, "--want goes with a case, not with a file"))
    if folder:
        echo(*_sweep_lines(identity_of(folder)), progress(folder))
    elif not file:
        echo(*_case_lines(load_case(target).scene, wanted))
    elif is_sweep(target):
        echo(*_whole_lines(Sweep.open(target)))
    else:
        echo(*_file_lines(store.load(target)))


def _case_lines(scene: Scene, wanted: Sequence[str] | None) -> list[str]:
    program = compile_scene(scene, wanted)
    timing, whole = scene.timing(), kinds(scene.outputs)
    loops = [
        f"{name} ({'iterated' if program.iterates(name) else 'closed form'})"
        for name in program.checks("closure")
    ]
    counts = ", ".join(f"{name} {count}" for name, count in program.instructions.items())
    return [
        *_mechanism_lines(template(scene).at([*scene.values().values()])),
        *scene_lines(scene),
        asked_line(timing.words(program.data.symbols)[:4], timing.slides),
        _ratios(*scene.xi),
        f"outputs: {', '.join(scene.outputs)}"
        + (f"; all of a kind: {', '.join(whole)}" if whole else ""),
        f"wanted: {', '.join(wanted or scene.wanted)}",
        f"loops closed by: {', '.join(loops) or 'none'}",
        f"instructions an instant: {sum(program.instructions.values())} ({counts})",
    ]


def _file_lines(solution: Solution) -> Iterator[str]:
    yield from _mechanism_lines(solution.description)
    yield asked_line((float(solution.t[0]), float(solution.t[-1]), solution.t.size), False)
    if over := solution.over:
        first, last = (over.drawn(over.values[k]) for k in (0, -1))
        yield f"in equal steps of {over.label}: {first:.6g} to {last:.6g}"
    yield _ratios(solution.xi[0], solution.xi[-1], solution.xi.size)
    made = solution.provenance
    yield from _method_lines(
        (made.backend, made.precision, made.compiler, made.flags), made.method, made.versions
    )
    yield from (f"note: {note}" for note in solution.notes)
    yield from not_evaluated_lines(solution)
    if solution.sensitivities.by:
        by = ", ".join(solution.sensitivities.parameters)
        yield f"sensitivities: of {len(solution.sensitivities.quantities)} quantities by {by}"
    yield from Rows.of_all(solution).table()


def _sweep_lines(identity: Identity) -> Iterator[str]:
    mechanism = described(identity["mechanism"])
    yield from _mechanism_lines(mechanism)
    yield from (f"swept {name}: {words}" for name, words in identity["grid"].items())
    asked = identity["t"][:4]
    yield asked_line(asked, len(asked) > 3 and mechanism.coordinates[asked[3]] == "slide")
    if identity["xi"]:
        yield _ratios(*identity["xi"])
    made = (identity["backend"], identity["precision"], identity["compiler"], identity["flags"])
    yield from _method_lines(made, identity["rung"], identity["versions"])


def _whole_lines(sweep: Sweep) -> Iterator[str]:
    yield from _sweep_lines(sweep.identity)
    yield from (
        f"{counted(count)}: {sweep.statuses[status][1]}"
        for status, count in sweep.counts().items()
        if count
    )
    yield "columns:"
    for kept in sweep.columns.values():
        axes = f" over {in_words(kept.axes)}" if kept.axes else ""
        yield f"  {kept.name:<36} {kept.unit:<4} {kept.long_name}{axes}"


def _ratios(first: float, last: float, count: int) -> str:
    return f"xi/l: {first:g} to {last:g}, {count} points"


def _method_lines(made: Sequence[str], method: str, versions: Mapping[str, str]) -> list[str]:
    """Describe the backend, precision, compiler and flags that made numbers, and their method."""
    backend, *others = made
    return [
        f"backend: {backend}, {' '.join(others)}".rstrip(),
        f"method: {method}",
        f"versions: {', '.join(f'{name} {version}' for name, version in versions.items())}",
    ]


def _mechanism_lines(description: Description) -> Iterator[str]:
    yield f"mechanism: {description.name}"
    for name, p in description.parameters.items():
        limits = (
            "" if math.isinf(p.low) and math.isinf(p.high) else f" (range {p.low:g} to {p.high:g})"
        )
        yield f"  parameter {name} = {p.value:g} {p.unit}{limits}"
    for name, body in description.bodies.items():
        size = "point mass" if body.length is None else f"link of {body.length:g} m,"
        thick = ", slices with rotary inertia" if body.slices else ""
        yield f"  {size} {name}: {body.mass:g} kg{thick}"
    for name, joint in description.joints.items():
        ends = " - ".join(f"{p.body} {_vector(description.components(p.at))}" for p in joint.ends)
        moves = (_in_space if description.space else _in_plane)(joint, description)
        yield f"  {joint.kind} joint {name}: {ends}{moves}"
    yield f"  gravity: {_vector(description.components(description.gravity))} m/s^2"
    if description.bars:
        yield f"  two-force links, whose spin has no effect: {', '.join(description.bars)}"


def _in_plane(joint: JointNumbers, description: Description) -> str:
    """Describe a joint of a plane."""
    along = (
        f", along {_vector(joint.triad[0][:2])} of {joint.parent.body}"
        if joint.kind in ("prismatic", "slot")
        else ""
    )
    cosine, sine, _ = joint.turned[0]
    angle = math.atan2(sine, cosine)
    turned = f", at {angle:g} rad ({math.degrees(angle):g} deg)" if angle else ""
    driven = (_driven(axis.coordinate, description) for axis in joint.axes)
    return f"{along}{turned}{''.join(driven)}"


def _in_space(joint: JointNumbers, description: Description) -> str:
    """Describe a joint in space: the axis of each of its coordinates, and what drives it."""
    text, unmeasured = "", set(description.unmeasured)
    for axis in joint.axes:
        if (name := axis.coordinate) not in unmeasured:
            part = name.partition(":")[2]
            lead = f" ({joint.pitch * math.tau:g} m a turn)" if joint.pitch else ""
            word = (
                f"{'along' if axis.kind == 'slide' else 'about'}"
                f" {_vector(axis.direction)}{'' if text else ' of ' + joint.parent.body}"
            )
            text += f", {part + ' ' if part else ''}{word}{lead}{_driven(name, description)}"
    barred = {joint.parent.body, joint.child.body} & set(description.bars)
    return (
        text
        if barred or not unmeasured & {axis.coordinate for axis in joint.axes}
        else f"{text}, closes a loop: its angles are not evaluated"
    )


def _driven(coordinate: str, description: Description) -> str:
    """Describe whether an effort drives a coordinate, and whether its motion is given, if the two
    differ.
    """
    given, drives = coordinate in description.driven, coordinate in description.drives
    if {*description.driven} == {*description.drives, *description.rows.values()}:
        return ", driven" if given else ""
    return f"{', driven' if drives else ''}{', motion given' if given else ''}"


def _vector(components: Sequence[float]) -> str:
    """Components in words; a file that was forged may have any number."""
    return f"({', '.join(f'{component + 0.0:g}' for component in components)})"
