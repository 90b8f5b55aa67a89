"""What acts in the cases beside joints and weights, written again for the oracle, in any
arithmetic.
"""

from __future__ import annotations

import bisect
import math

import oracle
from jets import Jet, functions

ANGLES = (
    0,
    20,
    180,
    220,
    260,
    300,
    320,
    335,
    350,
    360,
    368,
    375,
    390,
    410,
    440,
    480,
    520,
    540,
    560,
    600,
    700,
    720,
)
PRESSURES = (
    0.3,
    -0.2,
    -0.2,
    0.1,
    0.9,
    3.4,
    6.5,
    10.5,
    18,
    27,
    42,
    45,
    30,
    15,
    6.5,
    3.2,
    2.0,
    1.4,
    0.6,
    0.3,
    0.3,
    0.3,
)


def of_case(name, arithmetic, values):
    """What the oracle of a case needs beside its mechanism, at the parameters' values: loads,
    extras and unaided drives.
    """
    return _CASES[name](arithmetic, values) if name in _CASES else {}


def _read(at, of, x):
    """A table by straight lines."""
    i = min(max(bisect.bisect_right(at, x), 1), len(at) - 1)
    return of[i - 1] + (of[i] - of[i - 1]) / (at[i] - at[i - 1]) * (x - at[i - 1])


def _engine(arithmetic, values):
    """The gas's force on the piston: the table over the crank's angle, which only grows."""
    number = arithmetic.number
    pi, bore = number(math.pi), number(values["bore"])
    angles, pressures = ([number(x) for x in row] for row in (ANGLES, PRESSURES))

    def gas(place):
        turned = (place(("crank", 0, 0))[2].v - pi / 2) % (4 * pi) * 180 / pi
        pressure = 100_000 * _read(angles, pressures, turned)
        return [(("piston", 0, 0), 0, -pressure * pi / 4 * bore**2, 0)]

    return {"loads": [gas]}


def _connecting_rod(arithmetic, values):
    """The same diagram, of another largest pressure."""
    number = arithmetic.number
    share = number(values["pressure"]) / 45 / 100_000
    (gas,) = _engine(arithmetic, values)["loads"]
    return {"loads": [lambda place: [(point, x, share * y, z) for point, x, y, z in gas(place)]]}


def _v_twin(arithmetic, values):
    """The gas's force on either piston, along the cylinder."""
    number, cos, sin = arithmetic.number, arithmetic.cos, arithmetic.sin
    bore = number(values["bore"])

    def gas(side, way, x, y):
        def pushes(place):
            turned = place(("crank", 0, 0))[2].v - number(way)
            diagram = (
                number(3.0)
                + number(2.5) * cos(turned)
                - number(1.75) * sin(turned)
                + number(0.5) * cos(2 * turned)
            )
            push = -100_000 * diagram * number(math.pi) / 4 * bore**2
            return [((f"{side}_piston", 0, 0), push * x, push * y, 0)]

        return pushes

    return {"loads": [gas("left", math.pi / 2, 0, 1), gas("right", 0.0, 1, 0)]}


def _quick_return(arithmetic, values):
    cutting = arithmetic.number(values["cutting"])

    def cut(place):
        return [(("ram", 0, 0), -cutting * (place(("ram", 0, 0))[0].d > 0), 0, 0)]

    return {"loads": [cut]}


def _pressed(heights, shares, force, held=""):
    """A force on the ram on its way down, by a table of the height that holds its values beyond its
    ends; and a counterbalance of a mass that is ``held``.
    """

    def beside(arithmetic, values):
        number = arithmetic.number
        at, of = ([number(x) for x in row] for row in (heights, shares))

        def part(place):
            _, y, _ = place(("ram", 0, 0))
            height = 1000 * (number(values["r"]) + number(values["l"]) + y.v)
            height = min(max(height, at[0]), at[-1])
            acts = _read(at, of, height) if y.d < 0 else number(0)
            weight = number(values[held]) * number(9.81) if held else number(0)
            return [(("ram", 0, 0), 0, number(values[force]) * acts + weight, 0)]

        return {"loads": [part]}

    return beside


