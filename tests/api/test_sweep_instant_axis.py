"""Sweeps whose designs have instants of their own: the axis they share, in files, tables and
xarray.
"""

import math
import pickle

import h5py
import numpy as np
import pytest
import xarray
from click.testing import CliRunner
from commands import words
from internals import Plan, Request, Status, check_sweep, designs_of
from mechanisms import press, slider_crank, uneven

from lagrange_casadi import Sweep, derive, evaluate, sweep
from lagrange_casadi.cli import program
from lagrange_casadi.errors import DeclarationError, StoreError

GRID = {"rpm": [60.0, 600.0], "l": (0.3, 0.5, 3)}
TURN = math.tau


@pytest.fixture(scope="module")
def over(tmp_path_factory):
    path = tmp_path_factory.mktemp("over") / "x.h5"
    scene = press(wanted=["effort", "section:rod"])
    return sweep(
        scene, GRID, over=("O", 0, "360 deg", 37), keep="histories", xi=(0, 1, 3), out=path
    )


def test_histories_are_over_the_drives_coordinate(over):
    """Every design at the same angles, each at times of its own."""
    np.testing.assert_allclose(over["over"], TURN * np.arange(37) / 36, rtol=1e-15)
    assert over.unit("over") == "rad"
    assert over.column("history:effort:O").axes == ("over",)
    assert over.column("history:section:rod:bending").axes == ("over", "xi")
    np.testing.assert_allclose(
        over["history:t"][:, 0], [np.arange(37) / 36, np.arange(37) / 360], rtol=1e-14
    )
    solution = evaluate(press(), over=("O", 0, TURN, 37), parameters={"rpm": 60.0, "l": 0.4})
    np.testing.assert_allclose(over["history:effort:O"][0, 1], solution.effort("O"), atol=1e-12)
    np.testing.assert_allclose(
        over["peak_over:effort:O"],
        over["peak_t:effort:O"] * TURN * np.array([[1.0], [10.0]]),
        rtol=1e-14,
    )
    assert over.column("peak_over:effort:O").unit == "rad"


def test_the_file_is_whole_and_others_read_it(over):
    assert check_sweep(over.path) == []
    data = over.to_xarray()
    assert data["history:effort:O"].dims == ("rpm", "l", "over")
    assert data.coords["over"].attrs["units"] == "rad"
    with xarray.open_dataset(over.path) as read:
        assert read.coords["over"].attrs["long_name"] == "coordinate of joint 'O'"
    assert over.identity["t"] == [0.0, TURN, 37, "O", 0.0]


def test_tables_have_the_axis_as_a_column(over, tmp_path):
    columns = words("--column history:t --column history:effort:O")
    asked = ["table", str(over.path), *columns, "--csv", str(tmp_path / "x.csv")]
    assert CliRunner().invoke(program, asked).exit_code == 0
    lines = (tmp_path / "x.csv").read_text().splitlines()
    assert lines[0] == "rpm [1/min],l [m],over [rad],history:t [s],history:effort:O [N m]"
    assert len(lines) == 1 + 6 * 37
    told = CliRunner().invoke(program, ["info", str(over.path)]).output
    assert "O [rad]: 0 to 6.28319, 37 points" in told
    assert "effort of the drive over the drive's coordinate" in told


def test_bounds_that_are_expressions_make_each_design_whole(tmp_path):
    """A sweep over the speed sees the whole turn, where one over fixed times
    leaves most of it out.
    """
    scene = press(wanted=["effort"], t=lambda rpm: (0, 60 / rpm, 61))
    found = sweep(scene, {"rpm": (60.0, 6000.0, 4)}, keep="histories", out=tmp_path / "x.h5")
    assert found.column("history:effort:O").axes == ("cycle",)
    np.testing.assert_array_equal(found["cycle"], np.arange(61) / 60)
    np.testing.assert_allclose(found["history:t"][:, -1], 60 / np.linspace(60, 6000, 4), rtol=1e-15)
    by_angle = sweep(press(wanted=["effort"]), {"rpm": (60.0, 6000.0, 4)}, over=("O", 0, TURN, 61))
    np.testing.assert_allclose(found["peak:effort:O"], by_angle["peak:effort:O"], rtol=1e-12)
    start, stop, count = found.identity["t"]
    assert (start, count) == (0.0, 61)
    assert stop.startswith("(60/rpm) #")
    assert (
        "t [s]: 0 to (60/rpm), 61 points"
        in CliRunner().invoke(program, ["info", str(found.path)]).output
    )
    assert check_sweep(found.path) == []


