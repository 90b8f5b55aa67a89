"""Plates, bent bars, cylinders and struts: closed forms, and what is refused."""

from __future__ import annotations

import math
from functools import partial

import numpy as np
import pytest
from mechanisms import crank_slider

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, evaluate
from lagrange_casadi.elements import bent_bar, cylinder, gas_spring, plate, strut
from lagrange_casadi.errors import AssemblyError, DeclarationError, ParameterError
from lagrange_casadi.motion import move, moves, polynomial

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]


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


GAS = partial(gas_spring, force=(3.0, 4.0))


def pushing(make, **given):
    """A gas spring or a strut between the ground and a link."""
    told = {"closed": 0.3, "open": 0.5} | given
    return declared(lambda m: make(m, "g", m.ground, m.link("a", length=1, mass=1).tip, **told))


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
        "gas spring 'g': open must be longer than closed, got 0.2 m and 0.3 m": pushing(
            GAS, open=0.2
        ),
        "gas spring 'g': closed must be positive, got -1 m": pushing(GAS, closed=-1),
        "gas spring 'g': expected 2 forces, open and closed, got 300.0": pushing(GAS, force=300.0),
        "'g': its force must be positive, and not fall as it closes, got 4 N open and 3": (
            pushing(GAS, force=(4.0, 3.0))
        ),
        "gas spring 'g': end_damping needs end": pushing(GAS, end_damping=10.0),
        "gas spring 'g': end must be positive, got 0 m": pushing(GAS, end=0.0),
        "gas spring 'g': exponent must be 1 or more, got 0": pushing(GAS, exponent=0.0),
        "gas spring 'g': damping must not be negative .N s/m., got -1": pushing(GAS, damping=-1.0),
        "gas spring 'g': end_damping must not be negative .N s/m., got -2": pushing(
            GAS, end_damping=-2.0
        ),
        "strut 'g': stiffness must not be negative, got -5": pushing(strut, stiffness=-5.0),
        "strut 'g': damping must not be negative, got -5": pushing(strut, damping=-5.0),
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


def hatch(space=False, **options):
    """A lid on a gas spring from (0.1, -0.3) to a point 0.4 m along it."""
    m = SpatialMechanism("hatch") if space else Mechanism("hatch")
    lid = m.link("lid", length=1.0, mass=10.0)
    m.revolute("hinge", m.ground, lid, **({"axis": (0, 0, 1)} if space else {}))
    m.set_gravity(0.0, -9.81, *([0.0] if space else []))
    long = m.parameter("long", 0.56, "m")
    ends = {"first": m.ground.at(0.1, -0.3), "second": lid.at(0.4), "closed": 0.3, "open": long}
    gas = {"force": (300.0, 420.0), "exponent": 1.2, "damping": 30.0, "end_damping": 400.0}
    gas_spring(m, "gas", **ends, **gas, end=0.1)
    strut(m, "bumper", **ends, stiffness=1e3, length=0.35, damping=20.0)
    return Scene(m, {"hinge": polynomial(0.0, 1.0)}, **{"t": (0, 0.5, 21), **options})


@pytest.mark.parametrize("space", [False, True])
def test_a_gas_spring_pushes_as_its_gas_says(space):
    """p V^n is constant, and the volume that is left falls in a straight line with the stroke."""
    solution = evaluate(hatch(space))
    assert solution.certified
    angle = solution.t
    away = np.stack([0.4 * np.cos(angle) - 0.1, 0.4 * np.sin(angle) + 0.3])
    way = np.stack([-0.4 * np.sin(angle), 0.4 * np.cos(angle)])
    reach = np.hypot(*away)
    used, rate = (reach - 0.3) / 0.26, (away * way).sum(axis=0) / reach
    assert solution.output("gas_stroke") == pytest.approx(used, rel=1e-13)
    # The volume at open, in volumes that the rod takes over the stroke.
    volume = 1.0 / (1.0 - (300.0 / 420.0) ** (1 / 1.2))
    gas = 300.0 * (volume / (volume - (1.0 - used))) ** 1.2
    slowed = 30.0 + 400.0 * np.clip((reach - 0.46) / 0.1, 0.0, 1.0)
    assert slowed.min() == 30.0 < slowed.max()
    push = gas - slowed * rate
    assert solution.array("load:gas:resultant") == pytest.approx(np.abs(push), rel=1e-12)


def lifted(law, open_=0.75, **options):
    """A lever that a cylinder moves about a pin 0.2 m beside its mount, which it passes."""
    m = Mechanism("lifted")
    m.revolute("pivot", m.ground, lever := m.link("lever", length=0.4, mass=3.0))
    cylinder(m, "ram", m.ground.at(0.5, 0), lever.tip, closed=0.3, open=open_, bore=0.05)
    return Scene(m, law, **options)


STROKES = {
    "cylinder 'ram' is longer than open at t = 2 s, where pivot = 2 rad .114.592 deg., by "
    "0.0206 of its stroke: move its mounts nearer to each other, or give it a longer stroke": (
        lambda: lifted({"pivot": polynomial(0, 1)}, t=(1, 2, 5))
    ),
    "cylinder 'ram' is shorter than closed at t = 0 s.*: move its mounts further apart": (
        lambda: lifted({"pivot": polynomial(0.2, 1)}, t=(0, 1, 5))
    ),
    "gas spring 'gas' is longer than open at t = 0.6 s": lambda: hatch(t=(0, 0.6, 7)),
    "gas spring 'gas': open must be longer than closed, got 0.2 m and 0.3 m": (
        lambda: hatch(assembly={"long": 0.2})
    ),
    "'ram' is at its longest or shortest before that, and": (
        lambda: lifted({"ram": polynomial(0.2, 0.5)}, 1.2, t=(0, 2, 8), posture={"lever": 0.5})
    ),
    "'ram' is at its longest or shortest there, and": (
        lambda: lifted({"pivot": polynomial(2.8, 1)}, 1.2, t=(0, 1, 8), drives=["ram"])
    ),
    r"dead centre at t = 0.5 s(?!.*cylinder)": lambda: Scene(
        crank_slider(lengths=(0.1, 0.3)),
        {"guide": polynomial(0.35, 0.1)},
        t=(0, 1, 9),
        posture={"crank": 1.0},
    ),
}


@pytest.mark.parametrize(("says", "make"), STROKES.items())
def test_a_stroke_ends(says, make):
    with pytest.raises((AssemblyError, ParameterError), match=says):
        evaluate(make())
