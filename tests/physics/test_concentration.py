"""Factors of stress concentration against other published fits, solved problems, and limits that
are known exactly.
"""

import pytest
import strong

from lagrange_casadi import beams, evaluate
from lagrange_casadi.errors import DeclarationError

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]

# Norton, Machine Design, 2nd edition, figures E-1 to E-3: K = A (r/d)^b of round shafts with a
# shoulder, fits of older charts. Those of bending are lower by up to a twelfth.
NORTON = {
    "axial": (0.05, {1.2: (0.96272, -0.25527), 1.5: (0.99957, -0.28221), 2.0: (1.01470, -0.30035)}),
    "bending": (
        0.08,
        {1.2: (0.97098, -0.21796), 1.5: (0.93836, -0.25759), 2.0: (0.90879, -0.28598)},
    ),
    "shear": (
        0.05,
        {1.2: (0.83425, -0.21649), 1.33: (0.84897, -0.23161), 2.0: (0.86331, -0.23865)},
    ),
}


@pytest.mark.parametrize("load", NORTON)
@pytest.mark.parametrize("radius", [0.05, 0.1, 0.2])
def test_round_shoulders_are_those_of_another_fit(load, radius):
    apart, fits = NORTON[load]
    for ratio, (a, b) in fits.items():
        told = 0.25 <= (ratio - 1) / 2 / radius <= 4
        if load != "shear" or told:
            found = beams.shoulder(0.5, ratio, 1.0, radius, shear=None if told else 1.0)
            assert getattr(found, load) == pytest.approx(a * radius**b, rel=apart)


# Young and Budynas, Roark's Formulas for Stress and Strain, 7th edition, table 17.1: C1 to C4 by 1,
# sqrt(h/r) and h/r, up to h/r = 2 and beyond, fits of the same charts made anew; whether the bar is
# flat, the load, and h/r.
ROARK = {
    (True, "axial", 1.0): (
        (1.007, 1.000, -0.031),
        (-0.114, -0.585, 0.314),
        (0.241, -0.992, -0.271),
        (-0.134, 0.577, -0.012),
    ),
    (True, "axial", 5.0): (
        (1.042, 0.982, -0.036),
        (-0.074, -0.156, -0.010),
        (-3.418, 1.220, -0.005),
        (3.450, -2.046, 0.051),
    ),
    (True, "bending", 1.0): (
        (1.007, 1.000, -0.031),
        (-0.270, -2.404, 0.749),
        (0.677, 1.133, -0.904),
        (-0.414, 0.271, 0.186),
    ),
    (True, "bending", 5.0): (
        (1.042, 0.982, -0.036),
        (-3.599, 1.619, -0.431),
        (6.084, -5.607, 1.158),
        (-2.527, 3.006, -0.691),
    ),
    (False, "axial", 1.0): (
        (0.927, 1.149, -0.086),
        (0.011, -3.029, 0.948),
        (-0.304, 3.979, -1.737),
        (0.366, -2.098, 0.875),
    ),
    (False, "axial", 5.0): (
        (1.225, 0.831, -0.010),
        (-1.831, -0.318, -0.049),
        (2.236, -0.522, 0.176),
        (-0.630, 0.009, -0.117),
    ),
    (False, "bending", 1.0): (
        (0.927, 1.149, -0.086),
        (0.015, -3.281, 0.837),
        (0.847, 1.716, -0.506),
        (-0.790, 0.417, -0.246),
    ),
    (False, "bending", 5.0): (
        (1.225, 0.831, -0.010),
        (-3.790, 0.958, -0.257),
        (7.374, -4.834, 0.862),
        (-3.809, 3.046, -0.595),
    ),
}


@pytest.mark.parametrize("flat_load_depth", ROARK)
@pytest.mark.parametrize("ratio", [1.05, 1.2, 1.5, 2.0])
def test_shoulders_are_those_of_roarks_fit(flat_load_depth, ratio):
    flat, load, depth = flat_load_depth
    share = (ratio - 1) / ratio
    roark = sum(
        (a + b * depth**0.5 + c * depth) * share**k
        for k, (a, b, c) in enumerate(ROARK[flat_load_depth])
    )
    found = beams.shoulder(0.5, ratio, 1.0, (ratio - 1) / 2 / depth, flat=flat, shear=1.0)
    assert getattr(found, load) == pytest.approx(roark, rel=0.02)


