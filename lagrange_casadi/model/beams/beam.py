"""Beam of a link: a cross-section along it, a material, and notches; and its form in a file."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, TypeAlias

from ...base.arguments import Share, public
from ...base.arrays import Operand
from ...base.brief import Brief
from ...base.units import Within
from ...errors import DeclarationError
from .material import Material
from .shape import Course, Shape

Factor: TypeAlias = Annotated[float, Within(1.0)]

SLIGHT = 1e-6
"""Least fraction of a column's critical load: less compression is rounding at a free end, and
buckles nothing.
"""


@public
@dataclass(frozen=True)
class Notch:
    """A place where stress concentrates: the ratio ``at`` = xi/l, and the theoretical factors on
    nominal stress of axial force, of bending, and of shear and torsion.

    ``sensitivity``, from 0 to 1, is how much of it counts in fatigue: K_f = 1 + q (K_t - 1).
    """

    at: Share
    axial: Factor = 1.0
    bending: Factor = 1.0
    shear: Factor = 1.0
    sensitivity: Share = 1.0


@public
@dataclass(frozen=True, eq=False, repr=False)
class Beam(Brief):
    """A cross-section, a :class:`.Shape` or a :class:`.Course` of some, and a :class:`.Material`;
    notches along the link.

    ``columns`` are the effective lengths of the link as a column over its length: where it bends
    along y, in the plane of motion of a planar mechanism, and where it bends along z. By default
    they follow from the joints (:mod:`.engine.buckling`).

    Raises :class:`.DeclarationError` for what is none of these.
    """

    shape: Shape | Course
    material: Material
    notches: Sequence[Notch] = ()
    columns: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        if self.columns is not None:
            pair = tuple(self.columns) if isinstance(self.columns, Sequence) else ()
            if len(pair) != 2 or not all(
                isinstance(k, (int, float)) and 0.0 < k < math.inf for k in pair
            ):
                raise DeclarationError(
                    f"beam: expected two effective lengths, positive, got {self.columns!r}"
                )
            object.__setattr__(self, "columns", pair)
        object.__setattr__(self, "notches", tuple(self.notches))

    @property
    def course(self) -> Course:
        """Cross-sections along the link."""
        shape = self.shape
        return shape if isinstance(shape, Course) else Course((0.0, 1.0), (shape,), ((0, 0),))

    @property
    def round(self) -> bool:
        """True if the cross-sections are the same about any axis across the link."""
        return all(shape.round for shape in self.course.shapes)

    def mapped(self, change: Callable[[str, Operand], Operand]) -> Beam:
        """Return the beam with other dimensions.

        Parameters
        ----------
        change : callable
            Gives a new size [m] from a dimension's name and size.

        Returns
        -------
        Beam
            The beam, of the same material.
        """
        return replace(self, shape=self.course.mapped(change))

    def masses(self) -> list[list[Operand]]:
        """The mass per length [kg/m] between two breaks, as coefficients of rising powers of the
        ratio xi/l.

        Dimensions are linear there, so areas are of degree two at most.
        """
        course, found = self.course, []
        for (a, b), (first, last) in zip(
            itertools.pairwise(course.breaks), course.cells, strict=True
        ):
            if first is last:
                found.append([self.material.density * first.area])
                continue
            half = Shape(
                first.kind,
                {name: (x + last.dimensions[name]) / 2 for name, x in first.dimensions.items()},
            )
            start, stop = first.area, last.area
            bend = 2 * (start + stop - 2 * half.area)
            slope, width = stop - start - bend, b - a
            # In powers of the ratio, not of what is beyond the break.
            powers = (
                start - slope * a / width + bend * a * a / width**2,
                slope / width - 2 * bend * a / width**2,
                bend / width**2,
            )
            found.append([self.material.density * power for power in powers])
        return found
