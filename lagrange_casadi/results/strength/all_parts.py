"""All parts of a solution whose strength is known."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

from ...base.arguments import public
from ...errors import DeclarationError
from ..histories import Histories
from .bearing_life import joint_safety
from .member import Member
from .safety import Safety, safety, stress

NEEDED = ("yield_strength", "elasticity")
"""The numbers of a material that factors of safety need."""


@public
def safeties(solution: Histories) -> Iterator[Safety]:
    """Yield the factors of safety of all links with a beam and of all joints with pins or bearings.

    Parameters
    ----------
    solution : Solution
        Has section forces and reactions.

    Yields
    ------
    Safety
        Of each part. Parts whose forces are indeterminate are left out.
    """
    return (found for found in looked(solution) if found.verdicts)


def looked(solution: Histories) -> Iterator[Safety]:
    """The same, and of those that are open the reason, without a verdict."""
    for part in _parts(solution):
        try:
            yield part_safety(solution, part)
        except DeclarationError as error:
            yield Safety(part, (), (str(error),))


def not_evaluated(solution: Histories) -> dict[str, str]:
    """Links with beams, and joints with pins or bearings, that have no factor of safety, and the
    reasons.
    """

    def asked(part: str) -> object:
        if part in solution.description.joints:
            return joint_safety(solution, part)
        return Member.of(solution, part).beam.material.needs("safety", *NEEDED)

    return {part: why for part in _parts(solution) if (why := reason(asked, part))}


def _parts(solution: Histories) -> list[str]:
    """The links that have a beam and sections, and the joints that have something fitted."""
    described = solution.description
    links = [link for link in solution.links_with_sections if link in described.beams]
    return [*links, *described.fitted]


def part_safety(
    solution: Histories,
    part: str,
    *,
    criterion: str = "goodman",
    yield_criterion: str = "von_mises",
) -> Safety:
    """The factors of safety of a link, or of what is fitted to a joint: see :func:`.safety` and
    :func:`.joint_safety`.
    """
    if part in solution.description.joints:
        return joint_safety(solution, part)
    return safety(solution, part, criterion=criterion, yield_criterion=yield_criterion)


def fitted_in(solution: Histories) -> tuple[str, ...]:
    """The joints that have pins or bearings whose reactions were evaluated."""
    fitted = solution.description.fitted
    forces = {
        name: [o for o in solution.outputs if o.group == "reaction" and o.part == name]
        for name in fitted
    }
    return tuple(name for name, own in forces.items() if own and all(map(solution.determined, own)))


def strong_of(solution: Histories, *numbers: str) -> tuple[str, ...]:
    """The links whose stresses were evaluated, and whose material has some numbers."""
    materials = solution.description.materials
    return tuple(
        link
        for link in solution.links_with_sections
        if not reason(partial(stress, solution), link)
        and all(getattr(materials[link], name) is not None for name in numbers)
    )


def reason(asked: Callable[[str], object], part: str) -> str:
    """Reason why a result of a part is not available; empty if it is."""
    try:
        asked(part)
    except DeclarationError as error:
        return str(error)
    return ""
