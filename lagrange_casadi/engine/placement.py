"""Poses of the bodies of a mechanism at an instant, whether its loops close or not.

Nothing need be finished for that: links may lack a mass, joints may be missing or too many, nothing
need be driven. What can be solved is solved as for an evaluation. Other loops come as near to being
closed as they can, from the posture that is given.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

from ..base.arrays import Array
from ..base.numerals import readable
from ..base.rotation import Rotation
from ..base.symbolic import symbolic
from ..base.vectors import AXES
from ..errors import AssemblyError, LagrangeCasadiError, MobilityError
from ..model.declared_parts import Parameter, Point
from ..model.description import Description
from ..model.directions import Reference
from ..model.guiding import guided, laws_of
from ..model.joints import Joint
from ..model.limits import parameter_values
from ..model.mechanism import Mechanism
from ..model.motion_laws import Motion, polynomial
from ..model.sampled_laws import Laws
from ..model.scene import Scene
from ..model.scene_arguments import rough_posture
from ..model.spatial import SpatialMechanism
from .assembly import assemble
from .gaps import Gap, gaps_of
from .iteration import Start
from .kinematics import begun
from .model_data import described
from .nearest import Nearest
from .released_loops import State
from .tree import Tree, grow

_TURN, _MOST, _SAMPLES, _TINY = 0.2, 2000, 2001, 1e-12
"""Largest change of a driven coordinate in a step of time [rad or mechanism's size], steps, samples
of drives that measure the change, and the part of a step with less of which no loop closes.
"""

_BESIDE = 0.25
"""Room between what hangs on the ground and what does not, of its size."""


@dataclass(frozen=True, eq=False)
class Placement:
    """The bodies of a mechanism at an instant ``t`` [s], as it was ``declared``.

    ``description`` has the numbers of the mechanism. ``bases`` are the places of the bodies'
    origins (3,) [m] and ``axes`` their x, y and z, rows (3, 3), both in ground axes and by body.
    ``driven`` are the coordinates whose motion is given, and ``gaps`` the loops that do not close.
    """

    declared: Mechanism
    t: float
    description: Description
    bases: Mapping[str, Array]
    axes: Mapping[str, Array]
    driven: tuple[str, ...]
    gaps: tuple[Gap, ...]


def place_scene(
    scene: Scene,
    *,
    t: float | None = None,
    values: Mapping[str, float] | None = None,
    closed: bool = False,
) -> Placement:
    """Place the mechanism of a scene at an instant [s], by default its first one, as of
    :func:`place`; parameters have by default the values with which the scene is assembled.
    """
    return place(
        scene.mechanism,
        motion=scene.motion,
        start=scene.span[0],
        t=t,
        values={**scene.assembly, **(values or {})},
        posture=scene.posture,
        drives=scene.weights,
        closed=closed,
    )


@contextmanager
def explained(scene: Scene, values: Mapping[str, float] | None) -> Iterator[None]:
    """Give :class:`AssemblyError` and :class:`MobilityError` that are raised in the context the
    placement that shows them, and say in their message what is apart; or of a motion that began,
    the last instant at which all loops close.
    """
    try:
        yield
    except (AssemblyError, MobilityError) as error:
        _explain(error, scene, values)
        raise


def _explain(
    error: AssemblyError | MobilityError, scene: Scene, values: Mapping[str, float] | None
) -> None:
    t = error.t if isinstance(error, AssemblyError) else None
    with suppress(LagrangeCasadiError):
        found = place_scene(scene, t=t, values=values, closed=t is not None)
        # Where parts fit, and drives are too many, what is open with these says nothing of parts.
        fits = isinstance(error, MobilityError) and error.assembled
        words = [] if fits else [gap.sentence for gap in found.gaps]
        if t is not None and found.t != t:
            words = [gap.sentence for gap in place_scene(scene, t=t, values=values).gaps]
            words.append(f"all loops close until t = {readable(found.t, t)} s")
        error.placement, error.args = found, ("; ".join([str(error), *words]),)


@symbolic
@np.errstate(all="ignore")
def place(
    mechanism: Mechanism,
    *,
    motion: Mapping[str, Motion | Sequence[Motion]] | None = None,
    start: float = 0.0,
    t: float | None = None,
    values: Mapping[str, float] | None = None,
    posture: Mapping[str, Any] | None = None,
    drives: Collection[str] | None = None,
    closed: bool = False,
) -> Placement:
    """Place the bodies of a mechanism, which need not be finished, and may be declared further.

    Parameters
    ----------
    mechanism
        The mechanism.
    motion
        The laws of driven joints, points and poses, as of a :class:`.Scene`; by default none.
    start, t
        The instant at which the posture holds, and the instant that is wanted [s], by default the
        same.
    values
        Values of parameters, by default the parameters' defaults.
    posture
        Rough directions of links and coordinates of joints at the ``start``.
    drives
        The joints whose efforts make the motion, by default those that are driven.
    closed
        True for the last instant until ``t`` at which all loops close, where they do at the start.

    Returns
    -------
    Placement
        What is driven is where its law has it. Other coordinates are near the posture, or near
        zero, and so that loops close, or are as little open as they can be.
    """
    # No piston is behind its barrel, if that can be.
    slides = {name for name, kind in mechanism.coordinates.items() if kind[1].kind == "slide"}
    out = {name: polynomial(x) for name, x in mechanism.rough.items() if name in slides}
    if out and not motion and not posture:
        held = place(mechanism, motion=out, values=values)
        if not held.gaps:
            return replace(held, driven=())
    given = parameter_values(mechanism.parameters, values)
    laws = laws_of(mechanism, motion or {})
    rough = mechanism.rough | rough_posture(mechanism, posture or {})
    whole = _measured(guided(mechanism, motion or {}), given)
    at = start if t is None else t
    nearest, state, left, tree, floating = _stood(whole, laws, start, at, given, rough, closed)
    nearest.note(state)
    gaps = gaps_of(nearest, state, left)
    poses = nearest.poses()
    description = described(mechanism, tree, laws, drives).at(list(given.values()))
    bases = {name: poses[name][0] for name in description.bodies}
    axes = {name: poses[name][1:] for name in description.bodies}
    seated = getattr(mechanism, "references", {})
    _set_beside(bases, axes, description, [name for name in floating if name not in seated])
    return Placement(mechanism, state[2], description, bases, axes, nearest.drives, gaps)


@symbolic
@np.errstate(all="ignore")
def stand(scene: Scene, t: float, values: Mapping[str, float]) -> tuple[Nearest, State]:
    """The loops of a scene's mechanism over its own parameters, and the state of its coordinates at
    an instant [s], from which that of other parameters is found.
    """
    mechanism = scene.mechanism
    nearest, state, *_ = _stood(
        guided(mechanism, scene.motion),
        laws_of(mechanism, scene.motion),
        scene.span[0],
        t,
        mechanism.values({**scene.assembly, **values}),
        {**mechanism.rough, **scene.posture},
        closed=False,
    )
    return nearest, state


def _stood(
    mechanism: Mechanism,
    laws: Mapping[str, Any],
    start: float,
    t: float,
    values: Mapping[str, float],
    rough: Mapping[str, Any],
    closed: bool,
) -> tuple[Nearest, State, list[int], Tree, list[str]]:
    """Place a mechanism with driven motions at an instant, from a rough posture at the start.

    Returns its loops, the state of its coordinates, the loops that this leaves open, the tree, and
    the bodies that no joint places.
    """
    whole, tree, floating = _joined(mechanism, laws)
    p = list(parameter_values(whole.parameters, values).values())
    carried = [axis.coordinate for branch in tree.branches for axis in branch.joint.axes]
    driven = [name for name in carried if name in laws]
    multibody = assemble(whole, tree, driven, ())
    law = Laws.of(laws, whole.symbols).only(driven).motion
    numbers = begun(multibody, rough, Start(law, (start, start), p, ""))
    nearest = Nearest.of(multibody, numbers, rough)
    state, left = nearest.found(nearest.released.first)
    if t != start and not (closed and left):
        state, left = _followed(nearest, law, state, t, closed)
    return nearest, state, left, tree, floating


def _measured(mechanism: Mechanism, values: Mapping[str, float]) -> Mechanism:
    """The mechanism with a parameter for the length of each link that has a number for it."""
    found = copy.copy(mechanism)
    found.parameters, found.joints = dict(mechanism.parameters), dict(mechanism.joints)
    symbols: dict[Any, Any] = {}
    for name, link in mechanism.links.items():
        if not isinstance(link.length, ca.SX) and link.length > 0.0:
            what, symbol = f"length of {name}", ca.SX.sym(f"length_of_{name}")
            found.parameters[what] = Parameter(what, link.length, "m", 0.0, math.inf, symbol)
            symbols[link] = symbol

    def measured(point: Point) -> Point:
        at_tip = point.end == "tip" and point.body in symbols
        return replace(point, x=symbols[point.body]) if at_tip else point

    for name, joint in mechanism.joints.items():
        found.joints[name] = replace(
            joint, parent=measured(joint.parent), child=measured(joint.child)
        )
    return found


def _followed(
    nearest: Nearest, law: ca.Function, state: State, t: float, closed: bool
) -> tuple[State, list[int]]:
    """The state at an instant, from one before, by steps that are small beside a turn, and the
    loops that are open then; or the last state on the way in which all are ``closed``.
    """
    sizes = nearest.released.sizes[nearest.driven]
    start, p = state[2], state[3]

    def driven_at(t: float, state: State) -> State:
        """A state that is driven as it is at an instant."""
        u = state[0].copy()
        u[nearest.driven] = law(t, p)[0].full().ravel() / sizes
        return u, state[1], t, p

    samples = np.linspace(start, t, _SAMPLES)
    ways = np.abs(np.diff(law(samples[None], p)[0].full())).sum(axis=1) / sizes
    step = least = (t - start) / (1 + min(_MOST, np.max(ways, initial=0.0) / _TURN))
    while state[2] != t and abs(step) > abs(least) * _TINY:
        at = state[2] + step
        ahead = nearest.closed(driven_at(t if abs(at - start) > abs(t - start) else at, state))
        state, step = (state, step / 2.0) if ahead is None else (ahead, step)
    return (state, []) if closed or state[2] == t else nearest.found(driven_at(t, state))


def _joined(mechanism: Mechanism, driven: Collection[str]) -> tuple[Mechanism, Tree, list[str]]:
    """The mechanism without what bears on no place, with a joint that holds nothing at each body
    that no other joint can place; its tree, and these bodies.
    """
    whole = copy.copy(mechanism)
    whole.joints, whole.loads, whole.rows = dict(mechanism.joints), {}, {}
    floating: list[str] = []
    tree, lacking = grow(whole, driven)
    while lacking:
        body = next((body for body in lacking if body.oriented), lacking[0])
        floating.append(body.name)
        joint = _holding_nothing(whole, body)
        whole.joints[joint.name] = joint
        tree, lacking = grow(whole, driven)
    closing = tuple(joint for joint in tree.closing if joint.kind != "screw")
    return whole, replace(tree, closing=closing), floating


def _holding_nothing(mechanism: Mechanism, body: Any) -> Joint:
    """A joint of a body with the ground that leaves all motions free, all of which are zero where
    the body was declared to be.
    """
    near, far = Point(mechanism.ground, 0.0, 0.0), Point(body, 0.0, 0.0)
    name, z, x, y = f"{body.name} (floating)", AXES[2], AXES[0], AXES[1]
    if not isinstance(mechanism, SpatialMechanism):
        return Joint(name, "planar", near, far, (z, x, y), Rotation())
    where = mechanism.references.get(body.name, Reference())
    x, y, z = where.origin
    return Joint(name, "free", Point(mechanism.ground, x, y, z=z), far, AXES, where.rotation)


def _set_beside(
    bases: dict[str, Array],
    axes: Mapping[str, Array],
    description: Description,
    floating: Sequence[str],
) -> None:
    """Move bodies that no chain of joints connects to the ground beside the others, those that are
    connected with each other together.
    """
    joints = description.joints.values()
    groups = {name: {name} for name in ("ground", *description.bodies)}
    for joint in joints:
        one, other = (groups[end.body] for end in joint.ends)
        one |= other
        groups |= dict.fromkeys(one, one)

    def corners(bodies: Collection[str]) -> tuple[Array, Array]:
        """The least and the largest coordinates of bodies."""
        tips = [bases[b] + (description.bodies[b].length or 0.0) * axes[b][0] for b in bodies]
        points = np.array([*(bases[b] for b in bodies), *tips] or np.zeros((1, 3)))
        return points.min(axis=0), points.max(axis=0)

    room, standing = _BESIDE * description.size, groups["ground"] - {"ground"}
    for name in floating:
        if name not in standing:
            (low, _), (bottom, right) = corners(groups[name]), corners(standing)
            shift = np.array([right[0] + room - low[0], bottom[1] - low[1], 0.0])
            for body in groups[name]:
                bases[body] = bases[body] + shift
            standing |= groups[name]
