"""No part's name is reserved: a machine whose names are those that files and C give to other
things.
"""

import numpy as np
import pytest
from internals import Output

from lagrange_casadi import Mechanism, Scene, evaluate
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
