"""Mechanisms and numbers from elsewhere, in ``spatial_numbers``, told to the spatial oracle.

Sources, each named in its file: SD/FAST's numbers in Simbody's TestMobilizerReactionForces.cpp
(``sdfast_*``); OpenSim's joint reactions of DoublePendulum3D (``opensim_*``); Adams' numbers in
Chrono's data/testing/joints (``adams_*``); the rest were computed in 70 digits by equations of the
one mechanism (the slider-crank is of IFToMM's library of benchmarks) and checked by two programs.
Parts and drives are told as the oracle takes them. Adams' forces are on the
ground, their torque about the ground's point.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from spatial_bodies import Joint, Load, Mechanism, Rigid, Rod

FOLDER = Path(__file__).parent / "spatial_numbers"
NAMES = sorted(path.stem for path in FOLDER.glob("*.json"))
_TEXTS = ("name", "kind", "body", "parent", "child")


def numbers(x):
    """Numbers as they are printed, an array of them, or one."""
    found = np.array(x, dtype=float)
    return found if found.shape else found.item()


def told(part, **more):
    """A part's texts as they are, and its numbers."""
    return {key: x if key in _TEXTS else numbers(x) for key, x in (part | more).items()}


@dataclass(frozen=True)
class Instant:
    """One instant of an entry: what the oracle is told, and in ``data`` what must come out."""

    mechanism: Mechanism
    drives: dict
    guess: dict
    pushed: list
    efforts: dict
    data: dict


def instants(name: str) -> Iterator[Instant]:
    """The mechanism of an entry at each instant: where an orientation is driven, it is the one at
    coordinates zero.
    """
    entry = json.loads((FOLDER / f"{name}.json").read_text())
    parts = entry["mechanism"]
    for data in entry["instants"]:
        driven = data.get("orientations", {})
        turned = {name: {"orientation": R} for name, R in driven.items()}
        kinds = {"Rigid": Rigid, "Rod": Rod}
        mechanism = Mechanism(
            [kinds[body.pop("kind")](**body) for body in map(told, parts["bodies"])],
            [Joint(**told(joint, **turned.get(joint["name"], {}))) for joint in parts["joints"]],
            numbers(parts["gravity"]),
            [Load(**told(load)) for load in parts.get("loads", [])],
        )
        yield Instant(
            mechanism,
            {(joint, axis): tuple(numbers(law)) for joint, axis, law in data["drives"]},
            {name: (numbers(q["r"]), numbers(q["R"])) for name, q in data["poses"].items()},
            [(joint, axis) for joint, axis in data["pushed"]],
            {(joint, axis): numbers(effort) for joint, axis, effort in data["efforts"]},
            data,
        )
