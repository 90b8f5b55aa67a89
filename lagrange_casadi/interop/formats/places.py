"""Names and places of a case: variables, parameters, and where links and joints lie in the
reference posture.
"""

from __future__ import annotations

import keyword
import math
import re
from collections.abc import Collection, Iterator

import numpy as np

from ...base.arrays import Array
from .file_frames import Frame
from .posture import extent
from .python_text import Call, Place, short, text_of, vector
from .record import GROUND, Body, Joint, Model


class Places:
    """Variables and parameters of a case, which has names of its own, and its places by these.

    ``held`` are the bodies that a joint places, ``at`` the places of these joints, ``named`` the
    variables of places, ``between`` the two places that each link lies between.
    """

    def __init__(self, model: Model, opened: Collection[str], own: Collection[str]) -> None:
        self.model, self.size = model, extent(model)
        self.variables: dict[str, str] = {GROUND: "m.ground"}
        self._used = set(own)
        closed = [one for one in model.joints.values() if one.name not in opened]
        self.held = {GROUND, *(end for one in closed for end in one.ends)}
        self.at = {one.name: self.place(model.frames(one)[1].place) for one in closed}
        self.on = model.joints_on()
        self.between = {
            name: self._ends(body, self.on[name]) for name, body in model.bodies.items()
        }
        self.named: dict[Place, str] = {}
        self._masses: dict[str, str] = {}
        self.mu = ""

    def _ends(self, body: Body, mine: list[Joint]) -> tuple[Place, Place]:
        """Return two places that a link lies between: a joint, and the place farthest from it."""
        if body.rod is not None:
            base, tip = (self.place(body.frame.at(one)) for one in body.rod)
            return base, tip
        origins = []
        for joint in sorted(mine, key=lambda one: one.child != body.name):
            near, far = self.model.frames(joint)
            own = self.place((near if joint.parent == body.name else far).place)
            origins.append(self.at.get(joint.name, own))
        base, centre = origins[0], self.place(body.frame.at(body.centre))
        farthest = max(origins, key=lambda one: math.dist(base, one))
        aside = self.place(np.array(base) + body.frame.axes[:, 0] * self.size / 10.0)
        tips = (one for one in (farthest, centre) if math.dist(base, one) >= 1e-6 * self.size)
        return base, next(tips, aside)

    def parameters(self) -> Iterator[str]:
        """Yield lines that declare masses that several bodies have, and those of payloads."""
        alike: dict[str | float, list[str]] = {}
        for body in self.model.bodies.values():
            alike.setdefault(
                body.name if body.name in self.model.payloads else body.mass, []
            ).append(body.name)
        for of, bodies in alike.items():
            if of in self.model.payloads or (of and len(bodies) > 1):
                name, mass = self.own(f"mass_{bodies[0]}"), self.model.bodies[bodies[0]].mass
                self._masses |= dict.fromkeys(bodies, name)
                yield f'{name} = m.parameter("{name}", {text_of(mass)}, "kg", low=0.0)'
        if self.model.contacts:
            self.mu = self.own("friction")
            yield f'{self.mu} = m.parameter("{self.mu}", 0.6, low=0.0)'
        for joint, place in self.at.items():
            if place not in self.named and any(place):
                self.named[place] = self.variable(f"at_{joint}")

    def mass(self, body: Body) -> str:
        """Return a body's mass, as a parameter where it is one."""
        return self._masses.get(body.name) or text_of(body.mass)

    def own(self, wanted: str) -> str:
        """Return a name for a parameter or a load of the case, which no part may have."""
        name = self.variable(wanted)
        return self.own(f"{name}_") if self.model.taken(name) else name

    def variable(self, wanted: str) -> str:
        """Return a name for a variable that none has yet."""
        name = re.sub(r"\W", "_", wanted, flags=re.ASCII)
        while keyword.iskeyword(name) or name in self._used:
            name = f"{name}_"
        self._used.add(name)
        return name

    def frame(self, body: str) -> Frame:
        """Return the frame of a link as declared: at its base, x to its tip, y across."""
        if body == GROUND:
            return Frame()
        base, tip = (np.array(place) for place in self.between[body])
        return Frame(base, Frame.about(tip - base).axes[:, [2, 0, 1]])

    def place(self, place: Array) -> Place:
        """Return a place without the rounding of sums."""
        x, y, z = short(place, self.size).tolist()
        return x, y, z

    def written(self, place: Place) -> object:
        """Return a place: its name, or its components."""
        return self.named.get(place) or vector(place)

    def point(self, body: str, place: Array) -> Call:
        """Return a point of a body that is at a place in the reference posture."""
        if body not in self.held:
            local = self.place(self.frame(body).relative(Frame(place)).place)
            return Call(f"{self.variables[body]}.at", [text_of(one) for one in local])
        at = map(text_of, self.place(place))
        if body == GROUND:
            return Call("m.ground.at", [*at])
        return Call("m.at", [self.variables[body], *at])
