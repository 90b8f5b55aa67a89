"""Gears that mesh in a plane: closed forms, trains against vector equilibrium,
and what is refused.
"""

import math
import random

import numpy as np
import pytest
from five_bars import geared_five_bar
from hypothesis import given, settings
from hypothesis import strategies as st

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, evaluate
from lagrange_casadi.elements import gears, wheel
from lagrange_casadi.errors import DeclarationError, ParameterError
from lagrange_casadi.motion import harmonic, polynomial

pytestmark = pytest.mark.usefixtures("interpreted")


def pair(inside=False, turn=0.7, **told):
    """Two gears on the ground, the second one loaded; the line of their centres is turned."""
    m = Mechanism("pair")
    m.set_gravity(0, 0)
    z = m.parameter("z", 40.0)
    load_ = m.parameter("load", 60.0, "N m")
    r1, r2 = 0.03, 0.0015 * z
    apart = r2 - r1 if inside else r1 + r2
    first = wheel(m, "first", radius=r1, mass=0.8)
    second = wheel(m, "second", radius=r2, mass=2.0)
    m.revolute("A", m.ground.at(0.1, -0.05), first)
    m.revolute(
        "B", m.ground.at(0.1 + apart * math.cos(turn), -0.05 + apart * math.sin(turn)), second
    )
    mesh = gears(m, "mesh", first, second, teeth=(20, z), module=0.003, **told)
    m.torque("load", second, load_)
    return m, mesh


@pytest.mark.parametrize("inside", [False, True])
@pytest.mark.parametrize("moment", [60.0, -25.0])
@pytest.mark.parametrize("teeth", [40.0, 51.0])
def test_a_pair_bears_the_force_of_its_teeth(inside, moment, teeth):
    """Shigley, equation 13-35: the tangential force is the torque over the radius, the radial one
    its size times tan(20 deg), for either flank. The load torque is held at rest, in both
    directions."""
    m, _ = pair(inside)
    scene = Scene(m, {"A": polynomial(0.2)}, t=(0, 1, 2))
    solution = evaluate(scene, parameters={"load": moment, "z": teeth})
    assert solution.certified
    r2, e = 0.0015 * teeth, np.exp(0.7j)
    tangential = -moment / r2  # at the pitch point, on the second gear, about its axis
    outward = -e
    force = 1j * outward * tangential
    push = outward * abs(tangential) * math.tan(math.radians(20.0)) * (1.0 if inside else -1.0)
    on_second = force + push
    reaction = solution.reaction("B")
    assert reaction.fx[0] + 1j * reaction.fy[0] == pytest.approx(
        -on_second, abs=1e-12 * abs(tangential)
    )
    reaction = solution.reaction("A")
    assert reaction.fx[0] + 1j * reaction.fy[0] == pytest.approx(
        on_second, abs=1e-12 * abs(tangential)
    )
    assert abs(solution.effort("A")[0]) == pytest.approx(abs(moment) * 0.03 / r2, rel=1e-13)
    assert solution.output("mesh_radial")[0] == pytest.approx(
        abs(tangential) * math.tan(math.radians(20.0)), rel=1e-13
    )
    assert abs(solution.multiplier("mesh")[0]) == pytest.approx(abs(tangential), rel=1e-13)


