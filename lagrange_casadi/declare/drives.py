"""Joints whose efforts make a motion, if these are others than the joints whose motion is given."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import casadi as ca

from ..arguments import texts
from ..errors import DeclarationError, UnknownNameError, shown
from .mechanism import Mechanism
from .parts import Expression


def weighed(
    mechanism: Mechanism, drives: Mapping[str, Expression] | Sequence[str], moved: Sequence[str]
) -> dict[str, Expression]:
    """The drives with their weights, in the order of the joints' declaration.

    ``moved`` are the joints whose motion needs an effort. Raises :class:`UnknownNameError` for a
    joint that is none, and :class:`DeclarationError` for one that has no coordinate, for too few,
    and for a weight that is not positive.
    """
    if not isinstance(drives, Mapping) and texts(drives) is None:
        raise DeclarationError(
            f"drives: expected a list of joints, or weights by joint, got {shown(drives)}"
        )
    coordinates = mechanism.coordinates
    weights = dict(drives) if isinstance(drives, Mapping) else dict.fromkeys(drives, 1.0)
    if len(weights) < len(drives):
        raise DeclarationError(f"drives: a joint is listed twice in {', '.join(drives)}")
    for name, weight in weights.items():
        if name in mechanism.joints and name not in coordinates:
            axes = ", ".join(axis.coordinate for axis in mechanism.joints[name].axes)
            why = (
                f"has several coordinates; expected one of {axes}"
                if axes
                else "has no coordinate for an effort"
            )
            raise DeclarationError(f"drives: joint '{name}' {why}")
        if name not in coordinates:
            raise UnknownNameError("joint in drives", name, coordinates)
        if not isinstance(weight, ca.SX):
            if not isinstance(weight, (int, float)) or not 0.0 < weight < float("inf"):
                raise DeclarationError(
                    f"drives: expected a positive weight of joint '{name}', got {weight!r}"
                )
        elif strange := [
            str(s) for s in ca.symvar(weight) if not ca.depends_on(mechanism.symbols, s)
        ]:
            raise DeclarationError(
                f"drives: the weight of joint '{name}' depends on {', '.join(strange)}, which is"
                " not a parameter"
            )
    if len(weights) < len(moved):
        raise DeclarationError(
            f"drives: {len(weights)} cannot make {len(moved)} independent motions; expected at"
            f" least {len(moved)} joints for the motion of {', '.join(moved)}, got"
            f" {', '.join(weights) or 'none'}"
        )
    return {name: weights[name] for name in coordinates if name in weights}
