"""Mechanisms and numbers from elsewhere, in ``spatial_numbers``, told to the spatial oracle.

Sources, each named in its file: SD/FAST's numbers in Simbody's TestMobilizerReactionForces.cpp
(``sdfast_*``); OpenSim's joint reactions of DoublePendulum3D (``opensim_*``); Adams' numbers in
Chrono's data/testing/joints (``adams_*``); the rest were computed in 70 digits by equations of the
one mechanism (the slider-crank is of IFToMM's library of benchmarks) and checked by two programs.
Numbers in quotes have 30 digits. Adams' forces are on the ground, their torque about the ground's
point.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import mpmath
import numpy as np
from spatial_algebra import cross
from spatial_bodies import AXES, Joint, Load, Mechanism, Rigid, Rod

FOLDER = Path(__file__).parent / "spatial_numbers"
NAMES = sorted(path.stem for path in FOLDER.glob("*.json"))
_CONTEXT = mpmath.MPContext()
_CONTEXT.dps = 70


def number(x):
    """A number as it is printed."""
    return _CONTEXT.mpf(x)


def numbers(x):
    """Numbers as they are printed, an array of them."""
    return np.vectorize(number, otypes=[object])(np.array(x, dtype=object))


@dataclass(frozen=True)
class Instant:
    """One instant of an entry: what the oracle is told, and in ``data`` what must come out."""

    mechanism: Mechanism
    drives: dict
    guess: dict
    pushed: list
    efforts: dict
    data: dict


@dataclass(frozen=True)
class Entry:
    """One entry."""

    name: str

    @cached_property
    def data(self) -> dict:
        return json.loads((FOLDER / f"{self.name}.json").read_text(), parse_float=str)

    @property
    def count(self) -> int:
        return len(self.data["instants"])

    def instant(self, k: int) -> Instant:
        """The mechanism at an instant: where an orientation is driven, it is the one at coordinates
        zero.
        """
        data, told = self.data["instants"][k], self.data["mechanism"]
        drives: dict = {}
        pushed, efforts, orientations = [], {}, {}
        for drive in told["drives"]:
            kind, name, joint = drive["coordinate"], drive["joint"], told["joints"][drive["joint"]]
            given, mode = data["coordinates"][drive["name"]], drive.get("mode")
            if kind == "orientation":
                orientations[name] = numbers(given[0])
                first = 3 if joint["type"] == "free" else 0
                w, rate = numbers(given[1]), numbers(given[2])
                rate = rate - np.array([w[1] * w[2], -w[0] * w[2], w[0] * w[1]])
                found = {(name, first + i): (0, w[i], rate[i]) for i in range(3)}
                keys = dict(zip(found, ("mx", "my", "mz"), strict=True))
            elif kind == "place":
                found = {(name, i): tuple(numbers([row[i] for row in given])) for i in range(3)}
                keys = dict(zip(found, ("fx", "fy", "fz"), strict=True))
            else:
                index = int(
                    (joint["type"] == "cylindrical" and kind == "slide")
                    or drive.get("about") == "child"
                )
                found, keys = {(name, index): tuple(numbers(given))}, {(name, index): ""}
            if mode != "effort":
                drives |= found
            if mode != "motion":
                pushed += found
                efforts |= {key: f"{drive['name']}.{end}".rstrip(".") for key, end in keys.items()}
        mechanism = Mechanism(
            [_body(name, body) for name, body in told["bodies"].items()],
            [
                _joint(name, joint, told["drives"], orientations.get(name))
                for name, joint in told["joints"].items()
            ],
            numbers(told["gravity"]),
            [
                Load(
                    load["body"],
                    numbers(load["place"]),
                    numbers(load.get("force", [0] * 3)),
                    numbers(load.get("torque", [0] * 3)),
                )
                for load in told.get("loads", [])
            ],
        )
        guess = {
            name: (numbers(pose["r"]), numbers(pose["R"])) for name, pose in data["poses"].items()
        }
        return Instant(mechanism, drives, guess, pushed, efforts, data)


def _body(name, body):
    if "rod" not in body:
        return Rigid(name, number(body["mass"]), numbers(body["centre"]), numbers(body["inertia"]))
    rod = body["rod"]
    mass, polar, lateral = (
        [number(rod.get(key, 0)) / number(rod["length"])]
        for key in ("mass", "polar_inertia", "lateral_inertia")
    )
    return Rod(name, number(rod["length"]), mass, polar, lateral, lateral)


def _joint(name, joint, drives, orientation):
    parent, child = (numbers(joint.get(f"axis_{end}", AXES[2])) for end in ("parent", "child"))
    axis2 = None
    if joint["type"] in ("revolute", "cylindrical"):
        zeros = [d for d in drives if d["joint"] == name and d["coordinate"] == "angle"]
        ends = (
            [numbers(zeros[0][f"{end}_zero"]) for end in ("parent", "child")]
            if zeros
            else [_aside(parent), _aside(child)]
        )
        orientation = _axes(parent, ends[0]) @ _axes(child, ends[1]).T
    elif joint["type"] == "universal":
        aside = _axes(parent, _aside(parent))
        orientation = (
            numbers(joint["zero"])
            if "zero" in joint
            else aside[:, [1, 0, 2]] * [1, 1, -1] @ _axes(child, _aside(child)).T
        )
        axis2 = orientation @ child
    elif orientation is None:
        orientation = numbers(joint.get("turn", AXES))
    return Joint(
        name,
        joint["type"],
        joint["parent"],
        joint["child"],
        numbers(joint["at_parent"]),
        numbers(joint["at_child"]),
        parent,
        axis2,
        orientation=orientation,
    )


def _aside(axis):
    return cross(axis, numbers(AXES[int(np.argmin(np.abs(axis.astype(float))))]))


def _axes(axis, zero):
    """Axes as columns: ``axis``, what is of ``zero`` at right angles to it, and the third."""
    x = axis / _CONTEXT.sqrt(axis @ axis)
    y = zero - x * (x @ zero)
    y = y / _CONTEXT.sqrt(y @ y)
    return np.array([x, y, cross(x, y)]).T
