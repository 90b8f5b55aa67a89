"""Parameters from measurements are the true ones, as far as measurements tell them."""

from __future__ import annotations

import math
import runpy

import numpy as np
import pytest
from conftest import CASES
from measured_machines import (
    ARM,
    PLATE,
    RUBBING,
    combined,
    noisy,
    platform,
    record,
    rubbing,
    spatial_arm,
    swinging,
    two_links,
)

from lagrange_casadi import (
    Measurements,
    Mechanism,
    Scene,
    evaluate,
    excite,
    identify,
    load_case,
    read_measurements,
)
from lagrange_casadi.errors import UnknownNameError

pytestmark = pytest.mark.usefixtures("interpreted")

LOADING = ("mass", "k", "preload", "c", "mu")
"""The pin's friction goes with the size of its load, which is not linear in what loads it."""


def test_base_parameters_of_a_planar_arm_are_those_of_the_textbook():
    """J1 + l^2 m2, h1 + l m2, J2 and h2: Khalil and Dombre, Modeling, Identification and Control of
    Robots, 2002, chapter 9.
    """
    scene = two_links()
    result = identify(scene, record(scene, ARM, "effort:A", "effort:B"))
    assert [one.words for one in result.base] == ["h1 + 0.5 m2", "J1 + 0.25 m2", "h2", "J2"]
    values = [one.value for one in result.base]
    np.testing.assert_allclose(values, combined(result, ARM), rtol=1e-9)
    assert result.absent == ("m1",)
    assert not result.nonlinear
    assert not result.unexcited
    assert np.isinf([result.errors[name] for name in ("m2", "h1", "J1")]).all()
    assert max(result.comparison.relative.values()) < 1e-12


@pytest.mark.parametrize(
    ("make", "quantities", "curved"),
    [
        (spatial_arm, ("effort:q1", "effort:q2", "effort:q3"), ()),
        (lambda: (rubbing(), RUBBING), ("effort:O", "reaction:C:fx"), LOADING),
        (lambda: (platform(), PLATE), ("effort:d0", "effort:d1", "effort:d2"), ()),
    ],
    ids=["arm in space", "friction and springs", "3-RRR"],
)
def test_truth_is_found_without_noise(make, quantities, curved):
    scene, truth = make()
    result = identify(scene, record(scene, truth, *quantities))
    assert tuple(result.nonlinear) == curved
    values = np.array([one.value for one in result.base])
    true = combined(result, truth)
    np.testing.assert_allclose(values, true, rtol=1e-9, atol=1e-9 * np.abs(true).max())
    assert result.condition < 1e4
    if make is spatial_arm:
        # Of a serial arm with a vertical first axis: 10 n less what no joint feels.
        assert len(result.base) == 15
    else:
        assert all(np.isfinite(result.errors[name]) for name in truth)


def test_errors_are_as_large_as_stated():
    """In 60 draws of noise, deviations over the covariance are those of chi-squared."""
    scene, names = two_links(), ("effort:A", "effort:B")
    exact = record(scene, ARM, *names)
    generator, squares, within = np.random.default_rng(1), [], []
    for _ in range(60):
        columns = dict(exact.columns)
        for name in names:
            columns[name] = columns[name] + 0.3 * generator.standard_normal(exact.t.size)
        result = identify(scene, Measurements(exact.t, columns))
        away = np.array([one.value for one in result.base]) - combined(result, ARM)
        errors = np.array([one.error for one in result.base])
        within.append(np.abs(away) <= 1.96 * errors)
        squares.append(away @ np.linalg.solve(result.covariance, away))
        assert abs(result.noise["effort:A"] / 0.3 - 1.0) < 0.2
    assert 0.92 <= np.mean(within) <= 0.98
    assert 3.0 <= np.mean(squares) <= 5.0  # 4 degrees of freedom: 4 +- 0.37


