"""Cross-sections of thin walls: I, T, C, box, and hollow sections with rounded corners.

Second moments are exact for their rectangles, without fillets. Torsion of open ones is the sum of
their rectangles', of a box Bredt's; shear stresses are the flows of thin walls, V Q / (I t), and of
torsion T t / It in open walls, T / (2 A_m t) in closed ones (Young and Budynas, *Roark's Formulas
for Stress and Strain*, chapters 8 to 10). Warping that is held adds nothing. Shear areas are those
of the walls along the force. Hollow sections have the formulas of EN 10210-2 and EN 10219-2: exact
second moments of the rounded outlines, and torsion by the middle line.
"""

from __future__ import annotations

import itertools
from math import cos, pi, sin

from ...base.arrays import Operand
from .properties import ALONG_Y, ALONG_Z, Fibre, Properties, smaller
from .solid import rectangle_torsion


def i_section(height: Operand, width: Operand, web: Operand, flange: Operand) -> Properties:
    """An I: its web along y, two flanges of one width along z."""
    h, b, hw = height, width, height - 2 * flange
    area = 2 * b * flange + hw * web
    iz = 2 * b * flange * ((h - flange) ** 2 / 4 + flange**2 / 12) + web * hw**3 / 12
    iy = (2 * flange * b**3 + hw * web**3) / 12
    torsion = 2 * rectangle_torsion(b, flange) + rectangle_torsion(hw, web)
    at_flange = b * flange * (h - flange) / 2
    in_middle = at_flange + web * hw**2 / 8
    fibres = [
        Fibre(f"corner {up} {aside}", i * h / 2, j * b / 2)
        for (i, up), (j, aside) in itertools.product(ALONG_Y, ALONG_Z)
    ]
    for (i, up), (j, aside) in itertools.product(ALONG_Y, ALONG_Z):
        along = (i * j * b * (h - flange) / (4 * iz), b**2 / (8 * iy), i * flange / torsion)
        name = f"flange {up} at the web {aside}"
        fibres.append(Fibre(name, i * h / 2, j * web / 2, along_z=along))
        down = (at_flange / (iz * web), 0.0, -j * web / torsion)
        fibres.append(Fibre(f"web {up} {aside}", i * hw / 2, j * web / 2, down))
    for j, aside in ALONG_Z:
        down = (in_middle / (iz * web), 0.0, -j * web / torsion)
        fibres.append(Fibre(f"middle of the web {aside}", 0.0, j * web / 2, down))
    return Properties(
        area,
        iy,
        iz,
        tuple(fibres),
        torsion=torsion,
        shear_y=(h - flange) * web,
        shear_z=5 / 3 * b * flange,
    )


def t_section(height: Operand, width: Operand, web: Operand, flange: Operand) -> Properties:
    """A T: its flange on the side of +y, its web below."""
    b, hw = width, height - flange
    area = b * flange + hw * web
    low = (web * hw**2 / 2 + b * flange * (hw + flange / 2)) / area
    top, middle = height - low, height - low - flange / 2
    iz = (
        web * hw**3 / 12
        + web * hw * (low - hw / 2) ** 2
        + b * flange**3 / 12
        + b * flange * middle**2
    )
    iy = (flange * b**3 + hw * web**3) / 12
    torsion = rectangle_torsion(b, flange) + rectangle_torsion(hw, web)
    at_flange, neutral = b * flange * middle, smaller(0.0, hw - low)
    inside = web * (low + neutral) * (low - neutral) / 2
    fibres = []
    for j, side in ALONG_Z:
        fibres.append(Fibre(f"corner +y {side}", top, j * b / 2))
        fibres.append(Fibre(f"foot of the web {side}", -low, j * web / 2))
        along = (j * b * middle / (2 * iz), b**2 / (8 * iy), flange / torsion)
        fibres.append(Fibre(f"flange at the web {side}", top, j * web / 2, along_z=along))
        twist = -j * web / torsion
        down = (at_flange / (iz * web), 0.0, twist)
        fibres.append(Fibre(f"web at the flange {side}", hw - low, j * web / 2, down))
        fibres.append(Fibre(f"web {side}", neutral, j * web / 2, (inside / (iz * web), 0.0, twist)))
    return Properties(
        area,
        iy,
        iz,
        tuple(fibres),
        torsion=torsion,
        shear_y=height * web,
        shear_z=5 / 6 * b * flange,
        centre_y=middle,
    )


