"""The stresses of a link's fibres at fixed places, of many designs at once: a matrix times what its
section law is made of.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt

from ..base.arrays import Array, Expression
from ..base.quantities import Output
from ..beams.beam import Notch
from ..declare.parts import Link
from ..equations.checks import Column
from ..equations.model_data import ModelData
from ..equations.section_function import Side
from ..equations.strength import Loaded
from ..equations.stress import concentration
from .fatigue import Histories, notch_factor

_NEAR = 1e-9

_EVENLY = 33
"""Ratios that are looked at: half as many as of one solution."""


@dataclass(frozen=True, eq=False)
class FibreStresses:
    """The stresses of a link's fibres as a function of what its law is made of.

    ``rows(members, p)`` is their matrix: the normal stresses of all places and fibres, then the
    shear stresses of those that are ``sheared``, along one of ``axes`` after the other (0 is y, 1
    is z), for in a plane there are none along z; ``still`` are the members that it depends on.
    """

    members: tuple[Output, ...]
    still: npt.NDArray[np.intp]
    rows: Any
    sheared: npt.NDArray[np.intp]
    axes: tuple[int, ...]

    @classmethod
    def of(cls, data: ModelData, name: str, members: Sequence[Output]) -> FibreStresses:
        """Make it for a link whose law is made of ``members``."""
        symbols = ca.SX.sym("members", len(members))
        columns: dict[Column, Any] = dict(zip(members, ca.vertsplit(symbols), strict=True))
        p = data.symbols
        link = data.link(name, p)
        body = Loaded(data.space, link, columns)
        normal, shears = list[Any](), list[tuple[Any, ...]]()
        for cell, u, side, notch in _places(body, link):
            forces = [
                body.force_at(force, u, side) * concentration(notch, force)
                for force in body.cross.forces
            ]
            stresses = body.cross.stresses(cell, u, body.cross.fibres(cell).alone, forces)
            own, *across = (ca.vertsplit(one) for one in stresses)
            normal += own
            shears += zip(*across, strict=True)
        sheared = [
            k for k, pair in enumerate(shears) if not (pair[0].is_zero() and pair[1].is_zero())
        ]
        axes = tuple(axis for axis in (0, 1) if not all(shears[k][axis].is_zero() for k in sheared))
        every = ca.vertcat(*normal, *(shears[k][axis] for axis in axes for k in sheared))
        # Stresses are linear in forces, not in where these act.
        acting = [k for k, member in enumerate(members) if not _is_place(member)]
        slopes = ca.SX(every.numel(), len(members))
        slopes[:, acting] = ca.jacobian(every, symbols[acting])
        still = [k for k in range(len(members)) if ca.depends_on(slopes, symbols[k])]
        # Rows of the matrix one after another, as numbers lie in memory.
        found = ca.Function("rows", [symbols, p], [ca.vec(ca.densify(slopes.T))], {"cse": True})
        return cls(
            tuple(members), np.array(still, np.intp), found, np.array(sheared, np.intp), axes
        )

    def stands(self, members: Array) -> npt.NDArray[np.bool_]:
        """Return the designs, whose members are (n, members, t), for which the matrix is the same
        at all instants.
        """
        return np.asarray((np.ptp(members[:, self.still], axis=2) <= _NEAR).all(axis=1))

    def histories(self, members: Array, p: Array) -> Histories:
        """The stresses of designs whose members are (n, members, t)."""
        n, k, t = members.shape
        matrix = self._matrices(members[:, :, 0], p).reshape(n, -1, k)
        found = np.matmul(matrix, np.ascontiguousarray(members))
        first = found.shape[1] - len(self.axes) * self.sheared.size
        shears = found[:, first:].reshape(n, len(self.axes), self.sheared.size, t)
        return Histories(found[:, :first], shears, self.sheared, self.axes)

    @property
    def places(self) -> int:
        """Number of places and fibres."""
        return int(self.rows.numel_out(0) // len(self.members) - len(self.axes) * self.sheared.size)

    def _matrices(self, members: Array, p: Array) -> Array:
        """The numbers of ``rows`` for designs (n, ...), through memory that CasADi itself reads and
        writes: by far the fastest.
        """
        buffer, evaluate = self.rows.buffer()
        given, found = (
            [np.zeros(members.shape[1]), np.zeros(p.shape[1])],
            np.empty((len(p), self.rows.nnz_out(0))),
        )
        row = np.empty(found.shape[1])
        for number, values in enumerate(given):
            buffer.set_arg(number, values.data)
        buffer.set_res(0, row.data)
        for i in range(len(p)):
            given[0][:], given[1][:] = members[i], p[i]
            evaluate()
            found[i] = row
        return found


def _is_place(member: Output) -> bool:
    """Return whether a member is the place of a load on a link, not its size."""
    return member.member == "station" or (member.group == "spread" and member.power is None)


def _places(body: Loaded, link: Link) -> Iterator[tuple[int, Expression, Side, Notch | None]]:
    """Cells of the cross-section, ratios and the sides of them that are meant, and notches: those
    of :mod:`..strength.fatigue`.
    """
    breaks = body.course.breaks

    def cell_of(u: float, side: Side) -> int:
        inside = [k for k, (a, b) in enumerate(itertools.pairwise(breaks)) if a <= u <= b]
        return inside[-1] if side == "tip" else inside[0]

    sides: tuple[Side, ...] = ("base", "tip")
    for u in np.linspace(0.0, 1.0, _EVENLY).tolist():
        yield cell_of(u, "tip"), u, "tip", None
    for u, side in itertools.product(breaks, sides):
        yield cell_of(u, side), u, side, None
    for mark, side, cell in itertools.product(body.marks, sides, range(len(breaks) - 1)):
        u = ca.fmin(ca.fmax(ca.SX(mark), breaks[cell]), breaks[cell + 1])
        yield cell, u, side, None
    for notch, side in itertools.product(link.beam.notches if link.beam else (), sides):
        yield cell_of(notch.at, side), notch.at, side, notch_factor(notch)
