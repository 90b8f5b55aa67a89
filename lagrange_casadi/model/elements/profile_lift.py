"""The lift of a follower from a profile of a disc cam, drawn or measured: points of the cam, to the
law of its follower.

The follower's point lies on the normal of the profile at the point of contact, at the distance of
the roller's radius. Its distance from the cam's centre gives the follower's place, and its
direction the cam's angle. A flat face touches the profile at the point where both have the same
normal.
"""

from __future__ import annotations

import cmath
import math
import os
from dataclasses import dataclass, replace
from typing import Annotated, Any, TypeAlias

import numpy as np
import numpy.typing as npt

from ...base.arguments import Measured, Numeric, public
from ...base.arrays import Array, Expression
from ...base.bernstein import of_powers, slope, value, zeros
from ...base.csv_table import Table
from ...base.units import quantity
from ...errors import DeclarationError, one_line
from ..curves import Curve, curve
from ..declared_parts import Point, Vector
from ..joints import Joint
from ..mechanism import Mechanism
from .cam import layout_of

_LEAST = 16

Places: TypeAlias = npt.NDArray[np.complexfloating[Any, Any]]
"""Places and directions in a plane, x + i y."""


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
    slides = mechanism.ownership.joint(follower).kind == "prismatic"
    number = mechanism.ownership.at_defaults
    smoothing = quantity("profile: smoothing", smoothing, "m" if slides else "rad")
    layout = layout_of("profile", mechanism, cam, follower, point, roller, flat, side)

    def plane(vector: Vector) -> complex:
        return complex(number(vector[0]), number(vector[1]))

    if isinstance(points, (str, os.PathLike)):
        points = read_profile(points)
    at, normal = _normals(np.asarray(points, float))
    radius = number(layout.roller)
    # On a flat face the normal turns with the cam, otherwise the follower's point goes round it.
    seen = normal if flat else at + radius * normal
    far = (at * normal.conj()).real if flat else np.abs(seen)
    if slides:
        offset = number(layout.offset[0])
        up = plane(layout.offset[2])
        found = _law(seen, *_sliding(far, up, offset, flat), smoothing)
        least = _least(found)
        base = least if flat else math.hypot(least, offset) - radius
    else:
        away, length = plane(layout.away), abs(plane(layout.arm))
        found = _law(seen, *_swinging(far, away, length, side, flat), smoothing)
        least = _least(found)
        base = (
            abs(away) * math.sin(least)
            if flat
            else abs(length - abs(away) * cmath.rect(1.0, least)) - radius
        )
    cells = tuple((cell[0] - least, *cell[1:]) for cell in found.cells)
    return ProfileLift(replace(found, cells=cells), base)


def _normals(points: Array) -> tuple[Places, Places]:
    """Points in counter-clockwise sequence and the normals outward there, each (n,)."""
    if points.ndim != 2 or points.shape[1] != 2 or not np.isfinite(points).all():
        raise DeclarationError(
            f"profile: expected points (x, y), finite numbers, got an array of shape {points.shape}"
        )
    found = points[:, 0] + 1j * points[:, 1]
    size = float(np.abs(found).max(initial=0.0))
    if found.size > 1 and abs(found[-1] - found[0]) <= 1e-9 * size:
        found = found[:-1]
    if found.size < _LEAST:
        raise DeclarationError(f"profile: expected at least {_LEAST} points, got {found.size}")
    if np.sum((found.conj() * np.roll(found, -1)).imag) < 0.0:
        found = found[::-1]
    closed = np.append(found, found[0])
    steps = np.abs(np.diff(closed))
    if not steps.min() > 1e-9 * size:
        raise DeclarationError(f"profile: points {int(np.argmin(steps)) + 1} and the next coincide")
    arc_length = [0.0, *np.cumsum(steps).tolist()]
    x, y = (
        np.array([cell[1] for cell in curve(arc_length, row.tolist(), periodic=True).cells])
        for row in (closed.real, closed.imag)
    )
    turned = np.unwrap(np.angle(closed))
    if turned[-1] - turned[0] < math.pi:
        raise DeclarationError(
            "profile: its points do not enclose the cam's shaft, which is at (0, 0)"
        )
    return found, (y - 1j * x) / np.hypot(x, y)


def _sliding(far: Array, up: complex, offset: float, flat: bool) -> tuple[complex | Places, Array]:
    """The follower's point, or the normal of its face, and its place along its line, where the
    point or the face is ``far`` from the cam's shaft.
    """
    if flat:
        return up, far
    if far.min() < abs(offset):
        raise DeclarationError(
            f"profile: the follower's line is {abs(offset):.6g} m from the cam's shaft, too far to"
            f" touch the whole profile; expected less than {far.min():.6g} m"
        )
    height = np.sqrt(far**2 - offset**2)
    return (height - 1j * offset) * up, height


def _swinging(
    far: Array, away: complex, arm: float, side: int, flat: bool
) -> tuple[complex | Places, Array]:
    """The follower's point, or the normal of its face, and its angle from the line to the cam's
    shaft, where the point or the face is ``far`` from the shaft.
    """
    reach, line = abs(away), np.angle(-away)
    if flat:
        if np.abs(far).max() >= reach:
            raise DeclarationError(
                f"profile: the follower's pivot is {reach:.6g} m from the cam's shaft, but the"
                f" profile reaches {np.abs(far).max():.6g} m; move the pivot farther away"
            )
        angle = np.arcsin(far / reach)
        return np.exp(1j * (line + side * (angle + math.pi / 2))), angle
    cosine = (arm**2 + reach**2 - far**2) / (2.0 * arm * reach)
    if np.abs(cosine).max() >= 1.0:
        raise DeclarationError(
            "profile: the follower does not reach the whole profile: its end can be from"
            f" {abs(arm - reach):.6g} to {arm + reach:.6g} m from the cam's shaft, and must be from"
            f" {far.min():.6g} to {far.max():.6g} m; expected another length or pivot"
        )
    angle = np.arccos(cosine)
    return away + arm * np.exp(1j * (line + side * angle)), angle


def _law(seen: Places, there: complex | Places, height: Array, smoothing: float) -> Curve:
    """The curve through the follower's places at the angles by which the cam turns what is ``seen``
    on it to where it is ``there``, which fall while the profile is gone round.
    """
    angle = np.angle(there) - np.angle(seen)
    turned = np.unwrap(np.append(angle, angle[0]))
    steps = -np.diff(turned)
    if not (steps > 0.0).all() or abs(steps.sum() - math.tau) > 1e-6:
        bad = int(np.argmin(steps)) + 1
        raise DeclarationError(
            f"profile: the follower cannot touch it near its point {bad}, counted"
            " counter-clockwise: the profile is hollow there, or its points are too rough"
        )
    # From a whole turn, so that a period is one to the last digit.
    start, *within, _ = turned[::-1].tolist()
    places = np.append(height, height[0])[::-1].tolist()
    try:
        return curve([start, *within, start + math.tau], places, periodic=True, smoothing=smoothing)
    except DeclarationError as error:
        raise DeclarationError(f"profile: {one_line(error)}") from None


def _least(found: Curve) -> float:
    """The least value of a curve, at the start of a piece or where its slope is zero within."""
    widths = np.diff([*found.starts, found.starts[0] + found.high - found.low])
    pieces = of_powers(np.array(found.cells).T, np.array([np.zeros(widths.size), widths]))
    return float(value(pieces, np.pad(zeros(slope(pieces)).places, [(0, 1), (0, 0)])).min())
