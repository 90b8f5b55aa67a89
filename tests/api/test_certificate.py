"""The certificate: for every scene, by what was declared, and with consequences."""

import math
import subprocess

import casadi as ca
import h5py
import numpy as np
import pytest
from commands import command
from internals import (
    COARSE,
    DesignEngine,
    EvaluationMethod,
    Solution,
    Status,
    blocks,
    check,
    load,
    loops,
)
from internals import instants_refusal as refusal
from mechanisms import far, ladder, parallelogram, slider_crank

from lagrange_casadi import Mechanism, Scene, evaluate, export, save
from lagrange_casadi.cli import main
from lagrange_casadi.errors import AssemblyError, CertificateError, CertificateWarning
from lagrange_casadi.motion import harmonic, polynomial

pytestmark = pytest.mark.usefixtures("interpreted")

WHOLE = {"closure", "balance", "power", "ends"}


def residuals(solution):
    return {
        name: float(values.max())
        for name, values in solution.certificate.items()
        if name != "condition"
    }


def trammel():
    """A bar between two point masses on crossing lines: no joint gives its direction's rate, and
    its pins do.
    """
    m = Mechanism("trammel")
    bar, a, b = m.link("bar", length=0.5, mass=1.0), m.point_mass("a", 0.2), m.point_mass("b", 0.3)
    m.prismatic("A", m.ground, a, axis=(1, 0))
    m.prismatic("B", m.ground, b, axis=(0.3, 1))
    m.revolute("P", a, bar)
    m.revolute("Q", b, bar.tip)
    m.torsion_spring(
        "none", m.revolute("R", bar.at(0.2), m.link("flap", length=0.1, mass=0.1)), stiffness=0.0
    )
    return Scene(
        m,
        {"A": harmonic(0.3, 0.1, 1.0), "R": polynomial(0.2, 1.0)},
        t=(0, 1, 21),
        posture={"bar": 2.2},
    )


def directed():
    """A link pinned at a point mass, its direction prescribed by an equation alone."""
    m = Mechanism("directed")
    cart = m.point_mass("cart", 1.0)
    pole = m.link("pole", length=0.7, mass=0.4)
    m.prismatic("rail", m.ground, cart, axis=(1, 0))
    m.revolute("pin", cart, pole)
    m.constraint("tilt", m.direction(pole) - 1.4 - 0.3 * ca.sin(3 * m.time))
    m.force("wind", pole.tip, x=2.0)
    return Scene(m, {"rail": harmonic(0.0, 0.2, 1.0)}, t=(0, 1, 21), posture={"pole": 1.4})


def geared():
    m = Mechanism("geared")
    a, b = m.link("a", length=0.2, mass=1.0), m.link("b", length=0.3, mass=2.0)
    first, second = m.revolute("A", m.ground, a), m.revolute("B", m.ground.at(1, 0), b)
    m.gear("mesh", first, second, ratio=-2.0)
    return Scene(m, {"A": polynomial(0.1, 9.0)}, posture={"b": -0.2}, t=(0, 3, 31))


def on_a_parabola():
    m = Mechanism("parabola")
    a, b = m.link("a", length=0.5, mass=1.0), m.link("b", length=0.4, mass=0.7)
    m.revolute("A", m.ground, a)
    m.revolute("B", a.tip, b)
    x, y = m.place(b.tip)
    m.constraint("way", y - 0.3 * x * x - 0.1 * m.time)
    return Scene(m, {"A": polynomial(1.0, -0.4)}, t=(0, 0.8, 21), posture={"b": -1.0})


@pytest.mark.sampled(7)
@pytest.mark.quick
@pytest.mark.parametrize(
    "made", [ladder, trammel, directed, geared, on_a_parabola, slider_crank, parallelogram]
)
def test_it_is_whole_for_every_scene(made):
    """Whatever holds the bodies: point masses, users' equations, gears; and where equilibrium
    leaves reactions open.
    """
    solution = evaluate(made())
    found = residuals(solution)
    assert set(found) == WHOLE
    assert max(found.values()) < 1e-12
    assert solution.certified


