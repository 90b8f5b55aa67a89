"""Start of a mechanism by a rough posture, and what the posture leaves undecided, in lines to
paste.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import casadi as ca

from ..errors import PostureError
from ..model.scene_arguments import posture_entry
from .blocks import Block
from .multibody import Coordinate, Multibody, own_coordinate
from .substitution import Numbers


def is_angle(multibody: Multibody, name: str) -> bool:
    """Return whether a name of a posture is an angle."""
    return name in multibody.frames or multibody.mechanism.coordinates[name][1].kind == "angle"


def measured(
    multibody: Multibody, names: Collection[str]
) -> dict[str, tuple[ca.SX, set[Coordinate]]]:
    """Expressions of the posture's names, and the coordinates of each."""
    owner = {key: c for c in multibody.coordinates for key in c.keys}
    known: dict[str, tuple[Any, set[Coordinate]]] = {}
    for name in names:
        if name in multibody.frames:
            turn = multibody.frames[name].rotation
            expression = ca.SX(ca.atan2(turn.s, turn.c))
        else:
            joint, axis = multibody.mechanism.coordinates[name]
            if joint.turns > 2 and own_coordinate(axis, multibody.coordinates) is None:
                continue
            expression, *_ = multibody.motion_along(joint, axis)
        of = (owner.get(symbol.element_hash()) for symbol in ca.symvar(expression))
        known[name] = expression, {c for c in of if c is not None}
    return known


def directions(
    multibody: Multibody,
    posture: Mapping[str, float],
    numbers: Numbers,
    known: Collection[Coordinate],
) -> dict[str, float]:
    """Rough directions of bodies [rad]: those that are known by now or given, and those that joints
    carry on from these.

    A joint carries a direction from one of its bodies to the other where it holds it, or where the
    posture gives its angle.
    """
    mechanism, found = multibody.mechanism, {}
    for name, (direction, of) in measured(multibody, multibody.frames).items():
        if name in posture:
            found[name] = posture[name]
        elif of <= set(known) and mechanism.bodies[name].oriented:
            found[name] = numbers.of(direction)[0]
    steps: list[tuple[str, str, float]] = []
    for joint in mechanism.joints.values():
        parent, child = (body.name for body in joint.bodies)
        if joint.planar and joint.holds_direction:
            steps.append((parent, child, numbers.of(ca.SX(joint.turned.angle))[0]))
        elif joint.coordinate == "angle" and joint.name in posture:
            steps.append((parent, child, posture[joint.name]))
    going = True
    while going:
        before = len(found)
        for parent, child, angle in steps:
            if parent in found:
                found.setdefault(child, found[parent] + angle)
            elif child in found:
                found[parent] = found[child] - angle
        going = len(found) > before
    return found


@dataclass(eq=False)
class Undecided:
    """Missing entries of a posture: the ways to close each loop that has a closed form, and names
    that iterated loops need.
    """

    closures: list[tuple[Mapping[str, float], ...]] = field(default_factory=list)
    lacking: list[tuple[str, bool]] = field(default_factory=list)
    words: list[str] = field(default_factory=list)

    def __bool__(self) -> bool:
        return bool(self.closures or self.lacking)

    def note_ways(
        self,
        block: Block,
        modes: Sequence[Mapping[Coordinate, float]],
        words: Sequence[str],
        length: float,
    ) -> None:
        """Note that a loop can be assembled in some ways; the coordinate that differs most
        distinguishes them.
        """

        def apart(coordinate: Coordinate) -> float:
            residuals = (
                one[coordinate] - other[coordinate]
                for one, other in itertools.combinations(modes, 2)
            )
            return min(
                (
                    abs(math.remainder(residual, math.tau))
                    if coordinate.kind == "angle"
                    else abs(residual) / length
                )
                for residual in residuals
            )

        chosen = max(modes[0], key=apart)
        self.closures.append(tuple({chosen.posture_key: mode[chosen]} for mode in modes))
        many = "two" if len(modes) == 2 else "several"
        self.words.append(
            f"the loop closed by {block.joints} can be assembled in {many} ways at the start of the"
            f" motion: {' or '.join(words)}"
        )

    def note_lacking(self, block: Block, missing: Sequence[Coordinate]) -> None:
        """Note that an iteration needs rough values of coordinates to begin with."""
        names = [c.posture_key for c in missing]
        self.lacking += [(c.posture_key, c.kind != "slide") for c in missing]
        self.words.append(
            f"the loops closed by {block.joints} have no closed form; also give a rough posture of"
            f" {', '.join(names)}"
        )

    def refusal(self, multibody: Multibody) -> PostureError:
        """All of it as an error, with lines to paste."""
        lines = []
        for k in (
            range(len(self.closures[0])) if len(self.closures) == 1 and not self.lacking else (0,)
        ):
            entries = [
                posture_entry(
                    name,
                    not is_angle(multibody, name),
                    modes[k][name],
                    *(mode[name] for mode in modes),
                )
                for modes in self.closures
                for name in modes[k]
            ]
            entries += [
                f"'{name}': '... deg'" if angular else f"'{name}': ..."
                for name, angular in self.lacking
            ]
            lines.append("posture={" + ", ".join(entries) + "}")
        say = f"choose one by {' or '.join(lines)}" if self.closures else lines[0]
        after = (
            ", for example; each loop is listed for the first assembly of the loops before it"
            if len(self.closures) > 1
            else ""
        )
        return PostureError(
            f"{'; '.join(self.words)}; {say}{after}",
            tuple(self.closures),
            bool(self.lacking),
        )
