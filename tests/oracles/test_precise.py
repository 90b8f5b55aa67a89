"""The planar oracle in many digits, against a reference from outside."""

import math

import oracle
from arithmetic import Digits
from conftest import SIXTY_DIGITS


def test_every_digit_of_a_reference_from_outside():
    """The paper's mechanism in decimals, as the reference of :mod:`test_reference` has it, to the
    25 digits it prints.
    """
    arithmetic = Digits(40)
    r, l, m1, m2, m3, g = (
        arithmetic.number(SIXTY_DIGITS["parameters"][name])
        for name in ("r", "l", "m1", "m2", "m3", "g")
    )
    crank, rod = (
        oracle.from_density(name, length, lambda u, mass=mass: mass, arithmetic=arithmetic)
        for name, length, mass in (("crank", r, m1), ("rod", l, m2))
    )
    joints = [
        oracle.Joint("O", "revolute", ("ground", 0, 0), ("crank", 0, 0)),
        oracle.Joint("A", "revolute", ("crank", r, 0), ("rod", 0, 0)),
        oracle.Joint("B", "revolute", ("rod", l, 0), ("slider", 0, 0)),
        oracle.Joint("guide", "prismatic", ("ground", 0, 0), ("slider", 0, 0)),
    ]
    linkage = oracle.Oracle(
        [crank, rod, oracle.Body("slider", m3, oriented=False)],
        joints,
        (0, -g),
        arithmetic=arithmetic,
    )
    omega, epsilon = 25 * arithmetic.context.pi, arithmetic.context.pi / 100
    gaps, size = {}, {}
    for row in SIXTY_DIGITS["rows"]:
        t = arithmetic.number(row["t"])
        theta = omega * t + epsilon * t**2 / 2
        a, b = 0.1 * math.cos(theta), 0.1 * math.sin(theta)
        slope = -math.asin(b / 0.2)
        guess = {
            "crank": (0, 0, theta),
            "rod": (a, b, slope),
            "slider": (a + 0.2 * math.cos(slope), 0, 0),
        }
        found = linkage.solve({"O": (theta, omega + epsilon * t, epsilon)}, guess)
        on_rod, on_slider = found.reactions["A"], found.reactions["B"]
        sections = [
            [-force for force in found.sections["rod"](x)]
            for x in map(arithmetic.number, SIXTY_DIGITS["xi_over_l"])
        ]
        named = {
            "torque_O": [found.efforts["O"]],
            "guide_on_slider": [found.reactions["guide"][1]],
            "crank_on_rod_A": on_rod[:2],
            "slider_on_rod_B": [-force for force in on_slider[:2]],
        } | dict(zip(("R_axial", "R_shear", "R_bending"), zip(*sections, strict=True), strict=True))
        for name, values in named.items():
            expected = [
                arithmetic.number(text)
                for text in (row[name] if isinstance(row[name], list) else [row[name]])
            ]
            size[name] = max(size.get(name, 0), *map(abs, expected))
            gaps[name] = max(
                gaps.get(name, 0), *(abs(x - y) for x, y in zip(values, expected, strict=True))
            )
    assert set(gaps) == {name for name in row if name not in ("t", "theta")}
    for name, gap in gaps.items():
        assert gap < 1e-24 * size[name], name
