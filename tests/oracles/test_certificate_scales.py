"""What a residual is large beside: right results pass, however light, small, far or loaded; a wrong
number fails all the same.
"""

import math

import casadi as ca
import kinds
import numpy as np
import pytest
from declarations import declaration
from extremes import slider_crank
from internals import Output, certify
from mechanisms import far

from lagrange_casadi import Mechanism, Scene, evaluate
from lagrange_casadi.motion import harmonic, polynomial

MILLIONTH = 1.0 + 1e-6


def scissors():
    """Five stages of links of a microgram under a meganewton on either side."""
    return kinds.lift(5, 1e-9, 1.0, (1e6, 1e6), 61)


def pendulum(mass=1e-9, load=1e6):
    """A link under a force, driven."""
    m = Mechanism("pendulum")
    link = m.link("link", length=1.0, mass=mass)
    m.revolute("O", m.ground, link)
    m.force("load", link.at(0.7), x=load * ca.sin(7.0 * m.time), y=-load)
    return Scene(m, {"O": harmonic(0.3, 1.0, 1.0)}, t=(0.0, 1.0, 61))


def sprung(stiffness=1e10, gap=1e-7):
    """A stiff spring between points that nearly coincide."""
    m = Mechanism("sprung")
    link = m.link("link", length=1.0, mass=1.0)
    m.revolute("O", m.ground, link)
    m.spring(
        "spring",
        m.ground.at(math.cos(0.3) - gap, math.sin(0.3) + gap),
        link.tip,
        stiffness=stiffness,
        length=0.0,
    )
    return Scene(m, {"O": harmonic(0.3, 1e-6, 1.0, 0.1)}, t=(0.0, 1.0, 61))


def falling():
    """Driven as it would fall: nothing is needed but rounding."""
    m = Mechanism("falling")
    m.prismatic("way", m.ground, m.point_mass("stone", 1.0), axis=(0.6, 0.8))
    m.prismatic("down", m.ground.at(1, 0), m.point_mass("other", 3.0), axis=(0.0, 1.0))
    return Scene(
        m,
        {"way": polynomial(0.1, 0.3, 0.1), "down": polynomial(0.1, 0.3, -9.81 / 2)},
        t=(0.0, 1.0, 61),
    )


def flywheel(gravity):
    """A link that spins fast about its middle."""
    m = Mechanism("flywheel")
    m.set_gravity(0.0, -gravity)
    link = m.link("link", length=0.3, mass=2.0)
    m.revolute("O", m.ground.at(0.1, 0.2), link.at(0.15))
    return Scene(m, {"O": polynomial(0.1, 1e4)}, t=(0.0, 0.1, 61))


RIGHT = {
    "five light stages under 1 MN": (scissors, {}),
    "a link of 1e-9 kg under 1 MN": (lambda: pendulum(), {}),
    "a link of 1e-200 kg": (lambda: pendulum(1e-200, 1e-199), {}),
    "a link of 1e200 kg": (lambda: pendulum(1e200, 1e6), {}),
    "a spring of 1e10 N/m": (lambda: sprung(), {}),
    "a fall": (falling, {}),
    "a flywheel": (lambda: flywheel(9.81), {}),
    "a flywheel without weight": (lambda: flywheel(0.0), {}),
    "a crank of a micrometre, a rod of a kilometre": (slider_crank, {"r": 1e-6, "l": 1e3}),
    "a crank of 1e-310 m": (slider_crank, {"r": 1e-310}),
    "all of 1e-310 kg": (slider_crank, {"m1": 1e-310, "m2": 1e-310, "m3": 1e-310}),
}


@pytest.mark.sampled(9)
@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize("name", RIGHT)
def test_what_is_right_passes(name, precision):
    """And does not come near what fails."""
    made, parameters = RIGHT[name]
    if precision == "single" and "200 kg" in name:
        pytest.skip("singles end at 1e38")
    scene = made()
    solution = evaluate(
        scene,
        parameters=parameters,
        precision=precision,
        backend="c" if precision == "single" else "vm",
    )
    assert solution.certified
    found = {
        name: float(values.max())
        for name, values in solution.certificate.items()
        if name != "condition"
    }
    assert max(found.values()) < solution.tolerance / 10, found


def test_far_from_the_origin_right_results_pass():
    """Where reported places leave less than the tolerance."""
    assert evaluate(far(1e7, load=1e5), backend="vm").certified


def wrong(scene, solution, name):
    """The largest residuals of a solution with one output that is off by a millionth."""
    values = solution.series[name] * MILLIONTH
    residuals = certify(
        solution, declaration(scene, scene.mechanism.values(None)), {Output.of(name): values}
    )
    return {residual: float(gaps.max()) for residual, gaps in residuals.items()}


WRONG = {
    "lift, effort": (scissors, "effort:slide", "power"),
    "lift, reaction": (scissors, "reaction:M2:fx", "balance"),
    "lift, section": (scissors, "section:a1:law:f0", "ends"),
    "light, effort": (pendulum, "effort:O", "power"),
    "light, load": (pendulum, "load:load:fx", "balance"),
    "light, section": (pendulum, "section:link:load:n", "ends"),
    "lightest, effort": (lambda: pendulum(1e-200, 1e-199), "effort:O", "power"),
    "lightest, reaction": (lambda: pendulum(1e-200, 1e-199), "reaction:O:fy", "balance"),
    "heaviest, effort": (lambda: pendulum(1e200, 1e6), "effort:O", "power"),
    "stiff, spring": (sprung, "load:spring:fx", "power"),
    "stiff, effort": (sprung, "effort:O", "balance"),
    "flywheel, reaction": (lambda: flywheel(9.81e6), "reaction:O:fy", "balance"),
    "slider-crank, reaction": (slider_crank, "reaction:A:fy", "balance"),
    "slider-crank, effort": (slider_crank, "effort:O", "power"),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_millionth_fails(name):
    made, output, residual = WRONG[name]
    scene = made()
    solution = evaluate(scene, backend="vm")
    assert solution.certified
    assert 1e-9 < wrong(scene, solution, output)[residual] < 1e-5


@pytest.mark.sampled(7)
@pytest.mark.parametrize("kind", kinds.KINDS, ids=[kind.__name__ for kind in kinds.KINDS])
def test_a_millionth_of_any_large_force_fails(kind):
    """Of every one that is no less than a hundredth of the largest reaction."""
    scene = kinds.closing(kind, [2, 0])
    solution = evaluate(scene, backend="vm")
    peaks = {name: np.max(np.abs(values)) for name, values in solution.series.items()}
    largest = max(peak for name, peak in peaks.items() if name.startswith("reaction:"))
    forces = [
        name
        for name in peaks
        if name.startswith(("effort:", "reaction:", "load:")) and peaks[name] > largest / 100
    ]
    assert len(forces) > 4
    for name in forces:
        assert max(wrong(scene, solution, name).values()) > 1e-9, name
