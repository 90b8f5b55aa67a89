"""The file: scales that every reader finds, and every number at its design."""

import json

import h5py
import numpy as np
import pytest
import sweeps
import xarray
from internals import CONVENTIONS, sweep
from internals import ListingListed as Listed

from lagrange_casadi.errors import DeclarationError

pytestmark = pytest.mark.quick

GRID = {"l": (0.15, 0.4, 6), "r": [0.05, 0.1, 0.07]}


@pytest.fixture
def file(monkeypatch, tmp_path):
    sweeps.use(monkeypatch)
    return sweep(sweeps.scene(), GRID, out=tmp_path / "x.h5", xi=(0, 1, 4), keep="histories").path


def test_layout(file):
    with h5py.File(file) as h:
        assert set(h) == {
            "grid",
            "l",
            "r",
            "t",
            "xi",
            "status",
            "peak",
            "peak_t",
            "peak_xi",
            "mean",
            "rms",
            "peak_at",
            "history",
        }
        np.testing.assert_array_equal(h["grid/l"], [0.15, 0.2, 0.25, 0.3, 0.35, 0.4])
        assert h["grid/l"] == h["l"]
        assert h["l"].attrs["units"] == "m"
        assert h["peak/section/rod/bending"].shape == (6, 3)
        assert h["history/section/rod/bending"].shape == (6, 3, 7, 4)
        assert h["status"].dtype == np.int8
        attributes = h.attrs
        assert list(attributes)[-1] == "complete"
        assert attributes["schema"] == "lagrange-casadi-sweep"
        assert attributes["conventions"] == CONVENTIONS
        assert attributes["Conventions"] == "CF-1.8"
        assert json.loads(attributes["grid"]) == {"l": "0.15:0.4:6", "r": "0.05,0.1,0.07"}
        assert json.loads(attributes["parameters"])["m1"] == 0.1
        count = 0

        def visit(name, item):
            nonlocal count
            if isinstance(item, h5py.Dataset):
                assert item.attrs["units"], name
                assert item.attrs["long_name"], name
                assert item.fletcher32, name
                if not item.is_scale:
                    count += 1
                    for axis in range(item.ndim):
                        assert len(item.dims[axis]) == 1, name

        h.visititems(visit)
        assert count == attributes["columns"]
        assert "tension is positive" in h["peak/section/rod/axial"].attrs["sign"]


@pytest.mark.parametrize("engine", ["h5netcdf", "netcdf4"])
def test_xarray_opens_it(file, engine):
    with xarray.open_dataset(file, engine=engine, group="history/section/rod") as section:
        assert section["bending"].dims == ("l", "r", "t", "xi")
        assert section["bending"].attrs["units"] == "N m"
    with xarray.open_dataset(file, engine=engine) as root:
        assert root["l"].attrs["units"] == "m"
        np.testing.assert_array_equal(root["r"], [0.05, 0.1, 0.07])
        assert root["status"].dims == ("l", "r")
    with xarray.open_datatree(file, engine=engine) as tree:
        peak = tree["peak/section/rod"].sel(l=0.25, r=0.07)["bending"]
        with h5py.File(file) as h:
            assert float(peak) == h["peak/section/rod/bending"][2, 2]


@pytest.mark.parametrize("engine", ["h5netcdf", "netcdf4"])
def test_xarray_opens_a_list(monkeypatch, tmp_path, engine):
    sweeps.use(monkeypatch)
    listed = Listed(("l", "r"), np.random.default_rng(1).uniform(0.1, 0.3, (40, 2)))
    path = sweep(sweeps.scene(), listed, out=tmp_path / "x.h5").path
    with xarray.open_dataset(path, engine=engine, group="peak/effort") as effort:
        assert effort["O"].dims == ("design",)
    with xarray.open_dataset(path, engine=engine, group="grid") as grid:
        np.testing.assert_array_equal(grid["l"], listed.rows[:, 0])
        assert grid["l"].dims == ("design",)


def test_columns_stand_at_their_designs(file, monkeypatch):
    """Against the formula itself, called for all designs at once in an order written out here."""
    engine = sweeps.Formula()
    designs = [
        [r, l, 0.1, 0.1, 0.1] for l in [0.15, 0.2, 0.25, 0.3, 0.35, 0.4] for r in (0.05, 0.1, 0.07)
    ]
    outcome = engine.evaluate(np.array(designs), histories=True)
    with h5py.File(file) as h:
        np.testing.assert_array_equal(h["status"][()].ravel(), outcome.status)
        np.testing.assert_array_equal(
            h["peak/reaction/A/resultant"][()].ravel(), outcome.value[:, 1]
        )
        np.testing.assert_array_equal(h["peak/reaction/A/fx"][()].ravel(), outcome.value[:, 2])
        np.testing.assert_array_equal(h["peak_t/section/rod/axial"][()].ravel(), outcome.t[:, 3])
        np.testing.assert_array_equal(
            h["peak_xi/section/rod/bending"][()].ravel(), outcome.xi[:, 5]
        )
        np.testing.assert_array_equal(h["mean/effort/O"][()].ravel(), outcome.mean[:, 0])
        np.testing.assert_array_equal(h["rms/effort/O"][()].ravel(), outcome.rms[:, 0])
        np.testing.assert_array_equal(
            h["history/section/rod/law/f1"][()].reshape(18, 7), outcome.series[:, 5]
        )
        assert (outcome.status != 0).any()


def test_no_path_and_no_clock_is_in_it(file):
    assert str(file.parent).encode() not in file.read_bytes()


def test_names_that_the_file_keeps_are_refused(monkeypatch, tmp_path):
    from lagrange_casadi import Mechanism, Scene
    from lagrange_casadi.motion import polynomial

    sweeps.use(monkeypatch)
    m = Mechanism("x")
    link = m.link("a", length=m.parameter("t", 0.1, "m"), mass=1.0)
    m.revolute("O", m.ground, link)
    scene = Scene(m, {"O": polynomial(0, 1)})
    with pytest.raises(
        DeclarationError,
        match="parameter 't' cannot be an axis: the file uses that name itself",
    ):
        sweep(scene, {"t": [0.1, 0.2]}, out=tmp_path / "x.h5")
    assert list(tmp_path.iterdir()) == []
