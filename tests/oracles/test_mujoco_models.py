"""Random models of MuJoCo against MuJoCo's own inverse dynamics: what a case does not have of them,
its notes name. Attributes are those of MuJoCo's own schema.
"""

import random
import re

import numpy as np
import pytest
from commands import run_here
from internals import case_of

from lagrange_casadi import Scene, errors, evaluate
from lagrange_casadi.motion import polynomial

mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed")
pytestmark = pytest.mark.usefixtures("interpreted")

OF_TREE = ("body", "joint", "geom")
LEFT = {  # they say how the same model is written
    *("name", "class", "childclass", "file", "mesh", "material", "hfield", "type", "fromto"),
    *("quat", "axisangle", "xyaxes", "zaxis", "euler", "mocap", "fluidcoef"),
}
WORDS = {
    "Tendons": ("tendon_stiffness", "tendon_damping", "tendon_armature", "tendon_stiffnesspoly"),
    "Actuators, except which joints they drive": ("actuator_armature", "actuator_damping"),
    "Forces of a medium (density, viscosity, wind)": ("density", "viscosity", "wind"),
}
"""What a note says is not read, and where MuJoCo has it."""

FLAGS = {"Limits of joints": "LIMIT", "Contacts": "CONTACT"}


def attributes():
    """The attributes of each element, as MuJoCo prints them."""
    found, path = {}, []
    for line in mujoco.mj_printSchema(False, False).splitlines():
        head, tail = line[:28], line[28:]
        if match := re.match(r"( *)(?:\(world\))?(\w+) \(.\)", head):
            depth = len(match[1]) // 3
            path[depth:] = [match[2]]
        if path[-2:-1] in (["mujoco"], ["body"], ["option"]):
            found.setdefault(path[-1], []).extend(tail.split())
    return found


def compiled(text):
    try:
        return mujoco.MjModel.from_xml_string(text)
    except (ValueError, mujoco.FatalError):
        return None


class Draw:
    """A random model as XML: a tree, some attributes of its parts, couplings and a loop."""

    def __init__(self, seed):
        self.chance = random.Random(seed)
        self.schema, self.joints = attributes(), []
        count = self.chance.randrange(1, 5)
        under = {k: [] for k in range(count)}
        for k in range(1, count):
            under[self.chance.randrange(k)].append(k)
        self.more = {}
        self.tree = lambda: self.body(0, under)
        self.after = self.coupled(count)
        self.kinds = {k: self.kinds_of(k) for k in range(count)}
        self.fixed = {k: self.geometry() for k in range(count)}

    def numbers(self, count, size=1.0):
        return " ".join(f"{self.chance.uniform(-size, size):.3f}" for _ in range(count))

    def kinds_of(self, k):
        if self.chance.random() < 0.15 and k == 0:
            return ["free"]
        many = self.chance.choice((1, 1, 1, 2))
        return [self.chance.choice(("hinge", "hinge", "slide", "ball")) for _ in range(many)]

    def geometry(self):
        size = f"{self.chance.uniform(0.02, 0.1):.3f} {self.chance.uniform(0.1, 0.4):.3f} 0.07"
        kind = self.chance.choice(("box", "capsule", "ellipsoid", "cylinder"))
        place = f'pos="{self.numbers(3, 0.5)}" euler="{self.numbers(3, 90)}"'
        joint = [f'pos="{self.numbers(3, 0.3)}" axis="{self.numbers(3)}"' for _ in range(2)]
        return place, f'type="{kind}" size="{size}" pos="{self.numbers(3, 0.3)}"', joint

    def coupled(self, count):
        """Some equalities, an actuator and a tendon."""
        texts = ["<actuator><motor joint='j0_0'/></actuator>"]
        texts.append("<tendon><fixed><joint joint='j0_0' coef='1'/></fixed></tendon>")
        ratio = f'polycoef="{self.numbers(2)} 0 0 0"'
        pair = 'joint1="j0_0" joint2="j1_0"'
        texts.append(f"<equality><joint {pair} {ratio}/></equality>")
        ends = f'body1="b0" body2="b{count - 1}" anchor="{self.numbers(3)}"'
        texts.append(f"<equality><connect {ends}/></equality>")
        return [text for text in texts if self.chance.random() < 0.25]

    def body(self, k, under):
        place, shape, joints = self.fixed[k]
        lines = [f'<body name="b{k}" {place} {self.given("body", k)}>']
        for n, (kind, at) in enumerate(zip(self.kinds[k], joints, strict=False)):
            where = "" if kind == "free" else at if kind != "ball" else at.partition(" axis")[0]
            own = self.given("joint", (k, n))
            lines.append(f'<joint name="j{k}_{n}" type="{kind}" {where} {own}/>')
        lines.append(f"<geom {shape} {self.given('geom', k)}/>")
        return "\n".join([*lines, *(self.body(one, under) for one in under[k]), "</body>"])

    def given(self, element, place):
        told = self.more.get((element, place), {})
        return " ".join(f'{key}="{value}"' for key, value in told.items())

    @property
    def text(self):
        flags, option = self.given("flag", 0), self.given("option", 0)
        return (
            f"<mujoco><compiler {self.given('compiler', 0)}/>"
            f"<option {option}><flag {flags}/></option>\n<worldbody>{self.tree()}</worldbody>\n"
            f"{''.join(self.after)}</mujoco>"
        )

    def add(self):
        """Give a part an attribute that MuJoCo takes; what it takes, it is tried to say."""
        element = self.chance.choice(("option", "flag", *OF_TREE, "joint", "joint"))
        key = self.chance.choice(self.schema[element])
        if key in LEFT:
            return
        k = self.chance.choice(list(self.kinds))
        place = {"joint": (k, 0), "option": 0, "flag": 0}.get(element, k)
        told = self.more.setdefault((element, place), {})
        positive = f"{self.chance.uniform(0.1, 2):.3f}"
        for value in (positive, "disable", self.numbers(3), self.numbers(2), "true", "1"):
            told[key] = value
            if compiled(self.text) is not None:
                return
        del told[key]


