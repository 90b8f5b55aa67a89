"""Forces that equilibrium leaves open, by least strain energy: against a frame solver, closed forms
and published ones.
"""

import math

import frames
import numpy as np
import pytest
from elastic_mechanisms import (
    LIGHT,
    STEEL,
    agrees,
    held,
    made,
    moving,
    sections_of,
    three_cranks,
)
from hypothesis import given, reject, settings
from hypothesis import strategies as st

from lagrange_casadi import (
    Mechanism,
    Scene,
    SpatialMechanism,
    beams,
    evaluate,
)
from lagrange_casadi.errors import AssemblyError, MobilityError, PostureError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("interpreted")


def test_a_beam_held_at_both_ends():
    """Timoshenko, Strength of Materials I, with the shear of Timoshenko's beam: by the force
    method, by hand.
    """
    solution = evaluate(held(x=500.0, y=-1000.0))
    p, e, g = beams.rectangle(0.05, 0.02).properties(), STEEL.elasticity, STEEL.shear_modulus
    a, l, push = 0.6, 2.0, 1000.0
    # The tip released: its sag and slope under the load, and under a unit force and couple there.
    ei, ga = e * p.iz, g * p.shear_y
    flexible = np.array([[l**3 / (3 * ei) + l / ga, l**2 / (2 * ei)], [l**2 / (2 * ei), l / ei]])
    sagged = -push * np.array(
        [a**3 / (3 * ei) + a**2 / (2 * ei) * (l - a) + a / ga, a**2 / (2 * ei)]
    )
    force, couple = np.linalg.solve(flexible, -sagged)
    assert solution.reaction("B").fy[0] == pytest.approx(force, rel=1e-10)
    assert solution.reaction("B").mz[0] == pytest.approx(couple, rel=1e-10)
    assert solution.reaction("A").fx[0] == pytest.approx(-500.0 * (l - a) / l, rel=1e-12)
    # Without shear, as books have it: P b^2 (3a + b)/l^3.
    assert solution.reaction("A").fy[0] == pytest.approx(
        push * 1.4**2 * (3 * 0.6 + 1.4) / 8, rel=1e-3
    )
    assert solution.certified
    assert not solution.undetermined
    assert solution.certificate["elasticity"].max() < 1e-12
    assert set(map(str, solution.elasticity.completed)) >= {"reaction:A:fy", "section:bar:law:m0"}


def test_a_bar_on_three_supports():
    """Two equal spans under their weight: 3/8, 10/8 and 3/8 of a span's weight (Timoshenko,
    Strength of Materials I).
    """
    m = Mechanism("spans")
    shape = beams.rectangle(0.02, 0.02)
    bar = m.link("bar", length=2.0, beam=made(shape))
    m.revolute("A", m.ground, bar)
    for name, x in (("B", 1.0), ("C", 2.0)):
        foot = m.point_mass(f"foot{name}", 0.0)
        m.prismatic(f"slide{name}", m.ground.at(x, 0), foot, axis=(1, 0))
        m.revolute(name, foot, bar.at(x))
    solution = evaluate(Scene(m, {}, t=(0, 0, 1), posture={"bar": 0.0}, elastic=True))
    span, p = 4e-4 * STEEL.density * 9.81, shape.properties()
    ei, ga = STEEL.elasticity * p.iz, STEEL.shear_modulus * p.shear_y
    # Of the bar on its ends alone: the sag of its middle by its weight, over that by a unit force
    # there.
    middle = (5 * 2.0**4 / (384 * ei) + 2.0**2 / (8 * ga)) / (2.0**3 / (48 * ei) + 2.0 / (4 * ga))
    found = [solution.reaction(name).fy[0] / span for name in "ABC"]
    assert found == pytest.approx([(2 - middle) / 2, middle, (2 - middle) / 2], rel=1e-9)
    assert found == pytest.approx([0.375, 1.25, 0.375], rel=1e-3)


def truss(angle):
    m = Mechanism("truss")
    node, height = m.point_mass("node", 0.0), 1.0
    for k, x in enumerate((-height * math.tan(angle), 0.0, height * math.tan(angle))):
        bar = m.link(
            f"bar{k}", length=math.hypot(x, height), beam=made(beams.round_bar(0.02), LIGHT)
        )
        m.revolute(f"G{k}", m.ground.at(x, 0), bar)
        m.revolute(f"N{k}", bar.tip, node)
    m.force("P", node, y=-1000.0)
    posture = {f"bar{k}": -math.pi / 2 + (1 - k) * angle for k in range(3)}
    return Scene(m, {}, t=(0, 0, 1), xi=(0, 1, 5), posture=posture, elastic=True)


