"""Cross-sections by their kind and dimensions, constant or changing along a link.

Dimensions [m] are numbers, texts such as ``"30 mm"``, or expressions in parameters.
Heights are along the link's y, which in a planar mechanism is the axis n,
in the plane of motion; widths are along its z. The centroid is on the link's axis.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import pi
from typing import Any

from ...base.arguments import Symbolic, public
from ...base.arrays import Operand
from ...base.brief import Brief
from ...base.units import quantity
from ...errors import DeclarationError
from . import solid, walls
from .properties import Fibre, Properties

Demand = tuple[Any, str]
"""Expression that must be positive, and its description."""


@public
@dataclass(frozen=True, eq=False)
class Shape:
    """A cross-section: its ``kind`` and its ``dimensions`` by name."""

    kind: str
    dimensions: Mapping[str, Any]

    def __post_init__(self) -> None:
        known = DIMENSIONS.get(self.kind)
        if self.kind not in _FORMS or (known is not None and tuple(self.dimensions) != known):
            raise DeclarationError(f"{self.kind!r} is no cross-section with these dimensions")
        read = {
            name: quantity(f"{self.kind}: {name}", value, UNITS.get(name, "m"))
            if isinstance(value, str)
            else value
            for name, value in self.dimensions.items()
        }
        object.__setattr__(self, "dimensions", read)

    def properties(self, *, space: bool = True) -> Properties:
        """Return the properties of the shape.

        Parameters
        ----------
        space : bool
            False if bending is in one plane alone: round shapes then have fewer fibres.

        Returns
        -------
        Properties
            Area, second moments and fibres, about the centroid.
        """
        return _FORMS[self.kind](self.dimensions, space)

    @property
    def round(self) -> bool:
        """True if the shape is the same about any axis of its plane."""
        return self.kind in _ROUND

    @property
    def area(self) -> Operand:
        """Area [m^2]."""
        return _AREAS[self.kind](self.dimensions)

    def parameter_constraints(self) -> Iterator[Demand]:
        """Conditions on the dimensions."""
        kind, d = self.kind, self.dimensions
        if kind == "polygon":
            yield solid.polygon_area(_corners(d)), "area, of corners counter-clockwise,"
            return
        for name, value in d.items():
            if name != "iyz":
                yield value, name
        if kind == "given":
            yield d["iy"] * d["iz"] - d["iyz"] ** 2, "iy iz - iyz^2"
        elif kind == "tube":
            yield d["diameter"] - 2 * d["wall"], "inner diameter"
        elif kind == "hollow_section":
            for side in ("height", "width"):
                yield d[side] - 2 * d["outer_radius"], f"straight part of the {side}"
                inside = d[side] - 2 * d["wall"] - 2 * d["inner_radius"]
                yield inside, f"straight part of the inner {side}"
        elif kind in ("i_section", "c_section", "box"):
            yield d["height"] - 2 * d["flange"], "height between the flanges"
            yield (
                d["width"] - (2 if kind == "box" else 1) * d["web"],
                "width beside the web" + ("s" if kind == "box" else ""),
            )
        elif kind == "t_section":
            yield d["height"] - d["flange"], "height of the web"
            yield d["width"] - d["web"], "width beside the web"

    def mapped(self, change: Callable[[str, Operand], Operand]) -> Shape:
        """Return the shape with other dimensions.

        Parameters
        ----------
        change : callable
            Gives a new size [m] from a dimension's name and size.

        Returns
        -------
        Shape
            A shape of the same kind.
        """
        return Shape(
            self.kind, {name: change(name, value) for name, value in self.dimensions.items()}
        )


@dataclass(frozen=True, eq=False, repr=False)
class Course(Brief):
    """Cross-sections along a link: linear between two ``breaks``, ratios xi/l, from one shape to
    another of its kind.

    ``ends`` are the numbers of both among the ``shapes``, for each stretch between two breaks.
    """

    breaks: tuple[float, ...]
    shapes: tuple[Shape, ...]
    ends: tuple[tuple[int, int], ...]

    def __post_init__(self) -> None:
        rises = all(a < b for a, b in itertools.pairwise(self.breaks))
        if len(self.breaks) != len(self.ends) + 1 or not rises:
            raise DeclarationError("the breaks of a course of cross-sections do not fit its ends")

    @property
    def cells(self) -> tuple[tuple[Shape, Shape], ...]:
        """The first and the last shape between two breaks."""
        return tuple((self.shapes[first], self.shapes[last]) for first, last in self.ends)

    def mapped(self, change: Callable[[str, Operand], Operand]) -> Course:
        """Return the course with other dimensions.

        Parameters
        ----------
        change : callable
            Gives a new size [m] from a dimension's name and size.

        Returns
        -------
        Course
            The course, with the same breaks.
        """
        return replace(self, shapes=tuple(shape.mapped(change) for shape in self.shapes))


@public
def rectangle(height: Symbolic, width: Symbolic) -> Shape:
    """Return a rectangle.

    Parameters
    ----------
    height, width
        Sizes along y and along z [m], numbers, texts such as ``"30 mm"``, or expressions of
        parameters.

    Returns
    -------
    Shape
        The cross-section.

    Raises
    ------
    DeclarationError
        For a text that is no length.
    """
    return Shape("rectangle", {"height": height, "width": width})


@public
def round_bar(diameter: Symbolic) -> Shape:
    """Return a round bar.

    Parameters
    ----------
    diameter
        Diameter [m], numbers, texts such as ``"30 mm"``, or expressions of parameters.

    Returns
    -------
    Shape
        The cross-section.

    Raises
    ------
    DeclarationError
        For a text that is no length.
    """
    return Shape("round_bar", {"diameter": diameter})


@public
def tube(diameter: Symbolic, wall: Symbolic) -> Shape:
    """Return a round tube.

    Parameters
    ----------
    diameter, wall
        Outer diameter and wall [m], numbers, texts such as ``"30 mm"``, or expressions of
        parameters.

    Returns
    -------
    Shape
        The cross-section.

    Raises
    ------
    DeclarationError
        For a text that is no length.
    """
    return Shape("tube", {"diameter": diameter, "wall": wall})


@public
def ellipse(height: Symbolic, width: Symbolic) -> Shape:
    """Return an ellipse.

    Parameters
    ----------
    height, width
        Diameters along y and along z [m], numbers, texts such as ``"30 mm"``, or expressions of
        parameters.

    Returns
    -------
    Shape
        The cross-section.

    Raises
    ------
    DeclarationError
        For a text that is no length.
    """
    return Shape("ellipse", {"height": height, "width": width})


@public
def i_section(height: Symbolic, width: Symbolic, web: Symbolic, flange: Symbolic) -> Shape:
    """Return an I section without fillets.

    Parameters
    ----------
    height, width
        Outer sizes along y and along z [m], numbers, texts such as ``"30 mm"``, or expressions of
        parameters.
    web, flange
        Thickness of the web, and of each flange [m].

    Returns
    -------
    Shape
        The cross-section.

    Raises
    ------
    DeclarationError
        For a text that is no length.
    """
    return Shape("i_section", {"height": height, "width": width, "web": web, "flange": flange})


@public
def t_section(height: Symbolic, width: Symbolic, web: Symbolic, flange: Symbolic) -> Shape:
    """Return a T section without fillets, with its flange on the side of +y.

    Parameters
    ----------
    height, width
        Outer sizes along y and along z [m], numbers, texts such as ``"30 mm"``, or expressions of
        parameters.
    web, flange
        Thickness of web and flange [m].

    Returns
    -------
    Shape
        The cross-section.

    Raises
    ------
    DeclarationError
        For a text that is no length.
    """
    return Shape("t_section", {"height": height, "width": width, "web": web, "flange": flange})


@public
def c_section(height: Symbolic, width: Symbolic, web: Symbolic, flange: Symbolic) -> Shape:
    """Return a C section without fillets, with its web on the side of -z.

    Parameters
    ----------
    height, width
        Outer sizes along y and along z [m], numbers, texts such as ``"30 mm"``, or expressions of
        parameters.
    web, flange
        Thickness of the web, and of each flange [m].

    Returns
    -------
    Shape
        The cross-section.

    Raises
    ------
    DeclarationError
        For a text that is no length.
    """
    return Shape("c_section", {"height": height, "width": width, "web": web, "flange": flange})


@public
def box(height: Symbolic, width: Symbolic, web: Symbolic, flange: Symbolic) -> Shape:
    """Return a box with sharp corners, two webs along y and two flanges along z.

    Parameters
    ----------
    height, width
        Outer sizes along y and along z [m], numbers, texts such as ``"30 mm"``, or expressions of
        parameters.
    web, flange
        Thickness of each web, and of each flange [m].

    Returns
    -------
    Shape
        The cross-section.

    Raises
    ------
    DeclarationError
        For a text that is no length.
    """
    return Shape("box", {"height": height, "width": width, "web": web, "flange": flange})


@public
def hollow_section(
    height: Symbolic,
    width: Symbolic,
    wall: Symbolic,
    outer_radius: Symbolic,
    inner_radius: Symbolic,
) -> Shape:
    """Return a square or rectangular tube with rounded corners.

    Parameters
    ----------
    height, width
        Outer sizes along y and along z [m], numbers, texts such as ``"30 mm"``, or expressions of
        parameters.
    wall
        Thickness of the wall [m].
    outer_radius, inner_radius
        Radii of the corners [m]; EN 10210-2 takes 1.5 and 1 times the wall.

    Returns
    -------
    Shape
        The cross-section.

    Raises
    ------
    DeclarationError
        For a text that is no length.
    """
    values = (height, width, wall, outer_radius, inner_radius)
    return Shape("hollow_section", dict(zip(DIMENSIONS["hollow_section"], values, strict=True)))


@public
def polygon(places: Sequence[tuple[Operand, Operand]]) -> Shape:
    """Return a polygon without holes, moved so that its centroid lies on the link's axis.

    Parameters
    ----------
    places
        Corners (y, z) [m], counter-clockwise from y to z, numbers or expressions of parameters.

    Returns
    -------
    Shape
        The cross-section; its torsion is not known, use :func:`analysed` for it.

    Raises
    ------
    DeclarationError
        For fewer than three corners.
    """
    try:
        corners = [(y, z) for y, z in places]
    except (TypeError, ValueError):
        raise DeclarationError(f"polygon: expected corners (y, z), got {places!r}") from None
    if len(corners) < 3:
        raise DeclarationError(f"polygon: expected three corners or more, got {len(corners)}")
    return Shape(
        "polygon",
        {
            f"{axis}{k}": x
            for k, corner in enumerate(corners, 1)
            for axis, x in zip("yz", corner, strict=True)
        },
    )


@public
def given(
    area: Symbolic,
    iz: Symbolic,
    iy: Symbolic,
    *,
    top: Symbolic,
    side: Symbolic,
    bottom: Symbolic | None = None,
    iyz: Symbolic = 0.0,
    torsion: Symbolic | None = None,
    torsion_modulus: Symbolic | None = None,
    shear_y: Symbolic | None = None,
    shear_z: Symbolic | None = None,
) -> Shape:
    """Return a cross-section by its properties, as tables of standards have them.

    Parameters
    ----------
    area, iz, iy
        Area [m^2], and second moments, the integrals of y^2 and of z^2 [m^4].
    top, bottom
        Distances of the outermost fibres from the centroid along +y and -y [m]; ``bottom`` is by
        default as ``top``.
    side
        Distance of the outermost fibres along z [m].
    iyz
        Integral of y z [m^4].
    torsion, torsion_modulus
        Saint-Venant's constant [m^4], and the ratio of a torsional moment to its largest shear
        stress [m^3]; both or none.
    shear_y, shear_z
        Ratios of shear forces to their largest shear stresses [m^2]; by default two thirds of the
        area.

    Returns
    -------
    Shape
        The cross-section.

    Raises
    ------
    DeclarationError
        If only one of the two numbers of torsion is given.
    """
    if (torsion is None) != (torsion_modulus is None):
        raise DeclarationError("given: torsion and torsion_modulus go together")
    whole = quantity("given: area", area, "m^2") if isinstance(area, str) else area
    numbers = {
        "area": whole,
        "iz": iz,
        "iy": iy,
        "iyz": iyz,
        "top": top,
        "bottom": top if bottom is None else bottom,
        "side": side,
        "torsion": torsion,
        "torsion_modulus": torsion_modulus,
        "shear_y": 2 / 3 * whole if shear_y is None else shear_y,
        "shear_z": 2 / 3 * whole if shear_z is None else shear_z,
    }
    return Shape("given", {name: x for name, x in numbers.items() if x is not None})


@public
def along(ratios: Sequence[float], shapes: Sequence[Shape]) -> Course:
    """Return cross-sections along a link, linear in their dimensions between given ratios.

    Parameters
    ----------
    ratios
        Ratios xi/l from 0 to 1, in order; a ratio that is given twice makes a step.
    shapes
        A cross-section for each ratio, all of one kind.

    Returns
    -------
    Course
        The cross-sections along the link.

    Raises
    ------
    DeclarationError
        For ratios that fall or do not reach from 0 to 1, and for shapes that do not fit together.
    """
    if len(ratios) != len(shapes) or len(ratios) < 2:
        raise DeclarationError(
            f"along: expected as many shapes as ratios, two or more, got {len(ratios)} and"
            f" {len(shapes)}"
        )
    if (ratios[0], ratios[-1]) != (0.0, 1.0) or any(b < a for a, b in itertools.pairwise(ratios)):
        raise DeclarationError(
            "along: ratios must rise from 0 to 1, got"
            f" {', '.join(f'{ratio:g}' for ratio in ratios)}"
        )
    each, breaks, ends = [*dict.fromkeys(shapes)], [0.0], []
    for (a, first), (b, last) in itertools.pairwise(zip(ratios, shapes, strict=True)):
        if a == b:
            continue
        if (first.kind, list(first.dimensions)) != (last.kind, list(last.dimensions)):
            raise DeclarationError(
                f"along: between xi/l = {a:g} and {b:g} a {first.kind} cannot become a {last.kind};"
                " put a step"
            )
        breaks.append(b)
        ends.append((each.index(first), each.index(last)))
    return Course(tuple(breaks), tuple(each), tuple(ends))


@public
def tapered(base: Shape, tip: Shape) -> Course:
    """Return a cross-section whose dimensions change linearly from base to tip.

    Parameters
    ----------
    base, tip
        Cross-sections of one kind at the two ends.

    Returns
    -------
    Course
        The cross-sections along the link.

    Raises
    ------
    DeclarationError
        For shapes of different kinds.
    """
    return along([0.0, 1.0], [base, tip])


@public
def stepped(steps: Sequence[float], shapes: Sequence[Shape]) -> Course:
    """Return constant cross-sections with steps between them.

    Parameters
    ----------
    steps
        Ratios xi/l of the steps, in order.
    shapes
        Cross-sections, one more than steps.

    Returns
    -------
    Course
        The cross-sections along the link.

    Raises
    ------
    DeclarationError
        For numbers that do not fit each other.
    """
    if len(shapes) != len(steps) + 1:
        raise DeclarationError(
            f"stepped: expected one step fewer than shapes, got {len(steps)} steps and"
            f" {len(shapes)} shapes"
        )
    ends = [0.0, *steps, 1.0]
    return along(
        [x for pair in itertools.pairwise(ends) for x in pair],
        [shape for shape in shapes for _ in range(2)],
    )


def between(first: Shape, last: Shape, share: Operand) -> Shape:
    """The shape at a ``share`` of the way from one to another, a number or an array."""
    if first is last:
        return first
    dimensions = {
        name: value + share * (last.dimensions[name] - value)
        for name, value in first.dimensions.items()
    }
    return Shape(first.kind, dimensions)


UNITS = dict.fromkeys(("iz", "iy", "iyz", "torsion"), "m^4") | {
    "area": "m^2",
    "torsion_modulus": "m^3",
    "shear_y": "m^2",
    "shear_z": "m^2",
}
"""Units of what is no length of a cross-section that is given by its properties."""

_ROUND = ("round_bar", "tube")
_THIN = ("height", "width", "web", "flange")
DIMENSIONS = {
    "rectangle": ("height", "width"),
    "round_bar": ("diameter",),
    "tube": ("diameter", "wall"),
    "ellipse": ("height", "width"),
    "i_section": _THIN,
    "t_section": _THIN,
    "c_section": _THIN,
    "box": _THIN,
    "hollow_section": ("height", "width", "wall", "outer_radius", "inner_radius"),
}
"""Names of the dimensions by kind, of those whose dimensions do not vary."""


def _corners(d: Mapping[str, Operand]) -> list[tuple[Operand, Operand]]:
    return [(d[f"y{k}"], d[f"z{k}"]) for k in range(1, len(d) // 2 + 1)]


def _given(d: Mapping[str, float], _space: bool) -> Properties:
    fibres = [
        Fibre(f"corner {y_word} {z_word}", y, z)
        for y, y_word in ((d["top"], "+y"), (-d["bottom"], "-y"))
        for z, z_word in ((d["side"], "+z"), (-d["side"], "-z"))
    ]
    twist = 1 / d["torsion_modulus"] if "torsion" in d else 0.0
    for sign in (1, -1) if "torsion" in d else (1,):
        fibres.append(
            Fibre("inside, along y", 0.0, 0.0, along_y=(1 / d["shear_y"], 0.0, sign * twist))
        )
        fibres.append(
            Fibre("inside, along z", 0.0, 0.0, along_z=(0.0, 1 / d["shear_z"], sign * twist))
        )
    stiff = 5 / 6 * d["area"]
    numbers = (d["area"], d["iy"], d["iz"], tuple(fibres), d["iyz"], d.get("torsion"))
    return Properties(*numbers, shear_y=stiff, shear_z=stiff)


_FORMS: dict[str, Callable[[Mapping[str, Any], bool], Properties]] = {
    "rectangle": lambda d, _: solid.rectangle(**d),
    "round_bar": lambda d, space: solid.ellipse(d["diameter"], d["diameter"], space=space),
    "tube": lambda d, space: solid.tube(**d, space=space),
    "ellipse": lambda d, space: solid.ellipse(**d, space=space),
    "i_section": lambda d, _: walls.i_section(**d),
    "t_section": lambda d, _: walls.t_section(**d),
    "c_section": lambda d, _: walls.c_section(**d),
    "box": lambda d, _: walls.box(**d),
    "hollow_section": lambda d, space: walls.hollow_section(**d, space=space),
    "polygon": lambda d, _: solid.polygon(_corners(d)),
    "given": _given,
}


# Properties have the areas too, but as expressions take milliseconds of CasADi.
_AREAS: dict[str, Callable[[Mapping[str, Any]], Any]] = {
    "rectangle": lambda d: d["height"] * d["width"],
    "round_bar": lambda d: pi / 4 * d["diameter"] ** 2,
    "tube": lambda d: pi * d["wall"] * (d["diameter"] - d["wall"]),
    "ellipse": lambda d: pi / 4 * d["height"] * d["width"],
    "i_section": lambda d: (
        2 * d["width"] * d["flange"] + (d["height"] - 2 * d["flange"]) * d["web"]
    ),
    "t_section": lambda d: d["width"] * d["flange"] + (d["height"] - d["flange"]) * d["web"],
    "c_section": lambda d: (
        2 * d["width"] * d["flange"] + (d["height"] - 2 * d["flange"]) * d["web"]
    ),
    "box": lambda d: 2 * (d["width"] * d["flange"] + (d["height"] - 2 * d["flange"]) * d["web"]),
    "hollow_section": lambda d: walls.hollow_area(**d),
    "polygon": lambda d: solid.polygon_area(_corners(d)),
    "given": lambda d: d["area"],
}
