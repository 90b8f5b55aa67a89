"""Reading: by value, by design, by xarray; and what is no sweep is refused."""

import gc

import h5py
import numpy as np
import pytest
import sweeps

from lagrange_casadi import load, save, store
from lagrange_casadi.errors import DeclarationError, PathError, StoreError, UnknownNameError
from lagrange_casadi.sweep import Listed, Sweep, is_sweep, reading, sweep
from lagrange_casadi.sweep.checking import check_sweep

GRID = {"l": (0.15, 0.4, 6), "r": [0.05, 0.1, 0.07], "m1": [0.1, 0.2]}
LENGTHS = np.linspace(0.15, 0.4, 6)


@pytest.fixture
def swept(monkeypatch, tmp_path):
    sweeps.use(monkeypatch)
    return sweep(sweeps.scene(), GRID, out=tmp_path / "x.h5", xi=(0, 1, 4))


@pytest.fixture
def listed(monkeypatch, tmp_path):
    sweeps.use(monkeypatch)
    rows = np.random.default_rng(3).uniform(0.1, 0.3, (50, 2))
    return rows, sweep(sweeps.scene(), Listed(("l", "r"), rows), out=tmp_path / "y.h5")


def test_what_a_sweep_is(swept):
    again = Sweep.open(swept.path)
    assert again.dimensions == {"l": 6, "r": 3, "m1": 2}
    assert again.parameters == {"l": "m", "r": "m", "m1": "kg"}
    assert again.shape == (6, 3, 2)
    assert again.size == 36
    assert again.case == "slider_crank"
    assert next(iter(again.columns)) == "status"
    assert again.columns["peak_at:section:rod:bending"].axes == ("xi",)
    assert "36 designs over l, r, m1" in repr(again)
    np.testing.assert_array_equal(again["l"], LENGTHS)
    np.testing.assert_array_equal(again["xi"], np.linspace(0, 1, 4))
    assert {status: count for status, count in again.counts().items() if count} == {
        0: int((again["status"] == 0).sum()),
        1: int((again["status"] == 1).sum()),
    }
    assert again.counts()[1] > 0


def test_selection_by_value(swept):
    whole = swept["peak:effort:O"]
    assert whole.shape == (6, 3, 2)
    np.testing.assert_array_equal(swept.select(l=0.25)["peak:effort:O"], whole[2:3])
    np.testing.assert_array_equal(swept.select(l=0.1 + 0.15, r=0.07)["peak:effort:O"], whole[2:3, 2:3])
    np.testing.assert_array_equal(swept.select(l=(0.2, 0.3))["peak:effort:O"], whole[1:4])
    scattered = swept.select(r=(0.04, 0.07))
    np.testing.assert_array_equal(scattered["r"], [0.05, 0.07])
    np.testing.assert_array_equal(scattered["peak:effort:O"], whole[:, [0, 2]])
    np.testing.assert_array_equal(scattered.select(r=0.07)["peak:effort:O"], whole[:, 2:3])
    assert scattered.shape == (6, 2, 2)
    np.testing.assert_array_equal(swept.select(l=0.4)["peak_at:section:rod:axial"], swept["peak_at:section:rod:axial"][5:])


def test_selection_of_a_list(listed):
    rows, found = listed
    there = (rows[:, 0] >= 0.2) & (rows[:, 1] <= 0.2)
    cut = found.select(l=(0.2, 1.0), r=(0.0, 0.2))
    np.testing.assert_array_equal(cut["l"], rows[there, 0])
    np.testing.assert_array_equal(cut["peak:effort:O"], found["peak:effort:O"][there])
    assert cut.size == there.sum()
    assert found.design(7) == {"l": rows[7, 0], "r": rows[7, 1]}


def test_what_cannot_be_selected_is_named(swept):
    with pytest.raises(UnknownNameError, match="unknown swept parameter 'm3'; valid: l, r, m1"):
        swept.select(m3=0.1)
    with pytest.raises(DeclarationError, match=r"no design has l = 0\.21; nearest: 0\.2, 0\.25"):
        swept.select(l=0.21)
    with pytest.raises(UnknownNameError, match=r"unknown column 'peak:effort:Q' \(did you mean 'peak:effort:O'\?\)"):
        swept["peak:effort:Q"]


@pytest.mark.parametrize("size", [1, 5, 1 << 15])
def test_blocks_go_over_all_designs(swept, monkeypatch, size):
    monkeypatch.setattr(reading, "_BLOCK", size)
    numbers, values = [], []
    for places, found in swept.blocks(["r", "peak:effort:O", "l", "m1"]):
        numbers.append(places)
        values.append(np.stack([found["l"], found["r"], found["m1"], found["peak:effort:O"]]))
    np.testing.assert_array_equal(np.concatenate(numbers), np.arange(36))
    l, r, m1, peak = np.concatenate(values, axis=1)
    expected = np.meshgrid(LENGTHS, [0.05, 0.1, 0.07], [0.1, 0.2], indexing="ij")
    for mine, other in zip((l, r, m1), expected, strict=True):
        np.testing.assert_array_equal(mine, other.ravel())
    np.testing.assert_array_equal(peak, swept["peak:effort:O"].ravel())


