"""The trade: every rung measured, errors that are true, a front that nothing beats, and
recommendations that hold.
"""

import errno
import importlib
import itertools
import json
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from internals import COMPARED, EvaluationMethod, Measurement, Trade, trade
from internals import TRADE_METHODS as METHODS
from internals import TradeWork as Work
from internals import trade_in_turns as in_turns
from outside import doubled
from stepped import iterated

from lagrange_casadi import Mechanism, Scene, derive, evaluate, load_case, motion
from lagrange_casadi.cli import main
from lagrange_casadi.errors import AccuracyError, DeclarationError, StoreError

CASES = Path(__file__).parents[2] / "cases"
SOME = (
    EvaluationMethod("c"),
    EvaluationMethod("vm"),
    EvaluationMethod("c", "single"),
    EvaluationMethod("lanes", newton=1),
    EvaluationMethod("lanes", newton=2),
    EvaluationMethod("c", table=1e-6),
)
"""All that a mechanism may have whose loop is iterated, and whose one drive turns."""

WANTED = ("effort", "motion", "section")


@pytest.fixture(scope="module")
def measured():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(importlib.import_module("lagrange_casadi.studies.trade"), "QUIET", 3)
        return trade(iterated(WANTED), methods=SOME)


def test_every_rung_is_measured(measured):
    assert {one.method for one in measured.measurements} == set(SOME)
    assert not measured.refused
    assert all(
        0.0 < one.median <= one.largest < 1e-2 and 1e-10 < one.seconds < 1e-1
        for one in measured.measurements
    )
    counts = {one.method: one.instructions for one in measured.measurements}
    program = derive(iterated(WANTED))
    assert counts[EvaluationMethod("c")] == pytest.approx(
        sum(program.instructions.values()), rel=0.01
    )
    steps = (
        counts[EvaluationMethod("lanes", newton=2)] - counts[EvaluationMethod("lanes", newton=1)]
    )
    assert steps == program.instructions["loops"]
    assert list(measured.measurements) == sorted(measured.measurements, key=lambda one: one.seconds)


def test_times_are_those_of_a_processor_that_nothing_else_uses(monkeypatch):
    """Most calls of the fast work wait for others, as on a busy machine."""
    monkeypatch.setattr("lagrange_casadi.studies.trade.QUIET", 10)
    calls = itertools.count()

    def work(count, size, waits):
        def call():
            np.sort(np.arange(count * size) % 1009)
            time.sleep(2e-3 if waits and next(calls) % 9 else 0.0)

        return call

    ways = {"fast": (1000, True), "slow": (2000, False)}
    seconds = in_turns(
        {way: Work(partial(work, size=n, waits=w), 100) for way, (n, w) in ways.items()}
    )
    assert 1.2 < seconds["slow"] / seconds["fast"] < 4.0


@pytest.mark.long
def test_two_runs_on_a_busy_machine_recommend_the_same():
    scene, command = load_case("slider_crank").scene, "a = [1.0] * 10**6\nwhile True: a.sort()"
    busy = [subprocess.Popen([sys.executable, "-c", command]) for _ in range(3)]
    try:
        found = [trade(scene, methods=METHODS) for _ in range(2)]
    finally:
        for one in busy:
            one.kill()
            one.wait()
    for accuracy in (1e-3, 1e-6, 1e-9, 1e-13):
        for among in (found, [one.exported for one in found]):
            assert len({one.fastest(accuracy).method for one in among}) == 1


def test_errors_are_what_each_rung_may_have(measured):
    error = {one.method: one.largest for one in measured.measurements}
    assert error[EvaluationMethod("c")] == error[EvaluationMethod("vm")] < 1e-14
    assert 1e-8 < error[EvaluationMethod("c", "single")] < 2e-6
    assert (
        1e-14
        < error[EvaluationMethod("lanes", newton=2)]
        < error[EvaluationMethod("lanes", newton=1)] ** 1.5
    )
    assert 1e-9 < error[EvaluationMethod("c", table=1e-6)] <= 1e-6


