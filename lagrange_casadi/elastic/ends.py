"""How the ends of a link are held, as an elastic beam."""

from __future__ import annotations

from typing import Literal

from ..declare.description import Description, in_space
from ..declare.held import held_ends

End = Literal["pinned", "clamped", "free", "guided"]
Ends = tuple[End, End]

ENDS: tuple[End, ...] = ("pinned", "clamped", "free", "guided")
"""How an end is held: its place, its place and slope, not at all, its slope alone."""


def by_joints(description: Description, link: str) -> Ends:
    """How base and tip are held, by the rule by which columns are."""
    base, tip = held_ends(description, link)
    space = in_space(description)
    if not (base or tip):
        return "free", "free"
    if base and tip:
        if space or (base == tip == "turns"):
            return "pinned", "pinned"
        if base == tip:
            return "clamped", "guided"
        return ("clamped", "free") if base == "held" else ("free", "clamped")
    if space or "held" in (base, tip):
        return ("clamped", "free") if base else ("free", "clamped")
    return ("pinned", "free") if base else ("free", "pinned")
