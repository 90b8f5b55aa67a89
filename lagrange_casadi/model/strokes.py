"""Strokes of cylinders and struts, frozen: between which lengths they can be."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..base.brief import Brief
from .declared_parts import Expression


@dataclass(frozen=True, eq=False, repr=False)
class Stroke(Brief):
    """The ``length`` of a part between its pins, from ``closed`` to ``open`` [m]; ``what`` names
    the part in messages.
    """

    what: str
    length: Any
    closed: Expression
    open: Expression

    @property
    def used(self) -> Any:
        """Share of the stroke that is out: 0 closed, 1 open."""
        return (self.length - self.closed) / (self.open - self.closed)