def test_an_error_is_the_difference_that_there_is(measured):
    """By solutions of another backend, where the rung errs by far more than rounding."""
    scene = iterated(WANTED)
    exact, rough = evaluate(scene, backend="vm"), evaluate(scene, backend="lanes", newton=1)
    found = next(
        one for one in measured.measurements if one.method == EvaluationMethod("lanes", newton=1)
    )
    kept = np.unique(np.linspace(0, exact.t.size - 1, COMPARED).astype(int))
    gap = np.max(np.abs(exact.series[found.worst] - rough.series[found.worst])[kept]) / np.max(
        np.abs(exact.series[found.worst])
    )
    assert found.largest == pytest.approx(gap, rel=1e-6)


def entry(seconds, largest, backend="c"):
    return Measurement(
        EvaluationMethod(backend, flags=f"-D{seconds}"), seconds, 9, largest, largest, "effort:O"
    )


def test_the_front_and_the_fastest():
    found = Trade(
        "x",
        1,
        1,
        (entry(1, 1e-3), entry(2, 1e-2), entry(3, 1e-6), entry(4, 1e-6), entry(5, 1e-15)),
        {},
    )
    alike = Trade("x", 1, 1, (entry(10.5, 1e-6), entry(11, 1e-6), entry(13, 1e-6)), {})
    assert alike.fastest(1e-6).seconds == 11  # the shorter options of two that are equally fast
    assert [one.seconds for one in found.front] == [1, 3, 5]
    assert found.fastest(1e-3).seconds == 1
    assert found.fastest(9e-4).seconds == 3
    with pytest.raises(
        AccuracyError,
        match=(
            r"no method evaluates 'x' to 1e-16 .*; the best, --backend c --flags -D5, has an error"
            r" of 1e-15 \("
        ),
    ):
        found.fastest(1e-16)
    for wrong in (0.0, -1.0, float("nan")):
        with pytest.raises(DeclarationError, match="accuracy: expected a finite number above 0"):
            found.fastest(wrong)


def test_what_a_scene_has_not_is_refused_with_the_reason():
    found = trade(
        load_case(CASES / "arm").scene,
        t=(0, 2, 11),
        wanted=["effort"],
        methods=(
            EvaluationMethod("c"),
            EvaluationMethod("c", table=64),
            EvaluationMethod("c", newton=1),
        ),
    )
    assert [one.method for one in found.measurements] == [EvaluationMethod("c")]
    assert list(found.refused) == ["--backend c --table 64"]
    assert "one driven joint" in found.refused["--backend c --table 64"]


@pytest.mark.long
def test_what_is_zero_but_for_rounding_is_judged_beside_other_motions():
    """A cardan shaft in phase: its tube turns about one axis, so that all of some unit is zero."""
    found = trade(
        load_case("cardan_shaft").scene,
        wanted=["section:tube"],
        t=(0.0, 0.1, 9),
        methods=(EvaluationMethod("c"), EvaluationMethod("c", table=1e-6)),
    )
    exact, table = sorted(found.measurements, key=lambda one: one.largest)
    assert exact.largest < 1e-12
    assert table.largest < 1e-5


def test_what_exported_c_can_be_is_recommended_apart():
    methods = (
        EvaluationMethod("lanes", "single"),
        EvaluationMethod("c", flags="-O1"),
        EvaluationMethod("c", "single"),
        EvaluationMethod("c", newton=2),
        EvaluationMethod("vm"),
    )
    errors = (1e-7, 1e-15, 1e-7, 1e-12, 1e-15)
    measured = tuple(
        Measurement(method, k, 9, error, error, "effort:O")
        for k, (method, error) in enumerate(zip(methods, errors, strict=True))
    )
    found = Trade("x", 1, 1, measured, {})
    assert found.fastest(1e-6).method == EvaluationMethod("lanes", "single")
    assert found.exported.fastest(1e-6).method == EvaluationMethod("c", "single")
    assert found.exported.fastest(1e-9).method == EvaluationMethod("c", newton=2)


