"""The lift of a follower from a profile of a disc cam, drawn or measured: points of the cam, to the
law of its follower.

The follower's point lies on the normal of the profile at the point of contact, at the distance of
the roller's radius. Its distance from the cam's centre gives the follower's place, and its
direction the cam's angle. A flat face touches the profile at the point where both have the same
normal.
"""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from ...base.arguments import Measured, Numeric, public
from ...base.arrays import Array, Expression
from ...base.bernstein import of_powers, slope, value, zeros
from ...base.csv_table import Table
from ...base.units import quantity
from ...errors import DeclarationError, one_line
from ..curves import Curve, curve
from ..declared_parts import Point
from ..joints import Joint
from ..mechanism import Mechanism
from .cam import layout_of

_LEAST = 16


@dataclass(frozen=True, eq=False)
class ProfileLift:
    """The lift that a profile gives a follower, by the cam's angle: call it as :func:`.disc_cam`
    does.

    ``curve`` goes smoothly through the lift [m or rad] at the angles of the points; ``base_radius``
    [m] is that of the base circle.
    """

    curve: Curve
    base_radius: float

    def __call__(self, angle: Expression) -> Expression:
        """The lift at an angle of the cam [rad]."""
        return self.curve(angle)


@public
def read_profile(path: str | os.PathLike[str]) -> Array:
    """Read the points of a cam profile from a CSV file.

    Parameters
    ----------
    path
        File with columns ``x`` and ``y``, in m or with a unit as ``x [mm]``; other
        columns are ignored. :meth:`.CamProfile.save_csv` writes such a file.

    Returns
    -------
    ndarray
        Points (n, 2) [m].

    Raises
    ------
    PathError
        For a file that cannot be read.
    DeclarationError
        For missing columns, and for a line without numbers in them.
    """
    table = Table.read(path, "the columns x and y")
    places = {"x": "m", "y": "m"}
    units = table.units_of(places, usual=places)
    points = [
        [row.finite(name, cells[name], unit) for name, unit in units.items()]
        for row, cells in table.entries("point")
    ]
    return np.array(points)


@public
def profile_lift(
    mechanism: Mechanism,
    cam: Joint,
    follower: Joint,
    points: str | os.PathLike[str] | Annotated[Numeric, "m"],
    *,
    point: Point | None = None,
    roller: float | None = None,
    flat: bool = False,
    side: int = 1,
    smoothing: Measured = 0.0,
) -> ProfileLift:
    """Return the lift of a follower on a given cam profile, for :func:`.disc_cam`.

    Parameters
    ----------
    mechanism, cam, follower
        The mechanism, and the joints of cam and follower, as for :func:`.disc_cam`. Dimensions
        are taken at the default parameters.
    points
        Points (n, 2) [m] once around the profile, in either sense, in the cam's own axes about
        its shaft; or the path of a file for :func:`read_profile`.
    point, roller, flat, side
        As for :func:`.disc_cam`.
    smoothing
        Root mean square noise of the lift [m or rad] for measured points: accelerations are
        second derivatives and magnify noise.

    Returns
    -------
    ProfileLift
        The lift as a function of the cam's angle. Normals are those of a periodic cubic spline
        through the points; the error of the lift falls with the fourth power of their distance if
        the profile is smooth.

    Raises
    ------
    DeclarationError
        For points that are no profile, a follower that cannot touch all of it, for example a
        roller that is larger than a hollow, and as for :func:`.disc_cam` and :func:`.curve`.
    PathError
        For a file that cannot be read.
    """
    what, slides = "profile", mechanism.ownership.joint(follower).kind == "prismatic"
    smoothing = quantity(f"{what}: smoothing", smoothing, "m" if slides else "rad")
    layout = layout_of(what, mechanism, cam, follower, point, roller, flat, side)
    number = mechanism.ownership.at_defaults
    away, arm = (np.array([number(x) for x in pair[:2]]) for pair in (layout.away, layout.arm))
    if isinstance(points, (str, os.PathLike)):
        points = read_profile(points)
    at, normal = _normals(what, np.asarray(points, float))
    radius = number(layout.roller)
    if slides:
        up = np.array([number(x) for x in follower.triad[0][:2]])
        turned = np.array([number(x) for x in follower.turned.apply((*arm, 0.0))[:2]])
        offset = float((away + turned) @ np.array([up[1], -up[0]]))
        found = _law(what, *_sliding(at, normal, up, offset, radius, flat), smoothing)
        least = _least(found)
        base = least if flat else math.hypot(least, offset) - radius
    else:
        reach, length = math.hypot(*away), math.hypot(*arm)
        found = _law(what, *_swinging(at, normal, away, length, radius, side, flat), smoothing)
        least = _least(found)
        base = (
            reach * math.sin(least)
            if flat
            else math.sqrt(length**2 + reach**2 - 2 * length * reach * math.cos(least)) - radius
        )
    cells = tuple((cell[0] - least, *cell[1:]) for cell in found.cells)
    return ProfileLift(replace(found, cells=cells), base)


