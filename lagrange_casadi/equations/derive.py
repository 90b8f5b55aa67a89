"""From a scene to its graphs: kinematics, Lagrange terms and internal forces put together, and nothing that is not wanted."""

from __future__ import annotations

import functools
import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any

import casadi as ca

from ..declare.description import describe
from ..declare.ends import beyond_ends
from ..declare.held import effective_lengths, ends_of
from ..declare.limits import told_parameters
from ..declare.mechanism import Mechanism
from ..declare.motion import motion_function
from ..declare.scene import Scene, Wanted
from ..declare.spatial import reference_posture
from ..errors import AssemblyError, MobilityError, PostureError
from ..geometry.vectors import ZERO
from ..quantities import Output, force_members
from ..system import cache
from ..tables import ANGLE
from . import kinematics
from .assembly import assemble
from .checks import Check, Column
from .deflections import deflections
from .drives import closure, pushed
from .fingerprint import fingerprint
from .kinematics import Start
from .least_work import feeling, least_work
from .mobility import internal_forces, needed_reactions
from .multibody import Coordinate, Multibody, column, own_coordinate
from .open_forces import open_forces
from .own import own_outputs
from .reciprocals import share_reciprocals
from .scene_graph import SceneGraph
from .stations import gathered
from .strength import stresses, utilisation
from .tree import span
from .turns import count_turns


def derive(scene: Scene, wanted: Sequence[str] | None = None, *, iterate: bool = False, elastic: bool = False) -> SceneGraph:
    """Derive the graphs of a scene, for its own wanted outputs or for others: CasADi functions of an instant, and their names.

    With ``iterate`` every loop is left to Newton's method, and none is solved in closed form. With ``elastic`` it tells how forces
    change with what equilibrium leaves open.

    A graph is derived once: it is kept while the process lasts, and in the cache folder by the content of the declaration.

    Raises :class:`MobilityError`, :class:`DeclarationError` or :class:`AssemblyError` where the loops cannot be solved.
    """
    try:
        found = _kept(scene, Wanted.of(scene.mechanism, scene.wanted if wanted is None else wanted), iterate, elastic)
    except PostureError as error:
        error.scene = scene
        raise
    if isinstance(found, SceneGraph):
        return found
    raise type(found)(str(found))


def assembled(
    scene: Scene,
    values: Mapping[str, float],
    wanted: Sequence[str] | None = None,
    *,
    iterate: bool = False,
    elastic: bool = False,
) -> Scene:
    """The scene; or where its loops cannot be assembled with its own parameters, the same assembled with ``values`` of all.

    Raises what :func:`derive` does, where they can be assembled with neither.
    """
    try:
        derive(scene, wanted, iterate=iterate, elastic=elastic)
    except (AssemblyError, MobilityError):
        if values == scene.mechanism.values(scene.assembly):
            raise
        scene = _at(scene, tuple(values.items()))
        derive(scene, wanted, iterate=iterate, elastic=elastic)
    return scene


@functools.lru_cache(maxsize=32)
def _at(scene: Scene, values: tuple[tuple[str, float], ...]) -> Scene:
    return replace(scene, assembly=dict(values))


@functools.lru_cache(maxsize=32)
def _kept(scene: Scene, want: Wanted, iterate: bool, elastic: bool) -> SceneGraph | AssemblyError | MobilityError:
    """The graph from the cache, or derived and kept there; or why there is none."""
    key = fingerprint(scene, want)
    key = f"{key}-iterated" if key and iterate else key
    key = f"{key}-elastic" if key and elastic else key
    text = cache.read(f"{key}.graph") if key else None
    if text is not None:
        return SceneGraph.loads(text, scene, want)
    try:
        graph = _derive(scene, want, iterate, elastic)
    except AssemblyError as error:
        return AssemblyError(f"{error}{told_parameters(scene.mechanism, scene.assembly)}")
    except MobilityError as error:
        return MobilityError(str(error))
    if key:
        cache.write(f"{key}.graph", graph.dumps())
    return graph


