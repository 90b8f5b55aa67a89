"""Stresses in a beam's cross-sections, of its section forces: in numbers, arrays or expressions.

s = N/A + a y + b z with a Iz + b Iyz = -Mz and a Iyz + b Iy = My, for any axes; shear stresses are
those of :mod:`..beams`. In a planar mechanism bending is about z. All are linear in section forces.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from ..base.arrays import Array, Expression, Operand
from ..base.scalars import called, column, graph
from ..base.symbolic import Graphs, symbolic
from ..base.tables import table_of
from ..model.beams.beam import Beam, Notch
from ..model.beams.properties import Properties
from ..model.beams.shape import Shape, between

_PLACES = {False: (0, 1, 5), True: (0, 1, 2, 3, 4, 5)}
"""Places of the table's section forces in :meth:`.Properties.rows`."""

KINDS = {"normal": (1.0, 0.0), "shear": (0.0, 1.0), "von_mises": (1.0, 3.0), "tresca": (1.0, 4.0)}
"""Weights of s^2 and t^2 in the square of each kind of stress."""

_SAMPLED = 65
"""Places at which the thinnest cross-section is sought where it changes."""

_Row = tuple[list[Any], list[Any]]

_DEEP = 4
"""Depth to which expressions of two fibres are compared."""


@dataclass(frozen=True, eq=False)
class Fibres(Graphs):
    """The fibres of cross-sections of one kind, by their ``names``.

    ``factors(dimensions) -> (3 fibres, forces)`` is a function of the dimensions alone: what normal
    stresses, and then shear stresses along y and along z, take of section forces; so is
    ``sizes(dimensions) -> (6,)``: area, second moments about z and y, product of inertia, elastic
    moduli about z and y. ``alone`` are the fibres but those that are like another one; ``needed``
    those of them that have not the normal stress of another one, and no shear.
    """

    names: tuple[str, ...]
    factors: Any
    sizes: Any
    alone: tuple[int, ...]
    needed: tuple[int, ...]


@functools.cache
@symbolic
def _fibres(kind: str, dimensions: tuple[str, ...], space: bool) -> Fibres:
    """The fibres of a kind of shape with some dimensions."""
    symbols = ca.SX.sym("dimensions", len(dimensions))
    shape = Shape(kind, dict(zip(dimensions, ca.vertsplit(symbols), strict=True)))
    p = shape.properties(space=space)
    every = [p.rows(fibre) for fibre in p.fibres]
    rows = [
        ca.horzcat(*(ca.SX(part[place]) for place in _PLACES[space]))
        for part in itertools.chain.from_iterable(zip(*every, strict=True))
    ]
    factors = ca.Function(
        "factors", [symbols], [ca.densify(ca.vertcat(*rows))], ["dimensions"], ["factors"]
    )
    sizes = graph(
        "sizes", {"dimensions": symbols}, sizes=column([p.area, p.iz, p.iy, p.iyz, p.wz, p.wy])
    )
    names = tuple(fibre.name for fibre in p.fibres)
    plain = [_plain(row, space) for row in every]
    alone, needed = (_differing(plain, lower=lower) for lower in (False, True))
    return Fibres(names, factors, sizes, alone, needed)


