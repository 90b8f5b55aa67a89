"""Fittings of a joint: pins, plain bearings and rolling bearings, by their numbers."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any, TypeAlias

from ..base.arguments import Force, Hours, NotNegative, Positive, Stress, Symbolic, public
from ..base.brief import Brief
from ..base.units import Within
from .beams.material import Material

Heating: TypeAlias = Annotated[Any, Within(0.0, above=True, unit="W/m^2")]


@public
@dataclass(frozen=True, eq=False, repr=False)
class Pin(Brief):
    """A pin through an eye between two cheeks of a fork [m].

    ``eye`` is the width of the eye, ``cheek`` that of each cheek, ``gap`` that between eye and
    cheek; ``pressure`` is what the softer of them bears [Pa]. The pin fits loosely in both.
    """

    diameter: Symbolic
    eye: Symbolic
    cheek: Symbolic
    material: Material
    pressure: Stress | None = None
    gap: Symbolic = 0.0


@public
@dataclass(frozen=True, eq=False)
class Plain:
    """A plain bearing by its bore and its width [m], and what its material bears.

    ``pressure`` is the largest load over bore times width [Pa], ``speed`` the largest speed of
    sliding [m/s], and ``heating`` the largest mean of the product of both over time [W/m^2]. What
    is None is not looked at.
    """

    bore: Symbolic
    width: Symbolic
    pressure: Stress | None = None
    speed: Symbolic | None = None
    heating: Heating | None = None


@public
@dataclass(frozen=True, eq=False)
class Rolling:
    """A rolling bearing by its ratings, and the hours that nine of ten must run.

    ``dynamic`` and ``static`` are its basic load ratings C and C0 [N]; ``exponent`` is 3 of ball
    bearings and 10/3 of roller bearings. The equivalent load is ``radial`` times the force across
    the pin's axis, and ``axial`` times that along it (ISO 281).
    """

    dynamic: Force
    hours: Hours
    static: Force | None = None
    exponent: Positive = 3.0
    radial: NotNegative = 1.0
    axial: NotNegative = 0.0


Fitted = Pin | Plain | Rolling


@dataclass(frozen=True, eq=False)
class Fittings:
    """The parts that are fitted to a joint: one of each kind at most."""

    pin: Pin | None = None
    plain: Plain | None = None
    rolling: Rolling | None = None

    @property
    def parts(self) -> list[Fitted]:
        """Parts that are fitted."""
        return [part for part in (self.pin, self.plain, self.rolling) if part is not None]


_MAY_BE_ZERO = ("gap", "axial", "radial")


def positive(name: str, number: float) -> bool:
    """Check that a number of a part is positive."""
    return 0.0 <= number < math.inf if name in _MAY_BE_ZERO else 0.0 < number < math.inf
