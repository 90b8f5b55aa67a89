"""Files: round trip, every reader, truncation, damage, and what a failure leaves behind."""

import errno
import json
import re
import shutil

import h5py
import numpy as np
import pytest
import xarray

from lagrange_casadi import check, evaluate, load, save, store
from lagrange_casadi.errors import DeclarationError, PathError, StoreError
from lagrange_casadi.quantities import CONVENTIONS


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


def test_layout(solution, file):
    with h5py.File(file) as h:
        assert h["section/rod/bending"].shape == (801, 101)
        assert h["section/rod/law/n0"].shape == (801,)
        assert set(h) == {"t", "xi", "motion", "pose", "effort", "reaction", "section", "certificate"}
        assert dict(h["t"].attrs)["units"] == "s"
        assert list(h.attrs)[-1] == "complete"
        assert h.attrs["schema"] == "lagrange-casadi"
        assert h.attrs["schema_version"] == 1
        assert h.attrs["case"] == "slider_crank"
        assert h.attrs["conventions"] == CONVENTIONS
        assert h.attrs["backend"] in ("lanes", "c")
        assert h.attrs["precision"] == "double"
        assert "-ffp-contract=off" in h.attrs["flags"]
        assert json.loads(h.attrs["parameters"])["l"] == 0.2

        def visit(name, item):
            if isinstance(item, h5py.Dataset) and name not in ("t", "xi"):
                assert item.attrs["units"], name
                assert item.attrs["long_name"], name
                assert item.fletcher32, name
                assert item.dims[0]["t"] == h["t"], name

        h.visititems(visit)
        assert "tension is positive" in h["section/rod/axial"].attrs["sign"]
        assert "parent side on the child side" in h["reaction/guide/fy"].attrs["sign"]


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


def edit(file, change):
    with h5py.File(file, "r+") as h:
        change(h)


@pytest.mark.parametrize(
    ("change", "finding"),
    [
        (lambda h: h["section/rod/bending"].__setitem__((3, 4), 7.0), "section/rod/bending: differs from its law by"),
        (lambda h: h["effort/O"].__setitem__(5, np.nan), "effort/O: holds values that are not finite"),
        (lambda h: h["effort/O"].attrs.__setitem__("units", "lbf ft"), "effort/O: units 'lbf ft', expected 'N m'"),
        (lambda h: h["effort/O"].attrs.__setitem__("sign", "whatever"), "effort/O: sign is not the schema's"),
        (lambda h: h["effort/O"].dims[0].detach_scale(h["t"]), "effort/O: axis 0 has no scale /t"),
        (lambda h: h.__delitem__("section/rod/shear"), "damaged: .*section/rod/shear|damaged: .*shear"),
        (lambda h: h.attrs.__setitem__("mechanism", "{"), "damaged: "),
        (lambda h: h.attrs.__delitem__("mechanism"), "damaged: "),
        (lambda h: h.__delitem__("t"), "damaged: "),
        (lambda h: h.__delitem__("effort"), "effort/O: missing"),
        (lambda h: h["effort/O"].__setitem__(5, 3.0), "power: .*, computed anew, is worse than the tolerance|balance: "),
        (lambda h: h["certificate/power"].__setitem__(5, 0.1), "certificate/power: 0.1 is worse than the tolerance 1e-09"),
    ],
)
def test_check_names_what_is_wrong(file, change, finding):
    edit(file, change)
    found = check(file)
    assert re.search(finding, found[0])


@pytest.mark.parametrize("name", ["mechanism", "versions", "undetermined"])
def test_a_damaged_file_is_one_line(file, name):
    edit(file, lambda h: h.attrs.__setitem__(name, "{"))
    with pytest.raises(StoreError, match=r"result\.h5: damaged: "):
        load(file)


def test_a_flipped_byte_is_found(file):
    """The checksum of its chunk no longer fits."""
    with h5py.File(file) as h:
        chunk = h["section/rod/bending"].id.get_chunk_info(0)
    data = bytearray(file.read_bytes())
    data[chunk.byte_offset + 100] ^= 1
    file.write_bytes(data)
    (finding,) = check(file)
    assert finding.startswith("damaged: ")


@pytest.mark.parametrize("keep", [0.0, 0.3, 0.9, 0.999])
def test_a_truncated_file_is_refused(file, keep):
    data = file.read_bytes()
    file.write_bytes(data[: int(len(data) * keep)])
    with pytest.raises(StoreError, match=r"result\.h5: not a whole HDF5 file"):
        load(file)


def test_an_unfinished_file_is_refused(file):
    edit(file, lambda h: h.attrs.__delitem__("complete"))
    with pytest.raises(StoreError, match="was not written to its end"):
        load(file)


def test_other_files_are_refused(tmp_path, file):
    with h5py.File(tmp_path / "other.h5", "w") as h:
        h["x"] = 1.0
    with pytest.raises(StoreError, match="not the file of a run, its attribute 'schema' is None"):
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
    with pytest.raises(DeclarationError, match="expected a solution and a path"):
        save(tmp_path, solution)
    with pytest.raises(PathError, match="it is a folder"):
        save(solution, tmp_path)
    with pytest.raises(PathError, match=r"folder .*nowhere does not exist"):
        save(solution, tmp_path / "nowhere" / "result.h5")


@pytest.mark.parametrize(
    ("schema", "says"), [("lagrange-casadi-sweep", "it is the file of a sweep"), ("", "it is an HDF5 file of something else")]
)
def test_no_other_hdf5_file_is_replaced(solution, tmp_path, schema, says):
    target = tmp_path / "x.h5"
    with h5py.File(target, "w") as h:
        h.attrs["schema"] = schema
    before = target.read_bytes()
    with pytest.raises(PathError, match=rf"cannot write .*x\.h5: {says}; choose another name"):
        save(solution, target)
    assert target.read_bytes() == before


def test_a_file_that_the_disk_has_no_room_for_is_refused(solution, tmp_path, monkeypatch):
    monkeypatch.setattr("lagrange_casadi.store.shutil.disk_usage", lambda _: shutil._ntuple_diskusage(10**6, 0, 10**6))
    with pytest.raises(StoreError, match=r"cannot write .*x\.h5: it takes 0\.004\d+ GB, and the disk has 0\.001 GB left"):
        save(solution, tmp_path / "x.h5")
    assert not list(tmp_path.iterdir())
