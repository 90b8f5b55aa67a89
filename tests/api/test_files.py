"""Files of runs: round trip, every reader, grids, what check finds, and what is never replaced."""

import json
import os
import re
import shutil
import subprocess
import sys

import h5py
import numpy as np
import pytest
import sweeps
import xarray
from conftest import ROOT
from forging import edit, flip

from lagrange_casadi import Sweep, check, evaluate, load, save
from lagrange_casadi.cli import main
from lagrange_casadi.errors import (
    BusyError,
    DeclarationError,
    PathError,
    StoreError,
    UnknownNameError,
)

pytestmark = pytest.mark.quick

FOREIGN = "it is an HDF5 file of something else, or without its seal"


@pytest.fixture
def file(solution, tmp_path):
    path = tmp_path / "result.h5"
    save(solution, path)
    return path


def test_round_trip(solution, file):
    back = load(file)
    assert list(back.names()) == list(solution.names())
    for name in solution.names():
        np.testing.assert_array_equal(back.array(name), solution.array(name), err_msg=name)
    assert back.description == solution.description
    assert back.provenance == solution.provenance
    assert back.peak("section:rod:bending") == solution.peak("section:rod:bending")


def test_a_file_says_how_it_was_made(file):
    """Its datasets and their attributes are part of the contract, see tests/structure."""
    with h5py.File(file) as h:
        assert h["section/rod/bending"].shape == (801, 101)
        assert h.attrs["case"] == "slider_crank"
        assert h.attrs["backend"] in ("lanes", "c")
        assert "-ffp-contract=off" in h.attrs["flags"]
        assert json.loads(h.attrs["parameters"])["l"] == 0.2


def test_the_same_run_gives_the_same_bytes(slider_crank, tmp_path):
    for name in ("one.h5", "two.h5"):
        save(evaluate(slider_crank.scene, t=(0, 0.08, 11)), tmp_path / name)
    assert (tmp_path / "one.h5").read_bytes() == (tmp_path / "two.h5").read_bytes()
    assert str(tmp_path).encode() not in (tmp_path / "one.h5").read_bytes()


@pytest.mark.parametrize("engine", ["h5netcdf", "netcdf4"])
def test_xarray_opens_it(solution, file, engine):
    with xarray.open_dataset(file, engine=engine, group="section/rod") as section:
        assert section["bending"].dims == ("t", "xi")
        assert section["bending"].attrs["units"] == "N m"
        np.testing.assert_array_equal(section["bending"], solution.section("rod").bending)
    with xarray.open_dataset(file, engine=engine, group="effort") as effort:
        np.testing.assert_array_equal(effort["O"], solution.effort("O"))
    with xarray.open_dataset(file, engine=engine) as root:
        assert root["xi"].attrs["units"] == "1"


@pytest.mark.parametrize(
    ("change", "finding"),
    [
        (
            lambda h: h["section/rod/bending"].__setitem__((3, 4), 7.0),
            "section/rod/bending: differs from its law by",
        ),
        (
            lambda h: h["effort/O"].__setitem__(5, np.nan),
            "effort/O: values that are not finite",
        ),
        (
            lambda h: h["effort/O"].attrs.__setitem__("units", "lbf ft"),
            "effort/O: units 'lbf ft', expected 'N m'",
        ),
        (
            lambda h: h["effort/O"].attrs.__setitem__("sign", "whatever"),
            "effort/O: sign differs from the schema",
        ),
        (lambda h: h["effort/O"].dims[0].detach_scale(h["t"]), "effort/O: axis 0 has no scale /t"),
        (lambda h: h.__delitem__("effort"), "effort/O: missing"),
        (
            lambda h: h["effort/O"].__setitem__(5, 3.0),
            "power: .*, computed anew, is worse than the tolerance|balance: ",
        ),
        (
            lambda h: h["certificate/power"].__setitem__(5, 0.1),
            "certificate/power: 0.1 is worse than the tolerance 1e-09",
        ),
    ],
)
def test_check_names_what_is_wrong(file, change, finding):
    edit(file, change)
    found = check(file)
    assert re.search(finding, found[0])


def test_other_files_are_refused(tmp_path, file):
    with h5py.File(tmp_path / "other.h5", "w") as h:
        h["x"] = 1.0
    with pytest.raises(StoreError, match=r"it has no seal: .*run it again"):
        load(tmp_path / "other.h5")
    edit(file, lambda h: h.attrs.__setitem__("schema_version", 99))
    with pytest.raises(StoreError, match="schema version 99, this program reads version 1"):
        load(file)
    with pytest.raises(PathError, match="is a folder, not a file"):
        load(tmp_path)
    with pytest.raises(PathError, match="no such file"):
        load(tmp_path / "missing.h5")


def test_places_that_cannot_be_written(solution, tmp_path):
    with pytest.raises(DeclarationError, match=r"save: (solution|path): expected a"):
        save(tmp_path, solution)
    with pytest.raises(PathError, match="it is a folder"):
        save(solution, tmp_path)
    with pytest.raises(PathError, match=r"folder .*nowhere does not exist"):
        save(solution, tmp_path / "nowhere" / "result.h5")


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"notes", "it is no file of HDF5"),
        (b"\x89HDF\r\n\x1a\n" + b"damaged" * 100, FOREIGN),
        (b"MATLAB".ljust(512) + b"\x89HDF\r\n\x1a\n" + b"damaged" * 100, FOREIGN),
    ],
)
def test_nothing_is_replaced_that_was_not_read_and_found_to_be_a_run(
    solution, tmp_path, content, says
):
    target = tmp_path / "x.h5"
    target.write_bytes(content)
    with pytest.raises(PathError, match=rf"cannot write .*x\.h5: {says}; choose another name"):
        save(solution, target)
    assert target.read_bytes() == content


