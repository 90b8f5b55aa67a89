"""The certificate of mechanisms in space: at the level of rounding whatever holds the bodies, and
it sees what is wrong.
"""

from dataclasses import replace

import numpy as np
import pytest
from declarations import declaration
from internals import Output, certify
from spatial_solutions import evaluated, residuals

from lagrange_casadi import Scene, SpatialMechanism, evaluate, motion

pytestmark = pytest.mark.usefixtures("interpreted")

WHOLE = {"closure", "balance", "power", "ends"}


def disturbed(solution, name, change):
    """The residuals of a solution one of whose arrays is otherwise."""
    outputs = solution.outputs | {Output.of(name): change(solution.array(name))}
    return residuals(certify(replace(solution, outputs=outputs)))


def off(values):
    return values + 1e-2 * (np.abs(values).max() + 1.0)


WRONG = [
    ("reaction:A:fx", {"balance", "ends"}),
    ("reaction:O:my", {"balance"}),
    ("effort:O", {"balance", "power"}),
    ("load:force0:fz", {"balance", "power"}),
    ("pose:crank:z", {"closure"}),
    ("pose:crank:xy", {"closure"}),
    ("pose:rocker:zz", {"closure"}),
    ("motion:Q", {"closure"}),
    ("motion:Q_rate", {"closure"}),
    ("motion:Q_acceleration", {"closure"}),
    ("motion:B:turn_1", {"closure"}),
    ("motion:B:turn_2_rate", {"closure"}),
    ("motion:B:turn_2_acceleration", {"closure"}),
    *(
        (f"section:coupler:law:{member}", {"ends"})
        for member in ("n0", "fy0", "fz0", "mx0", "my0", "mz0")
    ),
    *(
        (f"section:crank:law:{member}", {"ends"})
        for member in ("n1", "n2", "fy1", "fy2", "fz1", "fz2")
    ),
]


@pytest.mark.parametrize(("name", "wrong"), WRONG, ids=[name for name, _ in WRONG])
def test_what_is_wrong_is_seen(name, wrong):
    """By the residual that says what is wrong; in a four-bar of skew axes, a universal joint closes
    it.
    """
    _, solution = evaluated("rsur", 0)
    found = disturbed(solution, name, off)
    assert all(found[kind] > 1e-5 for kind in wrong), found


def test_mirrored_axes_of_a_bar_are_seen():
    """Nothing but what is reported tells how its cross-section is turned."""
    _, solution = evaluated("suspension", 0)
    axes = {Output("pose", "bar1", f"z{x}"): -solution.array(f"pose:bar1:z{x}") for x in "xyz"}
    found = residuals(certify(replace(solution, outputs=solution.outputs | axes)))
    assert found["closure"] > 0.1


def constrained():
    """A universal joint's turns in proportion, a screw's angle by a point's height, and a spring to
    a point mass on a slide.
    """
    m = SpatialMechanism("constrained")
    arm = m.link("arm", length=0.5, mass=1.0)
    nut = m.link("nut", length=0.1, mass=0.7, centre=(0, 0.02, 0), inertia=(2e-3, 1e-3, 2e-3))
    bead = m.point_mass("bead", 0.3)
    joint = m.universal("U", m.ground, arm, axis=(0, 0, 1), second=(0, 1, 0))
    screw = m.screw("N", m.ground.at(0, 1, 0), nut, axis=(0, 0.6, 0.8), lead=0.05)
    m.prismatic("P", arm, bead, axis=(1, 0, 0))
    m.constraint("tie", m.coordinate(joint, "turn_2") - 0.4 * m.coordinate(joint, "turn_1") - 0.1)
    m.constraint("follow", m.coordinate(screw) - 4.0 * m.place(arm.tip)[2] - m.time)
    m.spring("spring", bead, nut.at(0.1, 0, 0), stiffness=50.0, length=0.2, damping=3.0)
    m.torque("twist", arm, x=1.0, z=2.0, turning=True)
    return Scene(
        m,
        {"U:turn_1": motion.polynomial(0.1, 1.0), "P": motion.harmonic(0.3, 0.1, 1.0)},
        t=(0, 1, 21),
        posture={"U:turn_2": 0.2, "N": 0.0},
    )


