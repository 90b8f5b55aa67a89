"""Fatigue as a limit of a search: the worst swings of a design, and what each is as a function of
the parameters.

By Goodman's rule a place of a link is used by a/S_e + m/S_u of its worst swing, which goes from one
instant to another. These are found by counting, as sweeps do it, at the same places. As parameters
change the two instants stay; where another swing or another place becomes the worst, the search
adds it, as it adds peaks. So the derivatives are those of the swing that is the worst: where two
are as bad, there is a kink.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from ...base.arrays import Expression
from ...base.quantities import Output
from ...beams.material import Material
from ...equations.program import Program
from ...errors import DeclarationError
from ...instants.statistics import counted
from ...strength.fatigue import cycle_squares, loaded, strengths, used
from ...strength.fibres import FibreStresses
from .sampled_design import Point, SampledDesign

_FEW = 8
"""Places of a link whose worst swings are told at least."""


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
        return self.program.data.materials[self.link]

    @cached_property
    def fatigue(self) -> FibreStresses:
        """Stresses of the link by the members of its law."""
        members = [
            output for output in self.program.outputs if output.along and output.part == self.link
        ]
        return FibreStresses.of(self.program.data, self.link, members)

    def points(self, sampled: SampledDesign) -> list[Point]:
        """The worst swings of a design, one a place, the worst first: a point's ``xi`` is the share
        of the swing's other instant.

        Raises :class:`.DeclarationError` where a load travels along the link.
        """
        fatigue = self.fatigue
        members = sampled.history.columns[
            [self.program.outputs[member] for member in fatigue.members]
        ]
        instants = np.flatnonzero(counted(members))
        members = members[:, instants]
        if not instants.size:
            return []
        if not fatigue.stands(members[None])[0]:
            raise DeclarationError(
                f"a load moves along link '{self.link}'; its fatigue is available in sweeps only"
            )
        histories = fatigue.histories(members[None], sampled.p[None])
        bound, _ = histories.bounds(self.material)
        found: list[Point] = []
        best = 0.0
        for k in np.argsort(-bound[0], kind="stable").tolist():
            if bound[0, k] <= best and len(found) >= _FEW:
                break
            cycles = loaded(histories.at(0, k))
            shares = used(cycles.amplitude, cycles.mean, self.material)
            worst = int(np.argmax(shares))
            first, last = (sampled.instant(int(instants[i])) for i in cycles.instants[worst])
            found.append(
                Point(
                    first.share, last.share, k, float(shares[worst]), first.guess, second=last.guess
                )
            )
            best = max(best, float(shares[worst]))
        return sorted(found, key=lambda point: -point.value)

    def stresses(self, out: ca.SX, p: ca.SX) -> ca.SX:
        """Normal stresses of all places, then their shear stresses along y and along z, of columns
        at an instant: expressions.
        """
        fatigue, count = self.fatigue, self.fatigue.places
        members = ca.vertcat(*(out[self.program.outputs[member]] for member in fatigue.members))
        found: ca.SX = ca.mtimes(
            ca.reshape(fatigue.rows(members, p), members.numel(), -1).T, members
        )
        shears = ca.SX(2 * count, 1)
        for number, axis in enumerate(fatigue.axes):
            first = count + number * fatigue.sheared.size
            shears[[axis * count + k for k in fatigue.sheared.tolist()]] = found[
                first : first + fatigue.sheared.size
            ]
        return ca.densify(ca.vertcat(found[:count], shears))

    def cycle(self, at_time: ca.Function) -> ca.Function:
        """``value(share, guess, p, xi, place)``: a swing's utilisation, by stresses at a time;
        ``place`` names the place by a 1.
        """
        kind = ca.SX if at_time.is_a("SXFunction") else ca.MX
        nz, count = at_time.numel_in(1), self.fatigue.places
        sizes: Sequence[int] = (1, nz, at_time.numel_in(2), 1, count + nz)
        given: list[Any] = [
            kind.sym(name, n)
            for name, n in zip(("share", "guess", "p", "xi", "place"), sizes, strict=True)
        ]
        share, guess, p, xi, place = given
        chosen, other = place[:count], place[count:]
        ends = [at_time(*when, p, 0.0, 0.0) for when in ((share, guess), (xi, other))]
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


def tired_link(output: Output | None) -> str | None:
    """The link whose utilisation against fatigue an output is; None of any other."""
    fatigue = output is not None and (output.group, output.member) == ("utilisation", "fatigue")
    return output.part if output is not None and fatigue else None


def _root(square: Expression) -> Expression:
    """A square root, whose slope at zero is none."""
    there = square > 0.0
    return ca.if_else(there, ca.sqrt(ca.if_else(there, square, 1.0)), 0.0)
