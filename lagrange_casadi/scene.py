"""A scene: a mechanism, the motion it must make, and what is wanted of it; and the graphs that hold just that."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt

from . import kinematics, multibody
from .errors import DeclarationError, UnknownNameError
from .kinematics import NewtonLoop
from .mechanism import Mechanism
from .mobility import internal_forces
from .motion import Motion, motion_function
from .tree import span

Grid = tuple[float, float, int]
"""Start, stop and count; both ends are included."""


def instants(what: str, grid: Grid) -> npt.NDArray[np.float64]:
    """The points of a grid. Raises :class:`DeclarationError` for a count below 1 or ends that are not finite or fall."""
    try:
        start, stop, count = float(grid[0]), float(grid[1]), int(grid[2])
    except (TypeError, ValueError, IndexError):
        raise DeclarationError(f"{what}: expected (start, stop, count), got {grid!r}") from None
    if count < 1 or count != grid[2]:
        raise DeclarationError(f"{what}: COUNT must be a whole number of at least 1, got {grid[2]}")
    if not (math.isfinite(start) and math.isfinite(stop)):
        raise DeclarationError(f"{what}: START and STOP must be finite, got {start:g} and {stop:g}")
    if stop < start or (count > 1 and stop == start):
        raise DeclarationError(f"{what}: STOP must be after START, got {start:g} and {stop:g}")
    return np.linspace(start, stop, count)


def ratios(grid: Grid) -> npt.NDArray[np.float64]:
    """The section ratios xi/l of a grid. Raises :class:`DeclarationError` outside [0, 1]."""
    xi = instants("xi", grid)
    if xi[0] < 0.0 or xi[-1] > 1.0:
        raise DeclarationError(f"xi: ratios xi/l must lie in [0, 1], got {xi[0]:g} to {xi[-1]:g}")
    return xi


@dataclass(frozen=True)
class Wanted:
    """Outputs by kind, joints and links in the order of declaration whatever the order of wanting."""

    effort: bool
    motion: bool
    reactions: tuple[str, ...]
    sections: tuple[str, ...]

    @classmethod
    def of(cls, mechanism: Mechanism, names: Sequence[str]) -> Wanted:
        """Read names: ``effort``, ``motion``, ``reaction:JOINT``, ``section:LINK``, ``all``."""
        choices = outputs(mechanism)
        for name in names:
            if name not in choices:
                _refuse_output(mechanism, name)
                raise UnknownNameError("output", name, choices)
        chosen = set(choices if "all" in names else names)
        if not chosen:
            raise DeclarationError(f"no output wanted; valid: {', '.join(choices)}")
        return cls(
            effort="effort" in chosen,
            motion="motion" in chosen,
            reactions=tuple(joint for joint in mechanism.joints if f"reaction:{joint}" in chosen),
            sections=tuple(link for link in mechanism.links if f"section:{link}" in chosen),
        )


def outputs(mechanism: Mechanism) -> list[str]:
    """Every output that can be wanted of a mechanism."""
    reactions = [f"reaction:{joint}" for joint in mechanism.joints]
    sections = [f"section:{link}" for link in mechanism.links if _side_joint(mechanism, link) is None]
    return ["all", "effort", "motion", *reactions, *sections]


def _side_joint(mechanism: Mechanism, link: str) -> str | None:
    """A joint that sits elsewhere than at the link's ends."""
    for joint in mechanism.joints.values():
        for point in (joint.parent, joint.child):
            if point.body.name == link and point.end is None:
                return joint.name
    return None


