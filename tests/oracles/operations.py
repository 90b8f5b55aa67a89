"""Each operation that a graph may hold, on one number or two."""

from __future__ import annotations

import casadi as ca

UNARY = (
    "sin cos tan asin acos atan sinh cosh tanh asinh acosh atanh exp log log1p expm1 erf sqrt floor"
    " ceil fabs sign"
)
BINARY = "atan2 hypot fmin fmax fmod copysign remainder"
X, Y = ca.SX.sym("x"), ca.SX.sym("y")
EACH = {name: getattr(ca, name)(X) for name in UNARY.split()} | {
    name: getattr(ca, name)(X, Y) for name in BINARY.split()
}
EACH |= {
    "not": ca.logic_not(X),
    "and": ca.logic_and(X, Y),
    "or": ca.logic_or(X, Y),
    "lt": X < Y,
    "le": X <= Y,
    "eq": X == Y,
}
EACH |= {
    "ne": X != Y,
    "choose": ca.if_else(X > Y, X, Y),
    "sq": X * X,
    "twice": 2 * X,
    "inverse": 1 / X,
    "power": ca.fabs(X) ** Y,
}
EACH |= {"constant power": ca.fabs(X) ** 2.5, "negative": -X, "sums": (X + Y) * (X - Y) / Y}
