"""Functions of a number drawn from all operations that a graph may hold, and whether they have a
kink: by halving steps alone. Scenes whose motion, constraint or lift is such a function.
"""

from __future__ import annotations

from typing import NamedTuple

import casadi as ca
import numpy as np
from operations import EACH, X, Y

from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.elements import disc_cam
from lagrange_casadi.motion import expression, polynomial

T, K = ca.SX.sym("t"), ca.SX.sym("k")
_STEPS, _HALVINGS, _LARGEST = 20000, 26, 100
_BESIDE = 1e-6


class Verdict(NamedTuple):
    """Whether something is "smooth" or "broken" from 0 to 1; else "unclear", or "nothing" where it
    is no number.
    """

    what: str
    values: np.ndarray


def smooth(r, t, k):
    """A function without a kink."""
    a, w = r.choice([0.3, 0.7, 1.0, 2.0]), r.choice([1.0, 3.0, 7.0])
    b, c = r.uniform(-1, 1), r.choice([0.0, 0.0, 0.5, 1.0, -1.0])
    kinds = (
        a * ca.sin(w * t + b) + c,
        w * (t - abs(b)),
        a * (t - abs(b)) ** 2 + k * c,
        a * ca.cos(w * t) + c + 0.2 * k,
        ca.exp(a * t) - 1 - k * b,
        a + t,
    )
    return kinds[r.integers(len(kinds))]


def drawn(r, depth=None):
    """An expression of T and K with operations upon operations, up to three of them."""
    depth = int(r.integers(3)) if depth is None else depth
    x, y = (
        drawn(r, depth - 1) if depth and r.random() < 0.5 else smooth(r, T, K) for _ in range(2)
    )
    found = ca.substitute(
        list(EACH.values())[r.integers(len(EACH))], ca.vertcat(X, Y), ca.vertcat(x, y)
    )
    beside = r.random()
    if beside < 0.5:
        found = found * smooth(r, T, K) if beside < 0.3 else found + smooth(r, T, K)
    return ca.SX(found)


def curve(expression, k):
    """The function of times (n,) to value and slope (2, n)."""
    function = ca.Function("curve", [T, K], [expression, ca.gradient(expression, T)])
    return lambda t: np.array([row.full().ravel() for row in function(ca.DM(t).T, k)])


def verdict(expression, k):
    """Halve steps, always to the side on which more changes: what does not fall with them is a
    kink.
    """
    f = curve(expression, k)
    t = np.linspace(0.0, 1.0, _STEPS + 1)
    values = f(t)
    if not np.isfinite(values).all():
        return Verdict("nothing", values)
    scale = np.quantile(np.abs(values), 0.99, axis=1)[:, None] + 1e-12
    worst, place, largest = 0.0, 0.5, (np.abs(values) / scale).max()
    for row in range(2):
        some = np.argsort(-np.abs(np.diff(values[row])))[:_LARGEST]
        low, high, before, after = t[some], t[some + 1], values[:, some], values[:, some + 1]
        for _ in range(_HALVINGS):
            middle = (low + high) / 2
            there = f(middle)
            if not np.isfinite(there).all():
                return Verdict("nothing", values)
            left = np.abs(there - before)[row] > np.abs(after - there)[row]
            low, high = np.where(left, low, middle), np.where(left, middle, high)
            before, after = np.where(left, before, there), np.where(left, there, after)
            largest = max(largest, (np.abs(there) / scale).max())
        rest = (np.abs(after - before) / scale)[row]
        if rest.max() > worst:
            worst, place = rest.max(), low[rest.argmax()]
    if worst > 1e-3 or largest > 1e4:
        # What is one thing at a single place and another beside it on both sides is both.
        aside = f(np.clip(place + _BESIDE * np.array([-1.0, 1.0]), 0.0, 1.0))
        there = np.abs(np.diff(aside)) / scale
        clear = _BESIDE < place < 1.0 - _BESIDE and (largest > 1e4 or there.max() > worst / 10)
        return Verdict("broken" if clear else "unclear", values)
    return Verdict("smooth" if worst < 1e-7 and largest < 50.0 else "unclear", values)


