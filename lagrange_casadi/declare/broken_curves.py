"""Errors for curves that a motion cannot follow: a kink, a jump, or an instant that is other than
both sides of it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from ..errors import DeclarationError


@dataclass(frozen=True)
class Kink:
    """A place, by symbol, at which a value or a slope jumps; by what part of it, infinite where it
    has no limit.
    """

    what: str
    jump: float
    at: Mapping[str, float]

    def __str__(self) -> str:
        does = f"jumps by {100.0 * self.jump:.3g} %" if math.isfinite(self.jump) else "has no limit"
        return f"its {self.what} {does} where {_place(self.at)}"

    def refused(self, what: str) -> DeclarationError:
        """The error for ``what`` has the kink."""
        return DeclarationError(
            f"{what}: {self}: rates would jump there, and accelerations would be wrong; expected a"
            " curve with a continuous slope, as curve(x, y) in place of a table, a polynomial or"
            " a Fourier sum"
        )


@dataclass(frozen=True)
class Isolated:
    """An instant, by symbol, at which a value, a slope or a curvature is other than on both sides
    of it.
    """

    what: str
    at: Mapping[str, float]

    def __str__(self) -> str:
        return f"its {self.what} where {_place(self.at)} differs from its values on both sides"

    def refused(self, what: str) -> DeclarationError:
        """The error for ``what`` is isolated at an instant."""
        return DeclarationError(
            f"{what}: {self}: the value is that of this instant alone; expected other instants, or"
            " a curve that is continuous there: if_else, fabs, sign and floor are not, so in"
            " place of if_else(x == 0, 1, sin(x)/x) take a series for small x"
        )


def _place(at: Mapping[str, float]) -> str:
    return ", ".join(f"{name} = {value:.6g}" for name, value in at.items())
