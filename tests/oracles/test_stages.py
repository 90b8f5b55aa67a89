"""Phases that outlast any number of turns, against the scene's own graphs in 50 digits."""

import dataclasses
import functools
import math
from fractions import Fraction

import casadi as ca
import numpy as np
import pytest
from balance import instant_at, settle
from conftest import CASES, NAMES
from estimates import kind as kind_of
from internals import (
    FEW_TURNS,
    EvaluationMethod,
    Output,
    certify,
    compensated,
    controlled,
    interpret,
    numpy_arithmetic,
    plain,
    reference,
    run,
    turns_many,
)
from mechanisms import counting, four_bar, harmonics, sampled, slider_crank
from mechanisms import sprung as four_bar_with_springs
from outside import doubled
from stepped import pinned

from lagrange_casadi import Mechanism, Scene, derive, evaluate, load_case
from lagrange_casadi.errors import DeclarationError
from lagrange_casadi.motion import expression, harmonic, polynomial, samples

DOUBLE = [EvaluationMethod("vm"), EvaluationMethod("c"), EvaluationMethod("lanes")]
BOUNDS = {"jansen_leg": 1e-5, "excavator": 3e-5, "cardan_shaft": 5e-6, "five_link_suspension": 1e-5}
"""The loops of the leg come near a dead centre; thrusts of 240 kN leave the excavator's cylinders
moments of 580 N m.

The cardan shaft's torque of 80 N m and lever of 0.5 m leave forces that are nil; the suspension's
condition number is 10.
"""
_NIL = 1e-30
SINGLE = [EvaluationMethod("c", "single"), EvaluationMethod("lanes", "single")]


def gap(program, t, method, truth=None):
    """The largest error of any column on a rung, relative to the peak of its kind; angles up to
    whole turns.
    """
    p, kind = values(program), unit_in(program.data.kinds) if program.data.space else kind_of
    table, _ = run(program, t, p, method)
    assert not table.status.any()
    truth = exact(program, t, z=table.iterated) if truth is None else truth
    size = {}
    for name, row in zip(program.names, truth, strict=True):
        size[kind(name)] = max(size.get(kind(name), 0.0), np.max(np.abs(row)))
    worst = 0.0
    for name, row, expected in zip(program.names, np.asarray(table.out, float), truth, strict=True):
        off = row - expected
        if name in map(str, program.loop_angles):
            off = off - math.tau * np.rint(off / math.tau)
        if not name.startswith("_"):
            worst = max(
                worst, np.max(np.abs(off)) / (size[kind(name)] if size[kind(name)] > _NIL else 1.0)
            )
    return worst


def unit_in(kinds):
    """In space whole motions and moments are nil, and not by structure: what has the same unit is
    measured by one peak.
    """
    return lambda name: (
        name if name.startswith("_") else Output.of(name).unit(kinds).replace("rad", "1")
    )


def values(program):
    return program.data.defaults


def exact(program, t, **beside):
    return np.array(
        [[float(x) for x in row] for row in reference(program, t, values(program), **beside)]
    ).T


@functools.cache
def case(name, later):
    """A case's graph, three instants of its cycle so much later, and every column there."""
    scene = load_case(CASES / name).scene
    program = derive(scene, ["all"])
    t = np.array([0.13, 0.4, 0.77]) * np.ptp(scene.span) + scene.span[0] + later
    z = (
        None
        if program.newton is None
        else run(program, t, values(program), EvaluationMethod("vm"))[0].iterated
    )
    return program, t, exact(program, t, z=z)


@pytest.mark.sampled(9)
@pytest.mark.parametrize("name", NAMES)
def test_plain_stages_are_the_graphs_bits(name):
    program = derive(load_case(CASES / name).scene, ["all"])
    p, stages = values(program), plain(program)
    assert not stages.compensated
    for t in np.linspace(*program.data.span, 5):
        z = settle(program, t, p, program.data.span[0])
        out = stages.instant(*stages.drive(t, p), z, p)
        assert (
            out.full().tobytes() == program.instant(t, *program.motion(t, p), z, p).full().tobytes()
        )


