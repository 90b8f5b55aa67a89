"""The C of section forces along a link by itself, on drawn links: each curve is the integral of
what acts from its place to the tip, and no place of many has a larger force than the curves.
"""

import ctypes
from functools import cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import pytest
from internals import PLANE, SPACE, codegen, compiler

pytestmark = pytest.mark.quick

along_links = codegen.along_links
END = 1e-12
LENGTH = 1.3
DRAWS = 60
SIZES = ("shear", "bending")
NODES, WEIGHTS = np.polynomial.legendre.leggauss(10)


class Kind(NamedTuple):
    """A link: breaks of its density, coefficients of each cell, load points, and powers of loads
    along it.
    """

    breaks: tuple = (0.0, 1.0)
    terms: int = 1
    stations: int = 0
    powers: tuple = ()
    space: bool = False
    thick: bool = False

    @property
    def table(self):
        return SPACE if self.space else PLANE

    @property
    def along(self):
        """The link, whose columns are in this order: law, load points, loads along it."""
        table, columns = self.table, iter(range(1000))
        law = tuple(next(columns) for _ in table.law)
        points = tuple(
            tuple(next(columns) for _ in table.place_first) for _ in range(self.stations)
        )
        directions = (*table.distributed, *(table.couples if self.thick else ()))
        loads, marks = [], []
        for many in self.powers:
            width, end, *rest = (next(columns) for _ in range(2 + many * len(directions)))
            loads.append((width, end, *rest))
            marks += [(end, width), (end,)]
        jumps = self.breaks[1:-1] if self.powers else ()
        return along_links.Along(
            law, points, self.breaks, self.terms, tuple(loads), (*marks, *jumps), self.thick
        )


KINDS = {
    "even": Kind(),
    "even cells": Kind((0.0, 0.4, 1.0)),
    "tapered": Kind(terms=2),
    "cells": Kind((0.0, 0.3, 0.55, 1.0), 3),
    "loaded": Kind(stations=2),
    "loaded cells": Kind((0.0, 0.4, 1.0), 2, stations=1),
    "spread": Kind(powers=(1,)),
    "spread cells": Kind((0.0, 0.6, 1.0), 2, 1, (3, 2)),
    "spatial": Kind(space=True, terms=2),
    "spatial cells": Kind((0.0, 0.35, 1.0), 2, 1, (), space=True),
    "spatial spread": Kind(powers=(2, 1), stations=1, space=True),
    "thick": Kind(powers=(2,), space=True, thick=True),
}


@cache
def library():
    """A function for each kind, of its columns, its matter, and its values and places."""
    links = [kind.along for kind in KINDS.values()]
    macros = {"ROOT": "sqrt", "HALF": "0.5", "CLOSE": 2.0**-26, "END": END}
    text = compiler.start("double")
    text += "".join(f"#define DESIGNS_{name} {value}\n" for name, value in macros.items())
    text += along_links.pieces(links)
    for k, link in enumerate(links):
        breaks = ", ".join(map(str, link.breaks))
        text += f"static const double designs_breaks{k}[] = {{{breaks}}};\n"
        text += f"LAGRANGE_CASADI_EXPORT void drawn{k}(const double* y, const double* matter,"
        text += " double* value, double* place) {\n  const unsigned long long need = ~0ull;\n"
        text += f"{along_links.along(k, link, 'value, place', 0)}}}\n"
    return compiler.loaded(text, compiler.find_compiler())


def drawn(kind, draw):
    """Cells of a link's mass, its law, load points and loads along it; some of them special."""
    cells = draw.uniform(0.1, 2.0, (len(kind.breaks) - 1, kind.terms))
    cells[:, 1:] *= draw.choice([-0.05, 1.0])
    cells *= draw.uniform(0, 1) < 0.95
    law = draw.uniform(-4, 4, len(kind.table.law)) * (draw.uniform(size=len(kind.table.law)) < 0.9)
    points = draw.uniform(-3, 3, (kind.stations, len(kind.table.place_first)))
    points[:, 0] = draw.choice(
        [0.0, END / 2, 0.2, 0.2 + END / 2, 1 - END / 2, 1.0, *draw.uniform(0, 1, 5)], kind.stations
    )
    loads = []
    for many in kind.powers:
        end = draw.choice([1.0, draw.uniform(0.3, 1.0)])
        width = draw.choice([end, end * draw.uniform(0.01, 1.0)])
        directions = len(kind.table.distributed) + kind.thick * len(kind.table.couples)
        loads.append((width, end, draw.uniform(-6, 6, (directions, many))))
    return cells, law, points, loads


