"""What is asked of a mechanism once it is compiled: its tables as plain data, and its numbers as functions of the parameters."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from ..base.arrays import Array
from ..base.quantities import Kinds
from ..base.symbolic import Graphs, symbolic
from ..base.tables import table_of
from ..base.vocabulary import PRECISIONS, Precision
from ..beams.beam import beam_of
from ..beams.material import Material
from ..declare.corners import Corners
from ..declare.declared import Declared, EquationGraph, equations_of
from ..declare.density import Density
from ..declare.description import Description, Template, template_of
from ..declare.kinds import kinds_of
from ..declare.laws import Laws
from ..declare.masses import ALL, masses_of
from ..declare.mechanism import Mechanism
from ..declare.parts import LineLoad, Link, Parameter
from ..declare.possible import Margins
from ..declare.scene import Scene
from ..declare.times import Timing
from ..errors import UnknownNameError
from .checks import Column
from .gaps import extent
from .section_function import Section
from .tree import span


@dataclass(frozen=True, eq=False)
class ModelData(Graphs):
    """A mechanism and its motion as plain data, beside the functions of a :class:`.Program`.

    ``kinds`` are the kinds of its coordinates, those of guides too, of its frictions and outputs. ``closings`` are the words for
    what closes loops: "joint", "path", "bar"; any other is a constraint. ``laws`` are the motions of the driven coordinates.
    ``timing`` is how the scene's own instants are asked for, and ``span`` [s] their first and last. ``rounding`` is how far axes
    were corrected for loops to close, or zero.

    ``extent(p)`` is its size [m], and ``masses(p)`` are those of its bodies, and last of all together [kg]. ``margins`` are what a
    precision demands of the parameters; motions and constraints may have kinks at ``corners``. The loads ``partial`` act along a
    part of their link; ``jumps`` are the ratios at which the mass along a link jumps. ``equations`` are the constraints and rows as
    they were declared, for certificates, and ``template`` is the description but for the numbers.
    """

    name: str
    space: bool
    rounding: float
    parameters: Mapping[str, Parameter]
    kinds: Kinds
    closings: Mapping[str, str]
    laws: Laws
    timing: Timing
    span: tuple[float, float]
    extent: Any
    margins: Mapping[Precision, Margins]
    corners: Corners
    masses: Any
    partial: tuple[str, ...]
    jumps: Mapping[str, tuple[float, ...]]
    equations: tuple[EquationGraph, ...]
    template: Template

    @classmethod
    def of(cls, scene: Scene, laws: Laws) -> ModelData:
        """Return the data of a scene whose motions are ``laws``."""
        mechanism, symbols = scene.mechanism, scene.mechanism.symbols
        return cls(
            name=mechanism.name,
            space=mechanism.space,
            rounding=_rounding(scene),
            parameters=mechanism.parameters,
            kinds=kinds_of(scene.guided),
            closings=_closings(mechanism),
            laws=laws,
            timing=scene.timing(),
            span=scene.span,
            extent=ca.Function("extent", [symbols], [ca.densify(ca.SX(extent(mechanism)))], ["p"], ["extent"], {"cse": True}),
            margins={precision: scene.demands(precision).margins() for precision in PRECISIONS},
            corners=Corners.of(scene),
            masses=ca.Function("masses", [symbols], [masses_of(mechanism)], ["p"], ["masses"], {"cse": True}),
            partial=tuple(name for name, load in mechanism.loads.items() if isinstance(load, LineLoad) and not load.whole),
            jumps={name: _jumps(link.mass) for name, link in mechanism.links.items() if isinstance(link.mass, Density)},
            equations=equations_of(mechanism),
            template=template(scene),
        )

    def asked_by(self, scene: Scene) -> ModelData:
        """The same, with how a scene of the same name asks for instants and lets axes be rounded."""
        return replace(self, timing=scene.timing(), rounding=_rounding(scene))

    @cached_property
    def defaults(self) -> Array:
        """The default values of all parameters."""
        return np.array([parameter.default for parameter in self.parameters.values()])

    def values(self, p: Sequence[float] | Array) -> dict[str, float]:
        """Name the values of all parameters."""
        return dict(zip(self.parameters, map(float, p), strict=True))

    def at(self, p: Sequence[float] | Array) -> Description:
        """Describe the mechanism in plain numbers, for parameters ``p``."""
        return self.template.filled(self.values(p))

    def declared(self, p: Sequence[float] | Array) -> Declared:
        """Return what certificates read of the mechanism, for parameters ``p``: nothing of it is derived."""
        known = tuple(map(float, p))
        return Declared.of(self.at(known), tuple(equation.at(known) for equation in self.equations))

    @property
    @symbolic
    def symbols(self) -> Any:
        """The parameters' symbols, in a column."""
        return ca.vertcat(ca.SX(0, 1), *(parameter.symbol for parameter in self.parameters.values()))

    @symbolic
    def mass(self, part: str, p: Any) -> Any:
        """Express the mass of a body, or of ``all`` of them [kg]. Raises :class:`.UnknownNameError` for anything else."""
        parts = [*self.template.content["bodies"], ALL]
        if part not in parts:
            raise UnknownNameError("part with a mass", part, parts)
        return self.masses(p)[parts.index(part)]

    @cached_property
    def materials(self) -> dict[str, Material]:
        """What links with a beam are made of."""
        bodies = self.template.content["bodies"].items()
        return {name: Material(**body["beam"]["material"]) for name, body in bodies if "beam" in body}

    @symbolic
    def matter(self, link: str, p: Any) -> tuple[Any, Density]:
        """The length of a link [m] and its density, per unit of xi/l, as expressions of parameters ``p``."""
        body = self.template.placed(self.template.content["bodies"][link], p)
        cells = tuple(map(tuple, body["density"]["cells"]))
        return body["length"], Density(tuple(body["density"]["breaks"]), cells, per_length=False)

    @symbolic
    def link(self, name: str, p: Any) -> Link:
        """A link that has sections and a beam, its numbers as expressions of parameters ``p``."""
        body = self.template.placed(self.template.content["bodies"][name], p)
        return Link(name, *self.matter(name, p), beam_of(body["beam"]))

    def section(self, link: str, columns: Mapping[Column, Any], p: Any) -> Section:
        """The section forces of a link, of columns and parameters ``p`` that are expressions."""
        return Section(link, table_of(self.space), columns, *self.matter(link, p))

    def closing(self, part: str) -> str:
        """What closes a loop, in words."""
        return f"{self.closings.get(part, 'constraint')} '{part}'"

    def words(self) -> dict[str, Any]:
        """The data for JSON; functions as the text in which CasADi writes them."""
        return {name: write(getattr(self, name)) for name, (write, _) in _WRITTEN.items()}

    @classmethod
    def loads(cls, words: Mapping[str, Any]) -> ModelData:
        """Read the data that :meth:`words` made."""
        return cls(**{name: read(words[name]) for name, (_, read) in _WRITTEN.items()})


