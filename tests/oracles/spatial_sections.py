"""What is inside a rod: the balance of its slices and of what acts on it, towards the tip of a
section.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from arithmetic import TOLERANCE
from spatial_algebra import cross
from spatial_balance import Acting, shares
from spatial_bodies import Rod


@dataclass(frozen=True)
class Section:
    """A rod's sections at an instant; ``acting`` is everything on it but gravity."""

    rod: Rod
    pose: object
    gravity: np.ndarray
    acting: list[Acting]

    def at(self, xi, weight=True):
        """[N, Vy, Vz, T, My, Mz], body axes: the part towards the tip on that towards the base, at
        a ratio.

        What acts at the section itself acts on the part towards the base; at the very tip beyond
        it. Without ``weight`` the slices are left out.
        """
        pose, xi, length = self.pose, float(xi), float(self.rod.length)
        place = pose.at(np.array([xi * length, 0.0, 0.0]))
        force = moment = np.zeros(3)
        acting = [one for one in self.acting if one.of is None and self._beyond(one, xi, length)]
        for spread in {id(one.of): one.of for one in self.acting if one.of is not None}.values():
            low = max(float(spread.start), xi * length)
            acting += shares(spread, pose, low, float(spread.end))
        for one in acting:
            force = force + one.force
            moment = moment + one.moment + cross(one.place - place, one.force)
        for x, mass, inertia in self.rod.slices(xi) if weight else ():
            point = np.array([x, 0.0, 0.0])
            needed = (pose.acceleration(point) - self.gravity) * mass
            inertia = pose.R @ inertia @ pose.R.T
            couple = inertia @ pose.alpha + cross(pose.w, inertia @ pose.w)
            force = force - needed
            moment = moment - couple - cross(pose.at(point) - place, needed)
        return np.concatenate([pose.R.T @ force, pose.R.T @ moment])

    def _beyond(self, one, xi, length):
        x = (one.place - self.pose.r) @ self.pose.R[:, 0]
        near = 100 * TOLERANCE * length
        return x > xi * length + near or (xi == 1 and x > length - near)
