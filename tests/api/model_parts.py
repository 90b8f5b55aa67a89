"""Parts of model files that several tests read: arms, assemblies, and how they are written."""

import json
from functools import partial

import numpy as np
import pytest
from model_files import (
    assembly,
    joint,
    link,
    own,
    own_body,
    own_joint,
    urdf,
)

from lagrange_casadi import Scene, evaluate, read
from lagrange_casadi.motion import polynomial


@pytest.fixture
def file(tmp_path):
    """Write the text of a model, or its JSON, and return the path."""

    def written(ending, told):
        if ending == "xml":
            pytest.importorskip("mujoco", reason="MuJoCo is not installed")
        path = tmp_path / f"model.{ending}"
        path.write_text(told if isinstance(told, str) else json.dumps(told))
        return path

    return written


def efforts(scene, count=5, laws=None, **more):
    """The efforts of a scene, or of its mechanism under other laws: a row a drive."""
    if laws is not None:
        scene = Scene(scene.mechanism, laws, **more)
    found = evaluate(scene, t=(*scene.span, count), wanted=["effort"])
    return np.array(list(found.outputs.values()))


def assert_same(one, other, rtol=1e-10):
    assert np.abs(one - other).max() <= rtol * np.abs(other).max()


MOVE = {"p": polynomial(0.3, 0.4, 0.5)}  # 0.4 rad/s and 1 rad/s^2


WEIGHT, TURN = 0.1 * 9.81 * np.cos(0.3), 0.2 + 0.1**2


BASE = '<link name="base"/>'


P = partial(joint, "p", "base", "a", axis="0 -1 0")


def arm(*parts):
    return urdf(BASE, link("a"), *parts)


def frame(name, *more):
    return f'<link name="{name}"/>', joint("q", "a", name, kind="fixed"), *more


def dynamics(**told):
    return "".join(["<dynamics>", *(f"<{k}>{v}</{k}>" for k, v in told.items()), "</dynamics>"])


MJCF_ARM = """
<body name="a" {} pos="0 0 1"><joint name="p" axis="0 1 0" {}/>
  <geom type="capsule" size="0.02" fromto="0 0 0 0.5 0 0" mass="1"/></body>
"""


MJCF_PLAIN = MJCF_ARM.format("", "")


TENDON = '<tendon><fixed name="t"><joint joint="p" coef="1"/></fixed></tendon>'


def numbers(chance):
    return " ".join(map(repr, chance.uniform(-1, 1, 3).tolist()))


SLENDER = (1e-4, 0.02, 0.02)


ORIGIN = (0.0, 0.0, 0.0)


DRIVE = {"drive": ("RotationalMotion", "O", "2.0d*pi*time")}


FOUR_BAR = (
    {"Marker1": (2.0, 0.0, 0.0), "Marker2": (0.0, 0.0, 0.0)},
    {
        "Part1": (
            *(0.2, (0.5, 0.1, 0.05), (8.3333333333333e-4, 0.016833333333333, 0.017333333333333)),
            *({"Marker1": (0.1, 0.1, 0.1), "Marker2": (0.9, 0.1, 0.1)}, (-0.1, -0.1, -0.1)),
        ),
        "Part2": (
            *(0.4, (1.0, 0.1, 0.05), (0.0016666666666667, 0.13366666666667, 0.13466666666667)),
            {"Marker1": (0.1, 0.1, 0.0), "Marker2": (1.9, 0.1, 0.0)},
            (0.80296435866847, -0.1413902845944, -4.8572257327351e-17),
            (
                (0.69212962962963, -0.72177321631434, -4.0768415228988e-17),
                (0.72177321631434, 0.69212962962963, 3.7688895158774e-17),
                (1.0141930549436e-18, -5.5511151231258e-17, 1.0),
            ),
        ),
        "Part3": (
            *(0.3, (0.75, 0.1, 0.05), (0.00125, 0.0565, 0.05725)),
            {"Marker1": (0.1, 0.1, 0.1), "Marker2": (1.4, 0.1, 0.1)},
            (1.9494211444078, 1.4026552603427, -0.1),
            (
                (-0.035256410256409, 0.99937829951217, -4.2098016992882e-17),
                (-0.99937829951217, -0.035256410256409, -3.0814879110196e-33),
                (-1.4842249580823e-18, 4.2071844635181e-17, 1.0),
            ),
        ),
    },
    {
        "O": ("RevoluteJoint", "Marker2", "Part1/Marker1"),
        "A": ("RevoluteJoint", "Part1/Marker2", "Part2/Marker1"),
        "B": ("RevoluteJoint", "Part2/Marker2", "Part3/Marker1"),
        "C": ("RevoluteJoint", "Part3/Marker2", "Marker1"),
    },
    DRIVE,
)