def train(draw):
    """A train on an arm that turns: a sun on the arm's axis, and gears on the arm, each of which
    meshes with the one before it.

    Bodies have their masses beside their axes, and bear forces. Numbers are drawn by ``draw(low,
    high)``.
    """
    m = Mechanism("train")
    m.set_gravity(draw(-5, 5), -9.81)
    count, inside = int(draw(1, 4)), draw(0, 1) > 0.6
    radii = [draw(0.02, 0.08) for _ in range(count + 1)]
    if inside:
        radii[-1] = radii[-2] + draw(0.05, 0.1)
    centres, heading = [0j], 0.0
    for k in range(count):
        heading += draw(-1.2, 1.2)
        apart = radii[k + 1] - radii[k] if inside and k == count - 1 else radii[k] + radii[k + 1]
        centres.append(centres[-1] + apart * np.exp(1j * heading))
    matter = [
        (draw(0.2, 2.0), draw(-0.01, 0.01) + 1j * draw(-0.01, 0.01), draw(1e-4, 1e-3))
        for _ in range(count + 2)
    ]

    def body(name, k):
        mass, centre, inertia = matter[k]
        return m.link(
            name, length=0.05, mass=mass, centre=(centre.real, centre.imag), inertia=inertia
        )

    arm, wheels = body("arm", count + 1), [body(f"gear{k}", k) for k in range(count + 1)]
    laws = {
        "swing": harmonic(draw(-1, 1), draw(0.3, 1.0), draw(0.5, 2.0)),
        "pin0": polynomial(draw(-1, 1), draw(-9, 9), draw(-9, 9)),
    }
    m.revolute("swing", m.ground, arm)
    m.revolute("pin0", m.ground, wheels[0])
    for k in range(1, count + 1):
        m.revolute(f"pin{k}", arm.at(centres[k].real, centres[k].imag), wheels[k])
    angle = draw(5, 30)
    for k in range(count):
        gears(
            m,
            f"mesh{k}",
            wheels[k],
            wheels[k + 1],
            radii=radii[k : k + 2],
            pressure_angle=f"{angle} deg",
        )
    forces = [
        (draw(-0.02, 0.02) + 1j * draw(-0.02, 0.02), draw(-90, 90) + 1j * draw(-90, 90))
        for _ in wheels
    ]
    for k, (at, force) in enumerate(forces):
        m.force(f"push{k}", wheels[k].at(at.real, at.imag), x=force.real, y=force.imag)
    return Scene(m, laws, t=(0, 0.4, 7)), (
        radii,
        centres,
        matter,
        forces,
        math.radians(angle),
        inside,
    )


def by_vectors(solution, told, i):
    """Forces at an instant by Newton and Euler on free bodies, with the teeth as forces at pitch
    points.

    Only the motion of the arm and the sun is taken from the solution; the others' follows from
    velocities at pitch points. Which flank touches is tried.
    """
    radii, centres, matter, forces, alpha, inside = told
    count = len(radii) - 1
    arm, sun = solution.motion("swing"), solution.motion("pin0")
    turn, rate, gain = (float(one[i]) for one in (arm.value, arm.rate, arm.acceleration))
    angles, rates, gains = ([float(one[i])] for one in (sun.value, sun.rate, sun.acceleration))
    pitches = []
    for k in range(count):
        inner = inside and k == count - 1
        way = (
            (centres[k + 1] - centres[k]) / abs(centres[k + 1] - centres[k]) * (-1 if inner else 1)
        )
        pitches.append(centres[k] + radii[k] * way)
        arm1, arm2 = pitches[k] - centres[k], pitches[k] - centres[k + 1]
        # Both have one velocity at the pitch point, as seen from the arm.
        share = (arm1 / arm2).real
        for values, own in ((angles, turn), (rates, rate), (gains, gain)):
            values.append(own + share * (values[k] - own))
    spin = np.exp(1j * turn)
    where = [spin * c for c in centres]
    moved = [(1j * gain - rate**2) * c for c in where]
    where, moved = [*where, 0j], [*moved, 0j]
    angles, rates, gains = [*angles, turn], [*rates, rate], [*gains, gain]
    gravity = complex(*solution.description["gravity"])
    bodies = count + 2
    columns = 2 * bodies + count + 2  # pins, teeth, the two drives
    flanks = np.ones(count)
    matrix, right = np.zeros((3 * bodies, columns)), np.zeros(3 * bodies)
    middles = [where[b] + matter[b][1] * np.exp(1j * angles[b]) for b in range(bodies)]

    def push(body, column, place, force):
        matrix[3 * body : 3 * body + 2, column] += force.real, force.imag
        matrix[3 * body + 2, column] += (np.conj(place - middles[body]) * force).imag

    for _ in range(3):
        matrix[:], right[:] = 0.0, 0.0
        for b in range(bodies):
            mass, centre, inertia = matter[b]
            lever = centre * np.exp(1j * angles[b])
            inertial = mass * (moved[b] + (1j * gains[b] - rates[b] ** 2) * lever - gravity)
            right[3 * b : 3 * b + 3] += inertial.real, inertial.imag, inertia * gains[b]
            if b <= count:
                at, force = forces[b]
                arm_ = at * np.exp(1j * angles[b]) - lever
                right[3 * b : 3 * b + 3] -= force.real, force.imag, (np.conj(arm_) * force).imag
            for axis, unit in enumerate((1.0, 1j)):
                push(b, 2 * b + axis, where[b], unit)
                if 0 < b <= count:
                    push(bodies - 1, 2 * b + axis, where[b], -unit)
        for k in range(count):
            out = spin * (pitches[k] - centres[k]) / radii[k]
            force = 1j * out - flanks[k] * math.tan(alpha) * out
            push(k, 2 * bodies + k, spin * pitches[k], force)
            push(k + 1, 2 * bodies + k, spin * pitches[k], -force)
        matrix[3 * (bodies - 1) + 2, columns - 2] = 1.0
        matrix[2, columns - 1] = 1.0
        found = np.linalg.solve(matrix, right)
        flanks = np.sign(found[2 * bodies : 2 * bodies + count])
    pins = found[: 2 * bodies].reshape(-1, 2) @ [1.0, 1j]
    return angles, pins, found[2 * bodies : 2 * bodies + count], found[-2:]