def test_three_bars_that_meet():
    """P/(1 + 2 cos^3 a) in the upright bar, cos^2 a of it in the others (Timoshenko, Strength of
    Materials I).
    """
    angle = math.radians(35)
    solution = evaluate(truss(angle))
    upright = 1000.0 / (1 + 2 * math.cos(angle) ** 3)
    found = [solution.section(f"bar{k}").axial[0, 0] for k in range(3)]
    assert found == pytest.approx(
        [upright * math.cos(angle) ** 2, upright, upright * math.cos(angle) ** 2], rel=1e-7
    )


def portal(mass=None):
    m = Mechanism("portal")
    beam = {"mass": mass} if mass else {"beam": made(beams.i_section(0.1, 0.055, 0.0041, 0.0057))}
    left = m.link("left", length=3.0, beam=made(beams.rectangle(0.1, 0.06)))
    top = m.link("top", length=4.0, **beam)
    right = m.link("right", length=2.5, beam=made(beams.round_bar(0.08)))
    m.weld("A", m.ground, left, angle=math.pi / 2)
    m.weld("B", left.tip, top, angle=-math.pi / 2)
    m.weld("C", top.tip, right, angle=-math.pi / 2)
    m.weld("D", m.ground.at(4.0, 0.5), right.tip, angle=-math.pi / 2)
    m.force("wind", left.at(1.2), x=2e3)
    m.force("load", top.at(1.5), y=-5e3)
    return m


def test_a_portal_frame_is_that_of_a_frame_solver():
    m = portal()
    solution = evaluate(Scene(m, {}, t=(0, 0, 1), elastic=True))
    sections = sections_of(**{name: link.beam for name, link in m.links.items()})
    loads = [("left", 1.2, (2e3, 0, 0), (0, 0, 0)), ("top", 1.5, (0, -5e3, 0), (0, 0, 0))]
    reactions, _ = frames.of_solution(solution, 0, sections, loads)
    agrees(solution, 0, reactions)
    assert len(solution.elasticity.completed) == 21


def test_a_planar_four_bar_of_spatial_pins_that_moves():
    """Its inertia by differences of its poses; every component of every reaction is a frame's."""
    m, solution = moving()
    i, h = 4, solution.t[1]
    stencil = (
        np.array([-1 / 560, 8 / 315, -1 / 5, 8 / 5, -205 / 72, 8 / 5, -1 / 5, 8 / 315, -1 / 560])
        / h**2
    )

    def accelerations(link, x):
        pose = solution.pose(link)
        return stencil @ (np.stack([pose.x, pose.y, pose.z], axis=1) + x * pose.axes[:, 0])

    sections = sections_of(**{name: link.beam for name, link in m.links.items()})
    reactions, _ = frames.of_solution(
        solution, i, sections, [("b", 0.15, (20.0, 0, 100.0), (0, 0, 0))], accelerations
    )
    agrees(solution, i, reactions, 1e-6)
    assert solution.certified
    assert not solution.undetermined


KINDS = ["weld", "weld", "revolute"]
LINKS = st.lists(
    st.tuples(st.floats(0.3, 1.5), st.floats(-1.2, 1.2), st.sampled_from(KINDS)),
    min_size=1,
    max_size=4,
)
FORCES = st.lists(
    st.tuples(st.floats(0.1, 0.9), st.floats(-1e3, 1e3), st.floats(-1e3, 1e3)),
    min_size=1,
    max_size=2,
)
SHAPES = [
    beams.rectangle(0.05, 0.02),
    beams.tube(0.05, 0.004),
    beams.i_section(0.08, 0.04, 0.004, 0.006),
    beams.round_bar(0.03),
]


@settings(max_examples=4)
@given(LINKS, st.sampled_from(["weld", "revolute"]), FORCES, st.integers(0, 3), st.booleans())
def test_any_chain_between_two_walls(parts, last, forces, odd, space):
    """Links end to end, welded or pinned, bent any way, of any cross-section, loaded anywhere: all
    reactions are a frame's.
    """
    m = (SpatialMechanism if space else Mechanism)("chain")
    near = None
    at = np.zeros(2)
    before = 0.0
    loads = []
    posture = {}
    pins = 0
    axis = {"axis": (0, 0, 1)} if space else {}

    def weld(name, place, child, turn):
        m.weld(name, place, child, **({"turned": [("z", turn)]} if space else {"angle": turn}))

    for k, (length, direction, kind) in enumerate(parts):
        link = m.link(f"l{k}", length=length, beam=made(SHAPES[(k + odd) % 4]))
        place = m.ground if near is None else near.tip
        # With more pins it would move, or be on the verge of it.
        if kind == "revolute" and pins < 2:
            pins += 1
            m.revolute(f"J{k}", place, link, **axis)
        else:
            weld(f"J{k}", place, link, direction - before)
        posture[f"J{k}" if space else f"l{k}"] = direction - before if space else direction
        near, before = link, direction
        at = at + length * np.array([math.cos(direction), math.sin(direction)])
        if k < len(forces):
            share, x, y = forces[k]
            aside = {"z": x / 2} if space else {}
            m.force(f"F{k}", link.at(share * length), x=x, y=y, **aside)
            loads.append((f"l{k}", share * length, (x, y, aside.get("z", 0.0)), (0, 0, 0)))
    end = m.ground.at(*map(float, at), *([0.0] if space else []))
    if last == "weld":
        weld("end", end, near.tip, before)
    else:
        m.revolute("end", end, near.tip, **axis)
        posture |= {"end": before} if space else {}
    posture = {name: rough for name, rough in posture.items() if not space or name in m.coordinates}
    try:
        solution = evaluate(Scene(m, {}, t=(0, 0, 1), posture=posture, elastic=True))
    except (AssemblyError, PostureError, MobilityError):
        reject()  # pins on one line, or nearly
    assert not solution.undetermined
    sections = sections_of(**{name: link.beam for name, link in m.links.items()})
    agrees(solution, 0, frames.of_solution(solution, 0, sections, loads)[0], 1e-6)


