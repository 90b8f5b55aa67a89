"""Solver of a search: an engine, and programs made when they are first needed."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from ...errors import DeclarationError
from ..designs.engine import DesignEngine
from .nonlinear_program import NonlinearProgram
from .problem import Problem, Question
from .term_evaluator import TermEvaluator
from .values import PointValues


@dataclass(frozen=True, eq=False)
class SearchTask:
    """A way to go: a problem, values of all parameters to start from, and how large the problem's
    terms are about.
    """

    problem: Problem
    start: tuple[float, ...]
    scales: tuple[float, ...]


@dataclass(eq=False)
class Solver:
    """A question, ready to be answered."""

    question: Question
    engine: DesignEngine
    evaluator: TermEvaluator
    programs: dict[Any, NonlinearProgram] = field(default_factory=dict)

    @classmethod
    def of(cls, question: Question, engine: DesignEngine) -> Solver:
        """Compile what the question needs beside its engine."""
        evaluator = TermEvaluator(
            engine,
            PointValues(engine.program, engine.times),
            question.terms,
            question.transmission**2,
        )
        solver = cls(question, engine, evaluator)
        solver.program(
            Problem(question.objectives[0], question.constraints)
        )  # what cannot be differentiated is refused at once
        if idle := [name for name in question.box.names if not solver._matters(name)]:
            named = ", ".join(f"'{name}'" for name in idle)
            raise DeclarationError(
                f"over: no objective or limit depends on {named}; remove it from over="
            )
        return solver

    def _matters(self, name: str) -> bool:
        """Return whether a term depends on a parameter."""
        place = self.engine.parameters.index(name)
        for term in self.question.terms:
            if term.output is None:
                if (
                    place
                    in term.of_parameters(self.engine.program.data)
                    .jac_sparsity(0, 0)
                    .get_triplet()[1]
                ):
                    return True
            elif self.evaluator.values.of(term.output).depends[place]:
                return True
        return False

    def program(self, problem: Problem) -> NonlinearProgram:
        """Program of a problem, for any limits."""
        known = (problem.objective, *((c.term, c.least) for c in problem.constraints))
        if known not in self.programs:
            evaluator, box = self.evaluator, self.question.box
            self.programs[known] = NonlinearProgram(
                self.engine, evaluator.values, box, problem, evaluator.least_closure
            )
        return self.programs[known]
