"""First bending frequencies: closed forms, published tapers, and bounds from both sides."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from internals import ENDS, first_mode
from internals import bending_modes_closed as closed


@pytest.mark.parametrize("ends", itertools.product(ENDS, ENDS), ids="-".join)
def test_a_uniform_beam_has_the_frequency_of_books(ends):
    mode = first_mode(lambda u: 100.0 + 0 * u, lambda u: 3.0 + 0 * u, 1.7, (0.0, 1.0), ends)
    exact = closed(100.0, 3.0, 1.7, ends)
    assert exact <= mode.upper * (1 + 1e-12)
    assert mode.upper == pytest.approx(exact, rel=1e-6)
    moves = all(end not in ("pinned", "clamped") for end in ends) or set(ends) == {"pinned", "free"}
    assert (mode.lower is None) == moves
    if mode.lower is not None:
        assert mode.lower <= exact * (1 + 1e-12)
        assert mode.lower == pytest.approx(exact, rel=1e-4)


def test_a_wedge_is_that_of_kirchhoff():
    """A wedge clamped at its thick end: w = 5.315 sqrt(EI/(m l^4)) of its base (Kirchhoff 1879;
    Timoshenko, Vibration Problems).
    """
    mode = first_mode(
        lambda u: 100 * (1 - u) ** 3 + 1e-12,
        lambda u: 3 * (1 - u) + 1e-12,
        1.7,
        (0.0, 1.0),
        ("clamped", "free"),
    )
    assert mode.upper == pytest.approx(5.315 * math.sqrt(100 / (3 * 1.7**4)), rel=1e-3)


@settings(max_examples=6)
@given(
    st.lists(st.floats(0.2, 5.0), min_size=3, max_size=3),
    st.lists(st.floats(0.2, 5.0), min_size=2, max_size=2),
    st.floats(0.2, 0.8),
    st.sampled_from(
        [
            ("clamped", "free"),
            ("pinned", "pinned"),
            ("clamped", "pinned"),
            ("clamped", "clamped"),
            ("guided", "pinned"),
        ]
    ),
)
def test_bounds_enclose_and_mirrored_beams_swing_alike(stiff, heavy, step, ends):
    def stiffness(u):
        return np.where(u < step, stiff[0], stiff[1] + (stiff[2] - stiff[1]) * u)

    def mass(u):
        return heavy[0] + (heavy[1] - heavy[0]) * u

    mode = first_mode(stiffness, mass, 1.3, (0.0, step, 1.0), ends)
    other = first_mode(
        lambda u: stiffness(1 - u), lambda u: mass(1 - u), 1.3, (0.0, 1 - step, 1.0), ends[::-1]
    )
    assert mode.lower <= mode.upper
    assert mode.upper == pytest.approx(mode.lower, rel=2e-3)
    assert other.upper == pytest.approx(mode.upper, rel=1e-4)
    assert other.lower <= mode.upper * (1 + 1e-12)
    assert mode.lower <= other.upper * (1 + 1e-12)


def test_the_mode_has_unit_modal_mass():
    """Strain energy of the mode is half the square of its frequency."""
    mode = first_mode(lambda u: 2 + u, lambda u: 3 - u, 0.7, (0.0, 1.0), ("clamped", "pinned"))
    assert np.sum(mode.weights * (2 + mode.u) * mode.curvature**2) == pytest.approx(
        mode.upper**2, rel=1e-8
    )


@pytest.mark.parametrize("ends", itertools.product(ENDS, ENDS), ids="-".join)
def test_a_beam_may_have_parts_without_mass_or_none_at_all(ends):
    """As the mass of a part goes to nothing, the frequency tends to that of the beam whose part has
    none.
    """

    def found(rest):
        return first_mode(
            lambda u: 100.0 + 0 * u,
            lambda u: np.where(u < 0.4, 3.0, rest),
            1.7,
            (0.0, 0.4, 1.0),
            ends,
        )

    none, little = found(0.0), found(1e-9)
    assert none.upper == pytest.approx(little.upper, rel=1e-7)
    assert none.lower == (
        little.lower if little.lower is None else pytest.approx(little.lower, rel=1e-5)
    )
    assert np.abs(none.curvature) == pytest.approx(
        np.abs(little.curvature), rel=1e-5, abs=1e-6 * np.abs(little.curvature).max()
    )
    nothing = first_mode(lambda u: 100.0 + 0 * u, lambda u: 0.0 * u, 1.7, (0.0, 1.0), ends)
    assert nothing.upper == np.inf
    assert nothing.lower == (None if none.lower is None else np.inf)


def test_a_mass_on_a_beam_without_any_is_that_of_a_spring():
    """Of a mass spread over so little of the middle as a point, w^2 =
    48 EI/(m l^3) between pins.
    """
    width = 1e-3
    edges = (0.0, 0.5 - width / 2, 0.5 + width / 2, 1.0)
    mode = first_mode(
        lambda u: 100.0 + 0 * u,
        lambda u: np.where(np.abs(u - 0.5) < width / 2, 3.0 / (1.7 * width), 0.0),
        1.7,
        edges,
        ("pinned", "pinned"),
    )
    assert mode.upper == pytest.approx(math.sqrt(48 * 100.0 / (3.0 * 1.7**3)), rel=1e-5)
