"""The order of solution, and drives that do not match the freedoms."""

import math

import pytest
from internals import assemble, solving_order, span

from lagrange_casadi import Mechanism, Scene, derive, evaluate
from lagrange_casadi.errors import MobilityError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.quick


def truss(triangles):
    """Triangles of two bars each, side by side, pinned."""
    m, posture = Mechanism("truss"), {}
    nodes = [(0.5 * k, 0.8 * (k % 2)) for k in range(triangles + 2)]
    pins = [m.ground.at(*nodes[0]), m.ground.at(*nodes[1])]
    for k in range(2, triangles + 2):
        for i in (k - 2, k - 1):
            (x, y), (u, v) = nodes[i], nodes[k]
            bar = m.link(f"b{i}_{k}", length=math.hypot(u - x, v - y), mass=0.1)
            posture[bar.name] = math.atan2(v - y, u - x) + 0.02
            m.revolute(f"p{i}_{k}", pins[i], bar)
            if len(pins) == k:
                pins.append(bar.tip)
            else:
                m.revolute(f"q{i}_{k}", pins[k], bar.tip)
    return Scene(m, {}, ["effort", "motion"], t=(0, 0, 1), posture=posture)


def blocks_of(scene):
    mechanism = scene.mechanism
    multibody = assemble(mechanism, span(mechanism, scene.motion), scene.motion, ())
    return solving_order(multibody, {"posture": {}, "inputs": [], "values": []})


def test_coupled_loops_fall_apart_into_dyads():
    """Thirty triangles: the number of ways to choose equations doubles with each."""
    scene = truss(30)
    blocks = blocks_of(scene)
    assert [len(block.unknown) for block in blocks] == [2] * 30
    assert all(block.forms for block in blocks)
    solved = set()
    for block in blocks:
        assert {c for e in block.equations for c in e.present} <= solved | set(block.unknown)
        solved |= set(block.unknown)
    assert derive(scene).newton is None


def slides(ways, drives):
    """Bodies that slide on one another, the last one on the ground."""
    m = Mechanism("slides")
    bodies = [m.link(f"w{i}", length=0.2, mass=1.0) for i in range(len(ways) - 1)]
    chain = [m.ground, *bodies]
    for i, way in enumerate(ways[:-1]):
        m.prismatic(f"S{i}", chain[i], chain[i + 1], axis=(math.cos(way), math.sin(way)))
    m.prismatic(
        "last", m.ground.at(0.1, 0.05), bodies[-1], axis=(math.cos(ways[-1]), math.sin(ways[-1]))
    )
    return Scene(m, {drive: polynomial(0.1, 0.2) for drive in drives}, t=(0, 1, 5))


@pytest.mark.parametrize(
    ("ways", "drives", "freedom"),
    [
        ((0, 0.7, 1.9), [], 1),
        ((0, 0.7, 1.9), ["S0", "S1"], 1),
        ((0, 0.7, 1.9, 2.5), ["S0"], 2),
        ((0, 0.7, 1.9, 2.5), ["S0", "S1", "S2"], 2),
    ],
)
def test_the_freedom_of_slides_is_counted_by_rank(ways, drives, freedom):
    """Their directions are held once too often: what is counted by joints is one too few."""
    with pytest.raises(
        MobilityError,
        match=rf"has {freedom} degree\(s\) of freedom \(by the rank .* and {len(drives)} drive",
    ):
        evaluate(slides(ways, drives))


def test_a_pin_driven_against_slides_is_refused():
    m = Mechanism("pin")
    a, b = m.link("a", length=0.3, mass=1.0), m.link("b", length=0.2, mass=1.0)
    m.prismatic("S", m.ground, a, axis=(1, 0))
    m.revolute("P", a.tip, b)
    m.prismatic("T", m.ground.at(0.3, 0.1), b, axis=(0, 1))
    with pytest.raises(MobilityError, match=r"has 0 degree\(s\) of freedom .* and 1 drive"):
        evaluate(Scene(m, {"P": polynomial(0.0, 1.0)}, t=(0, 1, 5)))


@pytest.mark.parametrize("way", [-2.575, -1.6435, 0.3, 3.1045])
def test_two_guides_of_an_inclined_line_leave_a_freedom(way):
    """The second guide's slopes are rounding alone, and of no rank."""
    m = Mechanism("guided")
    bar = m.link("bar", length=0.8, mass=1.0)
    along = 1.8321
    m.prismatic("first", m.ground, bar, axis=(math.cos(along), math.sin(along)), angle=way)
    back = along - way
    m.prismatic("second", bar, m.ground, axis=(3 * math.cos(back), 3 * math.sin(back)), angle=-way)
    solution = evaluate(Scene(m, {"first": polynomial(0.1, 0.2)}, t=(0, 1, 3)), backend="vm")
    assert solution.motion("second").value == pytest.approx([-0.1, -0.2, -0.3])
    assert "effort:first" not in solution.undetermined
