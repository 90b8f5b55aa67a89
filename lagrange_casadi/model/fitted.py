"""Fittings of a joint: pins, plain bearings and rolling bearings, by their numbers."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..base.arguments import NotNegative, Positive, Symbolic, public
from ..base.arrays import Operand
from ..base.brief import Brief
from ..errors import DeclarationError, shown
from .beams.material import Material

if TYPE_CHECKING:
    from .joints import Joint
    from .mechanism import Mechanism


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
    pressure: Positive | None = None
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
    pressure: Positive | None = None
    speed: Symbolic | None = None
    heating: Positive | None = None


@public
@dataclass(frozen=True, eq=False)
class Rolling:
    """A rolling bearing by its ratings, and the hours that nine of ten must run.

    ``dynamic`` and ``static`` are its basic load ratings C and C0 [N]; ``exponent`` is 3 of ball
    bearings and 10/3 of roller bearings. The equivalent load is ``radial`` times the force across
    the pin's axis, and ``axial`` times that along it (ISO 281).
    """

    dynamic: Positive
    hours: Positive
    static: Positive | None = None
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


_UNITS = dict.fromkeys(("diameter", "eye", "cheek", "gap", "bore", "width"), "m") | {"speed": "m/s"}
_MAY_BE_ZERO = ("gap", "axial", "radial")


@public
def fit(mechanism: Mechanism, joint: Joint, *parts: Fitted) -> None:
    """Fit a pin, a plain bearing or a rolling bearing to a joint, for ``safety:JOINT``.

    A joint that turns takes all kinds, a bearing of :func:`.two_bearings` a plain or a rolling one,
    and a joint that slides, as a bush of :func:`.two_bushes`, a plain one.

    Parameters
    ----------
    mechanism : Mechanism
        Has the joint, and is changed.
    joint : Joint
        A revolute or cylindrical joint.
    *parts : Pin, Plain or Rolling
        One part of each kind at most.

    Raises
    ------
    DeclarationError
        If the joint is one of another mechanism or takes no such part, if a part is of another
        type, or if a number is not positive.
    """
    if isinstance(mechanism, type) or not hasattr(mechanism, "ownership"):
        raise DeclarationError(f"fit: expected a Mechanism first, got {shown(mechanism)}")
    mechanism.ownership.joint(joint)
    what = f"joint '{joint.name}'"
    mechanism.ownership.refuse_frozen(f"fit {what}")
    turning = mechanism.turning.get(joint.name)
    if turning == "":
        raise DeclarationError(
            f"{what}: its shaft lies in the plane, so it does not turn here; use a"
            " SpatialMechanism for its bearings"
        )
    pinned = joint.kind in ("revolute", "cylindrical")
    slides = joint.kind in ("prismatic", "slot")
    takes = ("plain", "rolling") if turning else ("plain",) if slides else ()
    found = mechanism.fitted.get(joint.name, Fittings())
    for part in parts:
        kind = type(part).__name__.lower()
        if not pinned and kind not in takes:
            also = f"; it takes a {' or a '.join(takes)} bearing" if takes else ""
            raise DeclarationError(
                f"{what}: expected a revolute or cylindrical joint for a pin or a bearing, got a"
                f" {joint.kind} one{also}"
            )
        if getattr(found, kind) is not None:
            raise DeclarationError(f"{what}: the joint already has a {kind} part")
        numbers = {
            name: _checked(mechanism, f"{what}: {kind}", name, value)
            for name, value in vars(part).items()
        }
        found = Fittings(**vars(found) | {kind: type(part)(**numbers)})
    mechanism.fitted[joint.name] = found


def _checked(mechanism: Mechanism, what: str, name: str, value: float | None) -> Operand:
    if isinstance(value, Material):
        value.needs(what, "yield_strength")
    if value is None or isinstance(value, Material):
        return value
    number = mechanism.ownership.expression(f"{what}: {name}", value, _UNITS.get(name, "1"))
    if isinstance(number, float) and not positive(name, number):
        raise DeclarationError(f"{what}: {name} must be positive, got {number:g}")
    return number


def positive(name: str, number: float) -> bool:
    """Check that a number of a part is positive."""
    return 0.0 <= number < math.inf if name in _MAY_BE_ZERO else 0.0 < number < math.inf
