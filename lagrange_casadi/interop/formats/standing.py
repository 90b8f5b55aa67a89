"""Robots on their feet: a posture in which points of a robot stay on the ground."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from ...base.units import Number, quantity
from .file_frames import Frame
from .posture import posed
from .record import GROUND, MOVES, Joint, Law, Model


@dataclass(frozen=True, eq=False)
class Standing:
    """Stand of a robot: whether its base is free, in which ``posture``, and which links or frames
    of the file are ``contacts``.
    """

    floating: bool = False
    posture: Mapping[str, Number] = field(default_factory=dict)
    contacts: Sequence[str] = ()

    def placed(self, model: Model) -> Model:
        """Add contacts to a model and, where there are some, the motion of its base and its drives;
        return the model in the posture, which has the same joints and motions.

        Raises :class:`.ModelFileError` for unknown links and coordinates.
        """
        moves = {
            name: move
            for joint in model.joints.values()
            for name, (_, move, _) in zip(joint.coordinates, MOVES[joint.kind], strict=True)
        }
        for name, value in self.posture.items():
            model.known("posture", "coordinate", name, moves)
            unit = "m" if moves[name] == "slide" else "rad"
            model.posture[name] = quantity(f"posture: '{name}'", value, unit)
        found = posed(model, model.posture) if model.posture else model
        joints = list(model.joints.values())
        for stated in self.contacts:
            body, frame = model.spot(stated)
            place = Frame(found.frame_of(body).then(frame).place)
            words = f"{stated}_contact"
            model.contacts.append(
                model.add(Joint, words, "", "spherical", GROUND, body, place, Frame(frame.place))
            )
        if self.contacts:
            for name in (name for one in joints if one.kind == "free" for name in one.coordinates):
                model.motions.setdefault(name, Law(repr(model.posture.get(name, 0.0))))
            model.drives = [one.name for one in joints if one.coordinates == (one.name,)]
        return found
