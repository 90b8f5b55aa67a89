"""Newton's method for the loops that have no closed form: what is iterated, and a step of it."""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from ..base.arrays import Array, Expression, Operand
from ..base.scalars import column
from .linear import LinearSystem
from .multibody import Coordinate, Multibody
from .spherical import SphericalCoordinates, axes_of, quaternion_of, turn
from .substitution import Numbers

LARGEST_STEP = 0.3
"""Largest step of an angle [rad], or of a slide over the length of all links: a full step from afar
may land on another branch.
"""

CLOSED = 1e-9
"""The last correction of loops that are closed: the next one is rounding."""

_STEPS = 100

NEWTON_LOST = 0.1
"""A last correction, of a fixed number, after which nothing is known."""


@dataclass(frozen=True, eq=False)
class Start:
    """Start of the motion of the drives: of ``motion(t, p)``, the coordinates of drives first, at
    the beginning of its ``span`` [s].

    ``parameters`` are the numbers p; ``note`` names them, to end a message with.
    """

    motion: Any
    span: tuple[float, float]
    parameters: Sequence[float]
    note: str

    @property
    def t(self) -> float:
        """Time [s]."""
        return self.span[0]

    @cached_property
    def driven(self) -> list[float]:
        """Values of the driven coordinates [rad or m]."""
        return [float(x) for x in ca.DM(self.motion(self.t, self.parameters)[0]).full().ravel()]


@dataclass(frozen=True, eq=False)
class NewtonLoop:
    """Iteration of a loop: ``step(z, t, d, p) -> (correction, relative size)`` and the guess for
    the first instant.

    ``names`` are those of its blocks, which are judged by a volume; ``joints`` says what closes
    them, for messages. ``turning`` marks which unknowns are angles that matter up to whole turns
    only.
    """

    step: Any
    guess: tuple[float, ...]
    turning: tuple[bool, ...]
    names: tuple[str, ...]
    joints: str

    def closed(
        self, z: Operand, t: Operand, d: Operand, p: Sequence[float] | Array
    ) -> tuple[ca.DM, ca.DM]:
        """Iterated coordinates at instants, a column each, from ones that are near; and the size of
        the last correction, which is :data:`CLOSED` at most where they are found.
        """
        z, size = ca.DM(z), ca.DM(math.inf)
        for _ in range(_STEPS):
            correction, size = self.step(z, t, d, p)
            z += correction
            if float(ca.mmax(size)) < CLOSED:
                break
        return z, size


@dataclass(eq=False)
class Iterated:
    """The unknowns, in the order in which they were added: numbers, each on a scale of its own, and
    balls by their quaternions.

    Gaps are given to it in the axes of the balls, whose slopes are shorter than those of
    quaternions.
    """

    parts: list[tuple[Any, SphericalCoordinates | None]] = field(default_factory=list)
    scales: list[Any] = field(default_factory=list)
    guess: list[float] = field(default_factory=list)
    turning: list[bool] = field(default_factory=list)

    def add(
        self,
        name: str,
        guess: Sequence[float],
        scales: Sequence[Expression],
        spherical: SphericalCoordinates | None = None,
        *,
        turning: bool = False,
    ) -> ca.SX:
        """The symbols of a number, or of the quaternion of a ball; ``scales`` are what corrections
        are large beside.
        """
        symbols = ca.SX.sym(f"z_{name}", len(guess))
        self.parts.append((symbols, spherical))
        self.scales += scales
        self.guess += guess
        self.turning += [turning] * len(guess)
        return symbols

    @property
    def symbols(self) -> Expression:
        """All symbols, one column."""
        return column(symbols for symbols, _ in self.parts)

    def placed(self, expression: ca.SX) -> ca.SX:
        """An expression in axes of balls as one in the symbols."""
        sphericals = [(of.axes, symbols) for symbols, of in self.parts if of is not None]
        placed = column(axes_of(symbols) for _, symbols in sphericals)
        return ca.substitute(ca.SX(expression), column(axes for axes, _ in sphericals), placed)

    def step(self, residuals: ca.SX, units: Expression) -> tuple[ca.SX, ca.SX]:
        """Newton correction of the symbols, and its size; a large one is shortened. By their
        ``units`` the residuals are of one size.
        """
        moved = column(
            part if spherical is None else spherical.axes for part, spherical in self.parts
        )
        unit = ca.SX.eye(3)
        turned = [
            ca.SX(1)
            if spherical is None
            else ca.horzcat(
                *(column(spherical.changes(ca.vertsplit(unit[:, i]))) for i in range(3))
            )
            for _, spherical in self.parts
        ]
        slope = self.placed(ca.jacobian(residuals, moved) @ ca.diagcat(*turned))
        correction = -LinearSystem.of(slope, units).solve(self.placed(residuals))
        relative = ca.mmax(ca.fabs(correction / column(self.scales)))
        # Not fmin(1, limit / relative): where the loops are closed, its derivative would be 0 times
        # infinity.
        bounded = correction * (LARGEST_STEP / ca.fmax(relative, LARGEST_STEP))
        ends = [0, *itertools.accumulate(block.shape[1] for block in turned)]
        changes = zip(self.parts, ca.vertsplit(bounded, ends), strict=True)
        return column(
            change if spherical is None else turn(part, change) - part
            for (part, spherical), change in changes
        ), relative


def place_roughly(
    multibody: Multibody,
    posture: Mapping[Coordinate, float],
    numbers: Numbers,
    but: Collection[Coordinate],
) -> dict[SphericalCoordinates, list[float]]:
    """Put the coordinates of a ``posture``, but for some, into ``numbers``; return the quaternions
    of spherical joints.
    """
    found: dict[SphericalCoordinates, list[float]] = {}
    for coordinate in multibody.coordinates:
        spherical = coordinate.spherical
        if coordinate in but or spherical in found:
            continue
        if spherical is None:
            numbers.note(
                coordinate.variables,
                numbers.of(coordinate.placed(ca.SX(posture.get(coordinate, 0.0)))),
            )
            continue
        angles = [posture.get(c, 0.0) for c in multibody.coordinates if c.spherical is spherical]
        axes = np.array(
            numbers.of(spherical.turned_by(angles, multibody.frames[spherical.near].rotation))
        )
        numbers.note(spherical.axes, axes.tolist())
        found[spherical] = quaternion_of(axes.reshape(3, 3))
    return found
