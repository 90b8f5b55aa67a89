"""The certificate: for every scene, by what was declared, and with consequences."""

import functools

import h5py
import numpy as np
import pytest
from commands import command
from mechanisms import double_crank, slider_crank

from lagrange_casadi import Solution, check, evaluate, export, load, save
from lagrange_casadi.cli import main
from lagrange_casadi.errors import CertificateError, CertificateWarning

pytestmark = pytest.mark.usefixtures("interpreted")

WHOLE = {"closure", "balance", "power", "ends"}


def residuals(solution):
    return {
        name: float(values.max())
        for name, values in solution.certificate.items()
        if name != "condition"
    }


geared = functools.partial(double_crank, 0.1)


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
    assert np.sum(status != 0) == 1
    assert np.array_equal(np.isnan(effort), status != 0)
    capsys.readouterr()
    assert main(["check", "s.h5"]) == 1
    said = (
        "s.h5: 1 design, of those that were checked in full, without a certificate: others may be"
        " wrong as well\n"
    )
    assert capsys.readouterr().err == said


def test_it_is_whole_whatever_is_wanted():
    """Loops alone where no force is wanted of all parts; multipliers that were not wanted too."""
    for wanted in (["effort"], ["effort", "reaction:guide"]):
        solution = evaluate(slider_crank(), wanted=wanted)
        assert residuals(solution)["closure"] < 1e-15
        assert solution.certified
    wanted = ["motion", "effort", "reaction", "section"]
    assert set(residuals(evaluate(geared(), wanted=wanted))) == WHOLE


def test_a_file_and_a_run_of_a_result_that_fails_are_marked(here, capsys, monkeypatch):
    with pytest.warns(CertificateWarning):
        save(broken(), "wrong.h5")
    save(evaluate(slider_crank()), "right.h5")
    for name, certified in (("wrong", False), ("right", True)):
        assert load(f"{name}.h5").certified is certified
        told = [finding for finding in check(f"{name}.h5") if "worse than the tolerance" in finding]
        assert bool(told) is not certified
    assert command("run CASE --backend c --flags=-Dsin=cos --no-figures") == 1
    told = capsys.readouterr()
    assert "slider_crank.h5 is marked as not certified" in told.err.splitlines()[-1]
    assert "certificate: relative residuals closure" in told.out
    assert command("check slider_crank.h5") == 1
    monkeypatch.setattr(Solution, "failed", {"balance": 0.1})
    says = r"cannot export .*: the certificate fails: balance 0.1"
    with pytest.raises(CertificateError, match=says), pytest.warns(CertificateWarning):
        export(slider_crank(), "c")
    assert not (here / "c").exists()
