"""A drawing of a mechanism, as text."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Drawing:
    """A drawing of a mechanism as the text of an SVG, which a notebook shows; ``gaps`` say which
    loops do not close, and how wide they are open.
    """

    name: str
    svg: str = field(repr=False)
    gaps: tuple[str, ...] = ()

    def _repr_html_(self) -> str:
        """The picture, in any colours of the notebook."""
        return self.svg
