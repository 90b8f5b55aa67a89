"""Stresses at the fibres of a link, as functions of what its section law is made of and of the
link's numbers.

A link is known by its :class:`LinkForm`, in which no number is that a parameter or a profile may
change. So one function serves a :class:`.Program` at all parameters, a solution that was read from
a file, and every profile that is tried.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt

from ..base.arrays import Array, Expression
from ..base.interpret import interpret, numpy_arithmetic
from ..base.quantities import Column, Output
from ..base.scalars import column
from ..base.symbolic import Graphs, symbolic
from ..base.tables import table_of
from ..model.beams.beam import Beam, Notch
from ..model.beams.material import Material
from ..model.beams.shape import Course, Shape
from ..model.density import Density, NumericDensity
from ..model.limits import END
from ..model.parts import Link
from .section_function import SIDES, SectionInputs, Side, edge
from .strength import Loaded, Part
from .stress import concentration, notch_factor

_NEAR = 1e-9
"""Change of a place of a load, as a ratio xi/l, up to which it stands still."""

_SLACK = END["single"]


@dataclass(frozen=True)
class LinkForm:
    """A link with a beam, but for its numbers: how its density and its cross-section are divided,
    the kinds of shapes, notches, and what its section law is made of.

    ``cells`` are the numbers of the shapes at both ends of each part of the cross-section.
    """

    inputs: SectionInputs
    density: tuple[tuple[float, ...], tuple[int, ...]]
    breaks: tuple[float, ...]
    shapes: tuple[tuple[str, tuple[str, ...]], ...]
    cells: tuple[tuple[int, int], ...]
    notches: tuple[Notch, ...]

    @classmethod
    def of(cls, inputs: SectionInputs, density: Density | NumericDensity, beam: Beam) -> LinkForm:
        """Return the form of a link."""
        course = beam.course
        return cls(
            inputs.alike(),
            (tuple(density.breaks), tuple(map(len, density.cells))),
            course.breaks,
            tuple((shape.kind, tuple(shape.dimensions)) for shape in course.shapes),
            course.ends,
            tuple(beam.notches),
        )

    @property
    def link(self) -> tuple[Link, ca.SX]:
        """A link of this form, and its numbers as symbols."""
        breaks, sizes = self.density
        length = ca.SX.sym("length")
        cells = tuple(tuple(ca.vertsplit(ca.SX.sym("density", size))) for size in sizes)
        shapes = (
            Shape(kind, {name: ca.SX.sym(name) for name in names}) for kind, names in self.shapes
        )
        course = Course(self.breaks, tuple(shapes), self.cells)
        density = Density(breaks, cells, per_length=False)
        beam = Beam(course, Material("", 1.0), self.notches)
        numbers = column(numbers_of(length, density, beam))
        return Link("", length, density, beam), numbers


def numbers_of(
    length: Expression, density: Density | NumericDensity, beam: Beam
) -> list[Expression]:
    """Return the numbers of a link in the order in which :class:`FibreStresses` takes them: its
    length, its density per unit of the ratio, and dimensions.
    """
    return [
        length,
        *itertools.chain.from_iterable(density.cells),
        *(x for shape in beam.course.shapes for x in shape.dimensions.values()),
    ]


@dataclass(frozen=True, eq=False)
class FibrePart(Graphs):
    """The fibres of a part of a link, at a place x from 0 to 1 of it, or of a side of a ``notch``.

    ``rows(members, numbers, x)`` is what makes stresses of the members of the section law: first
    the normal stresses of the ``fibres``, then the shear stresses of those that are ``sheared``,
    along one of ``axes`` after the other (0 is y, 1 is z), for in a plane there are none along z.
    ``stresses`` of the same is their product with the members, and ``span`` where the part begins,
    and how wide it is.
    """

    fibres: tuple[str, ...]
    sheared: npt.NDArray[np.intp]
    axes: tuple[int, ...]
    degree: int
    rows: Any
    stresses: ca.Function
    span: ca.Function
    notch: Notch | None

    @cached_property
    def plain(self) -> npt.NDArray[np.intp]:
        """The fibres that have normal stress alone."""
        return np.setdiff1d(np.arange(len(self.fibres)), self.sheared)

    @property
    def count(self) -> int:
        """Number of stresses at a place."""
        return len(self.fibres) + len(self.axes) * self.sheared.size

    def at(
        self,
        members: Array,
        numbers: Array,
        x: Array,
        *,
        still: bool = True,
        chosen: npt.NDArray[np.intp] | None = None,
    ) -> Array:
        """The stresses (n, places, stresses, t) of n designs, whose members are (n, members, t) and
        numbers (n, numbers), at places ``x`` (n, places): all, or those ``chosen`` (n, some).

        Where loads do not stand ``still``, each instant has its own rows.
        """
        n, k, t = members.shape
        if still:
            places = x.shape[1]
            rows = self._matrices(members[:, :, 0], numbers, x).reshape(n, places, self.count, k)
            if chosen is not None:
                rows = np.take_along_axis(rows, chosen[:, None, :, None], axis=2)
            count = rows.shape[2]
            flat = rows.reshape(n, places * count, k)
            stresses = np.asarray(np.matmul(flat, np.ascontiguousarray(members)))
            return stresses.reshape(n, places, count, t)
        found = np.empty((n, self.count, x.shape[1], t))
        for i in range(n):
            given = [[*members[i]], [*numbers[i]], [x[i][:, None]]]
            (values,) = interpret(self.stresses, given, numpy_arithmetic())
            for row, value in zip(found[i], values, strict=True):
                row[:] = value
        every = np.moveaxis(found, 1, 2)
        if chosen is not None:
            every = np.take_along_axis(every, chosen[:, None, :, None], axis=2)
        return np.asarray(every)

    def stresses_of(self, fibres: npt.NDArray[np.intp]) -> npt.NDArray[np.intp]:
        """The numbers of the stresses of fibres (n,), which are all sheared, or all not: (n,
        stresses).
        """
        first, column = len(self.fibres), np.searchsorted(self.sheared, fibres)
        sheared = self.sheared.size and fibres[0] in self.sheared
        axes = range(len(self.axes)) if sheared else ()
        rows = [fibres, *(first + k * self.sheared.size + column for k in axes)]
        return np.stack(rows, axis=1)

    def ends(self, members: Array, numbers: Array) -> tuple[Array, Array]:
        """Return the beginning and the width of the part for designs: each (n,)."""
        low, width = self.span(members[:, :, 0].T, numbers.T).full()
        return low, width

    def _matrices(self, members: Array, numbers: Array, x: Array) -> Array:
        """The numbers of ``rows`` for designs and places (n, places, ...), through memory that
        CasADi itself reads and writes: by far the fastest.
        """
        buffer, evaluate = self.rows.buffer()
        size = self.rows.nnz_out(0)
        given = [np.zeros(members.shape[1]), np.zeros(numbers.shape[1]), np.zeros(1)]
        found, row = np.empty((*x.shape, size)), np.empty(size)
        for number, values in enumerate(given):
            buffer.set_arg(number, values.data)
        buffer.set_res(0, row.data)
        for i in range(len(x)):
            given[0][:], given[1][:] = members[i], numbers[i]
            for j, place in enumerate(x[i].tolist()):
                given[2][0] = place
                evaluate()
                found[i, j] = row
        return found


@dataclass(frozen=True, eq=False)
class FibreStresses:
    """The stresses of a link's fibres: ``inputs`` are the members of its section law, in the order
    in which functions take them.
    """

    form: LinkForm
    inputs: SectionInputs

    @classmethod
    def of(
        cls, outputs: Iterable[Output], link: str, density: Density | NumericDensity, beam: Beam
    ) -> FibreStresses:
        """Make them for a link, whose section law is among some outputs."""
        inputs = SectionInputs.of([*outputs], link)
        return cls(LinkForm.of(inputs, density, beam), inputs)

    @property
    def members(self) -> tuple[Output, ...]:
        """The members of the section law."""
        return (*self.inputs.law, *self.inputs.acting)

    @cached_property
    def places(self) -> list[int]:
        """Return the members that say where something acts, not how much."""
        return [k for k, member in enumerate(self.members) if _is_place(member)]

    def is_still(self, members: Array) -> npt.NDArray[np.bool_]:
        """Return the designs, whose members are (n, members, t), of which all loads stand still."""
        return np.asarray((np.ptp(members[:, self.places], axis=2) <= _NEAR).all(axis=1))

    def parts(self, *, still: bool = True) -> tuple[FibrePart, ...]:
        """The parts of the link, between load points that stand ``still`` and steps of its
        cross-section; then both sides of notches.
        """
        return _parts(self.form, still)


@dataclass(frozen=True, eq=False)
class LinkStress(Graphs):
    """The stresses in a link of a :class:`.Program`: functions at its ``fibres``, of its section
    law and its numbers, and these ``numbers(p)`` of the parameters.
    """

    fibres: FibreStresses
    numbers: ca.Function

    @classmethod
    def of(cls, outputs: Iterable[Output], link: Link, p: ca.SX) -> LinkStress:
        """Make them for a link, whose section law is among some outputs, and whose numbers are
        expressions of parameters ``p``.
        """
        assert isinstance(link.mass, Density)
        assert link.beam is not None
        numbers = ca.densify(ca.vertcat(*numbers_of(link.length, link.mass, link.beam)))
        fibres = FibreStresses.of(outputs, link.name, link.mass, link.beam)
        return cls(fibres, ca.Function("numbers", [p], [numbers]))


def _is_place(member: Output) -> bool:
    return member.member == "station" or (member.group == "spread" and member.power is None)


@functools.lru_cache(maxsize=64)
@symbolic
def _parts(form: LinkForm, still: bool) -> tuple[FibrePart, ...]:
    link, numbers = form.link
    outputs = (*form.inputs.law, *form.inputs.acting)
    members, x = ca.SX.sym("members", len(outputs)), ca.SX.sym("x")
    columns: Mapping[Column, Any] = dict(zip(outputs, ca.vertsplit(members), strict=True))
    body = Loaded(form.inputs.table is table_of(True), link, columns)
    # Stresses are linear in forces, not in where these act.
    sizes = [k for k, output in enumerate(outputs) if not _is_place(output)]
    spans = body.spans if still else body.cells
    found = []
    for part, u, beyond, notch in _places(body, spans, x, still=still):
        fibres = body.cross.fibres(part.cell)
        forces = [
            body.section.force(name, u, beyond) * concentration(notch, name)
            for name in body.cross.forces
        ]
        normal, *shears = body.cross.stresses(part.cell, u, fibres.alone, forces)
        sheared = [
            k for k in range(len(fibres.alone)) if not all(shear[k].is_zero() for shear in shears)
        ]
        axes = tuple(
            axis
            for axis, shear in enumerate(shears)
            if not all(shear[k].is_zero() for k in sheared)
        )
        every = ca.densify(ca.vertcat(normal, *(shears[axis][sheared] for axis in axes)))
        slopes = ca.SX(every.numel(), len(outputs))
        slopes[:, sizes] = ca.jacobian(every, members[sizes])
        given, options = [members, numbers, x], {"cse": True}
        found.append(
            FibrePart(
                tuple(fibres.names[k] for k in fibres.alone),
                np.array(sheared, np.intp),
                axes,
                0 if notch else body.degree_along(part),
                # One row after another, as numbers lie in memory.
                ca.Function("rows", given, [ca.vec(ca.densify(slopes.T))], options),
                ca.Function("stresses", given, [every], options),
                ca.Function(
                    "span", given[:2], [ca.densify(ca.vertcat(part.low, part.width))], options
                ),
                notch,
            )
        )
    return tuple(found)


def _places(
    body: Loaded, spans: Sequence[Part], x: ca.SX, *, still: bool
) -> Iterator[tuple[Part, Any, Any, Notch | None]]:
    """Parts, ratios in them, beyond which ratio loads are carried there, and notches with the
    factors that count in fatigue.
    """
    for part in spans:
        u = part.low + part.width * x
        yield part, u, edge(part.low if still else u, _SLACK), None
    assert body.link.beam is not None
    sides: tuple[Side, ...] = SIDES
    for notch, side in itertools.product(body.link.beam.notches, sides):
        u = ca.SX(notch.at)
        inside = [part for part in body.cells if float(part.low) <= notch.at]
        touching = [part for part in inside if notch.at <= float(part.low) + float(part.width)]
        cell = touching[-1 if side == "tip" else 0].cell
        yield Part(u, ca.SX(0.0), cell), u, edge(u, _SLACK, side), notch_factor(notch)