@pytest.mark.parametrize("mode", ["r+", "a"])
def test_a_run_that_another_program_writes_is_left_alone(solution, file, mode):
    before = file.stat().st_ino
    program = (
        f"import h5py, sys; h = h5py.File({str(file)!r}, {mode!r}); print('open', flush=True);"
        " sys.stdin.read()"
    )
    with sweeps.process(sys.executable, "-c", program, stdin=subprocess.PIPE) as holder:
        assert holder.stdout.readline() == "open\n"
        with pytest.raises(BusyError, match=r"result\.h5: another program has it open to write"):
            save(solution, file)
        with pytest.raises(StoreError, match=r"result\.h5: another program has it open to write"):
            load(file)
        assert file.stat().st_ino == before


def test_nothing_is_left_out_without_a_trace(file):
    """What was not written reads as no number, and whoever reads it here is told."""

    def lose(h):
        name = "section/rod/bending"
        attributes = dict(h[name].attrs)
        scales = [dim[0] for dim in h[name].dims]
        shape = h[name].shape
        assert np.isnan(h[name].fillvalue)
        del h[name]
        new = h.create_dataset(
            name, shape, float, chunks=(100, 101), fillvalue=np.nan, fletcher32=True
        )
        new[:700] = 0.0
        for key in ("units", "long_name", "sign"):
            new.attrs[key] = attributes[key]
        for dim, scale in zip(new.dims, scales, strict=True):
            dim.attach_scale(scale)

    edit(file, lose)
    with pytest.raises(StoreError, match=r"damaged: /section/rod/bending has \d+ bytes of 647208"):
        check(file)


CASE = """
from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.elements import bent_bar
from lagrange_casadi.motion import harmonic


def scene():
    m = Mechanism("bell")
    bar = bent_bar(m, "bell", [(0.3, 0.0), (0.0, 0.0), (0.0, 0.2)], mass=2.0)
    rod = m.link("rod", length=0.4, mass=1.0)
    m.revolute("pivot", m.ground, bar.corner(1))
    m.revolute("pin", bar.tip, rod)
    swing = {"pivot": harmonic(0.0, 0.3, 2.0), "pin": harmonic(0.2, 0.4, 3.0)}
    return Scene(m, swing, t=(0, 1, 61))
"""


@pytest.fixture(scope="module")
def bell():
    names = {}
    exec(CASE, names)
    return evaluate(names["scene"]())


def stored(path):
    with h5py.File(path) as file:
        return {link for link in file["section"] if "bending" in file["section"][link]}


@pytest.mark.parametrize(
    ("grids", "links"),
    [
        (None, {"rod"}),
        (True, {"rod", "bell_1", "bell_2"}),
        (False, set()),
        (["bell_2"], {"bell_2"}),
    ],
)
def test_what_is_left_out_is_filled_from_the_law(bell, tmp_path, grids, links):
    path = tmp_path / "bell.h5"
    save(bell, path, grids=grids)
    assert stored(path) == links
    assert check(path) == []
    back = load(path)
    assert list(back.names()) == list(bell.names())
    assert dict(back.errors) == dict(bell.errors)
    for name in bell.names():
        np.testing.assert_array_equal(back.array(name), bell.array(name), err_msg=name)
    for link in bell.links_with_sections:
        name = f"section:{link}:bending"
        assert back.peak(name) == bell.peak(name)


def test_grids_are_of_links_with_sections(bell, tmp_path):
    with pytest.raises(UnknownNameError, match="link with sections"):
        save(bell, tmp_path / "a.h5", grids=["bell"])
    with pytest.raises(DeclarationError, match="grids: expected True or False or a list of texts"):
        save(bell, tmp_path / "a.h5", grids="rod")
    assert not (tmp_path / "a.h5").exists()


def test_the_command_stores_what_is_asked_for(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "case.py").write_text(CASE)
    run = ["run", "case.py", "--no-figures", "--out", "a.h5"]
    every = {"rod", "bell_1", "bell_2"}
    for options, links in (
        ([], {"rod"}),
        (["--grids"], every),
        (["--no-grids"], set()),
        (["--want", "section:bell_1", "--want", "section:rod"], {"rod", "bell_1"}),
    ):
        main([*run, *options])
        assert stored("a.h5") == links


@pytest.fixture(scope="module")
def run(solution, tmp_path_factory):
    path = tmp_path_factory.mktemp("run") / "press.h5"
    save(solution.during(slice(0, 5)), path)
    return path


def test_the_documentation_verifies_a_file(run, tmp_path, monkeypatch):
    (block,) = re.findall(
        r"```python\n(.*?)```", (ROOT / "docs" / "schema.md").read_text(), re.DOTALL
    )
    shutil.copy(run, tmp_path)
    monkeypatch.chdir(tmp_path)
    exec(compile(block, "schema.md", "exec"), {})
    flip(tmp_path / "press.h5", 5000)
    with pytest.raises(AssertionError):
        exec(compile(block, "schema.md", "exec"), {})


def test_to_change_a_file_takes_its_seal(run, tmp_path):
    path = tmp_path / "x.h5"
    shutil.copy(run, path)
    with h5py.File(path, "r+") as file:
        file.attrs["mine"] = 1
    with pytest.raises(StoreError, match=r"x\.h5: it has no seal: .*; run it again$"):
        load(path)


@pytest.mark.parametrize("read", [load, check, Sweep.open])
def test_pipes_and_folders_are_not_opened(tmp_path, read):
    os.mkfifo(tmp_path / "x.h5")
    with pytest.raises(PathError, match=r"x\.h5: is a device or a pipe, not a file$"):
        read(tmp_path / "x.h5")
    with pytest.raises(PathError, match=r"is a folder, not a file$"):
        read(tmp_path)
