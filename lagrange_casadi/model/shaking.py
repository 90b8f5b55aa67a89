"""Shaking force and shaking moment: what the inertia of all bodies does to the frame.

With the momentum P and the moment of momentum H of all bodies, about a point of the ground, they
are -P' and -H'. A body is taken as points with mass and, for each pair of its axes e_i and e_j, a
second moment J_ij that adds J_ij e_i x e_j'' to H'.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from ..base.arguments import public
from ..base.arrays import Operand
from ..base.vectors import ZERO, Vector, cross, minus, times
from ..errors import DeclarationError
from .declared_parts import Expression, Link, Point, PointMass, UserOutput
from .link_density import Density
from .mass_properties import second_moments
from .mechanism import Mechanism


@public
def shaking(
    mechanism: Mechanism, name: str = "shaking", *, about: Sequence[Expression] = ()
) -> tuple[UserOutput, ...]:
    """Declare the shaking force and the shaking moment of a mechanism as outputs.

    They are ``output:NAME_fx``, ``output:NAME_fy`` [N] and ``output:NAME_mz`` [N m], in space also
    those of z, x and y: the action of the inertia of all bodies on the frame, in ground axes,
    without weights and loads. Call it when all bodies are declared: a scene refuses one that is
    declared later.

    Source: Berkof and Lowen, *A new method for completely force balancing simple linkages*, J. Eng.
    Ind. 91 (1969), 21-26.

    Parameters
    ----------
    mechanism
        The mechanism.
    name
        Prefix of the outputs' names.
    about
        Point of the ground about which the moment acts [m]; default: the origin.

    Returns
    -------
    tuple of UserOutput
        The outputs.

    Raises
    ------
    DeclarationError
        If there are no bodies, or ``about`` is no point.
    """
    if not mechanism.moving:
        raise DeclarationError(
            "shaking: there are no bodies yet; call it after all bodies are declared"
        )
    axes = mechanism.measures.components
    if not isinstance(about, (tuple, list)) or len(about) not in (0, len(axes)):
        raise DeclarationError(
            f"shaking: expected a place ({', '.join(axes)}) for about, got {about!r}"
        )
    centre = _spatial(mechanism.ownership.expression("shaking: about", x, "m") for x in about)
    force, moment = ZERO, ZERO
    for body in mechanism.moving:
        points, moments = _mass_properties(mechanism, body)
        for mass, point in points:
            place = _spatial(mechanism.place(point))
            acceleration = _spatial(mechanism.results.acceleration(point))
            force = minus(force, times(mass, acceleration))
            moment = minus(moment, times(mass, cross(minus(place, centre), acceleration)))
        for inertia, axis, other in moments:
            a, b = (_spatial(mechanism.place(end)) for end in axis)
            c, d = (_spatial(mechanism.results.acceleration(end)) for end in other)
            moment = minus(moment, times(inertia, cross(minus(b, a), minus(d, c))))
    bodies = tuple(body.name for body in mechanism.moving)
    named = {f"f{axis}": (value, "N") for axis, value in zip(axes, force, strict=False)}
    named |= {
        f"m{axis}": (value, "N m")
        for axis, value in zip("xyz", moment, strict=True)
        if mechanism.space or axis == "z"
    }
    found = tuple(
        mechanism.output(f"{name}_{member}", value, unit=unit)
        for member, (value, unit) in named.items()
    )
    mechanism.shaken |= {output.name: bodies for output in found}
    return found


def refuse_late(mechanism: Mechanism) -> None:
    """Raise :class:`.DeclarationError` for a body that was declared after a shaking force."""
    for output, bodies in mechanism.shaken.items():
        if late := [body.name for body in mechanism.moving if body.name not in bodies]:
            raise DeclarationError(
                f"output '{output}': body '{late[0]}' was declared after it; call shaking after all"
                " bodies"
            )


_Pair = tuple[Point, Point]


def _mass_properties(
    mechanism: Mechanism, body: Link | PointMass
) -> tuple[list[tuple[Expression, Point]], list[tuple[Operand, _Pair, _Pair]]]:
    """Points with mass that stand for a body, and second moments with the pairs of points that are
    their axes.
    """
    if not isinstance(body, Link):
        return [(body.mass, mechanism.ownership.point("shaking", body))], []
    if isinstance(body.mass, Density):
        base, tip, inertia = body.mass.ends(body.length)
        axis = body.base, body.tip
        moments = [(inertia / (body.length * body.length), axis, axis)]
        if body.mass.slices is not None:
            across = [(body.base, body.at(0.0, y, z)) for y, z in ((1.0, 0.0), (0.0, 1.0))]
            yy, zz, yz = body.mass.slices.whole(body.length)
            pairs = ((yy, 0, 0), (zz, 1, 1), (yz, 0, 1), (yz, 1, 0))
            moments += [(moment, across[i], across[j]) for moment, i, j in pairs]
        return [(base, body.base), (tip, body.tip)], moments
    rigid, place = body.mass, body.mass.centre
    centre = body.at(*place)
    axes = [(centre, body.at(*(x + (k == i) for k, x in enumerate(place)))) for i in range(3)]
    if not mechanism.space:
        return [(rigid.mass, centre)], [(rigid.inertia[2][2], axes[0], axes[0])]
    inertias = second_moments(rigid.inertia)
    return [(rigid.mass, centre)], [
        (inertias[i][j], axes[i], axes[j]) for i in range(3) for j in range(3)
    ]


def _spatial(components: Iterable[Expression]) -> Vector:
    """Three components of as many as there are; others are zero."""
    x, y, z, *_ = (*components, 0.0, 0.0, 0.0)
    return x, y, z
