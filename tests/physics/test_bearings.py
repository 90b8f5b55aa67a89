"""Pins and bearings against textbooks, closed forms, and the reactions of a mechanism."""

import math

import numpy as np
import pytest
from commands import command

from lagrange_casadi import (
    Mechanism,
    Scene,
    SpatialMechanism,
    beams,
    bearings,
    evaluate,
    load,
    save,
    sweep,
)
from lagrange_casadi.errors import DeclarationError
from lagrange_casadi.motion import polynomial

STEEL = beams.material("C45+QT")
SPEED = 40.0


def rotor(*parts, scale=1.0):
    """A rotor of 2 kg whose centre is 0.05 m beside its axis, turning evenly: its reaction is m w^2
    r and its weight.
    """
    m = Mechanism("rotor")
    r = m.parameter("r", 0.05 * scale, "m", low=0.0)
    disc = m.link("disc", length=0.2, mass=2.0, centre=(r, 0.0), inertia=0.01)
    bearings.fit(m, m.revolute("O", m.ground, disc), *parts)
    return Scene(m, {"O": polynomial(0.0, SPEED)}, t=(0.0, 2 * math.pi / SPEED, 201))


def reaction(t):
    """Its size, as a vector sum."""
    spun, weight = 2.0 * SPEED**2 * 0.05, 2.0 * 9.81
    return np.hypot(-spun * np.cos(SPEED * t), weight - spun * np.sin(SPEED * t))


def test_a_rating_of_a_textbook():
    """Shigley, Mechanical Engineering Design, 9th edition, example 11-1: 400 lbf, 5000 h at 1725
    1/min need 14.3 kN.
    """
    assert bearings.rated_hours(14.3e3, 1.78e3, 1725.0) == pytest.approx(5000.0, rel=0.01)


def test_the_cubic_mean_of_a_load_that_swings():
    """Shigley, example 11-6: of F + A sin it is F (1 + 3/2 (A/F)^2)^(1/3)."""
    angles = np.arange(3600) * math.tau / 3600
    found = bearings.equivalent_load(1000.0 + 400.0 * np.sin(angles), np.ones(3600))
    assert found == pytest.approx(1000.0 * (1.0 + 1.5 * 0.4**2) ** (1 / 3), rel=1e-12)


def test_loads_one_after_another():
    """By the sum of wear: turns over lives of each load are one over the whole life."""
    loads, turns, c = np.array([2e3, 5e3, 1e3]), np.array([3.0, 1.0, 6.0]), 30e3
    wear = (
        sum(n / (c / load) ** (10 / 3) for n, load in zip(turns, loads, strict=True)) / turns.sum()
    )
    assert (c / bearings.equivalent_load(loads, turns, 10 / 3)) ** (10 / 3) == pytest.approx(
        1 / wear, rel=1e-12
    )


def test_a_pin_bends_as_a_beam_does():
    """The moment in the middle, by sums over small pieces of both loads."""
    eye, cheek, gap, force = 0.03, 0.016, 0.002, 5e3
    half = (np.arange(2000) + 0.5) / 2000
    inner = -np.sum(force / 2 / 2000 * half * eye / 2)
    outer = force / 2 * np.mean(eye / 2 + gap + half * cheek)
    assert bearings.bending_of_pin(force, eye, cheek, gap) == pytest.approx(inner + outer, rel=1e-9)


@pytest.fixture(scope="module")
def solution():
    parts = (
        bearings.Pin(0.012, eye=0.02, cheek=0.01, material=STEEL, pressure=20e6),
        bearings.Plain(0.012, 0.02, pressure=10e6, speed=1.0, heating=2e6),
        bearings.Rolling(5e3, hours=2000.0, static=3e3),
    )
    return evaluate(rotor(*parts), wanted=["safety:O"])


def test_factors_follow_from_the_reaction(solution):
    found, force = solution.safety("O"), reaction(solution.t)
    most = force.max()
    w, area = math.pi * 0.012**3 / 32, math.pi * 0.012**2 / 4
    told = {
        "bending of pin": 490e6 * w / (most * 0.04 / 8),
        "shear of pin": 490e6 / math.sqrt(3) * area * 2 * 3 / 4 / most,
        "pressure in eye": 20e6 * 0.012 * 0.02 / most,
        "pressure in fork": 20e6 * 0.012 * 0.02 / most,
        "pressure": 10e6 * 0.012 * 0.02 / most,
        "speed": 1.0 / (SPEED * 0.006),
        "heating": 2e6 * 0.012 * 0.02 / (force[:-1].mean() * SPEED * 0.006),
        "static load": 3e3 / most,
    }
    cubic = (force[:-1] ** 3).mean() ** (1 / 3)
    hours = (5e3 / cubic) ** 3 * 1e6 / (60 * SPEED * 60 / math.tau)
    told["life of bearing"] = (hours / 2000.0) ** (1 / 3)
    assert {verdict.against: verdict.factor for verdict in found.verdicts} == pytest.approx(
        told, rel=1e-9
    )
    assert found.not_evaluated == ()


