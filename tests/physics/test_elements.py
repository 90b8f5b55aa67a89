"""Plates, bent bars and cylinders: closed forms, and that they are what they are made of."""

from __future__ import annotations

import math

import numpy as np
import pytest

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, evaluate
from lagrange_casadi.elements import bent_bar, cylinder, plate
from lagrange_casadi.errors import DeclarationError
from lagrange_casadi.motion import move, moves, polynomial

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]


def test_a_bar_bent_in_space_bends_and_twists_as_statics_says():
    """A crank handle that hangs on three ways at right angles, held at its base, with a weight at
    its end.
    """
    m = SpatialMechanism("handle")
    bar = bent_bar(m, "bar", [(0, 0, 0), (0.3, 0, 0), (0.3, 0.2, 0), (0.3, 0.2, 0.1)], mass=0.6)
    m.revolute("O", m.ground, bar.base, axis=(0, 0, 1))
    m.force("weight", bar.tip, x=7.0, y=0.0, z=-30.0)
    m.set_gravity(0, 0, 0)
    solution = evaluate(Scene(m, {"O": polynomial(0.0)}, t=(0, 1, 2)))
    assert solution.certified
    push = np.array([7.0, 0.0, -30.0])
    places = {"bar_1": (0, 0, 0), "bar_2": (0.3, 0, 0), "bar_3": (0.3, 0.2, 0)}
    for name, way in (("bar_1", (1, 0, 0)), ("bar_2", (0, 1, 0)), ("bar_3", (0, 0, 1))):
        moment = np.cross(np.array([0.3, 0.2, 0.1]) - places[name], push)
        section, along = solution.section(name), np.array(way)
        assert section.axial[0, 0] == pytest.approx(push @ along, abs=1e-13)
        assert section.torsion[0, 0] == pytest.approx(moment @ along, abs=1e-13)
        assert section.bending[0, 0] == pytest.approx(
            np.linalg.norm(moment - (moment @ along) * along), abs=1e-13
        )


def test_corners_oblique_in_space_are_where_they_are_told():
    m = SpatialMechanism("oblique")
    corners = [(0.1, 0.2, -0.1), (0.4, 0.1, 0.3), (0.2, 0.5, 0.2), (0.2, 0.5, 0.9)]
    bar = bent_bar(m, "bar", corners, mass=1.0)
    m.free("J", m.ground, bar.base)
    ends = [m.place(corner) for corner in bar.corners]
    for k, (x, y, z) in enumerate(ends):
        for axis, value in zip("xyz", (x, y, z), strict=True):
            m.output(f"c{k}_{axis}", value)
    still = {
        f"J:{axis}": polynomial(0.3)
        for axis in ("slide_1", "slide_2", "slide_3", "turn_1", "turn_2", "turn_3")
    }
    solution = evaluate(Scene(m, still, t=(0, 1, 2)))
    found = np.array([[solution.output(f"c{k}_{axis}")[0] for axis in "xyz"] for k in range(4)])
    gaps = [[math.dist(one, other) for other in found] for one in found]
    assert np.array(gaps) == pytest.approx(
        np.array([[math.dist(one, other) for other in corners] for one in corners]), abs=1e-14
    )
    volume = [np.linalg.det(np.diff(np.array(places), axis=0)) for places in (found, corners)]
    assert volume[0] == pytest.approx(volume[1], abs=1e-14)  # no mirror image


def declared(make, space=False):
    m = SpatialMechanism("m") if space else Mechanism("m")
    return lambda: make(m)