def _andrews_squeezer(arithmetic, values):
    number = arithmetic.number
    foot, end = ("ground", number(0.014), number(0.072)), ("k3", number(0.018), number(0.02))
    return {"loads": [_spring(arithmetic, foot, end, 4530, number(0.07785))]}


def _spring(arithmetic, foot, end, stiffness, free):
    """From the ground to a point of a body."""

    def pull(place):
        dx, dy = (b.v - a.v for a, b in zip(place(foot)[:2], place(end)[:2], strict=True))
        length = arithmetic.sqrt(dx * dx + dy * dy)
        size = -stiffness * (length - free) / length
        return [(end, size * dx, size * dy, 0)]

    return pull


def _sleigh(arithmetic, values):
    def effect(place):
        phi = place(("body", 0, 0))[2].v
        return [(("body", 0, 0), -arithmetic.sin(phi), arithmetic.cos(phi), 0)]

    return {"extras": [oracle.Extra("blade", None, effect)], "unaided": ["Y"]}


def _jansen_leg(arithmetic, values):
    number = arithmetic.number
    base, near, far = 36.7 / 100, 49 / 100, 65.7 / 100
    x = (base**2 + near**2 - far**2) / (2 * base)
    foot = ("shin", number(x), number(math.sqrt(near**2 - x**2)))
    return {"loads": [lambda place: [(foot, 0, number(values["push"]), 0)]]}


def _excavator(arithmetic, values):
    number = arithmetic.number
    teeth, digging = ("bucket", number(1.4), 0), number(values["digging"])
    return {"loads": [lambda place: [(teeth, digging, 0, 0)]]}


def _beam_pump(arithmetic, values):
    """The bridle leaves the head's arc upright, and pays out the radius times the beam's angle."""
    number = arithmetic.number
    radius, fluid = number(33) / 10, number(values["fluid"])
    rods, head, axle = ("rods", 0, 0), ("head", 0, 0), ("head", number(0.5 - 3.3), 0)

    def lift(place):
        return [(rods, 0, -fluid * (place(rods)[1].d > 0), 0)]

    def gap(place):
        return place(rods)[1] - place(axle)[1] - place(head)[2] * radius + 3

    bridle = oracle.Extra(
        "bridle", gap, lambda place: [(rods, 0, 1, 0), (axle, 0, -1, 0), (head, 0, 0, -radius)]
    )
    return {"loads": [lift], "extras": [bridle]}


def _scara(arithmetic, values):
    """A belt that ties the directions of the pulley and the outer arm."""
    pulley, outer = ("pulley", 0, 0), ("outer", 0, 0)
    belt = oracle.Extra(
        "belt",
        lambda place: place(pulley)[2] - place(outer)[2],
        lambda place: [(pulley, 0, 0, 1), (outer, 0, 0, -1)],
    )
    return {"extras": [belt]}


def _roller_cam(arithmetic, values):
    """The contact along the normal of the pitch curve, from the lift's formulas; and the spring."""
    number, sqrt = arithmetic.number, arithmetic.sqrt
    sin, cos = (functions(arithmetic)[name] for name in ("sin", "cos"))
    pi, h, offset = number(math.pi), number(values["lift"]), number(values["offset"])
    up, top, back = (angle * pi / 180 for angle in (100, 20, 150))
    prime = number(values["base"]) + number(12) / 1000
    least = sqrt(prime * prime - offset * offset)
    stem, cam = ("stem", 0, 0), ("cam", 0, 0)

    def rise(turn):
        """The lift and its slope at an angle, a jet."""
        at = turn.v % (2 * pi)
        inside = turn - (turn.v - at)
        if at < up:
            u, sign, start, width = inside / up, 1, 0, up
        elif at < up + top or at >= up + top + back:
            return inside * 0 + (h if at < up + top else 0), inside * 0
        else:
            u, sign, start, width = (inside - up - top) / back, -1, h, back
        return (u - sin(u * (2 * pi)) / (2 * pi)) * (sign * h) + start, (1 - cos(u * (2 * pi))) * (
            sign * h / width
        )

    def lean(place):
        """Where the roller is, and how far it goes aside as it rises on the cam, of jets."""
        s, slope = rise(Jet(place(cam)[2].v, place(cam)[2].d, place(cam)[2].a))
        return s + least, (slope - offset) / (s + least)

    def gap(place):
        height, tangent = lean(place)
        return place(stem)[1] - height - tangent * (place(stem)[0] - offset)

    def effect(place):
        height, tangent = (x.v for x in lean(place))
        size = sqrt(1 + tangent * tangent)
        x, y = -tangent / size, 1 / size
        return [(stem, x, y, 0), (cam, -x, -y, -(offset * y - height * x))]

    def spring(place):
        length = place(stem)[1].v - least
        return [
            (
                ("stem", number(11) / 100, number(3) / 1000),
                0,
                -number(values["preload"]) - number(values["stiffness"]) * length,
                0,
            )
        ]

    return {"loads": [spring], "extras": [oracle.Extra("contact", gap, effect)]}


