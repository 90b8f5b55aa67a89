"""The rungs: what goes together, what they are called, and how their mistakes are told."""

import importlib
import shlex

import numpy as np
import pytest
from internals import EvaluationMethod
from mechanisms import slider_crank
from stepped import two_rods
from sweeps import CASE

from lagrange_casadi import evaluate, export, load_case, prepare, sweep
from lagrange_casadi.cli import main
from lagrange_casadi.errors import DeclarationError, UnknownNameError

pytestmark = pytest.mark.quick

WRONG = [
    ({"backend": "gpu"}, UnknownNameError, "unknown backend 'gpu'; valid: auto, lanes, c, vm"),
    ({"precision": "half"}, UnknownNameError, "unknown precision 'half'; valid: double, single"),
    (
        {"newton": 0},
        DeclarationError,
        (
            "newton: expected a number of steps, from 1 to 1000 (after some ten nothing changes),"
            " got 0"
        ),
    ),
    (
        {"newton": 2.0},
        DeclarationError,
        (
            "newton: expected a number of steps, from 1 to 1000 (after some ten nothing changes),"
            " got 2.0"
        ),
    ),
    (
        {"newton": True},
        DeclarationError,
        (
            "newton: expected a number of steps, from 1 to 1000 (after some ten nothing changes),"
            " got True"
        ),
    ),
    (
        {"table": 3},
        DeclarationError,
        "table: expected a number of nodes, at least 8, or an accuracy between 0 and 1, got 3",
    ),
    ({"table": 1.0}, DeclarationError, "an accuracy between 0 and 1, got 1.0"),
    ({"table": 0.0}, DeclarationError, "an accuracy between 0 and 1, got 0.0"),
    ({"table": float("nan")}, DeclarationError, "an accuracy between 0 and 1, got nan"),
    ({"table": True}, DeclarationError, "an accuracy between 0 and 1, got True"),
    ({"table": "fine"}, DeclarationError, "an accuracy between 0 and 1, got 'fine'"),
    (
        {"flags": "-DNAME='open"},
        DeclarationError,
        'flags: expected options of a compiler, got "-DNAME=\'open": No closing quotation',
    ),
    ({"flags": 3}, DeclarationError, "flags: expected options of a compiler, got 3"),
    ({"newton": 1, "table": 64}, DeclarationError, "newton and table exclude each other"),
    (
        {"backend": "vm", "precision": "single"},
        DeclarationError,
        "backend 'vm' computes in doubles only",
    ),
    (
        {"backend": "vm", "flags": "-O1"},
        DeclarationError,
        "backend 'vm' compiles nothing; flags '-O1' need lanes or c",
    ),
]


@pytest.mark.parametrize(("words", "error", "says"), WRONG)
def test_what_does_not_go_together(words, error, says):
    """By itself, and when a scene is evaluated, before anything is derived."""
    for call in (lambda: EvaluationMethod(**words), lambda: evaluate(slider_crank(), **words)):
        with pytest.raises(error) as raised:
            call()
        assert says in str(raised.value)


