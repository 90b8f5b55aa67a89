"""What stands in a model's file is read, refused, or named in a note of the case: random robots and
models with random additions at random places.
"""

import copy
import random
import re
from xml.etree import ElementTree

import pytest
from hypothesis import given
from hypothesis import strategies as st
from internals import case_of

from lagrange_casadi import errors

pytestmark = pytest.mark.quick

NAMES = [
    "origin", "inertial", "mass", "inertia", "visual", "collision", "axis", "axis2", "limit",
    "dynamics", "mimic", "safety_controller", "transmission", "gazebo", "turnGravityOff",
    "joint", "link", "sensor", "plugin", "gravity", "pose", "parent", "child", "frame",
    "material", "damping", "friction", "spring_stiffness", "spring_reference", "physics", "ixx",
    "ixy", "xyz", "static", "model", "world", "include", "density", "screw_thread_pitch",
    "gearbox_ratio", "calibration", "ros2_control", "coupling", "loop", "wind", "auto",
    "strange",
]  # fmt: skip
KEYS = [
    "xyz", "rpy", "value", "damping", "friction", "type", "link", "expressed_in", "multiplier",
    "offset", "reference", "frame", "version", "relative_to", "degrees", "auto", "joint", "ixx",
    "ixz", "attached_to", "rotation_format", "use", "strange",
]  # fmt: skip
VALUES = ["0.37", "true", "1 2 3", "r7", "0 0 0.1 0 0 0", "link0", "joint0"]
"""None is what a format says of a switch that is not there: that changes nothing."""


def added(parent, tag, text="", /, **given):
    one = ElementTree.SubElement(parent, tag, {key: str(given[key]) for key in given})
    one.text = str(text)
    return one


def numbers(draw, count, low=-1.0, high=1.0):
    return " ".join(repr(draw.uniform(low, high)) for _ in range(count))


def moments(draw):
    a, b, c = (draw.uniform(0.01, 0.1) for _ in range(3))
    return {"ixx": b + c, "iyy": a + c, "izz": a + b, "ixy": 0, "ixz": 0, "iyz": 0}


def tree(draw, kinds):
    """Yield the links of a random tree: its number, the one above, and the kind of its joint."""
    for k in range(draw.randint(1, 4)):
        yield f"link{k}", f"link{draw.randrange(k)}" if k else "base", draw.choice(kinds)


def urdf(draw):
    root = ElementTree.Element("robot", name="robot")
    added(root, "link", name="base")
    for k, (name, above, kind) in enumerate(tree(draw, ("revolute", "prismatic", "fixed"))):
        link = added(root, "link", name=name)
        inertial = added(link, "inertial")
        added(inertial, "origin", xyz=numbers(draw, 3), rpy=numbers(draw, 3))
        added(inertial, "mass", value=draw.uniform(0.1, 3.0))
        added(inertial, "inertia", **moments(draw))
        if draw.random() < 0.5:
            added(added(link, "visual"), "geometry")
        joint = added(root, "joint", name=f"joint{k}", type=kind if k else "revolute")
        added(joint, "parent", link=above)
        added(joint, "child", link=name)
        added(joint, "origin", xyz=numbers(draw, 3), rpy=numbers(draw, 3))
        added(joint, "axis", xyz=numbers(draw, 3))
        if draw.random() < 0.5:
            added(joint, "dynamics", damping=draw.uniform(0.1, 1.0))
        if k and draw.random() < 0.2:
            added(joint, "mimic", joint="joint0", multiplier=draw.uniform(0.5, 2.0))
        if draw.random() < 0.3:
            added(added(root, "transmission", name=f"t{k}"), "joint", name=f"joint{k}")
        if draw.random() < 0.3:
            added(added(root, "gazebo", reference=name), "turnGravityOff", "true")
    return root


def sdf(draw):
    root = ElementTree.Element("sdf", version=draw.choice(["1.4", "1.7", "1.10"]))
    world = added(root, "world", name="world") if draw.random() < 0.5 else root
    model = added(world, "model", name="model")
    for k, (name, above, kind) in enumerate(tree(draw, ("revolute", "prismatic", "fixed", "ball"))):
        link = added(model, "link", name=name)
        added(link, "pose", numbers(draw, 6))
        inertial = added(link, "inertial")
        added(inertial, "mass", draw.uniform(0.1, 3.0))
        held = added(inertial, "inertia")
        for key, value in moments(draw).items():
            added(held, key, value)
        if draw.random() < 0.3:
            added(link, "gravity", "false")
        kind = kind if k else "revolute"
        joint = added(model, "joint", name=f"joint{k}", type=kind)
        added(joint, "parent", above if k else "world")
        added(joint, "child", name)
        if kind in ("revolute", "prismatic"):
            axis = added(joint, "axis")
            added(axis, "xyz", numbers(draw, 3))
            dynamics = added(axis, "dynamics")
            for key in ("damping", "spring_stiffness"):
                if draw.random() < 0.5:
                    added(dynamics, key, draw.uniform(0.1, 2.0))
    return root


def add(draw, root):
    """Add something at a random place of a file; return how a note calls it, and the elements that
    it is in.
    """
    above = {one: parent for parent in root.iter() for one in parent}
    at = draw.choice(list(root.iter()))
    around = [at]
    while around[-1] in above:
        around.append(above[around[-1]])
    return [_added(draw, at), *(one.tag for one in around)]


def _added(draw, at):
    what, value = draw.choice(("attribute", "element", "text")), draw.choice(VALUES)
    if what == "text":
        at.text = f"{at.text or ''} {value}"
        return "text"
    key = draw.choice([key for key in KEYS if key not in at.attrib])
    if what == "attribute":
        at.set(key, value)
        return f"{key}="
    one = ElementTree.Element(draw.choice(NAMES), {key: value} if draw.random() < 0.5 else {})
    one.text = draw.choice(VALUES) if not one.attrib or draw.random() < 0.5 else ""
    at.insert(draw.randrange(len(at) + 1), one)
    return one.tag


@pytest.mark.parametrize("form", [urdf, sdf])
def test_all_of_a_file_is_read_refused_or_named(form, tmp_path_factory):
    """What is added changes the case, is refused, or stands in a note."""
    path = tmp_path_factory.mktemp("models") / f"model.{form.__name__}"

    def text_of(root):
        path.write_bytes(ElementTree.tostring(root))
        return case_of(path)

    @given(st.integers(0, 2**32))
    def drawn(seed):
        draw = random.Random(seed)
        root = form(draw)
        before, more = text_of(root), copy.deepcopy(root)
        names = add(draw, more)
        try:
            after = text_of(more)
        except errors.ModelFileError:
            return
        notes = re.sub(r"\n#  ", "", after)
        noted = re.findall(r"^# Not read.*?: ([^(\n]*)", notes, re.MULTILINE)
        assert {*names} & {*re.split(r"[ ,.]+", " ".join(noted))} or after != before, (
            ElementTree.tostring(more).decode()
        )

    drawn()
