"""At which instants a mechanism is drawn: none that looks like another one."""

import numpy as np
import pytest
from internals import stills
from reports import solved

from lagrange_casadi import Mechanism, Scene, evaluate
from lagrange_casadi.motion import harmonic, polynomial

pytestmark = pytest.mark.quick


def turning(law, stop, count):
    m = Mechanism("bar")
    m.revolute("O", m.ground, m.link("bar", length=1.0, mass=1.0))
    return evaluate(Scene(m, {"O": law}, t=(0, stop, count)), backend="vm")


@pytest.mark.parametrize(("turns", "count"), [(1, 41), (2, 81), (2, 83), (3, 100), (0.9, 46)])
def test_a_motion_is_drawn_until_it_repeats_itself(turns, count):
    """Also where no instant is at a whole turn; of less than a turn, both ends."""
    solution = turning(polynomial(0, 2 * np.pi), turns, count)
    angles = 2 * np.pi * solution.t[stills(solution, 4)]
    expected = np.arange(4) * (np.pi / 2 if turns >= 1 else 2 * np.pi * turns / 3)
    np.testing.assert_allclose(angles, expected, atol=1.01 * 2 * np.pi * turns / (count - 1))


def test_there_and_back_is_drawn_once():
    solution = turning(harmonic(0.0, 0.5, 1.0), 1.0, 41)
    assert stills(solution, 4) == [0, 10, 30]


def test_what_stands_still_is_drawn_once():
    assert stills(turning(polynomial(0.3), 1.0, 9), 8) == [0]
    assert stills(turning(polynomial(0, 1), 0.0, 1), 8) == [0]


def test_a_shaft_that_turns_about_itself_is_seen_by_the_axes_of_its_joints():
    assert len(stills(solved("cardan_shaft"), 4)) == 4
