"""Drawings: what is declared is drawn, whether it closes or not, with numbers by hand; parts are
where closed forms put them.
"""

import itertools
import math
import re
import xml.etree.ElementTree as ElementTree

import casadi as ca
import numpy as np
import pytest
from mechanisms import pins_of
from PIL import Image

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, load_case
from lagrange_casadi.elements import belt, cylinder, cylindrical_cam, gas_spring, gears, wheel
from lagrange_casadi.errors import DeclarationError
from lagrange_casadi.motion import polynomial

SVG = "{http://www.w3.org/2000/svg}"


def four_bar(ground=0.3):
    """Links without a mass, as they are first declared."""
    m = Mechanism("first")
    crank, coupler, rocker = (
        m.link(name, length=l) for name, l in (("crank", 0.1), ("coupler", 0.3), ("rocker", 0.1))
    )
    ends = {"O": (m.ground, crank), "A": (crank.tip, coupler), "B": (coupler.tip, rocker.tip)}
    pins_of(m, **ends, C=(m.ground.at(ground, 0.0), rocker))
    return m


def texts(drawing):
    return [one.text for one in ElementTree.fromstring(drawing.svg).iter(f"{SVG}text")]


def curves(drawing):
    """The points of all polygons and polylines."""
    root = ElementTree.fromstring(drawing.svg)
    return [
        np.array([[*map(float, pair.split(","))] for pair in one.get("points").split()])
        for one in root.iter()
        if one.get("points")
    ]


def length(points):
    return float(np.sum(np.hypot(*np.diff(points, axis=0, append=points[:1]).T)))


def test_what_is_declared_first_is_drawn(here):
    drawing = four_bar().draw("first.svg")
    assert not drawing.gaps
    assert {"O", "A", "B", "C", "crank", "coupler", "rocker"} == set(texts(drawing))
    assert re.sub("<rect[^>]*>\n", "", (here / "first.svg").read_text()).count("\n") > 20
    assert drawing._repr_html_() == drawing.svg == four_bar()._repr_html_()
    assert Mechanism("none").draw().svg.count("<g ") == 1  # the ground
    for kind in (Mechanism, SpatialMechanism):
        loose = kind("loose")
        loose.link("a", length=0.3)
        loose.point_mass("b", 1.0)
        assert texts(loose.draw())[:2] == ["a", "b"]


def test_a_loop_that_does_not_close_has_its_gap(here):
    """Stretched, the links reach 0.5 of 2 m: the gap is 1.5 m."""
    drawing = four_bar(2.0).draw("open.png")
    (gap,) = drawing.gaps
    assert "2 m apart; with these lengths they reach 0.1 to 0.5 m" in gap
    assert gap in " ".join(texts(drawing))
    assert "1.5 m" in texts(drawing)
    with Image.open(here / "open.png") as picture:
        assert picture.size[0] == 1440
    with pytest.raises(DeclarationError, match=r"open\.gif: expected a name that ends in \.svg"):
        four_bar().draw("open.gif")


def test_loads_have_their_expressions():
    m = Mechanism("pushed")
    k, arm = m.parameter("k", 100.0, "N/m"), m.link("arm", length=0.4, mass=1.0)
    joint = m.revolute("O", m.ground, arm)
    m.force("push", arm.tip, x=-100 * ca.sin(m.time), y=-k / 3)
    m.torsion_spring("coil", joint, stiffness=3.0, angle=1.0)
    m.line_load("wind", arm, y=(-20, -60))
    m.spring("pull", m.ground.at(0.0, 1.0), arm.tip, stiffness=k, length=0.1, damping=2.0)
    m.torque("long", arm, sum(ca.sin(n * k * m.coordinate(joint)) for n in range(1, 5)))
    scene = Scene(m, {"O": polynomial(0.3, 1.0)}, t=(0, 1, 3))
    drawn = set(texts(scene.draw(t="500 ms", parameters={"k": 50.0})))
    assert drawn >= {
        "push: x = -100*sin(t), y = -(k/3) N",
        "coil: z = -(3*(O-1)) N m",
        "wind: 20 to 60 N/m",
        "pull: k N/m, 2 N s/m",
        "long: z = f(k, O) N m",
    }


@pytest.mark.parametrize("crossed", [False, True])
def test_a_belt_is_as_long_as_its_closed_form(crossed):
    """Two strands sqrt(d^2 - (r1 -+ r2)^2), and the arcs about both pulleys."""
    m, one, two, apart = Mechanism("belts"), 0.05, 0.12, 0.4
    wheels = [wheel(m, name, radius=r, mass=1.0) for name, r in (("a", one), ("b", two))]
    m.revolute("A", m.ground, wheels[0])
    m.revolute("B", m.ground.at(apart, 0.0), wheels[1])
    belt(m, "belt", *wheels, radii=(one, two), crossed=crossed)
    reach = one + two if crossed else one - two
    angle = math.acos(reach / apart)
    arcs = (
        (one + two) * 2 * (math.pi - angle)
        if crossed
        else 2 * (one * (math.pi - angle) + two * angle)
    )
    expected = 2 * math.sqrt(apart**2 - reach**2) + arcs
    found = curves(m.draw())
    scale = max(length(points) for points in found if len(points) == 48) / (2 * math.pi * two)
    (belts,) = (points for points in found if len(points) == 62)
    assert length(belts) / scale == pytest.approx(expected, rel=3e-3)


