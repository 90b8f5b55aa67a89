"""Andrews' squeezer: seven bodies, three loops that share a pin, one drive, a spring.

No gravity.
"""

from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.motion import polynomial

M1, M2, M3, M4, M5, M6, M7 = 0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498
I1, I2, I3, I4, I5, I6, I7 = 2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5
XA, YA, XB, YB, XC, YC = -0.06934, -0.00227, -0.03635, 0.03273, 0.014, 0.072
D, DA, E, EA, RR, RA = 0.028, 0.0115, 0.02, 0.01421, 0.007, 0.00092
SS, SA, SB, SC, SD = 0.035, 0.01874, 0.01043, 0.018, 0.02
TA, TB, U, UA, UB, ZF, ZT, FA = 0.02308, 0.00916, 0.04, 0.01228, 0.00449, 0.02, 0.04, 0.01421

# At t = 0.03 s of the set's simulation, the instant at which its reference solution is printed.
BETA, BETA_RATE, BETA_ACCELERATION = 15.81077119629904, 1139.920302151208, -24631.76316945196


def scene() -> Scene:
    m = Mechanism("andrews_squeezer")
    m.set_gravity(0, 0)
    # The set's own angles: beta and theta + beta from x; gamma, phi + delta from -y; delta, omega +
    # epsilon, epsilon as said.
    k1 = m.link("k1", length=RR, mass=M1, centre=(RA, 0), inertia=I1)
    k2 = m.link("k2", length=D, mass=M2, centre=(D - DA, 0), inertia=I2)
    k3 = m.link("k3", length=SS, mass=M3, centre=(SB, SA), inertia=I3)
    k4 = m.link("k4", length=E, mass=M4, centre=(E - EA, 0), inertia=I4)
    k5 = m.link("k5", length=ZT, mass=M5, centre=(TA, TB), inertia=I5)
    k6 = m.link("k6", length=ZF, mass=M6, centre=(ZF - FA, 0), inertia=I6)
    k7 = m.link("k7", length=U, mass=M7, centre=(UB, UA), inertia=I7)
    m.revolute("O", m.ground, k1)
    m.revolute("K", k1.tip, k2.tip)
    m.revolute("B", m.ground.at(XB, YB), k3)
    m.revolute("P3", k2, k3.tip)
    m.revolute("A5", m.ground.at(XA, YA), k5)
    m.revolute("H", k5.tip, k4)
    m.revolute("P4", k2, k4.tip)
    m.revolute("A7", m.ground.at(XA, YA), k7)
    m.revolute("G", k7.tip, k6)
    m.revolute("P6", k2, k6.tip)
    m.spring("spring", m.ground.at(XC, YC), k3.at(SC, SD), stiffness=4530.0, length=0.07785)
    return Scene(
        m,
        motion={"O": polynomial(BETA, BETA_RATE, BETA_ACCELERATION / 2)},
        t=(0, 2e-3, 201),
        posture={"k2": 0.05, "k3": -1.53, "k4": -1.58, "k5": 0.5, "k6": 1.58, "k7": -0.52},
    )