def test_two_hinges_of_one_door():
    """Alike hinges at both ends of a post, alike beyond them, share thrust and moments alike."""
    m = SpatialMechanism("door")
    post, upper, lower = (
        m.link(name, length=l, beam=made(beams.round_bar(0.03)))
        for name, l in (("p", 2), ("u", 1), ("l", 1))
    )
    up = [("y", "-90 deg")]
    m.revolute("H1", m.ground, post, axis=(0, 0, 1), turned=up)
    m.revolute("H2", m.ground.at(0, 0, 2), post.tip, axis=(0, 0, 1), turned=up)
    for name, x, arm in (("W1", 0.5, lower), ("W2", 1.5, upper)):
        m.weld(name, post.at(x), arm, turned=[("y", "90 deg")])
        m.force(f"F{name}", arm.tip, x=3.0, y=-2.0, z=-100.0)
    solution = evaluate(Scene(m, {"H1": polynomial(0.4)}, t=(0, 0, 1), elastic=True))
    first, second = solution.reaction("H1"), solution.reaction("H2")
    assert not solution.undetermined
    assert first.fz[0] == pytest.approx(second.fz[0], rel=1e-8)
    sections = sections_of(**{name: link.beam for name, link in m.links.items()})
    loads = [(name, 1.0, (3.0, -2.0, -100.0), (0, 0, 0)) for name in "ul"]
    agrees(solution, 0, frames.of_solution(solution, 0, sections, loads)[0])


def test_bricards_loop():
    """Six bars on six pins at right angles, one equation too many, at rest in a posture: all
    reactions are a frame's.
    """
    m, start, length = SpatialMechanism("bricard"), 1.3, 0.5
    shapes = [beams.rectangle(0.03, 0.01 + 0.002 * k) for k in range(5)]
    links = [m.link(f"link{k}", length=length, beam=made(shape)) for k, shape in enumerate(shapes)]
    m.revolute("J0", m.ground, links[0], axis=(0, 0, 1))
    for k in range(1, 5):
        right = 1 if k % 2 else -1
        m.revolute(
            f"J{k}",
            links[k - 1].tip,
            links[k],
            axis=(0, -right, 0),
            turned=[("x", f"{90 * right} deg")],
        )
    m.revolute("J5", m.ground.at(-length, 0, 0), links[4].tip, axis=(0, -1, 0))
    other = math.acos(-math.cos(start) / (1 + math.cos(start)))
    posture = {"J1": other, "J2": start, "J3": other, "J4": start, "J5": -other}
    solution = evaluate(
        Scene(m, {"J0": polynomial(start)}, posture=posture, t=(0, 0, 1), elastic=True)
    )
    assert not solution.undetermined
    assert solution.certified
    sections = sections_of(**{name: link.beam for name, link in m.links.items()})
    agrees(solution, 0, frames.of_solution(solution, 0, sections)[0], 1e-7)


def test_a_symmetric_machine_has_symmetric_forces():
    """Upright cranks, driven by their middle one's neighbour: what the outer ones bear upward is
    alike.
    """
    scene = three_cranks(made(beams.round_bar(0.01)), made(beams.rectangle(0.02, 0.01)))
    upright = Scene(
        scene.mechanism,
        {"G0": polynomial(math.pi / 2)},
        posture=scene.posture,
        t=(0, 0, 1),
        elastic=True,
    )
    solution = evaluate(upright)
    left, middle, right = (solution.reaction(f"B{k}").fy[0] for k in range(3))
    assert left == pytest.approx(right, rel=1e-8)
    assert middle != pytest.approx(left, rel=1e-2)