def test_outliers_count_little_in_hubers_loss():
    scene, names = two_links(), ("effort:A", "effort:B")
    given = noisy(scene, ARM, names, 0.1)
    effort = given.columns["effort:A"].copy()
    effort[::25] += 40.0
    spoilt = Measurements(given.t, {**given.columns, "effort:A": effort})
    off = {}
    for robust in (False, True):
        result = identify(scene, spoilt, robust=robust)
        off[robust] = np.abs([one.value for one in result.base] - combined(result, ARM)).max()
    assert off[True] < 0.1 * off[False]
    assert result.outliers["effort:A"] > result.outliers["effort:B"]
    # Without outliers a standard error grows by what Huber's loss gives away: 1/0.95 of a variance.
    plain, robust = (identify(scene, given, robust=huber) for huber in (False, True))
    for one, other in zip(plain.base, robust.base, strict=True):
        assert other.error == pytest.approx(one.error / math.sqrt(0.95), rel=0.1)


def test_missing_values_a_filter_and_a_second_record_change_no_truth():
    scene, names = two_links(), ("effort:A", "effort:B")
    exact = record(scene, ARM, *names)
    columns = {name: values.copy() for name, values in exact.columns.items()}
    columns["effort:A"][50:90] = np.nan
    columns["A_acceleration"][10:12] = np.nan  # from the spline of the coordinate
    keep = np.sort(np.random.default_rng(0).permutation(exact.t.size)[:200])
    keep[[0, -1]] = 0, exact.t.size - 1
    uneven = Measurements(exact.t[keep], {name: values[keep] for name, values in columns.items()})
    result = identify(scene, uneven, cutoff=10.0)
    values = [one.value for one in result.base]
    np.testing.assert_allclose(values, combined(result, ARM), rtol=2e-3)
    assert max(result.validate(exact).relative.values()) < 2e-3
    with pytest.raises(UnknownNameError, match="effort:B"):
        result.validate(Measurements(exact.t, {"A": exact.columns["A"], "B": exact.columns["B"]}))


def test_prior_values_are_one_more_measurement():
    scene, names = two_links(), ("effort:A", "effort:B")
    given = noisy(scene, ARM, names, 0.1)
    free = identify(scene, given)
    prior = identify(scene, given, parameters={"m2": 1.75}, prior={"m2": 0.1})
    assert prior.values["m2"] == pytest.approx(1.75, rel=1e-9)
    assert prior.errors["m2"] == pytest.approx(0.1, rel=1e-9)
    first = free.base[0].value - 0.5 * 1.75
    assert prior.values["h1"] == pytest.approx(first, rel=1e-6)
    assert np.isfinite(prior.errors["J1"])
    assert np.isinf(prior.errors["m1"])
    assert prior.values["m1"] == prior.initial["m1"] == 3.0  # nothing depends on it


def test_consistent_parameters_are_those_of_some_body():
    scene, truth = spatial_arm()
    names = ("effort:q1", "effort:q2", "effort:q3")
    given = noisy(scene, truth, names, 3.0)

    def least(result):
        found = []
        for k in (2, 3):
            v = result.values
            h = np.array([v[f"h{x}{k}"] for x in "xyz"])
            j = np.array([[v[f"J{min(a, b)}{max(a, b)}{k}"] for a in "xyz"] for b in "xyz"])
            moments = np.trace(j) / 2 * np.eye(3) - j
            whole = np.block([[moments, h[:, None]], [h[None], np.array([[v[f"m{k}"]]])]])
            found.append(np.linalg.eigvalsh(whole).min())
        return min(found)

    assert least(identify(scene, given)) < 0.0
    result = identify(scene, given, consistent=True)
    assert least(result) > 0.0
    assert max(result.comparison.relative.values()) < 1.0
    exact = identify(scene, record(scene, truth, *names), consistent=True, parameters=truth)
    np.testing.assert_allclose(
        list(exact.values.values()), [truth[n] for n in exact.values], atol=1e-6
    )


