"""Sum of the actions on a link at one place: it may be determined although each part's share is
not.

Equilibrium does not determine how two bearings on one pin share their load; the sections on either
side depend on the sum only. So, if shares may be indeterminate, load points at one place are
treated as one: the first has the whole force, the others have none. All places past the tip are
treated as one, because no section is between them. Forces at the base or before it act on no
section. Every section has the same force as without this. Places are compared at each instant, for
the parameters as they are.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial

import casadi as ca
import numpy as np

from ..base.arrays import Expression
from ..base.quantities import Column, Output
from ..base.scalars import column
from ..model.declared_parts import Link
from ..model.limits import END
from .mobility import load_points_of
from .multibody import Coordinate
from .sampling import Sampling, drawn

_IN_PLANE = ((("n0",), ("n",), 1), (("f0", "m0"), ("f", "m"), 1))
_IN_SPACE = (
    (("n0",), ("n",), 1),
    (("fy0", "mz0"), ("fy", "mz"), 1),
    (("fz0", "my0"), ("fz", "my"), -1),
    (("mx0",), ("mx",), 1),
)
"""Groups of members that act together, of the tip and of a load point: a force across the link has
an arm, one along it has none.

And the sign of the moment that a force has further out.
"""

_TWICE = 1e-14
"""Distance, relative to a link's length, up to which places at random values of all symbols are one
place written in two ways.
"""


def gathered(
    columns: Mapping[Column, ca.SX],
    free: ca.SX,
    links: Iterable[Link],
    sampling: Sampling,
) -> dict[Column, ca.SX]:
    """The columns of forces, those stations of ``links`` put together that are at one place and
    have shares that may be open.

    ``free`` are the symbols of what equilibrium leaves open: what does not change with them is not
    open.
    """
    found = dict(columns)

    def is_open(units: Expression, load: Expression) -> bool:
        return not sampling.vanish(ca.jacobian(load / units, free))

    for link in links if free.numel() else ():
        load_points = load_points_of((key for key in columns if isinstance(key, Output)), link.name)
        space = Output("law", link.name, "mx0") in columns
        for tip, load_point, sign in (_IN_SPACE if space else _IN_PLANE) if load_points else ():
            units = column(link.length if member[0] == "m" else 1 for member in load_point)
            opens = partial(is_open, units)
            # The tip comes first: what joins it is in the law's own coefficients.
            named = [([Output("law", link.name, member) for member in tip], ca.SX(1))]
            for name in load_points:
                place = columns[Output("station", link.name, "station", name)]
                named.append(
                    ([Output("station", link.name, member, name) for member in load_point], place)
                )
            shares = [
                (outputs, column(columns[output] for output in outputs), place)
                for outputs, place in named
            ]
            shares = [(outputs, load, place) for outputs, load, place in shares if opens(load)]
            gathered_loads = [load for _, load, _ in shares]
            places = [place for *_, place in shares]
            loads = _together(
                gathered_loads, places, sign * link.length, sampling.coordinates, opens
            )
            for (outputs, _, _), load in zip(shares, loads, strict=True):
                found |= zip(outputs, ca.vertsplit(load), strict=True)
    return found


def _together(
    loads: Sequence[ca.SX],
    places: Sequence[ca.SX],
    length: Expression,
    coordinates: Sequence[Coordinate],
    is_open: Callable[[Expression], bool],
) -> list[ca.SX]:
    """Loads at places, ratios xi/l: all at one place in the first of them, and none that is open
    where no section carries it.
    """
    found = list(loads)
    at = drawn(column(places), coordinates)
    twice = (np.abs(at[:, None] - at) <= _TWICE).all(axis=2)
    for j in reversed(
        range(len(places))
    ):  # from the last one on, so that a chain of neighbours hands on what it has
        for i in range(j):
            # Single precision shows no nearer than so whether places that are written in two ways
            # are one.
            near = END["single" if twice[i, j] else "double"]
            one = ca.fabs(ca.fmin(places[i], 1.0) - ca.fmin(places[j], 1.0)) <= near
            if not one.is_zero():
                force, *moment = ca.vertsplit(found[j])
                arm = (places[j] - places[i]) * length
                moved = column([force, *(m + arm * force for m in moment)])
                found[i] += ca.if_else(one, moved, 0.0)
                found[j] = ca.if_else(ca.logic_not(one), found[j], 0.0)
    for k, place in enumerate(places):
        accelerated = place > END["double"]
        # A sum that is never open stays, for it is smooth where its place passes the base.
        if not accelerated.is_one() and is_open(
            sum(load for load, same in zip(loads, twice[k], strict=True) if same)
        ):
            found[k] = ca.if_else(accelerated, found[k], 0.0)
    return found
