"""Estimates of errors where outputs jump: at stations, by loads that switch, and where a spring
nearly vanishes.
"""

import math

import casadi as ca
import pytest
from arithmetic import ROUNDING
from estimates import COUNT, METHODS, assert_near, ratios
from mechanisms import links_of, pins_of
from truth import truth

from lagrange_casadi import Mechanism, Scene, evaluate, table
from lagrange_casadi.motion import harmonic, polynomial


def cantilever(place, length=0.6, load=1e5):
    """A large load on a driven link, at a place that is an expression of its length."""
    m = Mechanism("cantilever")
    l = m.parameter("l", length, "m")
    link = m.link("link", length=l, mass=1.0)
    m.revolute("O", m.ground, link)
    m.force("load", link.at(place(l)), y=-load)
    return Scene(m, {"O": polynomial(0.3, 1.0)}, t=(0.0, 1.0, COUNT))


STATIONS = {
    "half": (lambda l: 0.3 * l / 0.6, 0.5),
    "a quarter": (lambda l: l * 0.1 + l * 0.2 - 0.05 * l, 0.25),
    "base": (lambda l: l - 0.6, 0.0),
    "tip": (lambda l: 3 * (l / 3), 1.0),
    "tip, by a root": (lambda l: ca.sqrt(l) ** 2, 1.0),
    "anywhere": (lambda l: 0.437 * l, 0.437),
}


@pytest.mark.sampled(9)
@pytest.mark.parametrize("station", STATIONS)
@pytest.mark.parametrize("method", ["lanes", "single"])
def test_a_station_on_a_ratio_that_is_looked_at(station, method):
    """A force jumps there; where rounding puts the station is no error of it."""
    place, ratio = STATIONS[station]
    scene = cantilever(place)
    solution = evaluate(scene, **METHODS[method])
    assert_near(ratios(solution, truth(scene, solution.t)))
    (load,) = solution.section("link").law.loads
    assert load.station == pytest.approx(ratio, abs=1e-6)
    unit = ROUNDING[solution.provenance.precision]
    for force in ("axial", "shear"):
        # What acts at the base no section feels.
        assert (abs(solution.peak(f"section:link:{force}").value) > 9e4) == (ratio > 0.0)
        assert solution.errors[f"section:link:{force}"] < unit * 1e6
        assert ratio == 0.0 or solution.errors[f"section:link:{force}"] > unit * 1e4


def friction(load):
    """A crank under a torque that depends on time, angle and rate, the last zero at instants, and a
    slider pushed likewise.
    """
    m = Mechanism("friction")
    crank, rod = links_of(m, crank=(0.1, 1.0), rod=(0.3, 1.0))
    slider = m.point_mass("slider", 1.0)
    main, *_ = pins_of(m, O=(m.ground, crank), A=(crank.tip, rod), B=(rod.tip, slider))
    guide = m.prismatic("guide", m.ground, slider, axis=(1, 0))
    m.torque("torque", crank, load(m.time, m.coordinate(main), m.rate(main)))
    m.force("force", slider, x=load(m.time, m.coordinate(guide), m.rate(guide)))
    return Scene(
        m, {"O": harmonic(0.0, math.pi, 1.0, 0.1)}, posture={"rod": 0.0}, t=(0.0, 1.0, COUNT)
    )


JUMPS = {
    "sign of a rate": lambda t, q, w: -1e6 * ca.sign(w),
    "one way": lambda t, q, w: -1e6 * (w > 0),
    "from a place on": lambda t, q, w: ca.if_else(q > 0.31, 1e6, -3e5),
    "from a time on": lambda t, q, w: 1e6 * (t >= 0.3),
    "a stair": lambda t, q, w: 1e5 * ca.floor(t / 0.07),
    "a saw": lambda t, q, w: 1e6 * ca.fmod(t, 0.07),
    "a table with a step": lambda t, q, w: table(
        t, [0.0, 0.3, 0.3 + 1e-9, 1.0], [1.0, 1.0, 1e6, 1e6]
    ),
    "a remainder": lambda t, q, w: 1e6 * ca.remainder(q, 0.1),
    "a direction at half a turn": lambda t, q, w: 1e5 * ca.atan2(ca.sin(10 * q), ca.cos(10 * q)),
    "a sign copied": lambda t, q, w: ca.copysign(1e6, w),
    "several": lambda t, q, w: -1e6 * ca.sign(w) + 3e5 * (q > 0.31) - 1e5 * (t >= 0.3),
}


@pytest.mark.sampled(13)
@pytest.mark.parametrize("jump", JUMPS)
@pytest.mark.parametrize("method", ["lanes", "c", "single"])
def test_a_load_that_jumps(jump, method):
    """Either side of a jump by itself, the one that the result took."""
    if (jump, method) == ("a table with a step", "single"):
        pytest.skip("a step narrower than singles are apart is steep, but no jump")
    scene = friction(JUMPS[jump])
    solution = evaluate(scene, **METHODS[method])
    assert_near(ratios(solution, truth(scene, solution.t)))
    unit = ROUNDING[solution.provenance.precision]
    assert solution.errors["load:force:fx"] < 1e3 * unit * 1e6
