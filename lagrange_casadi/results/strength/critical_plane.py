"""The critical plane: fatigue where normal and shear stress are not in phase, by Findley's
criterion.

Of all planes through a place the one is critical on which shear amplitude + k times the largest
normal stress is largest; it must not exceed what it is at the endurance limit of a bar that is bent
to and fro, S_e (k + sqrt(1 + k^2))/2 (Findley, *A theory for the effect of mean stress on fatigue
of metals under combined torsion and axial load or bending*, J. Eng. Ind. 81 (1959) 301-306; Socie
and Marquis, *Multiaxial Fatigue*, SAE 2000, chapter 5). k is about 0.3 for ductile steels. The
shear amplitude on a plane is half of the widest extent of the stress that goes round in it. A
largest normal stress in compression counts as none.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, TypeAlias

import numpy as np

from ...base.arguments import NotNegative, Numeric, public
from ...base.arrays import Array
from ...errors import DeclarationError, shown
from ...model.beams.material import Material
from .fatigue import Score

FINDLEY = "findley"
"""The criterion's name."""

DUCTILE = 0.3
"""k of ductile steels."""

_Grid: TypeAlias = tuple[tuple[float, int], ...]

_FLAT: _Grid = ((math.pi, 90),)
_SPACE: _Grid = ((math.pi / 2, 9), (math.tau, 24), (math.pi, 12))
"""Spans and numbers of angles that are tried first: with one shear stress, and with two."""

_ROUNDS, _BESIDE, _NEARER = 8, 2, 2.5
"""Number of refinements of the worst plane, of planes on each side, and the factor by which they
come nearer.
"""


@public
@dataclass(frozen=True)
class Plane:
    """The plane on which a history is worst: shear ``amplitude``, largest ``normal`` stress [Pa],
    none in compression, and the plane's ``angle`` to the link's cross-section [rad].
    """

    amplitude: float
    normal: float
    angle: float

    def value(self, share: NotNegative = DUCTILE) -> float:
        """Return the shear amplitude and a share of the normal stress.

        Parameters
        ----------
        share : float
            Findley's k.

        Returns
        -------
        float
            The sum [Pa].
        """
        return self.amplitude + share * self.normal


@public
def critical_plane(values: Annotated[Numeric, "Pa"], share: NotNegative = DUCTILE) -> Plane:
    """Return the critical plane of a history of stresses in a beam, by Findley's criterion.

    Parameters
    ----------
    values : array
        Stresses (3, t) [Pa]: normal, and shear along y and along z.
    share : float
        Findley's k, the weight of the normal stress.

    Returns
    -------
    Plane
        The plane with the largest sum of shear amplitude and k times the largest normal stress.

    Raises
    ------
    DeclarationError
        For other shapes, and for stresses that are not finite.

    Notes
    -----
    W. N. Findley, "A theory for the effect of mean stress on fatigue of metals under combined
    torsion and axial load or bending", J. Eng. Ind. 81 (1959), 301-305.
    """
    if values.ndim != 2 or len(values) != 3 or not values.size or not np.isfinite(values).all():
        raise DeclarationError(
            f"critical_plane: expected finite stresses (3, t), got {shown(values)}"
        )
    if values[1:].any(axis=1).all():
        return _best(values, share, _SPACE)
    # All planes that count go through the direction without stress.
    shear = values[1] if values[1].any() else values[2]
    return _best(np.stack([values[0], shear, np.zeros_like(shear)]), share, _FLAT)


@public
def plane_factor(plane: Plane, material: Material, share: NotNegative = DUCTILE) -> float:
    """Return the factor by which all loads may grow until the critical plane fails by fatigue.

    Parameters
    ----------
    plane : Plane
        Result of :func:`critical_plane`.
    material : Material
        Has the endurance limit in alternating bending.
    share : float
        Findley's k, as given to :func:`critical_plane`.

    Returns
    -------
    float
        The factor of safety.

    Raises
    ------
    DeclarationError
        If the material has no endurance limit.
    """
    (endurance,) = material.needs(f"fatigue by {FINDLEY}", "endurance")
    value = plane.value(share)
    return endurance * (share + math.sqrt(1.0 + share**2)) / 2 / value if value else math.inf


def plane_score() -> Score:
    """Return the score of the worst critical plane: its shear amplitude and a share of its normal
    stress.

    No plane is above a bound from the largest shear and principal stresses.
    """

    def bound(stresses: Array) -> Array:
        normal, shears = stresses[0], stresses[1:]
        wide = np.ptp(normal, axis=-1) ** 2 + 4.0 * np.sum(np.ptp(shears, axis=-1) ** 2, axis=0)
        principal = normal / 2 + np.sqrt((normal / 2) ** 2 + np.sum(shears**2, axis=0))
        return np.asarray(np.sqrt(wide) / 4 + DUCTILE * np.maximum(principal.max(axis=-1), 0.0))

    def of(values: Array) -> float:
        return critical_plane(values).value()

    return Score(of, bound, lambda amplitude, mean: amplitude + DUCTILE * mean)


def _best(values: Array, share: float, tried: _Grid) -> Plane:
    """The worst of planes given by angles: first of an even grid, then of finer ones near it."""
    grids = [(np.arange(n) + 0.5) * span / n for span, n in tried]
    steps = np.array([grid[1] - grid[0] for grid in grids])
    beside = [np.arange(-_BESIDE, _BESIDE + 1) / _BESIDE] * len(grids)
    angles, around = (
        np.stack(np.meshgrid(*rows, indexing="ij"), -1).reshape(-1, len(grids))
        for rows in (grids, beside)
    )
    best, middle = Plane(-1.0, 0.0, 0.0), angles[0]
    for _ in range(_ROUNDS + 1):
        normal, direction = _planes(angles)
        across = np.maximum((_plane_weights(normal, normal) @ values).max(axis=1), 0.0)
        amplitude = np.ptp(_plane_weights(normal, direction) @ values, axis=1) / 2
        k = int(np.argmax(amplitude + share * across))
        found = Plane(
            float(amplitude[k]), float(across[k]), math.acos(min(1.0, abs(float(normal[k, 0]))))
        )
        if found.value(share) > best.value(share):
            best, middle = found, angles[k]
        angles = middle + around * steps
        steps = steps / _NEARER
    return best


def _planes(angles: Array) -> tuple[Array, Array]:
    """Normals of planes by their angle to x and around it, and directions in the planes; by the
    first alone those in the plane of x and y.
    """
    (c, s), *others = ((np.cos(a), np.sin(a)) for a in angles.T)
    (cy, cz), (u, v) = others or [(1.0, 0.0), (1.0, 0.0)]
    normal = np.stack([c, s * cy, s * cz], 1)
    return normal, np.stack([-s * u, c * cy * u - cz * v, c * cz * u + cy * v], 1)


def _plane_weights(n: Array, m: Array) -> Array:
    """Weights of the three stresses in a beam for the stress on planes ``n`` in directions ``m``:
    (planes, 3).
    """
    shears = [n[:, 0] * m[:, k] + n[:, k] * m[:, 0] for k in (1, 2)]
    return np.stack([n[:, 0] * m[:, 0], *shears], 1)