def test_blocks_of_what_is_selected(swept):
    cut = swept.select(l=(0.2, 0.3), r=0.07)
    numbers = np.concatenate([places for places, _ in cut.blocks(["l"])])
    np.testing.assert_array_equal(numbers, np.arange(36).reshape(6, 3, 2)[1:4, 2].ravel())
    assert [swept.design(int(n))["r"] for n in numbers] == [0.07] * 6
    with pytest.raises(DeclarationError, match="column 'peak_at:section:rod:axial' has a value for every xi, not one a design"):
        list(swept.blocks(["peak_at:section:rod:axial"]))


def test_xarray(swept, listed):
    found = swept.select(l=(0.2, 0.3)).to_xarray(["peak:effort:O", "peak_at:section:rod:axial"])
    assert found["peak_at:section:rod:axial"].dims == ("l", "r", "m1", "xi")
    assert found["peak:effort:O"].attrs["units"] == "N m"
    assert found["l"].attrs["units"] == "m"
    assert float(found["peak:effort:O"].sel(l=0.25, r=0.07, m1=0.1)) == swept["peak:effort:O"][2, 2, 0]
    rows, other = listed
    np.testing.assert_array_equal(other.to_xarray()["l"], rows[:, 0])
    assert other.to_xarray()["peak:effort:O"].dims == ("design",)


def test_without_a_file_it_lives_as_long_as_the_sweep(monkeypatch):
    sweeps.use(monkeypatch)
    found = sweep(sweeps.scene(), {"l": [0.2, 0.3]})
    path, part = found.path, found.select(l=0.2)
    assert part["peak:effort:O"].shape == (1,)
    del found
    gc.collect()
    assert path.exists()
    del part
    gc.collect()
    assert not path.exists()


def test_what_is_no_sweep_is_refused(swept, solution, tmp_path):
    save(solution.during(slice(0, 3)), tmp_path / "run.h5")
    assert is_sweep(swept.path)
    assert not is_sweep(tmp_path / "run.h5")
    assert not is_sweep(tmp_path / "nothing.h5")
    with pytest.raises(StoreError, match="not a sweep, its attribute 'schema' is 'lagrange-casadi'"):
        Sweep.open(tmp_path / "run.h5")
    with pytest.raises(StoreError, match="its attribute 'schema' is 'lagrange-casadi-sweep'"):
        load(swept.path)
    with pytest.raises(StoreError):
        store.check(swept.path)
    with pytest.raises(PathError, match="no such file"):
        Sweep.open(tmp_path / "nothing.h5")
    with pytest.raises(PathError, match="is a folder"):
        Sweep.open(tmp_path)


def edit(path, change):
    with h5py.File(path, "r+") as h:
        change(h)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda h: h.attrs.__delitem__("complete"), "was not written to its end"),
        (lambda h: h.attrs.__setitem__("schema_version", 99), "schema version 99 of sweeps, this program reads version 1"),
        (lambda h: h.__delitem__("mean"), "damaged: it has"),
        (lambda h: h.attrs.__setitem__("mechanism", "{"), "damaged: "),
        (lambda h: h.__delitem__("status"), "damaged: "),
    ],
)
def test_what_is_not_whole_is_refused(swept, change, says):
    edit(swept.path, change)
    with pytest.raises(StoreError, match=says):
        Sweep.open(swept.path)


def test_check_passes_a_whole_file(swept, listed):
    assert check_sweep(swept.path) == []
    assert check_sweep(listed[1].path) == []


def _first(h, status):
    return tuple(int(i) for i in np.argwhere(h["status"][()] == status)[0])


@pytest.mark.parametrize(
    ("change", "finding"),
    [
        (lambda h: h["peak/effort/O"].__setitem__(_first(h, 0), np.nan), "peak:effort:O: 1 designs that have a result lack it"),
        (lambda h: h["peak/effort/O"].__setitem__(_first(h, 1), 3.0), "peak:effort:O: 1 designs that have no result have a number"),
        (lambda h: h["status"].__setitem__(_first(h, 1), 99), "status: 1 designs have a status that is none"),
        (lambda h: h["peak/effort/O"].dims[1].detach_scale(h["r"]), "peak:effort:O: axis 1 has no scale r"),
    ],
)
def test_check_names_what_is_wrong(swept, change, finding):
    edit(swept.path, change)
    assert check_sweep(swept.path)[0] == finding


def test_a_flipped_byte_is_found(swept):
    with h5py.File(swept.path) as h:
        chunk = h["peak/section/rod/bending"].id.get_chunk_info(0)
    data = bytearray(swept.path.read_bytes())
    data[chunk.byte_offset + 20] ^= 1
    swept.path.write_bytes(data)
    (finding,) = check_sweep(swept.path)
    assert finding.startswith("peak:section:rod:bending: damaged: ")
    with pytest.raises(StoreError, match="damaged"):
        swept["peak:section:rod:bending"]
