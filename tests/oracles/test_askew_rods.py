"""Loops in space closed by rods that lie askew to an axis: without iteration."""

import math

import pytest
from mechanisms import links_of

from lagrange_casadi import Scene, SpatialMechanism, derive, evaluate
from lagrange_casadi.errors import AssemblyError, PostureError
from lagrange_casadi.motion import polynomial

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]


def askew(posture, offset=0.03, reach=0.4):
    """A slider that turns about its guide; the rod's pin passes the guide's line at a distance."""
    m = SpatialMechanism("askew")
    crank, rod, slider = links_of(m, crank=(0.1, 1.0), rod=(reach, 1.0), slider=(0.05, 1.0))
    m.revolute("O", m.ground.at(0.0, 0.12, 0.13), crank, axis=(0.0, 0.3, 1.0))
    m.spherical("A", crank.tip, rod)
    m.revolute("B", slider.at(0.0, offset, 0.0), rod.tip, axis=(0, 0, 1))
    m.cylindrical("G", m.ground, slider, axis=(1, 0, 0))
    return Scene(m, {"O": polynomial(0.3, 6.0)}, t=(0, 1, 21), posture=posture)


@pytest.mark.parametrize("offset", [0.0, 0.03])
def test_no_iteration_is_needed(offset):
    scene = askew({"B": 0.3, "G:turn": 0.9}, offset)
    assert derive(scene).newton is None
    solved = evaluate(scene)
    assert solved.certified
    assert max(solved.certificate[name].max() for name in ("closure", "balance", "power")) < 1e-12


def test_all_ways_of_a_rod_that_lies_askew():
    """The sine of its angle to the guide is of two signs, each with two ways round; the posture
    that is told is the one found.
    """
    for offset in (0.0, 0.03):
        open_ = askew({}, offset)
        with pytest.raises(PostureError, match="can be assembled in several ways") as error:
            evaluate(open_)
        (ways,) = error.value.assembly_modes
        assert len(ways) == 4
        found = []
        for way in ways:
            assert f"'{math.degrees(way['B']):.6g} deg'" in str(error.value)
            solution = evaluate(askew(dict(way), offset))
            assert solution.certified
            assert math.remainder(
                float(solution.motion("B").value[0]) - way["B"], math.tau
            ) == pytest.approx(0.0, abs=1e-9)
            found.append(solution.effort("O"))
        assert len({round(float(effort[3]), 6) for effort in found}) == (4 if offset else 2)


def test_a_sign_that_cannot_be_is_no_way():
    """At a distance from the line the rod reaches the crank on one side only."""
    with pytest.raises(PostureError, match="can be assembled in two ways") as error:
        evaluate(askew({}, 0.2, 0.25), t=(0.0, 0.1, 3))
    assert {round(math.sin(way["B"]), 6) for way in error.value.assembly_modes[0]} == {
        round(math.sin(error.value.assembly_modes[0][0]["B"]), 6)
    }
    with pytest.raises(
        AssemblyError, match="the loop closed by joint 'A' cannot be closed at the start"
    ):
        evaluate(askew({}, 0.0, 0.1))
