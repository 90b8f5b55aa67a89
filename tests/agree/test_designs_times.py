"""Designs with instants of their own: each against its own evaluation, on every backend, whatever
the neighbours.
"""

import math

import numpy as np
import pytest
from internals import Status
from mechanisms import press, uneven

from lagrange_casadi import Mechanism, Scene, evaluate, motion, prepare, refine

TURN = math.tau
ASKED = {
    "over": {"over": ("O", 0.3, 0.3 + TURN, 61)},
    "over expressions": {"over": lambda rpm: ("O", rpm / 6000, TURN + rpm / 3000, 61)},
    "expressions of time": {"t": lambda rpm: (0, 60 / rpm, 61)},
}
P = np.array([[600.0, 0.5], [45.0, 0.4], [0.0, 0.5], [-60.0, 0.5], [3000.0, 0.3], [math.nan, 0.5]])
FAILS = {2: Status.NO_INSTANTS, 3: Status.NO_INSTANTS, 5: Status.INVALID}


@pytest.mark.sampled(19)
@pytest.mark.parametrize("backend", ["lanes", "c"])
@pytest.mark.parametrize("law", [motion.polynomial, uneven])
@pytest.mark.parametrize("asked", ASKED)
def test_designs_are_their_own_evaluations(asked, law, backend):
    """Peaks between instants, their times, the drive's coordinate there; histories at the instants
    that were asked for.
    """
    scene = press(law, wanted=["effort", "section:rod", "motion"], **ASKED[asked])
    designs = prepare(scene, backend=backend)
    outcome = designs.designs(P, histories=True)
    assert outcome.status.tolist() == [FAILS.get(k, Status.OK) for k in range(len(P))]
    for row in np.flatnonzero(outcome.status == Status.OK):
        solution = evaluate(scene, parameters=dict(zip(designs.parameters, P[row], strict=True)))
        np.testing.assert_allclose(outcome.times[row], solution.t, rtol=1e-14, atol=1e-16)
        for k, output in enumerate(designs.outputs):
            scale = np.abs(solution.array(output)).max()
            np.testing.assert_allclose(
                outcome.series[row, k],
                solution.array(output),
                rtol=0,
                atol=1e-13 * scale,
                err_msg=output,
            )
        for k, peak in enumerate(refine(scene, solution, designs.quantities)):
            assert outcome.value[row, k] == pytest.approx(peak.value, rel=1e-11, abs=1e-11), (
                peak.name
            )
            if solution.over:
                w = P[row, 0] * TURN / 60
                d = w * outcome.t[row, k] + (
                    0.2 * math.sin(w * outcome.t[row, k]) if law is uneven else 0.0
                )
                assert outcome.over[row, k] == pytest.approx(d, abs=1e-12)
    assert np.isnan(outcome.value[2]).all()
    assert np.isnan(outcome.series[2]).all()
    assert np.isnan(outcome.times[3]).all()


@pytest.mark.sampled(2)
@pytest.mark.parametrize("law", [motion.polynomial, uneven])
def test_means_are_over_the_time_of_a_whole_turn(law):
    """The mean power of a drive without losses is zero, whatever its speed; the mean of a square is
    that of many more instants.
    """
    scene = press(law, wanted=["effort"], over=("O", 0, TURN, 181))
    p = np.array([[600.0, 0.5], [100.0, 0.4]])
    outcome = prepare(scene).designs(p)
    for row, (rpm, length) in enumerate(p):
        fine = evaluate(scene, t=(0, 60 / rpm, 20001), parameters={"rpm": rpm, "l": length})
        effort = fine.effort("O")
        for found, values in (
            (outcome.mean[row, 0], effort),
            (outcome.rms[row, 0] ** 2, effort**2),
        ):
            mean = (values[1:] + values[:-1]).mean() / 2
            assert found == pytest.approx(mean, abs=1e-6 * np.abs(values).max())


def test_a_swing_that_is_looked_for_at_a_time_of_each_designs_own():
    """A motion without parameters, followed from a time that has them: some designs find it on its
    way, others on the next.
    """
    law = motion.harmonic(1.0, 0.4, 2.0)
    scene = press(lambda *_: law, wanted=["motion"], t=lambda rpm: (rpm / 1000, 2 + rpm / 1000, 2))
    designs = prepare(scene, over=("O", 0.7, 1.3, 9))
    found = designs.designs(np.array([[100.0, 0.5], [600.0, 0.5]]), histories=True)
    np.testing.assert_allclose(found.times[1] - found.times[0], 0.5, atol=1e-14)


def test_samples_of_a_motion_end_for_those_designs_alone_that_go_beyond():
    m = Mechanism("arm")
    stop = m.parameter("stop", 1.0, "s")
    arm = m.link("arm", length=0.4, mass=2.0)
    m.revolute("O", m.ground, arm)
    law = motion.samples(
        np.linspace(0, 2, 21), np.linspace(0, 7, 21) + 0.2 * np.sin(np.linspace(0, 7, 21))
    )
    scene = Scene(m, {"O": law}, ["effort"], t=(0, stop, 41))
    outcome = prepare(scene).designs(np.array([[0.5], [2.0], [2.1], [1.3]]))
    assert outcome.status.tolist() == [0, 0, Status.NO_INSTANTS, 0]
    for row, seconds in ((0, 0.5), (1, 2.0), (3, 1.3)):
        solution = evaluate(scene, t=(0, seconds, 41))
        assert abs(outcome.value[row, 0]) == pytest.approx(
            abs(refine(scene, solution, ["effort:O"])[0].value), rel=1e-9
        )
    over = prepare(Scene(m, {"O": law}, ["effort"], over=("O", 0, 6.0 * stop, 41)))
    assert over.designs(np.array([[0.5], [1.0], [1.3]])).status.tolist() == [
        0,
        0,
        Status.NO_INSTANTS,
    ]