@dataclass(frozen=True, eq=False)
class CrossSections:
    """The cross-sections of a beam along a link, and the stresses at their fibres."""

    beam: Beam
    space: bool

    @property
    def forces(self) -> tuple[str, ...]:
        """The names of the section forces that stresses are made of, and are linear in."""
        return tuple(table_of(self.space).sections)

    def shape(self, cell: int, u: Expression) -> Shape:
        """The shape between two breaks, at ratios ``u``."""
        course = self.beam.course
        first, last = course.cells[cell]
        share = (u - course.breaks[cell]) / (course.breaks[cell + 1] - course.breaks[cell])
        return between(first, last, share)

    def properties(self, cell: int, u: Expression) -> Properties:
        """The properties between two breaks, at ratios ``u``."""
        return self.shape(cell, u).properties(space=self.space)

    def fibres(self, cell: int) -> Fibres:
        """The fibres between two breaks."""
        shape, _ = self.beam.course.cells[cell]
        return _fibres(shape.kind, tuple(shape.dimensions), self.space)

    def stresses(
        self, cell: int, u: Expression, fibres: Sequence[int], forces: Sequence[Expression]
    ) -> tuple[Expression, Expression, Expression]:
        """Normal stresses, and shear stresses along y and along z, at some fibres between two
        breaks, at a ratio ``u``, of section forces: as expressions, (fibres,).
        """
        known = self.fibres(cell)
        factors = known.factors(ca.vertcat(*self.shape(cell, u).dimensions.values()))
        rows = [part * len(known.names) + k for part in range(3) for k in fibres]
        found = ca.mtimes(ca.sparsify(factors[rows, :]), ca.vertcat(*forces))
        normal, along_y, along_z = ca.vertsplit(found, len(fibres))
        return normal, along_y, along_z

    def factors(self, cell: int, u: Array) -> Array:
        """Factors of stresses by section forces between two breaks, at ratios ``u`` of any shape,
        or (u, 1) of n designs whose dimensions are (n,): (3, fibres, forces, u...).
        """
        known, many = self.fibres(cell), len(self.forces)
        _, *dimensions = np.broadcast_arrays(u, *self.shape(cell, u).dimensions.values())
        shape = dimensions[0].shape
        found = called(known.factors, np.array([x.ravel() for x in dimensions]))
        found = found.reshape(many, 3, len(known.names), *shape)
        return np.ascontiguousarray(np.moveaxis(found, 0, 2))

    @property
    def thinnest(self) -> tuple[Operand, Sequence[Operand], Sequence[Operand]]:
        """The least area of the beam, second moments and elastic moduli, each where it bends along
        y and along z; second moments are principal ones where y and z are no principal axes.
        """
        every = []
        for cell, ((first, last), (low, high)) in enumerate(
            zip(self.beam.course.cells, itertools.pairwise(self.beam.course.breaks), strict=True)
        ):
            sizes = self.fibres(cell).sizes
            for u in [low] if first is last else np.linspace(low, high, _SAMPLED).tolist():
                found = sizes(ca.vertcat(*self.shape(cell, u).dimensions.values()))
                area, iz, iy, iyz, wz, wy = ca.vertsplit(found)
                if not iyz.is_zero():
                    half = (iz + iy) / 2
                    iz = iy = half - (((iz - iy) / 2) ** 2 + iyz**2) ** 0.5
                every.append(ca.vertcat(area, iz, iy, wz, wy))
        least = functools.reduce(ca.fmin, every)
        known = isinstance(least, ca.DM)
        area, *others = least.full().ravel().tolist() if known else ca.vertsplit(least)
        return area, others[:2], others[2:]


def _differing(rows: Sequence[_Row], *, lower: bool) -> tuple[int, ...]:
    """Return the numbers of the rows of fibres that equal none before; with ``lower`` also without
    those below another one.
    """
    kept = list[int]()
    for k, row in enumerate(rows):
        below = lower and any(_below(row, other) for other in rows if other is not row)
        if not below and not any(_same(row, rows[other]) for other in kept):
            kept.append(k)
    return tuple(kept)


def _plain(row: tuple[tuple[Expression, ...], ...], space: bool) -> _Row:
    """Return factors of a fibre's normal stress and shear stress: in the plane only the square of
    the latter matters.
    """
    if space:
        return [ca.SX(x) for x in row[0]], [ca.SX(x) for each in row[1:] for x in each]
    return [ca.SX(row[0][k]) for k in (0, 5)], [ca.SX(row[1][1] ** 2 + row[2][1] ** 2)]


def squared(stresses: Operand, weights: tuple[float, float]) -> Operand:
    """The square of a kind of stress by its ``weights``, of normal stress and shear stresses along
    y and along z.
    """
    (normal, *shears), (of_normal, of_shear) = stresses, weights
    return of_normal * normal**2 + of_shear * sum(shear**2 for shear in shears)


def concentration(notch: Notch | None, force: str) -> float:
    """The factor of a notch on the nominal stress of a section force; 1 where there is none."""
    if notch is None:
        return 1.0
    return (
        notch.axial
        if force == "axial"
        else notch.bending
        if force.startswith("bending")
        else notch.shear
    )


def notch_factor(notch: Notch) -> Notch:
    """Fatigue stress concentration factor of a notch: K_f = 1 + q (K_t - 1) (Shigley, eq. 6-32)."""
    q = notch.sensitivity
    return Notch(
        notch.at, *(1.0 + q * (k - 1.0) for k in (notch.axial, notch.bending, notch.shear))
    )


def _same(a: _Row, b: _Row) -> bool:
    return all(
        ca.is_equal(x, y, _DEEP) for x, y in zip([*a[0], *a[1]], [*b[0], *b[1]], strict=True)
    )


def _below(a: _Row, b: _Row) -> bool:
    """Compare two fibres: the first has the normal stress of the second, which alone has shear."""
    same = all(ca.is_equal(x, y, _DEEP) for x, y in zip(a[0], b[0], strict=True))
    return same and all(x.is_zero() for x in a[1]) and not all(x.is_zero() for x in b[1])