def test_strain_gauges_tell_a_spring():
    """A gauge on a cantilevered rocker: strain = axial / EA - bending c / EI."""
    from lagrange_casadi import beams

    m = Mechanism("gauge")
    steel = beams.Material("steel", density=7850.0, elasticity=210e9)
    k, rest = m.parameter("k", 100.0, "N/m"), m.parameter("preload", 5.0, "N")
    arm = m.link("arm", length=0.4, beam=beams.Beam(beams.rectangle(0.02, 0.01), steel))
    m.revolute("O", m.ground, arm)
    m.spring("s", m.ground.at(0, 0.7), arm.tip, stiffness=k, length=0.3 - rest / k)
    scene = Scene(m, {"O": swinging(0.4, 0.5, 0.2)}, t=(0, 2, 101), xi=(0, 1, 5))
    truth = {"k": 140.0, "preload": 8.0}
    solution = evaluate(scene, parameters=truth, wanted=["all"])
    axial, bending = (solution.array(f"section:arm:{f}")[:, 1] for f in ("axial", "bending"))
    area, second = 0.02 * 0.01, 0.01 * 0.02**3 / 12
    strain = (axial / area - bending * 0.01 / second) / 210e9
    columns = {f"O{e}": solution.array(f"motion:O{e}") for e in ("", "_rate", "_acceleration")}
    given = Measurements(solution.t, {**columns, "strain:arm:side +y@0.25": strain})
    result = identify(scene, given)
    np.testing.assert_allclose([result.values[n] for n in truth], [*truth.values()], rtol=1e-9)
    given = Measurements(solution.t, {**columns, "section:arm:bending@0.25": bending})
    result = identify(scene, given, ["k"], parameters={"preload": 8.0})
    assert result.values["k"] == pytest.approx(140.0, rel=1e-9)


def test_the_shipped_records_are_those_of_the_arm_that_is_measured():
    """An arm with a parallelogram, a spring and friction: truth within the stated errors."""
    folder = CASES / "parallelogram_arm"
    made, case = runpy.run_path(str(folder / "measure.py")), load_case(folder)
    for name, text in made["records"]().items():
        rows = [
            np.loadtxt(lines, delimiter=",", skiprows=1)
            for lines in (folder / name, text.split("\n"))
        ]
        np.testing.assert_allclose(*rows, rtol=0.0, atol=1.1e-3)  # a digit may round otherwise
    noise = dict.fromkeys(case.scene.laws, made["ANGLE"])
    run, check = (read_measurements(folder / f"{n}.csv", noise=noise) for n in ("run", "check"))
    found = identify(case, run, trim=0.1)
    assert found.absent == ("m_upper", "m_crank")
    true = combined(found, case.scene.values(None) | made["TRUTH"])
    away = [abs(one.value - t) / one.error for one, t in zip(found.base, true, strict=True)]
    assert len(away) == 10
    assert max(away) < 4.0
    for left in found.validate(check, trim=0.1).residual.values():
        assert left == pytest.approx(made["TORQUE"], rel=0.3)


def test_an_excitation_keeps_within_limits_and_tells_more():
    scene = two_links()
    limits = {"A": (-1.0, 1.0, 2.0, 9.0), "B": (0.0, 1.5, 3.0, 20.0)}
    found = excite(scene, limits, period=4.0, steps=60)
    assert found.error < 0.9  # of random motions' best, at which the search begins
    assert len(found.base) == 4
    swept = Scene(scene.mechanism, found.motion, wanted=["motion"], t=(0, 4, 4001))
    solution = evaluate(swept)
    for drive, (low, high, speed, most) in limits.items():
        angle, rate, acceleration = (
            solution.array(f"motion:{drive}{end}") for end in ("", "_rate", "_acceleration")
        )
        shares = np.ptp(angle) / (high - low), np.abs(rate).max() / speed
        shares = (*shares, np.abs(acceleration).max() / most)
        assert low <= angle.min() < angle.max() <= high
        assert 0.99 < max(shares) <= 1.0
