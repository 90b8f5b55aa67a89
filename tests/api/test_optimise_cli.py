"""``lagrange-casadi optimise``: what it says and writes, its statuses, and the one line of every
mistake.
"""

import os
import signal
import time

import h5py
import numpy as np
import pytest
from commands import command
from internals import Descent, kind_of, verify

from lagrange_casadi import prepare
from lagrange_casadi.case import load_case

SOUGHT = "optimise CASE --minimise peak:effort:O"
ASKED = f"{SOUGHT} --over l=0.12:0.8 --starts 2"


def test_it_writes_a_file_and_a_picture(here, capfd):
    limit = "peak:section:rod:bending <= 1.2"
    line = f"{ASKED} --subject-to '{limit}' --out a.h5 --figure a.svg"
    assert command(line) == 0
    out, err = capfd.readouterr()
    assert err == ""
    assert out.startswith("slider_crank: peak:effort:O = 7.1794")
    assert f"  {limit}: 1.2, active; the objective falls by " in out
    assert "  2 of 2 starts converged, " in out
    assert out.endswith("wrote a.h5 and a.svg\n")
    assert (here / "a.svg").read_text().lstrip().startswith("<?xml")
    verify("a.h5")
    assert command("check a.h5") == 0
    assert capfd.readouterr().out == "a.h5: whole and consistent\n"
    assert command("info a.h5") == 1
    assert (
        "but that of a search for designs, which the command check reads" in capfd.readouterr().err
    )
    assert kind_of("a.h5") == "lagrange-casadi-optimum"
    with h5py.File("a.h5") as file:
        assert file.attrs["feasible"]
        assert file.attrs["converged"]
        assert file.attrs["residual"] <= 1e-8
        assert file["history"].shape[1] == len(file["history"].attrs["columns"]) == 5
        l = float(file["parameters/l"][()])
        assert file["limits/0"].attrs["active"]
        # The file tells the design, and that has this peak.
        peak = prepare(load_case("slider_crank").scene, wanted=["effort"]).peaks(l=l)
        assert abs(peak.value[0]) == pytest.approx(file.attrs["objective"], rel=1e-12)
        assert np.array_equal(file["starts/0/end"], [l]) or len(file["starts"]) == 2
    written = (here / "a.h5").read_bytes()
    assert command(line) == 0
    assert (here / "a.h5").read_bytes() == written


def test_limits_that_hold_nowhere_end_with_a_status(here, capfd):
    limit = "--subject-to peak:section:rod:bending<=0.01"
    assert command(f"{SOUGHT} --over l=0.2:0.3 --starts 1 {limit}") == 1
    out, _ = capfd.readouterr()
    assert "peak:section:rod:bending <= 0.01: 0.9417" in out
    assert "VIOLATED by 0.9317" in out
    assert "no design that was found is within all limits" in out
    assert "gains" not in out


def test_an_interrupt_leaves_the_best_so_far(here, capfd, monkeypatch):
    count = iter(range(100))

    def note(self, judged, own=Descent._note):
        own(self, judged)
        if next(count) == 1:
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(0.1)

    monkeypatch.setattr(Descent, "_note", note)
    assert command(f"{ASKED} --out a.h5") == 1
    out, err = capfd.readouterr()
    assert err == ""
    assert "stopped: the best design so far" in out
    with h5py.File("a.h5") as file:
        assert file.attrs["stopped"]
        assert len(file["history"]) == 2


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ("--over l=0.3", "expected NAME=LEAST:LARGEST, as in l=0.15:0.4, got 'l=0.3'"),
        ("--over l=0.1:0.2", "--over: parameter 'l' is listed twice"),
        ("--over k=0.1:0.2", "unknown parameter 'k'; valid: r, l"),
        ("--subject-to peak:effort:O", "expected a constraint such as"),
        ("--figure x.txt", "expected a name that ends in .png or .pdf or .svg"),
        ("--set l=0.2", "over: parameter 'l' is in over= and set to a value as well"),
        ("--out notes.txt", "--out notes.txt: expected a name that ends in .h5 or .hdf5"),
        ("--out nowhere/x.h5", "folder nowhere does not exist"),
    ],
)
def test_mistakes(here, capfd, options, said):
    assert command(f"{ASKED} {options}") == 2
    out, err = capfd.readouterr()
    assert out == ""
    assert err.startswith("error: ")
    assert err.count("\n") == 1
    assert said in err
    assert not list(here.iterdir())