def _refuse_output(mechanism: Mechanism, name: str) -> None:
    kind, _, part = name.partition(":")
    if kind == "section" and part in mechanism.links:
        raise DeclarationError(
            f"output '{name}': joint '{_side_joint(mechanism, part)}' sits off the ends of link '{part}', and the section law "
            "needs all joints at its base or its tip"
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
        joints = self.mechanism.joints
        for name, law in self.motion.items():
            if name not in joints:
                raise UnknownNameError("joint in motion", name, joints)
            if joints[name].coordinate is None:
                raise DeclarationError(f"joint '{name}' cannot be driven: a pin at a point mass turns nothing")
            if not isinstance(law, Motion):
                raise DeclarationError(f"motion of joint '{name}': expected a law of lagrange_casadi.motion, got {law!r}")
        places = [*self.mechanism.links, *(n for n, j in joints.items() if j.kind == "prismatic")]
        for name in self.posture:
            if name not in places:
                raise UnknownNameError("link or prismatic joint in posture", name, places)
        self.mechanism.freeze()
        Wanted.of(self.mechanism, self.wanted)
        instants("t", self.t)
        ratios(self.xi)
        self.mechanism.values()


@dataclass(frozen=True, eq=False)
class SceneGraph:
    """What a scene computes, as CasADi functions that hold nothing else.

    ``motion(t, p) -> (d, d_rate, d_acceleration)``; ``instant(d, d_rate, d_acceleration, z, p) -> out``, one row of ``out`` a
    column name; ``newton`` where loops must be iterated. ``closures`` names the first rows of ``out``: the joints whose loops are
    in closed form, see :mod:`.loops`.
    """

    scene: Scene
    wanted: Wanted
    motion: Any
    instant: Any
    newton: NewtonLoop | None
    columns: tuple[str, ...]
    closures: tuple[str, ...]

    @property
    def driven(self) -> tuple[str, ...]:
        """The driven joints in the order of d."""
        return tuple(name for name in self.scene.mechanism.joints if name in self.scene.motion)

    @property
    def instructions(self) -> dict[str, int]:
        """Instructions of each function."""
        functions = {"motion": self.motion, "instant": self.instant} | ({"loops": self.newton.step} if self.newton else {})
        return {name: f.n_instructions() if f.is_a("SXFunction") else f.n_nodes() for name, f in functions.items()}


def derive(scene: Scene, wanted: Sequence[str] | None = None) -> SceneGraph:
    """Derive the graphs of a scene, for its own wanted outputs or for others.

    Raises :class:`MobilityError`, :class:`DeclarationError` or :class:`AssemblyError` where the loops cannot be solved.
    """
    mechanism = scene.mechanism
    want = Wanted.of(mechanism, scene.wanted if wanted is None else wanted)
    p = mechanism.symbols
    tree = span(mechanism, scene.motion)
    body = multibody.assemble(mechanism, tree, scene.motion, want.reactions, want.sections)
    order = [c.joint for c in body.coordinates if c.driven]
    motion = motion_function([scene.motion[name] for name in order], p)
    defaults = list(mechanism.values().values())
    start = [float(x) for x in ca.DM(motion(scene.t[0], defaults)[0]).full().ravel()]
    solved = kinematics.solve(body, scene.posture, start, defaults)

    columns: dict[str, Any] = {f"closure:{name}": closure for name, closure in solved.closures.items()}
    if want.motion:
        columns |= _motion_columns(body, solved, order)
    if want.effort or want.reactions or want.sections:
        forces = internal_forces(body, solved, want.reactions)
        if want.effort:
            columns |= {f"effort:{joint}": effort for joint, effort in forces.efforts.items()}
        for joint, members in forces.reactions.items():
            columns |= {f"reaction:{joint}:{member}": force for member, force in members.items()}
        for link, law in forces.laws.items():
            columns |= {f"section:{link}:law:{name}": coefficient for name, coefficient in law.items()}
    out = ca.densify(ca.vertcat(ca.SX(0, 1), *columns.values()))
    inputs = [solved.driven, solved.driven_rate, solved.driven_acceleration, solved.iterated, p]
    names = ["d", "d_rate", "d_acceleration", "z", "p"]
    instant = ca.Function("instant", inputs, [out], names, ["out"], {"cse": True})
    return SceneGraph(scene, want, motion, instant, solved.newton, tuple(columns), tuple(solved.closures))


def _motion_columns(body: multibody.Multibody, solved: kinematics.Kinematics, order: list[str]) -> dict[str, Any]:
    columns: dict[str, Any] = {}
    for name, joint in body.mechanism.joints.items():
        if name in order:
            i = order.index(name)
            motion = (solved.driven[i], solved.driven_rate[i], solved.driven_acceleration[i])
        elif joint.coordinate is not None:
            motion = tuple(solved.evaluate(x) for x in body.joint_motion(joint))
        else:
            continue
        columns |= dict(zip((f"motion:{name}", f"motion:{name}_rate", f"motion:{name}_acceleration"), motion, strict=True))
    for part in body.mechanism.moving:
        frame = body.frames[part.name]
        x, y = frame.place_of(0.0, 0.0)
        columns |= {f"pose:{part.name}:x": solved.evaluate(x), f"pose:{part.name}:y": solved.evaluate(y)}
        if part.oriented:
            angle = ca.atan2(frame.rotation.s, frame.rotation.c)
            columns[f"pose:{part.name}:angle"] = solved.evaluate(angle)
    return columns
