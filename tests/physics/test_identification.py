"""Parameters from measurements are the true ones, as far as measurements tell them."""

import runpy

import h5py
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
    SpatialMechanism,
    evaluate,
    excite,
    identify,
    load_case,
    read_measurements,
)
from lagrange_casadi.cli import main
from lagrange_casadi.errors import UnknownNameError
from lagrange_casadi.motion import expression

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


def test_what_the_motion_does_not_tell_is_said():
    """With the second joint at rest its links are one; other motions would tell them apart."""
    scene = two_links()
    still = Scene(
        scene.mechanism,
        dict(scene.motion) | {"B": expression(lambda t: 0.8 + 0.0 * t)},
        t=(0, 3, 301),
    )
    result = identify(still, record(still, ARM, "effort:A"))
    assert len(result.base) < 4
    assert len(result.base) + len(result.unexcited) == 4
    other = identify(scene, record(scene, ARM, "effort:A"))
    assert not other.unexcited


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
    """In 100 draws of noise, deviations over the covariance are those of chi-squared."""
    scene, names = two_links(), ("effort:A", "effort:B")
    exact = record(scene, ARM, *names)
    generator, squares, within = np.random.default_rng(1), [], []
    for _ in range(100):
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
    assert 3.0 <= np.mean(squares) <= 5.0  # 4 degrees of freedom: 4 +- 0.28


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


def test_filtered_errors_are_those_of_filtered_noise():
    """A filter before least squares leaves the stated errors true."""
    scene, names = two_links(), ("effort:A", "effort:B")
    squares = []
    for seed in range(40):
        result = identify(scene, noisy(scene, ARM, names, 0.3, seed), cutoff=4.0)
        away = np.array([one.value for one in result.base]) - combined(result, ARM)
        squares.append(away @ np.linalg.solve(result.covariance, away))
    assert 2.7 <= np.mean(squares) <= 5.5  # 4 degrees of freedom: 4 +- 0.45


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


def test_a_thin_rod_is_a_body_that_can_be():
    """Its moment about its own axis is none; Wensing's matrix has no extent across it."""
    m = SpatialMechanism("boom")
    mass = m.parameter("mass", 1.0, "kg", low=0.0)
    moments = (0.0, 0.03 * mass, 0.03 * mass)
    rod = m.link("rod", length=0.6, mass=mass, centre=(0.3, 0, 0), inertia=moments)
    m.revolute("tilt", m.ground, rod, axis=(0, 1, 0))
    scene = Scene(m, {"tilt": swinging(0.1, 0.4, 0.2)}, t=(0, 2, 101))
    given = noisy(scene, {"mass": 1.4}, ("effort:tilt",), 0.1)
    free, safe = identify(scene, given), identify(scene, given, consistent=True)
    assert not free.impossible
    assert safe.values["mass"] == pytest.approx(free.values["mass"], rel=1e-6)


def test_consistent_parameters_are_the_least_squares_among_possible_ones():
    """With a moment of inertia that is measured too small, the others are those for the least."""
    scene, names = two_links(), ("effort:A", "effort:B")
    some, other = (record(scene, ARM | {"J2": inertia}, *names) for inertia in (0.1, 0.16))
    efforts = {n: some.columns[n] - (other.columns[n] - some.columns[n]) / 3 for n in names}
    given = Measurements(some.t, {**some.columns, **efforts}, dict.fromkeys(names, 0.1))
    known = {"m2": 1.7, "h2": 0.4}
    assert identify(scene, given, ["J2"], parameters=ARM).values["J2"] == pytest.approx(0.08)
    safe = identify(scene, given, ["h1", "J1", "J2"], parameters=known, consistent=True)
    least = 0.4**2 / 1.7
    held = identify(scene, given, ["h1", "J1"], parameters=known | {"J2": least})
    assert safe.values["J2"] == pytest.approx(least, rel=1e-4)
    assert not safe.impossible
    for name in ("h1", "J1"):
        assert safe.values[name] == pytest.approx(held.values[name], rel=1e-4)


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


