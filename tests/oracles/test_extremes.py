"""Extremes: as exact as their condition lets any algorithm be, in doubles and in singles."""

import numpy as np
import pytest
from estimates import LEAST
from extremes import EXTREMES, PRECISIONS, four_bar, slider_crank

from lagrange_casadi import evaluate
from lagrange_casadi.errors import AssemblyError, CertificateWarning

ROUNDINGS = 10

precisions = pytest.mark.parametrize("precision", PRECISIONS)


@pytest.mark.sampled(5)
@precisions
@pytest.mark.parametrize("extreme", EXTREMES, ids=[extreme.name for extreme in EXTREMES])
def test_extremes(extreme, precision):
    """Some roundings of what the condition allows, and no more than the stated errors."""
    if precision == "single" and extreme.single:
        with pytest.raises(AssemblyError, match=extreme.single):
            extreme.solution(precision=precision)
        return
    solution = extreme.solution(precision=precision)
    for name, (error, share) in extreme.judged(solution).items():
        assert share <= ROUNDINGS * extreme.bound(solution), name
        assert LEAST * error <= solution.errors[name], name


@precisions
def test_lengths_beyond_numbers_are_named(precision):
    for size in (1e-160, 1e160):
        with pytest.raises(
            AssemblyError,
            match=rf"link '\w+' is [12]e[-+]16\d m long, but squares in {precision} precision need",
        ):
            evaluate(slider_crank(), parameters={"r": size, "l": 2 * size}, precision=precision)


@pytest.mark.parametrize(
    ("scene", "later", "words"),
    [
        (slider_crank, 1e6, {}),
        (four_bar, 1e6, {}),
        (slider_crank, 1e3, {"backend": "c", "flags": "-O3 -ffast-math"}),
    ],
)
def test_a_lost_phase_is_in_the_estimate(scene, later, words):
    """5e12 rad are more than pairs of singles hold; and a compiler that may reassociate makes one
    single of a pair.
    """
    t = (later, later + 0.08, 9)
    exact = evaluate(scene(), t=t)
    with pytest.warns(CertificateWarning, match="closure"):
        lost = evaluate(scene(), t=t, precision="single", **words)
    for name in ("pose:b:x", "effort:O") if scene is four_bar else ("pose:slider:x", "effort:O"):
        gap = np.max(np.abs(lost.series[name] - exact.series[name]))
        assert gap > 1e-3 * np.max(np.abs(exact.series[name]))
        assert lost.errors[name] > gap / 10
