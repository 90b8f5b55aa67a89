"""Revolutions of a drive within the instants: whether a cycle is whole, and the same for all
parameters.
"""

from __future__ import annotations

import math

import numpy as np

from ..base.arrays import Array
from ..base.quantities import Kinds
from .motion_inverse import MotionInverse
from .sampled_laws import Laws
from .times import Timing

_SAMPLES = 129
_GOES_ON = 0.5
"""Fraction of the mean rate: a drive that ends slower comes to rest, and does not turn."""

_WHOLE = 1e-6
"""Fraction of a turn that is rounding."""

_BACK = 1e-9
"""Fraction of the largest rate below which a rate of the wrong sign is rounding."""

_BEYOND = 1.5
"""Largest duration of a whole turn, as a multiple of that at the mean rate."""

_PLACES = 6
"""Decimal places of an angle in degrees."""


def note(laws: Laws, kinds: Kinds, timing: Timing, p: Array) -> str:
    """A line where the one drive turns, and makes less than a turn within the instants, or not the
    same for all parameters.

    ``p`` is (n, parameters); those for which there are no instants do not count. A drive that
    swings or comes to rest does not turn. Nothing is said of several drives, whose turns are no
    cycle, nor where instants are asked for by the drive.
    """
    if len(laws.joints) != 1 or timing.joint or timing.count < 2:
        return ""
    (joint,), (span,) = laws.joints, laws.spans
    start, stop, _ = timing.bounds(p)
    with np.errstate(invalid="ignore"):
        there = np.isfinite(stop - start) & (stop > start) & (start >= span[0]) & (stop <= span[1])
    if kinds.coordinates[joint] == "slide" or not there.any():
        return ""
    start, stop, p = start[there], stop[there], p[there]
    law = MotionInverse.of(laws, joint)
    first, last = (law.at(moment[:, None], p)[0, :, 0] for moment in (start, stop))
    revolutions = (last - first) / math.tau
    sizes = np.abs(revolutions)
    least, most = sizes.min(), sizes.max()
    if not _goes_round(law, start, stop, revolutions, p):
        return ""
    whole = math.copysign(360.0 * max(1, round(float(most))), revolutions[0])
    begin = round(math.degrees(float(first[0])), _PLACES) + 0.0
    asked = (
        f"instants over {joint}={begin:.6g}deg:{begin + whole:.6g}deg:{timing.count} make it a"
        " whole number"
    )
    if most - least > _WHOLE * most:
        return (
            f"drive '{joint}' makes {least:.3g} to {most:.3g} turns, not the same in every design;"
            f" {asked}"
        )
    if least < 1.0 - _WHOLE:
        return f"drive '{joint}' makes {least:.3g} of a revolution; {asked}"
    return ""


def _goes_round(
    law: MotionInverse, start: Array, stop: Array, revolutions: Array, p: Array
) -> bool:
    """Return whether a drive goes one way all the time, does not come to rest, and if it continues
    makes a whole turn.
    """
    with np.errstate(all="ignore"):
        longer = (stop - start) * np.maximum(1.0, _BEYOND / np.abs(revolutions))
        moments = np.minimum(
            start[:, None] + longer[:, None] * np.linspace(0.0, 1.0, _SAMPLES), law.span[1]
        )
        d, rate, _ = law.at(moments, p)
        last = law.at(stop[:, None], p)[1, :, 0]
        sign = np.sign(revolutions)
        onward = (sign[:, None] * rate > -_BACK * np.abs(rate).max(axis=1, keepdims=True)).all(
            axis=1
        )
        goes_on = sign * last >= _GOES_ON * math.tau * np.abs(revolutions) / (stop - start)
        whole = np.abs(d[:, -1] - d[:, 0]) >= math.tau * (1.0 - _WHOLE)
    return bool((onward & goes_on & whole & (revolutions != 0.0)).all())
