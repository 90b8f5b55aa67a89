"""Request for instants, values and outputs of a scene, by a method."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from ..engine.instants.evaluation_method import EvaluationMethod
from ..model.even_points import EvenPoints
from ..model.times import Over, Times


@dataclass(frozen=True)
class Request:
    """Options of an evaluation; where it says nothing, the scene does: see :func:`.evaluate`."""

    parameters: Mapping[str, float] | None = None
    t: Times | None = None
    over: Over | None = None
    xi: EvenPoints | None = None
    wanted: Sequence[str] | None = None
    method: EvaluationMethod = field(default_factory=EvaluationMethod)
