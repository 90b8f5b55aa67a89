"""No part's name is reserved: a machine whose names are those that files and C give to other things
has the numbers of one with plain names.
"""

import numpy as np
from every_way import namesake

from lagrange_casadi import evaluate

PLAIN = {
    "law": "hinge",
    "O_rate": "knee",
    "pull_2": "push",
    "law_rate": "size",
    "rod_acceleration": "bob",
}
STATIONS = PLAIN | {"pull_3": "pull_2"}
"""What acts twice hides no other load: the second station is not called as a load is."""


def test_outputs_are_those_of_a_machine_with_plain_names():
    named = evaluate(namesake(), backend="vm")
    plain = evaluate(namesake(lambda name: PLAIN.get(name, name)), backend="vm")
    expected = {
        (one.group, one.part, one.member, one.load_point): values
        for one, values in plain.outputs.items()
    }
    assert named.certified
    assert len(named.series) == len(plain.series)
    for one, values in named.outputs.items():
        part, station = PLAIN.get(one.part, one.part), STATIONS.get(one.load_point, one.load_point)
        np.testing.assert_array_equal(values, expected[one.group, part, one.member, station])
    np.testing.assert_array_equal(named.series["motion:O_rate"], np.full(41, 5.0))
    knee = named.series["motion:O_rate.coordinate"]
    np.testing.assert_array_equal(knee, plain.motion("knee").value)
    units = [named.unit(f"motion:O_rate{end}") for end in ("", ".coordinate")]
    assert units == ["rad/s", "rad"]