class Forces:
    """The forces of a link at places, in order from the base, integrated from the tip."""

    def __init__(self, kind, cells, law, points, loads, u):
        table = kind.table
        self.law = dict(zip(table.law, law, strict=True))
        self.points, self.table, self.u = points, table, u
        half = np.diff(u) / 2
        s = (u[:-1] + half)[:, None] + half[:, None] * NODES
        cell = np.clip(np.searchsorted(kind.breaks, u[:-1] + half, side="right") - 1, 0, None)
        mass = sum(cells[cell, j, None] * s**j for j in range(kind.terms))
        self.acts = {}
        names = (*table.distributed, *(table.couples if kind.thick else ()))
        for number, name in enumerate(names):
            total = np.zeros(s.shape)
            for width, end, c in loads:
                inside = ((end - width < u[:-1] + half) & (u[:-1] + half < end))[:, None]
                x = (end - s) / width
                total += LENGTH * inside * sum(c[number, j] * x**j for j in range(c.shape[1]))
            self.acts[name] = total
        self.half, self.s, self.mass = half, s, mass
        self.smooth = {name: self._smooth(terms) for name, terms in table.sections.items()}

    def _smooth(self, terms):
        """What a force is without load points, and the sum of sizes of what it is made of."""
        first = self.law[terms.coefficients[0]]
        acts = np.zeros(self.s.shape)
        if terms.arm:
            shear = self.table.sections[terms.shear]
            value, rate = self._smooth(shear)[0], self._rate(shear)
            acts += ((self.s - self.u[:-1, None]) * LENGTH * terms.arm) * rate
            grows = LENGTH * terms.arm * value[1:] * np.diff(self.u)
        else:
            acts += self._rate(terms)
            grows = 0.0
        if terms.couple in self.acts:
            acts = acts + self.acts[terms.couple]
        steps = self.half * (acts @ WEIGHTS) + grows
        value = first + np.append(np.cumsum(steps[::-1])[::-1], 0.0)
        return value, abs(first) + np.abs(steps).sum()

    def _rate(self, terms):
        rate = np.zeros(self.s.shape)
        if len(terms.coefficients) > 1:
            _, one, two = (self.law[name] for name in terms.coefficients)
            rate += self.mass * (one + two * LENGTH * self.s)
        if terms.distributed in self.acts:
            rate += self.acts[terms.distributed]
        return rate

    def at(self, name, beyond):
        """A force at all places, with what acts at load points beyond ratios; the size of its
        terms.
        """
        parts = self.table.parts("section", name)
        if len(parts) > 1:
            found = [self.at(part, beyond) for part in parts]
            return np.hypot(*(value for value, _ in found)), sum(size for _, size in found)
        terms = self.table.sections[name]
        value, size = self.smooth[name]
        column = self.table.place_first.index
        for point in self.points:
            acts = point[column(terms.acting)]
            if terms.arm:
                across = point[column(self.table.sections[terms.shear].acting)]
                acts = acts + across * terms.arm * LENGTH * (point[0] - self.u)
            value = value + np.where(beyond < point[0], acts, 0.0)
            size += np.max(np.abs(acts))
        return value, size


def edges(u, side):
    return np.minimum(u + END, 1 - END) if side == "tip" else np.maximum(u - END, END)


def found(number, kind, cells, law, points, loads):
    """Values of the curves of each force, and their places, from C."""
    link = kind.along
    y = np.concatenate(
        [law, points.ravel(), *(np.append([width, end], c.ravel()) for width, end, c in loads)]
    )
    matter = np.array(along_links.mass_properties_of(link, LENGTH, cells))
    value = np.full(sum(map(len, link.places)), np.nan)
    place = np.full(max(link.rows, 4), np.nan)
    pointers = [array.ctypes.data_as(ctypes.c_void_p) for array in (y, matter, value, place)]
    getattr(library(), f"drawn{number}")(*pointers)
    rows = {"BASE": 0.0, "TIP": 1.0} | dict(enumerate(place))
    split = np.split(value, np.cumsum([len(places) for places in link.places])[:-1])
    return list(zip(split, [np.array([rows[r] for r in p]) for p in link.places], strict=True))


@pytest.mark.parametrize("name", KINDS)
def test_no_force_is_larger_than_the_curves(name):
    kind, number = KINDS[name], [*KINDS].index(name)
    draw = np.random.default_rng(number)
    for _ in range(DRAWS):
        link = drawn(kind, draw)
        points, loads = link[2:]
        curves = found(number, kind, *link)
        jumps = kind.breaks[1:-1] if loads else ()
        ends = [x for width, end, _ in loads for x in (end - width, end)]
        marks = np.sort([*np.clip([*points[:, 0], *ends, *jumps], 0.0, 1.0)])
        borders = np.array([0.0, *marks, 1.0])
        places = np.concatenate([places for _, places in curves])
        u = np.unique([*np.linspace(0, 1, 301), *kind.breaks, *borders, *places])
        forces = Forces(kind, *link, u)
        for force, (values, at) in zip(kind.table.forces, curves, strict=True):
            assert ((at >= 0.0) & (at <= 1.0)).all()
            where = np.searchsorted(u, at)
            both = {side: forces.at(force, edges(u, side)) for side in ("tip", "base")}
            near = {"rtol": 0, "atol": 2e-14 * both["tip"][1]}
            assert at[:2].tolist() == [0.0, 1.0]
            np.testing.assert_array_equal(at[2 : 2 + 2 * marks.size], np.repeat(marks, 2))
            sides = ["tip", "tip", *["tip", "base"] * marks.size]
            for k, side in enumerate(sides):
                np.testing.assert_allclose(values[k], both[side][0][where[k]], **near)
            turns = values[len(sides) :].reshape(-1, marks.size + 1)
            turned = where[len(sides) :].reshape(turns.shape)
            for part, (low, high) in enumerate(pairwise(borders)):
                inside, _ = forces.at(force, np.full(u.size, edges(low, "tip")))
                np.testing.assert_allclose(
                    turns[:, part], inside[turned[:, part]], err_msg=force, **near
                )
                first, last = np.searchsorted(u, (low, high))
                of_part = inside[first : last + 1]
                seen = [*turns[:, part], of_part[0], of_part[-1]]
                assert np.abs(of_part).max() <= np.abs(seen).max() + near["atol"]
                inner = u[turned[:, part]]
                assert np.all((low - 1e-15 <= inner) & (inner <= high + 1e-15))
                if kind.space and force in SIZES and link[1].all():
                    # Where it turns nowhere, not even at an end, it is looked at the larger end.
                    ends = turns[np.isin(inner, (low, high)), part]
                    assert (ends >= max(of_part[0], of_part[-1]) - near["atol"]).all()