@settings(deadline=None, max_examples=6)
@given(st.integers(0, 10**6))
def test_random_trains_on_an_arm_that_turns(seed):
    """All forces agree with vector equilibrium of free bodies, and all certificates hold."""
    scene, told = train(random.Random(seed).uniform)
    solution = evaluate(scene)
    assert solution.certified
    count = len(told[0]) - 1
    for i in (0, 3, 6):
        angles, pins, teeth, drives = by_vectors(solution, told, i)
        size = max(np.abs(pins).max(), np.abs(teeth).max())
        for k in range(count + 1):
            reaction = solution.reaction(f"pin{k}")
            assert reaction.fx[i] + 1j * reaction.fy[i] == pytest.approx(pins[k], abs=1e-12 * size)
            start = solution.pose(f"gear{k}").angle[0] - by_vectors(solution, told, 0)[0][k]
            assert solution.pose(f"gear{k}").angle[i] == pytest.approx(angles[k] + start, abs=1e-11)
        for k in range(count):
            assert solution.multiplier(f"mesh{k}")[i] == pytest.approx(teeth[k], abs=1e-12 * size)
        reaction = solution.reaction("swing")
        assert reaction.fx[i] + 1j * reaction.fy[i] == pytest.approx(
            pins[count + 1], abs=1e-12 * size
        )
        assert (solution.effort("swing")[i], solution.effort("pin0")[i]) == pytest.approx(
            tuple(drives), abs=1e-12 * size
        )


@pytest.mark.parametrize("rubs", [False, True])
def test_pins_that_close_loops_bear_teeth_too(rubs):
    """Balance, power, and the sections of the carrier at its base hold; and no order of declaration
    changes anything.
    """
    found = [evaluate(geared_five_bar(order, rubs)) for order in ("OABCD", "DCBAO")]
    for solution in found:
        assert solution.certified
        assert (
            max(solution.certificate[name].max() for name in ("balance", "power", "ends")) < 1e-13
        )
    for name in "OABCD":
        one, other = (solution.reaction(name).fx for solution in found)
        assert one == pytest.approx(other, abs=1e-11 * np.abs(one).max())


def test_the_carrier_bears_what_presses_apart():
    """Between two gears on an arm that stands still the arm is in tension, by the radial force."""
    m = Mechanism("arm")
    m.set_gravity(0, 0)
    arm = m.link("arm", length=0.1, mass=1.0)
    first = wheel(m, "first", radius=0.04, mass=1.0)
    second = wheel(m, "second", radius=0.06, mass=1.0)
    m.revolute("O", m.ground, arm)
    m.revolute("A", arm, first)
    m.revolute("B", arm.tip, second)
    gears(m, "mesh", first, second, radii=(0.04, 0.06))
    m.torque("load", second, 30.0)
    solution = evaluate(Scene(m, {"O": polynomial(0.4), "A": polynomial(0.0)}, t=(0, 1, 2)))
    assert solution.section("arm").axial[0] == pytest.approx(
        500.0 * math.tan(math.radians(20)), rel=1e-12
    )
    assert np.abs(solution.section("arm").shear[0]) == pytest.approx(500.0, rel=1e-12)


