"""Solver of a search: an engine, and programs made when they are first needed."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ...errors import DeclarationError
from ..designs.engine import DesignEngine
from .nonlinear_program import NonlinearProgram
from .problem import Problem, Question
from .term_evaluator import TermEvaluator
from .terms import Term
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
        matters = np.any([solver.depends(term) for term in question.terms], axis=0)
        box = question.box
        if idle := [n for n, k in zip(box.names, box.places, strict=True) if not matters[k]]:
            named = ", ".join(f"'{name}'" for name in idle)
            raise DeclarationError(
                f"over: no objective or limit depends on {named}; remove it from over="
            )
        return solver

    def depends(self, term: Term) -> list[bool]:
        """Return whether a term depends on each parameter."""
        if term.output is None:
            found = term.of_parameters(self.engine.program.data).jac_sparsity(0, 0)
        else:
            found = self.evaluator.values.of(term.output).value.jac_sparsity(0, 2)
        return [bool(found.colind(k + 1) > found.colind(k)) for k in range(found.size2())]

    def program(self, problem: Problem) -> NonlinearProgram:
        """Program of a problem, for any limits."""
        known = (problem.objective, *((c.term, c.least) for c in problem.constraints))
        if known not in self.programs:
            evaluator, box = self.evaluator, self.question.box
            self.programs[known] = NonlinearProgram(
                self.engine, evaluator.values, box, problem, evaluator.least_closure
            )
        return self.programs[known]
