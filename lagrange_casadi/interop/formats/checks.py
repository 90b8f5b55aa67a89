"""Checks of a record: what no body and no mechanism can be, and what a drawing has rounded."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ...base.arrays import Array
from .file_frames import Frame
from .posture import EXACT, SLACK, apart, assemble, extent, hang, outward
from .record import GROUND, Body, Joint, Model

SHORTEST_ROD = 1e-9
"""The length of a rod, at least, of its mechanism's size: places are as exact as doubles are."""


def checked(model: Model, *, accept_inertias: bool = False) -> Model:
    """Return a model that can be declared, its frames without rounding; moments of inertia that no
    body has are taken as they are if these are accepted.

    Raises :class:`.ModelFileError`, which names the element, for impossible bodies, joints of
    unknown bodies, and parts that hang on nothing.
    """
    if not model.bodies:
        raise model.refuse("", "has no body that moves")
    if not any(body.mass for body in model.bodies.values()):
        raise model.refuse("", "no body that moves has a mass: give the bodies masses")
    wrong: dict[str, str] = {}
    joints = model.joints.values()
    welded = {name for one in joints if one.kind == "weld" for name in one.ends}
    for body in model.bodies.values():
        model.bodies[body.name] = _body(model, body, welded, wrong)
    if wrong and not accept_inertias:
        raise model.refuse(
            model.bodies[next(iter(wrong))].where,
            "no body has such principal moments of inertia, none negative and none larger than the"
            f" sum of the other two: {'; '.join(wrong.values())}; correct them, or take them as"
            " they are by accept_inertias=True",
        )
    model.notes += [
        f"{words}: no body has such principal moments of inertia; they are as in the file."
        + (" The energy of this one may be negative." if "negative" in words else "")
        for words in wrong.values()
    ]
    bodies = {GROUND: None, **model.bodies}
    for joint in model.closures:
        for name in joint.ends:
            model.known(f"{joint.where}: joint '{joint.name}'", "body", name, bodies)
        if joint.parent == joint.child:
            raise model.refuse(
                joint.where, f"joint '{joint.name}' joins '{joint.parent}' to itself"
            )
    hang(model)
    if model.drawn:
        assemble(model)
    _connected(model)
    _lengths(model)
    valid = model.coordinates
    single = {name: None for name in valid if ":" not in name}
    stated = {name: law.where for name, law in model.motions.items()} | dict.fromkeys(
        model.posture, "posture"
    )
    for name, where in stated.items():
        model.known(where, "coordinate", name, valid)
    for one in model.couplings.values():
        for name in (one.first, one.second):
            model.known(one.where, "coordinate", name, single)
        if one.first == one.second:
            raise model.refuse(one.where, f"couples joint '{one.first}' to itself")
    _rounding(model)
    _spins(model)
    return model


def _body(model: Model, body: Body, welded: set[str], wrong: dict[str, str]) -> Body:
    """Return a body whose mass can be, with symmetric moments of inertia; say what is wrong with
    these, but for a drawing's rounding. A mass without them that is welded is a lump at its centre.
    """
    what = f"body '{body.name}'"
    if body.mass < 0.0:
        raise model.refuse(body.where, f"{what}: a mass of {body.mass:g} kg is impossible")
    inertia = (body.inertia + body.inertia.T) / 2.0
    if not np.any(inertia) and body.mass > 0.0 and not body.point:
        if body.name not in welded:
            raise model.refuse(
                body.where,
                f"{what} has a mass of {body.mass:g} kg and no inertia; give its moments of"
                " inertia about the centre of mass",
            )
        model.notes.append(f"{what} has no inertia: its mass is a lump at its centre.")
    moments = np.linalg.eigvalsh(inertia)
    excess, off = float(2.0 * moments[2] - moments.sum()), EXACT * float(np.abs(moments).max())
    text = f"{what} ({', '.join(f'{moment:.6g}' for moment in moments)} kg m^2, of which"
    if moments[0] < min(-off, -1e-9 * moments[2]):
        wrong[body.name] = f"{text} {moments[0]:.3g} is negative)"
    elif excess > 1e-3 * moments[2]:
        wrong[body.name] = f"{text} the last is too large by {excess:.3g})"
    elif excess > off:
        model.notes.append(
            f"{what}: its largest principal moment of inertia exceeds the sum of the other two by"
            f" {excess:.1e} kg m^2, which is taken as rounding"
        )
    return replace(body, inertia=inertia, strange=excess > off or bool(moments[0] < -off))