def test_an_excitation_is_a_drawn_one_if_none_that_is_improved_can_be_followed(monkeypatch):
    place = "lagrange_casadi.identification.excitation._Search._improved"
    monkeypatch.setattr(place, lambda _, starts, steps: [20.0 * one.series for one in starts])
    middles = {f"d{i}": 2 * np.pi * i / 3 + 7 * np.pi / 6 - 0.8 for i in range(3)}
    limits = {name: (middle - 0.2, middle + 0.2, 1.0, 5.0) for name, middle in middles.items()}
    found = excite(platform(), limits, period=4.0, harmonics=2)
    assert found.error == 1.0
    assert found.condition == found.first


def test_the_command_writes_values_a_file_and_a_figure(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "arm_case.py"
    path.write_text(
        "from math import sin\n"
        "from lagrange_casadi import Mechanism, Scene\n"
        "from lagrange_casadi.motion import harmonic\n"
        "def scene():\n"
        "    m = Mechanism('arm')\n"
        "    w, c = m.parameter('w', 1.0, 'kg'), m.parameter('c', 0.1, 'N m s')\n"
        "    j = m.revolute('O', m.ground, m.link('l', length=0.5, mass=w))\n"
        "    m.torsion_spring('d', j, stiffness=0.0, damping=c)\n"
        "    return Scene(m, {'O': harmonic(0.0, 1.0, 0.5)}, t=(0, 4, 201))\n"
    )
    solution = evaluate(load_case(path).scene, parameters={"w": 1.4, "c": 0.25})
    noise = np.random.default_rng(0).normal(0.0, 0.02, solution.t.size)
    heads = ["t [s]", "angle [deg]", "O_rate [deg/s]", "O_acceleration [rad/s^2]", "torque [N m]"]
    columns = [np.degrees(solution.array(f"motion:O{end}")) for end in ("", "_rate")]
    columns += [solution.array("motion:O_acceleration"), solution.array("effort:O") + noise]
    rows = zip(solution.t, *columns, strict=True)
    lines = [",".join(heads), *(",".join(f"{x:.12g}" for x in row) for row in rows)]
    (tmp_path / "run.csv").write_text("\n".join(lines))
    given = ["--column", "O=angle", "--column", "effort:O=torque", "--noise", "effort:O=0.02"]
    given += ["--validate", "run.csv", "--figure", "fit.svg", "--out", "found.h5"]
    given += ["--report", "page.html"]
    assert main(["identify", str(path), "run.csv", *given]) == 0
    said = capsys.readouterr().out
    settings = dict(word.split("=") for word in said.split() if word[:2] in ("w=", "c="))
    with h5py.File("found.h5") as file:
        for name, true in (("w", 1.4), ("c", 0.25)):
            item = file["parameters"][name]
            assert float(settings[name]) == item[()]
            assert abs(item[()] - true) < 4.0 * item.attrs["error"] < 0.02
        assert file.attrs["complete"]
        assert sorted(file["base"].attrs["words"]) == ["c", "w"]
        both = file["record/effort:O"]
        left = both["measured"][()] - both["model"][()]
        assert np.sqrt(np.mean(left**2)) == pytest.approx(0.02, rel=0.2)
        assert file["validation/effort:O"].attrs["relative"] == both.attrs["relative"]
    assert (tmp_path / "fit.svg").read_text().startswith("<?xml")
    page = (tmp_path / "page.html").read_text()
    for words in (f"<td>{settings['w'][:5]}", "standard error", "The record", "Another record"):
        assert words in page
    assert page.count("<img") == 4
    files = [tmp_path / name for name in ("found.h5", "fit.svg", "page.html")]
    before = [file.read_bytes() for file in files]
    assert main(["identify", str(path), "run.csv", *given]) == 0
    assert before == [file.read_bytes() for file in files]
    assert main(["identify", str(path), "run.csv", *given, "--report", "page.pdf"]) == 2
    assert main(["check", "found.h5"]) == 0
    damaged = bytearray(before[0])
    damaged[len(damaged) // 2] ^= 1
    (tmp_path / "found.h5").write_bytes(bytes(damaged))
    assert main(["check", "found.h5"]) == 1
