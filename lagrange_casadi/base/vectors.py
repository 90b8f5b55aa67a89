"""Vectors as three expressions.

What is zero by structure is the number 0, so that graphs hold nothing of it.
"""

from __future__ import annotations

import math

import casadi as ca

from .arrays import Expression as Expression
from .scalars import added, as_expression, less, product, products_added, products_less

Vector = tuple[Expression, Expression, Expression]

ZERO: Vector = (0.0, 0.0, 0.0)
AXES: tuple[Vector, Vector, Vector] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def plus(a: Vector, b: Vector) -> Vector:
    """Return a + b."""
    return added(a[0], b[0]), added(a[1], b[1]), added(a[2], b[2])


def minus(a: Vector, b: Vector) -> Vector:
    """Return a - b."""
    return less(a[0], b[0]), less(a[1], b[1]), less(a[2], b[2])


def times(factor: Expression, a: Vector) -> Vector:
    """A vector by a factor."""
    return product(factor, a[0]), product(factor, a[1]), product(factor, a[2])


def dot(a: Vector, b: Vector) -> Expression:
    """Return a . b."""
    return added(products_added(a[0], b[0], a[1], b[1]), product(a[2], b[2]))


def norm(a: Vector) -> Expression:
    """Return the length of a vector: a number where all three are."""
    if all(isinstance(component, float) for component in a):
        return math.hypot(*a)
    return ca.sqrt(ca.SX(dot(a, a)))


def cross(a: Vector, b: Vector) -> Vector:
    """Return a x b."""
    return (
        products_less(a[1], b[2], a[2], b[1]),
        products_less(a[2], b[0], a[0], b[2]),
        products_less(a[0], b[1], a[1], b[0]),
    )


def nil(value: Expression) -> bool:
    """Return whether a value is zero by structure."""
    return bool(as_expression(value).is_zero())
