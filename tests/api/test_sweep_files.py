"""A sweep's file: its layout, that every reader finds every number, that it is the same however the
sweep was cut and goes on, and what is never overwritten.
"""

import contextlib
import os
import threading

import h5py
import numpy as np
import pytest
import sweeps
import xarray
from commands import command
from sweeps import StopError, stop_after

from lagrange_casadi import Scene, Sweep, motion, read_designs, sweep
from lagrange_casadi.errors import BusyError, DeclarationError, PathError, StoreError

ASKED = {"t": (0, 0.08, 7)}
GRID = {"l": (0.15, 0.4, 20), "r": [0.05, 0.1, 0.07]}


@pytest.fixture(autouse=True)
def quick(monkeypatch):
    """Let plain formulas answer, a few designs a block."""
    monkeypatch.setattr("lagrange_casadi.studies.sweep.columns._MOST", 5)
    return sweeps.use(monkeypatch)


def run(path, grid=None, scene=None, **words):
    """The bytes of a sweep's file."""
    scene, grid = scene or sweeps.scene(), grid or GRID
    return sweep(scene, grid, out=path, **{**ASKED, **words}).path.read_bytes()


@pytest.fixture
def whole(tmp_path_factory):
    """The bytes of a sweep that nobody stops."""
    return run(tmp_path_factory.mktemp("whole") / "x.h5", workers=1)


@pytest.mark.parametrize("kind", ["grid", "list"])
@pytest.mark.parametrize("engine", ["h5netcdf", "netcdf4"])
def test_every_reader_finds_every_number(tmp_path, kind, engine):
    """Each dataset has its unit, its name, a checksum and a scale for every axis."""
    (tmp_path / "d.csv").write_text("l,r\n0.2,0.05\n0.3,0.1\n0.25,0.06\n")
    designs = GRID if kind == "grid" else read_designs(tmp_path / "d.csv")
    path = tmp_path / "x.h5"
    found = sweep(sweeps.scene(), designs, out=path, xi=(0, 1, 4), keep="histories", **ASKED)
    dims = ("l", "r") if kind == "grid" else ("design",)
    with xarray.open_dataset(path, engine=engine, group="history/section/rod") as section:
        assert section["bending"].dims == (*dims, "t", "xi")
        assert section["bending"].attrs["units"] == "N m"
        expected = found["history:section:rod:bending"]
        np.testing.assert_array_equal(section["bending"], expected)
    with h5py.File(path) as h:
        assert "tension is positive" in h["peak/section/rod/axial"].attrs["sign"]
        names = []

        def visit(name, item):
            if isinstance(item, h5py.Dataset):
                assert item.attrs["units"], name
                assert item.attrs["long_name"], name
                assert item.fletcher32, name
                if not item.is_scale and not name.startswith("grid/"):
                    names.append(name.replace("/", ":"))
                    assert all(len(dim) == 1 for dim in item.dims), name
                    np.testing.assert_array_equal(item[()], found[names[-1]], err_msg=name)

        h.visititems(visit)
    assert set(names) == set(found.columns)
    assert str(tmp_path).encode() not in path.read_bytes()
    assert command("check", path) == 0


@pytest.mark.parametrize("workers", [2, 5, None])
def test_the_same_bytes_whatever_the_workers(whole, tmp_path, workers):
    assert run(tmp_path / "x.h5", workers=workers) == whole


