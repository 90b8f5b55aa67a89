"""Identify a master arm of the da Vinci Research Kit from its published records.

    git clone https://github.com/WPI-AIM/dvrk_dynamics_identification
    python -m benchmarks.dvrk dvrk_dynamics_identification

The records have no licence, so they are not part of this project: they are read in the clone. The
dimensions, the coupling, the cable's torque and the spring are those of `main_mtm.ipynb` there. The
paper: Wang, Gondokaryono, Munawar, Fischer, *A convex optimization-based dynamic model
identification package for the da Vinci Research Kit*, IEEE RA-L 4, 2019, arXiv 1902.10875.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
from scipy.signal import butter, filtfilt

from lagrange_casadi import Measurements, Scene, SpatialMechanism, identify
from lagrange_casadi.base.arrays import Array
from lagrange_casadi.motion import polynomial
from lagrange_casadi.studies.identification import Comparison
from lagrange_casadi.studies.identification.measurements import filtered as low_passed

RATE = 200.0
"""Rows a second."""

BASE, UPPER, CRANK, FORE, WRIST = 0.2154, 0.2794, 0.1, 0.3645, 0.151
"""Height of the base, and lengths of the upper arm, the crank, the forearm and the wrist [m]."""

COUPLING = 0.6697
"""Angle of joint 4 for one of joints 2 and 3, by its tendons."""

CABLE = (0.0004877, -0.0037149, 0.0067497, 0.008519, -0.0201475, -0.025265, 0.048095, 0.00255)
"""Torque of the cable of joint 4, a polynomial of its angle, from the highest power [N m]."""

SPRING, LEVER, REST, OFFSET = 0.0075, 0.1035, 0.0613, np.radians(23.0)
"""Spring of joint 5: distances of its ends from the axis, its free length [m], and its angle."""

DRIVES = ("q1", "q2", "q3", "q4", "q5", "q6", "q7")
"""The joints that motors move, in the order of the records."""

TRIM, SHOWN = 1.0, 10.0
"""Seconds that are left out at both ends, and seconds by which the paper judges."""

FILTER = butter(6, 1.8 * 2 * np.pi / RATE)
"""Filter of the paper, there and back, of motion and torques."""

NOISE, CUTOFF = 1.5, 5.0
"""Smoothing without it: noise of angles over what third differences say, and a filter of torques
[Hz].
"""

PUBLISHED = {
    "fitted": (7.9, 15.6, 11.8, 18.6, 24.2, 18.3, 28.0),
    "other": (8.2, 16.3, 19.1, 20.9, 26.3, 23.5, 34.0),
    "fitted, consistent": (8.6, 16.2, 12.5, 18.9, 24.8, 18.1, 28.0),
    "other, consistent": (7.7, 14.9, 17.0, 22.3, 28.0, 23.4, 34.0),
}
"""Differences over measured torques, of root mean squares [%], in `main_mtm.ipynb`: by weighted
least squares, and with parameters that a body can have.
"""


def arm() -> Scene:
    """Declare the arm: seven motors, and a parallelogram from the crank to the forearm."""
    m = SpatialMechanism("dvrk_mtm")

    def link(name: str, length: float, mass: float) -> Any:
        """A rigid link: its mass, first moments and inertias about its base are unknown."""
        w = m.parameter(f"m_{name}", mass, "kg")
        h = [m.parameter(f"h{x}_{name}", 0.1 * mass * length, "kg m") for x in "xyz"]
        j = {
            n: m.parameter(f"J{n}_{name}", 0.1 * mass * length**2 * (n[0] == n[1]), "kg m^2")
            for n in ("xx", "xy", "xz", "yy", "yz", "zz")
        }
        square = sum(x * x for x in h)
        about = tuple(
            tuple(
                j[min(a, b) + max(a, b)] - ((a == b) * square - h[i] * h[k]) / w
                for k, b in enumerate("xyz")
            )
            for i, a in enumerate("xyz")
        )
        return m.link(name, length=length, mass=w, centre=tuple(x / w for x in h), inertia=about)

    def rubs(name: str, joint: Any, axis: tuple[float, float, float]) -> None:
        """Dry and viscous friction, and a constant torque, of a joint about its axis."""
        speed = m.rate(joint)
        dry, viscous, constant = (
            m.parameter(f"{kind}_{name}", 0.01, unit)
            for kind, unit in (("dry", "N m"), ("viscous", "N m s"), ("constant", "N m"))
        )
        torque = -dry * ca.sign(speed) - viscous * speed - constant
        turn(f"friction_{name}", joint, axis, torque)

    def turn(name: str, joint: Any, axis: tuple[float, float, float], torque: Any) -> None:
        x, y, z = (a * torque for a in axis)
        m.torque(name, joint.child, x=x, y=y, z=z, against=joint.parent, turning=True)

    first, upper = link("first", 0.1, 2.0), link("upper", UPPER, 1.0)
    crank, bar, fore = link("crank", CRANK, 0.5), link("bar", UPPER, 0.5), link("fore", FORE, 1.0)
    wrist = link("wrist", WRIST, 0.5)
    pitch, yaw, roll = (link(name, 0.05, 0.2) for name in ("pitch", "yaw", "roll"))
    along, across = (0.0, 0.0, 1.0), (0.0, 1.0, 0.0)
    down = ("x", "-90 deg")
    joints = [
        m.revolute("q1", m.ground.at(0, 0, -BASE), first, axis=along),
        m.revolute("q2", first, upper, axis=across, turned=[down, ("z", "90 deg")]),
        m.revolute("q3", first, crank, axis=across, turned=[down, ("z", "180 deg")]),
        m.revolute("elbow", upper.tip, fore, axis=along, turned=[("z", "90 deg")]),
        m.revolute("rear", crank.tip, bar, axis=along, turned=[("z", "-90 deg")]),
        m.revolute("twist", fore.tip, wrist, axis=across, turned=[down, ("y", "-90 deg")]),
        m.revolute("q5", wrist.tip, pitch, axis=(0, -1, 0), turned=((0, 0, -1), (1, 0, 0))),
        m.revolute("q6", pitch, yaw, axis=across, turned=[down, ("z", "90 deg")]),
        m.revolute("q7", yaw, roll, axis=across, turned=[down, ("z", "180 deg")]),
    ]
    m.revolute("front", bar.tip, fore.at(CRANK), axis=along)
    inertia = m.parameter("J_motor", 1e-4, "kg m^2")
    rotor = m.link("rotor", length=0.01, mass=1e-9, centre=(0, 0, 0), inertia=(inertia,) * 3)
    joints.append(m.revolute("q4", m.ground, rotor, axis=along))
    axes = {"twist": (1.0, 0.0, 0.0)}
    q = {joint.name: m.coordinate(joint) for joint in joints}
    m.constraint("tendons", q["twist"] - COUPLING * (q["q2"] - q["q3"]) - q["q4"])
    for joint in joints:
        if joint.name != "rear":  # it turns as the elbow does
            rubs(joint.name, joint, axes.get(joint.name, along))
    twist, q5 = joints[5], joints[6]
    cable = sum(c * q["twist"] ** k for k, c in enumerate(reversed(CABLE)))
    turn("cable", twist, axes["twist"], -cable)
    bent = ca.pi + OFFSET - q["q5"]
    length = ca.sqrt(SPRING**2 + LEVER**2 - 2 * SPRING * LEVER * ca.cos(bent))
    stiffness = m.parameter("k_spring", 30.0, "N/m")
    pull = stiffness * (length - REST)
    turn("spring", q5, along, pull * SPRING * LEVER * ca.sin(bent) / length)
    still = {name: polynomial(0.0) for name in DRIVES}
    return Scene(m, still, wanted=["effort", "motion"], t=(0, 1, 3), posture={"rear": 0.0})


def filtered(table: Array) -> Measurements:
    """Return a record that is filtered as in the paper."""
    t = np.arange(len(table)) / RATE
    speeds = np.gradient(table[:, 7:14], t, axis=0)
    parts = [filtfilt(*FILTER, part, axis=0) for part in (*np.split(table, 3, axis=1), speeds)]
    ends = ("{}", "{}_rate", "effort:{}", "{}_acceleration")
    columns = {
        end.format(drive): part[:, k]
        for end, part in zip(ends, parts, strict=True)
        for k, drive in enumerate(DRIVES)
    }
    return Measurements(t, columns)


def smoothed(table: Array) -> Measurements:
    """Return angles and torques as they are, and the noise of angles, by which a spline smooths."""
    rough = np.std(np.diff(table[:, :7], 3, axis=0), axis=0) / np.sqrt(20.0)
    columns = dict(zip(DRIVES, table[:, :7].T, strict=True))
    columns |= {f"effort:{drive}": table[:, 14 + k] for k, drive in enumerate(DRIVES)}
    noise = dict(zip(DRIVES, NOISE * rough, strict=True))
    return Measurements(np.arange(len(table)) / RATE, columns, noise)


def row(title: str, compared: Comparison, cutoff: float | None) -> str:
    """Return differences over measured torques, of root mean squares [%], by motor."""
    found = []
    for name in compared.measured:
        both = np.column_stack([compared.measured[name], compared.model[name]])
        known = np.asarray(np.isfinite(both).all(axis=1))
        both = both if cutoff is None else low_passed(compared.t, cutoff, both, known)
        shown = known & (compared.t >= TRIM) & (compared.t < TRIM + SHOWN)
        measured, model = both[shown].T
        found.append(100.0 * float(np.linalg.norm(measured - model) / np.linalg.norm(measured)))
    return f"| {title} | {' | '.join(f'{x:.1f}' for x in found)} |"


def report(clone: Path) -> str:
    """Identify by the first record, and judge by both."""
    folder, scene = clone / "data/mtm/measured_trajectory", arm()
    tables = [np.loadtxt(folder / f"{n}_results.csv", delimiter=",") for n in ("one", "two")]
    rows = ["| record, how smoothed | 1 | 2 | 3 | 4 | 5 | 6 | 7 |", "| --- " * 8 + "|"]
    for words, prepared, cutoff, consistent in (
        ("spline, 5 Hz", smoothed, CUTOFF, False),
        ("as in the paper", filtered, None, False),
        ("as in the paper, consistent", filtered, None, True),
    ):
        first, second = map(prepared, tables)
        found = identify(scene, first, cutoff=cutoff, trim=TRIM, consistent=consistent)
        rows.append(row(f"fitted, {words}", found.comparison, cutoff))
        rows.append(row(f"other, {words}", found.validate(second, TRIM), cutoff))
    for name, numbers in PUBLISHED.items():
        rows.append(f"| {name}, published | {' | '.join(map(str, numbers))} |")
    return "\n".join([f"{len(found.base)} of {len(found.values)} parameters", "", *rows])


if __name__ == "__main__":
    print(report(Path(sys.argv[1])))
