"""Mechanisms as plain numbers: what files keep of those in space, and what is refused of a file."""

import json
import math

import numpy as np
import pytest
from internals import (
    check_shape,
    coordinates_of,
    drives_of,
    motions_of,
    shape_of,
    template,
)

from lagrange_casadi import Scene, SpatialMechanism, motion

pytestmark = pytest.mark.quick

INERTIA = ((3.0, 0.1, 0.2), (0.1, 4.0, 0.3), (0.2, 0.3, 5.0))


def scene(drives=None):
    m = SpatialMechanism("described")
    lead = m.parameter("lead", 0.2, "m")
    arm = m.link("arm", length=0.5, mass=1.0)
    tool = m.link("tool", length=0.1, mass=2.0, centre=(0.01, 0.02, 0.03), inertia=INERTIA)
    m.set_gravity(1.0, 2.0, 3.0)
    m.universal(
        "U",
        m.ground.at(1, 2, 3),
        arm,
        axis=(0, 0, 2),
        second=(0, 3, 0),
        turned=[("z", math.pi / 2)],
    )
    m.screw("N", arm.tip, tool.at(0.1, 0.2, 0.3), axis=(1, 0, 0), lead=lead)
    m.force("wind", tool.at(0.1, 0, 0.4), z=1.0, turning=True)
    laws = {"U": [motion.polynomial(0.1), motion.polynomial(0.2)], "N": motion.polynomial(0, 1.0)}
    return Scene(m, laws, t=(0, 1, 3), drives=drives)


def test_all_is_told_in_plain_numbers():
    found = template(scene()).filled({"lead": 0.2})
    assert json.loads(json.dumps(found)) == found
    assert found["gravity"] == [1.0, 2.0, 3.0]
    assert found["bodies"]["tool"]["centre"] == {
        "x": 0.01,
        "y": 0.02,
        "z": 0.03,
        "inertia": [*map(list, INERTIA)],
    }
    assert found["loads"]["wind"] == {
        "kind": "force",
        "points": [{"body": "tool", "x": 0.1, "y": 0.0, "z": 0.4}],
        "turning": True,
    }
    universal, screw = found["joints"]["U"], found["joints"]["N"]
    assert universal["coordinates"] == {"U:turn_1": "angle", "U:turn_2": "angle"}
    assert universal["driven"] == ["U:turn_1", "U:turn_2"]
    assert universal["axes"] == [[0, 0, 1], [0, 1, 0]]
    assert universal["triad"] == [[0, 0, 1], [0, 1, 0], [-1, 0, 0]]
    np.testing.assert_allclose(universal["turned"], [[0, 1, 0], [-1, 0, 0], [0, 0, 1]], atol=1e-16)
    assert universal["parent"] == {"body": "ground", "x": 1.0, "y": 2.0, "z": 3.0}
    assert screw["coordinates"] == {"N": "angle"}
    assert screw["pitch"] == pytest.approx(0.2 / math.tau)
    assert found["bars"] == found["unmeasured"] == []


@pytest.mark.parametrize("drives", [None, ["U:turn_1", "U:turn_2", "N"]])
def test_drives_are_coordinates(drives):
    found = template(scene(drives)).filled({"lead": 0.2})
    assert drives_of(found) == [*coordinates_of(found)] == ["U:turn_1", "U:turn_2", "N"]
    assert motions_of(found) == {"U:turn_1": "angle", "U:turn_2": "angle", "N": "angle"}


OTHERWISE = [
    (("joints", "U", "axes", 0), [0.0, 1.0]),
    (("joints", "U", "turned"), [[1.0, 0.0, 0.0]]),
    (("joints", "U", "driven"), True),
    (("joints", "N", "parent"), {"body": "arm", "x": 0.5, "y": 0.0}),
    (("bodies", "tool", "centre", "inertia"), 1.0),
    (("loads", "wind", "turning"), None),
    (("bars",), "arm"),
    (("gravity",), [0.0, 0.0, 0.0, 0.0]),
    (("gravity",), [0.0, 0.0]),
]


@pytest.mark.parametrize(("path", "value"), OTHERWISE)
def test_what_a_file_has_otherwise_is_refused(path, value):
    """Of a mechanism in space all is held to its own shape, and what has a gravity of two
    components to that of a plane.
    """
    found = json.loads(json.dumps(template(scene()).filled({"lead": 0.2})))
    check_shape(found, shape_of, "mechanism")
    part = found
    for key in path[:-1]:
        part = part[key]
    part[path[-1]] = value
    with pytest.raises(ValueError, match="is not of the expected kind"):
        check_shape(found, shape_of, "mechanism")
