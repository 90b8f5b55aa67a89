"""Derivatives of peaks as columns of a sweep: those of a prepared scene, in conditions, in the
file, on the axes of figures.
"""

import h5py
import numpy as np
import pytest
from internals import check_sweep, is_of, label

from lagrange_casadi import Sweep, best, prepare, sweep
from lagrange_casadi.errors import DeclarationError

pytestmark = pytest.mark.quick

WANTED = ["effort", "section:rod", "sensitivity:l", "sensitivity:m3"]
GRID = {"r": (0.06, 0.1), "l": (0.09, 0.25, 0.3)}
SPAN = (0, 0.08, 65)


@pytest.fixture(scope="module")
def swept(slider_crank, tmp_path_factory):
    return sweep(
        slider_crank,
        GRID,
        t=SPAN,
        wanted=WANTED,
        out=tmp_path_factory.mktemp("slopes") / "a.h5",
        workers=1,
    )


def test_they_are_those_of_a_prepared_scene(slider_crank, swept):
    f = prepare(slider_crank.scene, t=SPAN, wanted=WANTED)
    for i, r in enumerate(GRID["r"]):
        for j, l in enumerate(GRID["l"]):
            if l < r:
                assert np.isnan(swept["sensitivity:l:peak:effort:O"][i, j])
                continue
            gradient = f.gradient(r=r, l=l)
            for name in f.quantities:
                for by in ("l", "m3"):
                    assert swept[f"sensitivity:{by}:peak:{name}"][i, j] == gradient[name][by]
            for by in ("l", "m3"):
                assert (
                    swept[f"sensitivity:{by}:mean:effort:O"][i, j] == gradient.mean["effort:O"][by]
                )
                assert swept[f"sensitivity:{by}:rms:effort:O"][i, j] == gradient.rms["effort:O"][by]


def test_they_are_columns_as_others(swept):
    assert check_sweep(swept.path) == []
    assert swept.unit("sensitivity:m3:peak:section:rod:axial") == "N/kg"
    assert "sensitivity:r:peak:effort:O" not in swept.columns
    assert (
        label(swept, "sensitivity:l:peak:section:rod:bending")
        == "rod bending, peak, derivative by l [N m/m]"
    )
    assert swept.unit("sensitivity:l:rms:effort:O") == "N m/m"
    assert label(swept, "sensitivity:l:rms:effort:O") == "effort O, rms, derivative by l [N m/m]"
    column = swept["sensitivity:l:peak:effort:O"]
    below = float(np.nanmedian(column))
    (found,) = best(
        swept, minimise="peak:effort:O", where=[f"sensitivity:l:peak:effort:O<{below}", "r=0.1"]
    )
    assert found.values["l"] in GRID["l"]
    assert column[1, GRID["l"].index(found.values["l"])] < below
    with h5py.File(swept.path) as file:
        assert (
            file["sensitivity/l/peak/effort/O"].attrs["long_name"]
            == "derivative by l of the peak: effort of the drive"
        )


def test_a_sweep_without_them_is_another_one(slider_crank, swept, tmp_path):
    plain = sweep(slider_crank, GRID, t=SPAN, wanted=WANTED[:2], out=tmp_path / "b.h5", workers=1)
    assert not [name for name in plain.columns if name.startswith("sensitivity")]
    np.testing.assert_array_equal(plain["peak:effort:O"], swept["peak:effort:O"])
    assert is_of(swept, slider_crank.scene)
    assert Sweep.open(swept.path).identity["wanted"]["sensitivity"] == ["l", "m3"]


def test_all_is_without_them_unless_they_are_named(slider_crank):
    kept = sweep(slider_crank, {"l": (0.2,)}, t=(0, 0.08, 9), wanted=["all", "sensitivity:r"])
    assert {name.split(":")[1] for name in kept.columns if name.startswith("sensitivity")} == {"r"}
    assert not [name for name in kept.columns if "motion" in name]


def test_only_sensitivities_are_nothing(slider_crank):
    with pytest.raises(DeclarationError, match="sensitivities need other outputs"):
        sweep(slider_crank, {"l": (0.2,)}, wanted=["sensitivity:l"])
