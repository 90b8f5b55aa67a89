"""The profile of a disc cam in numbers: points, pressure angle, radius of curvature, undercut; as
CSV and as DXF.
"""

from __future__ import annotations

import io
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from ...base.arguments import public
from ...base.arrays import Array
from ...base.brief import Brief
from ...base.files import writing
from ...base.packages import check_installed
from ...base.table_writers import TableFile
from ...errors import DeclarationError, LagrangeCasadiError, shown

_LEAST, _MOST = 16, 1 << 20

_MILLIMETRES = 1e3


@public
@dataclass(frozen=True, eq=False, repr=False)
class CamProfile(Brief):
    """A cam's profile at angles of one turn of the cam, each (n,), in its own axes.

    ``x`` and ``y`` [m] are where the follower touches it while the cam is at ``angle`` [rad], and
    ``pitch_x`` and ``pitch_y`` where the follower's point is. ``pressure_angle`` [rad] is between
    the force and the way of that point, ``radius`` [m] that of curvature: positive where the
    profile is convex, infinite where it is straight. ``undercut`` is true where it would cut
    itself.
    """

    name: str
    angle: Array
    x: Array
    y: Array
    pitch_x: Array
    pitch_y: Array
    pressure_angle: Array
    radius: Array
    undercut: npt.NDArray[np.bool_]
    closes: bool

    @property
    def undercut_summary(self) -> str:
        """Places of undercut, in words; empty if there are none."""
        found = np.degrees(self.angle[self.undercut])
        if not found.size:
            return ""
        where = f"{found[0]:.4g} deg of the cam, and at {found.size} angles in all"
        return f"its profile is undercut at {where}"

    def save_csv(self, path: str | Path, decimal_comma: bool = False) -> None:
        """Write the profile as a table, a row for every angle.

        Its columns are cam angle [deg], x [m], y [m], pressure angle [deg] and radius of curvature
        [m].

        Parameters
        ----------
        path : path
            The file; one that ends in .xlsx becomes a workbook.
        decimal_comma : bool
            True for numbers with a comma, and semicolons between cells.

        Raises
        ------
        LagrangeCasadiError
            If the profile is undercut, or openpyxl is missing.
        PathError
            If the file cannot be written.
        """
        self._refuse_undercut()
        rows = np.column_stack(
            [np.degrees(self.angle), self.x, self.y, np.degrees(self.pressure_angle), self.radius]
        )
        heads = ["angle [deg]", "x [m]", "y [m]", "pressure angle [deg]", "radius [m]"]
        TableFile(Path(path), decimal_comma).write(heads, rows.tolist())

    def save_dxf(self, path: str | Path) -> None:
        """Write the profile as a closed polyline of DXF R12, in mm.

        Parameters
        ----------
        path : path
            The file.

        Raises
        ------
        LagrangeCasadiError
            If the profile is undercut, or ezdxf is missing.
        PathError
            If the file cannot be written.
        """
        self._refuse_undercut()
        check_installed("ezdxf", "a DXF", "dxf")
        from ezdxf.addons.r12writer import R12FastStreamWriter

        text = io.StringIO()
        drawing = R12FastStreamWriter(text, fixed_tables=False)
        points = (_MILLIMETRES * np.column_stack([self.x, self.y])).tolist()
        drawing.add_polyline([tuple(point) for point in points], closed=True, layer="PROFILE")
        drawing.close()
        with writing(Path(path)) as file:
            file.write(text.getvalue().encode())

    def _refuse_undercut(self) -> None:
        if self.undercut.any():
            raise LagrangeCasadiError(
                f"cam '{self.name}': {self.undercut_summary}; no profile has this motion"
            )


def turn_in(name: str, count: int) -> Array:
    """Angles of one turn of a cam in so many steps, from 0 to 2 pi.

    Raises :class:`.DeclarationError` for too few or too many.
    """
    if not _LEAST <= count <= _MOST:
        bound = f"at least {_LEAST}" if count < _LEAST else f"at most {_MOST}"
        raise DeclarationError(
            f"cam '{name}': count must be a whole number of {bound}, got {shown(count)}"
        )
    return np.asarray(np.arange(count + 1) * (math.tau / count), float)
