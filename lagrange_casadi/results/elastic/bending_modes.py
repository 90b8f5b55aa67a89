"""The first natural frequency of a slender beam, from both sides.

From above: the Rayleigh quotients of Hermite's cubics on equal parts of the beam (Ritz). From
below: the sum of 1/w^2 over all modes is the integral of m(x) G(x, x), with G the deflection at x
by a unit force there (the trace of Green's operator; Dunkerley, *On the whirling and vibration of
shafts*, Phil. Trans. R. Soc. A 185, 1894, has the first sum alone). Ritz's frequencies of the
higher modes are too high, so

    1/w_1^2 <= integral of m G - sum over k > 1 of 1/w_k^2.

Shear, rotary inertia and axial force are left out: they lower the frequency of stout beams, and of
compressed ones.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from ...model.end_conditions import Ends

_PARTS, _POINTS = 32, 5

_HELD = {
    "pinned": (True, False),
    "clamped": (True, True),
    "free": (False, False),
    "guided": (False, True),
}
"""Marks of an end: true if it holds its place, and its slope."""

_LINES = np.array([[1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.0, 1.0]])
"""Place and slope of a + b u at the base, and at the tip."""


@dataclass(frozen=True, eq=False)
class Mode:
    """The first bending mode of a beam: bounds of its angular frequency, ``upper`` and ``lower``
    [rad/s], the latter None where the beam can move as a whole; infinite without mass. At ratios
    ``u`` with ``weights`` [m], which sum polynomials, ``curvature`` is that of the mode of unit
    modal mass.
    """

    upper: float
    lower: float | None
    u: Array
    weights: Array
    curvature: Array


def first_mode(
    stiffness: Callable[[Array], Array],
    mass: Callable[[Array], Array],
    length: float,
    breaks: tuple[float, ...],
    ends: Ends,
) -> Mode:
    """The first mode of a beam of a length [m] by its bending ``stiffness`` EI [N m^2] and ``mass``
    per length [kg/m], functions of the ratio xi/l that are smooth between two ``breaks``.
    """
    edges = np.concatenate(
        [
            *(
                np.linspace(a, b, max(4, round(_PARTS * (b - a))) + 1)[:-1]
                for a, b in itertools.pairwise(breaks)
            ),
            [1.0],
        ]
    )
    x, w = np.polynomial.legendre.leggauss(_POINTS)
    s = (x + 1) / 2
    low, width = edges[:-1, None], np.diff(edges)[:, None]
    u, weights = low + width * s, length * width * w / 2
    h = length * width
    rigidity, masses = weights * stiffness(u), weights * mass(u)
    # Hermite's cubics and their curvatures, in deflection and slope at both ends of a part.
    shape = np.stack(
        [1 - 3 * s**2 + 2 * s**3, s - 2 * s**2 + s**3, 3 * s**2 - 2 * s**3, -(s**2) + s**3]
    )
    bent = np.stack([12 * s - 6, 6 * s - 4, 6 - 12 * s, 6 * s - 2])
    units = np.stack([np.ones_like(h[:, 0]), h[:, 0]] * 2)
    parts, size = len(h), 2 * len(edges)
    curved = bent[:, None] * units[:, :, None] / h[None] ** 2
    moved = shape[:, None] * units[:, :, None]
    k, m = np.zeros((size, size)), np.zeros((size, size))
    at = 2 * np.arange(parts)[:, None] + np.arange(4)
    for into, shapes, factor in ((k, curved, rigidity), (m, moved, masses)):
        np.add.at(
            into,
            (at[:, :, None], at[:, None, :]),
            np.einsum("ipn,pn,jpn->pij", shapes, factor, shapes),
        )
    held = np.array([_HELD[end] for end in ends])
    kept = np.ones(size, bool)
    kept[[0, 1, -2, -1]] = ~held.ravel()
    rigid = 2 - int(np.linalg.matrix_rank(_LINES * held.reshape(4, 1)))
    whole = np.sum(masses)
    if whole == 0.0:
        return Mode(np.inf, None if rigid else np.inf, u.ravel(), weights.ravel(), np.zeros(u.size))
    # By flexibilities, for parts may be without mass; what can move as a whole is held by so much
    # of its mass.
    holding = np.pi**4 / length**4 * np.sum(rigidity) / whole if rigid else 0.0
    stiff, heavy = (matrix[np.ix_(kept, kept)] for matrix in (k, m))
    lower = np.linalg.cholesky(stiff + holding * heavy)
    half = np.linalg.solve(lower, heavy)
    flexible, vectors = (
        found[..., ::-1] for found in np.linalg.eigh(np.linalg.solve(lower, half.T))
    )
    mode = np.zeros(size)
    mode[kept] = np.linalg.solve(lower.T, vectors[:, rigid]) / np.sqrt(flexible[rigid])
    curvature = np.einsum("pi,ipn->pn", mode[at], curved)
    # Rayleigh's quotient of any shape is above; the square of the matrices is off by what the
    # highest modes are rounded by.
    most = np.sum(rigidity * curvature**2) / np.sum(
        masses * np.einsum("pi,ipn->pn", mode[at], moved) ** 2
    )
    bound = None
    if not rigid:
        rest = np.sum(masses * _sag(stiffness, length, edges, u, held)) - np.sum(flexible[1:])
        bound = float(min(1.0 / np.sqrt(rest), np.sqrt(most)))
    return Mode(float(np.sqrt(most)), bound, u.ravel(), weights.ravel(), curvature.ravel())


def _sag(
    stiffness: Callable[[Array], Array],
    length: float,
    edges: Array,
    u: Array,
    held: npt.NDArray[np.bool_],
) -> Array:
    """The deflection at ratios by a unit force there: the least energy of all bending moments that
    the force and the ends leave.

    At a ratio x moments over the length are max(x - u, 0) + a + b u. An end that does not hold its
    slope bears no moment, one that does not hold its place no force.
    """
    x = u.ravel()
    sums = _moments(stiffness, edges, np.append(x, 1.0))
    here, whole = sums[:, :-1], sums[:, -1]
    bears_none = ~held[:, ::-1].ravel()
    lines = _LINES[bears_none]
    nothing = np.zeros_like(x)
    needed = np.stack([-x, nothing + 1.0, nothing, nothing])[bears_none]
    energy = np.array([whole[:2], whole[1:]])
    by_force = x * here[:2] - here[1:]
    matrix = np.block([[energy, lines.T], [lines, np.zeros((len(lines), len(lines)))]])
    line = np.linalg.solve(matrix, np.concatenate([-by_force, needed]))[:2]
    own = x**2 * here[0] - 2 * x * here[1] + here[2]
    found = own + np.sum(line * (2 * by_force + energy @ line), axis=0)
    return np.asarray(length**3 * found).reshape(u.shape)


def _moments(stiffness: Callable[[Array], Array], edges: Array, ratios: Array) -> Array:
    """The integrals from the base to ratios of u^k/EI du, k = 0, 1, 2: (3, n)."""
    x, w = np.polynomial.legendre.leggauss(2 * _POINTS)

    def between(a: Array, b: Array) -> Array:
        v = a[:, None] + (b - a)[:, None] * (x + 1) / 2
        flow = (b - a)[:, None] * w / 2 / stiffness(v)
        return np.stack([np.sum(flow * v**k, axis=1) for k in range(3)])

    whole = np.concatenate(
        [np.zeros((3, 1)), np.cumsum(between(edges[:-1], edges[1:]), axis=1)], axis=1
    )
    part = np.clip(np.searchsorted(edges, ratios, side="right") - 1, 0, len(edges) - 2)
    return np.asarray(whole[:, part] + between(edges[part], ratios))