def shown(expression, k, place, low=0.0):
    """Whether value or slope differ across a place, however near to it: a kink that halving went by
    for it is small.
    """
    near = curve(expression, k)(
        np.clip(place + 1e-8 * np.array([-4.0, -2.0, -1.0, 1.0, 2.0, 4.0]), low, 1.0)
    )
    gaps = np.abs(near[:, [3, 4, 5]] - near[:, [2, 1, 0]])
    return bool(
        (gaps[:, 0] > 0.6 * gaps[:, 2]).any()
        and (gaps[:, 0] > 1e-7 * np.abs(near).max(axis=1)).any()
    )


def told_by_limits(expression, k, place=0.0):
    """By values, slopes and curvatures at ever smaller distances: "kink", "isolated" or "smooth";
    None where it is not clear.
    """
    slope = ca.gradient(expression, T)
    f = ca.Function("f", [T, K], [ca.densify(ca.vertcat(expression, slope, ca.gradient(slope, T)))])
    with np.errstate(all="ignore"):
        here = f(place, k).full().ravel()
        h = 2.0 ** -np.arange(6, 12)
        rows = np.array([[f(place + way * one, k).full().ravel() for one in h] for way in (-1, 1)])
    if not (np.isfinite(here).all() and np.isfinite(rows).all()):
        return None
    for part in (2.0, 4.0, 8.0):
        # A power series in h loses a term.
        rows = (part * rows[:, 1:] - rows[:, :-1]) / (part - 1)
    if np.abs(rows[:, -1] - rows[:, -2]).max() > 1e-5:
        return None
    before, after = rows[:, -1]
    if np.abs(after - before)[:2].max() > 1e-4:
        return "kink"
    low, high = np.minimum(before, after), np.maximum(before, after)
    return "isolated" if ((here < low - 1e-4) | (here > high + 1e-4)).any() else "smooth"


def slide(law, t=(0.0, 1.0, 101), default=0.0):
    """A slide whose motion is a law of time and of a parameter k."""
    m = Mechanism("slide")
    body, k = m.point_mass("body", 2.0), m.parameter("k", default)
    m.prismatic("way", m.ground, body, axis=(1, 0))
    return Scene(m, {"way": expression(lambda t: law(t, k))}, t=t, wanted=("effort",))


def constraint(law, t=(0.0, 1.0, 101), default=0.0):
    """A slide whose place is a law of a crank's angle and of a parameter k."""
    m = Mechanism("constraint")
    crank, body = m.link("crank", length=0.1, mass=1.0), m.point_mass("body", 2.0)
    k, turn = m.parameter("k", default), m.revolute("turn", m.ground, crank)
    way = m.prismatic("way", m.ground.at(0.0, 0.2), body, axis=(0, 1))
    m.constraint("profile", m.coordinate(way) - law(m.coordinate(turn), k))
    return Scene(m, {"turn": polynomial(0.0, 1.0)}, t=t, wanted=("effort",))


def cam(law, t=(0.0, 1.0, 101), turn=None, default=0.0):
    """A cam whose lift is a law of its angle and of a parameter k."""
    m = Mechanism("cam")
    wheel, rod = (m.link(name, length=0.1, mass=1.0) for name in ("wheel", "rod"))
    k, main = m.parameter("k", default), m.revolute("turn", m.ground, wheel)
    lead = m.prismatic("lead", m.ground, rod, axis=(0, 1), angle="90 deg")
    disc_cam(m, "profile", main, lead, lambda x: law(x, k), base_radius=0.1, roller=0.01)
    return Scene(m, {"turn": turn or polynomial(0.0, 1.0)}, t=t, wanted=("effort",))