@pytest.mark.sampled(97)
@pytest.mark.parametrize("later", [1e3, 1e6])
@pytest.mark.parametrize("method", DOUBLE, ids=lambda method: method.backend)
@pytest.mark.parametrize("name", NAMES)
def test_doubles_after_days(name, method, later):
    program, t, truth = case(name, later)
    assert gap(program, t, method, truth) < 1e-13


@pytest.mark.sampled(41)
@pytest.mark.parametrize("method", SINGLE, ids=lambda method: method.backend)
@pytest.mark.parametrize("name", [name for name in NAMES if name != "andrews_squeezer"])
def test_singles_after_hours(name, method):
    """Andrews' squeezer is left out: at its acceleration three hours are 10^12 rad, which no pair
    of singles knows a phase of.
    """
    program, t, truth = case(name, 1e4)
    assert gap(program, t, method, truth) < max(1e-5, BOUNDS.get(name, 0.0))


@pytest.mark.sampled(31)
@pytest.mark.parametrize("name", NAMES)
def test_singles_at_the_start(name):
    program, t, truth = case(name, 0.0)
    for method in SINGLE:
        assert gap(program, t, method, truth) < BOUNDS.get(name, 3e-6)


RAMP = polynomial(0.3, 40.0)
LOADS = {
    "fmod": lambda m, angle: ca.sin(0.7 * ca.fmod(angle - 0.2, 4 * math.pi)),
    "remainder": lambda m, angle: ca.remainder(angle, 2 * math.pi) ** 2,
    "turns": lambda m, angle: 3.0 * (angle - 2 * math.pi * ca.floor(angle / (2 * math.pi))),
    "harmonics": harmonics,
    "time": lambda m, angle: 50.0 * ca.sin(100 * m.time) * (1 + ca.cos(100 * m.time - angle)),
    "size": lambda m, angle: ca.sin(ca.fabs(0.3 - 2 * angle)),
    "tangent": lambda m, angle: ca.tan(angle / 4) / (1 + ca.tan(angle / 4) ** 2),
    "parameters": lambda m, angle, k: (
        ca.sin(ca.sqrt(k) * m.time + k / 3) + ca.sin(angle / k - k**3 * m.time)
    ),
    "squares": lambda m, angle: ca.sin(1e-3 * m.time**2 - 1 / (angle + 1)),
    "switched": lambda m, angle: (
        ca.if_else(ca.fmod(m.time, 0.02) > 0.01, 4.0, 1.0) * ca.fmin(m.time, 2.0)
    ),
}


LAWS = {
    "root": expression(lambda t: ca.sqrt(7 * t + 1e6) * 90),
    "quotient": expression(lambda t: t * 100 / (3 + 1 / (1 + t))),
    "pieces": expression(lambda t: ca.if_else(t < 3600, 30 * t, 30 * 3600 + 17 * (t - 3600))),
    "clamp": expression(lambda t: ca.fmax(ca.fmin(33 * t, 1e9), 10 * t)),
    "swing": harmonic(0.2, 0.9, 3.3, 0.1),
    "swung": expression(lambda t: 25 * t + ca.sin(20 * t)),
}


def geared(ratio):
    """A crank and a wheel on a gear, the wheel's pin a connecting rod's."""
    m = Mechanism("geared")
    crank = m.link("crank", length=0.1, mass=0.3)
    wheel = m.link("wheel", length=0.06, mass=0.5)
    rod = m.link("rod", length=0.2, mass=0.1)
    slider = m.point_mass("slider", 0.4)
    first, second = m.revolute("O", m.ground, crank), m.revolute("W", m.ground.at(0.3, 0.0), wheel)
    m.gear("mesh", first, second, ratio=ratio, offset=0.2)
    m.revolute("A", wheel.tip, rod)
    m.revolute("B", rod.tip, slider)
    m.prismatic("guide", m.ground, slider, axis=(1, 0))
    return Scene(m, {"O": RAMP}, posture={"rod": 0.1}, t=(0.0, 0.1, 11))


