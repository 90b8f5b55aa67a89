"""Robots on their feet: a posture in which points of a robot stay on the ground."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ...base.units import Number, quantity
from .file_frames import Frame
from .posture import outward, posed
from .record import GROUND, MOVES, Joint, Law, Model


def free(model: Model, name: str) -> None:
    """Free the link or frame of a name, where the model is, in place of its base.

    Raises :class:`.ModelFileError` for one that no joints connect to a free base.
    """
    body, frame = model.spot(name)
    hung, reached = [one for one in model.joints.values() if one.parent == GROUND], {body}
    joints = [one for one in model.joints.values() if one.parent != GROUND]
    list(outward(joints, reached))  # which adds what joints connect
    connected = [one.name for one in hung if one.kind == "free" and one.child in reached]
    if len(connected) != 1:
        raise model.refuse(
            "",
            f"expected joints from '{name}' to one base that is free, found"
            f" {', '.join(map(repr, connected)) or 'none'}",
        )
    del model.joints[connected[0]]
    place = model.frame_of(body).then(frame)
    model.add(Joint, f"{name}_free", "", "free", GROUND, body, place, frame)


def placed(model: Model, posture: Mapping[str, Number], contacts: Sequence[str]) -> Model:
    """Add contacts to a model and, where there are some, the motion of its base and its drives;
    return the model in the posture, which has the same joints and motions.

    Raises :class:`.ModelFileError` for unknown links and coordinates.
    """
    moves = {
        name: move
        for joint in model.joints.values()
        for name, (_, move, _) in zip(joint.coordinates, MOVES[joint.kind], strict=True)
    }
    for name, value in posture.items():
        model.known("posture", "coordinate", name, moves)
        unit = "m" if moves[name] == "slide" else "rad"
        model.posture[name] = quantity(f"posture: '{name}'", value, unit)
    found = posed(model, model.posture) if model.posture else model
    for stated in contacts:
        body, frame = model.spot(stated)
        place = Frame(found.frame_of(body).then(frame).place)
        ends = GROUND, body, place, Frame(frame.place)
        model.contacts.append(model.add(Joint, f"{stated}_contact", "", "spherical", *ends))
    if contacts:
        for name in (name for name, one in model.coordinates.items() if one.kind == "free"):
            model.motions.setdefault(name, Law(repr(model.posture.get(name, 0.0))))
        model.drives = [name for name, one in model.coordinates.items() if one.name == name]
    return found