def wheels(law, joint, *, gravity=(0.0, 0.0, 0.0)):
    """Two wheels on parallel shafts 0.3 m apart."""
    parts = {
        "one": (2.0, (0.0, 0.0, 0.0), (0.01, 0.01, 0.02), {"M": (0.0, 0.0, 0.0)}),
        "two": (3.0, (0.0, 0.0, 0.0), (0.03, 0.03, 0.05), {"M": (0.0, 0.0, 0.0)}, (0.3, 0.0, 0.0)),
    }
    joints = {
        "O": ("RevoluteJoint", "A", "one/M"),
        "Q": ("RevoluteJoint", "B", "two/M"),
        "tie": joint,
    }
    motions = {"drive": ("RotationalMotion", "O", law)}
    return {"A": (0.0, 0.0, 0.0), "B": (0.3, 0.0, 0.0)}, parts, joints, motions, gravity


PENDULUM = (
    {"G": (0.0, 0.0, 0.0)},
    {
        "upper": (0.5, (0.1, 0.0, 0.0), SLENDER, {"O": (0.0, 0.0, 0.0), "A": (0.2, 0.0, 0.0)}),
        "lower": (0.8, (0.2, 0.0, 0.0), SLENDER, {"A": (0.0, 0.0, 0.0)}, (0.2, 0.0, 0.0)),
    },
    {"O": ("RevoluteJoint", "G", "upper/O"), "A": ("RevoluteJoint", "upper/A", "lower/A")},
    {"one": ("RotationalMotion", "O", "2*time"), "two": ("RotationalMotion", "A", "time^2")},
)


GEAR = ("GearJoint", "one/M", "two/M", ("radiusI", 0.1), ("radiusJ", 0.2))


def pendulum(mark=ORIGIN, where=((0.2, 0.0, 0.0),), joints=None, motions=None):
    """The pendulum, its lower part with another marker, at another place, or on other joints."""
    points, parts, own_joints, own_motions = PENDULUM
    lower = (*parts["lower"][:3], {"A": mark}, *where)
    joints = {"O": own_joints["O"]} | (joints or {"A": own_joints["A"]})
    return points, parts | {"lower": lower}, joints, motions or own_motions


def off(last):
    """The four-bar whose ground is 1 cm off, its last joint with marker J there, or I."""
    points, parts, joints, motions = FOUR_BAR
    return points | {"Marker1": (2.01, 0.0, 0.0)}, parts, joints | {"C": last}, motions


ONE = {"one": PENDULUM[3]["one"]}


def changed(told, *replaced):
    """The text of an assembly, changed in some places."""
    text = assembly(*told)
    for old, new in replaced:
        assert old in text
        text = text.replace(old, new, 1)
    return text


def moved(file, motion, times=(0.3, 1.7)):
    """The values of a law of a file, at two times."""
    told = own([own_body("arm")], [own_joint("hinge", "ground", "arm")], motions={"hinge": motion})
    asked = {"t": (*times, 2), "wanted": ["motion"], "certificate": False}
    return evaluate(read(file("json", told)), **asked).motion("hinge").value