def test_a_solved_problem_of_a_textbook():
    """Shigley, 9th edition, example 6-6: from 38 to 32 mm by 3 mm, 690 MPa; read from charts K_t =
    1.65, q = 0.84, K_f = 1.55.
    """
    q = beams.sensitivity(0.003, 690e6)
    notch = beams.shoulder(0.5, 0.038, 0.032, 0.003, sensitivity=q)
    assert notch.bending == pytest.approx(1.65, rel=0.025)
    assert q == pytest.approx(0.84, abs=0.01)
    assert 1 + q * (notch.bending - 1) == pytest.approx(1.55, rel=0.025)


@pytest.mark.parametrize("narrow", [0.5, 0.7, 0.9])
@pytest.mark.parametrize("flat", [True, False])
def test_both_parts_of_a_fit_meet(narrow, flat):
    """At t/r = 2 they are apart by what the fits err."""
    below, above = (
        beams.shoulder(0.5, 1.0, narrow, (1.0 - narrow) / 2 / x, flat=flat, shear=1.0)
        for x in (2.0 - 1e-9, 2.0 + 1e-9)
    )
    assert below.axial == pytest.approx(above.axial, rel=0.01)
    assert below.bending == pytest.approx(above.bending, rel=0.01)


@pytest.mark.parametrize("flat", [True, False])
@pytest.mark.parametrize("depth", [0.5, 1.5, 3.0])
def test_a_fillet_that_is_large_beside_the_narrow_side_concentrates_nothing(flat, depth):
    found = beams.shoulder(0.5, 1.0, 1e-6, 0.5 / depth, flat=flat)
    assert [found.axial, found.bending, found.shear] == pytest.approx([1.0, 1.0, 1.0], abs=0.03)


def test_a_hole_has_howlands_factors():
    """Howland, Phil. Trans. R. Soc. A 229 (1930), by series; a small hole has Kirsch's 3."""
    for share, exact in (
        (1e-6, 3.0),
        (0.1, 3.03),
        (0.2, 3.14),
        (0.3, 3.36),
        (0.4, 3.74),
        (0.5, 4.32),
    ):
        assert beams.hole(0.5, 1.0, share).axial == pytest.approx(exact, rel=0.004)
    assert beams.hole(0.5, 1.0, 1e-6).bending == pytest.approx(1.0, abs=1e-5)
    assert beams.hole(0.5, 1.0, 0.4).bending == pytest.approx(1 / (1 - 0.4**3))
    assert beams.hole(0.5, 1.0, 0.8).bending == pytest.approx(2 * 0.8 / (1 - 0.8**3))


def test_the_narrow_side_of_a_step_has_the_stress():
    shape = beams.stepped([0.5], [beams.round_bar(0.03), beams.round_bar(0.02)])
    notch = beams.shoulder(0.5, 0.03, 0.02, 0.004)
    stress = evaluate(strong.press(shape, [notch], t=(0, 0.2, 5)), certificate=False).stress("rod")
    narrow = stress.at(0.5, "tip", notch)[0]
    assert abs(stress.peak("normal", notches=True).value) == pytest.approx(
        abs(narrow).max(), rel=1e-12
    )
    assert abs(narrow).max() > abs(stress.at(0.5, "base", notch)[0]).max()


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (
            lambda: beams.shoulder(0.5, 0.02, 0.03, 0.001),
            "shoulder: wide must be more than narrow, got 0.02 and 0.03 m",
        ),
        (
            lambda: beams.shoulder(0.5, 0.03, 0.02, -1.0),
            "shoulder: radius must be positive, got -1 m",
        ),
        (
            lambda: beams.shoulder(0.5, 0.03, 0.02, 0.0001, flat=True),
            "for tension the depth .* from 0.1 to 20, got 50",
        ),
        (
            lambda: beams.shoulder(0.5, 0.03, 0.02, 0.001),
            "for torsion the depth .* from 0.25 to 4, got 5, or give its factor as shear",
        ),
        (lambda: beams.hole(0.5, 0.02, 0.02), "hole: diameter must be less than height"),
        (
            lambda: beams.sensitivity(0.001, 100e6),
            "ultimate strength of 345 to 1724 MPa, got 100 MPa",
        ),
        (lambda: beams.keyway(1.5), "Notch: at: expected a number from 0 to 1"),
    ],
)
def test_what_is_no_notch(make, told):
    with pytest.raises(DeclarationError, match=told):
        make()


def test_a_keyway_is_the_tables():
    assert (beams.keyway(0.2).bending, beams.keyway(0.2).shear) == (2.14, 3.0)
