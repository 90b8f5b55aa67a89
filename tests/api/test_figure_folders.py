"""Folders of figures: drawn again, and never over what somebody else has put there."""

import hashlib
import json

import pytest
from internals import INDEX_MANIFEST as MANIFEST

from lagrange_casadi.cli import main
from lagrange_casadi.errors import PathError

pytestmark = pytest.mark.quick

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


def test_a_folder_is_drawn_again_and_keeps_what_lies_beside(command):
    words, folder = command
    assert main(words) == 0
    first = contents(folder)
    told = json.loads(first[MANIFEST.name])["files"]
    assert told == {
        name: hashlib.sha256(text).hexdigest()
        for name, text in first.items()
        if name != MANIFEST.name
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
    err = capsys.readouterr().err
    assert err.startswith(f"error: cannot draw into {folder.name}: ")
    assert {f"'{name}'", "choose another folder"} == {
        words for words in (f"'{name}'", "choose another folder") if words in err
    }
    assert contents(folder) == {name: b"mine"}
    assert sorted(folder.parent.iterdir()) == before


def test_what_was_changed_or_came_under_a_name_of_ours_stays(command, capsys):
    words, folder = command
    assert main(words) == 0
    picture = next(folder.glob("*.png"))
    drawn = picture.read_bytes()
    picture.write_bytes(b"with my notes")
    assert main(words) == 2
    assert (
        f"it holds an earlier drawing whose '{picture.name}' was changed since"
        in capsys.readouterr().err
    )
    assert picture.read_bytes() == b"with my notes"
    picture.unlink()
    assert main(words) == 0
    assert picture.read_bytes() == drawn
    told = json.loads((folder / MANIFEST.name).read_text())
    del told["files"][picture.name]
    (folder / MANIFEST.name).write_text(json.dumps(told))
    capsys.readouterr()
    assert main(words) == 2
    assert (
        f"'{picture.name}' there is no file of an earlier drawing; move it"
        in capsys.readouterr().err
    )


def test_what_is_drawn_no_more_is_known_still(files, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for wanted in ("effort", "motion", "effort"):
        assert main(["run", "four_bar", "--t", "0:0.1:11", "--want", wanted]) == 0
    assert main(["plot", str(files[1]), "--out", "four_bar_figures"]) == 0
    assert {"effort_O.png", "index.html", "mechanism.png"} <= MANIFEST.known(
        tmp_path / "four_bar_figures"
    ).keys()


def test_an_empty_folder_and_one_with_hidden_files_are_free(files, tmp_path):
    (tmp_path / ".gitignore").write_text("*")
    assert main(["plot", str(files[0]), "--out", str(tmp_path)]) == 0
    assert (tmp_path / ".gitignore").read_text() == "*"


OURS = '{"schema": "lagrange-casadi figures"'


@pytest.mark.parametrize(
    "text", ["", "[]", "{", "[" * 100_000, "\xff", OURS + "}", OURS + ', "files": 3}']
)
def test_what_is_no_manifest_is_a_file_of_somebody_else(tmp_path, text):
    (tmp_path / MANIFEST.name).write_bytes(text.encode("latin-1"))
    with pytest.raises(PathError, match=r"'figures\.json' there is no file of an earlier drawing"):
        MANIFEST.check(tmp_path)


def test_a_link_or_a_folder_under_a_known_name_was_changed(tmp_path):
    one = tmp_path / "one.png"
    one.write_text("drawn")
    (tmp_path / "drawn").mkdir()
    for make in (lambda path: path.symlink_to(one), lambda path: path.mkdir()):
        place = tmp_path / "drawn" / "one.png"
        (tmp_path / "drawn" / MANIFEST.name).write_text(
            MANIFEST.text({"one.png": hashlib.sha256(b"drawn").hexdigest()})
        )
        make(place)
        with pytest.raises(PathError, match=r"whose 'one\.png' was changed since"):
            MANIFEST.check(tmp_path / "drawn")
        place.unlink() if place.is_symlink() else place.rmdir()
