"""Loops in space closed along lines, and by rods that lie askew to an axis: without iteration."""

import math

import numpy as np
import pytest
from spatial_draft import orientation

from lagrange_casadi import Scene, SpatialMechanism, derive, evaluate
from lagrange_casadi.errors import AssemblyError, PostureError
from lagrange_casadi.motion import polynomial

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]

R = orientation(np.random.default_rng(7))
TURN = tuple(map(tuple, R.T))


def turned(x, y=0.0, z=0.0):
    """A direction or place of the drawing, wherever the drawing lies."""
    return tuple((R @ [x, y, z]).tolist())


def started(name):
    """A mechanism whose first link lies as the drawing does."""
    m = SpatialMechanism(name)
    sheet = m.link("sheet", length=1.0, mass=1.0)
    m.weld("sheet_on_ground", m.ground, sheet, turned=(TURN[0], TURN[1]))
    return m, sheet


def slotted(tilt=0.0):
    """A crank's pin in the slot of a swinging arm; the slot's line is off the arm's."""
    m, sheet = started("slotted")
    crank, arm = m.link("crank", length=0.1, mass=1.0), m.link("arm", length=0.6, mass=2.0)
    m.revolute("O", sheet, crank, axis=(0, 0, 1))
    m.revolute("C", sheet.at(0.0, -0.3, 0.0), arm, axis=(0, 0, 1))
    m.slot("S", arm.at(0.0, 0.02, 0.0), crank.tip, axis=(1.0, tilt, 0.0))
    return Scene(m, {"O": polynomial(0.3, 6.0)}, t=(0, 1, 21), posture={"C": 1.5})


def guided(offset=0.0):
    """A slider-crank whose slider may turn about its guide, which the ground holds anyhow."""
    m = SpatialMechanism("guided")
    crank = m.link("crank", length=0.1, mass=1.0)
    rod = m.link("rod", length=0.4, mass=1.0)
    slider = m.link("slider", length=0.05, mass=1.0)
    m.revolute(
        "O",
        m.ground.at(*turned(0.0, offset)),
        crank,
        axis=turned(0, 0, 1),
        turned=(TURN[0], TURN[1]),
    )
    m.revolute("A", crank.tip, rod, axis=(0, 0, 1))
    m.revolute("B", rod.tip, slider, axis=(0, 0, 1))
    m.cylindrical("G", m.ground, slider, axis=turned(1), turned=(TURN[0], TURN[1]))
    return Scene(m, {"O": polynomial(0.3, 6.0)}, t=(0, 1, 21), posture={"A": -0.4, "B": 0.1})


def askew(posture, offset=0.03, reach=0.4):
    """A slider that turns about its guide; the rod's pin passes the guide's line at a distance."""
    m = SpatialMechanism("askew")
    crank = m.link("crank", length=0.1, mass=1.0)
    rod = m.link("rod", length=reach, mass=1.0)
    slider = m.link("slider", length=0.05, mass=1.0)
    m.revolute("O", m.ground.at(0.0, 0.12, 0.13), crank, axis=(0.0, 0.3, 1.0))
    m.spherical("A", crank.tip, rod)
    m.revolute("B", slider.at(0.0, offset, 0.0), rod.tip, axis=(0, 0, 1))
    m.cylindrical("G", m.ground, slider, axis=(1, 0, 0))
    return Scene(m, {"O": polynomial(0.3, 6.0)}, t=(0, 1, 21), posture=posture)


SCENES = {
    "slot": slotted,
    "slot off the arm": lambda: slotted(0.2),
    "guide": guided,
    "guide beside the crank": lambda: guided(0.03),
    "askew": lambda: askew({"B": 0.3, "G:turn": 0.9}, 0.0),
    "askew, at a distance": lambda: askew({"B": 0.3, "G:turn": 0.9}),
}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", SCENES)
def test_no_iteration_is_needed(name):
    scene = SCENES[name]()
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
