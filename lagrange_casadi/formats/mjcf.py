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
from .frames import Frame, turned
from .record import GROUND, LARGEST, Body, Coupling, Joint, Model

if TYPE_CHECKING:
    from types import ModuleType

    import mujoco

_FOLDERS = ("assetdir", "meshdir", "texturedir")
_FILES = ("file", "fileup", "filedown", "filefront", "fileback", "fileleft", "fileright", "content")
_DEEPEST = 20
_UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])


def read(model: Model, text: str) -> None:
    """Read a file. Raises :class:`.ModelFileError`, and :class:`.MissingPackageError` without
    MuJoCo.
    """
    folder = model.file.parent.resolve()
    _inside(model, folder, parsed(model, text, "mujoco"), folder, 0)
    try:
        import mujoco
    except ImportError as error:
        words = f"{model.file.name}: a model of MuJoCo is compiled by MuJoCo: pip install mujoco"
        broken = "" if isinstance(error, ModuleNotFoundError) else f"; it is broken here: {error}"
        raise MissingPackageError(words + broken) from None
    try:
        compiled = mujoco.MjModel.from_xml_path(str(model.file))
    except ValueError as error:
        raise model.refuse("", f"MuJoCo refuses it: {error}") from None
    _Reader(model, compiled, mujoco).read()


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

    def read(self) -> None:
        """Read the model."""
        model, m = self.model, self.m
        stated = m.names.partition(b"\0")[0].decode(errors="replace")  # its own is the first one
        model.name = model.name_of("mechanism", stated or model.name, "")
        model.gravity = model.numbers("option", m.opt.gravity.tolist(), "gravity")
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

    def called(self, kind: str, k: int) -> str:
        """Return the name of an object, or its number."""
        data = self.mujoco.mj_id2name(self.m, getattr(self.mujoco.mjtObj, f"mjOBJ_{kind}"), k)
        return data or f"{kind.lower()}_{k}"

    def body(self, k: int) -> None:
        """Declare a body, and the joints that it hangs on."""
        model, m, stated = self.model, self.m, self.called("BODY", k)
        where, mass = f"body {shown(stated)}", float(m.body_mass[k])
        frame = self.frame(where, self.data.xpos[k], self.data.xquat[k])
        own = self.frame(where, m.body_ipos[k], m.body_iquat[k])
        inertia = own.tensor(np.diag(m.body_inertia[k]))
        name = model.add(Body, stated, where, mass, own.place, inertia, frame)
        self.bodies[k], above = name, self.bodies[int(m.body_parentid[k])]
        first, count = int(m.body_jntadr[k]), int(m.body_jntnum[k])
        if not count:
            model.attach(name, above, "weld", where)
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
        where = f"joint {shown(stated)}"
        far = Frame() if kind == "free" else self.frame(where, m.jnt_pos[j])
        at = far if kind == "free" else frame.then(far)
        if kind in ("prismatic", "revolute"):
            ref = model.number(where, float(m.qpos0[m.jnt_qposadr[j]]), "ref")
            along = Frame.about(m.jnt_axis[j])
            at, far = at.then(along), far.then(along)
            if kind == "revolute":
                far = far.then(Frame(axes=turned(np.array([0.0, 0.0, 1.0]), -ref)))
            else:
                at = at.then(Frame(np.array([0.0, 0.0, -ref])))
        near = model.frame_of(above).relative(at)
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
            offset, ratio = model.numbers(where, data[:2].tolist(), "polycoef", 2).tolist()
            offset += starts[0] - ratio * starts[1]
            joints = self.joints[other], self.joints[one]
            model.add(Coupling, stated, where, *joints, ratio, offset)
            return
        if kind not in (kinds.mjEQ_CONNECT, kinds.mjEQ_WELD):
            raise model.refuse(where, "is not supported; valid: connect, weld, joint")
        if sites:
            near, far = (self.frame(where, m.site_pos[k], m.site_quat[k]) for k in (one, other))
            one, other = int(m.site_bodyid[one]), int(m.site_bodyid[other])
        elif kind == kinds.mjEQ_CONNECT:
            near, far = self.frame(where, data[:3]), self.frame(where, data[3:6])
        else:
            far = self.frame(where, data[:3])
            near = self.frame(where, data[3:6], data[6:10]).then(far)
        shape = "weld" if kind == kinds.mjEQ_WELD else "spherical"
        ends = self.bodies[one], self.bodies[other]
        model.add(Joint, stated, where, shape, *ends, near, far)

    def frame(self, where: str, place: Array, quaternion: Array = _UPRIGHT) -> Frame:
        """Return the frame of a place and a quaternion, which MuJoCo takes even as no numbers."""
        found, axes = self.model.numbers(where, place.tolist(), "place"), np.zeros(9)
        turn = self.model.numbers(where, quaternion.tolist(), "quaternion", 4)
        self.mujoco.mju_quat2Mat(axes, turn)
        return Frame(found, self.model.rotation(where, axes.reshape(3, 3)))

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
