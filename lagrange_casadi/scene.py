"""A scene: a mechanism, the motion it must make, and what is wanted of it; and the graphs that hold just that."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import casadi as ca
import numpy as np

from . import kinematics
from .assembly import assemble
from .density import Density
from .errors import DeclarationError, UnknownNameError
from .kinematics import NewtonLoop, Start
from .mechanism import Mechanism
from .mobility import internal_forces, needed_reactions
from .motion import Motion, motion_function
from .multibody import Multibody
from .reciprocals import share_reciprocals
from .tree import span

_OPEN = 1e-9
_SAMPLES, _STEPS = 6, 8

Grid = tuple[float, float, int]
"""Start, stop and count; both ends are included."""


def checked(what: str, grid: Grid) -> Grid:
    """A grid in numbers. Raises :class:`DeclarationError` for a count below 1 or ends that are not finite or fall."""
    try:
        start, stop, count = float(grid[0]), float(grid[1]), int(grid[2])
        if len(grid) != 3:
            raise ValueError
    except (TypeError, ValueError, IndexError, OverflowError):
        raise DeclarationError(f"{what}: expected (start, stop, count), got {grid!r}") from None
    if count < 1 or count != grid[2]:
        raise DeclarationError(f"{what}: COUNT must be a whole number of at least 1, got {grid[2]}")
    if not (math.isfinite(start) and math.isfinite(stop)):
        raise DeclarationError(f"{what}: START and STOP must be finite, got {start:g} and {stop:g}")
    if stop < start or (count > 1 and stop == start):
        raise DeclarationError(f"{what}: STOP must be after START, got {start:g} and {stop:g}")
    return start, stop, count


def checked_ratios(grid: Grid) -> Grid:
    """A grid of section ratios xi/l in numbers. Raises :class:`DeclarationError` outside [0, 1]."""
    start, stop, count = checked("xi", grid)
    if start < 0.0 or stop > 1.0:
        raise DeclarationError(f"xi: ratios xi/l must lie in [0, 1], got {start:g} to {stop:g}")
    return start, stop, count


@dataclass(frozen=True)
class Wanted:
    """Outputs by kind, each in the order of declaration whatever the order of wanting."""

    effort: bool
    motion: bool
    reactions: tuple[str, ...]
    multipliers: tuple[str, ...]
    loads: tuple[str, ...]
    sections: tuple[str, ...]

    @classmethod
    def of(cls, mechanism: Mechanism, names: Sequence[str]) -> Wanted:
        """Read names: ``effort``, ``motion``, ``reaction:JOINT``, ``multiplier:NAME``, ``load:NAME``, ``section:LINK``, ``all``."""
        choices = outputs(mechanism)
        if isinstance(names, str) or not all(isinstance(name, str) for name in names):
            raise DeclarationError(f"wanted: expected a list of output names, got {names!r}; valid: {', '.join(choices)}")
        for name in names:
            if name not in choices:
                _refuse_output(mechanism, name)
                raise UnknownNameError("output", name, choices)
        chosen = set(choices if "all" in names else names)
        if not chosen:
            raise DeclarationError(f"no output wanted; valid: {', '.join(choices)}")

        def parts(kind: str) -> tuple[str, ...]:
            return tuple(name.partition(":")[2] for name in choices if name in chosen and name.startswith(f"{kind}:"))

        kinds = ("reaction", "multiplier", "load", "section")
        return cls("effort" in chosen, "motion" in chosen, *(parts(kind) for kind in kinds))

    @property
    def forces(self) -> bool:
        """Whether any force is wanted that equilibrium gives."""
        return bool(self.effort or self.reactions or self.multipliers or self.sections)


def outputs(mechanism: Mechanism) -> list[str]:
    """Every output that can be wanted of a mechanism."""
    reactions = [f"reaction:{joint}" for joint in mechanism.joints]
    multipliers = [f"multiplier:{name}" for name in (*mechanism.constraints, *mechanism.rows)]
    loads = [f"load:{name}" for name in mechanism.loads]
    sections = [f"section:{name}" for name, link in mechanism.links.items() if isinstance(link.mass, Density)]
    return ["all", "effort", "motion", *reactions, *multipliers, *loads, *sections]


def _refuse_output(mechanism: Mechanism, name: str) -> None:
    kind, _, part = name.partition(":")
    if kind == "section" and part in mechanism.links:
        raise DeclarationError(
            f"output '{name}': link '{part}' is known by its centre of mass and inertia only; a section needs to know how its mass "
            "lies along it, so give it a mass alone or a density"
        )
    if kind == "section" and part in mechanism.bodies:
        raise DeclarationError(f"output '{name}': '{part}' is not a link and has no sections; links: {', '.join(mechanism.links)}")


@dataclass(frozen=True, eq=False)
class Scene:
    """A mechanism, the motion of its driven joints, and the outputs wanted over a grid of time and of section ratios.

    Parameters
    ----------
    mechanism
        The mechanism; it freezes here.
    motion
        The law of every driven joint, by the joint's name.
    wanted
        Output names, see :func:`outputs`. Only these are derived, compiled and evaluated.
    t, xi
        Grids of time [s] and of the ratio xi/l: start, stop, count.
    posture
        Rough directions of links [rad] and places of slides [m] at the first instant, to choose between the ways in which a loop
        can be assembled.
    """

    mechanism: Mechanism
    motion: Mapping[str, Motion]
    wanted: Sequence[str] = ("all",)
    t: Grid = (0.0, 1.0, 101)
    xi: Grid = (0.0, 1.0, 101)
    posture: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not isinstance(self.mechanism, Mechanism):
            raise DeclarationError(f"scene: expected a Mechanism, got {self.mechanism!r}")
        for what, mapping in (("motion", self.motion), ("posture", self.posture)):
            if not isinstance(mapping, Mapping):
                raise DeclarationError(f"{what}: expected a mapping by name, got {mapping!r}")
            object.__setattr__(self, what, MappingProxyType(dict(mapping)))
        joints = self.mechanism.joints
        for name, law in self.motion.items():
            if name not in joints:
                raise UnknownNameError("joint in motion", name, joints)
            if joints[name].coordinate is None:
                why = "a weld does not move" if joints[name].kind == "weld" else "a pin at a point mass turns nothing"
                raise DeclarationError(f"joint '{name}' cannot be driven: {why}")
            if not isinstance(law, Motion):
                raise DeclarationError(f"motion of joint '{name}': expected a law of lagrange_casadi.motion, got {law!r}")
        places = [*self.mechanism.links, *(n for n, j in joints.items() if j.slides)]
        for name, rough in self.posture.items():
            if name not in places:
                raise UnknownNameError("link or sliding joint in posture", name, places)
            if not isinstance(rough, (int, float)) or not math.isfinite(rough):
                raise DeclarationError(f"posture of '{name}': expected a finite number, got {rough!r}")
        for row in self.mechanism.rows.values():
            if row.replaces not in self.motion:
                raise DeclarationError(f"row '{row.name}' replaces the drive of joint '{row.replaces}', which has no motion")
        self.mechanism.freeze()
        Wanted.of(self.mechanism, self.wanted)
        checked("t", self.t)
        checked_ratios(self.xi)
        self.mechanism.values()


@dataclass(frozen=True, eq=False)
class SceneGraph:
    """What a scene computes, as CasADi functions that hold nothing else.

    ``motion(t, p) -> (d, d_rate, d_acceleration)``; ``instant(t, d, d_rate, d_acceleration, z, p) -> out``, one row of ``out`` a
    column name; ``newton`` where loops must be iterated. Columns that begin with ``_`` are no outputs. They tell whether there is a
    result: ``_closure:JOINT`` (see :mod:`.loops`), ``_misfit:JOINT``, ``_row:NAME`` and ``_rowsize:NAME``; or they are what the
    certificate needs: ``_held:NUMBER:...``, what multipliers do to the bodies that ``held`` names. ``wrapped`` names the angles
    that are known up to whole turns, ``undetermined`` the outputs that equilibrium does not determine.
    """

    scene: Scene
    wanted: Wanted
    driven: tuple[str, ...]
    motion: Any
    instant: Any
    newton: NewtonLoop | None
    columns: tuple[str, ...]
    wrapped: tuple[str, ...]
    undetermined: tuple[str, ...]
    held: tuple[str, ...]

    def iterates(self, closure: str) -> bool:
        """Whether the loops that stand under the name of a closure are iterated."""
        return self.newton is not None and any(block.name == closure for block in self.newton.blocks)

    @property
    def instructions(self) -> dict[str, int]:
        """Instructions of each function."""
        functions = {"motion": self.motion, "instant": self.instant} | ({"loops": self.newton.step} if self.newton else {})
        return {name: f.n_instructions() if f.is_a("SXFunction") else f.n_nodes() for name, f in functions.items()}


def derive(scene: Scene, wanted: Sequence[str] | None = None) -> SceneGraph:
    """Derive the graphs of a scene, for its own wanted outputs or for others; the same graph for the same scene, while it lasts.

    Raises :class:`MobilityError`, :class:`DeclarationError` or :class:`AssemblyError` where the loops cannot be solved.
    """
    return _derive(scene, Wanted.of(scene.mechanism, scene.wanted if wanted is None else wanted))


@functools.lru_cache(maxsize=32)
def _derive(scene: Scene, want: Wanted) -> SceneGraph:
    mechanism = scene.mechanism
    p = mechanism.symbols
    tree = span(mechanism, scene.motion)
    body = assemble(mechanism, tree, scene.motion, needed_reactions(mechanism, want.reactions, want.sections))
    driven = tuple(c.joint for c in body.coordinates if c.driven)
    motion = motion_function({name: scene.motion[name] for name in driven}, p)
    defaults = list(mechanism.values().values())
    first = [float(x) for x in ca.DM(motion(scene.t[0], defaults)[0]).full().ravel()]
    solved = kinematics.solve(body, scene.posture, Start(float(scene.t[0]), first, defaults))

    columns = {f"_closure:{name}": closure for name, closure in solved.closures.items()}
    columns |= {f"_misfit:{name}": misfit for name, misfit in solved.misfits.items()}
    for graph in body.rows:
        columns |= {f"_row:{graph.row.name}": graph.residual, f"_rowsize:{graph.row.name}": graph.size}
    wrapped: tuple[str, ...] = ()
    if want.motion:
        motions = _motion_columns(body, solved, driven)
        loose = ca.vertcat(ca.SX(0, 1), *(c.value for c in body.coordinates if c.kind == "angle" and not c.driven))
        wrapped = tuple(name for name, value in motions.items() if _is_angle(mechanism, name) and ca.depends_on(value, loose))
        columns |= motions
    for part in reversed(body.applied):
        if part.source in want.loads:
            columns |= {f"load:{part.source}:{member}": getattr(part, member) for member in ("fx", "fy", "mz")}
    placed = solved.evaluate(ca.vertcat(ca.SX(0, 1), *columns.values()))
    columns = dict(zip(columns, ca.vertsplit(placed) if columns else (), strict=True))
    inputs = [mechanism.time, solved.driven, solved.driven_rate, solved.driven_acceleration, solved.iterated, p]
    undetermined: tuple[str, ...] = ()
    if want.forces:
        forces = internal_forces(
            body,
            solved,
            effort=want.effort,
            reactions=want.reactions,
            multipliers=want.multipliers,
            sections=want.sections,
        )
        undetermined = _undetermined(forces.columns, forces.free, motion, inputs, scene, solved.newton)
        settled = [column for name, column in forces.columns.items() if name not in undetermined]
        settled = ca.vertsplit(ca.substitute(ca.vertcat(ca.SX(0, 1), *settled), forces.free, ca.SX.zeros(forces.free.numel())))
        columns |= dict(zip((name for name in forces.columns if name not in undetermined), settled, strict=False))
    undetermined = tuple(name for name in undetermined if not name.startswith("_"))
    held = tuple(part.point.body.name for part in body.held) if want.reactions else ()
    out = ca.densify(ca.vertcat(ca.SX(0, 1), *columns.values()))
    names = ["t", "d", "d_rate", "d_acceleration", "z", "p"]
    instant = share_reciprocals(ca.Function("instant", inputs, [out], names, ["out"], {"cse": True}), "p")
    return SceneGraph(scene, want, driven, motion, instant, solved.newton, tuple(columns), wrapped, undetermined, held)


def _undetermined(
    columns: dict[str, Any], free: Any, motion: Any, inputs: list[Any], scene: Scene, newton: NewtonLoop | None
) -> tuple[str, ...]:
    """The outputs that change with what equilibrium leaves open, at any of a few instants of the motion."""
    if not free.numel():
        return ()
    slopes = ca.Function("slopes", [*inputs, free], [ca.jacobian(ca.vertcat(*columns.values()), free)])
    p = list(scene.mechanism.values().values())
    largest = np.zeros((len(columns), free.numel()))
    z = ca.DM(newton.guess if newton else [])
    for number, t in enumerate(np.linspace(scene.t[0], scene.t[1], 10 * _SAMPLES + 1)):
        if newton is not None:
            for _ in range(_STEPS):
                z += newton.step(z, t, motion(t, p)[0], p)[0]
        if number % 10 == 0:
            largest = np.fmax(largest, np.abs(slopes(t, *motion(t, p), z, p, ca.DM.zeros(free.numel())).full()))
    return tuple(name for name, row in zip(columns, largest, strict=True) if row.max() > _OPEN)


def _motion_columns(body: Multibody, solved: kinematics.Kinematics, driven: Sequence[str]) -> dict[str, Any]:
    columns: dict[str, Any] = {}
    for name, joint in body.mechanism.joints.items():
        if name in driven:
            i = driven.index(name)
            motion = (solved.driven[i], solved.driven_rate[i], solved.driven_acceleration[i])
        elif joint.coordinate is not None:
            motion = body.joint_motion(joint)
        else:
            continue
        columns |= dict(zip((f"motion:{name}", f"motion:{name}_rate", f"motion:{name}_acceleration"), motion, strict=True))
    for part in body.mechanism.moving:
        frame = body.frames[part.name]
        x, y = frame.place_of(0.0, 0.0)
        columns |= {f"pose:{part.name}:x": x, f"pose:{part.name}:y": y}
        if part.oriented:
            columns[f"pose:{part.name}:angle"] = frame.rotation.angle
    return columns


def _is_angle(mechanism: Mechanism, column: str) -> bool:
    group, part, *_ = column.split(":")
    if group == "pose":
        return column.endswith(":angle")
    return part in mechanism.joints and mechanism.joints[part].coordinate == "angle"
