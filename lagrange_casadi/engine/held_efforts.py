"""Efforts of a scene whose frictions at rest are at their limits, with given signs."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

import casadi as ca

from ..base.quantities import Column, Output
from ..base.scalars import column, graph
from ..base.symbolic import Graphs, symbolic
from ..model.scene import Scene, Wanted
from .indeterminate import Forces
from .mesh_forces import transmissions_of
from .mobility import internal_forces
from .moving import Moving
from .pressing import frictions_of


@dataclass(frozen=True, eq=False)
class HeldEfforts(Graphs):
    """``instant(t, d, d_rate, d_acceleration, z, p, signs) -> out``, a row for each of ``columns``.

    ``signs`` are those of ``frictions``; those ``every_way`` may hold their joint in more than one
    direction.
    """

    instant: Any
    columns: tuple[Column, ...]
    frictions: tuple[str, ...]
    every_way: tuple[str, ...]


@symbolic
@functools.lru_cache(maxsize=8)
def held_efforts(scene: Scene) -> HeldEfforts:
    """The efforts of a scene that can be assembled, with checks of its frictions, and of efforts
    that are ``open`` besides.
    """
    mechanism = scene.mechanism
    want = Wanted.of(mechanism, ["effort"])
    moving = Moving.of(scene, want)
    losses = (t.loss.name for t in transmissions_of(mechanism).values() if t.loss is not None)
    signs = {name: ca.SX.sym(f"sign_{name}") for name in (*frictions_of(mechanism), *losses)}
    columns, free, _ = internal_forces(moving.body, moving.solved, want, scene, signs)
    efforts: dict[Column, Any] = {
        key: value for key, value in columns.items() if isinstance(key, Output)
    }
    columns |= Forces.over(efforts, free, {}).columns
    out = ca.substitute(column(columns.values()), free, 0)
    instant = graph("held", moving.solved.inputs | {"signs": column(signs.values())}, out=out)
    every_way = (
        name
        for name, load in frictions_of(mechanism).items()
        if load.every_way or load.beside is not None
    )
    return HeldEfforts(instant, tuple(columns), tuple(signs), tuple(every_way))
