"""Struts with a stroke between two points, in a plane and in space: springs and dampers that have
ends, and gas springs.

The gas of a spring is shut in. Its rod goes in as far as it is short of open, so the volume of the
gas falls in a straight line with the share u of the stroke that is in, and with p V^n constant the
force is F_open (1 - u (1 - (F_open/F_closed)^(1/n)))^-n.
"""

from __future__ import annotations

from dataclasses import replace

import casadi as ca

from ...base.arguments import public
from ...errors import DeclarationError
from ..declared_parts import Body, Expression, Point
from ..loads import Spring
from ..mechanism import Mechanism
from ..strokes import Stroke
from .fits import Fits


def stroke(
    mechanism: Mechanism,
    kind: str,
    name: str,
    length: ca.SX,
    closed: Expression,
    open: Expression,  # noqa: A002
) -> Stroke:
    """Declare the stroke of a part, and the share of the stroke that is out as the output
    NAME_stroke.

    Raises :class:`.DeclarationError` for lengths that leave no stroke.
    """
    what = f"{kind} '{name}'"
    ends = [
        mechanism.ownership.expression(f"{what}: {word}", value, "m")
        for word, value in (("closed", closed), ("open", open))
    ]
    Fits(what, mechanism.ownership.at_defaults).positive("closed", ends[0])
    if not isinstance(ends[0], ca.SX) and not isinstance(ends[1], ca.SX) and ends[1] <= ends[0]:
        raise DeclarationError(
            f"{what}: open must be longer than closed, got {ends[1]:g} m and {ends[0]:g} m"
        )
    made = Stroke(what, length, *ends)
    mechanism.output(f"{name}_stroke", made.used)
    mechanism.strokes[name] = made
    return made


def _between(mechanism: Mechanism, first: Body | Point, second: Body | Point) -> ca.SX:
    start, stop = (ca.vertcat(*mechanism.place(point)) for point in (first, second))
    return ca.norm_2(stop - start)


@public
def strut(
    mechanism: Mechanism,
    name: str,
    first: Body | Point,
    second: Body | Point,
    *,
    closed: Expression,
    open: Expression,  # noqa: A002
    stiffness: Expression = 0.0,
    length: Expression = 0.0,
    damping: Expression = 0.0,
) -> Spring:
    """Declare a strut with a stroke between two points: a spring, a damper, or both.

    Parameters
    ----------
    mechanism, name, first, second
        The mechanism, the name of the load, and its ends.
    closed, open
        Distances of the ends between which the strut works [m].
    stiffness, length, damping
        As of :meth:`.Mechanism.spring`.

    Returns
    -------
    Spring
        The load NAME. The output NAME_stroke is the share of the stroke that is out, from 0
        closed to 1 open. Instants beyond that have no result.

    Raises
    ------
    DeclarationError
        For lengths that leave no stroke, and as of :meth:`.Mechanism.spring`.
    """
    load = mechanism.spring(
        name, first, second, stiffness=stiffness, length=length, damping=damping
    )
    for word, value in (("stiffness", load.stiffness), ("damping", load.damping)):
        if not isinstance(value, ca.SX) and value < 0.0:
            raise DeclarationError(f"strut '{name}': {word} must not be negative, got {value:g}")
    stroke(mechanism, "strut", name, _between(mechanism, first, second), closed, open)
    return load


@public
def gas_spring(
    mechanism: Mechanism,
    name: str,
    first: Body | Point,
    second: Body | Point,
    *,
    closed: Expression,
    open: Expression,  # noqa: A002
    force: tuple[Expression, Expression],
    exponent: Expression = 1.0,
    damping: Expression = 0.0,
    end_damping: Expression = 0.0,
    end: Expression | None = None,
) -> Spring:
    """Declare a gas spring between two points, which pushes them apart.

    Parameters
    ----------
    mechanism, name, first, second
        The mechanism, the name of the load, and its ends.
    closed, open
        Distances of the ends between which the gas spring works [m].
    force
        Forces when the gas spring is open and when it is closed [N].
    exponent
        Exponent n of the gas: 1 for slow motion at one temperature, 1.4 for fast motion.
    damping
        Damping over the whole stroke [N s/m].
    end_damping, end
        Further damping at the open end [N s/m], and the length before it over which this damping
        rises from zero [m].

    Returns
    -------
    Spring
        The load NAME. The output NAME_stroke is the share of the stroke that is out, from 0
        closed to 1 open. Instants beyond that have no result.

    Raises
    ------
    DeclarationError
        For lengths that leave no stroke, forces that do not rise as the gas spring closes, an
        ``end_damping`` without an ``end``, and as of :meth:`.Mechanism.spring`.
    """
    what, checked = f"gas spring '{name}'", mechanism.ownership.expression
    mechanism.ownership.free("load", name, mechanism.loads)
    if not isinstance(force, (list, tuple)) or len(force) != 2:
        raise DeclarationError(f"{what}: expected 2 forces, open and closed, got {force!r}")
    pushed = [checked(f"{what}: force", value, "N") for value in force]
    if not any(isinstance(one, ca.SX) for one in pushed) and not 0.0 < pushed[0] <= pushed[1]:
        raise DeclarationError(
            f"{what}: its force must be positive, and not fall as it closes, got {pushed[0]:g} N"
            f" open and {pushed[1]:g} N closed"
        )
    n, fits = checked(f"{what}: exponent", exponent), Fits(what, mechanism.ownership.at_defaults)
    fits.at_least("exponent must be 1 or more", n, 1.0, n)
    distance = _between(mechanism, first, second)
    made = stroke(mechanism, "gas spring", name, distance, closed, open)
    gone = (1.0 - made.used) * (1.0 - (pushed[0] / pushed[1]) ** (1.0 / n))
    push = pushed[0] * (1.0 - gone) ** -n
    slowed, held = (
        checked(f"{what}: {word}", value, "N s/m")
        for word, value in (("damping", damping), ("end_damping", end_damping))
    )
    for word, value in (("damping", slowed), ("end_damping", held)):
        fits.at_least(f"{word} must not be negative [N s/m]", value, 0.0, value)
    if end is not None:
        over = checked(f"{what}: end", end, "m")
        fits.positive("end", over)
        share = ca.fmin(ca.fmax((distance - made.open) / over + 1.0, 0.0), 1.0)
        slowed = slowed + held * share
    elif isinstance(held, ca.SX) or held:
        raise DeclarationError(f"{what}: end_damping needs end, the length over which it rises [m]")
    load = mechanism.spring(
        name, first, second, stiffness=-push / distance, length=0.0, damping=slowed
    )
    mechanism.loads[name] = load = replace(load, closed=made.closed)
    return load