def counted():
    """Scenes whose loads, laws, gears and springs count, what is looked at, and the error that
    single precision may leave.
    """
    for name, load in LOADS.items():
        more = {"k": 3.0} if name == "parameters" else {}
        yield f"load {name}", (lambda load=load, more=more: counting(RAMP, load, **more)), 2e-5
    for name, law in LAWS.items():
        yield f"law {name}", (lambda law=law: counting(law, LOADS["harmonics"])), 1e-5
    for ratio in (-0.5, 7.0 / 3.0):
        yield f"gear {ratio:.2g}", (lambda ratio=ratio: geared(ratio)), 1e-5
    # Springs on pins that no drive is on: between a crank and its rod, and at a rocker's foot.
    yield "springs", (lambda: four_bar_with_springs("AC", law=RAMP, span=0.1, count=11)), 1e-5


@pytest.mark.sampled(5)
@pytest.mark.parametrize(
    ("scene", "single"), [pytest.param(scene, one, id=name) for name, scene, one in counted()]
)
def test_what_counts_keeps_its_phase(scene, single):
    """After a million radians in double; in single, after an hour, as in
    :func:`test_singles_after_hours`.
    """
    made = scene()
    program = derive(made, ["load:load", "effort"] if "load" in made.mechanism.loads else ["all"])
    for later, methods, allowed in ((2.5e4, DOUBLE, 1e-13), (4e3, SINGLE, single)):
        t = later + np.array([0.0123, 0.0391, 0.0777])
        truth = exact(program, t)
        for method in methods:
            assert gap(program, t, method, truth) < allowed, method


def test_motion_by_samples():
    program = derive(sampled(10.0), ["load:load", "effort"])
    t = 90.0 + np.linspace(0.0, 3.0, 7)
    assert turns_many(program, t, values(program))
    truth = exact(program, t)
    for method in DOUBLE:
        assert gap(program, t, method, truth) < 1e-13
    # In single a spline is read in singles: its phase is as good as the angle's own rounding.
    for method in SINGLE:
        assert gap(program, t, method, truth) < 5000.0 * 1e-6


def two_drives():
    """A crank that turns steadily for hours carries an arm that samples swing."""
    m = Mechanism("two_drives")
    arm, crank = m.link("arm", length=0.2, mass=0.3), m.link("crank", length=0.1, mass=0.4)
    m.revolute("S", crank.tip, arm)
    m.revolute("O", m.ground, crank)
    times = np.linspace(3600.0, 3602.0, 21)
    return Scene(
        m, {"S": samples(times, np.sin(times)), "O": polynomial(0.1, 50.0)}, t=(3600.0, 3602.0, 21)
    )


def test_steady_drives_beside_samples():
    """What the samples lose in single, the steady drive does not."""
    scene = two_drives()
    program = derive(scene, ["all"])
    t = np.linspace(3600.1, 3601.9, 7)
    assert turns_many(program, t, values(program))
    truth = exact(program, t)
    for method in DOUBLE:
        assert gap(program, t, method, truth) < 1e-13
    table, _ = run(program, t, values(program), SINGLE[0])
    for member in ("x", "y"):
        # The arm's pin is the crank's tip.
        row = program.names.index(f"pose:arm:{member}")
        assert np.max(np.abs(table.out[row] - truth[row])) < 1e-6 * 0.1


TURNING = {"b": 2.2, "c": 1.6}


def drag_link(**keywords):
    """All links turn with the crank."""
    return four_bar((0.3, 0.35, 0.32), frame=(0.1, 0.02), rocker=1.6, **keywords)


def wheel_on_drag_link():
    m = Mechanism("wheel")
    a, b, c = (
        m.link(n, length=l, mass=w)
        for n, l, w in zip("abc", (0.3, 0.35, 0.32), (0.3, 0.5, 0.4), strict=True)
    )
    m.revolute("O", m.ground, a)
    m.revolute("A", a.tip, b)
    m.revolute("B", b.tip, c.tip)
    foot = m.revolute("C", m.ground.at(0.1, 0.02), c)
    wheel = m.revolute("W", m.ground.at(0.5, 0.0), m.link("wheel", length=0.1, mass=0.2))
    m.gear("mesh", foot, wheel, ratio=-0.3)
    return Scene(
        m, {"O": polynomial(0.2, 3.0)}, posture={"b": 2.2, "c": 1.6, "wheel": 0.0}, t=(0.0, 1.0, 2)
    )


