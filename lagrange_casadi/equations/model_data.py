"""What is asked of a mechanism once it is compiled: its tables as plain data, and its numbers as functions of the parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from ..declare.density import Array
from ..declare.description import Description, Template
from ..declare.mechanism import Mechanism
from ..declare.motion import Laws
from ..declare.scene import Scene
from ..quantities import Kinds
from .described import template
from .gaps import extent


@dataclass(frozen=True)
class ParameterData:
    """A parameter: its default, its unit, and the range from ``low`` to ``high``."""

    default: float
    unit: str
    low: float
    high: float


@dataclass(frozen=True)
class Course:
    """A prescribed motion: the time ``span`` that it covers [s], the ``knots`` of its samples [s], and whether it has samples."""

    span: tuple[float, float]
    knots: tuple[float, ...]
    sampled: bool


@dataclass(frozen=True, eq=False)
class ModelData:
    """A mechanism and its motion as plain data, beside the functions of a :class:`.SceneGraph`.

    ``kinds`` are the kinds of its coordinates, those of guides too, of its frictions and outputs. ``closings`` are the words for
    what closes loops: "joint", "path", "bar"; any other is a constraint. ``courses`` are the motions of the driven coordinates.
    If some have samples, ``parted`` are their functions, those with samples apart from the others. ``span`` [s] and ``count`` are
    those of the scene's own instants. ``rounding`` is how far axes were corrected for loops to close, or zero. ``extent(p)`` is its
    size [m], and ``template`` its description but for the numbers.
    """

    name: str
    space: bool
    rounding: float
    parameters: Mapping[str, ParameterData]
    kinds: Kinds
    closings: Mapping[str, str]
    courses: Mapping[str, Course]
    parted: Laws | None
    span: tuple[float, float]
    count: int
    extent: Any
    template: Template

    @classmethod
    def of(cls, scene: Scene, driven: Sequence[str]) -> ModelData:
        """The data of a scene, its motions in the order in which they are ``driven``."""
        laws = {name: scene.laws[name] for name in driven}
        mechanism, symbols = scene.mechanism, scene.mechanism.symbols
        known = {name: ParameterData(p.default, p.unit, p.low, p.high) for name, p in mechanism.parameters.items()}
        return cls(
            name=mechanism.name,
            space=mechanism.space,
            rounding=scene.rounding if mechanism.rounded else 0.0,
            parameters=known,
            kinds=scene.guided.kinds,
            closings=_closings(mechanism),
            courses={name: Course(law.span, law.knots, law.spline) for name, law in laws.items()},
            parted=Laws.of(laws, symbols) if any(law.spline for law in laws.values()) else None,
            span=scene.span,
            count=scene.timing().count,
            extent=ca.Function("extent", [symbols], [ca.densify(ca.SX(extent(mechanism)))], ["p"], ["extent"], {"cse": True}),
            template=template(scene),
        )

    @cached_property
    def defaults(self) -> Array:
        """The default values of all parameters."""
        return np.array([parameter.default for parameter in self.parameters.values()])

    def values(self, p: Array) -> dict[str, float]:
        """Values of the parameters by name."""
        return dict(zip(self.parameters, map(float, p), strict=True))

    def description(self, values: Mapping[str, float]) -> Description:
        """The mechanism as plain numbers, for values of all parameters."""
        return self.template.filled(values)

    def closing(self, part: str) -> str:
        """What closes a loop, in words."""
        return f"{self.closings.get(part, 'constraint')} '{part}'"

    def words(self) -> dict[str, Any]:
        """The data for JSON; functions as the text in which CasADi writes them."""
        parted = None if self.parted is None else self.parted.words()
        return {
            "name": self.name,
            "space": self.space,
            "rounding": self.rounding,
            "parameters": {name: asdict(parameter) for name, parameter in self.parameters.items()},
            "kinds": asdict(self.kinds),
            "closings": self.closings,
            "courses": {name: asdict(course) for name, course in self.courses.items()},
            "parted": parted,
            "span": self.span,
            "count": self.count,
            "extent": self.extent.serialize(),
            "template": self.template.dumps(),
        }

    @classmethod
    def loads(cls, words: Mapping[str, Any]) -> ModelData:
        """The data that :meth:`words` made."""
        courses = {name: Course(tuple(c["span"]), tuple(c["knots"]), c["sampled"]) for name, c in words["courses"].items()}
        return cls(
            name=words["name"],
            space=words["space"],
            rounding=words["rounding"],
            parameters={name: ParameterData(**parameter) for name, parameter in words["parameters"].items()},
            kinds=Kinds(**words["kinds"]),
            closings=words["closings"],
            courses=courses,
            parted=None if words["parted"] is None else Laws.loads(words["parted"]),
            span=tuple(words["span"]),
            count=words["count"],
            extent=ca.Function.deserialize(words["extent"]),
            template=Template.loads(words["template"]),
        )


def _closings(mechanism: Mechanism) -> dict[str, str]:
    kinds = (("bar", mechanism.links), ("path", mechanism.paths), ("joint", mechanism.joints))
    return {name: kind for kind, names in kinds for name in names}
