"""Dimension scales: what HDF5's own library reads and goes on with, of any number of datasets."""

import h5py
import numpy as np

from lagrange_casadi import Mechanism, Scene, evaluate, save
from lagrange_casadi.motion import polynomial


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


def test_hdf5_finds_the_scales_and_goes_on_with_them(tmp_path):
    """Each dataset knows its axes, each axis its datasets; scales can be attached and detached."""
    save(chain(3), tmp_path / "x.h5")
    with h5py.File(tmp_path / "x.h5", "r+") as file:
        over = {name: [] for name in ("t", "xi")}

        def visited(name, one):
            for k, axis in enumerate(getattr(one, "dims", ())):
                if len(axis):
                    over[axis[0].name[1:]].append((one.name, k))

        file.visititems(visited)
        for name, expected in over.items():
            listed = file[name].attrs["REFERENCE_LIST"]
            pairs = zip(listed["dataset"], listed["dimension"], strict=True)
            assert sorted((file[place].name, k) for place, k in pairs) == sorted(expected)
            assert len(expected) > 8
        section = file["section/link0/bending"]
        assert [axis[0].name for axis in section.dims] == ["/t", "/xi"]
        section.dims[1].detach_scale(file["xi"])
        file["more"] = np.zeros((2, 5))
        file["more"].dims[1].attach_scale(file["t"])
        assert len(file["xi"].attrs["REFERENCE_LIST"]) == len(over["xi"]) - 1
        assert len(file["t"].attrs["REFERENCE_LIST"]) == len(over["t"]) + 1
