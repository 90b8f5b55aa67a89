"""Extremes: as exact as their condition lets any algorithm be, in doubles and in singles; and named
refusals at singular limits.
"""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from condition import understated
from extremes import EXTREMES, PRECISIONS, RATE, SINGULAR, four_bar, slider_crank
from internals import reference
from mpmath import mp
from stepped import pinned, two_rods

from lagrange_casadi import derive, evaluate
from lagrange_casadi.errors import AssemblyError, CertificateWarning
from lagrange_casadi.motion import polynomial

ROUNDINGS = 100
ORDINARY = {"double": 1e-13, "single": 1e-5}
ANGLE = math.pi / 2 - 0.02 * RATE
"""From which the crank is upright at t = 0.02 s."""

precisions = pytest.mark.parametrize("precision", PRECISIONS)


def assert_exact(extreme, **options):
    solution = extreme.solution(**options)
    worst, *_ = judges = extreme.judged(solution)
    assert worst.units <= ROUNDINGS, worst
    if extreme.ordinary:
        largest = max(judges, key=lambda judge: judge.error)
        assert largest.error <= ORDINARY[solution.provenance.precision], largest
    assert not understated(solution, extreme.program, extreme.meant)


@pytest.mark.sampled(97)
@pytest.mark.parametrize("extreme", EXTREMES, ids=[extreme.name for extreme in EXTREMES])
def test_extremes(extreme):
    """In both precisions, and without a compiler where a dead centre is near.

    Elsewhere the compiled code has the virtual machine's numbers, as test_codegen shows.
    """
    assert_exact(extreme)
    if not extreme.ordinary:
        assert_exact(extreme, backend="vm")
    if extreme.single:
        with pytest.raises(AssemblyError, match=extreme.single):
            extreme.solution(precision="single")
    else:
        assert_exact(extreme, precision="single")


def test_the_documentation_lists_every_extreme():
    """``python tests extremes`` prints its table."""
    page = (
        (Path(__file__).parents[2] / "docs" / "accuracy.md").read_text().partition("## Extremes")[2]
    )
    assert [line.split(" | ")[0][2:] for line in page.splitlines() if line.startswith("| ")][
        2:
    ] == [e.name for e in EXTREMES]


@pytest.mark.sampled(11)
@precisions
@pytest.mark.parametrize("count", [8, 9, 82, 4001])
@pytest.mark.parametrize("limit", SINGULAR, ids=[limit.name for limit in SINGULAR])
def test_a_dead_centre_has_a_name(limit, count, precision):
    """On an instant or between two, however many there are, and at the ends of the motion."""
    for width in (0.3, 0.3 / count):
        for shift in (-width, 0.0, width):
            values = limit.values | {"angle": limit.centre + shift - width, "change": 0.0}
            with pytest.raises(
                AssemblyError, match=r"dead centre|did not converge|links do not reach"
            ):
                evaluate(
                    limit.scene(),
                    parameters=values,
                    t=(0, 2 * width / RATE, count),
                    precision=precision,
                    backend="c",
                )


@precisions
@pytest.mark.parametrize("count", [2, 3, 9])
@pytest.mark.parametrize("limit", SINGULAR, ids=[limit.name for limit in SINGULAR])
def test_a_dead_centre_beside_the_first_or_last_instant(limit, count, precision):
    for place in (0.4, count - 1.4):
        values = limit.values | {"angle": limit.centre - 0.02 * place, "change": 0.0}
        with pytest.raises(AssemblyError, match="dead centre"):
            evaluate(
                limit.scene(),
                parameters=values,
                t=(0, 0.02 * (count - 1) / RATE, count),
                precision=precision,
                backend="c",
            )


@precisions
def test_a_rod_that_is_too_short_by_little(precision):
    """Between two instants, too, it is seen."""
    for count in (9, 4001):
        with pytest.raises(
            AssemblyError,
            match=r"joint 'guide' (passes a dead centre|is at a dead centre|cannot be closed)",
        ):
            evaluate(
                slider_crank(),
                parameters={"r": 0.2 * (1 + 1e-9)},
                t=(0, 0.04, count),
                precision=precision,
            )


@pytest.mark.parametrize("count", [9, 81, 641])
def test_near_a_dead_centre_instants_may_be_few(count):
    """The same values whether the instants beside show how near it was or not."""
    values = {"r": 0.2 * (1 - 1e-9), "angle": ANGLE - 0.01, "change": 0.0}
    coarse = evaluate(slider_crank(), parameters=values, t=(0, 0.04, count))
    alone = evaluate(slider_crank(), parameters=values, t=(0, 0.04 / (count - 1) * 2, 3))
    for name, row in alone.series.items():
        np.testing.assert_allclose(
            coarse.series[name][:2], row[:2], rtol=1e-13, atol=1e-13 * np.max(np.abs(row))
        )


@pytest.mark.parametrize(("short", "passes"), [(1e-9, False), (0.0, True)])
def test_a_loop_that_comes_near_beside_one_that_is_iterated_has_a_result(short, passes):
    scene = two_rods(polynomial(ANGLE - 0.01, RATE), t=(0, 0.04, 81))
    parameters = {"r": 0.2 * (1 - short), "l": 0.2}
    if passes:
        with pytest.raises(AssemblyError, match=r"joint 'closed_guide'.* dead centre"):
            evaluate(scene, parameters=parameters)
    else:
        assert evaluate(scene, parameters=parameters).certified


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


@pytest.mark.parametrize(
    ("name", "scene"), [("r/l = 1 - 1e-9", slider_crank), ("stretched but for 1e-09", four_bar)]
)
def test_half_iterated_loops_are_in_the_estimate(name, scene):
    """Steps of Newton that are too few so near to a dead centre: one more
    of them would not tell.
    """
    (extreme,) = (replace(e, scene=lambda: scene(pin=pinned)) for e in EXTREMES if name in e.name)
    exact, rough = extreme.solution(), extreme.solution(newton=1)
    gaps = {name: np.max(np.abs(row - exact.series[name])) for name, row in rough.series.items()}
    assert gaps["effort:O"] > 1e-3 * np.max(np.abs(exact.series["effort:O"]))
    assert not {name: gap for name, gap in gaps.items() if not rough.errors[name] >= gap / 10}


def test_a_reference_means_whole_turns():
    """The double nearest to a turn would be off by 3e-9 rad after 1.25e7 of them."""
    program = derive(slider_crank(), ["motion"])
    values = slider_crank().mechanism.values({"change": 0.0})
    (row,) = reference(program, [1e6], list(values.values()))
    found = dict(zip(program.names, row, strict=True))
    with mp.workdps(50):
        turns = (found["pose:rod:angle"] - found["motion:O"] - found["motion:A"]) / (2 * mp.pi)
        assert abs(turns - mp.nint(turns)) < 1e-30
        assert abs(turns) > 1e7
