"""Polynomials from 0 to 1 in Bernstein's form, many at once: values, parts, products and zeros.

Ordinates ``c`` (n + 1, ...) are those of

    p(x) = sum_i c[i] binom(n, i) x^i (1 - x)^(n - i).

The first and the last are the values at 0 and at 1, and p is between the smallest and the largest.
Every operation takes numbers one by one, so the bits of one polynomial do not depend on how many
there are.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from math import comb
from typing import NamedTuple

import numpy as np

from .arrays import Array, Operand

_STEPS = 60
"""Steps of Newton's method at most."""

_CLOSE = float(np.sqrt(np.finfo(float).eps))
"""Length of a step of Newton's method that leaves a miss of rounding, for it squares the miss."""

EIGHTHS = np.arange(8.0) / 8.0
"""Begins of the eighths of 0 to 1."""


def value(c: Array, x: Array) -> Array:
    """The values (k, ...) of polynomials at places ``x`` (k, ...) of each.

    Terms follow from one another as by Horner's rule; at 0 and at 1 they are the ordinates.
    """
    n, beside = len(c) - 1, 1.0 - x
    if not n:
        return np.asarray(c[0] + np.zeros(x.shape))
    total, power = c[0] * beside, x
    for i in range(1, n):
        total += power * (comb(n, i) * c[i])
        total *= beside
        power = power * x
    total += power * c[n]
    return np.asarray(total)


def slope(c: Array) -> Array:
    """Ordinates (n, ...) of the derivatives of polynomials."""
    return np.asarray((len(c) - 1) * np.diff(c, axis=0))


def product(a: Array, b: Array) -> Array:
    """Ordinates of the products of polynomials."""
    n, m = len(a) - 1, len(b) - 1
    found = np.zeros((n + m + 1, *np.broadcast_shapes(a.shape[1:], b.shape[1:])))
    for i in range(n + 1):
        for j in range(m + 1):
            found[i + j] += (comb(n, i) * comb(m, j) / comb(n + m, i + j) * a[i]) * b[j]
    return found


def raised(c: Array, degree: int) -> Array:
    """Ordinates of polynomials as polynomials of a degree that is as high or higher."""
    return c if len(c) > degree else product(c, np.ones(degree + 2 - len(c)))


def of_powers(coefficients: Sequence[Operand], line: Array) -> Array:
    """Ordinates of sum_j coefficients[j] y^j, where y has the ordinates ``line`` (2, ...)."""
    found: Array = np.zeros((1, *line.shape[1:])) + coefficients[-1]
    for coefficient in reversed(coefficients[:-1]):
        found = product(found, line) + coefficient
    return found


def halves(c: Array) -> tuple[Array, Array]:
    """Ordinates of polynomials on both halves of 0 to 1 (de Casteljau)."""
    first, last = [c[0]], [c[-1]]
    while len(c) > 1:
        c = (c[:-1] + c[1:]) / 2.0
        first.append(c[0])
        last.append(c[-1])
    return np.stack(first), np.stack(last[::-1])


def eighths(c: Array) -> Array:
    """Ordinates (n + 1, k, 8 m, t) of polynomials (n + 1, k, m, t) on eighths of 0 to 1.

    One matrix gives all of a polynomial: its bits depend on the number of instants t alone.
    """
    found = _eighths(len(c)) @ np.moveaxis(c, 0, 2)
    return np.moveaxis(found.reshape(c.shape[1], -1, len(c), c.shape[3]), 2, 0)


@functools.cache
def _eighths(many: int) -> Array:
    """Ordinates of eighths, one after another, (8 many, many) by those of the whole."""
    found = within(np.eye(many)[:, None], EIGHTHS[:, None], EIGHTHS[:, None] + 0.125)
    return np.concatenate(np.moveaxis(found, 1, 0))


def within(c: Array, start: Array, stop: Array) -> Array:
    """Ordinates of polynomials on parts from ``start`` to ``stop`` (...) of 0 to 1."""
    first = np.divide(start, stop, out=np.zeros(stop.shape), where=stop > 0.0)
    return np.asarray(_begun(_begun(c, stop)[::-1], 1.0 - first)[::-1])


def _begun(c: Array, x: Array) -> Array:
    """Ordinates on parts from 0 to ``x`` (...) (de Casteljau)."""
    found: Array = c + np.zeros(x.shape)
    for i in range(1, len(c)):
        found[i:] = found[i - 1 : -1] + x * np.diff(found[i - 1 :], axis=0)
    return found


class Zeros(NamedTuple):
    """Zeros from 0 to 1 of polynomials of degree n: ``places`` (n, ...), all zeros among them, and
    ``turns``, 1 where a polynomial falls through zero there, -1 where it rises, else 0.

    Of degree 2 the first is that at which it falls, or is nearest to falling; beyond, they are in
    order.
    """

    places: Array
    turns: Array