@pytest.mark.parametrize("wanted", [["effort"], ["effort", "reaction:guide"]])
def test_loops_are_looked_at_whatever_is_wanted(wanted):
    solution = evaluate(slider_crank(), wanted=wanted)
    assert residuals(solution)["closure"] < 1e-15
    assert solution.certified


def test_multipliers_that_were_not_wanted_are_known_to_it():
    scene = geared()
    solution = evaluate(
        scene, wanted=["motion", "effort", "reaction:A", "reaction:B", "section:a", "section:b"]
    )
    assert "multiplier:mesh" not in solution.series
    assert set(residuals(solution)) == WHOLE


def broken():
    """Arithmetic that takes a cosine for a sine, by a flag of the compiler: the crank's direction
    is none.
    """
    return evaluate(slider_crank(), backend="c", flags="-Dsin=cos")


@pytest.mark.quick
def test_a_result_that_fails_is_marked():
    with pytest.warns(
        CertificateWarning, match=r"the certificate fails: closure .* the solution is not certified"
    ):
        solution = broken()
    assert not solution.certified
    assert set(solution.failed) == {
        name for name, value in residuals(solution).items() if value > 1e-9
    }


def test_a_file_of_a_result_that_fails_is_marked(tmp_path):
    with pytest.warns(CertificateWarning):
        save(broken(), tmp_path / "wrong.h5")
    save(evaluate(slider_crank()), tmp_path / "right.h5")
    for name, certified in (("wrong", False), ("right", True)):
        with h5py.File(tmp_path / f"{name}.h5") as file:
            assert bool(file.attrs["certified"]) is certified
        assert load(tmp_path / f"{name}.h5").certified is certified
    assert not check(tmp_path / "right.h5")
    assert any("worse than the tolerance" in finding for finding in check(tmp_path / "wrong.h5"))


def test_run_ends_with_a_status_where_the_certificate_fails(here, capsys):
    assert command("run CASE --backend c --flags=-Dsin=cos --no-figures") == 1
    told = capsys.readouterr()
    assert "slider_crank.h5 is marked as not certified" in told.err.splitlines()[-1]
    assert "certificate: relative residuals closure" in told.out
    assert main(["check", "slider_crank.h5"]) == 1


def test_a_sweep_ends_with_a_status_where_a_certificate_fails(here, capsys):
    """The designs that are kept need not hold what shows it: one of a block is evaluated with all
    outputs, and compared.
    """
    line = "sweep CASE --grid l=0.2:0.4:9 --want effort --out s.h5 --quiet --backend c"
    assert command(line) == 0
    assert command(f"{line} --flags=-Dsin=cos --force") == 1
    assert "checked in full, one of each block, fails its certificate" in capsys.readouterr().err
    with h5py.File("s.h5") as file:
        status, effort = file["status"][()], file["peak/effort/O"][()]
    assert np.sum(status == Status.UNCERTIFIED) == 1
    assert np.array_equal(np.isnan(effort), status != 0)
    capsys.readouterr()
    assert main(["check", "s.h5"]) == 1
    said = (
        "s.h5: 1 design, of those that were checked in full, without a certificate: others may be"
        " wrong as well\n"
    )
    assert capsys.readouterr().err == said


def test_the_tolerance_has_a_ceiling():
    """An angle of 1e9 rad is reported to 1e-7: no reason to believe any residual."""
    m = Mechanism("wheel")
    m.revolute("A", m.ground, m.link("a", length=1.0, mass=1.0))
    solution = evaluate(Scene(m, {"A": polynomial(0, 1e5)}, t=(-1e9, 1e9, 11)))
    assert solution.tolerance == COARSE


def mistaken(monkeypatch):
    """A scene whose equations are taken for two circles, which they are not: as a pattern that
    nobody verified.
    """
    monkeypatch.setattr(loops, "_turns", lambda *_: True)
    monkeypatch.setattr(blocks, "solves", lambda *_: True)
    m = Mechanism("mistaken")
    a, b = m.link("a", length=0.6, mass=1.0), m.link("b", length=0.5, mass=1.2)
    m.revolute("A", m.ground, a)
    m.revolute("B", a.tip, b)
    m.prismatic(
        "S", m.ground.at(0, -1), m.point_mass("s", m.parameter("mass", 1.0, "kg")), axis=(1, 0)
    )
    m.constraint("height", m.place(b.tip)[1] - 0.471)
    m.constraint("middle", m.place(b.at(0.25))[0] - 0.7)
    return Scene(m, {"S": polynomial(0.0, 0.1)}, t=(0, 1, 41), posture={"a": 0.9, "b": -0.1})


