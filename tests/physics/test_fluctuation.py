"""The fluctuation of energy of a drive, in sweeps and searches: against closed forms, and against
the integral that a free machine's flywheel is sized by.
"""

import math

import casadi as ca
import numpy as np
import pytest
from conftest import CASES
from internals import DesignEngine, DriveEnergy, EvaluationMethod, Output

from lagrange_casadi import Mechanism, Scene, flywheel, load_case, optimise, sweep
from lagrange_casadi.cli import main
from lagrange_casadi.errors import DeclarationError, UnknownNameError
from lagrange_casadi.motion import harmonic, polynomial

pytestmark = pytest.mark.usefixtures("interpreted")
TERM = "fluctuation:effort:O"


def rotor(motion=None, t=None):
    """A disc against a torque with a third harmonic."""
    m = Mechanism("rotor")
    m.set_gravity(0.0, 0.0)
    third = m.parameter("third", 0.5, "N*m")
    speed = m.parameter("speed", 10.0, "rad/s")
    disc = m.link("disc", length=0.2, mass=3.0, centre=(0.0, 0.0), inertia=0.5)
    angle = m.coordinate(m.revolute("O", m.ground, disc))
    m.torque("load", disc, -(2.0 + 6.0 * ca.sin(angle) + third * ca.sin(3.0 * angle)))
    turn = polynomial(0.3, speed) if motion is None else motion
    return Scene(m, {"O": turn}, t=t or (0.0, math.tau / speed, 41), wanted=["effort"])


def test_a_sweep_keeps_the_fluctuation_of_energy():
    """The energy is 6 cos(x) + third/3 cos(3 x), which at third = -3 turns at 30 deg."""
    found = sweep(rotor(), {"third": [0.0, 0.5, -3.0], "speed": [5.0, -8.0]}, fluctuation=True)
    exact = np.array([12.0, 12.0 + 1.0 / 3.0, 6.0 * math.sqrt(3.0)])
    assert np.abs(found[TERM][:, 0] / exact - 1.0).max() < 1e-9
    assert np.isnan(found[TERM][:, 1]).all()  # a turn backwards ends before it begins
    assert found.columns[TERM].unit == "J"


def test_a_third_harmonic_is_chosen_that_evens_the_energy():
    """The least of max |cos(x) + q cos(3 x)| is sqrt(3)/2, at q = -1/6."""
    options = {"over": {"third": (-6.0, 4.0)}, "starts": 1, "screen": 4}
    found = optimise(rotor(), minimise=TERM, **options)
    assert found.converged
    assert found.objective == pytest.approx(6.0 * math.sqrt(3.0), rel=1e-9)
    assert found.values["third"] == pytest.approx(-3.0, abs=1e-6)
    # For a smaller third the energy turns at its ends alone: it is 12 + 2/3 third.
    other = optimise(rotor(), minimise="peak:effort:O", subject_to=[f"{TERM} <= 11"], **options)
    assert other.converged
    assert other.values["third"] == pytest.approx(-1.5, abs=1e-6)
    assert other.limits[0].multiplier == pytest.approx(1.5, rel=1e-6)


@pytest.mark.parametrize("name", ["punch_press", "beam_pump"])
def test_its_derivatives_are_those_of_its_value(name):
    """With corners in the load, an iterated loop, and a motion that parameters change."""
    scene = load_case(CASES / name).scene
    joint = next(iter(scene.laws))
    engine = DesignEngine.of(
        scene, ["effort"], method=EvaluationMethod("auto"), timing=scene.timing(None)
    )
    energy, p = DriveEnergy(engine, Output("effort", joint)), engine.program.data.defaults
    slopes = energy.slopes(p)
    for k in range(p.size):
        step = 1e-4 * (np.arange(p.size) == k) * (p[k] or 1.0)
        difference = energy.fluctuation(p + step) - energy.fluctuation(p - step)
        scale = energy.fluctuation(p) / (p[k] or 1.0)
        assert abs(difference / (2.0 * step[k]) - slopes[k]) < 1e-5 * abs(scale)


def test_a_press_is_chosen_that_needs_the_smallest_flywheel(tmp_path, capsys, monkeypatch):
    """The energy of a search is that of the flywheel, which is integrated as a motion."""
    monkeypatch.chdir(tmp_path)
    press = str(CASES / "punch_press")
    term = "fluctuation:effort:main"
    command = ["optimise", press, "--minimise", term, "--over", "mass=40:120"]
    assert main([*command, "--starts", "1", "--screen", "2"]) == 0
    said = capsys.readouterr().out
    assert "at mass = 120" in said
    energy = float(said.split(f"{term} = ")[1].split(" J")[0])
    heavy = {"mass": 120.0}
    wheel = flywheel(load_case(press), fluctuation=0.1, parameters=heavy, wanted=["effort"])
    assert energy == pytest.approx(wheel.energy, rel=1e-7)
    sweeping = ["sweep", press, "--grid", "mass=60,120", "--want", "effort", "--fluctuation"]
    assert main([*sweeping, "--out", "press.h5", "--quiet"]) == 0
    assert main(["best", "press.h5", "--minimise", term]) == 0
    assert f"{energy:.6g}" in capsys.readouterr().out
    assert main(["check", "press.h5"]) == 0


def test_what_has_no_fluctuation_is_refused():
    over = {"third": (0.0, 1.0)}
    with pytest.raises(DeclarationError, match="a fluctuation of energy is that of an effort"):
        optimise(rotor(), minimise="fluctuation:reaction:O:fx", over=over)
    with pytest.raises(UnknownNameError, match="effort of a joint whose motion is given"):
        optimise(rotor(), minimise="fluctuation:effort:P", over=over)
    with pytest.raises(DeclarationError, match="can be limited from above only"):
        optimise(rotor(), minimise="third", over=over, subject_to=[f"{TERM} >= 1"])
    with pytest.raises(DeclarationError, match="and none is in wanted="):
        sweep(rotor(), {"third": [1.0]}, wanted=["reaction"], fluctuation=True)
    swung = rotor(harmonic(0.0, 0.3, 1.0), t=(0.0, 1.0, 41))
    with pytest.raises(DeclarationError, match="joint 'O' ends where it began"):
        sweep(swung, {"third": [1.0]}, fluctuation=True)
