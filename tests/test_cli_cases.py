"""The command ``cases``: what comes with the package can be found and copied."""

import filecmp
import os
import sys

import pytest
from conftest import CASES

from lagrange_casadi import evaluate, load_case
from lagrange_casadi.cli import main

pytestmark = pytest.mark.quick

NAMES = sorted(path.parent.name for path in CASES.glob("*/case.py"))


def test_the_cases_are_listed_with_what_they_say_of_themselves(capfd):
    assert main(["cases"]) == 0
    lines = capfd.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == NAMES
    assert "four_bar           A crank-rocker four-bar at constant speed." in lines
    assert all(len(line.split()) > 3 for line in lines)


def test_copies_are_whole_and_run(here, capfd):
    assert main(["cases", "--copy", "mine"]) == 0
    assert (
        capfd.readouterr().out
        == f"copied {len(NAMES)} cases: begin with lagrange-casadi run {os.path.join('mine', 'andrews_squeezer')}\n"
    )
    for name in NAMES:
        assert not filecmp.cmpfiles(CASES / name, here / "mine" / name, ["case.py", "README.md"], shallow=False)[1:][0]
    assert evaluate(load_case(here / "mine" / "arm").scene, t=(0, 0.1, 3)).certified


def test_nothing_is_copied_over_what_is_there(here, capfd):
    (here / "mine").mkdir()
    assert main(["cases", "--copy", "mine"]) == 2
    assert capfd.readouterr().err == "error: mine exists: expected a new folder\n"
    (here / "file").write_text("")
    assert main(["cases", "--copy", "file/x"]) == 1
    assert capfd.readouterr().err.startswith("error: cannot write file")
    assert sorted(os.listdir()) == ["file", "mine"]


def test_without_them_it_says_so(monkeypatch, tmp_path, capfd):
    monkeypatch.setattr("importlib.metadata.files", lambda name: None)
    monkeypatch.setattr(sys.modules["lagrange_casadi.cli.cases"], "_IN_A_CLONE", tmp_path)
    assert main(["cases"]) == 2
    assert capfd.readouterr().err == "error: the cases were not installed with the package: they are in its repository\n"
