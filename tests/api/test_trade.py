"""The trade: every method measured, errors that are true, a front that nothing beats, and
recommendations that hold.
"""

import errno
import json
import re
from pathlib import Path

import numpy as np
import pytest
from commands import command
from matplotlib.figure import Figure

from lagrange_casadi import evaluate, load_case, peaks

COUNT = 51
ASKED = f"trade CASE --want effort --t 0:0.08:{COUNT}"


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    """The numbers of a trade, what the command printed, and where its files are."""
    folder = tmp_path_factory.mktemp("trade")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setattr("lagrange_casadi.studies.trade.QUIET", 2)
        lines: list[str] = []
        patch.setattr("lagrange_casadi.cli.trade.echo", lambda *told: lines.extend(told))
        assert command(f"{ASKED} --accuracy 1e-9") == 0
    return json.loads((folder / "slider_crank_trade.json").read_text()), lines, folder


def test_errors_are_those_of_evaluations(measured):
    """Single precision and a table err by far more than rounding: beside the virtual machine."""
    told, scene = measured[0], load_case("slider_crank").scene
    error = {one["options"]: one["largest"] for one in told["rungs"]}
    assert error["--backend c"] == error["--backend vm"] < 1e-14
    span = (0, 0.08, COUNT)
    exact = evaluate(scene, wanted=["effort"], t=span, backend="vm").effort("O")
    for options, words in (
        ("--backend c --precision single", {"precision": "single"}),
        ("--backend c --table 0.001", {"table": 1e-3}),
    ):
        found = evaluate(scene, wanted=["effort"], t=span, backend="c", **words).effort("O")
        gap = np.abs(found - exact).max() / np.abs(exact).max()
        assert error[options] == pytest.approx(gap, rel=1e-5)


def test_nothing_beats_the_front_and_the_recommendation_is_the_fastest(measured):
    """Times within 20 % are held to be equal; exported C is without flags."""
    told, lines, _ = measured
    for one in told["rungs"]:
        better = [
            other
            for other in told["rungs"]
            if other["largest"] <= one["largest"] and 1.2 * other["seconds"] < one["seconds"]
        ]
        assert not (one["front"] and better)
    for place, pattern in (("", ""), (" in exported C", r"^--backend c(?!.*--flags)")):
        among = [one for one in told["rungs"] if re.search(pattern, one["options"])]
        least = min(one["seconds"] for one in among if one["largest"] <= 1e-9)
        (line,) = [line for line in lines if line.startswith(f"fastest within 1e-09{place}: ")]
        chosen = line.partition(": ")[2].partition(" (")[0]
        (one,) = [one for one in among if one["options"] == chosen]
        assert one["largest"] <= 1e-9
        assert one["seconds"] <= 1.2 * least


def test_what_peaks_miss_is_told(measured):
    told, scene = measured[0], load_case("slider_crank").scene
    rows = peaks.shortfall(scene, [row["count"] for row in told["peaks"]], ["effort:O"])
    for row, own in zip(told["peaks"], rows, strict=True):
        assert row["sampled_worst"] == pytest.approx(own.sampled_worst, rel=1e-6)
    exact, sampled = told["searches"]
    assert 0.0 == exact["error"] < sampled["error"] <= sampled["bound"]


def test_both_files_or_none(here, monkeypatch, capfd):
    """A disk that is full at the second file leaves the first as it was."""
    monkeypatch.setattr("lagrange_casadi.studies.trade.QUIET", 1)
    Path("x.json").write_text("of before")

    def full(*_, **__):
        raise OSError(errno.ENOSPC, "No space left on device")

    asked = "trade arm --want effort --t 0:1:5 --out x.json --figure x.png --accuracy 1e-30"
    with monkeypatch.context() as patch:
        patch.setattr(Figure, "savefig", full)
        assert command(asked) == 1
    told = "error: cannot write x.png: No space left on device\n"
    assert capfd.readouterr() == ("", told)
    assert [path.read_text() for path in here.iterdir()] == ["of before"]
    assert command(asked) == 1
    told = "error: no method evaluates 'arm' to 1e-30 of the peak; the best, "
    assert capfd.readouterr().err.startswith(told)
    refused = json.loads(Path("x.json").read_text())["refused"]
    assert "one driven joint" in refused["--backend c --table 0.001"]
