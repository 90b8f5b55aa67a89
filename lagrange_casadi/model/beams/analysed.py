"""Cross-sections of any outline, analysed by the package sectionproperties, which is not needed for
anything else.

It solves Saint-Venant's torsion and bending with shear by finite elements (van Leeuwen,
*sectionproperties: A Python package for the analysis of arbitrary cross-sections using the finite
element method*, J. Open Source Softw. 6105, 2024).
"""

from __future__ import annotations

from typing import Any

from ...base.arguments import public
from ...base.arrays import Operand
from ...base.packages import check_installed
from ...errors import DeclarationError
from .shape import Shape, given

_PIECES = 400
"""Into how many triangles a cross-section is cut, about, where no size is said."""


@public
def analysed(section: Any, mesh: float | None = None) -> Shape:
    """Return a cross-section of any outline, by finite elements of the package sectionproperties,
    with torsion and shear stresses.

    Parameters
    ----------
    section
        A polygon whose corners are numbers, or a ``Section`` of sectionproperties in metres: its
        y is the beam's y, its x the beam's z.
    mesh
        Largest area of a triangle in a polygon [m^2]. At a corner that points inward the shear
        stress has no limit: the value there depends on the mesh.

    Returns
    -------
    Shape
        The cross-section by its properties.

    Raises
    ------
    LagrangeCasadiError
        If sectionproperties is not installed.
    DeclarationError
        For any other object.
    """
    found = _meshed(section, mesh) if isinstance(section, Shape) else section
    if not hasattr(found, "calculate_warping_properties"):
        raise DeclarationError(
            f"analysed: expected a polygon, or a Section of sectionproperties, got {section!r}"
        )
    found.calculate_geometric_properties()
    found.calculate_warping_properties()
    x, y = map(float, found.get_c())
    left, right, bottom, top = map(float, found.geometry.calculate_extents())
    iz, iy, iyz = map(float, found.get_ic())

    def largest(**load: float) -> float:
        return max(
            float(stress["sig_zxy"].max()) for stress in found.calculate_stress(**load).get_stress()
        )

    return given(
        float(found.get_area()),
        iz,
        iy,
        iyz=iyz,
        top=top - y,
        bottom=y - bottom,
        side=max(right - x, x - left),
        torsion=float(found.get_j()),
        torsion_modulus=1.0 / largest(mzz=1.0),
        shear_y=1.0 / largest(vy=1.0),
        shear_z=1.0 / largest(vx=1.0),
    )


def _meshed(shape: Shape, mesh: float | None) -> Operand:
    """A polygon as a section of triangles."""
    numbers = list(shape.dimensions.values())
    if shape.kind != "polygon" or not all(isinstance(x, (int, float)) for x in numbers):
        raise DeclarationError(
            f"analysed: expected a polygon whose corners are numbers, got a {shape.kind}"
        )
    check_installed("sectionproperties", "a cross-section of any outline", "sections")
    from sectionproperties.analysis.section import Section
    from sectionproperties.pre.geometry import Geometry
    from shapely import Polygon

    geometry = Geometry(Polygon([(z, y) for y, z in zip(numbers[::2], numbers[1::2], strict=True)]))
    geometry.create_mesh(mesh_sizes=[float(shape.area) / _PIECES if mesh is None else mesh])
    return Section(geometry)
