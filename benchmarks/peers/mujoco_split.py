"""Section forces by MuJoCo: the rod's pieces are bodies without a joint, so welded, whose
``cfrc_int`` are the section's forces.
"""

from __future__ import annotations

from itertools import pairwise

import mujoco
import numpy as np

from .paper_case import Array, SliderCrank, Work
from .split_rod import close_loop, joint_motion


def sections(case: SliderCrank, t: Array, xi: Array) -> Work:
    """What works out axial, shear and bending of the rod, (3, t, xi), by a loop over the instants.

    Only what ``mj_rnePostConstraint`` reads is run before it, which takes three quarters of the
    time of ``mj_inverse`` and it. The guide is no constraint of MuJoCo's, which are soft. One model
    with a cut at every ratio costs a body a point. ``xi`` ascends strictly within 0 < xi < 1: a
    piece has a mass.
    """
    motion = joint_motion(case, t)
    model = _model(case, xi)
    data = mujoco.MjData(model)
    crank, rod = model.body("O").id, model.body("A").id
    pieces = slice(rod, rod + 1 + len(xi))

    def work() -> Array:
        wrench, place = np.empty((len(t), 1 + len(xi), 6)), np.empty((len(t), 1 + len(xi), 3))
        centre = np.empty((len(t), 1, 3))
        q, v, a = data.qpos, data.qvel, data.qacc
        wrench_now, place_now, centre_now = (
            data.cfrc_int[pieces],
            data.xpos[pieces],
            data.subtree_com[crank],
        )
        for i, (q_i, v_i, a_i) in enumerate(zip(*motion, strict=True)):
            q[:], v[:], a[:] = q_i, v_i, a_i
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            mujoco.mj_comVel(model, data)
            mujoco.mj_rnePostConstraint(model, data)
            wrench[i], place[i], centre[i] = wrench_now, place_now, centre_now
        phi = motion[0].sum(axis=1)[:, None]
        fx, fy, arm = (
            wrench[..., 3],
            wrench[..., 4],
            place - centre,
        )  # moments are about the tree's centre of mass
        moment = wrench[..., 2] - arm[..., 0] * fy + arm[..., 1] * fx
        along, across = np.cos(phi) * fx + np.sin(phi) * fy, np.cos(phi) * fy - np.sin(phi) * fx
        return close_loop(
            case, motion[0], xi, moment[:, 0], np.stack([along, across, moment])[:, :, 1:]
        )

    return work


def _model(case: SliderCrank, xi: Array) -> mujoco.MjModel:
    spec = mujoco.MjSpec()
    spec.option.gravity = [0.0, -case.g, 0.0]
    body = _bar(spec.worldbody, "O", 0.0, case.m1, case.r)
    reach = case.r
    for k, (start, stop) in enumerate(pairwise([0.0, *xi, 1.0])):
        length = case.l * (stop - start)
        body = _bar(body, f"section{k}" if k else "A", reach, case.m2 * (stop - start), length)
        reach = length
    for pin in ("O", "A"):
        spec.body(pin).add_joint(type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0, 0, 1])
    body.add_body(
        pos=[reach, 0, 0], mass=case.m3, ipos=[0, 0, 0], inertia=[0, 0, 0], explicitinertial=True
    )
    return spec.compile()


def _bar(parent: mujoco.MjsBody, name: str, x: float, mass: float, length: float) -> mujoco.MjsBody:
    """A bar; its moment is the same about all axes, as MuJoCo wants none of zero and the plane asks
    for one.
    """
    inertia = [mass * length**2 / 12] * 3
    return parent.add_body(
        name=name,
        pos=[x, 0, 0],
        mass=mass,
        ipos=[length / 2, 0, 0],
        inertia=inertia,
        explicitinertial=True,
    )
