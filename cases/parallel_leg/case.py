"""A leg whose knee and ankle are driven by parallel rods, as ``new --from leg.urdf`` writes it; the
motions are added.
"""

from lagrange_casadi import Scene, SpatialMechanism
from lagrange_casadi.motion import harmonic


def scene() -> Scene:
    m = SpatialMechanism("parallel_leg")
    mass_left_crank = m.parameter("mass_left_crank", 0.18, "kg", low=0.0)
    mass_left_rod = m.parameter("mass_left_rod", 0.12, "kg", low=0.0)
    hip_z = m.parameter("hip_z", 0.85, "m")
    knee_z = m.parameter("knee_z", 0.47, "m")
    pitch_z = m.parameter("pitch_z", 0.11, "m")
    knee_pin_x = m.parameter("knee_pin_x", 0.06, "m")
    knee_pin_y = m.parameter("knee_pin_y", 0.06, "m")
    left_motor_y = m.parameter("left_motor_y", 0.045, "m")
    left_motor_z = m.parameter("left_motor_z", 0.36, "m")
    left_swing_x = m.parameter("left_swing_x", 0.05, "m")
    at_hip = (0.0, 0.0, hip_z)
    at_knee = (0.0, 0.0, knee_z)
    at_pitch = (0.0, 0.0, pitch_z)
    at_knee_pin = (-knee_pin_x, knee_pin_y, hip_z)
    at_left_motor = (0.0, left_motor_y, left_motor_z)
    at_left_swing = (-left_swing_x, left_motor_y, left_motor_z)
    at_right_motor = (0.0, -left_motor_y, left_motor_z)
    at_right_swing = (-left_swing_x, -left_motor_y, left_motor_z)
    at_knee_lever = (-knee_pin_x, knee_pin_y, knee_z)
    at_left_ball = (-left_swing_x, left_motor_y, pitch_z)
    at_right_ball = (-left_swing_x, -left_motor_y, pitch_z)
    thigh = m.link(
        "thigh",
        between=(at_hip, at_knee),
        mass=4.2,
        centre=(0.0, 0.0, 0.66),
        inertia=(0.05824, 0.058835, 0.005075),
    )
    shank = m.link(
        "shank",
        between=(at_knee, at_pitch),
        mass=2.1,
        centre=(0.0, 0.0, 0.3),
        inertia=(0.02863, 0.02863, 0.00126),
    )
    cross = m.link(
        "cross",
        between=(at_pitch, (0.079, 0.0, pitch_z)),
        mass=0.15,
        centre=(0.0, 0.0, 0.11),
        inertia=(2.25e-05, 2.25e-05, 2.25e-05),
    )
    foot = m.link(
        "foot",
        between=(at_pitch, at_left_ball),
        mass=0.9,
        centre=(0.04, 0.0, 0.06),
        inertia=(0.0005475, 0.0036975, 0.00411),
    )
    knee_crank = m.link(
        "knee_crank",
        between=(at_hip, at_knee_pin),
        mass=0.25,
        centre=(-0.03, 0.06, 0.85),
        inertia=(2.34375e-05, 0.000152083, 0.000138021),
    )
    knee_rod = m.link(
        "knee_rod",
        between=(at_knee_pin, at_knee_lever),
        mass=0.3,
        centre=(-0.06, 0.06, 0.66),
        inertia=(0.00362, 0.00362, 2e-05),
    )
    left_crank = m.link(
        "left_crank",
        between=(at_left_motor, at_left_swing),
        mass=mass_left_crank,
        centre=(-0.025, 0.045, 0.36),
        inertia=(1.2e-05, 7.95e-05, 7.95e-05),
    )
    left_yoke = m.link(
        "left_yoke",
        between=(at_left_swing, (0.029, left_motor_y, left_motor_z)),
        mass=0.0,
        centre=(-0.05, 0.045, 0.36),
        inertia=(0.0, 0.0, 0.0),
    )
    left_rod = m.link(
        "left_rod",
        between=(at_left_swing, at_left_ball),
        mass=mass_left_rod,
        centre=(-0.05, 0.045, 0.235),
        inertia=(0.00062644, 0.00062644, 2.88e-06),
    )
    right_crank = m.link(
        "right_crank",
        between=(at_right_motor, at_right_swing),
        mass=mass_left_crank,
        centre=(-0.025, -0.045, 0.36),
        inertia=(1.2e-05, 7.95e-05, 7.95e-05),
    )
    right_yoke = m.link(
        "right_yoke",
        between=(at_right_swing, (0.029, -left_motor_y, left_motor_z)),
        mass=0.0,
        centre=(-0.05, -0.045, 0.36),
        inertia=(0.0, 0.0, 0.0),
    )
    right_rod = m.link(
        "right_rod",
        between=(at_right_swing, at_right_ball),
        mass=mass_left_rod,
        centre=(-0.05, -0.045, 0.235),
        inertia=(0.00062644, 0.00062644, 2.88e-06),
    )
    m.revolute("hip", m.ground, thigh, axis=(0.0, 1.0, 0.0), at=at_hip)
    m.revolute("knee", thigh, shank, axis=(0.0, 1.0, 0.0), at=at_knee)
    m.revolute("pitch", shank, cross, axis=(0.0, 1.0, 0.0), at=at_pitch)
    m.revolute("roll", cross, foot, axis=(1.0, 0.0, 0.0), at=at_pitch)
    m.revolute("knee_motor", thigh, knee_crank, axis=(0.0, 1.0, 0.0), at=at_hip)
    m.revolute("knee_pin", knee_crank, knee_rod, axis=(0.0, 1.0, 0.0), at=at_knee_pin)
    m.revolute("left_motor", shank, left_crank, axis=(0.0, 1.0, 0.0), at=at_left_motor)
    m.revolute("left_swing", left_crank, left_yoke, axis=(0.0, 1.0, 0.0), at=at_left_swing)
    m.revolute("left_tilt", left_yoke, left_rod, axis=(1.0, 0.0, 0.0), at=at_left_swing)
    m.revolute("right_motor", shank, right_crank, axis=(0.0, 1.0, 0.0), at=at_right_motor)
    m.revolute("right_swing", right_crank, right_yoke, axis=(0.0, 1.0, 0.0), at=at_right_swing)
    m.revolute("right_tilt", right_yoke, right_rod, axis=(1.0, 0.0, 0.0), at=at_right_swing)
    m.revolute("knee_lever", knee_rod, shank, axis=(0.0, 1.0, 0.0), at=at_knee_lever)
    m.spherical("left_ball", left_rod, foot, at=at_left_ball)
    m.spherical("right_ball", right_rod, foot, at=at_right_ball)
    laws = {
        "hip": harmonic(-0.2, 0.35, 1.0),
        "knee_motor": harmonic(0.3, 0.3, 1.0, 0.8),
        "left_motor": harmonic(0.0, 0.25, 1.0, 1.6),
        "right_motor": harmonic(0.0, 0.25, 1.0, 2.0),
    }
    return Scene(m, laws, t=(0.0, 1.0, 201), wanted=["effort", "reaction", "motion"])
