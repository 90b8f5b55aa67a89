"""All parts of a solution whose strength is known."""

from __future__ import annotations

from collections.abc import Iterator

from ..errors import DeclarationError
from ..instants.solution import Solution
from .bearings import joint_safety
from .safety import Safety, safety


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
