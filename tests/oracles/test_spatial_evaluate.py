"""Mechanisms in space, evaluated: all is as the oracle has it, in every way of evaluating them, and
files hold it.
"""

import math

import numpy as np
import pytest
from internals import Output
from mechanisms import links_of
from spatial_bridge import coordinate, declared_axes, named, postures
from spatial_oracle import SECTION
from spatial_solutions import DRAWS, evaluated, residuals, scene_of

from lagrange_casadi import Scene, SpatialMechanism, evaluate, motion, refine
from lagrange_casadi.peaks import forces

pytestmark = pytest.mark.usefixtures("interpreted")

WHOLE = {"closure", "balance", "power", "ends"}
MANY = {"tree": 12, "loop": 12, "anyhow": 35, "wheel": 12}
"""How many of a family there are with ``--long``."""


def cases():
    """Families and seeds: ten of those above by default, one of each other."""
    for name in DRAWS:
        few = 10 if name in MANY else 1
        for seed in range(MANY.get(name, 2)):
            long = [pytest.mark.long] if seed >= few else []
            yield pytest.param(name, seed, marks=long, id=f"{name}-{seed}")


OVER_CONSTRAINED = ("planar_four_bar", "planar_slider_crank", "bennett", "bricard")
ROUNDING, EPS, BESIDE = 1e-12, 2.0**-52, 1e-8
FACTOR = 10.0
"""An error that is stated is within a factor of what it is of, and of what rounding makes of the
largest of its kind, as the loops magnify these.
"""

SOME = (1, 4, 8)


def near(value, other, size):
    return abs(value - float(other)) <= ROUNDING * size


@pytest.mark.parametrize(("name", "seed"), cases())
def test_all_is_as_the_oracle_has_it_and_certified(name, seed):
    drawn, solution = evaluated(name, seed)
    found = residuals(solution.certificate)
    assert set(found) == (WHOLE if drawn.rods else WHOLE - {"ends"})
    assert max(found.values()) < ROUNDING
    assert solution.certified
    true = {k: drawn.solve(float(solution.t[k])) for k in SOME}
    reactions = np.array([x for one in true.values() for x in one.reactions.values()], float)
    force = max(1.0, np.abs(reactions[:, :3]).max())
    moment = max(1.0, np.abs(reactions[:, 3:]).max(), force * drawn.mechanism.size)
    steadiness = min(slope.least for _, slope in drawn.path)
    blur = 64 * EPS / steadiness**2
    for k, one in true.items():
        compare_motion(drawn, solution, k, one)
        for full, (value, key) in named(drawn, one).items():
            own = solution.outputs.get(Output.of(full), np.zeros_like(solution.t))
            size = force if full.startswith("reaction") and ":f" in full else moment
            if key in one.open:
                assert np.isnan(own).all(), full
            elif np.isfinite(own).all():
                assert near(own[k], value, size), full
                stated = solution.errors.get(full, 0.0)
                assert abs(own[k] - value) <= FACTOR * stated + blur * size, full
                assert stated <= FACTOR * blur * size, full
            else:
                # What is open at any instant is told at none.
                assert any(key in drawn.solve(float(t)).open for t in solution.t), full
        for rod in drawn.rods:
            compare_sections(drawn, solution, k, one, rod, force, moment)
    open_ = any(output.group != "motion" for output in solution.indeterminate)
    assert open_ == any(bool(one.open) for one in true.values())
    assert open_ or name not in OVER_CONSTRAINED
    locked = [str(output) for output in solution.indeterminate if output.group == "motion"]
    assert name == "locked" or not locked
    if seed % 2 == 0:
        compare_peaks(drawn, scene_of(name, seed)[1], solution, seed, {*named(drawn, one)})


def compare_peaks(drawn, scene, solution, seed, told):
    """Peaks of six forces are what the oracle has there, and no value at an instant is more."""
    told = told | {
        f"section:{rod}:{member}"
        for rod in {*drawn.rods} - {*solution.description.bars}
        for member in SECTION
    }
    told = [full for full in forces(solution) if full in told and solution.determined(full)]
    largest = {full: np.abs(solution.array(full)).max() for full in told}
    some = [str(full) for full in np.random.default_rng(seed).permutation(told)[:6]]
    for peak in refine(scene, solution, some):
        size = max(x for full, x in largest.items() if solution.unit(full) == peak.unit)
        assert abs(peak.value) >= largest[peak.name] - 1e-7 * size, peak
        true = drawn.solve(peak.t)
        if peak.xi is None:
            values = [named(drawn, true)[peak.name][0]]
        else:
            _, rod, member = peak.name.split(":")
            ratios = [min(max(peak.xi + x, 0.0), 1.0) for x in (0.0, -BESIDE, BESIDE)]
            values = [true.sections[rod].at(u)[SECTION.index(member)] for u in ratios]
        gap = min(abs(abs(float(value)) - abs(peak.value)) for value in values)
        assert gap <= 1e-6 * max(size, 1.0), (peak, values)


