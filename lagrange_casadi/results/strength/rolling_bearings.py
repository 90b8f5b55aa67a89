"""Deep groove ball bearings: boundary dimensions of ISO 15, load ratings computed by ISO 281 and
ISO 76 from an inner geometry that a rule gives.

The rule: balls of 0.3 (D - d), on a circle in the middle between bore and outer diameter, as many
as fit in with 195 degrees between the first and the last one (a Conrad bearing); grooves of 0.52
ball diameters. A maker's ratings are some per cent higher or lower: take his, where there are.
The dimensions, and the factors f0, were not compared with the printed standards.
"""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, TypeAlias

import numpy as np

from ...base.arguments import Count, Force, Hours, Length, NotNegative, Positive, public
from ...base.brief import Brief
from ...base.csv_table import Table
from ...base.units import Within
from ...errors import DeclarationError, NoDesignError
from ...model.fitted import Rolling
from ..histories import Histories
from .bearing_life import joint_safety

Bore: TypeAlias = Annotated[Any, Within(0.0, unit="m")]

_BORES = (10, 12, 15, 17, 20, 25, 30, 35, 40, 45, 50, 55, 60, 65, 70, 75, 80, 85, 90, 95, 100)
_OUTER = {
    "60": (
        *((26, 8), (28, 8), (32, 9), (35, 10), (42, 12), (47, 12), (55, 13), (62, 14), (68, 15)),
        *((75, 16), (80, 16), (90, 18), (95, 18), (100, 18), (110, 20), (115, 20), (125, 22)),
        *((130, 22), (140, 24), (145, 24), (150, 24)),
    ),
    "62": (
        *((30, 9), (32, 10), (35, 11), (40, 12), (47, 14), (52, 15), (62, 16), (72, 17), (80, 18)),
        *((85, 19), (90, 20), (100, 21), (110, 22), (120, 23), (125, 24), (130, 25), (140, 26)),
        *((150, 28), (160, 30), (170, 32), (180, 34)),
    ),
    "63": (
        *((35, 11), (37, 12), (42, 13), (47, 14), (52, 15), (62, 17), (72, 19), (80, 21), (90, 23)),
        *((100, 25), (110, 27), (120, 29), (130, 31), (140, 33), (150, 35), (160, 37), (170, 39)),
        *((180, 41), (190, 43), (200, 45), (215, 47)),
    ),
}
"""Outer diameters and widths [mm] of the dimension series of ISO 15 for the bores."""

_F0 = (
    *(14.7, 14.9, 15.1, 15.3, 15.5, 15.7, 15.9, 16.1, 16.3, 16.5, 16.4, 16.1, 15.9, 15.6, 15.4),
    *(15.2, 14.9, 14.7, 14.4, 14.2, 14.0, 13.7, 13.5, 13.2, 13.0, 12.8, 12.5, 12.3, 12.1, 11.8),
    11.6,
)
"""Factor f0 of ISO 76 for ball over pitch diameters 0, 0.01, ..., 0.3."""

_COLUMNS = {"name": "1", "bore": "m", "outer": "m", "width": "m", "dynamic": "N", "static": "N"}
"""Columns of a table, and units of their kinds."""

_LEADING = 0.41 * 98.0665 * 0.95
"""The constant of f_c in ISO/TR 1281-1 [N], with the reduction 0.95 for radial contact grooves."""

COMPUTED = "computed by ISO 281 and ISO 76 from a rule's inner geometry, no maker's rating"
_AXIAL = 2.3
"""Largest factor Y of ISO 281 for deep groove bearings: F_r + Y F_a is never below P."""


@public
@dataclass(frozen=True, repr=False)
class RollingBearing(Brief):
    """A ball bearing: bore, outer diameter and width [m], ratings C and C0 [N], and the ``source``
    of these.
    """

    name: str
    bore: Length
    outer: Length
    width: Length
    dynamic: Force
    static: Force
    source: str = ""

    def rolling(self, hours: Hours, axial: NotNegative = _AXIAL) -> Rolling:
        """Return the demand on this bearing, for :func:`.fit`.

        Parameters
        ----------
        hours : float
            Life that is wanted [h].
        axial : float
            Factor on axial forces, by default the largest of ISO 281.

        Returns
        -------
        Rolling
            The demand.
        """
        return Rolling(self.dynamic, hours, self.static, axial=axial)


@public
def dynamic_rating(element: Length, pitch: Length, count: Count) -> float:
    """Compute C_r of ISO 281 for a deep groove ball bearing.

    Parameters
    ----------
    element, pitch : float
        Diameters of the balls and of their circle [m].
    count : int
        Number of balls.

    Returns
    -------
    float
        The dynamic radial load rating [N].
    """
    share, size = element / pitch, 1e3 * element
    inner = 1.04 * ((1.0 - share) / (1.0 + share)) ** 1.72
    factor = _LEADING * (1.0 + inner ** (10.0 / 3.0)) ** -0.3 * (2 * 0.52 / (2 * 0.52 - 1)) ** 0.41
    factor *= share**0.3 * (1.0 - share) ** 1.39 / (1.0 + share) ** (1.0 / 3.0)
    by_size = size**1.8 if size <= 25.4 else 3.647 * size**1.4
    return float(1.3 * factor * count ** (2.0 / 3.0) * by_size)


