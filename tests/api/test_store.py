"""Files: round trip, every reader, truncation, damage, and what a failure leaves behind."""

import errno
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
import sweeps
import xarray
from forging import edit
from internals import base_seal as seal
from internals import runs as store

from lagrange_casadi import check, evaluate, load, save
from lagrange_casadi.errors import BusyError, DeclarationError, PathError, StoreError

FOREIGN = "it is an HDF5 file of something else, or without its seal"

pytestmark = pytest.mark.quick


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


def test_check_passes_a_whole_file(file):
    assert check(file) == []


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


def test_an_unfinished_file_is_refused(file):
    edit(file, lambda h: h.attrs.__delitem__("complete"))
    with pytest.raises(StoreError, match="was not written to its end"):
        load(file)


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


def test_a_failure_leaves_the_file_of_before(solution, file, monkeypatch):
    before = file.read_bytes()

    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(store, "_add", full)
    with pytest.raises(StoreError, match=r"cannot write .*result\.h5: No space left on device"):
        save(solution, file)
    assert file.read_bytes() == before
    assert [path.name for path in file.parent.iterdir()] == ["result.h5"]


def test_an_interrupt_leaves_the_file_of_before(solution, file, monkeypatch):
    before = file.read_bytes()

    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(store, "_add", interrupt)
    with pytest.raises(KeyboardInterrupt):
        save(solution, file)
    assert file.read_bytes() == before
    assert [path.name for path in file.parent.iterdir()] == ["result.h5"]


def test_places_that_cannot_be_written(solution, tmp_path):
    with pytest.raises(DeclarationError, match=r"save: (solution|path): expected a"):
        save(tmp_path, solution)
    with pytest.raises(PathError, match="it is a folder"):
        save(solution, tmp_path)
    with pytest.raises(PathError, match=r"folder .*nowhere does not exist"):
        save(solution, tmp_path / "nowhere" / "result.h5")


@pytest.mark.parametrize(
    ("schema", "says"),
    [
        ("lagrange-casadi-sweep", "it is the file of a sweep"),
        ("lagrange-casadi-optimum", "it is the file of a search"),
        ("", FOREIGN),
    ],
)
def test_no_other_hdf5_file_is_replaced(solution, tmp_path, schema, says):
    target = tmp_path / "x.h5"
    with h5py.File(target, "w") as h:
        h.attrs["schema"] = schema
    if schema:
        seal.seal(target, schema)
    before = target.read_bytes()
    with pytest.raises(PathError, match=rf"cannot write .*x\.h5: {says}; choose another name"):
        save(solution, target)
    assert target.read_bytes() == before


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


def test_a_run_that_another_program_reads_is_replaced(solution, file):
    with h5py.File(file) as h:
        save(solution.during(slice(0, 3)), file)
        assert h["t"].shape == (801,)
    assert load(file).t.size == 3


def test_what_cannot_be_opened_is_left_alone(solution, file, monkeypatch):
    """Whatever keeps a file from being read: that it is no HDF5 does not follow."""
    opened = Path.open

    def refuse(path, *arguments, **keywords):
        if path == file and arguments[:1] in ((), ("rb",)):
            raise PermissionError(errno.EACCES, "Permission denied")
        return opened(path, *arguments, **keywords)

    monkeypatch.setattr(Path, "open", refuse)
    monkeypatch.setattr(store, "kind_of", lambda _: None)
    with pytest.raises(
        PathError,
        match=r"cannot write .*result\.h5: what is there cannot be read: Permission denied",
    ):
        save(solution, file)


@pytest.mark.parametrize("keep", [600, 100_000])
def test_a_damaged_run_is_left_to_its_owner(solution, file, keep):
    """It might be what is left of something else."""
    file.write_bytes(file.read_bytes()[:keep])
    with pytest.raises(
        PathError,
        match=(
            r"cannot write .*result\.h5: it is an HDF5 file of something else, or without its seal"
        ),
    ):
        save(solution, file)


def test_what_hdf5_refuses_is_one_line(solution, tmp_path, monkeypatch):
    def refuse(*_):
        raise RuntimeError("Unspecified error in H5DSattach_scale (return value <0)")

    monkeypatch.setattr(store.Scales, "finish", refuse)
    with pytest.raises(
        StoreError, match=r"cannot write .*x\.h5: Unspecified error in H5DSattach_scale"
    ):
        save(solution, tmp_path / "x.h5")
    assert not list(tmp_path.iterdir())


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


def test_a_file_that_the_disk_has_no_room_for_is_refused(solution, tmp_path, monkeypatch):
    monkeypatch.setattr(
        "lagrange_casadi.store.runs.shutil.disk_usage",
        lambda _: shutil._ntuple_diskusage(10**6, 0, 10**6),
    )
    with pytest.raises(
        StoreError,
        match=r"cannot write .*x\.h5: it takes 0\.004\d+ GB, and the disk has 0\.001 GB left",
    ):
        save(solution, tmp_path / "x.h5")
    assert not list(tmp_path.iterdir())
