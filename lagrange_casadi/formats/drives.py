"""Drives of a model whose file gives too few motions: coordinates, and their values at rest."""

from __future__ import annotations

import numpy as np

from ..base.arrays import Array
from .checks import spinning
from .record import GROUND, MOVES, Frame, Joint, Law, Model, Tie

RANK = 1e-8
"""Singular values that are smaller, of the largest, are none."""

STEP = 1e-100
"""A step of which nothing is left in what is real."""

REST = "The file gives no motion of {}: here it rests. Write how it moves among the laws."


def driven(model: Model) -> Model:
    """Return a model in which as many coordinates have a motion as it has degrees of freedom.

    Those of the file have theirs; others are taken in the order of joints, and rest where they are.
    """
    names = [name for joint in model.joints.values() for name in joint.coordinates]
    rates = _rates(model, names)
    rank = int(np.linalg.matrix_rank(rates, RANK)) if rates.size else 0
    needed = len(names) - rank - sum(model.bodies[one].rod is not None for one in spinning(model))
    chosen = [k for k, name in enumerate(names) if name in model.motions]
    single = [len(model.joints[name.partition(":")[0]].coordinates) for name in names]
    later = [name.partition(":")[0] not in model.preferred for name in names]
    for k in sorted(range(len(names)), key=lambda k: (later[k], single[k] > 2, k)):
        if len(chosen) >= needed:
            break
        rest = [j for j in range(len(names)) if j not in (*chosen, k)]
        if k not in chosen and int(np.linalg.matrix_rank(rates[:, rest], RANK)) == rank:
            chosen.append(k)
    resting = [names[k] for k in chosen if names[k] not in model.motions]
    if resting:
        model.notes.append(REST.format(", ".join(resting)))
    for name in resting:
        joint = model.joints[name.partition(":")[0]]
        start = model.at_reference(joint)[joint.coordinates.index(name)]
        model.motions[name] = Law(repr(float(model.posture.get(name, start)) + 0.0))
    return model


def _rates(model: Model, names: list[str]) -> Array:
    """Return what closes: rows of loops and couplings by the rates of coordinates, in the reference
    posture.
    """
    paths: dict[str, list[tuple[str, Array]]] = {GROUND: []}
    rows: list[Array] = []
    column = {name: k for k, name in enumerate(names)}
    waiting = list(model.joints.values())
    while waiting:
        found = [one for one in waiting if (one.parent in paths) != (one.child in paths)]
        closing = [one for one in waiting if one.parent in paths and one.child in paths]
        for joint in closing:
            rows.append(_closed(model, joint, paths, column))
        waiting = [one for one in waiting if one not in closing]
        if not (tree := next((one for one in found if one in waiting), None)):
            continue
        sign = 1.0 if tree.parent in paths else -1.0
        near, far = (tree.parent, tree.child) if sign > 0 else (tree.child, tree.parent)
        twists = [(name, sign * twist) for name, twist in _twists(model, tree)]
        paths[far] = [*paths[near], *twists]
        waiting.remove(tree)
    for one in model.couplings.values():
        row = np.zeros((1, len(names)))
        row[0, column[one.second]], row[0, column[one.first]] = 1.0, -one.ratio
        rows.append(row)
    for tie in model.ties.values():
        rows.append(_tied(model, tie, paths, column))
    return np.vstack(rows) if rows else np.zeros((0, len(names)))


def _closed(
    model: Model, joint: Joint, paths: dict[str, list[tuple[str, Array]]], column: dict[str, int]
) -> Array:
    """Return six rows of a loop that a joint closes, its own coordinates too."""
    rows = np.zeros((6, len(column)))
    for sign, body in ((1.0, joint.parent), (-1.0, joint.child)):
        for name, twist in paths[body]:
            rows[:, column[name]] += sign * twist
    for name, twist in _twists(model, joint):
        rows[:, column[name]] += twist
    return rows


def _tied(
    model: Model, tie: Tie, paths: dict[str, list[tuple[str, Array]]], column: dict[str, int]
) -> Array:
    """Return the rows of a tie, by what its frames do in a small motion: a complex step."""
    near, far = model.frames(tie)
    moved = np.zeros((6, len(column)))
    for sign, body in ((1.0, tie.child), (-1.0, tie.parent)):
        for name, twist in paths[body]:
            moved[:, column[name]] += sign * twist
    size, found = model.size(), np.zeros((len(tie.rows), len(column)))
    x, y, z = near.axes.T
    for k in range(len(column)):
        speed, spin = moved[:3, k] * size, moved[3:, k]
        q = far.place + 1j * STEP * (speed + np.cross(spin, far.place))
        u, v, w = far.axes.T + 1j * STEP * np.cross(spin, far.axes.T)
        away = q - near.place
        for j, row in enumerate(tie.rows):
            e, f = (x, y, z)[row.i], (u, v, w)[row.j]
            values = {"slide": away @ e, "cosine": e @ f, "sides": x @ v + y @ u}
            values |= {"distance": away @ away}
            values["distance across"] = (away @ x) ** 2 + (away @ y) ** 2
            if row.kind == "wheels":
                first, second = (np.append(away @ near.axes, 0)[:2], -away @ np.array([u, v]).T)
                angles = [_angle(first), _angle(second)]
                values["wheels"] = angles[1] + row.factor * angles[0]
            values["slide and turn"] = away @ e + 1j * STEP * row.factor * (spin @ z)
            found[j, k] = values[row.kind].imag / STEP
    return found


def _angle(direction: Array) -> complex:
    """Return the small part of a direction's angle, as an imaginary number."""
    x, y = direction
    return complex(0.0, float((x.real * y.imag - y.real * x.imag) / (x.real**2 + y.real**2)))


def _twists(model: Model, joint: Joint) -> list[tuple[str, Array]]:
    """Return the velocity of the child against the parent for each coordinate: that of the point at
    the ground's origin over the mechanism's size, and the angular one.
    """
    near, far = model.frames(joint)
    moves = zip(joint.coordinates, MOVES[joint.kind], strict=True)
    return [
        (name, _twist(move, axis, near, far, joint.lead) * _scale(model))
        for name, (_, move, axis) in moves
    ]


def _scale(model: Model) -> Array:
    return np.array([1.0 / model.size()] * 3 + [1.0] * 3)


def _twist(move: str, axis: str, near: Frame, far: Frame, lead: float) -> Array:
    along = far.axes[:, 2] if axis == "w" else near.axes[:, "xyz".index(axis)]
    if move == "slide":
        return np.concatenate([along, np.zeros(3)])
    slide = lead / (2.0 * np.pi) * along if move == "screw" else np.zeros(3)
    return np.concatenate([np.cross(near.place, along) + slide, along])
