"""Full and round cross-sections: closed forms of rectangle, ellipse, round bar and tube, and of any
polygon.

Sources: torsion of the rectangle is the whole series of Timoshenko and Goodier, *Theory of
Elasticity*, art. 109, summed so that a few terms give all digits; that of the ellipse art. 107.
Shear stresses are Jourawski's, V Q / (I b); on the edge of an oval they lie along it. Shear areas
are Cowper's (*The shear coefficient in Timoshenko's beam theory*, J. Appl. Mech. 33, 1966).
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from math import cos, pi, sin
from typing import Any

from ...base.arrays import Operand
from .properties import (
    ALONG_Y,
    ALONG_Z,
    POISSON,
    Fibre,
    Properties,
    chosen,
    exponential,
    larger,
    smaller,
)

_APART = 1e-300
"""Below this two corners have one place across."""

_FIFTH, _CATALAN = 1.0045237627951398, 0.9159655941772190
"""The sum of 1/n^5 over odd n, 31 zeta(5)/32; and that of 1/n^2 with signs by turns."""

_ODD = range(1, 25, 2)

_Corner = tuple[Operand, Operand]


def rectangle(height: float, width: float) -> Properties:
    """A rectangle: nine fibres, at its corners, the middles of its sides and its centre."""
    area, torsion = height * width, rectangle_torsion(height, width)
    # The twist of a unit moment, 1/torsion, and the stress it makes in the middles of the long and
    # of the short sides.
    long, short = (share / torsion for share in _twisted(height, width))
    beside, above = chosen(height, width, long, short), chosen(height, width, short, long)
    shear = 1.5 / area
    fibres = [
        Fibre(f"corner {up} {aside}", i * height / 2, j * width / 2)
        for (i, up), (j, aside) in itertools.product(ALONG_Y, ALONG_Z)
    ]
    fibres += [
        Fibre(f"side {aside}", 0.0, j * width / 2, (shear, 0.0, -j * beside))
        for j, aside in ALONG_Z
    ]
    fibres += [
        Fibre(f"side {up}", i * height / 2, 0.0, along_z=(0.0, shear, i * above))
        for i, up in ALONG_Y
    ]
    fibres.append(Fibre("centre", 0.0, 0.0, (shear, 0.0, 0.0), (0.0, shear, 0.0)))
    stiff = 10 * (1 + POISSON) / (12 + 11 * POISSON) * area
    iy, iz = height * width**3 / 12, width * height**3 / 12
    return Properties(area, iy, iz, tuple(fibres), torsion=torsion, shear_y=stiff, shear_z=stiff)


def rectangle_torsion(a: Operand, b: Operand) -> Operand:
    """Saint-Venant's constant of a rectangle [m^4]."""
    long, short = larger(a, b), smaller(a, b)
    waves = [exponential(-n * pi * long / short) for n in _ODD]
    rest = sum(2 * w / (1.0 + w) / n**5 for n, w in zip(_ODD, waves, strict=True))
    return long * short**3 / 3 * (1.0 - 192 / pi**5 * (short / long) * (_FIFTH - rest))


def _twisted(a: float, b: float) -> tuple[float, float]:
    """The shear stress in the middle of a long and of a short side, over G times the twist per
    length [m].
    """
    long, short = larger(a, b), smaller(a, b)
    waves = [exponential(-n * pi * long / (2 * short)) for n in _ODD]
    deep = sum(2 * w / (1.0 + w * w) / n**2 for n, w in zip(_ODD, waves, strict=True))
    rest = sum(
        (-1) ** k * 2 * w * w / (1.0 + w * w) / n**2
        for k, (n, w) in enumerate(zip(_ODD, waves, strict=True))
    )
    return short * (1.0 - 8 / pi**2 * deep), short * 8 / pi**2 * (_CATALAN - rest)


def ellipse(height: Operand, width: Operand, *, space: bool) -> Properties:
    """An ellipse, by its two diameters; in space fibres are every 15 degrees around it, in the
    plane at the ends of its axes.
    """
    a, c = height / 2, width / 2
    area = pi * a * c
    fibres = [Fibre("centre", 0.0, 0.0, (4 / 3 / area, 0.0, 0.0), (0.0, 4 / 3 / area, 0.0))]
    for angle, y, z in _around(space):
        torsion = -2.0 * z / (pi * a * c * c), 2.0 * y / (pi * a * a * c)
        fibres.append(_edge(angle, a * y, c * z, y, z, 4 / 3 / area, c / a, torsion))
    constant = pi * a**3 * c**3 / (a * a + c * c)
    iy, iz = pi * a * c**3 / 4, pi * c * a**3 / 4
    return Properties(
        area,
        iy,
        iz,
        tuple(fibres),
        torsion=constant,
        shear_y=_elliptic(a / c) * area,
        shear_z=_elliptic(c / a) * area,
    )


def _elliptic(n: Operand) -> Operand:
    v = POISSON
    return 12 * (1 + v) * n**2 * (3 * n**2 + 1) / ((40 + 37 * v) * n**4 + (16 + 10 * v) * n**2 + v)