def _planetary_gear(arithmetic, values):
    """Teeth as forces at pitch points, their flanks those that the load presses; the sun pushes all
    planets alike; and the load.
    """
    number = arithmetic.number
    sin = arithmetic.sin
    cos = arithmetic.cos
    pi = arithmetic.number(math.pi)
    tangent, module = sin(pi / 9) / cos(pi / 9), number(values["module"])
    sun, planet, ring = (module * teeth / 2 for teeth in (24, 18, 60))
    carrier = ("carrier", 0, 0)

    def angle(place, name):
        return place((name, 0, 0))[2] - place(carrier)[2]

    def mesh(place, number_, first, second, radii, flank):
        turned = place(carrier)[2].v + 2 * pi * (number_ - 1) / 3
        c, s = cos(turned), sin(turned)
        x, y = -s - flank * tangent * c, c - flank * tangent * s
        return [((first, 0, 0), x, y, radii[0]), ((second, 0, 0), -x, -y, radii[1])]

    def inner(place):
        return [
            force
            for k in (1, 2, 3)
            for force in mesh(place, k, "sun", f"set_planet_{k}", (sun, planet), -1)
        ]

    def outer(k):
        name = f"set_planet_{k}"
        return oracle.Extra(
            f"set_ring_{k}",
            lambda place: angle(place, name) * planet - angle(place, "ring") * ring,
            lambda place: mesh(place, k, name, "ring", (planet, -ring), 1),
        )

    def stirred(place):
        return [
            (
                carrier,
                0,
                0,
                -number(values["torque"])
                * (1 + number(values["unsteady"]) * sin(4 * place(carrier)[2].v)),
            )
        ]

    first = oracle.Extra(
        "set_sun",
        lambda place: angle(place, "sun") * sun + angle(place, "set_planet_1") * planet,
        inner,
    )
    return {"loads": [stirred], "extras": [first, *(outer(k) for k in (1, 2, 3))]}


def _parallelogram_arm(arithmetic, values):
    """A spring from the base to the upper arm, and friction of both motors."""
    number, sqrt = arithmetic.number, arithmetic.sqrt
    base, point = ("ground", -number(15) / 100, number(25) / 100), ("upper", number(2) / 10, 0)
    spring = _spring(arithmetic, base, point, number(values["k_balance"]), number(1) / 10)

    def friction(joint, link):
        viscous, dry = (number(values[f"{kind}_{joint}"]) for kind in ("viscous", "dry"))

        def part(place):
            speed = place((link, 0, 0))[2].d
            size = viscous + dry / sqrt(speed * speed + number(4) / 10000)
            return [((link, 0, 0), 0, 0, -size * speed)]

        return part

    return {"loads": [spring, friction("shoulder", "upper"), friction("motor", "crank")]}


_CASES = {
    "parallelogram_arm": _parallelogram_arm,
    "planetary_gear": _planetary_gear,
    "connecting_rod": _connecting_rod,
    "v_twin": _v_twin,
    "engine": _engine,
    "quick_return": _quick_return,
    "andrews_squeezer": _andrews_squeezer,
    "sleigh": _sleigh,
    "jansen_leg": _jansen_leg,
    "excavator": _excavator,
    "beam_pump": _beam_pump,
    "scara": _scara,
    "roller_cam": _roller_cam,
    "servo_press": _pressed(
        (0, 5, 15, 30, 39, 40), (0.55, 0.7, 0.95, 1.0, 0.6, 0.0), "drawing", "mass"
    ),
    "punch_press": _pressed((7, 9.5, 10), (0, 1, 0), "punching"),
}
