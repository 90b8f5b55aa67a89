"""An arm whose second motor sits at the base and moves the forearm by a parallelogram."""

import casadi as ca

from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.model.declared_parts import Link
from lagrange_casadi.motion import Motion, expression

PERIOD = 4.0
"""Seconds in which the motion repeats itself."""

SLOW = 0.02
"""Speed [rad/s] within which dry friction changes its sign."""

# Mean, sines and cosines [rad], as `excite` finds them for the limits in the README.
SHOULDER = (1.21, (-0.14, 0.27, 0.15), (0.13, 0.02, 0.18))
MOTOR = (3.33, (0.01, -0.02, -0.21), (0.04, -0.04, -0.25))


def series(mean: float, sines: tuple[float, ...], cosines: tuple[float, ...]) -> Motion:
    """Return a Fourier series of the time."""

    def law(t: ca.SX) -> ca.SX:
        angle = 2 * ca.pi / PERIOD * t
        terms = zip(sines, cosines, strict=True)
        found = ca.SX(mean)
        for k, (a, b) in enumerate(terms, 1):
            found += a * ca.sin(k * angle) + b * ca.cos(k * angle)
        return found

    return expression(law)


def scene() -> Scene:
    m = Mechanism("parallelogram_arm")

    def body(name: str, length: float, mass: float, moment: float, inertia: float) -> Link:
        """Declare a link by what forces are linear in: its mass, its first moment and its inertia
        about its base.
        """
        w = m.parameter(f"m_{name}", mass, "kg", low=0.0)
        h = m.parameter(f"h_{name}", moment, "kg m")
        j = m.parameter(f"J_{name}", inertia, "kg m^2", low=0.0)
        return m.link(name, length=length, mass=w, centre=(h / w, 0), inertia=j - h**2 / w)

    upper = body("upper", 0.40, 2.0, 0.30, 0.10)
    fore = body("fore", 0.45, 1.5, 0.10, 0.06)
    crank = body("crank", 0.10, 0.6, 0.02, 0.004)
    bar = m.link("bar", length=0.40, mass=0.3)
    shoulder = m.revolute("shoulder", m.ground, upper)
    motor = m.revolute("motor", m.ground, crank)
    m.revolute("elbow", upper.tip, fore.at(0.10))
    m.revolute("rear", crank.tip, bar)
    m.revolute("front", bar.tip, fore)
    k = m.parameter("k_balance", 300.0, "N/m", low=0.0)
    m.spring("balance", m.ground.at(-0.15, 0.25), upper.at(0.2), stiffness=k, length=0.1)
    for joint, link in ((shoulder, upper), (motor, crank)):
        viscous = m.parameter(f"viscous_{joint.name}", 0.5, "N m s", low=0.0)
        dry = m.parameter(f"dry_{joint.name}", 0.5, "N m", low=0.0)
        speed = m.rate(joint)
        friction = viscous * speed + dry * speed / ca.sqrt(speed**2 + SLOW**2)
        m.torque(f"friction_{joint.name}", link, -friction)
    m.path("hand", fore.tip)
    return Scene(
        m,
        {"shoulder": series(*SHOULDER), "motor": series(*MOTOR)},
        t=(0, PERIOD, 401),
        posture={"bar": 1.2, "fore": 0.2},
    )
