"""No part's name is reserved: a machine whose names are those that files and C give to other
things.
"""

import numpy as np
import pytest
from exported import by_c99, compare, expected, exported, instants, solve
from internals import Output, check, load
from internals import runs_save as save
from machines import called_as_rates

from lagrange_casadi import Mechanism, Scene, Sweep, evaluate, refine, sweep
from lagrange_casadi.motion import harmonic, polynomial

PLAIN = {
    "law": "hinge",
    "O_rate": "knee",
    "pull_2": "push",
    "law_rate": "size",
    "rod_acceleration": "bob",
}
STATIONS = PLAIN | {"pull_3": "pull_2"}


def machine(called):
    """A slider-crank with a driven bob in the middle of its rod, at which two loads act twice."""
    m = Mechanism("namesake")
    size = m.parameter(called("law_rate"), 0.3)
    crank = m.link("crank", length=size, mass=1.0)
    rod = m.link("rod", length=0.9, mass=2.0)
    bob = m.link(called("rod_acceleration"), length=0.2, mass=0.5)
    m.revolute("O", m.ground, crank)
    m.revolute(called("O_rate"), crank.tip, rod)
    m.slot("guide", m.ground, rod.tip, axis=(1.0, 0.0))
    m.revolute(called("law"), rod.at(0.45), bob)
    m.spring("pull", rod.at(0.2), rod.at(0.7), stiffness=100.0, length=0.1)
    m.force(called("pull_2"), rod.at(0.5), y=-7.0)
    motion = {"O": polynomial(0.3, 5.0), called("law"): harmonic(0.0, 0.5, 3.0, 0.0)}
    return Scene(m, motion, t=(0.0, 1.0, 41), posture={"rod": 0.0})


@pytest.fixture(scope="module")
def scenes():
    return machine(lambda name: name), machine(lambda name: PLAIN.get(name, name))


@pytest.fixture(scope="module")
def solutions(scenes):
    return tuple(evaluate(scene, backend="vm") for scene in scenes)


def test_outputs_are_those_of_a_machine_with_plain_names(solutions):
    named, plain = solutions
    assert named.certified
    assert len(named.series) == len(plain.series)
    for output, values in named.outputs.items():
        part = PLAIN.get(output.part, output.part)
        station = STATIONS.get(output.load_point, output.load_point)
        np.testing.assert_array_equal(
            values, plain.outputs[Output(output.group, part, output.member, station)]
        )


def test_a_coordinate_and_a_rate_are_told_apart(solutions):
    named, plain = solutions
    np.testing.assert_array_equal(named.series["motion:O_rate"], np.full(41, 5.0))
    np.testing.assert_array_equal(
        named.series["motion:O_rate.coordinate"], plain.motion("knee").value
    )
    np.testing.assert_array_equal(named.motion("O_rate").rate, plain.motion("knee").rate)
    assert named.unit("motion:O_rate") == "rad/s"
    assert named.unit("motion:O_rate.coordinate") == "rad"


def test_what_acts_twice_hides_no_other_load(solutions):
    """A spring between two places of one link is two stations: the second is not called as a load
    is.
    """
    named, _ = solutions
    stations = {output.load_point for output in named.outputs if output.load_point}
    assert stations == {"law", "pull", "pull_2", "pull_3"}
    np.testing.assert_allclose(
        np.hypot(named.series["section:rod:pull_2:n"], named.series["section:rod:pull_2:f"]),
        7.0,
        rtol=1e-14,
    )


def test_files_and_peaks_know_them(scenes, solutions, tmp_path):
    named, _ = solutions
    save(named, tmp_path / "run.h5")
    again = load(tmp_path / "run.h5")
    assert list(again.outputs) == list(named.outputs)
    assert all(np.array_equal(again.series[name], values) for name, values in named.series.items())
    assert check(tmp_path / "run.h5") == []
    names = ["motion:O_rate.coordinate", "section:rod:bending", "effort:law"]
    assert [peak.name for peak in refine(scenes[0], named, names)] == names


def test_sweeps_know_them(scenes, solutions, tmp_path):
    sweep(
        scenes[0],
        {"law_rate": (0.25, 0.35, 3)},
        out=tmp_path / "s.h5",
        workers=1,
        xi=(0.0, 1.0, 5),
        keep="histories",
    )
    swept = Sweep.open(tmp_path / "s.h5")
    named, _ = solutions
    np.testing.assert_allclose(
        swept["history:section:rod:law:n0"][1],
        named.series["section:rod:law:n0"],
        rtol=1e-9,
        atol=1e-9,
    )
    np.testing.assert_allclose(
        swept["history:section:rod:law:n"][1],
        named.series["section:rod:law:n"],
        rtol=1e-9,
        atol=1e-9,
    )


def test_exported_c_knows_them(scenes, tmp_path):
    made, told = exported(scenes[0], tmp_path / "c")
    solution = solve(scenes[0], "double")
    found = by_c99(tmp_path / "c", told, instants(solution.t, "double"))
    compare(found, expected(scenes[0], told, solution), told, made, solution)
    assert {"O_rate", "motion_O_rate_coordinate"} <= {
        member.name for member in (*made.inputs, *made.outputs)
    }


@pytest.mark.parametrize("precision", ["double", "single"])
def test_exported_c_tells_a_drive_from_the_rate_that_is_called_so(precision, tmp_path):
    scene = called_as_rates()
    made, told = exported(scene, tmp_path, precision=precision)
    solution = solve(scene, precision)
    found = by_c99(tmp_path, told, instants(solution.t, precision))
    compare(found, expected(scene, told, solution), told, made, solution)
    names = [member.name for member in made.inputs if not member.rest_of]
    assert names[3:] == ["pin_rate_coordinate", "pin_rate_rate", "pin_rate_acceleration"]
