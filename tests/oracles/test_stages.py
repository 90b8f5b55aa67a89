"""Phases that outlast any number of turns, against the scene's own graphs in 50 digits."""

import dataclasses
import functools
import math

import casadi as ca
import numpy as np
import pytest
from conftest import CASES
from estimates import kind as kind_of
from internals import certify
from mechanisms import (
    PLAIN,
    counting,
    double_crank,
    four_bar,
    harmonics,
    links_of,
    pins_of,
    sampled,
    slider_crank,
)
from mechanisms import sprung as four_bar_with_springs
from outside import doubled
from stepped import pinned
from truth import true_errors, truth

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, evaluate, load_case
from lagrange_casadi.errors import DeclarationError
from lagrange_casadi.motion import expression, harmonic, polynomial

DOUBLE = [{"backend": backend} for backend in ("vm", "c", "lanes")]
SINGLE = [{"backend": backend, "precision": "single"} for backend in ("c", "lanes")]
BOUNDS = {"jansen_leg": 1e-5, "excavator": 3e-5, "cardan_shaft": 5e-6, "five_link_suspension": 1e-5}
"""The loops of the leg come near a dead centre; thrusts of 240 kN leave the excavator's cylinders
moments of 580 N m.

The cardan shaft's torque of 80 N m and lever of 0.5 m leave forces that are nil; the suspension's
condition number is 10.
"""
_NIL = 1e-30
AFTER = [(method, later) for method in DOUBLE for later in (1e3, 1e6)]
AFTER += [(method, later) for method in SINGLE for later in (0.0, 1e4)]
"""Methods, and by how much later than a cycle's start [s]."""


def gap(scene, method, exact=None):
    """The largest error of any output by a method, relative to the peak of its kind; angles up to
    whole turns.
    """
    solution = evaluate(scene, certificate=False, **method)
    exact = exact or truth(scene, solution.t)
    # In space whole motions and moments are nil, and not by structure.
    kind = solution.unit if isinstance(scene.mechanism, SpatialMechanism) else kind_of
    size = {}
    for name, values in solution.series.items():
        size[kind(name)] = max(size.get(kind(name), 0.0), np.max(np.abs(values)))
    off = true_errors(solution, exact, sections=False)
    return max(
        x / (size[kind(name)] if size[kind(name)] > _NIL else 1.0) for name, x in off.items()
    )


@functools.cache
def case(name, later):
    """A case at three instants of its cycle so much later, and what it has there."""
    scene = load_case(CASES / name).scene
    ends = (scene.span[0] + later + x * np.ptp(scene.span) for x in (0.13, 0.77))
    scene = dataclasses.replace(scene, t=(*ends, 3), over=None, wanted=["all"])
    return scene, truth(scene, evaluate(scene, wanted=["motion"], backend="vm").t)


@pytest.mark.sampled(79)
@pytest.mark.parametrize(("method", "later"), AFTER, ids=str)
@pytest.mark.parametrize("name", PLAIN)
def test_cases_keep_their_phases(name, method, later):
    """Andrews' squeezer is left out of single precision: at its acceleration three hours are 10^12
    rad, which no pair of singles knows a phase of.
    """
    if name == "andrews_squeezer" and method in SINGLE and later:
        return
    scene, exact = case(name, later)
    single = max(1e-5 if later else 3e-6, BOUNDS.get(name, 0.0))
    assert gap(scene, method, exact) < (1e-13 if method in DOUBLE else single)


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
    crank, wheel, rod = links_of(m, crank=(0.1, 0.3), wheel=(0.06, 0.5), rod=(0.2, 0.1))
    slider = m.point_mass("slider", 0.4)
    first, second = m.revolute("O", m.ground, crank), m.revolute("W", m.ground.at(0.3, 0.0), wheel)
    m.gear("mesh", first, second, ratio=ratio, offset=0.2)
    pins_of(m, A=(wheel.tip, rod), B=(rod.tip, slider))
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
    # In single a spline is read in singles: its phase is as good as the angle's own rounding.
    yield "samples", (lambda: sampled(10.0)), 5e-3
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
    wanted = ["load:load", "effort"] if "load" in made.mechanism.loads else ["all"]
    for later, methods, allowed in ((2.5e4, DOUBLE, 1e-13), (4e3, SINGLE, single)):
        at = dataclasses.replace(made, t=(later + 0.0123, later + 0.0777, 3), wanted=wanted)
        exact = truth(at, evaluate(at, wanted=["effort"], backend="vm", certificate=False).t)
        for method in methods:
            assert gap(at, method, exact) < allowed, method


TURNING = {"b": 2.2, "c": 1.6}


def drag_link(**keywords):
    """All links turn with the crank."""
    return four_bar((0.3, 0.35, 0.32), frame=(0.1, 0.02), rocker=1.6, **keywords)


@pytest.mark.parametrize(
    ("methods", "later", "allowed"),
    [(DOUBLE, 1e6, 1e-13), (SINGLE, 1e4, 1e-5)],
    ids=["double", "single"],
)
def test_iterated_loops_after_a_million_turns(methods, later, allowed):
    m = drag_link(pin=pinned).mechanism
    law, wanted = {"O": polynomial(0.2, 2 * math.pi)}, ["reaction:C", "effort"]
    scene = Scene(m, law, wanted, posture=TURNING, t=(later, later + 1.0, 41))
    for method in methods:
        assert gap(scene, method) < allowed


def test_iterated_angles_that_a_gear_counts_are_not_kept_within_a_turn():
    scene = dataclasses.replace(double_crank(10.0), t=(0, 120, 801))
    for method in DOUBLE:
        solution = evaluate(scene, wanted=["motion"], **method)
        turned = np.unwrap(solution.motion("C").value)
        assert turned[-1] - turned[0] > 18 * 2 * math.pi
        np.testing.assert_allclose(solution.motion("G").value, -2.0 * turned, atol=1e-11)


@pytest.mark.parametrize("stop", [0.08, 0.5, 2.0, 5.0, 12.0, 30.0, 80.0])
def test_from_few_turns_to_many(stop):
    """Doubles that count, and pairs, wherever the one takes over from the other."""
    assert gap(slider_crank(["all"], t=(stop - 0.02, stop, 5)), DOUBLE[0]) < 1e-13


def test_what_cannot_be_followed_is_not_in_single():
    scene = counting(RAMP, lambda m, angle: doubled(angle))
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