def test_a_link_without_a_beam_leaves_open_what_goes_through_it_and_is_named():
    scene = three_cranks(made(beams.round_bar(0.01)))
    solution, plain = evaluate(scene), evaluate(scene, elastic=False)
    assert set(solution.undetermined) == set(plain.undetermined)
    assert np.isnan(solution.reaction("B1").fx).all()
    assert solution.elasticity.reasons == ("they go through 'bar', which has no beam",)
    assert (
        "elasticity does not determine some forces: they go through 'bar', which has no beam"
        in solution.notes
    )
    assert solution.certified


def test_links_that_are_named_give_way_and_others_are_rigid():
    """A rigid bar on three equal elastic struts, its weight in its middle: a third each."""
    scene = three_cranks(made(beams.round_bar(0.01), LIGHT), elastic=["a", "b", "c"])
    upright = Scene(
        scene.mechanism,
        {"G0": polynomial(math.pi / 2)},
        posture=scene.posture,
        t=(0, 0, 1),
        elastic=scene.elastic,
    )
    solution = evaluate(upright)
    assert not solution.undetermined
    assert [solution.reaction(f"B{k}").fy[0] for k in range(3)] == pytest.approx(
        [9.81 / 3] * 3, rel=1e-6
    )


def test_two_parts_are_told_apart():
    """A fixed beam with a cross-section beside one without: the first is
    told, the second is open.
    """
    m = Mechanism("two")
    for k, made_of in enumerate(({"beam": made(beams.rectangle(0.05, 0.02))}, {"mass": 3.0})):
        bar = m.link(f"bar{k}", length=2.0, **made_of)
        m.weld(f"A{k}", m.ground.at(0, k), bar)
        m.weld(f"B{k}", m.ground.at(2.0, k), bar.tip)
    solution = evaluate(Scene(m, {}, t=(0, 0, 1), elastic=True))
    assert solution.determined("reaction:A0:mz")
    assert {name.split(":")[1] for name in solution.undetermined} == {"A1", "B1", "bar1"}
    weight = 2.0 * 0.05 * 0.02 * STEEL.density * 9.81
    assert solution.reaction("A0").mz[0] == pytest.approx(weight * 2.0 / 12, rel=1e-9)


def test_what_bends_no_link_stays_open():
    """Two gears between the same wheels share their couple however stiff the wheels are."""
    m = Mechanism("wheels")
    a, b = (m.link(name, length=0.2, beam=made(beams.round_bar(0.02))) for name in "ab")
    joints = m.revolute("A", m.ground, a), m.revolute("B", m.ground.at(1, 0), b)
    for name in ("left", "right"):
        m.gear(name, *joints, ratio=-2.0)
    solution = evaluate(
        Scene(m, {"A": polynomial(0.1, 2.0)}, posture={"b": -0.2}, t=(0, 1, 5), elastic=True)
    )
    assert set(solution.undetermined) == {"multiplier:left", "multiplier:right"}
    assert solution.elasticity.reasons == ("some do not deform any link",)
    assert solution.certified


def test_a_tapered_beam_by_fine_sums():
    """A beam held at both ends that tapers to a third: the force method with sums over a million
    places.
    """
    m = Mechanism("tapered")
    bar = m.link(
        "bar",
        length=2.0,
        beam=made(beams.tapered(beams.rectangle(0.06, 0.02), beams.rectangle(0.02, 0.02))),
    )
    m.weld("A", m.ground, bar)
    m.weld("B", m.ground.at(2.0, 0), bar.tip)
    solution = evaluate(Scene(m, {}, t=(0, 0, 1), xi=(0, 1, 5), elastic=True))
    n = 400_000
    s = (np.arange(n) + 0.5) * (2.0 / n)
    h = 0.06 - 0.02 * s
    i, area, line = 0.02 * h**3 / 12, 0.02 * h, 0.02 * h * STEEL.density * 9.81
    beyond = np.cumsum(line[::-1])[::-1] * (2.0 / n) - line * (1.0 / n)
    moment = -(np.cumsum((beyond)[::-1])[::-1] * (2.0 / n) - beyond * (1.0 / n))
    stiff = 10 * 1.3 / (12 + 11 * 0.3)
    e, g = STEEL.elasticity, STEEL.shear_modulus
    bend, sheared = np.array([2.0 - s, np.ones(n)]), np.array([np.ones(n), np.zeros(n)])
    flexible = (bend / (e * i)) @ bend.T + (sheared / (g * stiff * area)) @ sheared.T
    rest = (bend / (e * i)) @ moment + (sheared / (g * stiff * area)) @ -beyond
    force, couple = np.linalg.solve(flexible, -rest)
    assert solution.reaction("B").fy[0] == pytest.approx(force, rel=1e-8)
    assert solution.reaction("B").mz[0] == pytest.approx(couple, rel=1e-8)
    assert solution.certificate["elasticity"].max() < 1e-12
