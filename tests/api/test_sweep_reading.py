"""Reading: by value, by design, by xarray; and what is no sweep is refused."""

import gc
from dataclasses import replace

import numpy as np
import pytest
import sweeps
from forging import edit
from internals import ListingListed as Listed
from internals import Sweep, check_sweep, is_sweep, reading, sweep
from internals import runs as store

from lagrange_casadi import load, save
from lagrange_casadi.errors import DeclarationError, PathError, StoreError, UnknownNameError

GRID = {"l": (0.15, 0.4, 6), "r": [0.05, 0.1, 0.07], "m1": [0.1, 0.2]}
LENGTHS = [0.15, 0.2, 0.25, 0.3, 0.35, 0.4]


@pytest.fixture
def swept(monkeypatch, tmp_path):
    sweeps.use(monkeypatch)
    return sweep(sweeps.scene(), GRID, out=tmp_path / "x.h5", xi=(0, 1, 4))


@pytest.fixture
def histories(monkeypatch, tmp_path):
    sweeps.use(monkeypatch)
    grid = {"l": (0.15, 0.4, 6), "r": [0.05, 0.1, 0.07]}
    return sweep(sweeps.scene(), grid, out=tmp_path / "z.h5", xi=(0, 1, 18), keep="histories")


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
    assert {"l", "r", "m1", "xi", "status", "peak:effort:O"} <= set(again)
    assert all(again[name] is not None for name in again)
    with pytest.raises(DeclarationError, match="name: expected a text, got 0"):
        again[0]
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
    np.testing.assert_array_equal(
        swept.select(l=0.1 + 0.15, r=0.07)["peak:effort:O"], whole[2:3, 2:3]
    )
    np.testing.assert_array_equal(swept.select(l=(0.2, 0.3))["peak:effort:O"], whole[1:4])
    scattered = swept.select(r=(0.04, 0.07))
    np.testing.assert_array_equal(scattered["r"], [0.05, 0.07])
    np.testing.assert_array_equal(scattered["peak:effort:O"], whole[:, [0, 2]])
    np.testing.assert_array_equal(scattered.select(r=0.07)["peak:effort:O"], whole[:, 2:3])
    assert scattered.shape == (6, 2, 2)
    for listed in ([0.07, 0.05], np.array([0.05, 0.07])):
        np.testing.assert_array_equal(swept.select(r=listed)["r"], [0.05, 0.07])
    np.testing.assert_array_equal(swept.select(l=(0.3, np.inf))["l"], [0.3, 0.35, 0.4])
    np.testing.assert_array_equal(swept.select(l=(-np.inf, 0.2))["l"], [0.15, 0.2])
    np.testing.assert_array_equal(
        swept.select(l=0.4)["peak_at:section:rod:axial"], swept["peak_at:section:rod:axial"][5:]
    )


@pytest.mark.parametrize(
    "numbers", [[0], [5], [1, 2], [0, 5], [0, 2, 4], [1, 3, 4], [0, 1, 2, 3, 4, 5]]
)
def test_any_numbers_along_an_axis_are_read(swept, numbers):
    found = swept.select(l=[LENGTHS[k] for k in numbers])
    for name in ("peak:effort:O", "peak_at:section:rod:bending"):
        np.testing.assert_array_equal(found[name], swept[name][numbers])
        np.testing.assert_array_equal(found.thinned("r", 2)[name], swept[name][numbers][:, ::2])
    np.testing.assert_array_equal(found["l"], np.array(LENGTHS)[numbers])


def test_a_design_by_its_number(swept, listed):
    assert swept.design(35) == {"l": 0.4, "r": 0.07, "m1": 0.2}
    assert swept.values(35, "status") == {"status": swept["status"][5, 2, 1]}
    rows, other = listed
    assert list(other.design(49).values()) == rows[49].tolist()
    for number in (-1, 36, 10**20):
        for read in (swept.design, lambda number: swept.values(number, "status")):
            with pytest.raises(
                DeclarationError, match=rf"design {number}: expected a number from 0 to 35"
            ):
                read(number)


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
    for none in (0.21, [0.3, 0.21]):
        with pytest.raises(
            DeclarationError, match=r"no design has l = 0\.21; nearest: 0\.2, 0\.25"
        ):
            swept.select(l=none)
    with pytest.raises(
        DeclarationError, match=r"no design has l up to 0\.24 and from 0\.21; nearest: 0\.2, 0\.25"
    ):
        swept.select(l=(0.21, 0.24))
    with pytest.raises(DeclarationError, match="no design has l = inf"):
        swept.select(l=np.inf)
    with pytest.raises(
        DeclarationError,
        match=r"select: l: expected \(low, high\), got \(0\.3, 0\.2\): the range is reversed",
    ):
        swept.select(l=(0.3, 0.2))
    with pytest.raises(
        UnknownNameError, match=r"unknown column 'peak:effort:Q' \(did you mean 'peak:effort:O'\?\)"
    ):
        swept["peak:effort:Q"]


