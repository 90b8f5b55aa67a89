"""Folders of figures: drawn again, and never over what somebody else has put there."""

import hashlib
import json
import re

import pytest

from lagrange_casadi.cli import main

RUN = ["run", "four_bar", "--t", "0:0.1:11", "--want", "effort"]

SWEEP = ["sweep", "four_bar", "--grid", "a=0.1:0.12:3", "--t", "0:0.1:11", "--want", "effort"]


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """The file of a run, and of a sweep."""
    place = tmp_path_factory.mktemp("files")
    run, swept = place / "run.h5", place / "sweep.h5"
    assert main([*RUN, "--out", str(run), "--no-figures"]) == 0
    assert main([*SWEEP, "--out", str(swept)]) == 0
    return run, swept


@pytest.fixture(params=["run", "run by default", "plot", "plot of a sweep"])
def command(request, files, tmp_path, monkeypatch):
    """A command that fills a folder with figures, and the folder."""
    monkeypatch.chdir(tmp_path)
    commands = {
        "run": ([*RUN, "--figures", "drawn"], "drawn"),
        "run by default": (RUN, "four_bar_figures"),
        "plot": (["plot", str(files[0]), "--out", "drawn"], "drawn"),
        "plot of a sweep": (["plot", str(files[1]), "--out", "drawn"], "drawn"),
    }
    words, folder = commands[request.param]
    return words, tmp_path / folder


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


MANIFEST = "figures.json"


def test_a_folder_is_drawn_again_and_keeps_what_lies_beside(command):
    words, folder = command
    assert main(words) == 0
    first = contents(folder)
    told = json.loads(first[MANIFEST])["files"]
    assert told == {
        name: hashlib.sha256(text).hexdigest() for name, text in first.items() if name != MANIFEST
    }
    assert len(told.keys() - {"index.html"}) == len(told) - 1 > 0
    (folder / "notes.txt").write_text("mine")
    (folder / "own.png").write_text("mine")
    assert main(words) == 0
    assert contents(folder) == first | {"notes.txt": b"mine", "own.png": b"mine"}


@pytest.mark.parametrize("name", ["index.html", "figures.json", "notes.txt"])
def test_a_folder_of_somebody_else_is_refused_before_anything_is_written(command, name, capsys):
    words, folder = command
    folder.mkdir()
    (folder / name).write_text("mine")
    before = sorted(folder.parent.iterdir())
    assert main(words) == 2
    says = rf"error: cannot draw into {folder.name}: .*'{name}'.*choose another folder"
    assert re.match(says, capsys.readouterr().err)
    assert contents(folder) == {name: b"mine"}
    assert sorted(folder.parent.iterdir()) == before


def test_what_was_changed_or_came_under_a_name_of_ours_stays(command, capsys):
    words, folder = command
    assert main(words) == 0
    picture, manifest = next(folder.glob("*.png")), folder / MANIFEST
    drawn, told = picture.read_bytes(), json.loads(manifest.read_text())
    del told["files"][picture.name]
    for content, text, says in (
        (b"with my notes", manifest.read_text(), "an earlier drawing whose '{}' was changed since"),
        (drawn, json.dumps(told), "'{}' there is no file of an earlier drawing; move it"),
    ):
        picture.write_bytes(content)
        manifest.write_text(text)
        assert main(words) == 2
        assert says.format(picture.name) in capsys.readouterr().err
        assert picture.read_bytes() == content