@pytest.mark.parametrize(
    "name", ["multiplier:tie", "multiplier:follow", "load:twist:mx", "load:spring:fy", "effort:P"]
)
def test_equations_springs_and_point_masses_are_balanced(name):
    scene = constrained()
    solution = evaluate(scene)
    assert set(residuals(solution.certificate)) == WHOLE
    assert max(residuals(solution.certificate).values()) < 1e-13
    hidden = {Output.of(name): off(solution.array(name))}
    assert residuals(certify(solution, declaration(scene, solution), hidden))["balance"] > 1e-5


def hung_on_masses(m):
    """A bar between two point masses on lines, and a force on it: no joint gives its direction's
    rate, and its ends do.
    """
    a, b, bar = m.point_mass("a", 1.0), m.point_mass("b", 2.0), m.link("bar", length=0.5, mass=1.0)
    m.prismatic("P", m.ground, a, axis=(1, 0, 0))
    m.prismatic("Q", m.ground, b, axis=(0.1, 1, 0.2))
    m.spherical("S", a, bar)
    m.spherical("T", bar.tip, b)
    m.force("push", bar.at(0.2), x=3, z=-2)
    return {"P": motion.harmonic(0.2, 0.1, 1.0)}, {"Q": 0.4}


def on_a_mass(m):
    """A link whose base is at a point mass, turned by the link at its tip."""
    a = m.point_mass("a", 1.0)
    b = m.link("b", length=0.5, mass=1.0)
    c = m.link("c", length=0.5, mass=1.0)
    m.prismatic("P", m.ground, a, axis=(1, 0, 0))
    m.spherical("S", a, b)
    m.revolute("R", m.ground.at(0.3, 0.2, 0.1), c, axis=(0, 0, 1))
    m.universal("U", c.tip, b.tip, axis=(0, 0, 1), second=(0, 1, 0))
    return {"P": motion.harmonic(0, 0.1, 1.0)}, {"R": 0.1, "U:turn_1": 0.1, "U:turn_2": 0.1}


def light(m):
    """A link without mass that carries a point mass."""
    a, b = m.link("a", length=0.6, mass=0.0), m.point_mass("b", 2.0)
    m.universal("A", m.ground, a, axis=(0, 0, 1), second=(0, 1, 0))
    m.spherical("B", a.tip, b)
    return {"A": [motion.polynomial(0, 1.0), motion.polynomial(0.2, 0.3)]}, {}


def rolling_arm(m):
    """A link that turns about its own axis, on one that turns about z: of its axis one rate is
    nothing but rounding.
    """
    a, b = m.link("a", length=0.4, mass=1.0), m.link("b", length=0.3, mass=0.6)
    m.revolute("A", m.ground, a, axis=(0, 0, 1))
    m.revolute("B", a.tip, b, axis=(1, 0, 0))
    return {"A": motion.polynomial(0.1, 0.3), "B": motion.polynomial(0.0, 2.0)}, {}


@pytest.mark.parametrize("declare", [hung_on_masses, on_a_mass, light, rolling_arm])
def test_whatever_holds_the_bodies(declare):
    m = SpatialMechanism(declare.__name__)
    laws, posture = declare(m)
    solution = evaluate(Scene(m, laws, t=(0, 1, 11), posture=posture))
    assert set(residuals(solution.certificate)) == WHOLE
    assert max(residuals(solution.certificate).values()) < 1e-14


def test_many_turns_do_not_blur_what_is_judged():
    """A drive of ten million radians, far from the origin: angles have lost seven digits, and their
    phases are known.
    """
    m = SpatialMechanism("many")
    a, b = m.link("a", length=0.6, mass=1.0), m.link("b", length=0.3, mass=1.0)
    m.revolute("A", m.ground.at(5, 6, 7), a, axis=(0, 1, 1))
    m.universal("B", a.tip, b, axis=(0, 0, 1), second=(0, 1, 0))
    laws = {
        "A": motion.polynomial(0, 1e4),
        "B": [motion.polynomial(0, 2e3), motion.polynomial(0, 1e3)],
    }
    solution = evaluate(Scene(m, laws, t=(0, 1000, 101)))
    assert max(residuals(solution.certificate).values()) < 1e-11
    assert solution.certified
