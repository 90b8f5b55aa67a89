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
from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt

from ...base.arrays import Expression
from ...base.quantities import Column
from ...base.symbolic import Graphs, symbolic_property
from ...engine.program import Program
from ...engine.section_function import SIDES, Side, edge
from ...engine.section_stress import concentration, notch_factor
from ...engine.utilisation import Loaded, Part
from ...errors import DeclarationError
from ...model.beams.beam import Notch
from ...model.beams.material import Material
from ...model.limits import END
from ...results.statistics import counted
from ...results.strength.fatigue import cycle_squares, loaded, strengths, use_score, used
from ...results.strength.fibres import Maximum, maxima
from ...results.strength.member import Member
from .sampled_design import KEEP, Point, SampledDesign


@dataclass(frozen=True, eq=False)
class _Fibres(Graphs):
    """Fibres by their ``names``, in a part of a link between two marks, or beside a notch.

    ``where`` is the number of the part of the beam between breaks of its cross-section, the side of
    places, and the notch. ``span(out, p)`` is where the part begins, and how wide it is;
    ``stresses(out, p, x)`` are the normal stresses, and the shear stresses along y and along z, at
    a place from 0 to 1 of the part.
    """

    names: list[str]
    where: tuple[int, Side, Notch | None]
    span: ca.Function
    stresses: ca.Function


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

    @symbolic_property
    def fibres(self) -> list[_Fibres]:
        """The fibres between marks, by functions of columns at an instant and of parameters; then
        those on both sides of notches.
        """
        program = self.program
        out, p, x = ca.SX.sym("out", len(program.columns)), program.data.symbols, ca.SX.sym("x")
        columns: dict[Column, Any] = {output: out[k] for output, k in program.outputs.items()}
        body = Loaded(program.data.space, program.data.link(self.link, p), columns)
        found, breaks = [], body.course.breaks
        places: list[tuple[Part, Side, Notch | None]] = [(part, "tip", None) for part in body.spans]
        for one, side in itertools.product(body.beam.notches, SIDES):
            touching = [k for k in range(len(breaks) - 1) if breaks[k] <= one.at <= breaks[k + 1]]
            part = Part(ca.SX(one.at), ca.SX(0.0), touching[-1 if side == "tip" else 0])
            places.append((part, side, notch_factor(one)))
        for part, side, notch in places:
            u, beyond = part.low + part.width * x, edge(part.low, END["double"], side)
            forces = [
                body.section.force(name, u, beyond) * concentration(notch, name)
                for name in body.cross.forces
            ]
            fibres = body.cross.fibres(part.cell)
            stresses = body.cross.stresses(part.cell, u, fibres.alone, forces)
            found.append(
                _Fibres(
                    [fibres.names[k] for k in fibres.alone],
                    (part.cell, side, notch),
                    ca.Function("span", [out, p], [part.low, part.width]),
                    ca.Function("stresses", [out, p, x], [*stresses], {"cse": True}),
                )
            )
        return found

    def points(self, sampled: SampledDesign) -> list[Point]:
        """The worst swings of a design, one for each fibre between two marks, the worst first: a
        point's ``xi`` is the share of the swing's other instant.

        Raises :class:`.DeclarationError` where a load travels along the link.
        """
        columns, outputs = sampled.history.columns, self.program.outputs
        law = [output for output in outputs if output.along and output.part == self.link]
        instants = np.flatnonzero(counted(columns[[outputs[output] for output in law]]))
        if not instants.size:
            return []
        values = {output: columns[None, outputs[output], instants] for output in law}
        member = Member.of_designs(self.program.data, self.link, sampled.p[None], values)
        if not member.still.all():
            raise DeclarationError(
                f"a load moves along link '{self.link}'; its fatigue is available in sweeps only"
            )
        (found,) = maxima(member, use_score(self.material), KEEP)
        spans = [fibres.span(columns[:, instants[0]], sampled.p) for fibres in self.fibres]
        return [self._point(sampled, maximum, instants, spans) for maximum in found]

    def _point(
        self,
        sampled: SampledDesign,
        maximum: Maximum,
        instants: npt.NDArray[np.intp],
        spans: Sequence[Sequence[Any]],
    ) -> Point:
        cycles = loaded(maximum.history)
        shares = used(cycles.amplitude, cycles.mean, self.material)
        worst = int(np.argmax(shares))
        first, last = (sampled.instant(int(instants[i])) for i in cycles.instants[worst])
        strips, middle = maximum.strips, sum(maximum.ends) / 2.0
        where, number, place = (strips.cell.index, strips.side, strips.notch), 0, 0.0
        for fibres, (low, width) in zip(self.fibres, spans, strict=True):
            if fibres.where == where and 0.0 <= middle - float(low) <= float(width):
                place = (maximum.xi - float(low)) / (float(width) or 1.0)
                number += fibres.names.index(maximum.fibre)
                break
            number += len(fibres.names)
        return Point(
            first.share,
            last.share,
            number,
            maximum.score,
            first.guess,
            second=(place, *last.guess),
        )

    def stresses(self, out: Expression, p: Expression, x: Expression) -> Expression:
        """Normal stresses of all fibres, then their shear stresses along y and along z, of columns
        at an instant and at a place of each part: expressions.
        """
        every = [fibres.stresses(out, p, x) for fibres in self.fibres]
        return ca.densify(ca.vertcat(*itertools.chain.from_iterable(zip(*every, strict=True))))

    def cycle(self, at_time: ca.Function) -> ca.Function:
        """``value(share, guess, p, xi, place)``: a swing's utilisation, by stresses at a time;
        ``place`` names the fibre by a 1, and then the place in its part.
        """
        kind = ca.SX if at_time.is_a("SXFunction") else ca.MX
        nz, count = at_time.numel_in(1), sum(len(fibres.names) for fibres in self.fibres)
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
