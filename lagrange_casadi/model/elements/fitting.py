"""Pins and bearings that a joint is fitted with."""

from __future__ import annotations

from ...base.arguments import public
from ...base.arrays import Operand
from ...errors import DeclarationError
from ..beams.material import Material
from ..fitted import Fitted, Fittings, positive
from ..joints import Joint
from ..mechanism import Mechanism

_UNITS = dict.fromkeys(("diameter", "eye", "cheek", "gap", "bore", "width"), "m") | {"speed": "m/s"}
_TAKES: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(("revolute", "cylindrical"), ("pin", "plain", "rolling")),
    **dict.fromkeys(("prismatic", "slot"), ("plain",)),
}
"""Kinds of parts that a kind of joint takes."""


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
    mechanism.ownership.joint(joint)
    what = f"joint '{joint.name}'"
    mechanism.ownership.refuse_frozen(f"fit {what}")
    turning = mechanism.turning.get(joint.name)
    if turning == "":
        raise DeclarationError(
            f"{what}: its shaft lies in the plane, so it does not turn here; use a"
            " SpatialMechanism for its bearings"
        )
    takes = ("plain", "rolling") if turning else _TAKES.get(joint.kind, ())
    found = mechanism.fitted.get(joint.name, Fittings())
    for part in parts:
        kind = type(part).__name__.lower()
        if kind not in takes:
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
