"""The closed form in NumPy: arrays of t for the coefficients, then the forces on the (t, xi) grid
by broadcasting.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .paper_case import Array, SliderCrank, Work


@dataclass(frozen=True)
class _Rod:
    """The rod's angle and direction, rate and acceleration, the acceleration of its base, and its
    action on the slider.
    """

    phi: Array
    cos: Array
    sin: Array
    spin: Array
    turn: Array
    ax: Array
    ay: Array
    acceleration: Array
    bx: Array
    by: Array

    def law(self, g: float) -> tuple[Array, ...]:
        """n0, n1, n2, f0, f1, f2."""
        c, s, up = self.cos, self.sin, self.ay + g
        along = (-self.bx * c - self.by * s, -self.ax * c - up * s, self.spin**2)
        return *along, self.bx * s - self.by * c, self.ax * s - up * c, -self.turn


def instants(case: SliderCrank, t: Array) -> Work:
    """What returns the package's columns of ``wanted="all"``, (columns, t)."""

    def call() -> Array:
        r, l, m1, m2, m3 = case.parameters
        g = case.g
        theta, omega, alpha = case.motion(t)
        rod = _rod(case, theta, omega, alpha)
        c, s, zero = np.cos(theta), np.sin(theta), np.zeros_like(t)
        guide = r * c + l * rod.cos
        fx, fy = rod.bx + m2 * (rod.ax + rod.acceleration) / 2, rod.by + m2 * (rod.ay / 2 + g)
        motion = [theta, omega, alpha, rod.phi - theta, rod.spin - omega, rod.turn - alpha]
        slide = [guide, -r * s * omega - l * rod.sin * rod.spin, rod.acceleration]
        pose = [zero, zero, theta, r * c, r * s, rod.phi, guide, zero]
        effort = r * (fy * c - fx * s) + m1 * r * (g * c / 2 + r * alpha / 3)
        at_ground = [fx + m1 * rod.ax / 2, fy + m1 * (rod.ay / 2 + g)]
        reactions = [*at_ground, fx, fy, rod.bx, rod.by, zero, m3 * g - rod.by]
        crank = [-fx * c - fy * s, -g * s, omega**2, fx * s - fy * c, -g * c, -alpha, zero]
        return np.stack([*motion, *slide, *pose, effort, *reactions, *crank, *rod.law(g), zero])

    return call


def designs(case: SliderCrank, t: Array, lengths: Array) -> Work:
    """The same for one length of the rod after another; what is left is the last one's."""
    works = [instants(replace(case, l=float(length)), t) for length in lengths]
    return lambda: [work() for work in works][-1]


def sections(case: SliderCrank, t: Array, xi: Array) -> Work:
    """What returns axial, shear and bending of the rod, (3, t, xi), as polynomials of the part
    beyond the section.
    """

    def call() -> Array:
        n0, n1, n2, f0, f1, f2 = _rod(case, *case.motion(t[:, None])).law(case.g)
        l, m, v = case.l, case.m2, 1.0 - xi
        out = np.empty((3, len(t), len(xi)))
        out[0] = n0 + v * (m * (n1 + l * n2) - m * l / 2 * n2 * v)
        out[1] = f0 + v * (m * (f1 + l * f2) - m * l / 2 * f2 * v)
        out[2] = l * v * (f0 + v * (m / 2 * (f1 + l * f2) - m * l / 6 * f2 * v))
        return out

    return call


def _rod(case: SliderCrank, theta: Array, omega: Array, alpha: Array) -> _Rod:
    r, l, _, m2, m3 = case.parameters
    c, s = np.cos(theta), np.sin(theta)
    sin = -r / l * s
    cos = np.sqrt(1.0 - sin**2)
    spin = -r * c * omega / (l * cos)
    ax, ay = -r * (c * omega**2 + s * alpha), r * (c * alpha - s * omega**2)
    turn = (sin * spin**2 - ay / l) / cos
    acceleration = ax - l * (cos * spin**2 + sin * turn)
    bx = m3 * acceleration
    by = ((bx + m2 * ax / 2) * sin - m2 * l * turn / 3) / cos - m2 * (
        ay + case.g
    ) / 2  # the rod's moments about its base
    return _Rod(np.arcsin(sin), cos, sin, spin, turn, ax, ay, acceleration, bx, by)
