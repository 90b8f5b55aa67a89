"""Solver of a search: an engine, and programs made when they are first needed.

Ways from starts are gone here.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ...errors import DeclarationError
from ..designs.engine import DesignEngine
from .descent import Descent, Told
from .judge import Judge
from .problem import Problem, Question
from .program import NonlinearProgram
from .trail import Trail
from .values import PointValues


@dataclass(frozen=True, eq=False)
class Errand:
    """A way to go: a problem, values of all parameters to start from, and how large the problem's
    terms are about.
    """

    problem: Problem
    start: tuple[float, ...]
    scales: tuple[float, ...]


@dataclass(eq=False)
class Finder:
    """A question, ready to be answered."""

    question: Question
    engine: DesignEngine
    judge: Judge
    programs: dict[Any, NonlinearProgram] = field(default_factory=dict)

    @classmethod
    def of(cls, question: Question, engine: DesignEngine) -> Finder:
        """Compile what the question needs beside its engine."""
        judge = Judge(
            engine,
            PointValues(engine.graph, engine.times),
            question.terms,
            question.transmission**2,
        )
        finder = cls(question, engine, judge)
        finder.program(
            Problem(question.objectives[0], question.constraints)
        )  # what cannot be differentiated is told at once
        if idle := [name for name in question.box.names if not finder._matters(name)]:
            named = ", ".join(f"'{name}'" for name in idle)
            raise DeclarationError(
                f"over: nothing that is minimised or limited depends on {named}: leave out what"
                " does not matter"
            )
        return finder

    def _matters(self, name: str) -> bool:
        """Return whether a term depends on a parameter."""
        place = self.engine.parameters.index(name)
        for term in self.question.terms:
            if term.output is None:
                if (
                    place
                    in term.of_parameters(self.engine.graph.data)
                    .jac_sparsity(0, 0)
                    .get_triplet()[1]
                ):
                    return True
            elif self.judge.values.of(term.output).depends[place]:
                return True
        return False

    def program(self, problem: Problem) -> NonlinearProgram:
        """Program of a problem, for any limits."""
        known = (problem.objective, *((c.term, c.least) for c in problem.constraints))
        if known not in self.programs:
            judge, box, count = self.judge, self.question.box, self.engine.count
            self.programs[known] = NonlinearProgram(
                judge.values, box, problem, count, judge.least_closure
            )
        return self.programs[known]

    def descend(self, errand: Errand, told: Told) -> Trail:
        """Go the way of an errand. Its start has a result."""
        first = self.judge.look(np.array(errand.start))
        return Descent(
            self.judge,
            self.program(errand.problem),
            self.question.box,
            errand.problem,
            errand.scales,
            told,
        ).go(first)
