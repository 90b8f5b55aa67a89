"""A link with a beam as an input file of CalculiX or Abaqus that runs: quadratic beam elements, its
section and material, and one load case.

Inertia and weight act as forces of nodes, by the elements' shape functions. These integrate the
link's density exactly, so the loads stay in equilibrium, and the mean of a section force over an
element is that of the section law, however coarse the mesh.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from ..base.arrays import Array
from ..beams.shape import Shape, between
from ..errors import DeclarationError
from .loads import LoadCase, Rod, inertia_field, listed, node_sets, title

_ELEMENTS = 16
"""Elements of a link, where no load point and no step of the section asks for more."""

_SAME = 1e-9
"""Distance of two nodes, as a share of the length, below which they are one."""

_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(6)
_SHAPES = np.array([_POINTS * (_POINTS - 1) / 2, 1 - _POINTS**2, _POINTS * (_POINTS + 1) / 2])
"""Shape functions of the three nodes of an element at the points of integration."""

_ENDS = np.array([(1 - _POINTS) / 2, (1 + _POINTS) / 2])
"""Linear ones, for couples: CalculiX takes none at nodes in the middle."""


def beam_model(case: LoadCase, _number: int, nodes: Mapping[str, str]) -> Iterator[str]:
    """Yield the lines of an input file; ``nodes`` are names of node sets, by those of the loads."""
    rod = case.rod
    if rod is None:
        raise DeclarationError(
            f"load cases of link '{case.link}': format 'beam' needs a link with a beam"
        )
    elastic = rod.beam.material.needs("a model for finite elements", "elasticity", "shear_modulus")
    poisson = elastic[0] / (2.0 * elastic[1]) - 1.0
    if not -1.0 < poisson < 0.5:
        raise DeclarationError(
            f"load case of link '{case.link}': material '{rod.beam.material.name}' has Poisson's"
            f" ratio {poisson:.4g} by its moduli, but solids have -1 to 0.5"
        )
    bearing = node_sets(case, nodes)
    x = _mesh(rod, [node.at[0] for _, node in bearing])
    loads = _inertia(case, rod, x)
    sets: list[tuple[str, int]] = []
    for name, node in bearing:
        k = int(np.argmin(np.abs(x - node.at[0])))
        arm = np.array(node.at) - [x[k], 0.0, 0.0]
        loads[k] += [*node.force, *(np.array(node.moment) + np.cross(arm, node.force))]
        sets.append((name, k))
    # CalculiX holds no node against twisting that bears a moment: one within an element bears none.
    sets += [("BASE", 0), ("TIP", x.size - 1), ("WITHIN", x.size // 4 * 2 + 1)]
    yield "*HEADING"
    yield title(case)
    yield "** SI units, on the axes of the link: x leads from its base to its tip."
    yield "*NODE, NSET=NODES"
    yield from (f"{k}, {listed([at, 0.0, 0.0])}" for k, at in enumerate(x, 1))
    yield from _elements(case.link, rod, x)
    for name, k in sets:
        if not name.isdigit():
            yield from (f"*NSET, NSET={name}", f"{k + 1}")
    yield "*MATERIAL, NAME=MATERIAL"
    yield f"** {rod.beam.material.name}"
    yield "*ELASTIC"
    yield listed([elastic[0], poisson])
    yield from ("*DENSITY", f"{rod.beam.material.density:.12g}")
    yield "** The supports carry no load: the loads are in equilibrium."
    yield from ("*BOUNDARY", "BASE, 1, 3", "TIP, 2, 3", "WITHIN, 4", "*STEP", "*STATIC")
    yield "** Loads of joints, with inertia and weight as forces of nodes"
    yield "*CLOAD"
    for number, row in enumerate(loads.tolist(), 1):
        yield from (f"{number}, {k}, {value:.12g}" for k, value in enumerate(row, 1) if value)
    yield from ("*NODE FILE", "U", "*EL FILE", "S", "*END STEP")


def _mesh(rod: Rod, places: Sequence[float]) -> Array:
    """Return the x of all nodes: load points, steps of section and density are ends of elements."""
    ratios = {*rod.density.breaks, *rod.beam.course.breaks}
    ratios |= {b for moment in rod.slices for b in moment.breaks}
    ends = sorted({0.0, 1.0, *ratios, *(min(max(x / rod.length, 0.0), 1.0) for x in places)})
    kept = [0.0]
    for end in ends:
        if end - kept[-1] > _SAME and (end == 1.0 or 1.0 - end > _SAME):
            kept.append(end)
    found = [0.0]
    for start, stop in itertools.pairwise(kept):
        count = 2 * math.ceil(_ELEMENTS * (stop - start) - _SAME)
        found += np.linspace(start, stop, count + 1)[1:].tolist()
    return rod.length * np.array(found)


def _inertia(case: LoadCase, rod: Rod, x: Array) -> Array:
    """Return forces and moments of nodes (nodes, 6) of weight and inertia."""
    moved = np.array([case.acceleration, case.omega, case.alpha, case.gravity])
    _, omega, alpha, _ = moved
    loads = np.zeros((x.size, 6))
    for k in range(0, x.size - 1, 2):
        start, stop = x[k], x[k + 2]
        at = (start + stop) / 2 + (stop - start) / 2 * _POINTS
        share = _WEIGHTS * (stop - start) / (2 * rod.length)
        mass = share * rod.density.at(at / rod.length)
        field = inertia_field(moved, at[:, None] * np.array([1.0, 0.0, 0.0]))
        loads[k : k + 3, :3] += _SHAPES @ (mass[:, None] * field)
        if rod.slices:
            yy, zz, yz = (share * moment.at(at / rod.length) for moment in rod.slices)
            none = np.zeros_like(yy)
            inertia = np.array([[yy + zz, none, none], [none, zz, -yz], [none, -yz, yy]])
            spun = np.einsum("ijn,j->ni", inertia, omega)
            couple = np.einsum("ijn,j->ni", inertia, alpha) + np.cross(omega, spun)
            loads[k : k + 3 : 2, 3:] -= _ENDS @ couple
    return loads


def _elements(link: str, rod: Rod, x: Array) -> Iterator[str]:
    """Yield elements and their sections; each has the section of its middle."""
    course = rod.beam.course
    numbers: dict[tuple[str, str, str], list[int]] = {}
    for k in range(0, x.size - 1, 2):
        ratio = x[k + 1] / rod.length
        cell = max(0, int(np.searchsorted(course.breaks, ratio)) - 1)
        low, high = course.breaks[cell : cell + 2]
        shape = between(*course.cells[cell], (ratio - low) / (high - low))
        numbers.setdefault(_section(shape), []).append(k)
    for number, ((kind, section, sizes), members) in enumerate(numbers.items(), 1):
        name = link if len(numbers) == 1 else f"{link}_{number}"
        yield f"*ELEMENT, TYPE={kind}, ELSET={name}"
        yield from (f"{k // 2 + 1}, {k + 1}, {k + 2}, {k + 3}" for k in members)
        if section == "RECT" and rod.beam.course.cells[0][0].kind != "rectangle":
            yield "** A rectangle with the second moments about y and z of the link's section"
        yield f"*BEAM SECTION, ELSET={name}, MATERIAL=MATERIAL, SECTION={section}"
        yield sizes
        yield "0., 1., 0."


def _section(shape: Shape) -> tuple[str, str, str]:
    """Return the type of an element, the kind of its section, and its sizes, y first."""
    d = shape.dimensions
    match shape.kind:
        case "rectangle":
            return "B32", "RECT", listed([d["height"], d["width"]])
        case "round_bar":
            return "B32", "CIRC", listed([d["diameter"] / 2, d["diameter"] / 2])
        case "ellipse":
            return "B32", "CIRC", listed([d["height"] / 2, d["width"] / 2])
    whole = shape.properties()
    slender = math.sqrt(whole.iz / whole.iy)
    height = (12.0 * slender * whole.iz) ** 0.25
    return "B32", "RECT", listed([height, height / slender])
