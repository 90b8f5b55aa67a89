"""Support of a link's ends by joints, and its consequence for the link as a column and as a
beam.
"""

from __future__ import annotations

from typing import Literal

from ..base.arguments import public
from ..errors import check_known
from .description import Description

_END = 1e-9
_SLIDING = ("prismatic", "slot", "cylindrical", "planar", "screw")

End = Literal["pinned", "clamped", "free", "guided"]
Ends = tuple[End, End]

ENDS: tuple[End, ...] = ("pinned", "clamped", "free", "guided")
"""Supports of a beam's end: its place, its place and slope, not at all, its slope alone."""

_SUPPORTS: dict[tuple[str, str], Ends] = {
    ("", ""): ("free", "free"),
    ("turns", ""): ("pinned", "free"),
    ("", "turns"): ("free", "pinned"),
    ("turns", "turns"): ("pinned", "pinned"),
    ("held", ""): ("clamped", "free"),
    ("", "held"): ("free", "clamped"),
    ("held", "turns"): ("clamped", "free"),
    ("turns", "held"): ("free", "clamped"),
    ("held", "held"): ("clamped", "guided"),
}
"""Supports of base and tip by how joints in a plane hold them, as of :func:`held_ends`."""


@public
def effective_lengths(description: Description, link: str) -> tuple[float, float]:
    """Return the effective length factors of a link as a column, from the joints at its ends.

    Parameters
    ----------
    description : Description
        The description of a solution, ``solution.description``.
    link : str
        Name of the link.

    Returns
    -------
    tuple of float
        Effective length over length, for bending along y and along z.

    Raises
    ------
    DeclarationError
        If ``description`` is not that of a solution.

    Notes
    -----
    In a plane a pin lets the end rotate in the plane, and holds it out of the plane; a weld, a
    slide, or the drive of a pin holds it in the plane too. In the plane the factor is 1 if both
    ends are pinned, 2 if one end is held, because nothing holds the other end sideways, and 1 if
    both are held. Out of the plane it is 1/2 if both ends have joints, else 2. In space it is 1, or
    2 if an end is free. These are the theoretical numbers (Timoshenko and Gere, *Theory of Elastic
    Stability*, section 2.4).
    """
    check_known("link", [link], description.links)
    ends = held_ends(description, link)
    if description.space:
        return (1.0, 1.0) if all(ends) else (2.0, 2.0)
    across = 0.5 if all(ends) else 2.0
    return (1.0 if ends[0] == ends[1] and ends[0] else 2.0), across


def ends_of(description: Description, link: str) -> Ends:
    """Supports of base and tip, by the rule for columns."""
    base, tip = held_ends(description, link)
    if description.space:
        alone = "turns" if base and tip else "held"
        base, tip = base and alone, tip and alone
    return _SUPPORTS[base, tip]


def held_ends(description: Description, link: str) -> tuple[str, str]:
    """Supports of the base and the tip of a link by joints: "turns", "held", or "" if there is
    none.
    """
    return _holds(description, link, False), _holds(description, link, True)


def _holds(description: Description, link: str, tip: bool) -> str:
    """Support of an end: "turns", "held", or none."""
    length, found = description.bodies[link].length or 0.0, ""
    for joint in description.joints.values():
        for place, other in ((joint.parent, joint.child), (joint.child, joint.parent)):
            if place.body != link or abs(place.at[0] - (length if tip else 0.0)) > _END * length:
                continue
            if place is joint.parent and joint.kind in _SLIDING:
                continue  # what slides along it is elsewhere
            lone = not description.oriented(other.body)
            if (
                lone
                and sum(
                    other.body in (j.parent.body, j.child.body) for j in description.joints.values()
                )
                < 2
            ):
                continue  # a mass that hangs on nothing else
            held = joint.kind in ("weld", "prismatic") or any(
                axis.coordinate in description.driven for axis in joint.axes
            )
            found = "held" if held and not lone else found or "turns"
    return found
