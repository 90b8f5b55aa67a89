"""The reference: Newton-Euler of the free bodies with 50 digits, as linear equations, and nothing
solved on paper.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from mpmath import mp, mpf

from .paper_case import HALF_ACCELERATION, SPEED, Array, SliderCrank

DIGITS = 50
FORCES = ("O:fx", "O:fy", "A:fx", "A:fy", "B:fx", "B:fy", "guide:fy")


@dataclass(frozen=True)
class _Instant:
    """The linkage at one instant: crank, rod and slider as (coordinate, rate, acceleration), and
    forces by name.
    """

    crank: tuple[Any, Any, Any]
    rod: tuple[Any, Any, Any]
    slider: tuple[Any, Any, Any]
    effort: Any
    reactions: dict[str, Any]


def instants(case: SliderCrank, t: Array) -> dict[str, Array]:
    """Motions, the effort and reactions by the package's names, each (t,)."""
    rows: dict[str, list[Any]] = {}
    with mp.workdps(DIGITS):
        for time in t:
            now = _solve(case, float(time))
            motions = {
                "O": now.crank,
                "A": tuple(b - a for a, b in zip(now.crank, now.rod, strict=True)),
                "guide": now.slider,
            }
            values = {
                f"motion:{j}{end}": m[i]
                for j, m in motions.items()
                for i, end in enumerate(("", "_rate", "_acceleration"))
            }
            values |= {f"reaction:{name}": force for name, force in now.reactions.items()}
            for name, value in (
                values | {"effort:O": now.effort, "reaction:guide:fx": mpf(0)}
            ).items():
                rows.setdefault(name, []).append(value)
        return {name: np.array([float(value) for value in row]) for name, row in rows.items()}


def sections(case: SliderCrank, t: Array, xi: Array) -> Array:
    """Axial, shear and bending of the rod, (3, t, xi)."""
    out = np.empty((3, len(t), len(xi)))
    with mp.workdps(DIGITS):
        for i, time in enumerate(t):
            now = _solve(case, float(time))
            for j, ratio in enumerate(xi):
                out[:, i, j] = [float(force) for force in _cut(case, now, mpf(float(ratio)))]
    return out


def _solve(case: SliderCrank, time: float) -> _Instant:
    """The loop r e(theta) + l e(phi) = (x, 0) and its derivatives, then three equations a bar and
    two for the slider.
    """
    r, l, m1, m2, m3 = map(mpf, case.parameters)
    g, t, half = mpf(case.g), mpf(time), mpf(HALF_ACCELERATION)
    theta, omega, alpha = (half * t + mpf(SPEED)) * t, 2 * half * t + mpf(SPEED), 2 * half
    phi = mp.findroot(lambda angle: r * mp.sin(theta) + l * mp.sin(angle), mpf(0))
    (cx, cy), (ex, ey) = _direction(theta), _direction(phi)
    loop = mp.matrix([[-l * ey, -1], [l * ex, 0]])  # by phi and x
    spin, speed = mp.lu_solve(loop, mp.matrix([r * omega * cy, -r * omega * cx]))
    across, inward = mp.matrix([-cy, cx]) * (r * alpha), mp.matrix([cx, cy]) * (r * omega**2)
    turn, acceleration = mp.lu_solve(loop, inward + mp.matrix([ex, ey]) * (l * spin**2) - across)

    a = across - inward  # of A
    rod = a + _relative(ex, ey, l / 2, spin, turn)  # of the rod's centre
    h, k = r / 2, l / 2
    equations = [  # effort, then FORCES: on the child, so the parent gets the opposite
        ([0, 1, 0, -1, 0, 0, 0, 0], m1 * a[0] / 2),
        ([0, 0, 1, 0, -1, 0, 0, 0], m1 * (a[1] / 2 + g)),
        ([1, h * cy, -h * cx, h * cy, -h * cx, 0, 0, 0], m1 * r**2 / 12 * alpha),
        ([0, 0, 0, 1, 0, -1, 0, 0], m2 * rod[0]),
        ([0, 0, 0, 0, 1, 0, -1, 0], m2 * (rod[1] + g)),
        ([0, 0, 0, k * ey, -k * ex, k * ey, -k * ex, 0], m2 * l**2 / 12 * turn),
        ([0, 0, 0, 0, 0, 1, 0, 0], m3 * acceleration),
        ([0, 0, 0, 0, 0, 0, 1, 1], m3 * g),
    ]
    effort, *forces = mp.lu_solve(
        mp.matrix([row for row, _ in equations]), mp.matrix([value for _, value in equations])
    )
    position = r * cx + l * ex
    reactions = dict(zip(FORCES, forces, strict=True))
    return _Instant(
        (theta, omega, alpha), (phi, spin, turn), (position, speed, acceleration), effort, reactions
    )


def _cut(case: SliderCrank, now: _Instant, ratio: Any) -> tuple[Any, Any, Any]:
    """Newton-Euler of the piece from the section to the tip, about its own centre."""
    r, l, whole, g = mpf(case.r), mpf(case.l), mpf(case.m2), mpf(case.g)
    (theta, omega, alpha), (phi, spin, turn) = now.crank, now.rod
    (cx, cy), (ex, ey) = _direction(theta), _direction(phi)
    length, mass = l * (1 - ratio), whole * (1 - ratio)
    centre = _relative(cx, cy, r, omega, alpha) + _relative(ex, ey, l - length / 2, spin, turn)
    tx, ty = -now.reactions["B:fx"], -now.reactions["B:fy"]  # the slider on the tip
    sx, sy = mass * centre[0] - tx, mass * (centre[1] + g) - ty  # the inboard part on the piece
    arm = length / 2
    couple = mass * length**2 / 12 * turn - arm * (ex * ty - ey * tx) + arm * (ex * sy - ey * sx)
    return -(sx * ex + sy * ey), -(sy * ex - sx * ey), -couple


def _direction(angle: Any) -> tuple[Any, Any]:
    return mp.cos(angle), mp.sin(angle)


def _relative(ex: Any, ey: Any, length: Any, spin: Any, turn: Any) -> Any:
    """The acceleration of a bar's point with respect to its base."""
    return mp.matrix([-ey, ex]) * (length * turn) - mp.matrix([ex, ey]) * (length * spin**2)


def chain(n: int, t: Array) -> Array:
    """Efforts of an open chain of uniform links, (n, t), driven as in :mod:`.pinocchio_chain`:
    Newton-Euler, tip to base.
    """
    length, mass, gravity = mpf("0.5"), mpf(1), mpf("9.81")
    out = np.empty((n, len(t)))
    with mp.workdps(DIGITS):
        for i, time in enumerate(map(mpf, map(float, t))):
            angle, base, links = mpf(0), mp.matrix([0, gravity]), []
            for k in range(n):
                angle += mpf(0.1 * k) + time + mpf(0.2) * time**2
                rate, turn = (k + 1) * (1 + 2 * mpf(0.2) * time), (k + 1) * 2 * mpf(0.2)
                e = _direction(angle)
                links.append((e, base + _relative(*e, length / 2, rate, turn), turn))
                base = base + _relative(*e, length, rate, turn)
            force, couple = mp.matrix([0, 0]), mpf(0)
            for k, (e, centre, turn) in reversed(list(enumerate(links))):
                own = mass * centre
                couple += mass * length**2 / 12 * turn + length / 2 * (
                    e[0] * own[1] - e[1] * own[0]
                )
                couple += length * (e[0] * force[1] - e[1] * force[0])
                force += own
                out[k, i] = float(couple)
    return out
