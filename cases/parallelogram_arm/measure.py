"""Make up what is measured on an arm that differs from its drawing: `run.csv` and `check.csv`.

python cases/parallelogram_arm/measure.py
"""

from pathlib import Path

import numpy as np

from lagrange_casadi import Scene, evaluate, load_case
from lagrange_casadi.motion import harmonic

HERE = Path(__file__).parent

TRUTH = {"m_upper": 2.3, "h_upper": 0.42, "J_upper": 0.14, "m_fore": 1.8, "h_fore": 0.18}
TRUTH |= {"J_fore": 0.075, "h_crank": 0.03, "J_crank": 0.005, "k_balance": 330.0}
TRUTH |= {"viscous_shoulder": 0.8, "dry_shoulder": 0.9, "viscous_motor": 0.6, "dry_motor": 0.4}
"""Parameters of the arm that is measured."""

ANGLE, TORQUE = 0.002, 0.05
"""Standard deviations of the noise [deg, N m]."""

COUNT = 401


def measured(scene: Scene, seed: int) -> str:
    """Return what encoders and torque sensors say along the motion of a scene, as CSV."""
    solution = evaluate(scene, parameters=TRUTH)
    noise = np.random.default_rng(seed)
    heads, columns, formats = ["t [ms]"], [1000.0 * solution.t], ["%.0f"]
    for joint in scene.laws:
        heads.append(f"{joint} [deg]")
        columns.append(np.degrees(solution.array(f"motion:{joint}")))
        columns[-1] += ANGLE * noise.standard_normal(COUNT)
        formats.append("%.3f")
    for joint in scene.laws:
        heads.append(f"effort:{joint} [N m]")
        columns.append(solution.effort(joint) + TORQUE * noise.standard_normal(COUNT))
        formats.append("%.3f")
    lines = (",".join(formats) % row for row in zip(*columns, strict=True))
    return "\n".join([",".join(heads), *lines]) + "\n"


def records() -> dict[str, str]:
    """Return the files by name: one along the motion of the case, and one along another."""
    scene = load_case(HERE).scene
    motion = {"shoulder": harmonic(1.2, 0.35, 0.6), "motor": harmonic(3.4, 0.3, 0.9)}
    other = Scene(scene.mechanism, motion, t=(0, 4, COUNT), posture=scene.posture)
    return {"run.csv": measured(scene, 1), "check.csv": measured(other, 2)}


if __name__ == "__main__":
    for name, text in records().items():
        (HERE / name).write_text(text)