def tube(diameter: Operand, wall: Operand, *, space: bool) -> Properties:
    """A round tube by its outer diameter and its wall, whatever its thickness."""
    outer, inner = diameter / 2, diameter / 2 - wall
    square, area = outer**2 + inner**2, pi * wall * (outer + inner)
    moment = area * square / 4
    most = 4 / 3 * (outer**2 + outer * inner + inner**2) / square / area
    fibres = []
    for angle, y, z in _around(space):
        torsion = -outer * z / (2 * moment), outer * y / (2 * moment)
        fibres.append(_edge(angle, outer * y, outer * z, y, z, most, 1.0, torsion))
    v, m = POISSON, inner / outer
    stiff = (
        6
        * (1 + v)
        * (1 + m**2) ** 2
        / ((7 + 6 * v) * (1 + m**2) ** 2 + (20 + 12 * v) * m**2)
        * area
    )
    return Properties(
        area, moment, moment, tuple(fibres), torsion=2 * moment, shear_y=stiff, shear_z=stiff
    )


def _around(space: bool) -> list[tuple[int, float, float]]:
    """Angles from y towards z [degrees], with cosine and sine."""
    return [
        (k, round(cos(k * pi / 180), 15), round(sin(k * pi / 180), 15))
        for k in range(0, 360, 15 if space else 90)
    ]


def _edge(
    angle: int,
    y: Operand,
    z: Operand,
    c: float,
    s: float,
    most: Operand,
    slope: Operand,
    torsion: tuple[Operand, Operand],
) -> Fibre:
    """A fibre on the edge of an oval, where shear stresses lie along the edge."""
    aside = -most * s * c
    along_y = (most * s * s, aside / slope, torsion[0])
    along_z = (aside * slope, most * c * c, torsion[1])
    return Fibre(f"{angle} deg", y, z, along_y, along_z)


def polygon(places: Sequence[_Corner]) -> Properties:
    """Any polygon without holes, by its corners counter-clockwise, y to the right and z up; about
    its own centroid.

    Fibres are its corners, and the centroid, where shear is V Q / (I b) with the whole width there.
    Torsion is not known.
    """
    area, centroid, (iy, iz, iyz) = polygon_moments(places)
    moved = [(y - centroid[0], z - centroid[1]) for y, z in places]
    fibres = [Fibre(f"corner {k + 1}", y, z) for k, (y, z) in enumerate(moved)]
    shear = [
        _shear_at_centroid([(p[k], p[1 - k]) for p in moved], i) for k, i in ((0, iz), (1, iy))
    ]
    fibres.append(Fibre("centroid", 0.0, 0.0, (shear[0], 0.0, 0.0), (0.0, shear[1], 0.0)))
    stiff = 5 / 6 * area
    return Properties(area, iy, iz, tuple(fibres), iyz=iyz, shear_y=stiff, shear_z=stiff)


def polygon_area(places: Sequence[_Corner]) -> Operand:
    """Area of a polygon, positive if the corners go round counter-clockwise."""
    y0, z0 = places[0]
    return _integrals([(y - y0, z - z0) for y, z in places], lambda a, b: 1 / 2)[0]


def polygon_moments(
    places: Sequence[_Corner],
) -> tuple[Operand, _Corner, tuple[Operand, Operand, Operand]]:
    """Area of a polygon, its centroid, and about that the integrals of z^2, y^2 and y z; all
    integrals are negative if the corners go round clockwise.

    Seen from the first corner, so that a polygon far from its axes loses no digits.
    """
    y0, z0 = places[0]
    ring = [(y - y0, z - z0) for y, z in places]
    area, *first = _integrals(
        ring, lambda a, b: 1 / 2, lambda a, b: (a[0] + b[0]) / 6, lambda a, b: (a[1] + b[1]) / 6
    )
    y, z = (part / area for part in first)
    iy, iz, iyz = _integrals(
        [(a - y, b - z) for a, b in ring],
        lambda a, b: (a[1] ** 2 + a[1] * b[1] + b[1] ** 2) / 12,
        lambda a, b: (a[0] ** 2 + a[0] * b[0] + b[0] ** 2) / 12,
        lambda a, b: (a[0] * b[1] + 2 * a[0] * a[1] + 2 * b[0] * b[1] + b[0] * a[1]) / 24,
    )
    return area, (y0 + y, z0 + z), (iy, iz, iyz)


def _integrals(
    places: Sequence[_Corner], *terms: Callable[[_Corner, _Corner], Operand]
) -> list[Operand]:
    """The sum over the sides of a polygon of a x b times a term of both ends a and b."""
    sides = list(zip(places, [*places[1:], places[0]], strict=True))
    return [sum((a[0] * b[1] - b[0] * a[1]) * term(a, b) for a, b in sides) for term in terms]


def _shear_at_centroid(places: Sequence[tuple[Operand, Operand]], moment: Operand) -> Operand:
    """Q / (I b) at the line x = 0 of a polygon whose corners are (x, across); of numbers, arrays or
    expressions.
    """
    first: Any = 0.0
    width: Any = 0.0
    for (x1, w1), (x2, w2) in zip(places, [*places[1:], places[0]], strict=True):
        apart = chosen(abs(x2 - x1), _APART, x2 - x1, 1.0)
        crossing = w1 + (w2 - w1) * (0.0 - x1) / apart
        width = width + _beyond(x2, _beyond(x1, 0.0, crossing), _beyond(x1, -crossing, 0.0))
        # The first moment of the part with x > 0, by the integral of x^2/2 along its sides.
        a, b = larger(x1, 0.0), larger(x2, 0.0)
        start, stop = _beyond(x1, w1, crossing), _beyond(x2, w2, crossing)
        first = first + (stop - start) * (a * a + a * b + b * b) / 6
    return abs(first) / (moment * abs(width))


def _beyond(x: Operand, there: Operand, here: Operand) -> Operand:
    """``there`` where x is positive, else ``here``."""
    return chosen(-x, 0.0, here, there)
