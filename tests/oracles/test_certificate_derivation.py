"""A derivation that is wrong throughout, so that all of its results agree with each other, fails
the certificate all the same.
"""

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from every_load import every_joint_and_load
from internals import assembly, cache, sampled_laws
from mechanisms import pins_of

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, evaluate, motion
from lagrange_casadi.errors import CertificateWarning

pytestmark = pytest.mark.usefixtures("interpreted")


def arm_in_space():
    """A turning link with loads on its own axes."""
    m = SpatialMechanism("arm")
    arm = m.link("arm", length=0.5, mass=2.0)
    m.revolute("O", m.ground, arm, axis=(0.0, 0.6, 0.8))
    m.force("follow", arm.tip, x=3.0, y=20.0, z=5.0, turning=True)
    m.torque("twist", arm, x=4.0, y=-7.0, z=2.0, turning=True)
    m.line_load(
        "wind", arm, x=2.0, y=(3.0, -9.0), z=lambda x: 1.0 + 30.0 * x**2, between=(0.1, 0.4)
    )
    return Scene(m, {"O": motion.polynomial(0.3, 7.0, 2.0)}, t=(0.0, 0.9, 7))


def tool_on_a_path():
    """A point whose place is given, and a body whose direction is."""
    m = Mechanism("tool")
    near, far = (m.link(name, length=0.6, mass=1.0) for name in ("near", "far"))
    pins_of(m, A=(m.ground, near), B=(near.tip, far))
    m.path("tool", far.tip)
    law = motion.harmonic(0.7, 0.1, 2.0), motion.harmonic(0.2, 0.1, 2.0, 0.5)
    return Scene(
        m, {"tool": law}, drives=["A", "B"], t=(0.0, 0.5, 7), posture={"near": 1.2, "far": -0.9}
    )


def loads(name, change):
    """Derive with another load of a name than was declared."""

    def patch(monkeypatch):
        applied_by = assembly.applied_by

        def wrong(load, resting):
            return applied_by(change(load) if load.name == name else load, resting)

        monkeypatch.setattr(assembly, "applied_by", wrong)

    return patch


def times(load, *factors):
    """A load with other components."""
    pairs = zip(factors, load.components, strict=True)
    return replace(load, components=tuple(factor * one for factor, one in pairs))


def law(change):
    """Derive with another motion than was declared."""

    def patch(monkeypatch):
        right = sampled_laws.Laws.of

        def wrong(given, parameters):
            found = right(given, parameters)
            t, p = found.motion.sx_in()
            names = found.motion.name_in(), found.motion.name_out()
            changed = change(*found.motion(t, p))
            return replace(found, motion=ca.Function("motion", [t, p], changed, *names))

        monkeypatch.setattr(sampled_laws.Laws, "of", wrong)

    return patch


WRONG = {
    "spring, its sign": (
        every_joint_and_load,
        loads("spring", lambda one: replace(one, stiffness=-one.stiffness)),
        "balance",
    ),
    "spring, its free length": (
        every_joint_and_load,
        loads("spring", lambda one: replace(one, length=0.0)),
        "balance",
    ),
    "damper, a factor": (
        every_joint_and_load,
        loads("spring", lambda one: replace(one, damping=one.damping * 1.001)),
        "balance",
    ),
    "force, its sign": (
        every_joint_and_load,
        loads("push", lambda one: times(one, 1, -1, 1)),
        "balance",
    ),
    "force, its axes": (
        every_joint_and_load,
        loads("follow", lambda one: replace(one, turning=not one.turning)),
        "balance",
    ),
    "torque, a factor": (
        every_joint_and_load,
        loads("couple", lambda one: times(one, 1, 1, 0.5)),
        "balance",
    ),
    "line load, its ends": (
        every_joint_and_load,
        loads("wind", lambda one: replace(one, y=one.y[::-1])),
        "balance",
    ),
    "friction, a factor": (
        every_joint_and_load,
        loads("pin", lambda one: replace(one, symbol=one.symbol / 2)),
        "balance",
    ),
    "force in space": (
        arm_in_space,
        loads("follow", lambda one: times(one, 1, 1, -1)),
        "balance",
    ),
    "torque in space": (
        arm_in_space,
        loads("twist", lambda one: replace(one, turning=False)),
        "balance",
    ),
    "line load in space": (
        arm_in_space,
        loads("wind", lambda one: replace(one, z=(*one.z[:2], 2 * one.z[2]))),
        "balance",
    ),
    "motion": (
        every_joint_and_load,
        law(lambda d, rate, change: [d * 1.001, rate * 1.001, change * 1.001]),
        "closure",
    ),
    "motion, its rate": (
        arm_in_space,
        law(lambda d, rate, change: [d, rate / 2, change]),
        "closure",
    ),
    "motion, its acceleration": (
        arm_in_space,
        law(lambda d, rate, change: [d, rate, change / 2]),
        "closure",
    ),
    "motion of a point": (
        tool_on_a_path,
        law(lambda d, rate, change: [d, rate * 1.001, change]),
        "closure",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_derivation_is_noticed(name, monkeypatch):
    made, patch, residual = WRONG[name]
    monkeypatch.setattr(cache, "read", lambda _: None)
    monkeypatch.setattr(cache, "write", lambda *_: None)
    patch(monkeypatch)
    with pytest.warns(CertificateWarning):
        solution = evaluate(made())
    assert residual in solution.failed
    # What the residual is of the largest force is a part of each force that may be wrong.
    effort = next(name for name in solution.names() if name.startswith("effort"))
    off = solution.errors[effort] / abs(solution.peak(effort).value)
    balance = np.max(solution.certificate["balance"])
    assert residual == "closure" or (off == pytest.approx(balance) and off > 1e-6)


@pytest.mark.parametrize("precision", ["double", "single"])
def test_a_law_that_jumps_may_be_on_either_side(precision):
    """Where rounding decides, as of a stop that is met exactly at an instant, and of a rest."""
    m = Mechanism("stop")
    arm = m.link("arm", length=0.7, mass=1.0)
    joint = m.revolute("O", m.ground, arm)
    x, _ = m.place(arm.tip)
    m.force("stop", arm.tip, x=ca.if_else(x < 0.7 * ca.cos(0.3), 90.0, 0.0))
    m.torque("brake", arm, -5.0 * ca.sign(m.rate(joint)))
    m.torque("late", arm, ca.if_else(m.time > 0.3, 4.0, 0.0))
    scene = Scene(m, {"O": motion.harmonic(0.0, 0.3, 2.5)}, t=(0.0, 0.4, 17))
    assert evaluate(
        scene, precision=precision, backend="c" if precision == "single" else "vm"
    ).certified
