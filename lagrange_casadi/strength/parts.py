"""All parts of a solution whose strength is known."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from ..arguments import public
from ..errors import DeclarationError
from ..instants.solution import Solution
from .bearings import joint_safety
from .safety import Safety, safety


@public
def safeties(solution: Solution) -> Iterator[Safety]:
    """The factors of safety of links that have a beam, and of joints that have pins or bearings; not of those that are open."""
    bodies, joints = solution.description["bodies"], solution.description["joints"]
    links = [link for link in solution.links_with_sections if "beam" in bodies[link]]
    for part in [*links, *(name for name, joint in joints.items() if "fitted" in joint)]:
        try:
            found = joint_safety(solution, part) if part in joints else safety(solution, part)
        except DeclarationError:
            continue
        if found.verdicts:
            yield found


def fitted_in(solution: Solution) -> tuple[str, ...]:
    """The joints that have pins or bearings whose reactions are told."""
    fitted = (name for name, joint in solution.description["joints"].items() if "fitted" in joint)
    forces = {name: [o for o in solution.outputs if o.group == "reaction" and o.part == name] for name in fitted}
    return tuple(name for name, own in forces.items() if own and all(map(solution.determined, own)))


def strong_of(solution: Solution, *numbers: str) -> tuple[str, ...]:
    """The links whose stresses are told, and whose material has some numbers."""
    bodies = solution.description["bodies"]
    known = (link for link in solution.links_with_sections if _is_told(solution.stress, link))
    return tuple(link for link in known if all(bodies[link]["beam"]["material"][name] is not None for name in numbers))


def bending_of(solution: Solution) -> tuple[str, ...]:
    """The links whose deflections are told."""
    return tuple(link for link in strong_of(solution, "elasticity") if _is_told(solution.deflection, link))


def _is_told(asked: Callable[[str], object], link: str) -> bool:
    try:
        asked(link)
    except DeclarationError:
        return False
    return True
