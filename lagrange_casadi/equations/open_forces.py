"""Forces as functions of what equilibrium leaves open in an over-constrained mechanism."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca

from ..errors import DeclarationError
from .checks import Column, column_of


@dataclass(frozen=True, eq=False)
class OpenForces:
    """The ``columns`` of a graph that change with what equilibrium leaves open, which is ``count`` numbers x.

    ``values(t, d, d_rate, d_acceleration, z, p, x) -> (columns,)`` are these for any x, and ``slopes`` of the same ->
    (columns, count) their derivatives by x. Section forces and reactions are linear in x.
    """

    columns: tuple[Column, ...]
    count: int
    values: Any
    slopes: Any

    def dumps(self) -> str:
        """All of it as text."""
        names = [str(column) for column in self.columns]
        return json.dumps([names, self.count, self.values.serialize(), self.slopes.serialize()])

    @classmethod
    def loads(cls, text: str) -> OpenForces:
        """What :meth:`dumps` made a text of."""
        names, count, values, slopes = json.loads(text)
        return cls(tuple(map(column_of, names)), count, *(ca.Function.deserialize(f) for f in (values, slopes)))


def open_forces(columns: Mapping[Column, Any], free: Any, inputs: Sequence[Any], frictions: Mapping[str, Any]) -> OpenForces | None:
    """Those of ``columns`` that change with ``free``; None where none does.

    Raises :class:`.DeclarationError` where ``frictions`` do: what rubs is not linear in what presses on it.
    """
    for name, value in frictions.items():
        if ca.depends_on(ca.SX(value), free):
            raise DeclarationError(
                f"elastic: friction '{name}' follows a reaction that equilibrium leaves open; elasticity tells it without friction"
            )
    each = {key: ca.SX(value) for key, value in columns.items()}
    doubted = {key: value for key, value in each.items() if ca.jacobian(value, free).nnz()}
    if not doubted:
        return None
    rows = ca.densify(ca.vertcat(*doubted.values()))
    names = ["t", "d", "d_rate", "d_acceleration", "z", "p", "x"]
    values = ca.Function("open_forces", [*inputs, free], [rows], names, ["out"], {"cse": True})
    slopes = ca.Function("open_slopes", [*inputs, free], [ca.densify(ca.jacobian(rows, free))], names, ["out"], {"cse": True})
    return OpenForces(tuple(doubted), free.numel(), values, slopes)
