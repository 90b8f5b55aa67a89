"""What a scene computes, as CasADi functions that hold nothing else; and the same as text, to be kept."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca

from ..declare.density import Array
from ..declare.motion import Laws
from ..declare.scene import Scene, Wanted
from .gaps import extent
from .kinematics import NewtonLoop
from .mobility import LAW, STATION, stations_of


@dataclass(frozen=True, eq=False)
class SceneGraph:
    """What a scene computes, as CasADi functions that hold nothing else.

    ``motion(t, p) -> (d, d_rate, d_acceleration)``; ``instant(t, d, d_rate, d_acceleration, z, p) -> out``, one row of ``out`` a
    column name; ``newton`` where loops must be iterated. Columns that begin with ``_`` are no outputs. They tell whether there is
    a result: ``_closure:JOINT`` (see :mod:`.loops`), ``_gap:JOINT`` and ``_misfit:JOINT`` (see :mod:`.gaps`), ``_row:NAME`` and
    ``_rowsize:NAME``, and ``_turned:NAME``, how far an angle swings that is seen with its turns (see :mod:`.turns`); whether it is
    the only one: ``_open:FORCE`` (see :mod:`.determinacy`); or they are what the certificate needs: ``_multiplier:NAME``, where
    it was not wanted. ``wrapped`` names the angles that loops set, and what they are sums and differences of: by
    ``pose:BODY:angle`` directions known up to whole turns, and by ``_turns:JOINT`` the whole turns of angles that count them,
    which are in these columns without them.
    """

    scene: Scene
    wanted: Wanted
    driven: tuple[str, ...]
    motion: Any
    instant: Any
    newton: NewtonLoop | None
    columns: tuple[str, ...]
    wrapped: Mapping[str, Mapping[str, int]]

    @cached_property
    def laws(self) -> Laws:
        """The motion once more, what samples give apart from what can be followed in any arithmetic."""
        if self.motion.is_a("SXFunction"):
            return Laws(self.motion, None, tuple(range(len(self.driven))))
        return Laws.of({name: self.scene.motion[name] for name in self.driven}, self.scene.mechanism.symbols)

    def extent(self, p: Array) -> float:
        """The size of the mechanism [m], beside which a gap is large or small, for parameters ``p``."""
        mechanism = self.scene.mechanism
        return mechanism.number(extent(mechanism), dict(zip(mechanism.parameters, map(float, p), strict=True)))

    @cached_property
    def links(self) -> tuple[str, ...]:
        """The links of which a whole section law was wanted, and is there."""
        needed = {
            link: [f"law:{member}" for member in LAW]
            + [f"{station}:{member}" for station in stations_of(self.columns, link) for member in STATION]
            for link in self.wanted.sections
        }
        return tuple(link for link, names in needed.items() if all(f"section:{link}:{name}" in self.columns for name in names))

    @cached_property
    def doubtful(self) -> dict[str, int]:
        """The outputs that equilibrium may leave open, and the columns that tell where it does."""
        return {name.removeprefix("_open:"): k for k, name in enumerate(self.columns) if name.startswith("_open:")}

    def iterates(self, closure: str) -> bool:
        """Whether the loops that stand under the name of a closure are iterated."""
        return self.newton is not None and closure in self.newton.names

    @property
    def instructions(self) -> dict[str, int]:
        """Instructions of each function."""
        functions = {"motion": self.motion, "instant": self.instant} | ({"loops": self.newton.step} if self.newton else {})
        return {name: f.n_instructions() if f.is_a("SXFunction") else f.n_nodes() for name, f in functions.items()}

    def dumps(self) -> str:
        """The graph as text, without the scene that it is of."""
        newton = None
        if self.newton is not None:
            loop = self.newton
            newton = {
                "step": loop.step.serialize(),
                "guess": loop.guess,
                "turning": loop.turning,
                "names": loop.names,
                "joints": loop.joints,
            }
        kept = {name: getattr(self, name) for name in _KEPT} | {"wrapped": self.wrapped}
        return json.dumps(kept | {"motion": self.motion.serialize(), "instant": self.instant.serialize(), "newton": newton})

    @classmethod
    def loads(cls, text: str, scene: Scene, wanted: Wanted) -> SceneGraph:
        """The graph that :meth:`dumps` made a text of."""
        kept = json.loads(text)
        motion, instant = (ca.Function.deserialize(kept[name]) for name in ("motion", "instant"))
        newton = None
        if kept["newton"] is not None:
            loop = kept["newton"]
            step = ca.Function.deserialize(loop["step"])
            newton = NewtonLoop(step, tuple(loop["guess"]), tuple(loop["turning"]), tuple(loop["names"]), loop["joints"])
        rest = {name: tuple(kept[name]) for name in _KEPT}
        return cls(scene=scene, wanted=wanted, motion=motion, instant=instant, newton=newton, wrapped=kept["wrapped"], **rest)


_KEPT = ("driven", "columns")