def test_a_file_tells_the_same_again(solution, tmp_path):
    save(solution, tmp_path / "a.h5")
    assert load(tmp_path / "a.h5").safety("O") == solution.safety("O")


def test_in_space_the_force_along_the_pin_is_axial():
    m = SpatialMechanism("rotor")
    disc = m.link("disc", length=0.2, mass=2.0)
    joint = m.revolute("O", m.ground, disc, axis=(0, 0, 1))
    m.force("push", disc.base, z=-100.0)
    bearings.fit(m, joint, bearings.Rolling(5e3, hours=1.0, static=1e3, radial=0.5, axial=1.5))
    solution = evaluate(
        Scene(m, {"O": polynomial(0.0, SPEED)}, t=(0, 0.1, 21)), wanted=["safety:O"]
    )
    radial = 2.0 * SPEED**2 * 0.1
    factor = 1e3 / (0.5 * radial + 1.5 * (100.0 + 2.0 * 9.81))
    assert solution.safety("O").against("static load") == pytest.approx(factor, rel=1e-9)


def test_what_is_open_is_told():
    scene = rotor(bearings.Plain(0.012, 0.02, heating=1e6), bearings.Rolling(5e3, hours=1.0))
    solution = evaluate(scene, wanted=["reaction:O"])
    assert [told.partition(":")[0] for told in solution.safety("O").not_evaluated] == [
        "plain bearing",
        "rolling bearing",
    ]
    with pytest.raises(DeclarationError, match="not evaluated; add reaction:O too"):
        evaluate(scene, wanted=["effort"]).safety("O")


@pytest.mark.parametrize(
    ("part", "told"),
    [
        (
            lambda: bearings.Pin(-0.01, 0.02, 0.01, STEEL),
            "joint 'O': pin: diameter must be positive, got -0.01",
        ),
        (
            lambda: bearings.Pin(0.01, 0.02, 0.01, beams.Material("wood", 500.0)),
            "material 'wood' has no yield_strength",
        ),
        (lambda: bearings.Plain(0.01, 0.02, speed=0.0), "speed must be positive, got 0"),
        (lambda: 3.0, "fit: parts: expected a Pin, a Plain or a Rolling, got 3"),
    ],
)
def test_parts_that_cannot_be(part, told):
    with pytest.raises(DeclarationError, match=told):
        rotor(part())


def test_of_each_kind_one():
    with pytest.raises(DeclarationError, match="the joint already has a rolling part"):
        rotor(bearings.Rolling(1e3, 1.0), bearings.Rolling(2e3, 1.0))


def test_a_slide_has_no_pin():
    m = Mechanism("m")
    joint = m.prismatic("P", m.ground, m.point_mass("a", 1.0), axis=(1, 0))
    with pytest.raises(DeclarationError, match="got a prismatic one"):
        bearings.fit(m, joint, bearings.Rolling(1e3, 1.0))


def test_a_sweep_tells_no_pins():
    with pytest.raises(
        DeclarationError, match="output 'safety:O': sweeps have no strength of pins and bearings"
    ):
        sweep(rotor(bearings.Rolling(1e3, 1.0)), {"r": [0.05]}, wanted=["safety:O"])


CASE = """
from lagrange_casadi import Mechanism, Scene, bearings
from lagrange_casadi.motion import polynomial
def scene():
    m = Mechanism("rotor")
    disc = m.link("disc", length=0.2, mass=2.0, centre=(0.05, 0.0), inertia=0.01)
    bearings.fit(m, m.revolute("O", m.ground, disc), bearings.Rolling(1e3, hours=20.0))
    return Scene(m, {"O": polynomial(0.0, 40.0)}, t=(0.0, 0.157, 21))
"""


def test_run_tells_what_governs(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "case.py").write_text(CASE)
    assert command("run case.py --no-figures --no-certificate --backend vm --want safety") == 0
    assert "  O   " in (out := capsys.readouterr().out)
    assert "life of bearing governs" in out