def _connected(model: Model) -> None:
    """Raise :class:`.ModelFileError` for the first body that hangs on nothing; one that ties alone
    hold is free but for these.
    """
    reached = {GROUND}
    for one in outward(model.closures, reached):  # a tie comes where no joint can follow
        for free in {*one.ends} - reached if one.rows else ():
            model.attach(free, GROUND, "free", one.where)
    for body in model.bodies.values():
        if body.name not in reached:
            raise model.refuse(body.where, f"body '{body.name}' is not connected to the ground")


def _lengths(model: Model) -> None:
    """Raise :class:`.ModelFileError` for a rod that is too short for the mechanism's size, and for
    wheels whose axes are one.
    """
    size = extent(model)
    for body in model.bodies.values():
        if body.rod and not (length := math.dist(*body.rod)) > SHORTEST_ROD * size:
            raise model.refuse(
                body.where,
                f"body '{body.name}': a rod of {length:g} m in a mechanism of {size:g} m;"
                f" expected at least {SHORTEST_ROD:g} of it",
            )
    for tie in model.ties.values():
        near, far = model.frames(tie)
        away = (one.relative(other).place[:2] for one, other in ((near, far), (far, near)))
        wheels = any(row.kind == "wheels" for row in tie.rows)
        if wheels and min(map(np.linalg.norm, away)) <= SLACK * size:
            raise model.refuse(tie.where, "the axes of its two wheels coincide")


def _spins(model: Model) -> None:
    """Hold the idle spin of bodies that are no rods: one of their spherical joints is universal."""
    on = model.joints_on()
    for name in (name for name in spinning(model) if model.bodies[name].rod is None):
        first, last = on[name]
        other = last.parent if last.child == name else last.child
        along = model.frames(last)[0].place - model.frames(first)[0].place
        across = _axis_of(model, on[other], along / np.linalg.norm(along))
        held = []
        for mine, frame in ((last.parent, last.on_parent), (last.child, last.on_child)):
            # The neighbour carries the axis about which it turns; the body the one across it.
            z = across if mine == other else np.cross(along, across)
            axes = model.frame_of(mine).axes.T @ Frame.about(z).axes
            held.append(Frame(frame.place, axes))
        near, far = held
        model.joints[last.name] = replace(last, kind="universal", on_parent=near, on_child=far)
        model.notes.append(
            f"body '{name}' lies between two spherical joints, and its rotation about the line"
            f" between them has no effect: joint '{last.name}' is made universal"
        )


def _axis_of(model: Model, joints: list[Joint], along: Array) -> Array:
    """Return a direction across a line, about which the body at its end, which has these joints,
    turns, where it does.
    """
    for joint in joints:
        if joint.kind == "revolute":
            axis = model.frames(joint)[0].axes[:, 2]
            across = axis - (axis @ along) * along
            if (size := float(np.linalg.norm(across))) > 0.1:
                return np.asarray(across / size)
    return Frame.about(along).axes[:, 0]


def _rounding(model: Model) -> None:
    """Note axes and frames of joints that miss by a drawing's rounding."""
    size, (off, where) = extent(model), model.rounded
    if off:
        model.notes.append(
            f"Axes that are off right angles by {off:.1e} (at {where}) or less are taken as"
            " rounding, and set at right angles."
        )
    for joint in model.joints.values():
        gap, angle = apart(model, joint)
        if EXACT < max(gap / size, angle) <= SLACK:
            model.notes.append(
                f"joint '{joint.name}': its two frames differ by {gap:.1e} m and {angle:.1e} rad,"
                " which is taken as rounding: the child's place and the parent's axes are used"
            )


def spinning(model: Model) -> list[str]:
    """Return the bodies between two spherical joints and on no other, whose spin about the line
    between these loads nothing.
    """
    on = model.joints_on()
    return [name for name, body in model.bodies.items() if _spins_idly(body, on[name])]


def _spins_idly(body: Body, joints: list[Joint]) -> bool:
    """Return whether a body's spin about the line between two spherical joints loads nothing."""
    if len(joints) != 2 or any(one.kind != "spherical" for one in joints) or body.point:
        return False
    own = (one.on_parent if one.parent == body.name else one.on_child for one in joints)
    first, second = (frame.place for frame in own)
    if not (length := float(np.linalg.norm(second - first))):
        return False
    along, beside = (second - first) / length, body.centre - first
    off = float(np.linalg.norm(beside - (beside @ along) * along))
    twist = body.inertia @ along
    askew = float(np.linalg.norm(twist - (twist @ along) * along))
    straight = askew <= SLACK * float(np.trace(body.inertia))
    return straight and (off <= SLACK * length or not body.mass)