def test_parts_of_machines_are_drawn():
    """A rack through the pitch point, a cylinder as thick as its bore, a gas spring with its
    barrel, a drum with its roller.
    """
    m = Mechanism("parts")
    pinion, bar = wheel(m, "pinion", radius=0.05, mass=1.0), m.link("bar", length=0.4, mass=1.0)
    m.revolute("A", m.ground.at(0.0, 0.05), pinion)
    m.prismatic("slide", m.ground, bar.at(0.2), axis=(1, 0))
    gears(m, "mesh", pinion, bar.at(0.2), radii=(0.05,))
    cylinder(m, "jack", m.ground.at(0.0, 0.4), bar.tip, closed=0.2, bore=0.08, rod=0.04)
    gas_spring(m, "gas", m.ground.at(0, 1), bar.tip, closed=0.3, open=0.5, force=(9.0, 11.0))
    found = curves(m.draw())
    scale = max(length(points) for points in found if len(points) == 48) / (2 * math.pi * 0.05)
    boxes = [length(points) / scale for points in found if len(points) == 4]
    assert min(abs(np.array(boxes) - 2 * (0.85 * 0.2 + 0.08))) < 2e-3
    assert any(len(points) == 4 * 9 + 3 for points in found)  # nine teeth, and the back
    (barrel,) = (points for points in found if len(points) == 7)
    assert np.linalg.norm(barrel[3] - barrel[2]) / scale == pytest.approx(0.89 * 0.3, abs=2e-3)
    s = SpatialMechanism("drum")
    drum, follower = s.link("drum", length=0.2, mass=1.0), s.link("arm", length=0.1, mass=1.0)
    shaft = s.revolute("shaft", s.ground, drum, axis=(1, 0, 0))
    way = s.prismatic("way", s.ground.at(0.07, 0.0, 0.05), follower, axis=(1, 0, 0))
    cylindrical_cam(s, "cam", shaft, way, lambda x: 0.03 * (1 - ca.cos(x)), roller=0.008)
    found = curves(s.draw())
    assert sum(len(points) == 120 for points in found) == 2  # the flanks
    assert sum(len(points) == 48 for points in found) == 3  # the ends and the roller


def test_a_geneva_wheel_has_seats_for_the_arc_and_slots_for_the_pin():
    """The arc is about the crank's axis; in the middle of a slot its end is about the pin."""
    scene = load_case("geneva").scene
    for angle, size, touching in ((-3.0, 26, 25), (0.0, 48, 9)):
        by_size = {len(points): points for points in curves(scene.draw(t=(angle + 3.0) / math.tau))}
        wheel, round_part = by_size[6 * 36], by_size[size]
        middle = round_part[0] if size == 26 else np.mean(round_part, axis=0)
        radius = np.linalg.norm(round_part[1] - middle)
        near = np.sort(np.linalg.norm(wheel - middle, axis=1))[:touching]
        assert near == pytest.approx(np.full(touching, radius), abs=0.3)


def test_no_rod_is_behind_its_barrel_where_nothing_is_driven():
    found = curves(load_case("toggle_clamp").scene.mechanism.draw())
    _, barrel, head, *_ = (points for points in found if len(points) == 4)  # a dashpot's cup first
    along = barrel[1] - barrel[0]
    shares = (head - barrel[0]) @ along / (along @ along)
    assert 0.0 < shares.min() < shares.max() < 1.0


@pytest.mark.sampled(6)
@pytest.mark.parametrize(
    "case", ["delta", "excavator", "quick_return", "roller_cam", "sleigh", "v6"]
)
def test_drawings_of_cases_stay_on_their_sheets(case):
    """All names are there, none lies on another, and nothing is beside the sheet."""
    scene = load_case(case).scene
    drawing, described = scene.draw(), scene.mechanism
    assert not drawing.gaps
    assert set(described.links) <= set(", ".join(texts(drawing)).split(", "))
    wide, high = (float(x) for x in re.search(r'viewBox="0 0 (\d+) (\d+)"', drawing.svg).groups())
    for points in curves(drawing):
        assert points.min() >= -30.0
        assert (points.max(axis=0) <= [wide + 30.0, high + 30.0]).all()
    places = [
        (*map(float, re.findall(r"[\d.]+", one.get("transform"))), 0.6 * 13.0 * len(one.text))
        for one in ElementTree.fromstring(drawing.svg).iter(f"{SVG}text")
    ]
    for (x, y, width), (x2, y2, width2) in itertools.combinations(places, 2):
        assert abs(y2 - y) > 13.0 or x2 > x + width or x > x2 + width2
    assert drawing.svg in scene._repr_html_()