def test_a_rack_is_pushed_where_its_gear_is():
    """The force travels along the rack; T = F r, and F tan(20 deg) off the gear."""
    m = Mechanism("rack")
    m.set_gravity(0, 0)
    pinion = wheel(m, "pinion", radius=0.05, mass=1.0)
    bar = m.link("bar", length=0.6, mass=0.0)
    m.revolute("turn", m.ground, pinion)
    m.prismatic("slide", m.ground.at(0, -0.07), bar.at(0.3, -0.02), axis=(1, 0))
    mesh = gears(m, "mesh", pinion, bar.at(0.3), radii=0.05)
    m.force("push", bar.tip, x=-100.0)
    solution = evaluate(Scene(m, {"turn": harmonic(0.0, 1.5, 1.0)}, t=(0, 1, 9)))
    assert solution.certified
    assert mesh.kind == "rack"
    assert solution.motion("slide").value == pytest.approx(
        0.05 * solution.motion("turn").value, abs=1e-15
    )
    assert solution.multiplier("mesh") == pytest.approx(np.full(9, -100.0), rel=1e-12)
    # Beyond the pinion nothing bends the bar; the load is along it.
    place = 0.3 - solution.motion("slide").value
    beyond = solution.section("bar").law.at("axial", (place / 0.6 + 0.01)[:, None])[:, 0]
    before = solution.section("bar").law.at("axial", (place / 0.6 - 0.01)[:, None])[:, 0]
    assert beyond == pytest.approx(np.full(9, -100.0), rel=1e-12)
    assert before == pytest.approx(np.zeros(9), abs=1e-11)


def refused(told, **more):
    with pytest.raises(DeclarationError) as error:
        pair(**more)
    assert told in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.quick
def test_bad_gears_are_refused_by_name():
    refused("pressure_angle must be from 0 to 45 deg, got 50 deg", pressure_angle="50 deg")
    refused("gears in a plane have no helix", helix_angle="20 deg")
    refused("hand must be 'right' or 'left'", hand="both")
    m = Mechanism("bad")
    first, second, third = (
        m.link(name, length=0.1, mass=1.0, centre=(0, 0), inertia=1e-3) for name in ("a", "b", "c")
    )
    m.revolute("A", m.ground, first)
    m.revolute("B", m.ground.at(0.1, 0), second)
    m.revolute("C", second.tip, third)

    def one_line(told, *where, **more):
        with pytest.raises(DeclarationError) as error:
            gears(m, "mesh", *where, **more)
        assert str(error.value).startswith("gears 'mesh': ")
        assert told in str(error.value)
        assert "\n" not in str(error.value)

    both = (first, second)
    one_line(
        "centres are 0.1 m apart; expected 0.11 m by the radii, or 0.01 m for a gear in a ring",
        *both,
        radii=(0.05, 0.06),
    )
    one_line("centres are 0.1 m apart; expected 0.09 m", *both, teeth=(20, 40), module=0.003)
    one_line(
        "numbers of teeth must be whole, and 1 or more, got 20.5",
        *both,
        teeth=(20.5, 40),
        module=0.003,
    )
    one_line(
        "numbers of teeth must be whole, and 1 or more, got 0", *both, teeth=(0, 40), module=0.003
    )
    one_line("radii must be positive, got -0.1 m", *both, radii=(-0.1, 0.2))
    one_line("module must be positive", *both, teeth=(20, 40), module=0.0)
    one_line("expected module= and teeth=, or radii=", *both, module=0.003)
    one_line("expected module= and teeth=, or radii=", *both, radii=(0.05, 0.05), module=0.003)
    one_line("expected 2 radii, got 1", *both, radii=0.05)
    one_line("'a' turns on 'ground'; 'c' turns on 'b'", first, third, radii=(0.05, 0.05))
    one_line("'a' turns on nothing", first.at(0.01), second, radii=(0.05, 0.05))
    one_line("on 'c'", *both, radii=(0.05, 0.05), carrier=third)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("values", "told"),
    [
        ({"z": 40.5}, "numbers of teeth must be whole, and 1 or more, got 40.5"),
        ({"r": 0.07}, "its centres are 0.09 m apart"),
    ],
)
def test_values_that_do_not_fit_are_refused(values, told):
    m = Mechanism("swept")
    z, r = m.parameter("z", 40.0), m.parameter("r", 0.06, "m")
    first, second = wheel(m, "first", radius=0.03, mass=1.0), wheel(m, "second", radius=r, mass=1.0)
    m.revolute("A", m.ground, first)
    m.revolute("B", m.ground.at(0.09, 0), second)
    gears(m, "mesh", first, second, teeth=(20, z), radii=(0.03, r))
    scene = Scene(m, {"A": polynomial(0, 1)}, t=(0, 1, 2))
    assert evaluate(scene).certified
    with pytest.raises(ParameterError, match="'mesh'") as error:
        evaluate(scene, parameters=values)
    assert told in str(error.value)