@public
def static_rating(element: Length, pitch: Length, count: Count) -> float:
    """Compute C_0r of ISO 76 for a deep groove ball bearing.

    Parameters
    ----------
    element, pitch : float
        Diameters of the balls and of their circle [m].
    count : int
        Number of balls.

    Returns
    -------
    float
        The static radial load rating [N].
    """
    factor = np.interp(element / pitch, np.arange(len(_F0)) / 100.0, _F0)
    return float(factor * count * (1e3 * element) ** 2)


@public
def deep_groove(series: str | None = None) -> tuple[RollingBearing, ...]:
    """Return deep groove ball bearings of the dimension series 60, 62 and 63.

    Parameters
    ----------
    series : str, optional
        One of the series, as ``"62"``; by default all.

    Returns
    -------
    tuple of RollingBearing
        The bearings by increasing bore. Their ratings are computed by a rule, as ``source`` says.

    Raises
    ------
    DeclarationError
        For another series.
    """
    if series is not None and series not in _OUTER:
        raise DeclarationError(f"deep_groove: expected one of {', '.join(_OUTER)}, got {series!r}")
    found = [
        _computed(name, k, bore / 1e3, outer / 1e3, width / 1e3)
        for name, sizes in _OUTER.items()
        if series in (None, name)
        for k, (bore, (outer, width)) in enumerate(zip(_BORES, sizes, strict=True))
    ]
    return tuple(sorted(found, key=lambda bearing: (bearing.bore, bearing.dynamic)))


def _computed(series: str, k: int, bore: float, outer: float, width: float) -> RollingBearing:
    element, pitch = 0.3 * (outer - bore), (outer + bore) / 2
    count = 1 + math.floor(math.radians(195.0) / (2.0 * math.asin(element / pitch)))
    dynamic, static = dynamic_rating(element, pitch, count), static_rating(element, pitch, count)
    return RollingBearing(f"{series}{k:02d}", bore, outer, width, dynamic, static, COMPUTED)


@public
def read_bearings(path: str | os.PathLike[str]) -> tuple[RollingBearing, ...]:
    """Read bearings from a CSV file.

    Parameters
    ----------
    path : path
        A file with the columns name, bore, outer, width [mm], dynamic and static [kN], and
        optionally ``source``. Cells are separated as :func:`.read_rows` describes; lines that begin
        with ``#`` are ignored.

    Returns
    -------
    tuple of RollingBearing
        The bearings, in the order of the file.

    Raises
    ------
    PathError
        If the file cannot be read.
    DeclarationError
        For a column that is missing or a cell that is not valid, with the number of its line.
    """
    table = Table.read(path, "the columns name, bore, outer, width [mm], dynamic, static [kN]")
    units = table.units_of(_COLUMNS)
    found = []
    for row, cells in table.entries("bearing"):
        bore, outer, width, dynamic, static = (
            row.positive(name, cells[name], units[name])
            for name in ("bore", "outer", "width", "dynamic", "static")
        )
        source = cells.get("source", str(path))
        found.append(RollingBearing(cells["name"], bore, outer, width, dynamic, static, source))
    return tuple(found)


@public
def select_bearing(
    solution: Histories,
    joint: str,
    bearings: Sequence[RollingBearing],
    *,
    hours: Hours,
    bore: Bore = 0.0,
    static: Positive = 1.0,
) -> RollingBearing:
    """Choose for a joint the bearing with the smallest outer diameter that lives long enough.

    Parameters
    ----------
    solution : Solution
        Has the joint's reaction and motion.
    joint : str
        Name of the joint.
    bearings : sequence of RollingBearing
        What there is to choose from.
    hours : float
        Hours that nine of ten bearings must run.
    bore : float
        Least bore, as the shaft needs it [m].
    static : float
        Least factor of C0 on the largest load.

    Returns
    -------
    RollingBearing
        The first, by outer diameter, that lives long enough.

    Raises
    ------
    NoDesignError
        If none serves, which says how near the strongest comes.
    DeclarationError
        If there are no bearings to choose from, and as :func:`.joint_safety` does.
    """
    if not bearings:
        raise DeclarationError("select_bearing: bearings: expected at least one")
    fitting = [one for one in bearings if one.bore >= bore]
    if not fitting:
        raise NoDesignError(f"joint '{joint}': no bearing has a bore of {1e3 * bore:g} mm or more")
    for one in sorted(fitting, key=lambda one: (one.outer, one.bore, one.width)):
        found = joint_safety(solution, joint, [one.rolling(hours)])
        if not found.verdicts:
            raise DeclarationError(f"joint '{joint}': {'; '.join(found.not_evaluated)}")
        if found.against("life of bearing") >= 1.0 and found.against("static load") >= static:
            return one
    best = max(fitting, key=lambda one: one.dynamic)
    found = joint_safety(solution, joint, [best.rolling(hours)])
    raise NoDesignError(
        f"joint '{joint}': no bearing has a life of {hours:g} h; the strongest, '{best.name}',"
        f" has a factor of {found.governs.factor:.4g} against {found.governs.against}"
    )
