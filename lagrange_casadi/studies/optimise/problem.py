"""Problem of a search: terms, limits, the parameters to choose, and the evaluation of designs."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np

from ...base.arrays import Array, Json, Operand, as_json
from ...base.numerals import real
from ...base.units import in_unit
from ...base.vocabulary import Compiled
from ...engine.identity import sources
from ...engine.instants.evaluation_method import EvaluationMethod
from ...engine.model_data import ModelData, template
from ...errors import DeclarationError, UnknownNameError, check_known
from ...model.scene import Scene, margins
from ...model.times import Times, Timing
from ...results.strength.fatigue import lacking, strengths
from ..designs.engine import DesignEngine
from ..peaks_between import wanted_for
from ..sweep.meanings import WAYS
from .sampled_design import EvaluatedDesign
from .search_run import merit
from .terms import Constraint, Term, tired_link


@dataclass(frozen=True, eq=False)
class Box:
    """The parameters that are chosen: their ``places`` among all, bounds, and the values ``p`` of
    all others.
    """

    names: tuple[str, ...]
    places: tuple[int, ...]
    low: Array
    high: Array
    p: Array

    @classmethod
    def of(
        cls,
        scene: Scene,
        over: Mapping[str, tuple[Operand, Operand]],
        parameters: Mapping[str, float] | None,
    ) -> Box:
        """Bounds by parameter.

        Raises :class:`DeclarationError` for what is no pair of bounds, or out of a parameter's
        range.
        """
        declared = scene.parameters
        if not isinstance(over, Mapping) or not over:
            raise DeclarationError(
                f"over: expected bounds by parameter, as {{'l': (0.15, 0.4)}}, got {over!r}"
            )
        names, low, high = tuple(over), [], []
        for name, bounds in over.items():
            check_known("parameter", [name], declared)
            if not isinstance(bounds, (tuple, list)) or len(bounds) != 2:
                raise DeclarationError(
                    f"over: expected (least, largest) for '{name}', got {bounds!r}"
                )
            for bound in bounds:
                declared[name].check(bound)
            a, b = (declared[name].number(bound) for bound in bounds)
            if not a < b:
                raise DeclarationError(
                    f"over: '{name}': the least value {a:g} must be below the largest, {b:g}"
                )
            low.append(a)
            high.append(b)
            if name in (parameters or {}):
                raise DeclarationError(
                    f"over: parameter '{name}' is in over= and set to a value as well; expected"
                    " one of both"
                )
        values = scene.values(parameters)
        places = tuple(list(declared).index(name) for name in names)
        return cls(names, places, np.array(low), np.array(high), np.array(list(values.values())))

    def all(self, x: Array) -> Array:
        """The values of all parameters, for shares ``x`` (n,) of the way from the low bounds to the
        high ones.
        """
        p: Array = self.p.copy()
        p[list(self.places)] = np.clip(self.low + x * (self.high - self.low), self.low, self.high)
        return p

    def share(self, p: Array) -> Array:
        """The shares for values of all parameters."""
        return np.asarray((p[list(self.places)] - self.low) / (self.high - self.low))


@dataclass(frozen=True)
class Problem:
    """One objective, and what holds."""

    objective: Term
    constraints: tuple[Constraint, ...] = ()

    @property
    def terms(self) -> tuple[Term, ...]:
        """All terms, objective first."""
        return (self.objective, *(c.term for c in self.constraints))

    def excess(self, evaluated: EvaluatedDesign) -> float:
        """Excess of the worst limit, over its scale; NaN without a result."""
        excess = evaluated.closing
        for constraint in self.constraints:
            value = evaluated.values[constraint.term]
            excess = max(excess, constraint.excess(value) / constraint.scale(value))
        return excess if evaluated.has_result else math.nan

    def merit(self, evaluated: EvaluatedDesign) -> tuple[float, float]:
        """Key by which designs are compared: the better one has less."""
        return merit(self.excess(evaluated), evaluated.values[self.objective])

    def scales(self, evaluated: EvaluatedDesign) -> tuple[float, ...]:
        """Scales of the terms, objective first."""
        objective = abs(evaluated.values[self.objective]) or 1.0
        return (objective, *(c.scale(evaluated.values[c.term]) for c in self.constraints))


@dataclass(frozen=True, eq=False)
class Question:
    """A search before it begins.

    All that its result follows from, but the scene and the starts, is in it; it can be sent.
    """

    objectives: tuple[Term, ...]
    constraints: tuple[Constraint, ...]
    box: Box
    timing: Timing
    method: EvaluationMethod
    transmission: float

    @classmethod
    def of(
        cls,
        scene: Scene,
        minimise: str | Sequence[str],
        over: Mapping[str, tuple[Operand, Operand]],
        subject_to: Sequence[str],
        *,
        transmission: float,
        t: Times | None,
        parameters: Mapping[str, float] | None,
        backend: Compiled,
    ) -> Question:
        """Read what a user says. Raises what :func:`.optimise` does for mistakes."""
        declared = scene.parameters
        texts = [minimise] if isinstance(minimise, str) else minimise
        if (
            not isinstance(texts, (list, tuple))
            or not texts
            or not all(isinstance(text, str) for text in texts)
        ):
            raise DeclarationError(
                f"minimise: expected a text such as 'peak:effort:O', or several, got {minimise!r}"
            )
        objectives = tuple(Term.parse(text, declared) for text in texts)
        for objective in objectives:
            if objective.kind == "min":
                raise DeclarationError(
                    f"minimise: a smallest value cannot be an objective; use max:{objective.name}"
                )
        if len(set(objectives)) < len(objectives):
            raise DeclarationError(
                f"minimise: a term is listed twice: {', '.join(map(str, objectives))}"
            )
        constraints = tuple(found for text in subject_to for found in constraints_of(text, scene))
        box = Box.of(scene, over, parameters)
        if not isinstance(transmission, float) or not 0.0 < transmission < 1.0:
            raise DeclarationError(
                f"transmission: expected a sine between 0 and 1, got {transmission!r}"
            )
        return cls(
            objectives, constraints, box, scene.timing(t), EvaluationMethod(backend), transmission
        )

    @property
    def terms(self) -> tuple[Term, ...]:
        """All terms, each once."""
        return tuple(dict.fromkeys((*self.objectives, *(c.term for c in self.constraints))))

    @property
    def wanted(self) -> list[str]:
        """The outputs that the terms are of."""
        outputs = [term.output for term in self.terms if term.output is not None]
        wants = [
            f"section:{link}" if (link := tired_link(output)) else wanted_for(output)
            for output in outputs
        ]
        return list(dict.fromkeys(wants)) or ["motion"]

    def engine(self, scene: Scene) -> DesignEngine:
        """Make the engine that evaluates designs. Raises :class:`UnknownNameError` for a term
        without values.
        """
        # Contacts hold whatever is minimised.
        wanted = [*self.wanted, *margins(scene)]
        engine = DesignEngine.of(scene, wanted, method=self.method, timing=self.timing)
        for term in self.terms:
            if term.output is None:
                term.of_parameters(engine.program.data)
            if term.kind == "peak" and (link := tired_link(term.output)):
                scene.wants([f"safety:{link}"])
                continue
            if term.kind == "fluctuation" and term.output not in engine.drives:
                raise UnknownNameError(
                    "effort of a joint whose motion is given", term.name, map(str, engine.drives)
                )
            there = engine.quantities if term.pointed else engine.efforts
            if term.output is not None and term.name not in there:
                raise UnknownNameError(f"quantity with a {term.kind}", term.name, there)
        return engine

    def measured(self, data: ModelData) -> Question:
        """The search with the numbers of its limits in the units of their terms.

        Raises :class:`DeclarationError` for a text in a unit of another kind.
        """
        limits = []
        for one in self.constraints:
            what = f"limit of {one.term}: its number"
            (limit,) = in_unit(what, [one.limit], one.unit, one.term.unit(data))
            limits.append(replace(one, limit=limit, unit=""))
        return replace(self, constraints=tuple(limits))

    def words(self, engine: DesignEngine) -> dict[str, Json]:
        """Inputs of every number of a search beside its starts, for JSON: no clock, no path."""
        made, program, box = engine.provenance, engine.program, self.box
        content = {
            "case": program.data.name,
            "versions": made.versions,
            "sources": sources(),
            "compiler": f"{made.backend} {made.compiler} {made.flags} {made.method}",
            "scene": program.identity or "cannot be identified",
            "mechanism": program.data.at(program.data.defaults).plain(),
            "t": self.timing.words(program.data.symbols),
            "minimise": list(map(str, self.objectives)),
            "subject_to": [c.words for c in self.constraints],
            "over": {
                name: [float(a), float(b)]
                for name, a, b in zip(box.names, box.low, box.high, strict=True)
            },
            "parameters": {
                name: float(x)
                for name, x in zip(engine.parameters, box.p, strict=True)
                if name not in box.names
            },
            "transmission": self.transmission,
        }
        return cast(dict[str, Any], as_json(content))


_LEAST = re.compile(
    r"\s*least:(safety|yield|buckling|fatigue):([^<>=!:]+?)\s*(<=|>=|<|>)\s*([^<>=!]+?)\s*"
)


def constraints_of(text: str, scene: Scene) -> list[Constraint]:
    """The constraints that a text says: ``least:safety:LINK >= NUMBER`` is one for each way to
    fail, any other text one.

    Raises :class:`.DeclarationError` for what is none, and where fatigue is to be limited of a
    material that lacks a number.
    """
    found = _LEAST.fullmatch(text) if isinstance(text, str) else None
    if found is None:
        return [Constraint.parse(text, scene.parameters)]
    mode, link, relation, number = found.groups()
    scene.wants([f"safety:{link}"])
    try:
        factor = real(number)
    except ValueError:
        factor = math.nan
    if not (0.0 < factor < math.inf and relation.startswith(">")):
        raise DeclarationError(
            f"'{text}': expected a least factor of safety, as least:safety:{link} >= 2"
        )
    material = template(scene).content.materials[link]
    if mode == "fatigue":
        strengths(material, "goodman")
    modes = (
        tuple(w for w in WAYS if w != "fatigue" or not lacking(material))
        if mode == "safety"
        else (mode,)
    )
    return [
        Constraint.parse(f"peak:utilisation:{link}:{each} <= {1.0 / factor:.17g}", scene.parameters)
        for each in modes
    ]
