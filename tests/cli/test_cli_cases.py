"""The commands ``cases`` and ``new``: what comes with the package can be found by name, copied, and
begun with.
"""

import errno
import filecmp
import importlib
import os
from pathlib import Path
from types import SimpleNamespace

import pytest
from conftest import CASES
from internals import shipped_cases

from lagrange_casadi import LagrangeCasadiError, evaluate, load_case
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
        capfd.readouterr().out == f"copied {len(NAMES)} cases: begin with lagrange-casadi run"
        f" {os.path.join('mine', 'andrews_squeezer')}\n"
    )
    for name in NAMES:
        assert not filecmp.cmpfiles(
            CASES / name, here / "mine" / name, ["case.py", "README.md"], shallow=False
        )[1:][0]
    assert evaluate(load_case(here / "mine" / "arm").scene, t=(0, 0.1, 3)).certified


def test_nothing_is_copied_over_what_is_there(here, capfd):
    (here / "mine").mkdir()
    assert main(["cases", "--copy", "mine"]) == 2
    assert capfd.readouterr().err == "error: mine exists: expected a new folder\n"
    (here / "file").write_text("")
    assert main(["cases", "--copy", "file/x"]) == 2
    assert capfd.readouterr().err.startswith("error: cannot write file")
    assert sorted(os.listdir()) == ["file", "mine"]


def test_copies_are_all_there_or_none(here, capfd, monkeypatch):
    def full(source, target):
        if "beam_pump" in str(source):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        Path(target).touch()

    monkeypatch.setattr("shutil.copyfile", full)
    assert main(["cases", "--copy", "mine"]) == 1
    assert capfd.readouterr().err == "error: cannot write mine: No space left on device\n"
    assert not os.listdir()


def test_what_begins_a_case_can_be_pasted(here, capfd):
    assert main(["new", "my press"]) == 0
    assert capfd.readouterr().out.endswith("run 'my press'\n")


def test_without_them_it_says_so(monkeypatch, tmp_path, capfd):
    monkeypatch.setattr("importlib.metadata.files", lambda name: None)
    monkeypatch.setattr(
        importlib.import_module("lagrange_casadi.shipped_cases"), "_IN_A_CLONE", tmp_path
    )
    assert main(["cases"]) == 2
    assert (
        capfd.readouterr().err
        == "error: the cases were not installed with the package: they are in its repository\n"
    )
    with pytest.raises(
        LagrangeCasadiError,
        match=r"no such file; expected a folder with a case\.py, or a Python file$",
    ):
        load_case("four_bar")


def test_a_clone_has_its_own_cases_not_those_of_its_installation(monkeypatch, tmp_path):
    """Copies in the environment are as old as the installation."""
    clone = tmp_path / "clone"
    (clone / "cases" / "four_bar").mkdir(parents=True)
    (clone / "cases" / "four_bar" / "case.py").write_text("")
    monkeypatch.setattr(
        importlib.import_module("lagrange_casadi.shipped_cases"), "_IN_A_CLONE", clone / "cases"
    )
    installed = tmp_path / "share" / "cases" / "arm" / "case.py"
    installed.parent.mkdir(parents=True)
    installed.write_text("")
    record = SimpleNamespace(locate=lambda: installed, match=lambda pattern: True)
    monkeypatch.setattr("importlib.metadata.files", lambda name: [record])
    assert shipped_cases() == {"arm": installed.parent}
    (clone / "pyproject.toml").write_text("")
    assert shipped_cases() == {"four_bar": clone / "cases" / "four_bar"}


@pytest.mark.parametrize(
    "arguments",
    [
        ["run", "NAME", "--no-figures", "--want", "effort"],
        ["info", "NAME"],
        ["export", "NAME", "--out", "c", "--want", "effort"],
    ],
)
def test_commands_find_a_case_by_its_name(here, capfd, arguments):
    assert main([word.replace("NAME", "four_bar") for word in arguments]) == 0
    by_name, wrote = capfd.readouterr(), sorted(os.listdir())
    assert main([word.replace("NAME", str(CASES / "four_bar")) for word in arguments]) == 0
    told = capfd.readouterr()
    assert [
        line for line in told.out.splitlines() if not line.startswith("replaced")
    ] == by_name.out.splitlines()
    assert told.err == by_name.err
    assert sorted(os.listdir()) == wrote


def test_what_is_here_comes_before_what_comes_with_the_package(here):
    shipped = load_case("four_bar").path
    assert here not in shipped.parents
    assert shipped.read_bytes() == (CASES / "four_bar" / "case.py").read_bytes()
    assert main(["new", "four_bar", "--like", "arm"]) == 0
    assert load_case("four_bar").path == here / "four_bar" / "case.py"
    (here / "engine").mkdir()
    with pytest.raises(LagrangeCasadiError, match=r"case engine: has no case\.py"):
        load_case("engine")


def test_a_name_that_none_bears_is_told_those_there_are():
    with pytest.raises(
        LagrangeCasadiError,
        match=f"case five_bar: no such file; .* the package: {', '.join(NAMES)}$",
    ):
        load_case("five_bar")


@pytest.mark.parametrize("name", NAMES)
def test_a_case_of_ones_own_begins_as_one_that_runs(here, capfd, name):
    assert main(["new", "own/../my-own", "--like", name]) == 2  # for there is no folder own
    capfd.readouterr()
    assert main(["new", "my-own", "--like", name]) == 0
    assert (
        capfd.readouterr().out
        == f"wrote {os.path.join('my-own', 'case.py')}: change it, then lagrange-casadi run"
        " my-own\n"
    )
    own, like = load_case("my-own"), load_case(name)
    assert own.scene.mechanism.name == "my_own"
    assert own.name == "my-own"
    assert (here / "my-own" / "case.py").read_text().replace("my_own", name) == (
        like.path
    ).read_text()
    beside = {file.name for file in like.path.parent.iterdir() if file.is_file()} - {"README.md"}
    assert set(os.listdir("my-own")) - {"__pycache__"} == beside >= {"case.py"}


def test_a_new_case_is_put_over_nothing(here, capfd):
    (here / "mine").mkdir()
    (here / "link").symlink_to("nowhere")
    for folder in ("mine", "link"):
        assert main(["new", folder]) == 2
        assert capfd.readouterr().err == f"error: {folder} exists: expected a new folder\n"
    assert main(["new", "other", "--like", "enginee"]) == 2
    assert "unknown case 'enginee' (did you mean 'engine'?)" in capfd.readouterr().err
    assert sorted(os.listdir()) == ["link", "mine"]


def test_a_folder_whose_name_is_no_mechanisms_keeps_that_of_the_other(here):
    assert main(["new", "2nd"]) == 0
    assert load_case("2nd").scene.mechanism.name == "four_bar"