@pytest.mark.parametrize(
    ("says", "make"),
    {
        "plate 'p': expected three corners or more": declared(
            lambda m: plate(m, "p", [(0, 0), (1, 0)], mass=1.0)
        ),
        "plate 'p': its corners lie on a line": declared(
            lambda m: plate(m, "p", [(0, 0), (1, 0), (2, 0)], mass=1.0)
        ),
        "the edges from corners 0 and 2 cross": declared(
            lambda m: plate(m, "p", [(0, 0), (1, 1), (1, 0), (0, 1)], mass=1.0)
        ),
        "plate 'p': corner 2: expected 2 numbers, got 3": declared(
            lambda m: plate(m, "p", [(0, 0), (1, 0), 3], mass=1.0)
        ),
        "plate 'p': expected mass= or per_area=": declared(
            lambda m: plate(m, "p", [(0, 0), (1, 0), (0, 1)])
        ),
        "only a mechanism in a plane has plates": declared(
            lambda m: plate(m, "p", [(0, 0), (1, 0), (0, 1)], mass=1.0), space=True
        ),
        "'p': there is no corner 3, expected 0 to 2": declared(
            lambda m: plate(m, "p", [(0, 0), (1, 0), (0, 1)], mass=1.0).corner(3)
        ),
        "a straight bar is a link": declared(
            lambda m: bent_bar(m, "b", [(0, 0), (1, 0)], mass=1.0)
        ),
        "corners 0 and 1 coincide": declared(
            lambda m: bent_bar(m, "b", [(0, 0), (0, 0), (1, 0)], mass=1.0)
        ),
        "corner 2: expected 2 numbers": declared(
            lambda m: bent_bar(m, "b", [(0, 0), (1, 0), (1, 0, 0)], mass=1.0)
        ),
        "expected mass= or per_length=": declared(
            lambda m: bent_bar(m, "b", [(0, 0), (1, 0), (1, 1)])
        ),
        "'b_1': there is no corner -1, expected 0 to 2": declared(
            lambda m: bent_bar(m, "b", [(0, 0), (1, 0), (1, 1)], mass=1.0).corner(-1)
        ),
    }.items(),
)
def test_misuse_is_named(make, says):
    with pytest.raises(DeclarationError, match=says):
        make()


def hoist(**options):
    """A boom that a cylinder lifts."""
    m = Mechanism("hoist")
    load = m.parameter("load", 800.0, "kg")
    boom = m.link("boom", length=3.0, mass=150.0)
    m.revolute("foot", m.ground, boom)
    m.weld("grip", boom.tip, m.point_mass("weight", load))
    made = cylinder(
        m,
        "ram",
        m.ground.at(1.0, -0.2),
        boom.at(1.5, 0.1),
        closed=0.5,
        bore=0.1,
        rod=0.06,
        **options,
    )
    lifting = moves([move("60 deg", time=3.0)], start="10 deg")
    return made, Scene(m, {"foot": lifting}, t=(0, 3, 301), posture={"ram": 0.2}, drives=["ram"])


def test_a_cylinder_bears_what_virtual_work_says():
    """The force times the speed of the pins' distance is the load's power; pressures balance the
    force on both areas.
    """
    back = 4e5
    made, scene = hoist(back_pressure=back, barrel_mass=0.0, rod_mass=0.0)
    solution = evaluate(scene)
    assert solution.certified
    angle = solution.motion("foot")
    c, s = np.cos(angle.value), np.sin(angle.value)
    front = np.stack([1.5 * c - 0.1 * s - 1.0, 1.5 * s + 0.1 * c + 0.2])
    reach = np.hypot(*front)
    assert solution.motion("ram").value == pytest.approx(reach - 0.5, rel=1e-12)
    force = solution.effort("ram")
    cap, ring = math.pi / 4 * 0.1**2, math.pi / 4 * (0.1**2 - 0.06**2)
    pressures = solution.output("ram_cap_pressure"), solution.output("ram_rod_pressure")
    assert pressures[0] * cap - pressures[1] * ring == pytest.approx(force, rel=1e-12)
    assert np.minimum(*pressures) == pytest.approx(back, rel=1e-12)
    assert (made.cap_area, made.rod_area) == pytest.approx((cap, ring))
    assert solution.output("ram_flow") == pytest.approx(
        cap * solution.motion("ram").rate, rel=1e-12
    )
    assert solution.output("ram_power") == pytest.approx(
        force * solution.motion("ram").rate, rel=1e-12
    )
