"""Sizing: of a table of profiles the lightest for each link that is safe, with the loads that its
own mass brings.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import casadi as ca

from ..base.arguments import Positive, public
from ..base.brief import Brief
from ..base.numerals import readable
from ..base.scalars import column
from ..base.templates import Template
from ..engine.model_data import beam_at, template
from ..engine.two_force_links import unaimed
from ..errors import (
    DeclarationError,
    LagrangeCasadiError,
    NoDesignError,
    check_known,
)
from ..model.beams.profiles import Profile
from ..model.declared_parts import Parameter
from ..model.description import Description
from ..model.scene import Scene
from ..model.times import Over, Times
from ..results.elastic.deflection import Deflection
from ..results.solution import Solution
from ..results.strength.member import Member
from ..results.strength.safety import Safety, Verdict, as_column, rated
from .request import Request
from .solving import solve

_TURNS = 100
"""Largest number of evaluations of loads before a search is given up."""


@dataclass(frozen=True, repr=False)
class StiffSafety(Safety):
    """The factors of safety of a link, and against ``deflection``: what is allowed over the
    largest. Of that 1 is enough, of the others ``enough``.
    """

    enough: float = 1.0

    @property
    def governs(self) -> Verdict:
        """The one that is nearest to what is enough of it."""
        return min(self.verdicts, key=self._share)

    @property
    def suffices(self) -> bool:
        """True if all links are safe and stiff enough."""
        return self._share(self.governs) >= 1.0

    def _share(self, verdict: Verdict) -> float:
        return verdict.factor / (1.0 if verdict.against == _BENT else self.enough)


_BENT = "deflection"


@dataclass(frozen=True, repr=False)
class Sized(Brief):
    """The profile chosen for a link: its mass [kg], its factors of safety, and the next lighter
    one, which is not safe, with its factors where the rest is as chosen; None where it is the
    lightest.
    """

    link: str
    profile: Profile
    mass: float
    safety: Safety
    lighter: tuple[Profile, Safety] | None


@dataclass(frozen=True, repr=False)
class Sizing(Brief):
    """Result of a choice: a :class:`Sized` for each link, the parameters, and the number of
    evaluations of loads.

    ``left`` are links with a beam that the profiles do not fit, with why. ``solution`` is that of
    what was chosen.
    """

    links: tuple[Sized, ...]
    parameters: Mapping[str, float]
    evaluations: int
    left: Mapping[str, str]
    solution: Solution

    @property
    def mass(self) -> float:
        """The mass of the links that were sized [kg]."""
        return sum(sized.mass for sized in self.links)


@public
def size(
    scene: Scene,
    profiles: Sequence[Profile],
    *,
    safety: Positive = 2.0,
    links: Sequence[str] | None = None,
    parameters: Mapping[str, float] | None = None,
    t: Times | None = None,
    over: Over | None = None,
    criterion: str = "goodman",
    yield_criterion: str = "von_mises",
    deflection: Positive | None = None,
) -> Sizing:
    """Choose for each link the lightest of some profiles that is safe.

    Dimensions of a link's cross-section that are parameters take a profile's values. Links begin
    with their lightest profile. A link that is not safe takes the next one that is safe under the
    present loads, and loads are evaluated again. Then each link is tried lighter, with the others
    unchanged, until no single link can be lighter. The result is evaluated with its certificate.

    Parameters
    ----------
    scene
        The scene.
    profiles
        The profiles, as of :func:`.read_profiles`.
    safety
        Demand this factor of safety at least.

        It is against yielding, buckling and fatigue.
    links
        Size this link; default: all that profiles fit.

        Names of links whose dimensions are parameters of the profiles.
    parameters, t, over
        As of :func:`.studies.evaluate.evaluate`.
    criterion
        Count mean stress in fatigue by this criterion.
    yield_criterion
        Compare this equivalent stress with the yield strength.

        Both as in :func:`.strength.safety`.
    deflection
        Limit the deflection across a link over its length, as 1/500; default: no limit.

        With it the factors of safety are :class:`StiffSafety`.

    Returns
    -------
    Sizing
        The profile of each link, and the solution with them.

    Raises
    ------
    DeclarationError
        If profiles fit no link, or not those that are named.
    NoDesignError
        If no profile is safe.
    LagrangeCasadiError
        As :func:`.evaluate` and :func:`.strength.safety`.
    """
    criteria = {"criterion": criterion, "yield_criterion": yield_criterion}
    request = Request(parameters, t, over)
    search = _Search.of(scene, profiles, links, request, float(safety), criteria, deflection)
    choice = search.lightened(search.safe())
    return search.result(choice)


@dataclass(frozen=True)
class _Slot:
    """Parameters that profiles may set of a link: one for each dimension, and the profiles,
    lightest first.
    """

    parameters: Mapping[str, str]
    profiles: tuple[Profile, ...]

    def values(self, profile: Profile) -> dict[str, float]:
        """Values of the parameters for a profile."""
        return {self.parameters[name]: value for name, value in profile.dimensions.items()}


@dataclass(eq=False)
class _Search:
    """Choice of profiles for links of a scene: a ``factor`` of safety is enough by some
    ``criteria``, and so is a ``deflection`` over a link's length.
    """

    evaluated: Callable[..., Solution]
    request: Request
    template: Template[Description]
    slots: dict[str, _Slot]
    factor: float
    criteria: Mapping[str, str]
    deflection: float | None
    left: Mapping[str, str]
    outputs: Sequence[str]
    sections: Sequence[str]
    evaluations: int = 0

    @classmethod
    def of(
        cls,
        scene: Scene,
        profiles: Sequence[Profile],
        links: Sequence[str] | None,
        request: Request,
        factor: float,
        criteria: Mapping[str, str],
        deflection: float | None,
    ) -> _Search:
        if not profiles:
            raise DeclarationError("size: expected at least one profile")
        described = template(scene)
        content, having = described.content, described.content.beams
        if not having:
            raise DeclarationError(
                "size: no link has a cross-section, so there is nothing to size; declare one with"
                " beam="
            )
        check_known("link with a beam", links or (), having)
        slots: dict[str, _Slot] = {}
        remaining: dict[str, str] = {}
        defaults = scene.values(request.parameters)
        spinning = [name for name in content.bars if name not in content.beside]
        for name in having if links is None else [name for name in having if name in links]:
            try:
                if name in spinning and not beam_at(described, name, list(defaults.values())).round:
                    raise _UnfitError(unaimed(name).replace(f"link '{name}'", "it", 1))
                slots[name] = _slot(described, name, profiles, scene.parameters, defaults)
            except _UnfitError as error:
                if links is not None:
                    raise DeclarationError(f"link '{name}': {error}") from None
                remaining[name] = str(error)
        if not slots:
            why = "; ".join(f"{name}: {reason}" for name, reason in remaining.items())
            raise DeclarationError(f"size: the profiles fit no link; {why}")
        taken: dict[str, str] = {}
        for name, slot in slots.items():
            for parameter in dict.fromkeys(slot.parameters.values()):
                if (other := taken.setdefault(parameter, name)) != name:
                    raise DeclarationError(
                        f"size: links '{other}' and '{name}' share parameter '{parameter}'; give"
                        " each its own"
                    )
        sections = [f"section:{name}" for name in having]
        evaluated, enough = partial(solve, scene), (factor, criteria, deflection)
        left = (remaining, scene.wanted, sections)
        return cls(evaluated, request, described, slots, *enough, *left)

    @property
    def fixed(self) -> Mapping[str, float]:
        """Values that were given."""
        return self.request.parameters or {}

    def solve(self, choice: Mapping[str, int]) -> Solution:
        """The loads with profiles by their numbers."""
        self.evaluations += 1
        asked = replace(self.request, parameters=self.values(choice), wanted=self.sections)
        return self.evaluated(asked, certificate=False)

    def values(self, choice: Mapping[str, int]) -> dict[str, float]:
        found = dict(self.fixed)
        for name, k in choice.items():
            found |= self.slots[name].values(self.slots[name].profiles[k])
        return found

    def judge(self, solution: Solution, name: str, k: int, *, whole: bool = False) -> Safety:
        """Safety of a link with a profile, under the loads of a solution; ``whole`` for all
        criteria, else until one fails.
        """
        member = Member.of(solution, name)
        slot, values = self.slots[name], solution.description.values
        values |= slot.values(slot.profiles[k])
        other = replace(member, beam=beam_at(self.template, name, list(values.values())))
        enough = 0.0 if whole else self.factor
        column = as_column(solution.description, other)
        found = rated(other, column, **self.criteria, enough=enough)
        if self.deflection is None or found.factor < enough:
            return found
        peak = Deflection.of(other, solution.description).peak()
        allowed = self.deflection * member.law.length
        where = (
            f"{abs(peak.value) * 1e3:.4g} of {allowed * 1e3:.4g} mm at t = {peak.t:.5g} s, xi/l ="
            f" {peak.xi:.4f}"
        )
        verdict = Verdict(_BENT, allowed / abs(peak.value) if peak.value else math.inf, where)
        return StiffSafety(found.link, (*found.verdicts, verdict), found.not_evaluated, self.factor)

    def suffices(self, found: Safety) -> bool:
        """Return whether a link is safe, and stiff if that is asked for."""
        return found.suffices if isinstance(found, StiffSafety) else found.factor >= self.factor

    def safe(self) -> dict[str, int]:
        """Numbers of profiles that are safe under the loads that they bring, each the first that is
        from the lightest upward.
        """
        choice = dict.fromkeys(self.slots, 0)
        for _ in range(_TURNS):
            solution, changed = self.solve(choice), False
            for name, slot in self.slots.items():
                first = choice[name]
                while not self.suffices(self.judge(solution, name, choice[name])):
                    changed = True
                    if choice[name] + 1 == len(slot.profiles):
                        tried = range(first, len(slot.profiles))
                        raise NoDesignError(self._report_none(solution, name, tried))
                    choice[name] += 1
            if not changed:
                return choice
        raise NoDesignError(f"size: loads and profiles do not converge within {_TURNS} evaluations")

    def _report_none(self, solution: Solution, name: str, tried: Iterable[int]) -> str:
        whole = {k: self.judge(solution, name, k, whole=True) for k in tried}
        best = max(whole, key=lambda k: whole[k].factor)
        profile, found = self.slots[name].profiles[best].name, whole[best]
        most = f"the most, '{profile}', has {found.factor:.4g} against {found.governs.against}"
        stiff = (
            ""
            if self.deflection is None
            else f", and a deflection of {self.deflection:g} of its length at most"
        )
        return f"size: link '{name}': no profile has a factor of {self.factor:g}{stiff}; {most}"

    def lightened(self, choice: dict[str, int]) -> dict[str, int]:
        """The same, each link as light as the others allow."""
        changed = True
        while changed:
            changed = False
            for name in self.slots:
                for k in range(choice[name]):
                    lighter = {**choice, name: k}
                    solution = self.solve(lighter)
                    if all(
                        self.suffices(self.judge(solution, other, n))
                        for other, n in lighter.items()
                    ):
                        choice, changed = lighter, True
                        break
        return choice

    def result(self, choice: Mapping[str, int]) -> Sizing:
        """Result of a choice, evaluated anew with its certificate."""
        wanted = [*self.outputs, *self.sections]
        asked = replace(self.request, parameters=self.values(choice), wanted=wanted)
        solution = self.evaluated(asked)
        links = []
        for name, k in choice.items():
            slot, mass = self.slots[name], solution.description.bodies[name].mass
            before = None
            if k:
                before = (
                    slot.profiles[k - 1],
                    self.judge(self.solve({**choice, name: k - 1}), name, k - 1, whole=True),
                )
            links.append(
                Sized(
                    name, slot.profiles[k], mass, self.judge(solution, name, k, whole=True), before
                )
            )
        chosen = {
            n: v
            for n, v in self.values(choice).items()
            if n not in self.fixed or self.fixed[n] != v
        }
        return Sizing(tuple(links), chosen, self.evaluations, self.left, solution)


class _UnfitError(LagrangeCasadiError):
    """Profiles do not fit a link."""


def _slot(
    described: Template[Description],
    link: str,
    profiles: Sequence[Profile],
    parameters: Mapping[str, Parameter],
    defaults: Mapping[str, float],
) -> _Slot:
    """Find the profiles that may be a link's own, in the order of the mean area of its
    cross-sections. Raises :class:`_UnfitError`.
    """
    owners: dict[str, str] = {}
    shapes = list(
        beam_at(described, link, column(one.symbol for one in parameters.values())).course.shapes
    )
    for name in profiles[0].dimensions:
        if lacking := [shape.kind for shape in shapes if name not in shape.dimensions]:
            raise _UnfitError(f"{name} is not a dimension of its {lacking[0]}")
        symbols = [shape.dimensions[name] for shape in shapes]
        found = {str(s) for s in symbols if isinstance(s, ca.SX) and s.is_symbolic()}
        if len(found) != 1:
            raise _UnfitError(f"its {name} must be a parameter, which profiles can set")
        owners[name] = found.pop()
    table = next((profile.table for profile in profiles if profile.table), "")
    for shape in shapes:
        if table and (lacking := [name for name in shape.dimensions if name not in owners]):
            raise _UnfitError(f"table '{table}' has no {', '.join(lacking)} of its {shape.kind}")
    slot = _Slot(owners, ())
    weights = []
    for profile in profiles:
        values = slot.values(profile)
        for name, value in profile.dimensions.items():
            if values[owners[name]] != value:
                raise _UnfitError(
                    f"profile '{profile.name}' gives parameter '{owners[name]}' two values"
                )
            if fault := parameters[owners[name]].fault(value):
                raise _UnfitError(f"profile '{profile.name}': {fault}")
        beam = beam_at(described, link, list((dict(defaults) | values).values()))
        for shape in beam.course.shapes:
            for value, words in shape.parameter_constraints():
                if not float(value) > 0.0:
                    raise _UnfitError(
                        f"profile '{profile.name}': {words} of its {shape.kind} must be positive,"
                        f" got {readable(float(value))}"
                    )
        areas = [float(shape.area) for shape in beam.course.shapes]
        weights.append(sum(areas) / len(areas))
    order = sorted(range(len(profiles)), key=lambda k: weights[k])
    return _Slot(owners, tuple(profiles[k] for k in order))
