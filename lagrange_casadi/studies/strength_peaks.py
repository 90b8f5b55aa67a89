"""Stresses and factors of safety over all times of a solution's span: as :mod:`.peaks`, of what is
largest along a whole link.

At a time the largest stress along a link is exact (:mod:`.strength.stress`). Over time it is the
upper edge of smooth curves, one for each fibre and summit: where two cross it has a kink that
points downward, beside which the search looks more closely.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from ..base.arguments import public
from ..base.arrays import Array
from ..base.quantities import Output, parts_along
from ..engine.buckling import Column
from ..model.even_points import are_even
from ..model.scene import Scene
from ..results.solution import Solution
from ..results.strength.member import Member
from ..results.strength.safety import Safety, Verdict, as_column, buckling, safety, yielded
from ..results.strength.stress import Stress, StressPeak
from .peaks_between import ContinuousSolution


@public
def refine_stress(
    scene: Scene, solution: Solution, link: str, kind: str = "von_mises", *, notches: bool = False
) -> StressPeak:
    """Return the peak of a stress in a link over all times, between instants too.

    Parameters
    ----------
    scene : Scene
        The scene of the solution.
    solution : Solution
        Has the section forces of the link.
    link : str
        Name of a link with a beam.
    kind : str
        ``"normal"``, ``"shear"``, ``"von_mises"`` or ``"tresca"``.
    notches : bool
        Include the factors of notches.

    Returns
    -------
    StressPeak
        The peak, exact to rounding, and not below that of the instants. If the search does not end,
        its value is NaN, and ``least`` is the largest stress that was found. If elasticity
        determines the forces, it is the peak of the instants.

    Raises
    ------
    DeclarationError
        If the solution is not of this scene, and as :func:`.strength.stress` does.
    UnknownNameError
        For another kind of stress.
    """
    stress = solution.stress(link)
    peak = stress.peak(kind, notches=notches)
    found = _Searched.of(scene, solution, link)
    return peak if found is None else found.stress(kind, peak)


@public
def refine_safety(
    scene: Scene,
    solution: Solution,
    link: str,
    *,
    criterion: str = "goodman",
    yield_criterion: str = "von_mises",
) -> Safety:
    """Return the factors of safety of a link, with yielding and buckling over all times.

    Parameters
    ----------
    scene : Scene
        The scene of the solution.
    solution : Solution
        Has the section forces of the link.
    link : str
        Name of a link with a beam.
    criterion, yield_criterion : str
        As of :func:`.strength.safety`.

    Returns
    -------
    Safety
        Factors over all times of the span, between instants too; against fatigue those of the
        instants. ``not_evaluated`` has those whose search did not end.

    Raises
    ------
    DeclarationError
        If the solution is not of this scene, and as :func:`.strength.safety` does.
    UnknownNameError
        For another criterion or kind of stress.
    """
    unrefined = safety(solution, link, criterion=criterion, yield_criterion=yield_criterion)
    found = _Searched.of(scene, solution, link)
    if found is None:
        return unrefined
    verdicts, missing = [], list(unrefined.not_evaluated)
    for verdict in unrefined.verdicts:
        refined: Verdict | None = verdict
        if verdict.against == "yield":
            peak = found.stress(yield_criterion, Stress(found.member).peak(yield_criterion))
            refined = None if math.isnan(peak.value) else yielded(found.member, peak)
        elif verdict.against == "buckling":
            refined = found.buckled(verdict, as_column(solution.description, found.member))
        if refined is None:
            missing.append(
                f"{verdict.against}: between the instants it may be less than"
                f" {verdict.factor:.4g}; smooth what switches there"
            )
        else:
            verdicts.append(refined)
    return Safety(link, tuple(verdicts), tuple(missing))


_BESIDE = 1e-4
"""Relative difference between a factor and that of the link at the reported time; if it is larger,
the factor jumps there.
"""


@dataclass(frozen=True, eq=False)
class _Along:
    """Link in numbers at every instant (t,), as a curve over time."""

    member: Member
    columns: Mapping[Output, int]
    size: Callable[[Member], Array]

    def at(self, columns: Array) -> Member:
        """The link at the times of some columns."""
        outputs = {output: columns[k] for output, k in self.columns.items()}
        return replace(
            self.member,
            law=self.member.law.of(self.member.link, outputs),
            t=np.zeros(columns.shape[1]),
        )

    def curves(self, columns: Array) -> tuple[Array, Array]:
        """Ratios, which are not known, and sizes, each (1, t)."""
        found = np.full((1, columns.shape[1]), np.nan)
        whole = np.isfinite(columns[list(self.columns.values())]).all(axis=0)
        if whole.any():
            found[0, whole] = self.size(self.at(columns[:, whole]))
        return np.full_like(found, np.nan), found


@dataclass(frozen=True, eq=False)
class _Searched:
    """A link of a solution, and what it is at any time of its span."""

    member: Member
    over_time: ContinuousSolution

    @classmethod
    def of(cls, scene: Scene, solution: Solution, link: str) -> _Searched | None:
        """Make it for a link; None if nothing is between the instants, or equilibrium alone does
        not determine its forces.
        """
        determinate = solution.by_equilibrium
        member = Member.of(solution, link)
        if solution.t.size == 1 or any(
            not determinate.determined(f"section:{link}:{force}") for force in member.forces
        ):
            return None
        found = ContinuousSolution.of(scene, determinate)
        return cls(member, found if are_even(solution.t) else found.in_equal_steps())

    def stress(self, kind: str, sampled: StressPeak) -> StressPeak:
        """The peak of a stress whose peak at the instants is known."""

        def size(member: Member) -> Array:
            stress = Stress(member)
            return (
                stress.largest_at_notches(kind)
                if sampled.notch
                else np.abs(stress.largest(kind).value)
            )

        found = self.over_time.signals([self._along(size)], {}).peaks([0])
        peak = Stress(self.at(float(found.t[0]))).peak(kind, notches=sampled.notch)
        best = max(sampled, peak, key=lambda one: abs(one.value))
        return best if found.resolved[0] else replace(best, value=math.nan, least=abs(best.value))

    def buckled(self, sampled: Verdict, of: Column) -> Verdict | None:
        """The factor against buckling, of which that at the instants is known; None where it cannot
        be determined.

        It jumps where compression begins: the graph knows when that is.
        """
        used = self.over_time.in_equal_steps(f"safety:{self.member.link}")
        (peak,), _ = used.refined([used.solution.peak(f"utilisation:{self.member.link}:buckling")])
        if math.isnan(peak.value):
            return None
        factor = 1.0 / peak.value if peak.value else math.inf
        if factor >= sampled.factor:
            return sampled
        there = buckling(self.at(peak.t), of)
        if there.factor <= factor * (1.0 + _BESIDE):
            return there
        return Verdict("buckling", factor, f"where compression begins, at t = {peak.t:.5g} s")

    def at(self, t: float) -> Member:
        """The link at a time."""
        along = self._along(lambda member: np.zeros_like(member.t))
        signals, times = self.over_time.signals([along], {}), np.array([t])
        z, _ = signals.closed(times, signals.near(times))
        return replace(along.at(signals.columns(times, z)), t=times)

    def _along(self, size: Callable[[Member], Array]) -> _Along:
        return _Along(
            self.member, parts_along(self.over_time.program.outputs, self.member.link), size
        )