@pytest.mark.parametrize(
    "wrong",
    [
        slice(0.2, 0.3),
        "0.2",
        None,
        np.nan,
        (0.1, 0.2, 0.3),
        (0.2,),
        [],
        [0.2, np.nan],
        {"a": 1},
        [[0.2]],
    ],
)
def test_what_selects_nothing_is_named(swept, wrong):
    with pytest.raises(
        DeclarationError,
        match=r"select: l: expected a number, a list of numbers, or a tuple \(low, high\), got ",
    ):
        swept.select(l=wrong)


def test_an_unknown_one_of_many_columns_is_answered_by_the_nearest(swept):
    many = replace(
        swept,
        columns={f"peak:effort:J{k}": swept.columns["peak:effort:O"] for k in range(30)}
        | swept.columns,
    )
    with pytest.raises(UnknownNameError) as caught:
        many.column("peak:effort:P")
    hint = f"`lagrange-casadi info {swept.path}` lists the {len(many.columns) + 3} there are"
    assert (
        str(caught.value)
        == f"unknown column 'peak:effort:P' (did you mean 'peak:effort:O'?); {hint}"
    )
    with pytest.raises(
        UnknownNameError,
        match=r"unknown column 'bending' \(did you mean 'peak:section:rod:bending'\?\)",
    ):
        many.column("bending")


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
    with pytest.raises(
        DeclarationError,
        match="column 'peak_at:section:rod:axial' has a value for every xi, not one a design",
    ):
        list(swept.blocks(["peak_at:section:rod:axial"]))


@pytest.mark.sampled(7)
@pytest.mark.parametrize("size", [1, 9, 40, 1 << 15])
@pytest.mark.parametrize("along", [("t",), ("xi",), ("t", "xi")])
def test_blocks_of_rows_along_axes(histories, monkeypatch, size, along):
    """Against arrays broadcast here; a selection of designs, and as many of them as there are
    ratios.
    """
    monkeypatch.setattr(reading, "_BLOCK", size)
    own = {
        "t": "history:effort:O",
        "xi": "peak_at:section:rod:axial",
        "t xi": "history:section:rod:shear",
    }[" ".join(along)]
    for cut in (histories, histories.select(r=0.07, l=(0.2, 0.35))):
        blocks = list(cut.blocks(["r", "status", own, *along], along))
        numbers = np.concatenate([places for places, _ in blocks])
        shape = (*cut.shape, *(histories[axis].size for axis in along))
        everywhere = np.arange(18).reshape(6, 3)[
            np.ix_(*(cut.chosen.get(name, np.arange(n)) for name, n in cut.dimensions.items()))
        ]
        spare = (1,) * len(along)
        expected = {
            "r": cut["r"].reshape(1, -1, *spare),
            "status": cut["status"].reshape(*cut.shape, *spare),
            own: cut[own],
            **dict(
                zip(along, np.meshgrid(*(cut[axis] for axis in along), indexing="ij"), strict=True)
            ),
        }
        np.testing.assert_array_equal(
            numbers, np.broadcast_to(everywhere.reshape(*cut.shape, *spare), shape).ravel()
        )
        for name, values in expected.items():
            found = np.concatenate([block[name] for _, block in blocks])
            np.testing.assert_array_equal(found, np.broadcast_to(values, shape).ravel())
        assert max(places.size for places, _ in blocks) <= max(size, np.prod(shape[2:]))