@pytest.mark.sampled(5)
@pytest.mark.parametrize(
    "method",
    [
        EvaluationMethod("vm"),
        EvaluationMethod("c"),
        EvaluationMethod("lanes"),
        EvaluationMethod("lanes", precision="single"),
    ],
)
def test_what_does_not_close_a_loop_is_refused(method, monkeypatch, fresh_cache):
    """By every backend, also where only the effort is wanted, and in sweeps."""
    scene = mistaken(monkeypatch)
    told = {"backend": method.backend, "precision": method.precision}
    for wanted in (["all"], ["effort"]):
        with pytest.raises(
            AssemblyError,
            match=r"of the loop closed by constraint 'middle' does not close it at t = 0 s",
        ):
            evaluate(scene, wanted=wanted, **told)
    outcome = DesignEngine.of(scene, ["effort"], method=method).evaluate(np.ones((2, 1)))
    assert outcome.status.tolist() == [Status.NOT_CLOSED] * 2
    assert np.isnan(outcome.value).all()


def test_exported_c_refuses_what_does_not_close_a_loop(monkeypatch, fresh_cache, tmp_path):
    """Made as if nobody looked: evaluation and the certificate would not let it through."""
    scene = mistaken(monkeypatch)
    monkeypatch.setattr(refusal, "refusal", lambda *_: None)
    monkeypatch.setattr(Solution, "failed", {})
    export(scene, tmp_path / "c")
    (tmp_path / "c" / "look.c").write_text(
        '#include <stdio.h>\n#include "mistaken.h"\nint main(void) {\n  mistaken_model model;\n '
        " mistaken_inputs in;\n  mistaken_outputs out;\n  mistaken_prepare(&model, 0);\n "
        ' mistaken_motion(&model, 0.0, &in);\n  printf("%s",'
        " mistaken_message(mistaken_evaluate(&model, &in, &out)));\n  return 0;\n}\n"
    )
    subprocess.run(
        ["cc", "look.c", "mistaken.c", "-lm", "-o", "look"], cwd=tmp_path / "c", check=True
    )
    told = subprocess.run(
        ["./look"], cwd=tmp_path / "c", capture_output=True, text=True, check=True
    ).stdout
    assert told == "the solution of a loop does not satisfy its equations"


def test_what_fails_its_certificate_is_not_exported(monkeypatch, tmp_path):
    monkeypatch.setattr(Solution, "failed", {"balance": 0.1})
    with (
        pytest.raises(
            CertificateError, match=r"cannot export .*: the certificate fails: balance 0.1"
        ),
        pytest.warns(CertificateWarning),
    ):
        export(slider_crank(), tmp_path / "c")
    assert not (tmp_path / "c").exists()


def test_a_gap_far_from_the_origin_is_judged_by_the_places_that_it_is_between():
    """A four-bar a kilometre away: places have lost three digits, and nothing is wrong."""
    near, away = evaluate(far(0.0)), evaluate(far(1e6))
    np.testing.assert_allclose(
        away.effort("O"), near.effort("O"), atol=1e-6 * np.max(np.abs(near.effort("O")))
    )
    assert math.isclose(away.certificate["closure"].max(), 0.0, abs_tol=1e-9)


def test_what_has_no_motion_to_tell_is_evaluated_without_it():
    """A structure of welds alone, of which only a reaction is wanted: no body's place is told, so
    there is nothing to check.
    """
    m = Mechanism("bracket")
    m.weld("A", m.ground, m.link("arm", length=1.0, mass=1.0))
    solution = evaluate(Scene(m, {}, t=(0, 0, 1)), wanted=["reaction:A"])
    assert solution.reaction("A").mz[0] == pytest.approx(9.81 / 2)
    assert not solution.certificate
