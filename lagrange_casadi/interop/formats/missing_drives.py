"""Drives of a model whose file gives too few motions: coordinates, and their values at rest."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...base.arrays import Array
from .checks import spinning
from .posture import at_reference, closing, extent, outward
from .record import GROUND, MOVES, Joint, Law, Model
from .separate_systems import Rows, blocks, check_size

RANK = 1e-6
"""Smaller singular values come of axes that a drawing has rounded."""

REST = "The file gives no motion of {}: here it rests. Write how it moves among the laws."


def drive(model: Model) -> None:
    """Give as many coordinates of a model a motion as it has degrees of freedom.

    Those of the file have theirs; others are taken in the order of joints, and rest where they are.
    Raises :class:`.ModelFileError` for loops too large to find what moves in them.
    """
    size = extent(model)
    twists = {
        one.name: {name: twist[:, None] for name, twist in _twists(model, one, size)}
        for one in model.joints.values()
    }
    names = [name for one in twists.values() for name in one]
    idle = 3 * sum(body.point for body in model.bodies.values()) + sum(
        model.bodies[one].rod is not None for one in spinning(model)
    )
    joint_of, preferred = model.coordinates, set(model.preferred)

    def last(name: str) -> tuple[bool, ...]:
        several = name in joint_of and len(joint_of[name].coordinates) > 2
        later = name.partition(":")[0] not in preferred
        return name not in model.motions, name not in joint_of, later, several

    equations, factors = list[Rows](), 0
    for found in _rows(model, twists, size):
        check_size(model, factors := factors + 6 * len(found))
        equations += [found] if found else []
    order, followed = sorted(names, key=last), set[str]()
    for rows, block, _ in blocks(model, equations, order):
        followed |= {block[k] for k in _basis(rows)}
    needed = len(names) - len(followed) - idle - sum(name in model.motions for name in names)
    taken = {*followed, *model.motions}
    resting = [one for one in order if one in joint_of and one not in taken][: max(needed, 0)]
    if resting:
        model.notes.append(REST.format(", ".join(resting)))
    for name in resting:
        start = model.posture.get(name, at_reference(model, name, size))
        model.motions[name] = Law(repr(float(start) + 0.0))


def _basis(rows: Array) -> list[int]:
    """Return the numbers of columns on which all others depend, the last ones that do."""
    found, rank = list[int](), int(np.linalg.matrix_rank(rows, RANK))
    axes = np.zeros((len(rows), rank))
    for k in reversed(range(rows.shape[1])):
        if len(found) == rank:
            break
        rest, known = rows[:, k], axes[:, : len(found)]
        for _ in range(2):  # the second time without the rounding of the first
            rest = rest - known @ (known.T @ rest)
        if (length := float(np.linalg.norm(rest))) > RANK:
            axes[:, len(found)] = rest / length
            found.append(k)
    return found


def _rows(model: Model, twists: dict[str, Rows], size: float) -> Iterator[Rows]:
    """Yield what closes in the reference posture: equations of loops, couplings and ties."""
    above: dict[str, tuple[int, str, str, float]] = {GROUND: (0, "", "", 0.0)}
    for joint in outward([*model.joints.values()], {GROUND}):
        parent, child = joint.ends
        if child not in above:
            above[child] = (above[parent][0] + 1, parent, joint.name, 1.0)
        elif parent not in above:
            above[parent] = (above[child][0] + 1, child, joint.name, -1.0)
        else:
            yield _between(above, twists, child, parent) | twists[joint.name]
    for coupling in model.couplings.values():
        yield {coupling.second: np.ones((1, 1)), coupling.first: np.array([[-coupling.ratio]])}
    for tie in model.ties.values():
        slopes = closing(model, tie, tie.rows, size)[1]
        rows = _between(above, twists, tie.parent, tie.child)
        yield {name: slopes @ twist for name, twist in rows.items()}


def _between(
    above: dict[str, tuple[int, str, str, float]], twists: dict[str, Rows], one: str, other: str
) -> Rows:
    """Return the velocity of the other body against one by the rates of the joints between them, in
    a tree of bodies: depth, body and joint above each, and the sign of the joint's twist.
    """
    found: Rows = {}
    while one != other:
        deeper, direction = (other, 1.0) if above[other][0] >= above[one][0] else (one, -1.0)
        _, next_one, joint, sign = above[deeper]
        found |= {name: direction * sign * twist for name, twist in twists[joint].items()}
        one, other = (one, next_one) if deeper == other else (next_one, other)
    return found


def _twists(model: Model, joint: Joint, size: float) -> Iterator[tuple[str, Array]]:
    """Yield the velocity of the child against the parent for each coordinate: that of the point at
    the ground's origin over a size [m], and the angular one.

    A point mass has no direction, so a joint holds none there: in place of the joint's turns are
    three of the mass itself, which are no coordinates.
    """
    near, far = model.frames(joint)
    axes = dict(zip("xyzw", (*near.axes.T, far.axes[:, 2]), strict=True))
    freedoms = zip(joint.coordinates, MOVES[joint.kind], strict=True)
    moves = [(name, move, axes[axis], near.place) for name, (_, move, axis) in freedoms]
    bodies = (model.bodies[one] for one in joint.ends if one != GROUND)
    if points := [one.frame.place for one in bodies if one.point]:
        moves = [one for one in moves if one[1] == "slide"]
        moves += [(f"{joint.name} {k}", "turn", x, points[0]) for k, x in enumerate(np.eye(3))]
    for name, move, along, place in moves:
        speed, spin = (along, 0.0 * along) if move == "slide" else (np.cross(place, along), along)
        if move == "screw":
            speed = speed + joint.lead / (2.0 * np.pi) * along
        yield name, np.concatenate([speed / size, spin])
