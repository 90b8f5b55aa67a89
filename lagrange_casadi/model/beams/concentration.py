"""Notches by their dimensions: shoulders, holes and keyways, with factors of stress concentration
from published fits.

Shoulders and holes: Pilkey, *Peterson's Stress Concentration Factors*, 2nd edition, the charts of
stepped flat and round bars in tension and bending, of round bars in torsion, and of an element of
finite width with a hole. Keyways: Budynas and Nisbett, *Shigley's Mechanical Engineering Design*,
9th edition, table 7-1. Sensitivity: the same, eq. 6-34 and 6-35a, Neuber's constant.

Factors are on nominal stress of the beam's own cross-section: at a shoulder that of the narrow
side, at a hole that of the whole cross-section, as if there were no hole.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from ...base.arguments import Length, Stress, public
from ...errors import DeclarationError
from .beam import Notch

_Row = tuple[float, float, float]
_Fit = Sequence[tuple[float, float, Sequence[_Row]]]
"""Range of t/r of a fit, and C1 to C4, each a + b sqrt(t/r) + c t/r."""

_ROUND_TENSION: _Fit = (
    (
        0.1,
        2.0,
        (
            (0.926, 1.157, -0.099),
            (0.012, -3.036, 0.961),
            (-0.302, 3.977, -1.744),
            (0.365, -2.098, 0.878),
        ),
    ),
    (
        2.0,
        20.0,
        (
            (1.200, 0.860, -0.022),
            (-1.805, -0.346, -0.038),
            (2.198, -0.486, 0.165),
            (-0.593, -0.028, -0.106),
        ),
    ),
)
_ROUND_BENDING: _Fit = (
    (
        0.1,
        2.0,
        (
            (0.947, 1.206, -0.131),
            (0.022, -3.405, 0.915),
            (0.869, 1.777, -0.555),
            (-0.810, 0.422, -0.260),
        ),
    ),
    (
        2.0,
        20.0,
        (
            (1.232, 0.832, -0.008),
            (-3.813, 0.968, -0.260),
            (7.423, -4.868, 0.869),
            (-3.839, 3.070, -0.600),
        ),
    ),
)
_ROUND_TORSION: _Fit = (
    (
        0.25,
        4.0,
        (
            (0.905, 0.783, -0.075),
            (-0.437, -1.969, 0.553),
            (1.557, 1.073, -0.578),
            (-1.061, 0.171, 0.086),
        ),
    ),
)
_FLAT_TENSION: _Fit = (
    (
        0.1,
        2.0,
        (
            (1.006, 1.008, -0.044),
            (-0.115, -0.584, 0.315),
            (0.245, -1.006, -0.257),
            (-0.135, 0.582, -0.017),
        ),
    ),
    (
        2.0,
        20.0,
        (
            (1.020, 1.009, -0.048),
            (-0.065, -0.165, -0.007),
            (-3.459, 1.266, -0.016),
            (3.505, -2.109, 0.069),
        ),
    ),
)
# Printed with -0.200 as the last number of the first row: by that it would not meet the second row,
# nor go to 1 for a wide step.
_FLAT_BENDING: _Fit = (
    (
        0.1,
        2.0,
        (
            (1.006, 0.967, 0.013),
            (-0.270, -2.372, 0.708),
            (0.662, 1.157, -0.908),
            (-0.405, 0.249, 0.200),
        ),
    ),
    (
        2.0,
        20.0,
        (
            (1.058, 1.002, -0.038),
            (-3.652, 1.639, -0.436),
            (6.170, -5.687, 1.175),
            (-2.558, 3.046, -0.701),
        ),
    ),
)

_INCH, _KSI = 0.0254, 6.894757e6
_NEUBER = (0.246, -3.08e-3, 1.51e-5, -2.67e-8)
_KNOWN = (50.0, 250.0)
"""Neuber's constant of steels [in^1/2] in powers of the ultimate strength [ksi], and the strengths
for which it holds.
"""


@public
def shoulder(
    at: float,
    wide: Length,
    narrow: Length,
    radius: Length,
    *,
    flat: bool = False,
    shear: float | None = None,
    sensitivity: float = 1.0,
) -> Notch:
    """Return the notch of a step of a bar with a fillet.

    Parameters
    ----------
    at
        Ratio xi/l of the step.
    wide, narrow
        Diameters of a round bar, or heights of a flat one, on both sides [m, or a text].
    radius
        Radius of the fillet [m, or a text].
    flat
        True for a flat bar, whose wide part is at least six times as long as high.
    shear
        Factor on shear stress; by default that of torsion for round bars, and 1 for flat ones.
    sensitivity
        Notch sensitivity for fatigue, from 0 to 1.

    Returns
    -------
    Notch
        The notch.

    Raises
    ------
    DeclarationError
        If there is no step, and outside the range of the fits: the depth of the step over the
        radius must be 0.1 to 20, for torsion 0.25 to 4.
    """
    if not wide > narrow:
        raise DeclarationError(
            f"shoulder: wide must be more than narrow, got {wide:g} and {narrow:g} m"
        )
    if shear is None:
        shear = 1.0 if flat else _fitted("torsion", _ROUND_TORSION, wide, narrow, radius)
    tension, bending = (_FLAT_TENSION, _FLAT_BENDING) if flat else (_ROUND_TENSION, _ROUND_BENDING)
    axial = _fitted("tension", tension, wide, narrow, radius)
    return Notch(at, axial, _fitted("bending", bending, wide, narrow, radius), shear, sensitivity)


@public
def hole(
    at: float,
    height: Length,
    diameter: Length,
    *,
    shear: float = 1.0,
    sensitivity: float = 1.0,
) -> Notch:
    """Return the notch of a hole through the middle of a flat bar, along z, for bending in the
    plane of the hole.

    Parameters
    ----------
    at
        Ratio xi/l of its place.
    height, diameter
        Height of the bar and diameter of the hole [m, or a text].
    shear
        Factor on shear stress.
    sensitivity
        Notch sensitivity for fatigue, from 0 to 1.

    Returns
    -------
    Notch
        The notch. In bending the factor is that of the outermost fibre, or of the edge of the
        hole if that is larger.

    Raises
    ------
    DeclarationError
        For a hole that does not fit.
    """
    share = diameter / height
    if not share < 1.0:
        raise DeclarationError(
            f"hole: diameter must be less than height, got {diameter:g} and {height:g} m"
        )
    remaining = 1.0 - share
    tension = 0.284 + 2.0 / remaining - 0.600 * remaining + 1.32 * remaining**2
    return Notch(at, tension, max(1.0, 2.0 * share) / (1.0 - share**3), shear, sensitivity)


@public
def keyway(at: float, *, sensitivity: float = 1.0) -> Notch:
    """Return the notch at the end of an end-milled keyway, whose corners have a radius of a
    fiftieth of the diameter, as in standards.

    Parameters
    ----------
    at
        Ratio xi/l of its place.
    sensitivity
        Notch sensitivity for fatigue, from 0 to 1.

    Returns
    -------
    Notch
        The notch.
    """
    return Notch(at, 1.0, 2.14, 3.0, sensitivity)


@public
def sensitivity(radius: Length, ultimate: Stress) -> float:
    """Return the notch sensitivity of steel, by Neuber's constant.

    Parameters
    ----------
    radius
        Radius of the notch [m, or a text].
    ultimate
        Ultimate strength [Pa].

    Returns
    -------
    float
        Notch sensitivity, from 0 to 1.

    Raises
    ------
    DeclarationError
        For a strength for which it is not known.
    """
    strength: float = ultimate / _KSI
    if not _KNOWN[0] <= strength <= _KNOWN[1]:
        ends = " to ".join(f"{end * _KSI / 1e6:.0f}" for end in _KNOWN)
        raise DeclarationError(
            f"sensitivity: known for steels with an ultimate strength of {ends} MPa, got"
            f" {ultimate / 1e6:g} MPa"
        )
    root = sum(c * strength**power for power, c in enumerate(_NEUBER))
    return 1.0 / (1.0 + root / math.sqrt(radius / _INCH))


def _fitted(load: str, fit: _Fit, wide: float, narrow: float, radius: float) -> float:
    """A factor by a fit; none is below 1."""
    depth = (wide - narrow) / 2
    ratio, share = depth / radius, 2 * depth / wide
    if not fit[0][0] <= ratio <= fit[-1][1]:
        more = ", or give its factor as shear" if load == "torsion" else ""
        raise DeclarationError(
            f"shoulder: for {load} the depth of the step over the radius must be from {fit[0][0]:g}"
            f" to {fit[-1][1]:g}, got {ratio:.4g}{more}"
        )
    rows = next(rows for _, high, rows in fit if ratio <= high)
    return max(
        1.0,
        sum((a + b * math.sqrt(ratio) + c * ratio) * share**k for k, (a, b, c) in enumerate(rows)),
    )