@pytest.mark.parametrize(
    ("method", "options"),
    [
        (EvaluationMethod(), "(default)"),
        (
            EvaluationMethod("c", "single", flags="-O1"),
            "--backend c --precision single --flags -O1",
        ),
        (EvaluationMethod("vm", newton=2), "--backend vm --newton 2"),
        (EvaluationMethod("lanes", table=64), "--backend lanes --table 64"),
        (EvaluationMethod(table=1e-6), "--table 1e-06"),
        (EvaluationMethod(flags="-O1 -DNAME=3"), "--flags '-O1 -DNAME=3'"),
    ],
)
def test_a_rung_as_options(method, options, tmp_path, monkeypatch):
    """The command line takes them back."""
    assert method.options == options
    words = [] if options == "(default)" else shlex.split(options)
    taken = []
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(
        importlib.import_module("lagrange_casadi.cli.run"),
        "evaluate",
        lambda scene, **given: taken.append(given) or 1 / 0,
    )
    with pytest.raises(ZeroDivisionError):
        main(["run", str(CASE), "--no-figures", *words])
    assert EvaluationMethod(**{name: taken[0][name] for name in vars(method)}) == method


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (
            ["--newton", "0"],
            (
                "newton: expected a number of steps, from 1 to 1000 (after some ten nothing"
                " changes), got 0"
            ),
        ),
        (["--newton", "two"], "Invalid value for '--newton': 'two' is not a valid integer"),
        (
            ["--table", "3"],
            "table: expected a number of nodes, at least 8, or an accuracy between 0 and 1, got 3",
        ),
        (["--table", "2.5"], "an accuracy between 0 and 1, got 2.5"),
        (
            ["--table", "few"],
            "expected a number of nodes or an accuracy, as in 128 or 1e-6, got 'few'",
        ),
        (
            ["--precision", "half"],
            "Invalid value for '--precision': 'half' is not one of 'double', 'single'",
        ),
        (
            ["--backend", "vm", "--precision", "single"],
            "backend 'vm' computes in doubles only; precision 'single' needs lanes or c",
        ),
        (
            ["--backend", "vm", "--flags", "-O1"],
            "backend 'vm' compiles nothing; flags '-O1' need lanes or c",
        ),
        (
            ["--flags", "-D'"],
            'flags: expected options of a compiler, got "-D\'": No closing quotation',
        ),
        (
            ["--newton", "1"],
            (
                "newton: no loop of 'slider_crank' is iterated; leave newton out: closed forms are"
                " exact and faster"
            ),
        ),
        (
            ["--newton", "1", "--table", "64"],
            "newton and table exclude each other: a table is read, no loop is closed",
        ),
    ],
)
def test_mistakes_on_the_command_line_are_one_line(arguments, says, tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    assert main(["run", str(CASE), "--no-figures", *arguments]) == 2
    out, err = capfd.readouterr()
    assert err.startswith("error: ")
    assert err.count("\n") == 1
    assert says in err
    assert out == ""
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("scene", [slider_crank, lambda: load_case(CASE.parent / "arm").scene])
def test_steps_for_loops_that_are_not_iterated_are_refused(scene, tmp_path):
    """Whatever evaluates them: closed forms need none."""
    scene = scene()
    says = (
        f"newton: no loop of '{scene.mechanism.name}' is iterated; leave newton out: closed forms"
        " are exact and faster"
    )
    calls = (
        lambda: evaluate(scene, newton=2),
        lambda: prepare(scene, newton=2),
        lambda: sweep(
            scene,
            {next(iter(scene.mechanism.parameters)): (0.2, 0.3, 3)},
            newton=2,
            out=tmp_path / "x.h5",
        ),
        lambda: export(scene, tmp_path / "x", newton=2),
    )
    for call in calls:
        with pytest.raises(DeclarationError) as raised:
            call()
        assert str(raised.value) == says
    assert not list(tmp_path.iterdir())


def test_steps_are_of_iterated_loops_alone():
    """The other loop is closed, however few the steps."""
    scene = two_rods()
    exact, rough = evaluate(scene), evaluate(scene, newton=1)
    gap = {
        name: (
            np.abs(rough.motion(f"{name}_guide").value - exact.motion(f"{name}_guide").value).max()
        )
        for name in ("closed", "stepped")
    }
    assert gap["closed"] < 1e-15 < 1e-9 < gap["stepped"]


def test_a_rung_is_told_in_the_provenance():
    solution = evaluate(
        slider_crank(["effort"]), backend="c", precision="single", flags="-O1", certificate=False
    )
    assert (solution.provenance.precision, solution.provenance.backend) == ("single", "c")
    assert solution.provenance.method == "--backend c --precision single --flags -O1"
    assert solution.provenance.flags.endswith(" -O1")
