"""Robots on their feet: a posture in which points of a robot stay on the ground."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from ...base.units import Number, quantity
from .file_frames import Frame
from .posture import outward, posed
from .record import GROUND, MOVES, Joint, Law, Model


@dataclass(frozen=True, eq=False)
class Standing:
    """Stand of a robot: whether its base is free, or which link or frame in its place, in which
    ``posture``, and which links or frames of the file are ``contacts``.
    """

    floating: bool | str = False
    posture: Mapping[str, Number] = field(default_factory=dict)
    contacts: Sequence[str] = ()

    def free(self, model: Model) -> None:
        """Free the link or frame that is named, where the model is, in place of its base.

        Raises :class:`.ModelFileError` for one that no joints connect to a free base.
        """
        if not isinstance(self.floating, str):
            return
        body, frame = model.spot(self.floating)
        free = {
            one.child: one.name
            for one in model.joints.values()
            if one.kind == "free" and one.parent == GROUND
        }
        joints = [one for one in model.joints.values() if one.parent != GROUND]
        reached = {body}
        list(outward(joints, reached))  # which adds what joints connect
        bases = [joint for base, joint in free.items() if base in reached]
        if len(bases) != 1:
            found = ", ".join(map(repr, bases)) or "none"
            words = (
                f"expected joints from '{self.floating}' to one base that is free, found {found}"
            )
            raise model.refuse("", words)
        del model.joints[bases[0]]
        place = model.frame_of(body).then(frame)
        model.add(Joint, f"{self.floating}_free", "", "free", GROUND, body, place, frame)

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
