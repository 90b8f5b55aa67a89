"""Models of MuJoCo, ``.xml``: compiled by MuJoCo itself, which knows defaults and the inertia of
shapes.

Files that a model names are read in its own folder alone. A body with several joints has bodies
without mass between these.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..base.arrays import Array
from ..errors import MissingPackageError, shown
from .elements import Element, parsed
from .record import GROUND, LARGEST, Body, Coupling, Frame, Joint, Model, turned

if TYPE_CHECKING:
    from types import ModuleType

    import mujoco

_FOLDERS = ("assetdir", "meshdir", "texturedir")
_FILES = ("file", "fileup", "filedown", "filefront", "fileback", "fileleft", "fileright", "content")
_DEEPEST = 20


def read(path: Path, text: str) -> Model:
    """Return the model of a file. Raises :class:`.ModelFileError`, and
    :class:`.MissingPackageError` without MuJoCo.
    """
    model = Model(path.stem, path.name)
    root = parsed(model, text, "mujoco")
    _inside(model, path.parent.resolve(), root, path.parent.resolve(), 0)
    try:
        import mujoco
    except ModuleNotFoundError:
        raise MissingPackageError(
            f"{path.name}: a model of MuJoCo is compiled by MuJoCo: pip install mujoco"
        ) from None
    try:
        compiled = mujoco.MjModel.from_xml_path(str(path))
    except ValueError as error:
        raise model.refuse("", f"MuJoCo refuses it: {error}") from None
    return _Reader(model, compiled, mujoco).read()


def _inside(model: Model, folder: Path, line: Element, base: Path, depth: int) -> None:
    """Raise :class:`.ModelFileError` for a file outside of the folder, and for a number that no
    machine has; included files are read.
    """
    for key, data in line.given.items():
        if any(map(_gigantic, data.split())):
            raise line.refuse(f"{key}: expected numbers of at most {LARGEST:g}, got {shown(data)}")
        if key not in (*_FOLDERS, *_FILES):
            continue
        there = (base / data).resolve()
        if Path(data).is_absolute() or not there.is_relative_to(folder):
            raise line.refuse(f"{key} {shown(data)} leads out of its folder")
        if line.name == "include" and there.is_file():
            if depth > _DEEPEST:
                raise line.refuse("includes are too deep")
            included = there.read_text(encoding="utf-8", errors="replace")
            _inside(model, folder, parsed(model, included, ""), there.parent, depth + 1)
    for one in line.inside:
        _inside(model, folder, one, base, depth)


def _gigantic(word: str) -> bool:
    try:
        return abs(float(word)) > LARGEST and not word.strip("+-").isalpha()
    except ValueError:
        return False


class _Reader:
    """A compiled model under way."""

    def __init__(self, model: Model, compiled: mujoco.MjModel, mujoco: ModuleType) -> None:
        self.model, self.m, self.mujoco = model, compiled, mujoco
        self.data = mujoco.MjData(compiled)
        mujoco.mj_kinematics(compiled, self.data)
        self.bodies: dict[int, str] = {0: GROUND}
        self.joints: dict[int, str] = {}

    def read(self) -> Model:
        """Return the model."""
        model, m = self.model, self.m
        stated = m.names.partition(b"\0")[0].decode(errors="replace")  # its own is the first one
        model.name = model.name_of("mechanism", stated or model.name, "", {})
        model.gravity = m.opt.gravity.copy()
        for k in range(1, m.nbody):
            self.body(k)
        for k in range(m.neq):
            if m.eq_active0[k]:
                self.equality(k)
        kinds = self.mujoco.mjtTrn
        for k in range(m.nu):
            if kinds(int(m.actuator_trntype[k])) in (kinds.mjTRN_JOINT, kinds.mjTRN_JOINTINPARENT):
                model.preferred.append(self.joints[int(m.actuator_trnid[k, 0])])
        self.left_out()
        return model

    def called(self, kind: str, k: int) -> str:
        """Return the name of an object, or its number."""
        data = self.mujoco.mj_id2name(self.m, getattr(self.mujoco.mjtObj, f"mjOBJ_{kind}"), k)
        return data or f"{kind.lower()}_{k}"

    def frame(self, k: int) -> Frame:
        """Return where a body is in the reference posture."""
        axes = self.data.xmat[k].reshape(3, 3)
        return Frame(self.data.xpos[k].copy(), self.model.rotation(f"body {k}", axes))

    def body(self, k: int) -> None:
        """Declare a body, and the joints that it hangs on."""
        model, m, stated = self.model, self.m, self.called("BODY", k)
        where, axes, frame = f"body {shown(stated)}", self.rotation(m.body_iquat[k]), self.frame(k)
        inertia, mass = axes @ np.diag(m.body_inertia[k]) @ axes.T, float(m.body_mass[k])
        name = model.add(Body, stated, where, mass, m.body_ipos[k].copy(), inertia, frame)
        self.bodies[k], above = name, self.bodies[int(m.body_parentid[k])]
        first, count = int(m.body_jntadr[k]), int(m.body_jntnum[k])
        if not count:
            near = model.frame_of(above).relative(frame)
            model.add(Joint, f"{name}_fixed", where, "weld", above, name, near, Frame())
        for j in range(first, first + count):
            below = name
            if j < first + count - 1:
                none = 0.0, np.zeros(3), np.zeros((3, 3)), frame
                below = model.add(Body, f"{name}_{j - first + 1}", where, *none)
            self.joint(j, above, below, frame)
            above = below

    def joint(self, j: int, above: str, below: str, frame: Frame) -> None:
        """Declare a joint; in the reference posture its coordinate is ``ref``."""
        model, m, stated = self.model, self.m, self.called("JOINT", j)
        kind = ("free", "spherical", "prismatic", "revolute")[int(m.jnt_type[j])]
        far = Frame() if kind == "free" else Frame(m.jnt_pos[j].copy())
        at = far if kind == "free" else frame.then(far)
        if kind in ("prismatic", "revolute"):
            along, ref = Frame.about(m.jnt_axis[j]), float(m.qpos0[m.jnt_qposadr[j]])
            at, far = at.then(along), far.then(along)
            if kind == "revolute":
                far = far.then(Frame(axes=turned(np.array([0.0, 0.0, 1.0]), -ref)))
            else:
                at = at.then(Frame(np.array([0.0, 0.0, -ref])))
        near, where = model.frame_of(above).relative(at), f"joint {shown(stated)}"
        self.joints[j] = model.add(Joint, stated, where, kind, above, below, near, far)

    def equality(self, k: int) -> None:
        """Declare an equality: connect and weld close loops, joint couples two of them."""
        model, m, stated = self.model, self.m, self.called("EQUALITY", k)
        where, data = f"equality {shown(stated)}", m.eq_data[k]
        one, other = int(m.eq_obj1id[k]), int(m.eq_obj2id[k])
        kinds = self.mujoco.mjtEq
        kind = kinds(int(m.eq_type[k]))
        sites = int(m.eq_objtype[k]) == int(self.mujoco.mjtObj.mjOBJ_SITE)
        if kind == kinds.mjEQ_JOINT:
            if np.any(data[2:5]) or other < 0:
                raise model.refuse(where, "is not supported: its polynomial is not linear")
            starts = [float(m.qpos0[m.jnt_qposadr[j]]) for j in (one, other)]
            offset = float(data[0]) + starts[0] - float(data[1]) * starts[1]
            joints = self.joints[other], self.joints[one]
            model.add(Coupling, stated, where, *joints, float(data[1]), offset)
            return
        if kind not in (kinds.mjEQ_CONNECT, kinds.mjEQ_WELD):
            raise model.refuse(where, "is not supported; valid: connect, weld, joint")
        if sites:
            near, far = self.site(one), self.site(other)
            one, other = int(m.site_bodyid[one]), int(m.site_bodyid[other])
        elif kind == kinds.mjEQ_CONNECT:
            near, far = Frame(data[:3].copy()), Frame(data[3:6].copy())
        else:
            far = Frame(data[:3].copy())
            near = Frame(data[3:6].copy(), self.rotation(data[6:10])).then(far)
        shape = "weld" if kind == kinds.mjEQ_WELD else "spherical"
        ends = self.bodies[one], self.bodies[other]
        model.add(Joint, stated, where, shape, *ends, near, far)

    def site(self, k: int) -> Frame:
        """Return the frame of a site on its body."""
        return Frame(self.m.site_pos[k].copy(), self.rotation(self.m.site_quat[k]))

    def rotation(self, quaternion: Array) -> Array:
        """Return the axes of a quaternion."""
        axes = np.zeros(9)
        self.mujoco.mju_quat2Mat(axes, np.asarray(quaternion, dtype=float))
        return self.model.rotation("quaternion", axes.reshape(3, 3))

    def left_out(self) -> None:
        """Note what was not read."""
        m, notes = self.m, self.model.notes
        data = {
            "Springs of joints": np.any(m.jnt_stiffness),
            "Damping of joints": np.any(m.dof_damping),
            "Friction of joints": np.any(m.dof_frictionloss),
            "Armature, the inertia of motors at joints": np.any(m.dof_armature),
            "Contacts": m.npair > 0 or (np.any(m.geom_contype) and m.ngeom > 1),
            "Tendons": m.ntendon > 0,
            "Actuators, except which joints they drive": m.nu > 0,
            "Keyframes": m.nkey > 0,
        }
        notes += [f"{what}: not read." for what, there in data.items() if there]
