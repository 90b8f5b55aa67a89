"""Models of MuJoCo, ``.xml``: compiled by MuJoCo itself, which knows defaults and the inertia of
shapes, in a process of its own, on a copy of the files of the model's folder that it names.

A body with several joints has bodies without mass between these. What is compiled to other values
than MuJoCo's defaults is read, or has no effect here, or is named in a note.
"""

from __future__ import annotations

import os
import re
import subprocess
import tempfile
from collections.abc import Sequence
from itertools import product
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from ...base.apart import LostError, run_apart
from ...errors import PathError, shown
from ..mujoco_model import compiled
from .file_elements import Element, parsed
from .file_frames import Frame
from .record import GROUND, Body, Coupling, Joint, Model, Spring

LIMITS: dict[str, Any] = {"seconds": 120.0, "busy": 12.0, "most": 2e9}
"""Time, processor time [s] and memory [bytes] that MuJoCo may take."""

_MOST, _LARGEST, _LONGEST, _PLACES, _DEEPEST = 3000, 2**28, 2**24, 32, 20
"""Files of a model, bytes of these and of its parts, folders where they are looked for, and parts
in parts, at most.
"""

_UP, _DEPTH = 8, 20
"""Steps upwards in a name, and folders without files above the copy, more than all names that make
a path have together.
"""

_FOLDERS = ("assetdir", "meshdir", "texturedir")
_BLANK = b"\xef\xbb\xbf \t\r\n"
_SWITCHES = ("gravity", "equality", "constraint", "spring", "damper", "passive", "frictionloss")
_SWITCHED = {
    "opt.gravity": ("gravity",),
    "eq_active0": ("equality", "constraint"),
    "jnt_stiffness": ("spring", "passive"),
    "dof_damping": ("damper", "passive"),
    "dof_frictionloss": ("frictionloss", "constraint"),
    "body_gravcomp": ("passive", "spring damper"),
}
"""Fields that are zero where something is switched off, or two things are."""

_READ = (
    *("body_parentid", "body_mass", "body_inertia", "body_ipos", "body_iquat", "body_jntadr"),
    *("body_jntnum", "body_gravcomp", "jnt_type", "jnt_pos", "jnt_axis", "jnt_qposadr"),
    *("jnt_dofadr", "jnt_stiffness", "dof_damping", "dof_armature", "dof_frictionloss"),
    *("jnt_actfrclimited", "jnt_actfrcrange", "qpos0", "qpos_spring", "eq_active0"),
    *("eq_obj1id", "eq_obj2id", "eq_data", "site_bodyid", "site_pos", "site_quat"),
    *("actuator_trnid", "geom_contype", "opt.gravity"),
    *(f"disable {name}" for name in _SWITCHES),
)
"""Fields of a compiled model that are read, switched flags too."""

_IDLE = "|".join(
    (  # Counts, names, addresses, looks.
        r"n(?!key|plugin)\w*|signature|flg_\w+|[BDM]_\w+|map\w+|efm\w+|tree_\w+",
        r"(?!body_mocap)\w+_\w*(adr|num|id)",
        r"(vis|stat|cam|light|mat|tex|text|mesh|skin|hfield|bvh|oct|sensor|site)_\w+",
        r"(tuple|numeric)_\w+|\w+_(user|group|sameframe|margin|solref\w*|solimp\w*|invweight0)",
        r"body_(bvh\w+|conaffinity|contype|pos|quat|simple|subtreemass)|dof_(M0|length)",
        r"geom_(aabb|castshadow|conaffinity|condim|friction|gap|pos|priority|quat|rbound|rgba)",
        r"geom_(size|solmix|type)|exclude_signature|eq_(type|objtype)",
        # Contacts, and how MuJoCo goes on in time.
        r"opt\.((ccd|sdf|ls|noslip|o)_\w+|iterations|tolerance|solver|jacobian|cone|impratio)",
        r"opt\.(integrator|timestep|apirate|magnetic|sleep_tolerance|\w+flags|disableactuator)",
        r"disable (limit|contact|clampctrl|warmstart|filterparent|actuation|refsafe)",
        r"disable (sensor|midphase|eulerdamp|autoreset|nativeccd|island|multiccd)",
        r"enable (override|energy|fwdinv|invdiscrete|sleep|diagexact|ipc|speculative|multiccd)",
        r"enable (island)",
    )
)
"""Fields without effect on the motion and the forces that are asked for here: looks, names,
addresses, what contacts are computed with.
"""

