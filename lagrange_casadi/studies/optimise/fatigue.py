"""Fatigue as a limit of a search: the worst swings of a design, and what each is as a function of
the parameters.

By Goodman's rule a place of a link is used by a/S_e + m/S_u of its worst swing, which goes from one
instant to another. These are found by counting, as sweeps do it, at the same places. As parameters
change the two instants and the place stay; where another swing or another place becomes the worst,
the search adds it, as it adds peaks. So the derivatives are those of the swing that is the worst:
where two are as bad, there is a kink.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt

from ...base.arrays import Expression
from ...engine.fibre_stresses import LinkStress
from ...engine.program import Program
from ...errors import DeclarationError
from ...model.beams.material import Material
from ...results.statistics import counted
from ...results.strength.fatigue import cycle_squares, loaded, strengths, use_score, used
from ...results.strength.worst import LinkHistories, Maximum
from .sampled_design import KEEP, Point, SampledDesign


@dataclass(frozen=True, eq=False)
class Tired:
    """A link whose utilisation against fatigue is a term.

    Raises :class:`.DeclarationError` where its material lacks a number.
    """

    program: Program
    link: str

    def __post_init__(self) -> None:
        strengths(self.material, "goodman")

    @property
    def material(self) -> Material:
        """Material of the link."""
        return self.program.data.content.materials[self.link]

    @property
    def stress(self) -> LinkStress:
        """Stresses in the link."""
        return self.program.stress[self.link]

    @cached_property
    def rows(self) -> list[int]:
        """The columns that are members of the link's law."""
        return [self.program.outputs[member] for member in self.stress.fibres.members]

    @cached_property
    def first(self) -> dict[int, int]:
        """The number of the first fibre of each part of the link, by the part's identity."""
        parts = self.stress.fibres.parts()
        counts = itertools.accumulate((len(part.fibres) for part in parts), initial=0)
        return {id(part): count for part, count in zip(parts, counts, strict=False)}

    @property
    def fibres(self) -> int:
        """Number of fibres of all parts."""
        return sum(len(part.fibres) for part in self.stress.fibres.parts())

    def points(self, sampled: SampledDesign) -> list[Point]:
        """The worst swings of a design, one a local maximum along a fibre, the worst first: a
        point's ``xi`` is the share of the swing's other instant.

        Raises :class:`.DeclarationError` where a load travels along the link.
        """
        stress = self.stress
        members = sampled.history.columns[self.rows]
        instants = np.flatnonzero(counted(members))
        members = members[None][:, :, instants]
        if not instants.size:
            return []
        if not stress.fibres.is_still(members)[0]:
            raise DeclarationError(
                f"a load moves along link '{self.link}'; its fatigue is available in sweeps only"
            )
        histories = LinkHistories(stress.fibres, members, stress.numbers(sampled.p).full().T)
        (maxima,) = histories.maxima(use_score(self.material), KEEP)
        return [self._point(sampled, histories, maximum, instants) for maximum in maxima]

    def _point(
        self,
        sampled: SampledDesign,
        histories: LinkHistories,
        maximum: Maximum,
        instants: npt.NDArray[np.intp],
    ) -> Point:
        cycles = loaded(histories.history(maximum))
        shares = used(cycles.amplitude, cycles.mean, self.material)
        worst = int(np.argmax(shares))
        first, last = (sampled.instant(int(instants[i])) for i in cycles.instants[worst])
        return Point(
            first.share,
            last.share,
            self.first[id(maximum.part)] + maximum.fibre,
            maximum.value[0],
            first.guess,
            second=(maximum.x, *last.guess),
        )

    def stresses(self, out: Expression, p: Expression, x: Expression) -> Expression:
        """Normal stresses of all fibres, then their shear stresses along y and along z, of columns
        at an instant and at a place of each part: expressions.
        """
        numbers = self.stress.numbers(p)
        members = ca.vertcat(*(out[row] for row in self.rows))
        found: list[list[Expression]] = [[], [], []]
        for part in self.stress.fibres.parts():
            values = part.stresses(members, numbers, x)
            many = len(part.fibres)
            shears = ca.SX(2, many)
            for number, axis in enumerate(part.axes):
                for k, fibre in enumerate(part.sheared.tolist()):
                    shears[axis, fibre] = values[many + number * part.sheared.size + k]
            for rows, own in zip(
                found, (values[:many], shears[0, :].T, shears[1, :].T), strict=True
            ):
                rows.append(own)
        return ca.densify(ca.vertcat(*itertools.chain.from_iterable(found)))

    def cycle(self, at_time: ca.Function) -> ca.Function:
        """``value(share, guess, p, xi, place)``: a swing's utilisation, by stresses at a time;
        ``place`` names the fibre by a 1, and then the place in its part.
        """
        kind = ca.SX if at_time.is_a("SXFunction") else ca.MX
        nz, count = at_time.numel_in(1), self.fibres
        sizes: Sequence[int] = (1, nz, at_time.numel_in(2), 1, count + 1 + nz)
        given: list[Any] = [
            kind.sym(name, n)
            for name, n in zip(("share", "guess", "p", "xi", "place"), sizes, strict=True)
        ]
        share, guess, p, xi, place = given
        chosen, x, other = place[:count], place[count], place[count + 1 :]
        ends = [at_time(*when, p, x, 0.0) for when in ((share, guess), (xi, other))]
        a, b = (
            [ca.dot(chosen, end[k * count : (k + 1) * count]) for k in range(3)] for end in ends
        )
        amplitude, mean = (_root(square) for square in cycle_squares(a, b))
        return ca.Function(
            "swing",
            given,
            [used(amplitude, mean, self.material)],
            {"cse": True} if kind is ca.SX else {},
        )


def _root(square: Expression) -> Expression:
    """A square root, whose slope at zero is none."""
    there = square > 0.0
    return ca.if_else(there, ca.sqrt(ca.if_else(there, square, 1.0)), 0.0)