def c_section(height: Operand, width: Operand, web: Operand, flange: Operand) -> Properties:
    """A C: its web along y on the side of -z, its flanges towards +z; the shear centre is beyond
    the web.
    """
    h, b, hw = height, width, height - 2 * flange
    area = 2 * b * flange + hw * web
    back = (flange * b**2 + hw * web**2 / 2) / area
    tip = b - back
    iz = 2 * b * flange * ((h - flange) ** 2 / 4 + flange**2 / 12) + web * hw**3 / 12
    iy = (
        2 * (flange * b**3 / 12 + b * flange * (b / 2 - back) ** 2)
        + hw * web**3 / 12
        + hw * web * (back - web / 2) ** 2
    )
    torsion = 2 * rectangle_torsion(b, flange) + rectangle_torsion(hw, web)
    wide, high = b - web / 2, h - flange
    centre = -(back - web / 2) - wide**2 * high**2 * flange / (4 * iz)
    at_flange = b * flange * high / 2
    in_middle = at_flange + web * hw**2 / 8
    fibres = []
    for i, side in ALONG_Y:
        twist = i * flange / torsion
        fibres.append(Fibre(f"tip of the flange {side}", i * h / 2, tip))
        along = (i * wide * high / (2 * iz), tip**2 / (2 * iy), twist)
        fibres.append(Fibre(f"back {side}", i * h / 2, -back, along_z=along))
        along = (i * tip * high / (2 * iz), tip**2 / (2 * iy), twist)
        fibres.append(Fibre(f"flange {side}", i * h / 2, 0.0, along_z=along))
    for j, z, face in ((1, web - back, "inside"), (-1, -back, "back")):
        twist = -j * web / torsion
        for i, side in ALONG_Y:
            flow = (at_flange / (iz * web), 0.0, twist)
            fibres.append(Fibre(f"{face} of the web {side}", i * hw / 2, z, flow))
        fibres.append(
            Fibre(f"{face} of the web, middle", 0.0, z, (in_middle / (iz * web), 0.0, twist))
        )
    return Properties(
        area,
        iy,
        iz,
        tuple(fibres),
        torsion=torsion,
        shear_y=high * web,
        shear_z=5 / 3 * b * flange,
        centre_z=centre,
    )


def box(height: Operand, width: Operand, web: Operand, flange: Operand) -> Properties:
    """A box: two webs along y, two flanges along z."""
    h, b, hi, bi = height, width, height - 2 * flange, width - 2 * web
    area = 2 * (b * flange + hi * web)
    iz = 2 * b * flange * ((h - flange) ** 2 / 4 + flange**2 / 12) + 2 * web * hi**3 / 12
    iy = 2 * h * web * ((b - web) ** 2 / 4 + web**2 / 12) + 2 * flange * bi**3 / 12
    wide, high = b - web, h - flange
    inside = wide * high
    torsion = 4 * inside**2 / (2 * wide / flange + 2 * high / web)
    flange_first, web_first = b * flange * high / 2, h * web * wide / 2
    fibres = []
    for (i, up), (j, aside) in itertools.product(ALONG_Y, ALONG_Z):
        where, twist = f"{up} {aside}", 1 / (2 * inside)
        in_web = (flange_first / (2 * iz * web), -i * j * h * wide / (4 * iy), -j * twist / web)
        in_flange = (
            -i * j * b * high / (4 * iz),
            web_first / (2 * iy * flange),
            i * twist / flange,
        )
        fibres.append(Fibre(f"corner {where}, web", i * h / 2, j * b / 2, in_web))
        fibres.append(Fibre(f"corner {where}, flange", i * h / 2, j * b / 2, along_z=in_flange))
    for (s, up), (_, aside) in zip(ALONG_Y, ALONG_Z, strict=True):
        deep = (flange_first + web * hi**2 / 4) / (2 * iz * web)
        down = (deep, 0.0, -s / (2 * inside * web))
        fibres.append(Fibre(f"web {aside}", 0.0, s * b / 2, down))
        deep = (web_first + flange * bi**2 / 4) / (2 * iy * flange)
        along = (0.0, deep, s / (2 * inside * flange))
        fibres.append(Fibre(f"flange {up}", s * h / 2, 0.0, along_z=along))
    return Properties(
        area,
        iy,
        iz,
        tuple(fibres),
        torsion=torsion,
        shear_y=2 * high * web,
        shear_z=2 * wide * flange,
    )