def inverse(model, notes, solution):
    """The power of all efforts by MuJoCo, and the efforts of joints with one coordinate, without
    what notes name.
    """
    for words, fields in WORDS.items():
        for field in fields if f"{words}: not read." in notes else ():
            if hasattr(model.opt, field):
                setattr(model.opt, field, 0.0 * np.array(getattr(model.opt, field)))
            elif hasattr(model, field):
                getattr(model, field)[...] = 0.0
    for field in re.findall(r"What MuJoCo calls (\w+): not read", notes):
        getattr(model, field)[...] = 0.0
    for words, flag in FLAGS.items():
        if f"{words}: not read." in notes:
            model.opt.disableflags |= int(getattr(mujoco.mjtDisableBit, f"mjDSBL_{flag}"))
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_EQUALITY)
    off = mujoco.mjtDisableBit.mjDSBL_FRICTIONLOSS | mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    rubs = model.dof_frictionloss * (0.0 if model.opt.disableflags & int(off) else 1.0)
    model.dof_frictionloss[:] = 0.0  # which MuJoCo softens
    data = mujoco.MjData(model)
    mujoco.mj_setConst(model, data)
    mujoco.mj_resetData(model, data)
    data.qpos[:] = model.qpos0
    for j in range(model.njnt):
        name, kind = model.joint(j).name, int(model.jnt_type[j])
        at, v = model.jnt_qposadr[j], model.jnt_dofadr[j]
        every = slice(v, v + (6 if kind == 0 else 3))
        if f"Spring and damper of joint '{name}'" in notes:
            model.jnt_stiffness[j] = 0.0
            model.dof_damping[every] = 0.0
        if f"Armature of joint '{name}'" in notes:
            model.dof_armature[every] = 0.0
        if kind >= 2:
            motion = solution.motion(name)
            data.qpos[at] += motion.value[0]
            data.qvel[v], data.qacc[v] = motion.rate[0], motion.acceleration[0]
            continue
        # Turns are zero: of x, y and z in sequence, axes carried by those before.
        rate, growth = told(solution, name, "turn")
        a, b, c = rate
        turning = growth + np.array([b * c, -a * c, a * b])
        if kind == 0:
            axes = np.zeros(9)
            mujoco.mju_quat2Mat(axes, data.qpos[at + 3 : at + 7])
            for where, found in zip(
                (data.qvel, data.qacc), told(solution, name, "slide"), strict=True
            ):
                where[v : v + 3] = axes.reshape(3, 3) @ found
            v += 3
        data.qvel[v : v + 3], data.qacc[v : v + 3] = rate, turning
    mujoco.mj_inverse(model, data)
    alone = {model.joint(j).name: model.jnt_dofadr[j] for j in np.flatnonzero(model.jnt_type >= 2)}
    for v in alone.values():
        data.qfrc_inverse[v] += rubs[v] * np.tanh(data.qvel[v] / 1e-3)
    efforts = {name: float(data.qfrc_inverse[v]) for name, v in alone.items()}
    return data.qfrc_inverse * data.qvel, efforts


def told(solution, name, move):
    """Rates and accelerations of three coordinates."""
    motions = [solution.motion(f"{name}:{move}_{k}") for k in (1, 2, 3)]
    return (
        np.array([getattr(one, word)[0] for one in motions]) for word in ("rate", "acceleration")
    )


def drawn(seed):
    """A model of MuJoCo, some parts of which have attributes of all kinds."""
    draw = Draw(seed)
    while compiled(draw.text) is None:
        draw = Draw(seed := seed + 1_000_000)
    for _ in range(draw.chance.randrange(12)):
        draw.add()
    return draw


@pytest.mark.sampled(41)
@pytest.mark.parametrize("seed", range(400))
def test_efforts_are_those_of_mujoco_or_a_note_says_why_not(seed, tmp_path, monkeypatch):
    monkeypatch.setattr("lagrange_casadi.interop.formats.mjcf.run_apart", run_here)
    draw, path = drawn(seed), tmp_path / "model.xml"
    path.write_text(draw.text)
    model = compiled(draw.text)
    text = case_of(path)
    notes = re.sub(r"\n#   ", " ", text)
    named = {"__name__": "case"}
    exec(text, named)
    scene, chance = named["scene"](), draw.chance
    held = model.neq > 0
    laws = {
        name: polynomial(
            0.0 if held or ":" in name else chance.uniform(-0.3, 0.3),
            *(chance.uniform(-1, 1) for _ in range(2)),
        )
        for name in scene.motion
    }
    try:
        solution = evaluate(Scene(scene.mechanism, laws, t=(0, 0, 1)))
    except (errors.AssemblyError, errors.PostureError, errors.MobilityError):
        assert held, draw.text
        return
    powers, efforts = inverse(model, notes, solution)
    effort = {name: float(solution.effort(name)[0]) for name in laws}
    rates = {name: float(solution.motion(name).rate[0]) for name in laws}
    power = sum(effort[name] * rates[name] for name in laws)
    size = max(np.abs(powers).sum(), 1e-9)
    assert abs(power - powers.sum()) < 1e-8 * size, draw.text
    for name in () if held else efforts.keys() & effort.keys():
        largest = max(map(abs, efforts.values()))
        assert abs(effort[name] - efforts[name]) < 1e-8 * max(largest, 1e-9), draw.text
