"""Extremes: as exact as their condition lets any algorithm be, in doubles and in singles; and named
refusals at singular limits.
"""

import numpy as np
import pytest
from estimates import LEAST
from extremes import EXTREMES, PRECISIONS, RATE, SINGULAR, four_bar, slider_crank

from lagrange_casadi import evaluate
from lagrange_casadi.errors import AssemblyError, CertificateWarning

ROUNDINGS = 10

precisions = pytest.mark.parametrize("precision", PRECISIONS)


@pytest.mark.sampled(3)
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


@pytest.mark.sampled(11)
@precisions
@pytest.mark.parametrize("count", [2, 3, 8, 9, 82, 4001])
@pytest.mark.parametrize("limit", SINGULAR, ids=[limit.name for limit in SINGULAR])
def test_a_dead_centre_has_a_name(limit, count, precision):
    """On an instant or between two, however many there are, at the ends of the motion and beside
    the first or the last instant.
    """
    windows = [(shift - w, 2 * w) for w in (0.3, 0.3 / count) for shift in (-w, 0.0, w)]
    windows += [(-part * 0.6 / (count - 1), 0.6) for part in (0.4, count - 1.4)]
    for begin, turn in windows:
        with pytest.raises(AssemblyError, match=r"dead centre|did not converge|links do not reach"):
            evaluate(
                limit.scene(),
                parameters=limit.values | {"angle": limit.centre + begin, "change": 0.0},
                t=(0, turn / RATE, count),
                precision=precision,
                backend="c",
            )


@precisions
def test_lengths_beyond_numbers_are_named(precision):
    for size in (1e-160, 1e160):
        with pytest.raises(
            AssemblyError,
            match=rf"link '\w+' is [12]e[-+]16\d m long, but squares in {precision} precision need",
        ):
            evaluate(slider_crank(), parameters={"r": size, "l": 2 * size}, precision=precision)


@pytest.mark.parametrize("scene", [slider_crank, four_bar])
def test_a_lost_phase_is_in_the_estimate(scene):
    """5e12 rad are more than pairs of singles hold."""
    t = (1e6, 1e6 + 0.08, 9)
    exact = evaluate(scene(), t=t)
    with pytest.warns(CertificateWarning, match="closure"):
        lost = evaluate(scene(), t=t, precision="single")
    for name in ("pose:b:x", "effort:O") if scene is four_bar else ("pose:slider:x", "effort:O"):
        gap = np.max(np.abs(lost.series[name] - exact.series[name]))
        assert gap > 1e-3 * np.max(np.abs(exact.series[name]))
        assert lost.errors[name] > gap / 10
