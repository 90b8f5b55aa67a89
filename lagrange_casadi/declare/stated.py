"""Constraints and non-holonomic rows as they are declared, as functions of what they measure and of the parameters.

Certificates judge by them: here are the declared expressions themselves, and nothing of the graphs that loops are solved from.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca

from ..base.symbolic import Graphs, symbolic
from .description import Place, Template
from .mechanism import Mechanism
from .meshes import Transmission, Wrench
from .parts import Point


@dataclass(frozen=True, eq=False)
class Stated(Graphs):
    """The equations of a mechanism: constraints Phi = 0, and then rows A q' + b = 0.

    ``template`` describes each by its name, whether it is a ``row``, the ``entries`` that it measures and the ``meshes`` at which
    its multiplier acts. ``values(places, rates, accelerations, t, p)`` gives the equation and, of a constraint, its first and
    second total time derivative; ``slopes(places, rates, t, p)`` how it changes with each entry: with its place, or of a row with
    its rate.
    """

    template: Template
    values: tuple[Any, ...]
    slopes: tuple[Any, ...]

    @classmethod
    @symbolic
    def of(cls, mechanism: Mechanism) -> Stated:
        """Return the equations of a mechanism."""
        given = [(c.name, c.phi, False, c.transmission) for c in mechanism.constraints.values()]
        given += [(row.name, row.expression, True, None) for row in mechanism.rows.values()]
        measured = [*_measured(mechanism)]
        functions = []
        asked: list[Any] = []
        described: list[Any] = []

        def number(expression: Any) -> Place:
            asked.append(expression)
            return Place(len(asked) - 1)

        for name, expression, row, transmission in given:
            own = [one for one in measured if any(ca.depends_on(ca.SX(expression), symbol) for symbol in one[3:])]
            entries = [{"kind": kind, "part": part, "point": [*map(number, point)]} for kind, part, point, *_ in own]
            meshes = [*_meshes(transmission, number)]
            described.append({"name": name, "row": row, "entries": entries, "meshes": meshes})
            functions.append(_functions(mechanism, ca.SX(expression), own, row))
        values, slopes = zip(*functions, strict=True) if functions else ((), ())
        return cls(Template.over({"equations": described}, asked, mechanism.symbols), values, slopes)

    def words(self) -> list[Any]:
        """Write them for JSON."""
        return [self.template.dumps(), *([f.serialize() for f in each] for each in (self.values, self.slopes))]

    @classmethod
    def loads(cls, words: Sequence[Any]) -> Stated:
        """Read what :meth:`words` wrote."""
        template, *functions = words
        values, slopes = (tuple(map(ca.Function.deserialize, each)) for each in functions)
        return cls(Template.loads(template), values, slopes)


def _measured(mechanism: Mechanism) -> Iterator[tuple[str, str, tuple[Any, ...], Any, Any]]:
    """All that is measured: its kind, its part and point, and the symbols of its place and its rate."""
    for measure in mechanism.measures.asked:
        of = measure.of
        if isinstance(of, Point):
            point = tuple(of.place[: len(measure.places)])
            for component, place, rate in zip("xyz", measure.places, measure.rates, strict=False):
                yield component, of.body.name, point, place, rate
        elif measure.axis is not None:
            yield "coordinate", measure.axis.coordinate, (), measure.places[0], measure.rates[0]
        else:
            yield "direction", of.name, (), measure.places[0], measure.rates[0]


def _functions(mechanism: Mechanism, expression: Any, own: Sequence[Any], row: bool) -> tuple[Any, Any]:
    """The functions of one equation, over the places and rates of what is its own."""
    places, rates = (ca.vertcat(ca.SX(0, 1), *(one[k] for one in own)) for k in (3, 4))
    accelerations, t, p = ca.SX.sym("accelerations", len(own)), mechanism.time, mechanism.symbols
    moving, speed = ca.vertcat(places, rates, t), ca.vertcat(rates, accelerations, 1)
    changes = [expression]
    for _ in range(0 if row else 2):
        changes.append(ca.jtimes(changes[-1], moving, speed))
    slopes = ca.densify(ca.jacobian(expression, rates if row else places).T)
    return (
        ca.Function("values", [places, rates, accelerations, t, p], [ca.densify(ca.vertcat(*changes))]),
        ca.Function("slopes", [places, rates, t, p], [slopes]),
    )


def _meshes(transmission: Transmission | None, number: Callable[[Any], Place]) -> Iterator[Mapping[str, Any]]:
    """The meshes of a transmission: their bodies, and numbers."""

    def both(wrench: Wrench | None) -> list[list[Place]]:
        told = wrench or Wrench()
        return [[*map(number, told.force)], [*map(number, told.couple)]]

    for mesh in transmission.meshes if transmission is not None else ():
        assert transmission is not None
        loss = transmission.loss
        yield {
            "bodies": [mesh.first.body.name, mesh.second.body.name, mesh.carrier.name],
            "centre": [*map(number, mesh.centre)],
            "reach": [*map(number, mesh.reach)],
            "along": both(mesh.along),
            "apart": both(mesh.apart),
            "slack": number(transmission.slack),
            "braking": both(mesh.braking),
            "loss": [0.0, 0.0] if loss is None else [number(loss.arm), number(loss.lean)],
            "turns": [] if loss is None else [[sign, joint.name] for sign, joint in loss.turns],
        }
