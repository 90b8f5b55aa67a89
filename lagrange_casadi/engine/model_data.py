"""Data of a compiled mechanism: its tables as plain data, and its numbers as functions of the
parameters.
"""

from __future__ import annotations

import functools
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import get_args

import casadi as ca
import numpy as np

from ..base.arrays import Array, Expression
from ..base.brief import Brief
from ..base.quantities import Column, Kinds
from ..base.scalars import column, graph
from ..base.symbolic import Graphs, symbolic
from ..base.tables import table_of
from ..base.templates import Template
from ..base.vocabulary import Precision
from ..errors import check_known
from ..model.beams.beam import Beam
from ..model.corners import Corners
from ..model.declared_parts import Link, Parameter
from ..model.description import Description
from ..model.link_density import Density
from ..model.loads import LineLoad
from ..model.mass_properties import ALL
from ..model.mechanism import Mechanism
from ..model.sampled_laws import Laws
from ..model.scene import Scene
from ..model.stated import Stated
from ..model.times import Timing
from ..model.validity import Margins
from .section_function import Section
from .sizes import extent
from .tree import Tree, span


@symbolic
def beam_at(described: Template[Description], link: str, p: Expression) -> Beam:
    """Return the beam of a link, its numbers as expressions of parameters ``p``, or as numbers
    where these are numbers.
    """
    return described.placed(described.content.beams[link], p)


@symbolic
@functools.lru_cache(maxsize=32)
def template(scene: Scene) -> Template[Description]:
    """The description of a scene's mechanism but for its numbers.

    In space it names the ``two_force_links``, links whose spin about their own axis is idle and
    taken to be none, and the coordinates that are ``unmeasured``.
    """
    tree = span(scene.guided, scene.laws)
    return described(scene.mechanism, tree, scene.laws, scene.weights)


def described(
    mechanism: Mechanism, tree: Tree, driven: Collection[str], drives: Collection[str] | None
) -> Template[Description]:
    """The description of a mechanism with some tree, as of :func:`template`."""
    content = Description.of(mechanism, driven, drives)
    if mechanism.space:
        content = replace(
            content,
            bars=tuple(one.link.name for one in tree.two_force_links),
            unmeasured=tuple(
                name
                for name, (joint, axis) in mechanism.coordinates.items()
                if not tree.measures(joint, axis)
            ),
        )
    return Template.of(content, mechanism.symbols)


@dataclass(frozen=True, eq=False, repr=False)
class ModelData(Graphs, Brief):
    """A mechanism and its motion as plain data, beside the functions of a :class:`.Program`.

    ``laws`` are the motions of the driven coordinates. ``timing`` is how the scene's own instants
    are asked for, and ``span`` [s] their first and last. ``rounding`` is how far axes and
    places may be off where loops do not close as declared, else zero.

    ``extent(p)`` is its size [m]. ``margins`` are what a precision demands of the parameters;
    motions and constraints may have kinks at ``corners``. The loads ``partial`` act along a part of
    their link; ``jumps`` are the ratios at which the mass along a link jumps. ``stated`` are the
    constraints, rows, motions and laws of loads as they were declared, for certificates
    (:class:`.Stated`), and ``template`` is the description but for the numbers.
    """

    rounding: float
    parameters: Mapping[str, Parameter]
    laws: Laws
    timing: Timing
    span: tuple[float, float]
    extent: ca.Function
    margins: Mapping[Precision, Margins]
    corners: Corners
    partial: tuple[str, ...]
    jumps: Mapping[str, tuple[float, ...]]
    stated: Template[Stated]
    template: Template[Description]

    @classmethod
    def of(cls, scene: Scene, laws: Laws) -> ModelData:
        """Return the data of a scene whose motions are ``laws``."""
        mechanism, given = scene.mechanism, {"p": scene.mechanism.symbols}
        return cls(
            rounding=mechanism.rounding,
            parameters=mechanism.parameters,
            laws=laws,
            timing=scene.timing(),
            span=scene.span,
            extent=graph("extent", given, extent=extent(mechanism)),
            margins={
                precision: scene.parameter_constraints(precision).margins()
                for precision in get_args(Precision)
            },
            corners=Corners.of(scene),
            partial=tuple(
                name
                for name, load in mechanism.loads.items()
                if isinstance(load, LineLoad) and not load.whole
            ),
            jumps={
                name: _jumps(link.mass)
                for name, link in mechanism.links.items()
                if isinstance(link.mass, Density)
            },
            stated=Stated.of(mechanism, scene.laws),
            template=template(scene),
        )

    @property
    def content(self) -> Description:
        """The description, with a :class:`.Leaf` for each number that parameters change."""
        return self.template.content

    @property
    def name(self) -> str:
        """The mechanism's name."""
        return self.content.name

    @property
    def space(self) -> bool:
        """True if it lies in space."""
        return self.content.space

    @cached_property
    def kinds(self) -> Kinds:
        """The kinds of coordinates, those of guides too, and of frictions, and the units of the
        user's outputs.
        """
        return self.content.kinds

    @cached_property
    def defaults(self) -> Array:
        """The default values of all parameters."""
        return np.array([parameter.default for parameter in self.parameters.values()])

    def values(self, p: Sequence[float] | Array) -> dict[str, float]:
        """Name the values of all parameters."""
        return dict(zip(self.parameters, map(float, p), strict=True))

    def at(self, p: Sequence[float] | Array) -> Description:
        """Describe the mechanism in plain numbers, for parameters ``p``."""
        return self.template.at(p)

    @property
    @symbolic
    def symbols(self) -> ca.SX:
        """The parameters' symbols, in a column."""
        return column(parameter.symbol for parameter in self.parameters.values())

    @symbolic
    def mass(self, part: str, p: ca.SX) -> ca.SX:
        """Express the mass of a body, or of ``all`` of them [kg].

        Raises :class:`.UnknownNameError` for anything else.
        """
        bodies = self.content.bodies
        check_known("part with a mass", [part], (*bodies, ALL))
        some = bodies.values() if part == ALL else [bodies[part]]
        return ca.SX(sum(self.template.placed([body.mass for body in some], p)))

    @symbolic
    def mass_properties(self, link: str, p: ca.SX) -> tuple[ca.SX, Density]:
        """The length of a link [m] and its density, per unit of xi/l, as expressions of parameters
        ``p``.
        """
        length, density = self.template.placed(self.content.bodies[link].length_and_density, p)
        return ca.SX(length), Density(density.breaks, density.cells, per_length=False)

    @symbolic
    def link(self, name: str, p: Expression) -> Link:
        """A link that has sections and a beam, its numbers as expressions of parameters ``p``."""
        return Link(name, *self.mass_properties(name, p), beam_at(self.template, name, p))

    def section(self, link: str, columns: Mapping[Column, Expression], p: Expression) -> Section:
        """The section forces of a link, of columns and parameters ``p`` that are expressions."""
        return Section(link, table_of(self.space), columns, *self.mass_properties(link, p))

    def closing(self, part: str) -> str:
        """Describe the part that closes a loop."""
        content = self.content
        kinds: Sequence[tuple[str, Collection[str]]] = (
            ("joint", content.joints),
            ("path", content.paths),
            ("two-force link", content.bodies),
        )
        return f"{next((kind for kind, parts in kinds if part in parts), 'constraint')} '{part}'"


def _jumps(density: Density) -> tuple[float, ...]:
    return tuple(sorted({*density.jumps, *(density.slices.breaks[1:-1] if density.slices else ())}))
