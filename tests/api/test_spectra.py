"""Load spectra as files, and loads of bearings for catalogues."""

import csv
import math

import numpy as np
import pytest
from internals import rainflow

from lagrange_casadi import (
    Mechanism,
    Scene,
    bearing_loads,
    errors,
    evaluate,
    link_load_cases,
    load_case,
    write_spectrum,
)
from lagrange_casadi.motion import harmonic, polynomial

pytestmark = pytest.mark.usefixtures("interpreted")


@pytest.fixture(scope="module")
def engine():
    return evaluate(load_case("connecting_rod").scene, wanted=["all"], t=(0, 0.07, 141))


def test_instants_of_the_largest_stresses_govern(engine):
    cases = link_load_cases(engine, "rod")
    found = {name: case.t for case in cases for name in case.governs if name.startswith("stress")}
    assert set(found) == {f"stress:rod:{kind}" for kind in ("normal", "shear", "von_mises")}
    for name, t in found.items():
        assert t == engine.stress("rod").peak(name.split(":")[-1]).t


def rows(path):
    first, *lines = path.read_text().splitlines()
    assert first.startswith("# ")
    return [{k: float(x) for k, x in row.items()} for row in csv.DictReader(lines)]


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("reaction:crankpin:fx", "N"),
        ("section:rod:bending@0.5", "N m"),
        ("stress:rod@0.25", "Pa"),
    ],
)
def test_classes_hold_the_cycles(engine, name, unit, tmp_path):
    file = tmp_path / "spectrum.csv"
    write_spectrum(engine, name, file, classes=0)
    assert file.read_text().startswith(f"# {name} [{unit}], counted over ")
    exact = rows(file)
    write_spectrum(engine, name, file, classes=20)
    classed = rows(file)
    total = sum(row["cycles"] for row in exact)
    assert sum(row["cycles"] for row in classed) == total
    widest = max(row["range"] for row in exact)
    for row in exact:
        assert row["range_low"] == row["range"] == row["range_high"]
    for row in classed:
        held = [
            one
            for one in exact
            if row["range_low"] <= one["range"] * (1 + 1e-12)
            and one["range"] <= row["range_high"] * (1 + 1e-12)
        ]
        assert held
        assert abs(row["range"] - held[0]["range"]) <= widest / 20


def test_cycles_are_those_of_the_history(engine, tmp_path):
    law = engine.section("rod").law
    history = law.at("bending", np.full((engine.t.size, 1), 0.5))[:, 0]
    write_spectrum(engine, "section:rod:bending@0.5", tmp_path / "s.csv", classes=0)
    expected = [one for one in rainflow(history, repeating=True) if one.size > 0.0]
    found = [(row["range"], row["mean"]) for row in rows(tmp_path / "s.csv")]
    found = [
        pair
        for pair, row in zip(found, rows(tmp_path / "s.csv"), strict=True)
        for _ in range(int(row["cycles"]))
    ]
    assert sorted(found) == sorted((one.size, one.mean) for one in expected)
    normal = engine.stress("rod").at(0.25)[0]
    write_spectrum(engine, "stress:rod@0.25", tmp_path / "s.csv", classes=0)
    assert max(row["range"] for row in rows(tmp_path / "s.csv")) == np.ptp(normal, axis=1).max()


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("section:rod:bending", "give a ratio too, as in 'section:rod:bending@0.5'"),
        ("section:rod:bending@1.5", "expected section:LINK:FORCE@RATIO"),
        ("effort:main@0.5", "expected section:LINK:FORCE@RATIO"),
        ("section:rod:twist@0.5", "unknown section force 'twist'; valid: axial, shear, bending"),
    ],
)
def test_what_has_no_spectrum_is_named(engine, name, words, tmp_path):
    with pytest.raises(errors.DeclarationError, match=words):
        write_spectrum(engine, name, tmp_path / "s.csv")
    assert not (tmp_path / "s.csv").exists()


def test_loads_of_a_bearing_are_those_of_its_turns():
    """A disc off its axis: the load turns with it; in an arm that swings the speed is its mean."""
    m = Mechanism("disc")
    m.set_gravity(0.0, 0.0)
    disc = m.link("disc", length=0.1, mass=2.0, centre=(0.05, 0.0), inertia=0.01)
    m.revolute("O", m.ground, disc)
    turning = evaluate(Scene(m, {"O": polynomial(0, 50.0)}, t=(0, 0.1, 21)))
    found = bearing_loads(turning, "O")
    force = 2.0 * 0.05 * 50.0**2
    assert math.isclose(found.radial, force, rel_tol=1e-12)
    assert math.isclose(found.largest_radial, force, rel_tol=1e-12)
    assert math.isclose(found.speed, 50.0 * 60.0 / math.tau, rel_tol=1e-12)
    assert (found.axial, found.largest_axial) == (0.0, 0.0)
    swinging = evaluate(Scene(m, {"O": harmonic(0, 0.5, 1.0)}, t=(0, 1.0, 2001)))
    found = bearing_loads(swinging, "O", 10.0 / 3.0)
    # Four times 0.5 rad in a second.
    assert math.isclose(found.speed, 2.0 * 60.0 / math.tau, rel_tol=1e-5)
    rate = math.tau * 0.5 * np.abs(np.cos(math.tau * swinging.t))
    across = np.hypot(swinging.reaction("O").fx, swinging.reaction("O").fy)
    mean = np.sum(across ** (10 / 3) * rate) / np.sum(rate)
    assert math.isclose(found.radial, mean**0.3, rel_tol=1e-3)
    with pytest.raises(errors.DeclarationError, match="reaction of joint 'O' was not evaluated"):
        bearing_loads(
            evaluate(Scene(m, {"O": polynomial(0, 1)}, t=(0, 1, 3)), wanted=["effort"]), "O"
        )
