"""The record of a scene that was declared here: its description, and where its bodies are at its
first instant.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

import casadi as ca
import numpy as np

from ...base.arrays import Array
from ...base.interpret import INFIX, Arithmetic, codes, interpret
from ...errors import DeclarationError
from ...model.description import BodyNumbers, JointNumbers
from ...model.scene import Scene
from ...results.solution import Solution
from ...studies.evaluate import evaluate
from .file_frames import Frame, turned
from .motion_texts import ONE_NUMBER, LawError, parsed
from .record import Body, Joint, Law, Model, slender

SAMPLES = 1001
"""Instants of a motion that has no expression, as one from measured points."""


_SHORTER = {
    **dict.fromkeys((ca.OP_POW, ca.OP_CONSTPOW), "{0} ^ {1}"),
    ca.OP_SQ: "{0} ^ 2",
    ca.OP_TWICE: "2 * {0}",
    ca.OP_INV: "1 / {0}",
}
"""Operations that a law writes by its own signs."""

_TEXT = Arithmetic(
    repr,
    {code: f"({words})".format for code, words in (INFIX | _SHORTER).items()}
    | {code: f"{name}({{}})".format for code, name in codes(ONE_NUMBER).items()},
)
"""Graphs as texts."""


def model_of(scene: Scene, parameters: Mapping[str, float], file: Path) -> Model:
    """Return the record of a scene for values of parameters; what it has no word for is in its
    notes.

    Raises :class:`.DeclarationError` where what moves the mechanism has no word: a constraint, or a
    motion of a path's point.
    """
    start, stop = scene.span
    solution = evaluate(
        scene, t=(start, start, 1), wanted=["motion"], parameters=parameters, backend="vm"
    )
    described = solution.description
    model = Model(described.name, file, span=(start, stop, 101 if stop > start else 1))
    what = f"mechanism '{model.name}'"
    for name in (*described.constraints, *described.rows):
        raise DeclarationError(f"{what}: constraint '{name}' cannot be written into a model file")
    if described.loads:
        model.notes.append(f"Loads are not exported: {', '.join(described.loads)}.")
    model.gravity = np.array(described.gravity)
    for name, body in described.bodies.items():
        model.bodies[name] = _body(name, body, _frame(solution, name), described.space)
        if body.density is not None and model.bodies[name].rod is None:
            model.notes.append(
                f"The mass of '{name}' is exported as a total, without its distribution along"
                " the link."
            )
    for name, joint in described.joints.items():
        model.joints[name] = _joint(name, joint)
    known = model.coordinates
    values = ca.DM(list(scene.values(parameters).values()))
    laws = scene.prescribed
    for k, name in enumerate(laws.joints):
        if name not in known:
            raise DeclarationError(
                f"{what}: the motion of '{name}' cannot be written into a model file"
            )
        t = ca.SX.sym("t")
        motion = ca.densify(laws.motion(t, values)[0][k])
        if model.joints[name.partition(":")[0]].kind == "universal":
            # Its turns are counted from the reference posture, which is that at the start.
            motion = motion - ca.substitute(motion, t, start)
        model.motions[name] = _law(ca.Function("law", [t], [motion]), model.span)
    if scene.drives is not None:
        model.drives = list(scene.drives)
    return model


def _frame(solution: Solution, body: str) -> Frame:
    """Return where a body is at the first instant."""
    pose = solution.pose(body)
    place = np.array([pose.x[0], pose.y[0], 0.0 if pose.z is None else pose.z[0]])
    if pose.axes is not None:
        return Frame(place, pose.axes[0].T)
    angle = 0.0 if pose.angle is None else float(pose.angle[0])
    return Frame(place, turned([0.0, 0.0, angle]))


def _body(name: str, body: BodyNumbers, frame: Frame, space: bool) -> Body:
    whole = body.whole
    if body.length is None:
        return Body(name, whole.mass, frame=frame, point=True)
    if (
        body.density is not None
        and [*map(len, body.density.cells)] == [1]
        and not any(one.mass for one in body.slices)
    ):
        rod = np.zeros(3), np.array([body.length, 0.0, 0.0])
        return Body(name, whole.mass, *slender(whole.mass, *rod), frame, rod=rod)
    inertia: Array = np.array(whole.inertia)
    if body.density is None and not space:
        # In a plane one moment is given; two more that a body may have.
        inertia[0, 0] = inertia[1, 1] = inertia[2, 2] / 2.0
    return Body(name, whole.mass, np.array(whole.centre), inertia, frame)


def _joint(name: str, numbers: JointNumbers) -> Joint:
    """Return a joint, the frames so that its coordinates are those that were declared."""
    (u, v, w), zero = np.array(numbers.triad), np.array(numbers.turned).T
    kind, parent, child = numbers.kind, numbers.parent, numbers.child
    # Slides and turns are about z of a frame; of three of a kind about x, y and z.
    near = np.column_stack((u, v, w) if kind in ("spherical", "free") else (v, w, u))
    far = zero.T @ (np.column_stack([w, u, v]) if kind == "universal" else near)
    frames = Frame(np.array(parent.at), near), Frame(np.array(child.at), far)
    return Joint(name, kind, parent.body, child.body, *frames, numbers.pitch * math.tau)


def _law(law: ca.Function, span: tuple[float, float, int]) -> Law:
    """Return a motion as text, or as samples where it has none."""
    with suppress(DeclarationError, LawError):
        ((text,),) = interpret(law, [["t"]], _TEXT)
        parsed(text)
        return Law(text)
    times = np.linspace(span[0], span[1], SAMPLES)
    values: Array = law(times[None, :]).full()[0]
    return Law(samples=(tuple(times.tolist()), tuple(values.tolist())))