def hollow_section(
    height: Operand,
    width: Operand,
    wall: Operand,
    outer_radius: Operand,
    inner_radius: Operand,
    *,
    space: bool,
) -> Properties:
    """A rectangular hollow section; in space fibres are every 22.5 degrees around its corners, in
    the plane at the ends of the sides. Names have the angle of the outward normal from the y axis.
    """
    h, b, t, middle = height, width, wall, (outer_radius + inner_radius) / 2
    outlines = [(h, b, outer_radius, 1), (h - 2 * t, b - 2 * t, inner_radius, -1)]
    area, iz, iy, half_y, half_z = (
        sum(sign * _rounded(x, y, r)[k] for x, y, r, sign in outlines) for k in range(5)
    )
    high, wide, lost = h - t, b - t, (4 - pi) * middle
    length, inside = 2 * (high + wide) - 2 * lost, high * wide - lost * middle
    ring = 2 * inside * t / length
    torsion = t**3 * length / 3 + 2 * ring * inside
    twist = (t + ring / t) / torsion
    fibres = []
    for (i, up), (j, aside) in itertools.product(ALONG_Y, ALONG_Z):
        for angle in (0.0, 22.5, 45.0, 67.5, 90.0) if space else (0.0, 90.0):
            c, s = (round(f(angle * pi / 180), 15) for f in (cos, sin))
            by_y = _around_corner(high, wide, t, middle, s, angle) / (iz * t)
            by_z = _around_corner(wide, high, t, middle, c, 90.0 - angle) / (iy * t)
            fibres.append(
                Fibre(
                    f"corner {up} {aside}, {angle:g} deg",
                    i * (h / 2 - outer_radius * (1 - c)),
                    j * (b / 2 - outer_radius * (1 - s)),
                    (s * by_y, -i * j * s * by_z, -j * s * twist),
                    (-i * j * c * by_y, c * by_z, i * c * twist),
                )
            )
    for (s, up), (_, aside) in zip(ALONG_Y, ALONG_Z, strict=True):
        in_web, in_flange = half_y / (2 * iz * t), half_z / (2 * iy * t)
        fibres.append(Fibre(f"side {aside}", 0.0, s * b / 2, (in_web, 0.0, -s * twist)))
        fibres.append(Fibre(f"side {up}", s * h / 2, 0.0, along_z=(0.0, in_flange, s * twist)))
    return Properties(
        area, iy, iz, tuple(fibres), torsion=torsion, shear_y=2 * high * t, shear_z=2 * wide * t
    )


def hollow_area(
    height: Operand, width: Operand, wall: Operand, outer_radius: Operand, inner_radius: Operand
) -> Operand:
    """Area of a rectangular hollow section."""
    inner = _rounded(height - 2 * wall, width - 2 * wall, inner_radius)
    return _rounded(height, width, outer_radius)[0] - inner[0]


def _rounded(height: Operand, width: Operand, radius: Operand) -> tuple[Operand, ...]:
    """A rectangle with rounded corners: its area, second moments about z and about y, and first
    moments of its halves about z and about y.
    """
    # What a rounded corner lacks of a square: its area, its centroid from the sides, its moment.
    lack, away = (1 - pi / 4) * radius**2, (10 - 3 * pi) / (12 - 3 * pi) * radius
    own = (1 / 3 - pi / 16 - 1 / (36 - 9 * pi)) * radius**4
    at_y, at_z = height / 2 - away, width / 2 - away
    return (
        height * width - 4 * lack,
        width * height**3 / 12 - 4 * (own + lack * at_y**2),
        height * width**3 / 12 - 4 * (own + lack * at_z**2),
        width * height**2 / 8 - 2 * lack * at_y,
        height * width**2 / 8 - 2 * lack * at_z,
    )


def _around_corner(
    high: Operand, wide: Operand, wall: Operand, radius: Operand, s: float, angle: float
) -> Operand:
    """First moment of the wall from the middle of a side to a place on the rounded corner, by the
    middle line, about the parallel axis; ``angle`` [deg] from the normal of the side, ``s`` its
    sine.
    """
    side, centre = wide / 2 - radius, high / 2 - radius
    return wall * (side * high / 2 + radius * (centre * (angle * pi / 180) + radius * s))
