"""Shapes of a mechanism, from its description: bodies with their axes, arms and plates, joints,
springs, points.

Places and directions are three numbers, in a body's axes [m]; in the plane z is 0. How bodies move
is not said here.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ...model.description import Description, Place, Triple
from .curves import ROUND

_WAYS = np.exp(2j * np.pi * np.arange(1440) / 1440)

_FLAT = 1e-6
"""Over a body's size: points that are no farther from a plane, or from a line, lie in it."""


@dataclass(frozen=True)
class Shape:
    """Shape of a body: lines between places, and plates, each a polygon.

    ``kind`` is "link" where it has an axis that is drawn, "rigid" where only its centre is known,
    "point" for a point mass. Of a rigid body that is held at its centre alone, as a gear or a
    rotor, there is a ``disc``, whose radius is the link's length.
    """

    name: str
    kind: str
    length: float | None
    mass: float
    axis: tuple[Triple, ...] = ()
    arms: tuple[tuple[Triple, Triple], ...] = ()
    plates: tuple[tuple[Triple, ...], ...] = ()
    centre: Triple | None = None
    disc: float = 0.0


def shapes(description: Description) -> Iterator[Shape]:
    """The bodies, in the order in which they are declared."""
    for name, body in description.bodies.items():
        outlines, rollers = _outlines(description, name), _rollers(description, name)
        spots = list(dict.fromkeys(spot.at for spot in spots_of(description) if spot.body == name))
        length, mass = body.length, body.mass
        if length is None:
            yield Shape(name, "point", None, mass, centre=(0.0, 0.0, 0.0))
        elif body.centre is not None and not math.isnan(mass):
            centre = body.centre
            plates = outlines or _plates(spots)
            # Two joints hold a bar between them; arms from the centre hold any others that lie in
            # no plane.
            ends = (
                [(spots[0], spots[1])]
                if len(spots) == 2
                else [(centre, at) for at in spots if at != centre]
            )
            arms = () if plates else tuple(ends)
            disc = 0.0 if arms or plates else max(length, 0.0)
            yield Shape(name, "rigid", length, mass, (), arms, plates + rollers, centre, disc)
        else:
            axis: tuple[Triple, ...] = ((0.0, 0.0, 0.0), (length, 0.0, 0.0))
            beside = [
                at
                for at in spots
                if np.hypot(at[1], at[2]) > _FLAT * (abs(length) or 1.0)
                or not 0.0 <= at[0] <= length
            ]
            # A true outline stands for the axis and what is beside it.
            plates = outlines or _plates([*axis, *beside])
            arms = (
                ()
                if plates
                else tuple(((min(max(at[0], 0.0), length), 0.0, 0.0), at) for at in beside)
            )
            shown = () if outlines else axis
            yield Shape(name, "link", length, mass, shown, arms, plates + rollers)


def named_spots(description: Description) -> dict[str, Place]:
    """The places beside which pictures write names: of joints, except the welds inside bent bars,
    and of declared points.
    """
    inner = description.bends
    joints = description.joints.items()
    return {name: one.child for name, one in joints if name not in inner} | dict(description.paths)


def spots_of(description: Description) -> list[Place]:
    """Every place of a body at which something holds or pulls it, or that is declared."""
    ends = [*(joint.ends for joint in description.joints.values()), *description.springs.values()]
    rollers = (roller.centre for roller in description.rollers.values())
    return [*itertools.chain(*ends), *description.paths.values(), *rollers]


def _outlines(description: Description, body: str) -> tuple[tuple[Triple, ...], ...]:
    """Outlines that are declared for a body, without corners of a cam that its follower cannot
    touch.
    """
    return tuple(
        tuple((x, y, 0.0) for x, y in outline if np.isfinite(x + y))
        for outline in description.outlines.get(body, ())
    )


def _rollers(description: Description, body: str) -> tuple[tuple[Triple, ...], ...]:
    """The rollers on a body, each as a polygon."""
    return tuple(
        tuple(
            (roller.centre.at[0] + corner.real, roller.centre.at[1] + corner.imag, 0.0)
            for corner in (roller.radius * ROUND).tolist()
        )
        for roller in description.rollers.values()
        if roller.centre.body == body
    )


def _plates(places: Sequence[Triple]) -> tuple[tuple[Triple, ...], ...]:
    """The convex polygon of three places or more that lie in one plane and not in a line; else
    nothing.
    """
    if len(places) < 3:
        return ()
    points = np.array(places)
    middle = points - points.mean(axis=0)
    size = float(np.abs(middle).max())
    _, distributed, directions = np.linalg.svd(middle / (size or 1.0))
    if distributed[1] < 1e3 * _FLAT or (distributed.size > 2 and distributed[2] > 1e3 * _FLAT):
        return ()
    # A corner is farthest in some direction.
    farthest = np.argmax(middle @ directions[:2].T @ [_WAYS.real, _WAYS.imag], axis=0)
    return (tuple(places[k] for k in dict.fromkeys(farthest.tolist())),)