def test_an_axis_is_no_column(histories):
    said = (
        "'xi' is no column but an axis: it needs a column over xi, as peak_at:section:rod:axial is"
    )
    for read in (
        lambda: histories.column("xi"),
        lambda: histories.blocks(["l", "q", "xi"]),
        lambda: histories.blocks(["xi"], ["t"]),
        lambda: histories.values(0, ["xi"]),
    ):
        with pytest.raises(DeclarationError, match=said):
            read()
    with pytest.raises(DeclarationError, match="as history:effort:O is"):
        histories.column("t")


def test_all_unknown_names_are_told(histories):
    for read in (
        lambda: histories.axes_of(["l", "p", "q"]),
        lambda: histories.blocks(["p", "status", "q"]),
    ):
        with pytest.raises(
            UnknownNameError, match=r"unknown columns 'p' .*, 'q'; `lagrange-casadi info "
        ):
            read()
    with pytest.raises(UnknownNameError, match="unknown swept parameters 'm3', 'q'; valid: l, r"):
        histories.select(m3=0.1, l=0.2, q=1)


def test_rows_along_axes_that_are_none_are_refused(histories, monkeypatch, tmp_path):
    with pytest.raises(
        DeclarationError,
        match="column 'history:effort:O' has a value for every t, not one a design",
    ):
        histories.blocks(["history:effort:O"], ["xi"])
    with pytest.raises(UnknownNameError, match="unknown axis 'x'"):
        histories.blocks(["status"], ["x"])
    with pytest.raises(
        DeclarationError,
        match="for every t, 'history:section:rod:axial' for every t and xi: write a table for each",
    ):
        histories.axes_of(["l", "status", "history:effort:O", "history:section:rod:axial"])
    assert histories.axes_of(["l", "status", "history:section:rod:axial"]) == ("t", "xi")
    assert histories.axes_of("status") == ()
    assert histories.axes_of(["xi"]) == ()
    assert histories.axes_of(["xi", "history:effort:O"]) == ("t",)
    with pytest.raises(DeclarationError, match="column 'history:effort:O' has a value for every t"):
        histories.values(3, ["history:effort:O"])


def test_xarray(swept, listed):
    found = swept.select(l=(0.2, 0.3)).to_xarray(["peak:effort:O", "peak_at:section:rod:axial"])
    assert found["peak_at:section:rod:axial"].dims == ("l", "r", "m1", "xi")
    assert found["peak:effort:O"].attrs["units"] == "N m"
    assert found["l"].attrs["units"] == "m"
    assert (
        float(found["peak:effort:O"].sel(l=0.25, r=0.07, m1=0.1)) == swept["peak:effort:O"][2, 2, 0]
    )
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
    with pytest.raises(
        StoreError, match=r"run\.h5: not the file of a sweep, but that of a run, which `load` reads"
    ):
        Sweep.open(tmp_path / "run.h5")
    with pytest.raises(
        StoreError,
        match=r"x\.h5: not the file of a run, but that of a sweep, which `Sweep\.open` reads",
    ):
        load(swept.path)
    with pytest.raises(StoreError):
        store.check(swept.path)
    with pytest.raises(PathError, match="no such file"):
        Sweep.open(tmp_path / "nothing.h5")
    with pytest.raises(PathError, match="is a folder"):
        Sweep.open(tmp_path)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda h: h.attrs.__delitem__("complete"), "was not written to its end"),
        (
            lambda h: h.attrs.__setitem__("schema_version", 99),
            "schema version 99 of sweeps, this program reads version 1",
        ),
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
        (
            lambda h: h["peak/effort/O"].__setitem__(_first(h, 0), np.nan),
            "peak:effort:O: 1 of the designs that have a result lack it",
        ),
        (
            lambda h: h["peak/effort/O"].__setitem__(_first(h, 1), 3.0),
            "peak:effort:O: 1 of the designs that have no result have a number",
        ),
        (
            lambda h: h["status"].__setitem__(_first(h, 1), 99),
            "status: 1 of the designs have an unknown status",
        ),
        (
            lambda h: h["peak/effort/O"].dims[1].detach_scale(h["r"]),
            "peak:effort:O: axis 1 has no scale r",
        ),
    ],
)
def test_check_names_what_is_wrong(swept, change, finding):
    edit(swept.path, change)
    assert check_sweep(swept.path)[0] == finding