def test_iterated_angles_are_kept_within_a_turn():
    """Ten thousand turns of every link, in steps of a fifth of one; at their end as near as at
    their start.
    """
    law = {"O": polynomial(0.2, 2 * math.pi)}
    scenes = (
        Scene(drag_link(pin=pin).mechanism, law, posture=TURNING, t=(0.0, 1.0, 2))
        for pin in (pinned, Mechanism.revolute)
    )
    iterated, closed = (derive(scene, ["reaction:C", "effort"]) for scene in scenes)
    assert iterated.newton is not None
    assert all(iterated.newton.turning)
    t = np.linspace(0.0, 1e4, 50_001)
    for method, allowed in (
        (EvaluationMethod("c"), 1e-13),
        (EvaluationMethod("c", "single"), 1e-5),
    ):
        one, two = (run(program, t, values(program), method)[0] for program in (iterated, closed))
        assert not one.status.any()
        assert np.max(np.abs(one.iterated)) <= math.pi * (1 + 1e-6)
        for name in ("effort:O", "reaction:C:fx"):
            gaps = np.abs(one.out[iterated.names.index(name)] - two.out[closed.names.index(name)])
            assert np.max(gaps[-100:]) < allowed * np.max(np.abs(two.out[closed.names.index(name)]))


@pytest.mark.parametrize(
    ("methods", "later", "allowed"),
    [(DOUBLE, 1e6, 1e-13), (SINGLE, 1e4, 1e-5)],
    ids=["double", "single"],
)
def test_iterated_loops_after_a_million_turns(methods, later, allowed):
    m = drag_link(pin=pinned).mechanism
    scene = Scene(
        m, {"O": polynomial(0.2, 2 * math.pi)}, posture=TURNING, t=(later, later + 1.0, 41)
    )
    program, t = derive(scene, ["reaction:C", "effort"]), np.linspace(*scene.span, scene.t[2])
    for method in methods:
        assert gap(program, t, method) < allowed


def test_iterated_angles_that_a_gear_counts_are_not():
    scene = wheel_on_drag_link()
    program = derive(scene, ["motion"])
    turning = dict(zip(("A", "C", "W"), program.newton.turning, strict=False))
    assert not all(program.newton.turning), turning
    t = np.linspace(0.0, 40.0, 801)
    for method in (EvaluationMethod("vm"), EvaluationMethod("c"), EvaluationMethod("lanes")):
        table, _ = run(program, t, values(program), method)
        rows = dict(zip(program.names, table.out, strict=True))
        turned = np.unwrap(rows["motion:C"])
        assert turned[-1] - turned[0] > 18 * 2 * math.pi
        np.testing.assert_allclose(rows["motion:W"], -0.3 * turned, atol=1e-11)


def test_from_few_turns_to_many():
    """Doubles that count, and pairs, on either side of where the one takes over."""
    program = derive(slider_crank(["all"]))
    p, stop = values(program), (FEW_TURNS - 0.05) / (25 * math.pi)
    below, above = np.linspace(0.0, stop, 50), np.linspace(0.0, stop + 1e-3, 50)
    assert not turns_many(program, below, p)
    assert turns_many(program, above, p)
    one, two = (run(program, t, p, EvaluationMethod("vm"))[0] for t in (below, above))
    assert (one.stages.compensated, two.stages.compensated) == (False, True)
    assert gap(program, below[-5:], EvaluationMethod("vm")) < 1e-13
    pairs = compensated(program, "double")
    for t in below[-5:]:
        counted = np.array(pairs.instant(*pairs.drive(t, p), [], p))
        once = np.array(instant_at(program, t, p))
        size = {}
        for name, row in zip(program.names, one.out, strict=True):
            size[kind_of(name)] = max(size.get(kind_of(name), 0.0), np.max(np.abs(row)))
        for name, x, y in zip(program.names, counted, once, strict=True):
            assert abs(x - y)[0] <= 1e-13 * (size[kind_of(name)] or 1.0), name