def is_told(solution, name):
    """Whether a coordinate is measured, and in no gimbal lock."""
    return name not in solution.description.unmeasured and solution.determined(f"motion:{name}")


def compare_motion(drawn, solution, k, one):
    places = postures(drawn, one.poses)
    fast = max(
        1.0,
        *(abs(float(x)) for _, rate, change in one.coordinates.values() for x in (rate, change)),
    )
    for name, value in places.items():
        if not is_told(solution, name):
            continue
        gap = solution.motion(name).value[k] - value
        angle = solution.unit(f"motion:{name}") == "rad"
        assert abs(gap - (math.tau * round(gap / math.tau) if angle else 0.0)) < 1e-11, name
    for (joint, number), (_, rate, change) in one.coordinates.items():
        name = coordinate(drawn.mechanism.joint(joint), number)
        if is_told(solution, name):
            own = solution.motion(name)
            assert near(own.rate[k], rate, 10 * fast), name
            assert near(own.acceleration[k], change, 100 * fast), name
    for body, pose in one.poses.items():
        told = solution.pose(body)
        assert np.allclose([told.x[k], told.y[k], told.z[k]], pose.r, rtol=0, atol=1e-12), body
        axes = declared_axes(drawn, body, pose)
        assert np.allclose(told.axes[k], axes.T, rtol=0, atol=1e-12), body


def compare_sections(drawn, solution, k, one, rod, force, moment):
    """Along and about the axes that are declared."""
    section, R = solution.section(rod), one.poses[rod].R
    turned = R.T @ declared_axes(drawn, rod, one.poses[rod])
    for i, xi in enumerate(solution.xi):
        told = (one.sections[rod].at(float(xi)).reshape(2, 3) @ turned).ravel()
        is_open = np.reshape(one.open_section(rod, float(xi)), (2, 3))
        if rod in solution.description.bars:
            is_open[:, 1:] = is_open[:, 1:].any(axis=1, keepdims=True)
        sizes = [force] * 3 + [moment] * 3
        for name, other, left, size in zip(SECTION, told, is_open.ravel(), sizes, strict=True):
            value = getattr(section, name)[k, i]
            if np.isnan(value):
                # What two stations leave open is told on neither side of them.
                assert one.open
            else:
                assert not left, rod
                assert near(value, other, size), rod


def turning_crank(turns=3, **options):
    """A slider-crank whose crank and rod are joined so that they slide too, along the pin: that
    joint closes the loop.
    """
    m = SpatialMechanism("crank")
    crank, rod, ram = links_of(m, crank=(0.1, 1.0), rod=(0.4, 1.5), ram=(0.1, 2.0))
    m.revolute("O", m.ground, crank, axis=(0, 0, 1))
    m.cylindrical("A", crank.tip, rod, axis=(0, 0, 1))
    m.revolute("B", rod.tip, ram, axis=(0, 0, 1))
    m.prismatic("Q", m.ground, ram, axis=(1, 0, 0))
    posture = {"A:turn": -0.3, "A:slide": 0.0, "B": 0.1, "Q": 0.45}
    return Scene(
        m,
        {"O": motion.polynomial(0.2, 6.0)},
        t=(0, turns * math.tau / 6.0, 60 * turns + 1),
        posture=posture,
        **options,
    )


def test_angles_that_loops_set_go_on():
    """Whether they are coordinates or are measured: over turns each grows by
    what its rate gives.
    """
    solution = evaluate(turning_crank())
    assert solution.certified
    for name in ("A:turn", "B"):
        own = solution.motion(name)
        assert np.abs(np.diff(own.value)).max() < 1.0, name
        steps = np.diff(solution.t) * (own.rate[1:] + own.rate[:-1]) / 2
        assert np.abs(np.diff(own.value) - steps).max() < 1e-2, name
    assert solution.motion("A:turn").value[-1] - solution.motion("A:turn").value[
        0
    ] == pytest.approx(-3 * math.tau, abs=1e-9)
    assert solution.motion("B").value[-1] == pytest.approx(solution.motion("B").value[0], abs=1e-9)


def test_a_point_that_slides_off_its_link_is_noted():
    """By a screw as by a slide; and by its motion, where no section tells."""
    m = SpatialMechanism("off")
    beam, nut = m.link("beam", length=0.5, mass=1.0), m.link("nut", length=0.05, mass=0.2)
    m.revolute("A", m.ground, beam, axis=(0, 0, 1))
    m.screw("N", beam.at(0.4), nut, axis=(1, 0, 0), lead=0.1)
    scene = Scene(
        m, {"A": motion.polynomial(0.1), "N": motion.polynomial(0.0, math.tau)}, t=(0, 2, 5)
    )
    for wanted in (["all"], ["motion"]):
        (told,) = evaluate(scene, wanted=wanted).notes
        assert told.startswith("joint 'N' leaves link 'beam' at t = 1.5 s (xi/l from 0.8 to 1.2)")