def _as_it_is(value: Any) -> Any:
    return value


def _parameters(words: Mapping[str, Any]) -> dict[str, Parameter]:
    known = words.items()
    return {name: Parameter(name, default, unit, low, high, ca.SX.sym(name)) for name, (default, unit, low, high) in known}


_FUNCTION = ca.Function.serialize, ca.Function.deserialize
_WRITTEN: Mapping[str, tuple[Callable[[Any], Any], Callable[[Any], Any]]] = {
    **dict.fromkeys(("name", "space", "rounding", "closings"), (_as_it_is, _as_it_is)),
    **dict.fromkeys(("span", "partial"), (_as_it_is, tuple)),
    **dict.fromkeys(("extent", "masses"), _FUNCTION),
    "parameters": (lambda own: {name: [p.default, p.unit, p.low, p.high] for name, p in own.items()}, _parameters),
    "kinds": (asdict, lambda words: Kinds(**words)),
    "laws": (Laws.words, Laws.loads),
    "timing": (asdict, lambda words: Timing(**words)),
    "margins": (
        lambda own: {precision: margins.words() for precision, margins in own.items()},
        lambda words: {precision: Margins.loads(margins) for precision, margins in words.items()},
    ),
    "corners": (Corners.words, Corners.loads),
    "jumps": (_as_it_is, lambda words: {name: tuple(jumps) for name, jumps in words.items()}),
    "equations": (
        lambda own: [equation.words() for equation in own],
        lambda words: tuple(EquationGraph.loads(equation) for equation in words),
    ),
    "template": (Template.dumps, Template.loads),
}
"""How each field is written for JSON, and read."""


def _rounding(scene: Scene) -> float:
    return scene.rounding if scene.mechanism.rounded else 0.0


def _jumps(density: Density) -> tuple[float, ...]:
    return tuple(sorted({*density.jumps, *(density.slices.breaks[1:-1] if density.slices else ())}))


def _closings(mechanism: Mechanism) -> dict[str, str]:
    kinds = (("bar", mechanism.links), ("path", mechanism.paths), ("joint", mechanism.joints))
    return {name: kind for kind, names in kinds for name in names}


@symbolic
def described(scene: Scene, values: Mapping[str, float]) -> Description:
    """The description of a scene's mechanism, for values of its parameters; see :func:`template`."""
    return template(scene).filled(values)


@symbolic
@functools.lru_cache(maxsize=32)
def template(scene: Scene) -> Template:
    """The description of a scene's mechanism but for its numbers.

    In space it names the ``bars``, links whose spin about their own axis is idle and taken to be none, and the coordinates that are
    ``unmeasured``.
    """
    mechanism = scene.mechanism
    found = template_of(mechanism, tuple(scene.laws), None if scene.weights is None else tuple(scene.weights))
    if not mechanism.space:
        return found
    tree = span(scene.guided, scene.laws)
    unmeasured = [name for name, (joint, axis) in mechanism.coordinates.items() if not tree.measures(joint, axis)]
    return replace(found, content=found.content | {"bars": [bar.link.name for bar in tree.bars], "unmeasured": unmeasured})
