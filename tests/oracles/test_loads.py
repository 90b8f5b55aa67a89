"""Loads of every kind, against vector Newton-Euler with the same loads written again."""

import math

import casadi as ca
import numpy as np
import pytest
from balance import assert_balanced, instant_at
from mechanisms import INSTANT, crank_and_rod

from lagrange_casadi import Mechanism, Scene, derive, evaluate, table
from lagrange_casadi.errors import ParameterError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.quick


def loads_on(m, parts):
    a, b, s = parts["a"], parts["b"], parts["s"]
    x, v = m.coordinate(m.joints["P"]), m.rate(m.joints["P"])
    m.force("gas", s, x=-50.0 * table(x, [0.2, 0.3, 0.4, 0.5], [5.0, 2.0, 1.0, 0.5]) - 3.0 * v)
    m.force("wind", b.at(0.2, 0.01), x=4.0 * ca.sin(7 * m.time), y=-2.0)
    m.force("follower", b.at(0.1), y=5.0, turning=True)
    m.torque("brake", b.at(0.25), 0.7, against=a.at(0.05))
    m.spring(
        "spring", m.ground.at(0.2, 0.3), b.at(0.3, -0.02), stiffness=200.0, length=0.1, damping=4.0
    )
    m.spring("strut", a.tip, s, stiffness=90.0, length=0.2)
    m.damper("dashpot", m.ground.at(0.5, 0.1), b.tip, damping=2.5)
    m.torsion_spring("coil", m.joints["A"], stiffness=1.5, angle=0.2, damping=0.05)


def loads_beside(place):
    """The same loads, written again for the oracle."""
    t = INSTANT
    sx = place(("s", 0.0, 0.0))[0]
    x, v = sx.v, sx.d
    gas = -50.0 * float(np.interp(x, [0.2, 0.3, 0.4, 0.5], [5.0, 2.0, 1.0, 0.5])) - 3.0 * v
    phi = place(("b", 0.0, 0.0))[2]
    parts = [(("s", 0.0, 0.0), gas, 0.0, 0.0), (("b", 0.2, 0.01), 4.0 * math.sin(7 * t), -2.0, 0.0)]
    parts.append((("b", 0.1, 0.0), -5.0 * math.sin(phi.v), 5.0 * math.cos(phi.v), 0.0))
    parts += [(("b", 0.25, 0.0), 0.0, 0.0, 0.7), (("a", 0.05, 0.0), 0.0, 0.0, -0.7)]
    for p, q, k, rest, c in (
        (("ground", 0.2, 0.3), ("b", 0.3, -0.02), 200.0, 0.1, 4.0),
        (("a", 0.1, 0.0), ("s", 0.0, 0.0), 90.0, 0.2, 0.0),
        (("ground", 0.5, 0.1), ("b", 0.35, 0.0), 0.0, 0.0, 2.5),
    ):
        (px, py, _), (qx, qy, _) = place(p), place(q)
        d, e = (qx - px), (qy - py)
        length = math.hypot(d.v, e.v)
        tension = k * (length - rest) + c * (d.v * d.d + e.v * e.d) / length
        fx, fy = tension * d.v / length, tension * e.v / length
        parts += [(p, fx, fy, 0.0), (q, -fx, -fy, 0.0)]
    bend = phi - place(("a", 0.0, 0.0))[2]
    couple = -1.5 * (math.remainder(bend.v, 2 * math.pi) - 0.2) - 0.05 * bend.d
    parts += [(("b", 0.0, 0.0), 0.0, 0.0, couple), (("a", 0.1, 0.0), 0.0, 0.0, -couple)]
    return parts


def test_loads_of_every_kind():
    assert_balanced(crank_and_rod({"mass": 0.5}, loads=loads_on), loads=[loads_beside])


def test_loads_are_reported():
    solution = evaluate(
        crank_and_rod({"mass": 0.5}, loads=loads_on),
        wanted=["load:wind", "load:brake", "load:strut"],
    )
    assert solution.array("load:wind:fx")[0] == pytest.approx(4.0 * math.sin(7 * INSTANT))
    assert solution.array("load:brake:mz").tolist() == [0.7, 0.7]
    assert set(solution.series) == {
        f"load:{n}:{k}" for n in ("wind", "brake", "strut") for k in ("fx", "fy", "mz")
    }


def test_a_load_outside_its_link_is_named():
    m = Mechanism("m")
    a = m.link("a", length=1, mass=1)
    m.revolute("J", m.ground, a)
    m.spring("S", m.ground.at(0, 1), a.at(-0.9), stiffness=1.0, length=0.0)
    with pytest.raises(
        ParameterError, match=r"load 'S': its point at -0\.9\d* m is outside link 'a'"
    ):
        Scene(m, {"J": polynomial(0)})


def test_instants_are_functions_of_time_where_loads_are():
    scene = crank_and_rod({"mass": 0.5}, loads=loads_on)
    program = derive(scene, ["load:wind"])
    k = program.names.index("load:wind:fx")
    assert float(instant_at(program, 0.5)[k]) == pytest.approx(4.0 * math.sin(3.5))