def _derive(scene: Scene, asked: Wanted, iterate: bool, elastic: bool) -> SceneGraph:
    mechanism = scene.mechanism
    want = feeling(mechanism, asked) if scene.elastic and asked.forces else asked
    p = mechanism.symbols
    tree = span(scene.guided, scene.laws)
    borne = needed_reactions(mechanism, want.reactions, want.sections)
    body = assemble(scene.guided, tree, scene.laws, borne, pushed(scene.needs_drives, scene.weights), want.own)
    driven = tuple(c.name for c in body.coordinates if c.driven)
    motion = motion_function({name: scene.laws[name] for name in driven}, p)
    values = list(mechanism.values(scene.assembly).values())
    first = [float(x) for x in ca.DM(motion(scene.span[0], values)[0]).full().ravel()]
    start = Start(scene.span[0], first, values)
    solved = kinematics.solve(body, reference_posture(scene.mechanism) | dict(scene.posture), start, iterate=iterate)
    solved, swings = count_turns(body, solved, motion, scene.span, start, _seeing(body, want))

    columns = _beyond(body, _seeing(body, want))
    columns |= _locks(mechanism, body, forces=want.forces)
    columns |= {Check("closure", name): closure for name, closure in solved.closures.items()}
    columns |= {Check("gap", name): gap for name, gap in solved.gaps.items()}
    columns |= {Check("misfit", name): misfit for name, misfit in solved.misfits.items()}
    for graph in body.rows:
        columns |= {Check("row", graph.row.name): graph.residual, Check("rowsize", graph.row.name): graph.size}
    columns |= {Check("turned", name): swing for name, swing in (solved.swings | swings).items()}
    loop_angles: dict[Output, dict[Column, int]] = {}
    if want.motion:
        motions = _motion_columns(mechanism, body, solved, driven)
        angles = [c for c in body.coordinates if c.kind == "angle"]
        loose: dict[Column, Any] = {_known_by(c): c.value for c in angles if c.name in solved.loose}
        counted: dict[Column, Any] = {Check("turns", c.name): c.value for c in angles if c.name not in solved.loose}
        loop_angles = {output: _turns(value, loose | counted) for output, value in motions.items() if _is_angle(mechanism, output)}
        loop_angles = {output: turns for output, turns in loop_angles.items() if not loose.keys().isdisjoint(turns)}
        loop_angles |= {output: {output: 1} for output in _within_a_turn(mechanism, body, motions)}
        whole = {check: ca.floor(value * (1 / math.tau)) for check, value in counted.items()}
        within = column(value - math.tau * whole[check] for check, value in counted.items())
        motions |= {output: ca.substitute(ca.SX(motions[output]), column(counted.values()), within) for output in loop_angles}
        columns |= {check: value for check, value in whole.items() if any(check in turns for turns in loop_angles.values())}
        columns |= dict(motions.items())
        columns |= _untold(body, motions)
    for part in reversed(body.applied):
        if part.source in want.loads:
            columns |= {Output("load", part.source, member): part.members[member] for member in force_members(mechanism.space)}
    placed = solved.evaluate(ca.vertcat(ca.SX(0, 1), *columns.values()))
    columns = dict(zip(columns, ca.vertsplit(placed) if columns else (), strict=True))
    inputs = [mechanism.time, solved.driven, solved.driven_rate, solved.driven_acceleration, solved.iterated, p]
    at_start = (start.t, *motion(start.t, values), solved.newton.guess if solved.newton else [], values)

    def begins(expression: Any) -> Any:
        return ca.Function("start", inputs, [expression])(*at_start)

    acting: dict[Column, Any] = {}
    free = ca.SX(0, 1)
    frictions: Mapping[str, Any] = {}
    if want.forces:
        forces = internal_forces(
            body,
            solved,
            effort=want.effort,
            reactions=want.reactions,
            multipliers=want.multipliers,
            sections=want.sections,
            frictions=want.frictions,
            weights=scene.weights,
        )
        rubbed = forces.rubbed
        frictions = rubbed.forces
        told = {key: columns.pop(key) for key, value in list(columns.items()) if ca.depends_on(ca.SX(value), rubbed.symbols)}
        placed = ca.substitute(column(told.values()), rubbed.symbols, rubbed.values)
        pressed = dict(zip(told, ca.vertsplit(placed) if told else (), strict=True))
        acting, free = gathered(forces.columns, forces.free, mechanism.links.values(), body.coordinates), forces.free
        acting |= pressed
        # Beside the start of the motion, for a drive through a gear moves little of what it drives, and holds it all the same.
        for check in [check for check in acting if isinstance(check, Check) and check.kind == "hold"]:
            acting[check] = closure(acting[check], float(begins(acting[check])))
    acting |= own_outputs(body, solved, columns | acting)
    opened = open_forces(acting, free, inputs, frictions) if (elastic or scene.elastic) and free.numel() else None
    least = least_work(mechanism, scene.elastic, columns | acting, free, begins) if opened else None
    loaded = acting if least is None else least.completed(acting, free)
    strength = _strength(scene, asked, columns | loaded)
    acting = (acting if elastic else loaded) | strength | ({} if least is None else least.doubts(strength))
    columns |= _settled(acting, free)
    columns = columns if want is asked else {key: value for key, value in columns.items() if not _felt_alone(key, asked)}
    out = ca.densify(ca.vertcat(ca.SX(0, 1), *columns.values()))
    names = ["t", "d", "d_rate", "d_acceleration", "z", "p"]
    instant = share_reciprocals(ca.Function("instant", inputs, [out], names, ["out"], {"cse": True}), "p")
    opened = opened if elastic else None
    return SceneGraph(scene, asked, driven, motion, instant, solved.newton, tuple(columns), loop_angles, opened)


