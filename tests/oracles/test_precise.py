"""The oracle in many digits: against itself in fewer digits, and against closed forms; graphs are
held against it in test_formulas.
"""

import math

import mpmath
import numpy as np
import oracle
import pytest
from arithmetic import DOUBLE, Digits
from conftest import CASES, PLANAR, SIXTY_DIGITS
from internals import FORCES
from mechanisms import parallelogram, slider_crank
from precise import precise

from lagrange_casadi import evaluate, load_case

RATIOS = (0.0, 0.1234567, 0.5012345, 0.9034567, 1.0)


@pytest.mark.sampled(19)
@pytest.mark.parametrize("name", PLANAR)
def test_30_digits_are_the_first_of_50(name):
    """Of what has no digits beside the largest force, 30 leave 25 of that."""
    scene = load_case(CASES / name).scene
    start, stop, _ = scene.t
    for part in (0.0, 0.35, 0.8):
        more, fewer = (
            precise(scene, start + part * (stop - start), digits=digits) for digits in (50, 30)
        )
        assert set(more) == set(fewer)
        size = max(abs(value) for name, value in more.items() if name.startswith("reaction"))
        for quantity, value in more.items():
            pairs = (
                [(value(u), fewer[quantity](u)) for u in RATIOS]
                if callable(value)
                else [(value, fewer[quantity])]
            )
            for one, two in pairs:
                assert abs(one - two) <= 1e-25 * max(size, 1.0), quantity


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


def test_drives_of_many_digits_are_taken_as_they_are():
    """A slider-crank in closed form, at a third of pi that no double is."""
    scene, digits = slider_crank(), mpmath.MPContext()
    digits.dps = 60
    angle, r, l = digits.pi / 3, digits.mpf(0.1), digits.mpf(0.2)
    found = precise(scene, 1 / 75, {"O": (angle, 2, digits.mpf(1) / 7)})
    assert abs(found["pose:crank:angle"] - angle) < 1e-55
    place = r * digits.cos(angle) + digits.sqrt(l**2 - (r * digits.sin(angle)) ** 2)
    assert abs(found["pose:slider:x"] - place) < 1e-55


def test_what_is_undetermined_is_left_out():
    """Three cranks that turn together need the torque that lifts their centres and the bar's: a
    closed form for all digits.
    """
    scene = parallelogram(pendulum=False)
    found = precise(scene, 0.0)
    assert set(found).isdisjoint(evaluate(scene).undetermined)
    bent = {f"section:{crank}:{force}" for crank in "abc" for force in ("shear", "bending")}
    assert {
        name
        for name in found
        if name.startswith(("effort", "section", "reaction")) and found[name] != 0
    } == {"effort:O"} | bent
    digits = found["effort:O"].context
    crank, bar, length, gravity = map(digits.mpf, (0.3, 1.0, 0.2, 9.81))
    torque = (3 * crank / 2 + bar) * length * gravity * digits.cos(digits.mpf(0.7))
    assert abs(found["effort:O"] - torque) < 1e-50
    with_bob = precise(parallelogram(pendulum=True), 0.0)
    assert {name for name in with_bob if name.startswith("section")} == {
        f"section:bob:{force}" for force in FORCES
    } | bent


def test_loads_and_rows_must_be_given():
    with pytest.raises(AssertionError, match=r"declares \['gas'\]: give the oracle the same loads"):
        precise(load_case(CASES / "engine").scene, 0.01, beside=lambda arithmetic, values: {})


@pytest.mark.parametrize("arithmetic", [DOUBLE, Digits(50)])
def test_equations_that_agree_are_solved(arithmetic):
    """Five equations of rank two for three unknowns: what they determine comes out, whatever is
    chosen for the rest.
    """
    first, second = [3, 1, 0], [1, -2, 0]
    rows = [
        [k * a + n * b for a, b in zip(first, second, strict=True)]
        for k, n in ((1, 0), (0, 1), (2, 3), (1, -1), (0, 5))
    ]
    matrix = arithmetic.array([[arithmetic.number(x) for x in row] for row in rows])
    x, y, _ = arithmetic.solve(
        matrix,
        matrix @ arithmetic.array([arithmetic.number(1) / 3, arithmetic.number(2) / 7, 0]),
        1e-9,
    )
    assert abs(3 * x - 1) < 100 * arithmetic.tolerance
    assert abs(7 * y - 2) < 100 * arithmetic.tolerance


@pytest.mark.parametrize("arithmetic", [DOUBLE, Digits(50)])
def test_quadrature_is_exact_for_polynomials(arithmetic):
    nodes, weights = arithmetic.gauss
    for power in (0, 1, 4, 22, 23):
        integral = np.sum(weights * ((nodes + 1) / 2) ** power) / 2
        assert abs(integral * (power + 1) - 1) < 10 * arithmetic.tolerance
