"""What the certificates of the plane and of space share: which forces they need, and the sizes beside which gaps are told."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ..base.arrays import Array
from ..base.quantities import Output
from ..declare.description import drives_of
from ..instants.section_law import SectionLaw
from ..instants.solution import Solution
from . import digits
from .written import Written

_EDGE = 1e-9
"""Of a link's length: what is as near to its base is at the base."""


@dataclass(eq=False)
class Tally:
    """Forces on the bodies: what they sum to by body, about each centre, their power, and how large all these are.

    ``pushes`` and ``twists`` are all forces and couples added up, ``flow`` the powers, none against another.
    """

    force: dict[str, Any] = field(default_factory=dict)
    moment: dict[str, Any] = field(default_factory=dict)
    size: Array | float = 0.0
    pushes: Array | float = 0.0
    twists: Array | float = 0.0
    power: Array | float = 0.0
    flow: Array | float = 0.0

    def bear(self, push: Array, twist: Array, size: float) -> None:
        """Take a force and a couple into the sizes; ``size`` is the mechanism's."""
        self.size = np.maximum(self.size, push + twist / size)
        self.pushes, self.twists = self.pushes + push, self.twists + twist

    def scales(self, solution: Solution, turned: Array, fastest: Array) -> tuple[float, float]:
        """The largest force and the largest flow; ``turned`` and ``fastest`` are the largest rate of turning, and speed, (t,).

        And what reported digits leave open: those of places, which give arms, and of the joints' rates, of which the rates of
        bodies are sums and differences.
        """
        least, part = digits.least(solution), digits.coarseness(solution)
        largest = self.size * (1.0 + part * digits.extent(solution) / digits.size(solution))
        flow = self.flow + least * fastest + part * (self.pushes * fastest + self.twists * turned)
        return max(float(np.max(largest)), least), float(np.max(flow))


def forces_told(solution: Solution, equations: Sequence[Written] | None) -> bool:
    """Whether a solution tells every force that acts on its bodies, and the equations along which multipliers act are known."""
    description = solution.description
    if equations is None and (description["constraints"] or description["rows"]):
        return False
    wanted = [Output("reaction", name, "fx") for name in description["joints"]]
    wanted += [Output("load", name, "fx") for name in description["loads"]]
    wanted += [output for output in solution.outputs if output.group in ("reaction", "load")]
    wanted += [Output("effort", name) for name in drives_of(description)]
    wanted += [Output("multiplier", name) for name in (*description["constraints"], *description["rows"])]
    return all(output in solution.outputs and np.isfinite(solution.outputs[output]).all() for output in wanted)


def law_at_base(solution: Solution, link: str) -> SectionLaw:
    """The law of a link, for its section at the base: what slides over the base just now counts as at the base."""
    law = solution.section(link).law
    return replace(law, slack=max(_EDGE, law.slack))