def test_a_design_without_instants_has_a_status_and_no_numbers():
    found = sweep(
        press(wanted=["effort"]),
        {"rpm": [-60.0, 0.0, 60.0]},
        over=("O", 0, TURN, 37),
        keep="histories",
    )
    assert found["status"].tolist() == [Status.NO_INSTANTS, Status.NO_INSTANTS, 0]
    assert found.statuses[Status.NO_INSTANTS][0] == "no_instants"
    for name in ("peak:effort:O", "peak_over:effort:O", "history:t"):
        assert np.isnan(found[name][:2]).all()
        assert np.isfinite(found[name][2]).all()


def test_sweeps_over_times_do_not_know_of_it(tmp_path):
    """Files of before keep their axes, columns and statuses."""
    found = sweep(
        slider_crank(["effort"]), {"l": (0.2, 0.3, 3)}, keep="histories", out=tmp_path / "x.h5"
    )
    assert list(found.columns) == [
        "status",
        "peak:effort:O",
        "peak_t:effort:O",
        "mean:effort:O",
        "rms:effort:O",
        "history:effort:O",
    ]
    assert Status.NO_INSTANTS not in found.statuses
    with h5py.File(found.path) as file:
        assert "over" not in file
        assert file.attrs["t"] == "[0.0, 0.08, 81]"


def test_a_sweep_goes_on_only_over_the_same_instants(tmp_path):
    scene, path = press(wanted=["effort"]), tmp_path / "x.h5"
    sweep(scene, GRID, over=("O", 0, TURN, 37), out=path)
    before = path.read_bytes()
    assert (
        sweep(scene, GRID, over=("O", 0, TURN, 37), out=path, resume=True).path.read_bytes()
        == before
    )
    with pytest.raises(StoreError, match=r"is of another sweep: t was \[0\.0, 6\.28"):
        sweep(scene, GRID, over=("O", 0, 2 * TURN, 37), out=path, resume=True)
    with pytest.raises(DeclarationError, match="t and over exclude each other"):
        sweep(scene, GRID, over=("O", 0, TURN, 37), t=(0, 1, 5))


@pytest.mark.parametrize("asked", ["t", "over"])
def test_a_worker_that_makes_the_scene_anew_has_the_same_instants(asked):
    """What is asked for is sent without the expressions of this process, and comes to the same
    bytes.
    """
    scene = press(uneven, wanted=["effort"])
    rpm = scene.mechanism.parameters["rpm"].symbol
    words = {"t": {"t": (0, 60 / rpm, 31)}, "over": {"over": ("O", rpm / 6000, TURN, 31)}}[asked]
    plan = Plan.of(scene, designs_of({"rpm": [60.0, 600.0]}), Request(**words), "histories")
    other, p = press(uneven, wanted=["effort"]), plan.block(0, 2)
    task = pickle.loads(pickle.dumps(plan.harvest.task))
    harvest = task.harvest(derive(other))
    assert harvest.signature == plan.harvest.signature
    for one, column in zip(harvest.evaluate(p), plan.harvest.evaluate(p), strict=True):
        assert one.tobytes() == column.tobytes()


def test_a_parameter_may_bear_the_name_of_an_axis_that_is_not_there(tmp_path):
    from lagrange_casadi import Mechanism, Scene, motion

    m = Mechanism("m")
    over = m.parameter("over", 1.0, "m")
    m.revolute("O", m.ground, m.link("a", length=over, mass=1.0))
    scene = Scene(m, {"O": motion.polynomial(0, 1.0)}, ["effort"])
    assert Sweep.open(
        sweep(scene, {"over": [1.0, 2.0]}, out=tmp_path / "x.h5").path
    ).dimensions == {"over": 2}
    with pytest.raises(DeclarationError, match="parameter 'over' cannot be an axis"):
        sweep(scene, {"over": [1.0, 2.0]}, over=("O", 0, 1, 5))