@pytest.mark.parametrize(
    ("scene", "instants", "expected"),
    [
        (
            lambda: counting(polynomial(0.3), LOADS["harmonics"]),
            (1e6, 1e6 + 1),
            False,
        ),  # nothing turns
        (lambda: counting(polynomial(0.3), LOADS["time"]), (1e6, 1e6 + 1), True),
        (lambda: counting(polynomial(0.3), LOADS["time"]), (0.0, 1.2), False),
        (lambda: counting(harmonic(0.0, 1.0, 1.0), LOADS["harmonics"]), (0.0, 20.0), False),
        (lambda: counting(harmonic(0.0, 1.0, 1.0), LOADS["harmonics"]), (0.0, 21.0), True),
        (
            lambda: counting(polynomial(0.3), lambda m, angle, k: ca.sin(k), k=1e5),
            (0.0, 1.0),
            False,
        ),  # a parameter does not turn
        (
            lambda: counting(polynomial(0.3, 1.0), lambda m, angle: ca.fmod(angle, 1.0)),
            (0.0, 120.0),
            False,
        ),
        (
            lambda: counting(polynomial(0.3, 1.0), lambda m, angle: ca.fmod(angle, 1.0)),
            (-129.0, 0.0),
            True,
        ),
        (
            lambda: counting(polynomial(0.3, 1.0), lambda m, angle: ca.sin(50 * ca.sin(angle))),
            (0.0, 100.0),
            False,
        ),
    ],
)
def test_what_counts(scene, instants, expected):
    program = derive(scene(), ["load:load", "effort"])
    assert turns_many(program, np.linspace(*instants, 101), values(program)) is expected


def test_fixed_parameters_keep_the_phase_of_a_motion():
    """Numbers for parameters that come after the arithmetic of pairs is written would be folded in
    doubles: rests were lost.
    """
    m = Mechanism("arm")
    speed = m.parameter("speed", 7.3, "rad/s")
    m.revolute("O", m.ground, m.link("arm", length=0.5, mass=1.0))
    law = controlled(
        derive(Scene(m, {"O": polynomial(0.0, speed)}), ["effort"]), "single", (7.3,)
    ).law
    single = dataclasses.replace(numpy_arithmetic(), constant=np.float32)
    for t in (1.1, 1e5 / 7, 1e6 / 3):
        high = np.float32(t)
        rest = np.float32(t - float(high))
        found = interpret(law, [[high, rest], [np.float32(7.3)]], single)[0]
        exact = Fraction(7.3) * (Fraction(float(high)) + Fraction(float(rest)))
        assert abs(sum(Fraction(float(part)) for part in found) - exact) < 1e-13 * abs(exact)


def test_what_cannot_be_followed_is_not_in_single():
    scene = counting(RAMP, lambda m, angle: doubled(angle))
    program = derive(scene, ["load:load"])
    assert not turns_many(program, np.array([1e6]), values(program))
    with pytest.raises(
        DeclarationError, match="function 'instant' cannot be followed: it calls another one"
    ):
        evaluate(scene, precision="single", wanted=["load:load"])


def test_the_certificate_knows_what_reported_angles_can_tell():
    """A thousand seconds on, angles are reported to 1e-11 rad; results are better, and are not said
    to be worse.
    """
    scene = load_case(CASES / "engine").scene
    solution = evaluate(scene, t=(1000.0, 1000.04, 201))
    assert np.max(solution.certificate["balance"]) < 1e-13
    # From the reported angles alone, as they stand in a file.
    assert 1e-12 < np.max(certify(solution)["balance"]) < solution.tolerance
    assert solution.errors["effort:main"] < 1e-13 * abs(solution.peak("effort:main").value)
