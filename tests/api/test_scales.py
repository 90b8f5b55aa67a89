"""Dimension scales: what HDF5's own library reads and goes on with, of any number of datasets."""

import h5py
import numpy as np
import pytest
import xarray
from internals import LARGE, Scales

from lagrange_casadi import Mechanism, Scene, check, evaluate, load, save
from lagrange_casadi.motion import polynomial

MANY = 5600
"""More than a list in an object's header has room for."""


def write(path, count):
    """Datasets in groups of a hundred, the odd ones over both axes."""
    with h5py.File(path, "w", track_order=True) as file:
        for name, values in (("t", [0.0, 1.0, 2.0]), ("xi", [0.0, 1.0])):
            file.create_dataset(name, data=values, **LARGE).make_scale(name)
        scales = Scales(file)
        for number in range(count):
            axes = ("t", "xi")[: 1 + number % 2]
            shape = tuple(file[axis].size for axis in axes)
            scales.attach(
                file.create_dataset(
                    f"{number // 100}/{number}", shape, np.float64, fillvalue=number
                ),
                axes,
            )
        scales.finish()


@pytest.fixture(scope="module")
def many(tmp_path_factory):
    path = tmp_path_factory.mktemp("scales") / "many.h5"
    write(path, MANY)
    return path


@pytest.mark.sampled(2)
def test_each_knows_of_the_other(many):
    with h5py.File(many) as file:
        for number in (0, 1, MANY - 1):
            dataset = file[f"{number // 100}/{number}"]
            assert [dim[0] for dim in dataset.dims] == [file["t"], file["xi"]][: dataset.ndim]
        assert file["t"].attrs["REFERENCE_LIST"].nbytes > 1 << 16
        for name, expected in (("t", range(MANY)), ("xi", range(1, MANY, 2))):
            belonging = file[name].attrs["REFERENCE_LIST"]
            assert len(belonging) == len(expected)
            for place, number in zip(belonging["dataset"], expected, strict=True):
                assert file[place] == file[f"{number // 100}/{number}"]
            assert set(belonging["dimension"]) == {["t", "xi"].index(name)}


@pytest.mark.long
@pytest.mark.sampled(2)
@pytest.mark.parametrize("engine", ["h5netcdf", "netcdf4"])
def test_xarray_finds_them(many, engine):
    with xarray.open_dataset(many, engine=engine, group="55") as found:
        assert found["5598"].dims == ("t",)
        assert found["5599"].dims == ("t", "xi")
        assert found["5599"].values.tolist() == [[5599.0] * 2] * 3


def test_hdf5_goes_on_with_them(tmp_path):
    """Its own library attaches and detaches scales of such a file."""
    write(tmp_path / "x.h5", 4)
    with h5py.File(tmp_path / "x.h5", "r+") as file:
        assert h5py.h5ds.is_attached(file["0/1"].id, file["xi"].id, 1)
        file["0/1"].dims[1].detach_scale(file["xi"])
        file["more"] = np.zeros((2, 3))
        file["more"].dims[1].attach_scale(file["t"])
    with h5py.File(tmp_path / "x.h5") as file:
        assert [file[place].name for place in file["xi"].attrs["REFERENCE_LIST"]["dataset"]] == [
            "/0/3"
        ]
        assert [file[place].name for place in file["t"].attrs["REFERENCE_LIST"]["dataset"]] == [
            *(f"/0/{number}" for number in range(4)),
            "/more",
        ]


def test_the_same_bytes_every_time(tmp_path):
    for name in ("x.h5", "y.h5"):
        write(tmp_path / name, 40)
    assert (tmp_path / "x.h5").read_bytes() == (tmp_path / "y.h5").read_bytes()


def chain(links):
    m = Mechanism("chain")
    near, drives = m.ground, {}
    for number in range(links):
        link = m.link(f"link{number}", length=0.1, mass=0.2)
        m.revolute(f"joint{number}", near, link)
        near, drives[f"joint{number}"] = link.tip, polynomial(0.1 * number, 1.0)
    return evaluate(
        Scene(m, drives, t=(0.0, 0.1, 5), xi=(0.0, 1.0, 11), wanted=("all",)),
        backend="vm",
        certificate=False,
    )


def test_a_file_grows_as_its_mechanism_does(tmp_path):
    """Four times the links, four times the bytes, or a little less."""
    sizes = []
    for links in (10, 40):
        save(chain(links), tmp_path / "x.h5")
        sizes.append((tmp_path / "x.h5").stat().st_size)
    assert sizes[1] < 4 * sizes[0]


@pytest.mark.long
def test_750_links_are_saved_and_read(tmp_path):
    solution, path = chain(750), tmp_path / "chain.h5"
    save(solution, path)
    assert path.stat().st_size < 750 * 75_000
    back = load(path)
    assert list(back.names()) == list(solution.names())
    for name, values in solution.series.items():
        np.testing.assert_array_equal(back.series[name], values, err_msg=name)
    assert check(path) == []
    for engine in ("h5netcdf", "netcdf4"):
        with xarray.open_dataset(path, engine=engine, group="section/link749") as section:
            assert section["bending"].dims == ("t", "xi")
            np.testing.assert_array_equal(section["bending"], solution.section("link749").bending)