_WORDS = {
    r"\w+_armature": "Armature, the inertia of motors at joints",
    r"jnt_(limited|range)": "Limits of joints",
    r"pair_\w+|geom_(adhesion|surfacevel)": "Contacts",
    r"(tendon|ten|wrap)_\w+": "Tendons",
    r"actuator_\w+|jnt_actfrcgravcomp": "Actuators, except which joints they drive",
    r"flex\w+": "Deformable bodies",
    r"n?plugin\w*|\w+_plugin": "Plugins",
    r"nkey|key_\w+": "Keyframes",
    r"body_mocapid": "Motion of mocap bodies",
    r"opt\.(density|viscosity|wind)": "Forces of a medium (density, viscosity, wind)",
}
"""Fields that are not read, in words; others have their own names in a note."""


def read(model: Model, text: str) -> None:
    """Read a file. Raises :class:`.ModelFileError`, and :class:`.MissingPackageError` without
    MuJoCo.
    """
    try:
        found = _compiled(model, _files(model, text))
    except subprocess.TimeoutExpired:
        raise model.refuse("", f"was not compiled within {LIMITS['seconds']:g} s") from None
    except LostError as error:
        raise model.refuse("", str(error)) from None
    except OSError as error:
        raise PathError(f"cannot copy and compile {model.file}: {error.strerror}") from None
    if "refused" in found:
        raise model.refuse("", f"MuJoCo refuses it: {found['refused']}")
    _Reader(model, found).read()


def _compiled(model: Model, files: dict[str, bytes]) -> dict[str, Any]:
    """Return what MuJoCo compiles of files, in a folder of their own."""
    with tempfile.TemporaryDirectory() as place:
        # Names that lead out of it lead nowhere, for nobody can guess its own name.
        folder = Path(place, *["_"] * _DEPTH, Path(place).name)
        for name, content in files.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_bytes(content)
        return dict(run_apart(compiled, model.file.name, _READ, _IDLE, folder=folder, **LIMITS))


def _files(model: Model, text: str) -> dict[str, bytes]:
    """Return the contents of a model's file and of those that it and its parts name, by their path
    in its folder.

    Raises :class:`.ModelFileError` for a name that leads out of the folder, and for too much.
    """
    root, found = model.file.parent.resolve(), {model.file.name: text.encode()}
    bases, inner = {""}, {""}  # the folders of parts, and those that parts state
    named, parts = dict[str, Element](), set[str]()
    tried, done, inside, astray = set(found), set(found), set[str](), set[str]()
    waiting, left = [parsed(model, text, "mujoco")], _LONGEST
    for _ in range(_DEEPEST):
        while waiting:
            line = waiting.pop()
            waiting += line.inside
            for key, name in line.given.items():
                leads = name.startswith(("/", "\\")) or ":" in name or name.count("..") > _UP
                if leads and (key.startswith("file") or key in _FOLDERS):
                    raise line.refuse(f"{key} {shown(name)} leads out of its folder")
                if key in _FOLDERS:
                    inner.add(name)
                elif key.startswith("file"):
                    named.setdefault(name, line)
                    parts |= {name} if line.name in ("include", "model") else set()
        if len(bases) * len(inner) > _PLACES or len(named) > _MOST:
            raise model.refuse("", "names too many files or folders")
        for base, folder, name in product(sorted(bases), sorted(inner), named):
            path = os.path.normpath(os.path.join(base, folder, name))
            if path not in tried:
                tried.add(path)
                there = _within(root, path)
                astray |= {name} if there is None else set()
                if there is not None and os.path.isfile(there):
                    if there.stat().st_size > _LARGEST - sum(map(len, found.values())):
                        raise named[name].refuse(f"more than {_LARGEST // 2**20} MB in all")
                    found[path] = there.read_bytes()
            inside |= {name} if path in found else set()
            content = b"" if path in done else found.get(path, b"")
            if content.lstrip(_BLANK).startswith(b"<") or (content and name in parts):
                done.add(path)
                bases.add(os.path.dirname(path))
                left -= len(content)
                if left < 0:
                    raise named[name].refuse(f"more than {_LONGEST // 2**20} MB of XML in parts")
                waiting.append(parsed(model, content.decode(errors="replace"), ""))
        if not waiting:
            break
    else:
        raise model.refuse("", "includes are too deep")
    for name in sorted(astray - inside):
        raise named[name].refuse(f"file {shown(name)} leads out of its folder")
    return found


