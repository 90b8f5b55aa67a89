"""What is asked of a mechanism once it is compiled: its tables as plain data, and its numbers as functions of the parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from ..base.arrays import Array
from ..base.quantities import Kinds
from ..base.symbolic import Graphs, symbolic
from ..base.tables import table_of
from ..beams.material import Material
from ..declare.density import Density
from ..declare.description import Description, Template
from ..declare.kinds import kinds_of
from ..declare.laws import Laws
from ..declare.mechanism import Mechanism
from ..declare.scene import Scene
from .checks import Column
from .described import template
from .gaps import extent
from .section_function import Section


@dataclass(frozen=True)
class ParameterData:
    """A parameter: its default, its unit, and the range from ``low`` to ``high``."""

    default: float
    unit: str
    low: float
    high: float


@dataclass(frozen=True, eq=False)
class ModelData(Graphs):
    """A mechanism and its motion as plain data, beside the functions of a :class:`.SceneGraph`.

    ``kinds`` are the kinds of its coordinates, those of guides too, of its frictions and outputs. ``closings`` are the words for
    what closes loops: "joint", "path", "bar"; any other is a constraint. ``laws`` are the motions of the driven coordinates.
    ``span`` [s] and ``count`` are those of the scene's own instants. ``rounding`` is how far axes were corrected for loops to
    close, or zero. ``extent(p)`` is its size [m], and ``template`` its description but for the numbers.
    """

    name: str
    space: bool
    rounding: float
    parameters: Mapping[str, ParameterData]
    kinds: Kinds
    closings: Mapping[str, str]
    laws: Laws
    span: tuple[float, float]
    count: int
    extent: Any
    template: Template

    @classmethod
    def of(cls, scene: Scene, driven: Sequence[str]) -> ModelData:
        """The data of a scene, its motions in the order in which they are ``driven``."""
        mechanism, symbols = scene.mechanism, scene.mechanism.symbols
        known = {name: ParameterData(p.default, p.unit, p.low, p.high) for name, p in mechanism.parameters.items()}
        return cls(
            name=mechanism.name,
            space=mechanism.space,
            rounding=_rounding(scene),
            parameters=known,
            kinds=kinds_of(scene.guided),
            closings=_closings(mechanism),
            laws=Laws.of({name: scene.laws[name] for name in driven}, symbols),
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

    @cached_property
    def materials(self) -> dict[str, Material]:
        """What links with a beam are made of."""
        bodies = self.template.content["bodies"].items()
        return {name: Material(**body["beam"]["material"]) for name, body in bodies if "beam" in body}

    @symbolic
    def matter(self, link: str, p: Any) -> tuple[Any, Density]:
        """The length of a link [m] and its density, per unit of xi/l, as expressions of parameters ``p``."""
        body, numbers = self.template.content["bodies"][link], self.template.numbers(p)
        cells = tuple(tuple(numbers[int(place)] for place in cell) for cell in body["density"]["cells"])
        return numbers[int(body["length"])], Density(tuple(body["density"]["breaks"]), cells, per_length=False)

    def section(self, link: str, columns: Mapping[Column, Any], p: Any) -> Section:
        """The section forces of a link, of columns and parameters ``p`` that are expressions."""
        return Section(link, table_of(self.space), columns, *self.matter(link, p))

    def closing(self, part: str) -> str:
        """What closes a loop, in words."""
        return f"{self.closings.get(part, 'constraint')} '{part}'"

    def words(self) -> dict[str, Any]:
        """The data but for ``count`` and ``rounding`` for JSON; functions as the text in which CasADi writes them."""
        return {
            "name": self.name,
            "space": self.space,
            "parameters": {name: asdict(parameter) for name, parameter in self.parameters.items()},
            "kinds": asdict(self.kinds),
            "closings": self.closings,
            "laws": self.laws.words(),
            "span": self.span,
            "extent": self.extent.serialize(),
            "template": self.template.dumps(),
        }

    @classmethod
    def loads(cls, words: Mapping[str, Any], scene: Scene) -> ModelData:
        """The data that :meth:`words` made of a scene that differs from this one in ``count`` and ``rounding`` at most."""
        return cls(
            name=words["name"],
            space=words["space"],
            rounding=_rounding(scene),
            parameters={name: ParameterData(**parameter) for name, parameter in words["parameters"].items()},
            kinds=Kinds(**words["kinds"]),
            closings=words["closings"],
            laws=Laws.loads(words["laws"]),
            span=tuple(words["span"]),
            count=scene.timing().count,
            extent=ca.Function.deserialize(words["extent"]),
            template=Template.loads(words["template"]),
        )


def _rounding(scene: Scene) -> float:
    return scene.rounding if scene.mechanism.rounded else 0.0


def _closings(mechanism: Mechanism) -> dict[str, str]:
    kinds = (("bar", mechanism.links), ("path", mechanism.paths), ("joint", mechanism.joints))
    return {name: kind for kind, names in kinds for name in names}
