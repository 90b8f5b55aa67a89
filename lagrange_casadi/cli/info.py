"""``lagrange-casadi info``: what a case or a file holds."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
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
    if folder or target.suffix in HDF5:
        refuse((wanted, "--want goes with a case, not with a file"))
        if folder:
            _describe_sweep(identity_of(folder))
            echo(progress(folder))
        elif is_sweep(target):
            _describe_whole(Sweep.open(target))
        else:
            _describe_file(store.load(target))
    else:
        _describe_case(load_case(target).scene, wanted)


def _describe_case(scene: Scene, wanted: Sequence[str] | None) -> None:
    program = compile_scene(scene, wanted)
    _describe_mechanism(template(scene).at([*scene.values().values()]))
    echo(*scene_lines(scene))
    timing = scene.timing()
    echo(asked_line(timing.words(program.data.symbols)[:4], timing.slides))
    echo(f"xi/l: {scene.xi[0]:g} to {scene.xi[1]:g}, {scene.xi[2]} points")
    outputs = scene.outputs
    whole = kinds(outputs)
    echo(
        f"outputs: {', '.join(outputs)}" + (f"; all of a kind: {', '.join(whole)}" if whole else "")
    )
    echo(f"wanted: {', '.join(wanted or scene.wanted)}")
    loops = [
        f"{name} ({'iterated' if program.iterates(name) else 'closed form'})"
        for name in program.checks("closure")
    ]
    echo(f"loops closed by: {', '.join(loops) or 'none'}")
    counts = ", ".join(f"{name} {count}" for name, count in program.instructions.items())
    echo(f"instructions an instant: {sum(program.instructions.values())} ({counts})")


def _describe_file(solution: Solution) -> None:
    _describe_mechanism(solution.description)
    provenance = solution.provenance
    echo(f"t [s]: {solution.t[0]:g} to {solution.t[-1]:g}, {solution.t.size} points")
    if solution.over:
        first, last = (solution.over.drawn(solution.over.values[k]) for k in (0, -1))
        echo(f"in equal steps of {solution.over.label}: {first:.6g} to {last:.6g}")
    echo(f"xi/l: {solution.xi[0]:g} to {solution.xi[-1]:g}, {solution.xi.size} points")
    made = (provenance.backend, provenance.precision, provenance.compiler, provenance.flags)
    _describe_method(made, provenance.method, provenance.versions)
    echo(*(f"note: {note}" for note in solution.notes), *not_evaluated_lines(solution))
    if solution.sensitivities.by:
        by = ", ".join(solution.sensitivities.parameters)
        echo(f"sensitivities: of {len(solution.sensitivities.quantities)} quantities by {by}")
    echo(*Rows.of_all(solution).table())


def _describe_sweep(identity: Identity) -> None:
    mechanism = described(identity["mechanism"])
    _describe_mechanism(mechanism)
    for name, words in identity["grid"].items():
        echo(f"swept {name}: {words}")
    asked, xi = identity["t"][:4], identity["xi"]
    echo(asked_line(asked, len(asked) > 3 and mechanism.coordinates[asked[3]] == "slide"))
    if xi:
        echo(f"xi/l: {xi[0]:g} to {xi[1]:g}, {xi[2]} points")
    made = (identity["backend"], identity["precision"], identity["compiler"], identity["flags"])
    _describe_method(made, identity["rung"], identity["versions"])


def _describe_method(made: Sequence[str], method: str, versions: Mapping[str, str]) -> None:
    """Describe the backend, precision, compiler and flags that made numbers, and their method."""
    backend, *others = made
    echo(f"backend: {backend}, {' '.join(others)}".rstrip())
    echo(f"method: {method}")
    echo(f"versions: {', '.join(f'{name} {version}' for name, version in versions.items())}")


def _describe_whole(sweep: Sweep) -> None:
    _describe_sweep(sweep.identity)
    for status, count in sweep.counts().items():
        if count:
            echo(f"{counted(count)}: {sweep.statuses[status][1]}")
    echo("columns:")
    for kept in sweep.columns.values():
        axes = f" over {in_words(kept.axes)}" if kept.axes else ""
        echo(f"  {kept.name:<36} {kept.unit:<4} {kept.long_name}{axes}")


def _describe_mechanism(description: Description) -> None:
    echo(f"mechanism: {description.name}")
    for name, p in description.parameters.items():
        limits = (
            "" if math.isinf(p.low) and math.isinf(p.high) else f" (range {p.low:g} to {p.high:g})"
        )
        echo(f"  parameter {name} = {p.value:g} {p.unit}{limits}")
    for name, body in description.bodies.items():
        size = "point mass" if body.length is None else f"link of {body.length:g} m,"
        thick = ", slices with rotary inertia" if body.slices else ""
        echo(f"  {size} {name}: {body.mass:g} kg{thick}")
    for name, joint in description.joints.items():
        ends = " - ".join(f"{p.body} {_vector(description.components(p.at))}" for p in joint.ends)
        moves = (_in_space if description.space else _in_plane)(joint, description)
        echo(f"  {joint.kind} joint {name}: {ends}{moves}")
    echo(f"  gravity: {_vector(description.components(description.gravity))} m/s^2")
    if description.bars:
        echo(f"  two-force links, whose spin has no effect: {', '.join(description.bars)}")


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
