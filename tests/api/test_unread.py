"""What stands in a model's file is read, refused, or named in a note of the case: random
additions at random places of robots.
"""

import copy
import random
import re
from xml.etree import ElementTree

import pytest
from hypothesis import given
from hypothesis import strategies as st
from internals import case_of
from model_files import SMALL

from lagrange_casadi import errors

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


@pytest.mark.parametrize("name", ["arm.urdf", "cell.urdf", "loop.urdf", "arm.sdf"])
def test_all_of_a_file_is_read_refused_or_named(name, tmp_path_factory):
    """What is added changes the case, is refused, or stands in a note."""
    path = tmp_path_factory.mktemp("models") / name
    root = ElementTree.fromstring(SMALL[name])

    def text_of(root):
        path.write_bytes(ElementTree.tostring(root))
        return case_of(path)

    before = text_of(root)

    @given(st.integers(0, 2**32))
    def drawn(seed):
        more = copy.deepcopy(root)
        names = add(random.Random(seed), more)
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