def test_what_is_there_is_not_overwritten(whole, tmp_path):
    path, folder = tmp_path / "x.h5", tmp_path / "x.h5.parts"
    with pytest.raises(StopError):
        run(path, workers=1, progress=stop_after(4))
    with pytest.raises(PathError, match=r"holds an unfinished sweep: continue with resume=True"):
        run(path)
    assert [command(word, path) for word in ("info", "check")] == [0, 1]
    with pytest.raises(PathError, match=r"x\.h5: its sweep is not finished"):
        Sweep.open(path)
    designs = []
    run(path, resume=True, workers=1, progress=lambda what, done, _: designs.append((what, done)))
    assert 0 < min(done for what, done in designs if what == "designs") < 60
    assert path.read_bytes() == whole
    assert run(path, resume=True, progress=pytest.fail) == whole
    seen = []
    run(path, {"l": [0.2]}, force=True, progress=lambda *_: seen.append(path.read_bytes() == whole))
    assert all(seen), "the old file stays until the new one is whole"
    for content, words, says in (
        (whole, {}, r"x\.h5 exists: force=True replaces it, resume=True"),
        (whole, {"force": True, "resume": True}, "resume and force exclude each other"),
        (b"mine", {}, "exists"),
        (b"mine", {"resume": True}, "not a file of this program"),
    ):
        path.write_bytes(content)
        with pytest.raises((PathError, StoreError, DeclarationError), match=says):
            run(path, **words)
    folder.mkdir()
    (folder / "thesis.txt").write_text("mine")
    for words in ({}, {"resume": True}, {"force": True}):
        with pytest.raises(PathError, match=r"holds 'thesis\.txt', which is not part of a sweep"):
            run(path, **words)
    assert (path.read_text(), os.listdir(folder)) == ("mine", ["thesis.txt"])


def test_a_part_of_another_sweep_is_none(whole, tmp_path):
    """It has the same name, and as many columns of as many designs."""
    for name, words in (("x", {}), ("other", {"parameters": {"m3": 0.2}})):
        with pytest.raises(StopError):
            run(tmp_path / f"{name}.h5", workers=1, progress=stop_after(3), **words)
    part = min((tmp_path / "x.h5.parts").glob("*.part"))
    part.write_bytes((tmp_path / "other.h5.parts" / part.name).read_bytes())
    assert command("check", tmp_path / "x.h5.parts") == 1
    with pytest.raises(StoreError, match=r"\.part was damaged, and is deleted; .*continue with"):
        run(tmp_path / "x.h5", resume=True)
    assert run(tmp_path / "x.h5", resume=True) == whole


OTHERS = [
    ({"grid": {"l": (0.15, 0.4, 21), "r": GRID["r"]}}, "grid l was 0.15:0.4:20 and is 0.15:0.4:21"),
    ({"grid": {"l": GRID["l"]}}, "grid r was there, and is not"),
    ({"grid": dict(reversed(GRID.items()))}, "the axes of the grid were l, r and are r, l"),
    ({"parameters": {"m3": 0.2}}, "mechanism parameters m3 value was 0.1 and is 0.2"),
    ({"wanted": ["effort"]}, "wanted reactions was "),
    ({"t": (0, 0.08, 9)}, "t was [0.0, 0.08, 7] and is [0.0, 0.08, 9]"),
    ({"keep": "histories"}, "keep was peaks and is histories"),
    (
        {"law": motion.polynomial(0, 1)},
        "an expression, a law of motion or the posture of the scene",
    ),
]


@pytest.mark.parametrize("finished", [True, False])
def test_another_sweep_is_refused_with_the_difference(whole, tmp_path, finished):
    path = tmp_path / "x.h5"
    if finished:
        path.write_bytes(whole)
    else:
        with pytest.raises(StopError):
            run(path, progress=stop_after(2))
    for change, says in OTHERS:
        scene, words = sweeps.scene(), dict(change)
        if law := words.pop("law", None):
            scene = Scene(scene.mechanism, {"O": law}, t=scene.t, posture=scene.posture)
        with pytest.raises(StoreError) as caught:
            run(path, scene=scene, resume=True, **words)
        assert f"is of another sweep: {says}" in str(caught.value)
        assert str(caught.value).endswith("; start anew with force=True, or write another file")


def test_one_writer_at_a_time(whole, tmp_path):
    """A second sweep into the file, and one into a file that another program has open, are refused;
    the first goes on undisturbed.
    """
    path, refused = tmp_path / "x.h5", []

    def second(*_):
        for words in ({}, {"resume": True}, {"force": True}):
            with contextlib.suppress(BusyError):
                run(path, **words)
                refused.append(words)

    assert run(path, progress=second) == whole
    assert not refused
    with sweeps.held(path, "r+"):
        for words in ({}, {"force": True}, {"resume": True}):
            with pytest.raises(BusyError, match="another program has it open to write"):
                run(path, **words)
    assert os.listdir(tmp_path) == ["x.h5"]
    assert threading.active_count() < 10