def test_graphs_that_call_functions_have_no_reference():
    m = Mechanism("arm")
    arm = m.link("arm", length=1, mass=1)
    joint = m.revolute("J", m.ground, arm)
    m.torque("t", arm, doubled(m.coordinate(joint)))
    with pytest.raises(DeclarationError, match="has no C: it calls another one"):
        trade(
            Scene(m, {"J": motion.polynomial(0.3, 1)}, t=(0, 1, 9)),
            methods=(EvaluationMethod("c"),),
        )


@pytest.mark.long
def test_the_command(tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("lagrange_casadi.studies.trade.METHODS", METHODS)
    monkeypatch.setattr("lagrange_casadi.studies.trade.QUIET", 1)
    arguments = ["trade", str(CASES / "slider_crank"), "--want", "effort", "--t", "0:0.08:201"]
    assert main([*arguments, "--accuracy", "1e-9"]) == 0
    out, err = capfd.readouterr()
    assert "fastest within 1e-09: --backend" in out
    assert "fastest within 1e-09 in exported C: --backend c" in out
    assert "x lanes" in out
    assert "error" not in err
    stored = json.loads((tmp_path / "slider_crank_trade.json").read_text())
    assert {one["options"] for one in stored["rungs"]} == {
        method.options for method in METHODS if method.newton is None
    }
    assert any(one["front"] for one in stored["rungs"])
    assert len(stored["peaks"]) > 3
    assert (tmp_path / "slider_crank_trade.png").stat().st_size > 10_000
    assert main([*arguments, "--accuracy", "1e-30"]) == 1
    out, err = capfd.readouterr()
    assert err.startswith(
        "error: no method evaluates 'slider_crank' to 1e-30 of the peak; the best, "
    )
    assert err.count("\n") == 1


@pytest.mark.parametrize("failing", ["draw", "disk"])
def test_both_files_or_none(tmp_path, monkeypatch, capfd, failing):
    """Neither a drawing that fails nor a disk that is full at the second file leaves the first."""
    monkeypatch.chdir(tmp_path)
    command = importlib.import_module("lagrange_casadi.cli.trade")
    monkeypatch.setattr(
        command, "measure", lambda *_, **__: Trade("x", 1, 1, (entry(1, 1e-3),), {})
    )
    (tmp_path / "x.json").write_text("of before")

    def fail(_trade, file, _ending):
        if failing == "draw":
            raise StoreError("cannot be drawn")
        file.write(b"half")
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(command, "draw_trade", fail)
    assert main(["trade", str(CASES / "slider_crank"), "--out", "x.json", "--figure", "x.png"]) == 1
    told = {
        "draw": "cannot be drawn",
        "disk": "cannot write x.json and x.png: No space left on device",
    }
    assert capfd.readouterr() == ("", f"error: {told[failing]}\n")
    assert [path.name for path in tmp_path.iterdir()] == ["x.json"]
    assert (tmp_path / "x.json").read_text() == "of before"


@pytest.mark.parametrize(
    "words", [["--figure", "x.txt"], ["--out", "x.png"], ["--out", "nowhere/x.json"]]
)
def test_a_wrong_name_is_said_before_anything_is_measured(words, tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    assert main(["trade", str(CASES / "slider_crank"), *words]) == 2
    err = capfd.readouterr().err
    assert err.startswith("error: ")
    assert words[1] in err
    assert err.count("\n") == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("accuracy", ["0", "-1", "nan"])
def test_a_wrong_accuracy_is_said_before_anything_is_measured(
    accuracy, tmp_path, monkeypatch, capfd
):
    monkeypatch.chdir(tmp_path)
    assert main(["trade", str(CASES / "slider_crank"), "--accuracy", accuracy]) == 2
    assert capfd.readouterr().err.startswith("error: accuracy: expected a finite number above 0")
    assert not list(tmp_path.iterdir())