def _within(root: Path, path: str) -> Path | None:
    """Return where a path of a folder leads, links resolved; None where that is elsewhere."""
    try:
        there = (root / path).resolve()
    except (OSError, RuntimeError, ValueError):  # links in a circle, a name that no file has
        return None
    return there if there.is_relative_to(root) else None


class _Reader:
    """A compiled model under way: ``m`` are its fields, dots in names as lines."""

    def __init__(self, model: Model, found: dict[str, Any]) -> None:
        self.model, self.found, fields = model, found, found["fields"]
        off = {name for name in _SWITCHES if fields.get(f"disable {name}")}
        for name, switches in _SWITCHED.items():
            if any(off.issuperset(one.split()) for one in switches):
                fields[name] = np.zeros_like(fields[name]).tolist()
        named = {name.replace(".", "_"): values for name, values in fields.items()}
        self.m = SimpleNamespace(**named)
        self.bodies: dict[int, str] = {0: GROUND}
        self.joints: dict[int, str] = {}

    def read(self) -> None:
        """Read the model."""
        model, m, kinds = self.model, self.m, self.found["kinds"]
        model.name = model.name_of("mechanism", self.found["name"] or model.name, "")
        model.gravity = model.numbers("option", m.opt_gravity, "gravity")
        for k in range(1, len(m.body_mass)):
            self.body(k)
        for k in np.flatnonzero(m.eq_active0).tolist():
            self.equality(k)
        model.preferred += [
            self.joints[j]
            for kind, (j, *_) in zip(kinds["actuator_trntype"], m.actuator_trnid, strict=True)
            if kind in ("JOINT", "JOINTINPARENT") and j in self.joints
        ]
        for k, body in enumerate(m.site_bodyid):
            if stated := self.found["names"]["site"][k]:
                frame = self.frame(f"site {shown(stated)}", m.site_pos[k], m.site_quat[k])
                model.spots[stated] = self.bodies[body], frame
        contacts = ["Contacts"] if len(m.geom_contype) > 1 and np.any(m.geom_contype) else []
        words = dict.fromkeys([*map(_words, self.found["others"]), *contacts])
        model.notes += [f"{one}: not read." for one in words]

    def called(self, kind: str, k: int) -> tuple[str, str]:
        """Return the name of an object, or its number, and what messages call it."""
        stated = self.found["names"][kind][k] or f"{kind}_{k}"
        return stated, f"{kind} {shown(stated)}"

    def body(self, k: int) -> None:
        """Declare a body, and the joints that it hangs on."""
        model, m, (stated, where) = self.model, self.m, self.called("body", k)
        mass = model.number(where, m.body_mass[k], "mass")
        place = model.numbers(where, m.xpos[k], "place")
        frame = Frame(place, model.rotation(where, np.reshape(m.xmat[k], (3, 3))))
        own = self.frame(where, m.body_ipos[k], m.body_iquat[k])
        inertia = own.tensor(np.diag(model.numbers(where, m.body_inertia[k], "inertia")))
        weight = model.number(where, 1.0 - m.body_gravcomp[k], "gravcomp")
        name = model.add(Body, stated, where, mass, own.place, inertia, frame, weight=weight)
        self.bodies[k], above = name, self.bodies[m.body_parentid[k]]
        first, count = m.body_jntadr[k], m.body_jntnum[k]
        if not count and above == GROUND:
            model.base(name, where)
        elif not count:
            model.attach(name, above, "weld", where)
        for j in range(first, first + count):
            below = name
            if j < first + count - 1:
                below = model.add(Body, f"{name}_{j - first + 1}", where, frame=frame)
            self.joint(j, above, below, frame)
            above = below

    def joint(self, j: int, above: str, below: str, frame: Frame) -> None:
        """Declare a joint, with its spring; in the reference posture its coordinate is zero."""
        model, m, (stated, where) = self.model, self.m, self.called("joint", j)
        kind = ("free", "spherical", "prismatic", "revolute")[m.jnt_type[j]]
        far = Frame() if kind == "free" else self.frame(where, m.jnt_pos[j])
        if kind in ("prismatic", "revolute"):
            axis = model.numbers(where, m.jnt_axis[j], "axis")
            far = far.then(Frame.about(model.direction(where, axis)))
        near = model.frame_of(above).relative(frame.then(far))
        name = self.joints[j] = model.add(Joint, stated, where, kind, above, below, near, far)
        low, high = m.jnt_actfrcrange[j] if m.jnt_actfrclimited[j] else (0.0, 0.0)
        # A drive has one limit for both ways.
        largest = max(min(-low, high), 0.0)
        if low + high != 0.0:
            read = f"read as {largest:g} both ways" if largest else "not read"
            model.notes.append(f"Effort limits of {where}, {low:g} to {high:g}: {read}.")
        at, v = m.jnt_qposadr[j], m.jnt_dofadr[j]
        law = m.dof_damping[v], m.jnt_stiffness[j], m.qpos_spring[at] - m.qpos0[at]
        spring = model.numbers(where, [*law, m.dof_frictionloss[v]], "spring and damper", 4)
        motor = model.numbers(where, [m.dof_armature[v], largest], "armature", 2)
        if kind in ("prismatic", "revolute"):
            if np.any(spring[[0, 1, 3]]):
                model.springs.append(Spring(name, *spring.tolist()))
            model.motor(name, armature=motor[0], effort=motor[1])
            return
        unread = {"Spring and damper": spring[:2], "Friction": spring[3], "Armature": motor}
        model.notes += [
            f"{words} of {where}, which has no axis: not read."
            for words, given in unread.items()
            if np.any(given)
        ]

    def equality(self, k: int) -> None:
        """Declare an equality: connect and weld close loops, joint couples two of them."""
        model, m, (stated, where) = self.model, self.m, self.called("equality", k)
        data, kind = m.eq_data[k], self.found["kinds"]["eq_type"][k]
        one, other = m.eq_obj1id[k], m.eq_obj2id[k]
        if kind == "JOINT":
            if np.any(data[2:5]) or other < 0:
                raise model.refuse(
                    where, "is not supported: it does not couple two joints linearly"
                )
            offset, ratio = model.numbers(where, data[:2], "polycoef", 2).tolist()
            first, second = self.joints[other], self.joints[one]
            model.add(Coupling, stated, where, first, second, ratio, offset)
            return
        if kind not in ("CONNECT", "WELD"):
            raise model.refuse(where, "is not supported; valid: connect, weld, joint")
        if self.found["kinds"]["eq_objtype"][k] == "SITE":
            near, far = (self.frame(where, m.site_pos[i], m.site_quat[i]) for i in (one, other))
            one, other = m.site_bodyid[one], m.site_bodyid[other]
        elif kind == "CONNECT":
            near, far = self.frame(where, data[:3]), self.frame(where, data[3:6])
        else:  # the anchor is given on both bodies
            near, far = self.frame(where, data[3:6], data[6:10]), self.frame(where, data[:3])
        # Without a scale of its torque a weld holds no direction.
        shape = "weld" if kind == "WELD" and data[10] else "spherical"
        model.add(Joint, stated, where, shape, self.bodies[one], self.bodies[other], near, far)

    def frame(
        self, where: str, place: Sequence[float], quaternion: Sequence[float] = (1.0, 0.0, 0.0, 0.0)
    ) -> Frame:
        """Return the frame of a place and a quaternion, which MuJoCo takes even as no numbers."""
        found = self.model.numbers(where, place, "place")
        w, *axis = self.model.numbers(where, quaternion, "quaternion", 4).tolist()
        v = np.array(axis)
        turned = (w * w - v @ v) * np.eye(3) + 2.0 * (np.outer(v, v) - w * np.cross(v, np.eye(3)))
        return Frame(found, self.model.rotation(where, turned))


def _words(field: str) -> str:
    """Return what a field that is not read is called in a note."""
    found = (words for pattern, words in _WORDS.items() if re.fullmatch(pattern, field))
    return next(found, f"What MuJoCo calls {field}")
