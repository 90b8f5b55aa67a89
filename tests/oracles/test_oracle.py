"""What the oracle says of mechanisms that have no one answer: which forces are open, and how far a
dead centre is.
"""

import math

import numpy as np
import oracle
import pytest

pytestmark = pytest.mark.quick

STILL = {"bar": (0.0, 0.0, 0.0)}


def bar(*joints):
    """A bar of a metre and 2 kg."""
    return oracle.Oracle([oracle.from_density("bar", 1.0, lambda u: 2.0)], joints)


def pin(name, x, at):
    return oracle.Joint(name, "revolute", ("ground", x, 0), ("bar", at, 0))


def test_pins_at_both_ends_share_what_is_along_the_bar():
    found = bar(pin("A", 0, 0), pin("B", 1, 1)).solve({}, STILL)
    assert found.open == {"reaction:A:fx", "reaction:B:fx"}
    assert found.reactions["A"][1] == pytest.approx(9.81)
    assert found.open_sections["bar"](0.3) == (True, False, False)
    assert found.sections["bar"](0.5)[2] == pytest.approx(2.0 * 9.81 / 8)


def slider_crank(angle):
    """A crank of 0.1 m and a rod of 0.3 m, the slider driven."""
    rods = [
        oracle.from_density(name, length, lambda u: 1.0)
        for name, length in (("a", 0.1), ("b", 0.3))
    ]
    joints = [
        oracle.Joint("O", "revolute", ("ground", 0, 0), ("a", 0, 0)),
        oracle.Joint("A", "revolute", ("a", 0.1, 0), ("b", 0, 0)),
        oracle.Joint("B", "revolute", ("b", 0.3, 0), ("s", 0, 0)),
        oracle.Joint("P", "prismatic", ("ground", 0, 0), ("s", 0, 0)),
    ]
    model = oracle.Oracle([*rods, oracle.Body("s", 1.0, oriented=False)], joints)
    x, y = 0.1 * math.cos(angle), 0.1 * math.sin(angle)
    lean = -math.asin(y / 0.3)
    place = x + 0.3 * math.cos(lean)
    return model.move(
        {"P": (place, 0.1, 0.0)}, {"a": (0, 0, angle), "b": (x, y, lean), "s": (place, 0, 0)}
    )


def test_a_dead_centre_is_near_where_crank_and_rod_are_in_line():
    far, near, beyond = slider_crank(1.0), slider_crank(0.02), slider_crank(-0.02)
    assert far.steadiness > 10 * near.steadiness > 0
    assert oracle.passed(near, beyond)
    assert not oracle.passed(far, near)


def test_all_is_open_that_several_joints_bear_together():
    """A joint declared twice: both bear the sum, in parts that nothing tells; the rest is as with
    one.
    """
    welds = [oracle.Joint(name, "weld", ("ground", 0, 0), ("bar", 0, 0)) for name in "WV"]
    one, two = bar(welds[0]).solve({}, STILL), bar(*welds).solve({}, STILL)
    assert one.open == set()
    assert two.open == {
        f"reaction:{joint}:{member}" for joint in "WV" for member in ("fx", "fy", "mz")
    }
    np.testing.assert_allclose(two.sections["bar"](0.2), one.sections["bar"](0.2), atol=1e-12)
    assert two.open_sections["bar"](0.2) == (False, False, False)


def test_loops_that_do_not_close_are_told():
    with pytest.raises(oracle.OpenLoopError):
        bar(pin("A", 0, 0), pin("B", 2, 1)).solve({}, STILL)
