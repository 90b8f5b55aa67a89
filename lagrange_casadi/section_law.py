"""The section law of a uniform rod as numbers: its forces at any ratio xi/l, and where along the link they peak.

With u = xi/l and v = 1 - u the moments from the section to the tip are mu0 = m v, mu1 = m l v (1 + u)/2, and the combinations
that bending needs, mu1 - xi mu0 = m l v^2/2 and mu2 - xi mu1 = m l^2 v^2 (2 + u)/6, are written so that nothing cancels near
the tip.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

FORCES = ("axial", "shear", "bending")
_COEFFICIENTS = {"axial": ("n0", "n1", "n2"), "shear": ("f0", "f1", "f2"), "bending": ("m0", "f0", "f1", "f2")}


@dataclass(frozen=True, eq=False)
class SectionLaw:
    """The law of one link: ``coefficients`` by name (n0 ... m0), each of shape (t,); length [m] and mass [kg]."""

    length: float
    mass: float
    coefficients: Mapping[str, Array]

    def on_grid(self, force: str, xi: Array) -> Array:
        """A force at every instant and every ratio ``xi``, of shape (t, xi)."""
        columns = np.stack([self.coefficients[name] for name in _COEFFICIENTS[force]], axis=1)
        return np.asarray(columns @ np.stack(self._basis(force, xi)))

    def at(self, force: str, xi: Any) -> Array:
        """A force at ratios of shape (t, ...), one row an instant."""
        u = np.asarray(xi, dtype=float)
        shape = (-1,) + (1,) * (u.ndim - 1)
        terms = zip(_COEFFICIENTS[force], self._basis(force, u), strict=True)
        return np.asarray(sum(self.coefficients[name].reshape(shape) * factor for name, factor in terms))

    def extreme(self, force: str) -> tuple[Array, Array]:
        """The ratio at which a force is largest in size, and the force there, at every instant, both of shape (t,)."""
        places = np.stack([np.zeros_like(self.coefficients["n0"]), np.ones_like(self.coefficients["n0"]), *self._stationary(force)])
        places = np.where((places > 0.0) & (places < 1.0), places, np.where(places >= 1.0, 1.0, 0.0)).T
        values = self.at(force, places)
        best = np.argmax(np.abs(values), axis=1)[:, None]
        return np.take_along_axis(places, best, 1)[:, 0], np.take_along_axis(values, best, 1)[:, 0]

    def _basis(self, force: str, u: Array) -> list[Array]:
        m, l, v = self.mass, self.length, 1.0 - u
        if force == "bending":
            return [np.ones_like(u), l * v, m * l * v * v / 2, m * l * l * v * v * (2.0 + u) / 6]
        return [np.ones_like(u), m * v, m * l * v * (1.0 + u) / 2]

    def _stationary(self, force: str) -> list[Array]:
        """Where the force's derivative along the link is zero: for bending, the zeros of shear."""
        c, m, l = self.coefficients, self.mass, self.length
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            if force == "axial":
                return [-c["n1"] / (c["n2"] * l)]
            if force == "shear":
                return [-c["f1"] / (c["f2"] * l)]
            # shear = f0 + b v + a v^2; the root that would cancel comes from the other one.
            a, b = -c["f2"] * m * l / 2, c["f1"] * m + c["f2"] * m * l
            q = -(b + np.copysign(np.sqrt(b * b - 4.0 * a * c["f0"]), b)) / 2
            return [1.0 - q / a, 1.0 - c["f0"] / q]
