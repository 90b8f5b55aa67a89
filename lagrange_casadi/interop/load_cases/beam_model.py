"""A link with a beam as an input file of CalculiX or Abaqus that runs: quadratic beam elements, its
section and material, and one load case.

Inertia and weight act as forces of nodes, by the elements' shape functions. These integrate the
link's density exactly, so the loads stay in equilibrium, and the mean of a section force over an
element is that of the section law, however coarse the mesh.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Mapping

import numpy as np

from ...base.arrays import Array
from ...model.beams.beam import Beam
from ...model.beams.shape import Shape, between
from ...model.description import BodyNumbers
from ...results.verification.instant_vectors import constant
from ..portable.text import template
from .load_case import LoadCase, listed, nodes_of, on_own_axes, refused, title, unlike

_ELEMENTS = 16
"""Elements of a link, where no load point and no step of the section asks for more."""

_SAME = 1e-9
"""Distance of two nodes, as a share of the length, below which they are one."""

_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(6)
_FORCES = np.array([_POINTS * (_POINTS - 1) / 2, 1 - _POINTS**2, _POINTS * (_POINTS + 1) / 2])
"""Shape functions of the three nodes of an element at the points of integration."""

_COUPLES = np.array([(1 - _POINTS) / 2, 0 * _POINTS, (1 + _POINTS) / 2])
"""Linear ones, for couples: CalculiX takes none at nodes in the middle."""


def modelled(case: LoadCase) -> tuple[BodyNumbers, Beam, float, float]:
    """Return what a model is made of: the link and its beam, modulus of elasticity [Pa] and
    Poisson's ratio. Raises :class:`.DeclarationError` where something is missing.
    """
    if case.rod is None or case.rod.beam is None:
        raise refused(case.link, "format 'beam' needs a link with a beam")
    beam = case.rod.beam
    material = beam.material
    young, shear = material.needs("a model for finite elements", "elasticity", "shear_modulus")
    poisson = young / (2.0 * shear) - 1.0
    if not -1.0 < poisson < 0.5:
        why = f"material '{material.name}' has Poisson's ratio {poisson:.4g} by its moduli"
        raise refused(case.link, f"{why}, but solids have -1 to 0.5")
    return case.rod, beam, young, poisson


def beam_model(case: LoadCase, _number: int, nodes: Mapping[str, str]) -> str:
    """Return an input file; ``nodes`` are names of node sets, by those of the loads."""
    (rod, beam, young, poisson), bearing = modelled(case), nodes_of(case, nodes)
    x = _mesh(rod, beam, [node.at[0] for node in bearing])
    loads, sets = _inertia(case, rod, x), dict[str, int]()
    for node in bearing:
        k = sets[node.set] = int(np.argmin(np.abs(x - node.at[0])))
        loads[k] += node.wrench
        loads[k, 3:] += np.cross(np.subtract(node.at, [x[k], 0.0, 0.0]), node.wrench[:3])
    every, base, tip, within = (unlike(name, sets) for name in ("NODES", "BASE", "TIP", "WITHIN"))
    # CalculiX holds no node against twisting that bears a moment: one within an element bears none.
    sets |= {base: 0, tip: x.size - 1, within: x.size // 4 * 2 + 1}
    return template(
        "beam.inp",
        title=title(case),
        every=every,
        nodes="\n".join(f"{k}, {listed([at, 0.0, 0.0])}" for k, at in enumerate(x, 1)),
        elements="\n".join(_elements(case.link, beam, x / rod.length_and_density[0])),
        sets="\n".join(
            f"*NSET, NSET={name}\n{k + 1}" for name, k in sets.items() if not name.isdecimal()
        ),
        material=beam.material.name,
        moduli=listed([young, poisson]),
        density=listed([beam.material.density]),
        base=base,
        tip=tip,
        within=within,
        loads="\n".join(
            f"{number}, {k}, {value:.12g}"
            for number, row in enumerate(loads.tolist(), 1)
            for k, value in enumerate(row, 1)
            if value
        ),
    )


def _mesh(rod: BodyNumbers, beam: Beam, places: Iterable[float]) -> Array:
    """Return the x of all nodes: load points, steps of section and density are ends of elements."""
    (length, density), ratios = rod.length_and_density, {0.0, 1.0, *beam.course.breaks}
    ratios |= {b for one in (density, *rod.slices) for b in one.breaks}
    kept = [0.0]
    for end in sorted({*ratios, *(min(max(x / length, 0.0), 1.0) for x in places)}):
        if end - kept[-1] > _SAME and (end == 1.0 or 1.0 - end > _SAME):
            kept.append(end)
    found = [0.0]
    for start, stop in itertools.pairwise(kept):
        count = 2 * math.ceil(_ELEMENTS * (stop - start) - _SAME)
        found += np.linspace(start, stop, count + 1)[1:].tolist()
    return np.array(found) * length


def _inertia(case: LoadCase, rod: BodyNumbers, x: Array) -> Array:
    """Return forces and moments of nodes (nodes, 6) of weight and inertia."""
    moved = on_own_axes(*map(constant, (case.acceleration, case.omega, case.alpha)))
    start, stop = x[:-2:2, None], x[2::2, None]
    at, share = (start + stop) / 2 + (stop - start) / 2 * _POINTS, stop - start
    length, density = rod.length_and_density
    ratio, share = at / length, _WEIGHTS * share / (2 * length)
    mass = share * density.at(ratio)
    change = moved.origin[2] + moved.rotation[2, 0] * at.ravel()
    force = mass.ravel() * (constant(case.gravity) - change)
    yy, zz, yz = [share * one.at(ratio) for one in rod.slices] or np.zeros((3, *ratio.shape))
    no = np.zeros_like(yy)
    slices = np.array([[yy + zz, no, no], [no, zz, -yz], [no, -yz, yy]]).reshape(3, 3, -1)
    loads = np.zeros((x.size, 6))
    for shapes, first, vector in ((_FORCES, 0, force), (_COUPLES, 3, -moved.turning(slices))):
        for column, along in enumerate(vector.reshape(3, *at.shape), first):
            for node, shape in enumerate(shapes):
                loads[node : x.size - 2 + node : 2, column] += along @ shape
    return loads


def _elements(link: str, beam: Beam, ratios: Array) -> Iterator[str]:
    """Yield elements and their sections; each has the section of its middle."""
    course = beam.course
    numbers: dict[tuple[str, str], list[int]] = {}
    for k in range(0, ratios.size - 1, 2):
        cell = max(0, int(np.searchsorted(course.breaks, ratios[k + 1])) - 1)
        low, high = course.breaks[cell : cell + 2]
        shape = between(*course.cells[cell], (ratios[k + 1] - low) / (high - low))
        numbers.setdefault(_section(shape), []).append(k)
    for number, ((section, sizes), members) in enumerate(numbers.items(), 1):
        name = link if len(numbers) == 1 else f"{link}_{number}"
        yield f"*ELEMENT, TYPE=B32, ELSET={name}"
        yield from (f"{k // 2 + 1}, {k + 1}, {k + 2}, {k + 3}" for k in members)
        if section == "RECT" and course.cells[0][0].kind != "rectangle":
            yield "** A rectangle with the second moments about y and z of the link's section"
        yield f"*BEAM SECTION, ELSET={name}, MATERIAL=MATERIAL, SECTION={section}"
        yield from (sizes, "0., 1., 0.")


def _section(shape: Shape) -> tuple[str, str]:
    """Return the kind of a section, and its sizes, y first: the sides of a rectangle, or radii."""
    d = shape.dimensions
    match shape.kind:
        case "rectangle":
            return "RECT", listed([d["height"], d["width"]])
        case "round_bar":
            return "CIRC", listed([d["diameter"] / 2, d["diameter"] / 2])
        case "ellipse":
            return "CIRC", listed([d["height"] / 2, d["width"] / 2])
    whole = shape.properties()
    slender = math.sqrt(whole.iz / whole.iy)
    height = (12.0 * slender * whole.iz) ** 0.25
    return "RECT", listed([height, height / slender])