def _normals(what: str, points: Array) -> tuple[Array, Array]:
    """Points in counter-clockwise sequence and the normals outward there, each (n, 2)."""
    if points.ndim != 2 or points.shape[1] != 2 or not np.isfinite(points).all():
        raise DeclarationError(
            f"{what}: expected points (x, y), finite numbers, got an array of shape {points.shape}"
        )
    size = float(np.abs(points).max(initial=0.0))
    if points.shape[0] > 1 and np.abs(points[-1] - points[0]).max() <= 1e-9 * size:
        points = points[:-1]
    if len(points) < _LEAST:
        raise DeclarationError(f"{what}: expected at least {_LEAST} points, got {len(points)}")
    x, y = points.T
    area = float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)) / 2.0
    if area < 0.0:
        points = points[::-1]
    closed = np.vstack([points, points[:1]])
    steps = np.hypot(*np.diff(closed, axis=0).T)
    if not steps.min() > 1e-9 * size:
        raise DeclarationError(f"{what}: points {int(np.argmin(steps)) + 1} and the next coincide")
    arc_length = np.concatenate([[0.0], np.cumsum(steps)])
    slopes = [
        [cell[1] for cell in curve(arc_length.tolist(), row.tolist(), periodic=True).cells]
        for row in closed.T
    ]
    along = np.array(slopes).T
    turned = np.unwrap(_direction(closed))
    if turned[-1] - turned[0] < math.pi:
        raise DeclarationError(
            f"{what}: its points do not enclose the cam's shaft, which is at (0, 0)"
        )
    return points, np.column_stack([along[:, 1], -along[:, 0]]) / np.hypot(*along.T)[:, None]


def _sliding(
    at: Array, normal: Array, up: Array, offset: float, radius: float, flat: bool
) -> tuple[Array, Array]:
    """The cam's angle and the follower's place along its line while each point is touched."""
    if flat:
        return math.atan2(up[1], up[0]) - _direction(normal), np.sum(at * normal, axis=1)
    pitch = at + radius * normal
    reach = np.hypot(*pitch.T)
    if reach.min() < abs(offset):
        raise DeclarationError(
            f"profile: the follower's line is {abs(offset):.6g} m from the cam's shaft, too far to"
            f" touch the whole profile; expected less than {reach.min():.6g} m"
        )
    height = np.sqrt(reach**2 - offset**2)
    place = offset * np.array([up[1], -up[0]]) + height[:, None] * up
    return _direction(place) - _direction(pitch), height


def _swinging(
    at: Array, normal: Array, away: Array, arm: float, radius: float, side: int, flat: bool
) -> tuple[Array, Array]:
    """The cam's angle, and the follower's angle from the line to the cam's shaft, while each point
    is touched.
    """
    reach = math.hypot(*away)
    line = math.atan2(-away[1], -away[0])
    if flat:
        sine = np.sum(at * normal, axis=1) / reach
        if np.abs(sine).max() >= 1.0:
            raise DeclarationError(
                f"profile: the follower's pivot is {reach:.6g} m from the cam's shaft, but the"
                f" profile reaches {reach * np.abs(sine).max():.6g} m; move the pivot farther away"
            )
        angle = np.arcsin(sine)
        return line + side * (angle + math.pi / 2) - _direction(normal), angle
    pitch = at + radius * normal
    far = np.hypot(*pitch.T)
    cosine = (arm**2 + reach**2 - far**2) / (2.0 * arm * reach)
    if np.abs(cosine).max() >= 1.0:
        raise DeclarationError(
            "profile: the follower does not reach the whole profile: its end can be from"
            f" {abs(arm - reach):.6g} to {arm + reach:.6g} m from the cam's shaft, and must be from"
            f" {far.min():.6g} to {far.max():.6g} m; expected another length or pivot"
        )
    angle = np.arccos(cosine)
    turned = line + side * angle
    place = away + arm * np.column_stack([np.cos(turned), np.sin(turned)])
    return _direction(place) - _direction(pitch), angle


def _law(what: str, angle: Array, height: Array, smoothing: float) -> Curve:
    """The curve through the follower's places at angles that fall while the
    profile is gone round.
    """
    turned = np.unwrap(np.concatenate([angle, angle[:1]]))
    steps = -np.diff(turned)
    if not (steps > 0.0).all() or abs(steps.sum() - math.tau) > 1e-6:
        bad = int(np.argmin(steps)) + 1
        raise DeclarationError(
            f"{what}: the follower cannot touch it near its point {bad}, counted counter-clockwise:"
            " the profile is hollow there, or its points are too rough"
        )
    order = slice(None, None, -1)
    x, y = turned[order], np.concatenate([height, height[:1]])[order]
    # From a whole turn, so that a period is one to the last digit.
    start = float(x[0])
    at = [start, *(x[1:-1].tolist()), start + math.tau]
    try:
        return curve(at, y.tolist(), periodic=True, smoothing=smoothing)
    except DeclarationError as error:
        raise DeclarationError(f"{what}: {one_line(error)}") from None


def _least(found: Curve) -> float:
    """The least value of a curve, at the start of a piece or where its slope is zero within."""
    widths = np.diff([*found.starts, found.starts[0] + found.high - found.low])
    pieces = of_powers(np.array(found.cells).T, np.array([np.zeros(widths.size), widths]))
    return float(value(pieces, np.pad(zeros(slope(pieces)).places, [(0, 1), (0, 0)])).min())


def _direction(vectors: Array) -> Array:
    return np.arctan2(vectors[:, 1], vectors[:, 0])