def zeros(c: Array) -> Zeros:
    """Find the zeros of polynomials.

    To degree 2 they are the roots, kept from 0 to 1. Beyond, signs of ordinates decide: without a
    change there is no zero, with one there is one. With more there is one zero or none between two
    zeros of the derivative.
    """
    n = len(c) - 1
    if n <= 2:
        return _roots(c)
    flat = c.reshape(n + 1, -1)
    places, turns = np.zeros((2, n, flat.shape[1]))
    places[:] = np.abs(flat[n]) < np.abs(flat[0])  # the end that is nearer to a zero
    changes = np.diff(flat < 0.0, axis=0).sum(axis=0)
    for single in (True, False):
        chosen = np.flatnonzero(changes == 1 if single else changes > 1)
        if chosen.size:
            few = flat[:, chosen]
            inner = few[:0] if single else zeros(slope(few)).places
            found = _between(few, np.sort(inner, axis=0))
            places[:, chosen], turns[: len(found.turns), chosen] = found
    return Zeros(places.reshape(n, *c.shape[1:]), turns.reshape(n, *c.shape[1:]))


def _roots(c: Array) -> Zeros:
    """The zeros of polynomials up to degree 2; the root that would cancel comes from the other."""
    with np.errstate(all="ignore"):
        if len(c) < 3:
            roots = c[:-1] / (c[:-1] - c[1:])
            turns = np.where((roots > 0.0) & (roots < 1.0), np.sign(c[:-1]), 0.0)
        else:
            half, bend = c[1] - c[0], c[0] - 2.0 * c[1] + c[2]
            root = np.sqrt(np.maximum(half * half - bend * c[0], 0.0))
            far = -half - np.where(half > 0.0, root, -root)
            one = far / bend
            other = np.where(root > 0.0, c[0] / far, one)
            falls = half > 0.0
            roots = np.stack([np.where(falls, one, other), np.where(falls, other, one)])
            inside = (roots > 0.0) & (roots < 1.0) & (root > 0.0)
            turns = np.where(inside, np.array([1.0, -1.0]).reshape(2, *(1,) * half.ndim), 0.0)
    return Zeros(np.fmin(np.fmax(roots, 0.0), 1.0), turns)


def _between(c: Array, inner: Array) -> Zeros:
    """The zeros of polynomials (n + 1, m) that have one or none between 0, ``inner`` (k, m) and 1:
    by Newton's method kept within what encloses each. If there is none, the nearer end.
    """
    bounds = np.pad(inner, [(1, 1), (0, 0)], constant_values=((0.0, 1.0), (0.0, 0.0)))
    values = value(c, bounds)
    nearer = np.abs(values[:-1]) <= np.abs(values[1:])
    places, rises = np.where(nearer, bounds[:-1], bounds[1:]), values[:-1] < 0.0
    row, column = np.nonzero(rises != (values[1:] < 0.0))
    turns, rising = np.zeros(places.shape), rises[row, column]
    turns[row, column] = np.where(rising, -1.0, 1.0)
    low, high, c = bounds[row, column], bounds[row + 1, column], c[:, column]
    rate, left, at_low = slope(c), np.arange(row.size), values[row, column]
    x = low + (high - low) * (at_low / (at_low - values[row + 1, column]))
    for _ in range(_STEPS):
        now = value(c, x[None])[0]
        before = (now < 0.0) == rising
        low, high = np.where(before, x, low), np.where(before, high, x)
        with np.errstate(all="ignore"):
            step = now / value(rate, x[None])[0]
        step[now == 0.0] = 0.0  # 0/0 where zeros meet
        ahead, tight = x - step, high - low <= _CLOSE
        # At an end that is a zero, too, there is another one between.
        trusted = ((ahead > low) & (ahead < high)) | tight
        more = ~(trusted & (np.abs(step) <= _CLOSE))
        x = np.where(trusted, np.clip(ahead, low, high), (low + high) / 2.0)
        if not more.all():
            places[row[left], column[left]] = x
            left, low, high, x, rising = (one[more] for one in (left, low, high, x, rising))
            c, rate = c[:, more], rate[:, more]
        if not left.size:
            break
    places[row[left], column[left]] = x
    return Zeros(places, turns)


@functools.cache
def nodes(degree: int) -> Array:
    """Places from 0 to 1 at which values make polynomials of a degree (:func:`interpolated`)."""
    return np.asarray((1.0 + np.polynomial.chebyshev.chebpts1(degree + 1)) / 2.0)


def interpolated(values: Array) -> Array:
    """Ordinates (n + 1, ...) of the polynomials that have ``values`` (n + 1, ...) at the nodes."""
    found = np.zeros(values.shape)
    for weights, value_at_node in zip(_weights(len(values) - 1), values, strict=True):
        found += np.multiply.outer(weights, value_at_node)
    return found


@functools.cache
def _weights(degree: int) -> Array:
    """Weights (nodes, ordinates) of values at nodes in ordinates."""
    return np.asarray(np.linalg.inv(value(np.eye(degree + 1), nodes(degree)[:, None])).T, float)