def _strength(scene: Scene, want: Wanted, columns: Mapping[Column, Any]) -> dict[Column, Any]:
    """Stresses, utilisation and deflections of the links of which they are wanted."""
    found: dict[Column, Any] = {}
    for name in want.stressed:
        found |= stresses(scene.mechanism, name, columns)
    if want.used or want.bent:
        told = describe(scene.mechanism, scene.mechanism.values(scene.assembly), scene.laws)
        for name in want.used:
            beam = scene.mechanism.links[name].beam
            assert beam is not None
            found |= utilisation(scene.mechanism, name, columns, beam.columns or effective_lengths(told, name))
        for name in want.bent:
            found |= deflections(scene.mechanism, name, columns, ends="free" not in ends_of(told, name))
    return found


def _felt_alone(key: Column, asked: Wanted) -> bool:
    """Whether a column is there for strain energy alone."""
    if not isinstance(key, Output):
        return False
    return (key.group == "reaction" and key.part not in asked.reactions) or (key.along and key.part not in asked.sections)


def _settled(columns: dict[Column, Any], free: Any) -> dict[Column, Any]:
    """Forces with nothing for what equilibrium leaves open, and by a check that it is ``open`` how much a force changes with that.

    What does not change with it by structure is determined. Any other force is determined where that is zero, for parameters and
    at instants that are looked at then.
    """
    if not free.numel():
        return columns
    forces = column(columns.values())
    slopes = ca.jacobian(forces, free)
    slopes, forces = (ca.substitute(part, free, ca.SX.zeros(free.numel())) for part in (slopes, forces))
    doubted = ((output, slopes[k, :]) for k, output in enumerate(columns) if slopes[k, :].nnz() and isinstance(output, Output))
    sizes: dict[Column, Any] = {Check("open", output): ca.sum2(ca.fabs(slope)) for output, slope in doubted}
    return dict(zip(columns, ca.vertsplit(forces), strict=True)) | sizes


def _seeing(body: Multibody, want: Wanted) -> dict[str, Any]:
    """The expressions of loads, rows and multipliers that are evaluated, by what they are of."""
    parts = [part for part in (*body.applied, *body.held) if want.forces or part.source in want.loads]
    found = {f"row '{graph.row.name}'": ca.vertcat(graph.residual, graph.size) for graph in body.rows}
    found |= {f"output '{name}'": expression for name, expression in body.own.items()}
    for part in parts:
        kind = (
            "load" if part.source in body.mechanism.loads else "constraint" if part.source in body.mechanism.constraints else "row"
        )
        name = f"{kind} '{part.source}'"
        found[name] = ca.vertcat(found.get(name, ca.SX(0, 1)), *part.force, *part.couple)
    return found


def _beyond(body: Multibody, seeing: Mapping[str, Any]) -> dict[Column, Any]:
    """How far what is put into curves with ends is beyond them, by the constraint, load or row that does it."""
    found = {f"constraint '{loop.name}'": loop.gap for loop in body.loop_equations if loop.declared}
    columns: dict[Column, Any] = {}
    for name, expression in (found | dict(seeing)).items():
        far = enumerate(beyond_ends(expression), 1)
        columns |= {Check("beyond", name if k == 1 else f"{name}, curve {k}"): value for k, value in far}
    return columns


