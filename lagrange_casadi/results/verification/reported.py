"""The results to be verified, read as vectors of the components that their space has."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array, during
from ...base.quantities import Output
from ...base.vocabulary import Precision
from ...engine.compensated import DTYPES, ROUNDING
from ...model.description import Description, JointNumbers
from ..histories import Histories
from ..section_laws import SectionLaw
from .instant_vectors import about, constant

_ROUNDINGS = 4.0
"""So many roundings may be in what is reported."""

NEARBY = 32.0
"""So many roundings may be between what is reported, and what a law has seen of it."""

TOLERANCE, COARSE = 1e-9, 1e-3
"""A residual above it means that the solution is wrong, not that it is rounded; in doubles, and
where less was asked for.
"""

_NEAR = 1e-3
"""The square of the cosine of a second turn below which the rates of three turns have lost digits
of the body's.
"""


def precision_of(histories: Histories) -> Precision:
    """The precision that histories were made with."""
    return "single" if histories.provenance.precision == "single" else "double"


def blur(histories: Histories) -> float:
    """Uncertainty of a phase by the reported angles: one rounding of the largest of them [rad]."""
    angles = [
        Output("motion", name)
        for name, kind in histories.description.coordinates.items()
        if kind == "angle"
    ]
    angles += [Output("pose", name, "angle") for name in histories.description.bodies]
    reported = (histories.outputs[angle] for angle in angles if angle in histories.outputs)
    return ROUNDING[precision_of(histories)] * max(
        (float(np.max(np.abs(values))) for values in reported), default=0.0
    )


@dataclass(frozen=True, eq=False)
class Reported:
    """Outputs at some instants ``t``, those that are hidden from users included.

    ``phases`` are angles up to whole turns that are known more closely than they are reported.
    ``laws`` are the laws of links with sections. There are places and forces along ``lines``, and
    turns and couples about ``turns``: "xyz", in a plane "xy" and "z". ``unmeasured`` are
    coordinates that are not reported, or not used.
    """

    t: Array
    outputs: Mapping[Output, Array]
    phases: Mapping[Output, Array]
    laws: Mapping[str, SectionLaw]
    lines: str
    turns: str
    unmeasured: frozenset[str]
    precision: Precision

    @property
    def rounding(self) -> float:
        """The largest relative error of one rounding."""
        return ROUNDING[self.precision]

    def straight(self, values: npt.ArrayLike) -> Array:
        """The components of a declared place, force or direction of a slide, (3,) or (3, t)."""
        return np.reshape(values, (3, -1))[: len(self.lines)]

    def turning(self, values: npt.ArrayLike) -> Array:
        """The components of a declared couple or direction of a turn, (3,) or (3, t)."""
        return np.reshape(values, (3, -1))[-len(self.turns) :]

    @property
    def ground(self) -> Array:
        """Axes that are not turned."""
        return constant(np.eye(len(self.lines)))

    def rounded(self, values: Array) -> Array:
        """Largest error of reported values by their last digits."""
        return _ROUNDINGS * self.rounding * np.abs(values)

    @property
    def least(self) -> float:
        """The force beside which what underflows is as small as a rounding."""
        return float(np.finfo(DTYPES[self.precision]).tiny) / self.rounding

    @property
    def doubted(self) -> float:
        """Limit of a residual by the roundings of a law alone; a larger one is examined more
        closely.
        """
        return 256.0 * self.rounding

    @property
    def coarseness(self) -> float:
        """A rounding as a share of the least residual that fails."""
        return _ROUNDINGS * self.rounding / (COARSE if self.precision == "single" else TOLERANCE)

    def during(self, instants: slice) -> Reported:
        """The results at some of the instants."""
        moving = {name: getattr(self, name) for name in ("t", "outputs", "phases", "laws")}
        return replace(self, **during(moving, instants))

    def without_locked(self, declared: Description) -> Reported:
        """The results without turns near gimbal lock among what is used: those bodies are taken
        where they are reported.

        Three turns that loops set say nothing where they lock, and little near it; driven ones are
        known all the same.
        """
        locked = {
            name for joint in declared.joints.values() for name in self._locked(declared, joint)
        }
        return replace(self, unmeasured=self.unmeasured | locked) if locked else self

    def _locked(self, declared: Description, joint: JointNumbers) -> list[str]:
        rotations = [axis.coordinate for axis in joint.axes if axis.kind == "angle"]
        if len(rotations) < 3 or {*rotations} & {*declared.driven, *self.unmeasured}:
            return []
        second = self.outputs[Output("motion", rotations[1])]
        return [] if np.min(np.cos(second) ** 2) > _NEAR else rotations

    @cached_property
    def members(self) -> Mapping[tuple[str, str], Mapping[str, Array]]:
        """The outputs of each group and part by their members; of sections, the last one's."""
        found: dict[tuple[str, str], dict[str, Array]] = defaultdict(dict)
        for output, values in self.outputs.items():
            found[output.group, output.part][output.member] = values
        return found

    def motion(self, coordinate: str) -> Array:
        """The value of a coordinate, its rate and its acceleration, (3, t)."""
        moving = self.members["motion", coordinate]
        return np.array([moving[one] for one in ("", "rate", "acceleration")], float)

    def phase(self, output: Output) -> Array:
        """An angle up to whole turns, as closely as it is known."""
        return self.phases.get(output, self.outputs[output])

    def place(self, body: str) -> Array:
        """The place of a body's origin."""
        return self._vector("pose", body, self.lines)

    def axes(self, body: str) -> Array:
        """The axes of a body; those of the ground where it has none."""
        if Output("pose", body, "xx") in self.outputs:
            return np.array([self._vector("pose", body, (a + x for x in "xyz")) for a in "xyz"])
        angle = Output("pose", body, "angle")
        turned = angle in self.outputs
        return about(constant([1.0]), self.phase(angle)) if turned else self.ground

    def acts(self, group: str, part: str, axes: str = "") -> tuple[Array, Array]:
        """The force and the couple of a part, on other ``axes`` where given; components that it has
        none of are zero.
        """
        force, couple = (
            self._vector(group, part, (letter + x for x in axes or ground))
            for letter, ground in (("f", self.lines), ("m", self.turns))
        )
        return force, couple

    def _vector(self, group: str, part: str, members: Iterable[str]) -> Array:
        given, nothing = self.members[group, part], np.zeros_like(self.t)
        return np.array([given.get(member, nothing) for member in members], float)

    def inside(self, link: str) -> tuple[Array, Array]:
        """The force and the moment of a link's section at its base, in the link's axes."""
        law, base = self.laws[link], np.zeros((self.t.size, 1))
        found = np.array([law.at(force, base)[:, 0] for force in law.table.sections])
        return found[: len(self.lines)], found[len(self.lines) :]