@pytest.mark.quick
def test_wheels_are_discs():
    m, s = Mechanism("plane"), SpatialMechanism("space")
    disc = wheel(m, "disc", radius=0.1, bore=0.04, width=0.02, teeth=30)
    mass = 7850 * math.pi * (0.1**2 - 0.04**2) * 0.02
    assert disc.mass.mass == pytest.approx(mass)
    assert disc.mass.inertia == pytest.approx(mass * (0.1**2 + 0.04**2) / 2)
    assert len(m.outlines["disc"][0]) == 4 * 30 + 48 + 2
    solid = wheel(s, "disc", radius=0.1, mass=2.0, width=None)
    assert [float(solid.mass.inertia[k][k]) for k in range(3)] == pytest.approx(
        [0.01, 0.005, 0.005]
    )
    for told in (
        {"radius": 0.1},
        {"radius": 0.1, "bore": 0.2, "mass": 1.0},
        {"radius": 0.1, "mass": 1.0, "teeth": 2.5},
    ):
        with pytest.raises(DeclarationError, match="wheel 'other'"):
            wheel(m, "other", **told)


def test_a_rack_in_a_loop_that_a_guide_closes():
    """The guide holds a direction too, which is an equation by itself: the shoe may as well be a
    point, which has none.
    """

    def solved(shoe):
        m = Mechanism("rack_in_a_loop")
        cart, arm = m.link("cart", length=0.1, mass=1.0), m.link("arm", length=0.4, mass=1.0)
        bar, last = m.link("bar", length=0.5, mass=0.5), shoe(m)
        m.prismatic("x", m.ground, cart, axis=(1, 0))
        m.revolute("A", cart, arm)
        m.prismatic("B", arm.at(0.1, 0.04), bar.at(0.2), axis=(1, 0))
        gears(m, "mesh", cart, bar.at(0.2), radii=0.04, carrier=arm)
        m.revolute("D", bar.tip, last)
        m.prismatic("C", m.ground.at(0.0, 0.4), last, axis=(1, 0))
        rough = {"arm": 0.8, "bar": 0.8, "B": 0.03, "C": 0.4}
        return evaluate(Scene(m, {"x": harmonic(0.0, 0.1, 1.0)}, t=(0, 0.4, 9), posture=rough))

    point = solved(lambda m: m.point_mass("shoe", 0.3))
    link = solved(lambda m: m.link("shoe", length=0.05, mass=0.3))
    assert link.certified
    for one, other in (
        (link.multiplier("mesh"), point.multiplier("mesh")),
        (link.effort("x"), point.effort("x")),
        (link.reaction("A").fy, point.reaction("A").fy),
    ):
        np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-12 * np.abs(other).max())