def _locks(mechanism: Mechanism, body: Multibody, *, forces: bool) -> dict[Column, Any]:
    """Of joints whose three turns are coordinates, the square of the cosine of the second: nil where the third axis is the first.

    There (gimbal lock) loops cannot set them, and they cannot give every couple. Their motion is told where it is given.
    """
    found: dict[Column, Any] = {}
    for joint in mechanism.joints.values():
        turns = [own_coordinate(axis, body.coordinates) for axis in joint.axes if axis.kind == "angle"]
        own = [turn for turn in turns if turn is not None]
        if len(own) == 3 and (forces or not all(turn.driven for turn in own)):
            found[Check("gimbal", joint.name)] = ca.cos(own[1].value) ** 2
    return found


def _untold(body: Multibody, motions: Collection[Output]) -> dict[Column, Any]:
    """Of the turns of balls, by a check that they are ``open``, where they are not told, in gimbal lock; the second's angle is."""
    columns: dict[Column, Any] = {}
    for ball in body.balls:
        turns = [axis.coordinate for axis in ball.joint.axes if axis.kind == "angle"]
        locked = body.turns_of(ball).locked
        outputs = (Output("motion", name, member) for name in turns for member in ("", "rate", "acceleration"))
        columns |= {
            Check("open", output): locked for output in outputs if output != Output("motion", turns[1]) and output in motions
        }
    return columns


def _motion_columns(
    mechanism: Mechanism, body: Multibody, solved: kinematics.Kinematics, driven: Sequence[str]
) -> dict[Output, Any]:
    columns: dict[Output, Any] = {}
    for name, (joint, axis) in mechanism.coordinates.items():
        if name in driven:
            i = driven.index(name)
            motion = (solved.driven[i], solved.driven_rate[i], solved.driven_acceleration[i])
        elif not body.tree.measures(joint, axis):
            continue
        else:
            motion = body.motion_along(joint, axis)
        members = (Output("motion", name, member) for member in ("", "rate", "acceleration"))
        columns |= dict(zip(members, motion, strict=True))
    for part in mechanism.moving:
        frame = body.frames[part.name]
        place = zip("xyz" if mechanism.space else "xy", frame.place_of(ZERO), strict=False)
        columns |= {Output("pose", part.name, component): value for component, value in place}
        if part.oriented and mechanism.space:
            axes = zip("xyz", (frame.rotation.x, frame.rotation.y, frame.rotation.z), strict=True)
            cosines = ((f"{name}{component}", value) for name, axis in axes for component, value in zip("xyz", axis, strict=True))
            columns |= {Output("pose", part.name, member): ca.SX(value) for member, value in cosines}
        elif part.oriented:
            columns[Output("pose", part.name, "angle")] = frame.rotation.angle
    return columns


def _within_a_turn(mechanism: Mechanism, body: Multibody, motions: Collection[Output]) -> list[Output]:
    """The angles of joints in space that are known by a direction alone: none of them is a coordinate of the tree."""
    angles = [axis for _, axis in mechanism.coordinates.values() if mechanism.space and axis.kind == "angle"]
    seen = [Output("motion", axis.coordinate) for axis in angles if own_coordinate(axis, body.coordinates) is None]
    return [output for output in seen if output in motions]


def _known_by(coordinate: Coordinate) -> Output:
    """The output that an angle that a loop sets is the same as."""
    return Output("motion", coordinate.name) if coordinate.relative else Output("pose", coordinate.body, "angle")


def _is_angle(mechanism: Mechanism, output: Output) -> bool:
    return output.member in ("", "angle") and output.unit(mechanism) == ANGLE


def _turns(angle: Any, parts: dict[Column, Any]) -> dict[Column, int]:
    """How often each coordinate's angle goes into another angle: once, or less once."""
    if not parts:
        return {}
    slopes = ca.evalf(ca.densify(ca.jacobian(ca.SX(angle), ca.vertcat(*parts.values())))).full().ravel()
    return {part: int(slope) for part, slope in zip(parts, slopes, strict=True) if slope}
