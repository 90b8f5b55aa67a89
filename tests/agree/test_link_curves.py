"""The curves of a link's section forces in C, as sweeps have them, over random laws: the same as in
Python.
"""

import math
import subprocess
from importlib import resources

import numpy as np
import pytest
from compiled import cc
from internals import (
    PLANE,
    SPACE,
    DistributedLoad,
    NumericDensity,
    PointLoad,
    SectionLaw,
    SpatialPointLoad,
    along,
    mass_properties_of,
    turning,
)
from internals import LinkCurvesAlong as Along

HEAD = """#include <math.h>
#include <stdio.h>
#define casadi_real double
#define lanes_real double
#define LANES_INLINE static inline
#define DESIGNS_HALF 0.5
#define DESIGNS_SIXTH (1.0/6)
#define DESIGNS_FABS fabs
#define DESIGNS_ROOT sqrt
#define DESIGNS_CLOSE 1e-15
#define lanes_less(x, y, a, b) ((x) < (y) ? (a) : (b))
#define lanes_larger(x, y) ((x) < (y) ? (y) : (x))
#define lanes_where_less(x, y) ((x) < (y))
#define DESIGNS_END 1e-12
"""
LINKS = 15


def drawn(generator, table, loaded):
    """A law at one instant: of a link of any density, with stations anywhere but at breaks of the
    density, or without.

    Where ``loaded`` there are loads along it, on all of it or on a part.
    """
    many = int(generator.integers(1, 4))
    breaks = (
        0.0,
        *map(float, sorted(generator.choice([0.2, 0.45, 0.5, 0.7], many - 1, replace=False))),
        1.0,
    )
    cells = tuple(
        tuple(generator.uniform(0.1, 2.0, int(generator.integers(1, 5))).tolist())
        for _ in range(many)
    )
    places = [0.0, 1e-15, 0.25, 1 / 3, 0.1 / 0.3, 0.8, 0.95, 1.0 - 1e-15]
    stations = generator.choice(places, int(generator.integers(0, 4)), replace=False)
    of = PointLoad if table is PLANE else SpatialPointLoad
    loads = tuple(
        of("", np.array([x]), *generator.normal(size=(len(table.load_point) - 1, 1)))
        for x in stations
    )
    coefficients = {
        name: generator.normal(size=1) * (5.0 if name[-1] == "2" else 1.0) for name in table.law
    }
    spreads = []
    for _ in range(int(generator.integers(1, 4)) if loaded else 0):
        start, end = (
            (0.0, 1.0)
            if generator.random() < 0.4
            else sorted(generator.choice([0.0, 0.1, 0.35, 0.62, 0.9, 1.0], 2, False))
        )
        terms = {
            name: tuple(generator.normal(size=(int(generator.integers(1, 6)), 1)) * 4.0)
            for name in table.distributed[:1]
        }
        terms |= {
            name: tuple(generator.normal(size=(len(terms["qn"]), 1)) * 4.0)
            for name in table.distributed[1:]
        }
        spreads.append(DistributedLoad("", np.array([end - start]), np.array([end]), terms))
    return SectionLaw(
        float(generator.uniform(0.1, 3.0)),
        NumericDensity(breaks, cells),
        coefficients,
        loads,
        tuple(spreads),
    )


def along_of(law):
    """The link's part in columns that stand one behind the other, and these."""
    y: list[float] = []

    def columns(values):
        y.extend(float(value[0]) for value in values)
        return tuple(range(len(y) - len(values), len(y)))

    members = columns([law.coefficients[name] for name in law.table.law])
    stations = tuple(
        columns([getattr(load, name) for name in law.table.place_first]) for load in law.loads
    )
    spreads = tuple(
        columns([one.width, one.end, *(c for row in one.terms.values() for c in row)])
        for one in law.distributed_loads
    )
    marks = [
        mark
        for width, end, *_ in spreads
        if (y[width], y[end]) != (1.0, 1.0)
        for mark in ((end, width), (end,))
    ]
    marks += law.density.jumps if spreads else ()
    terms = max(map(len, law.density.cells))
    return Along(members, stations, law.density.breaks, terms, spreads, tuple(marks)), y


def numbers(values):
    return ", ".join(repr(float(x)) for x in values)


def program(laws):
    """C that prints all values and places of each law."""
    links = [along_of(law) for law in laws]
    body = ""
    for k, (law, (link, y)) in enumerate(zip(laws, links, strict=True)):
        values = sum(map(len, link.places))
        body += f"""  {{
    static const double designs_breaks{k}[] = {{{numbers(law.density.breaks)}}};
    static const double matter[] = {{{numbers(mass_properties_of(link, law.length, law.density.cells))}}}, y[] = {{{numbers(y)}}};
    double value[{values}], place[{link.rows}];
    (void) designs_breaks{k};
{along(k, link, "value, place", 0)}
    for (i = 0; i < {values}; ++i) printf("%.17g ", value[i]);
    for (i = 0; i < {link.rows}; ++i) printf("%.17g ", place[i]);
    printf("\\n");
  }}
"""  # noqa: E501
    sections = resources.files("lagrange_casadi.codegen").joinpath("sections.c").read_text()
    return f"""{HEAD}{sections}{turning([link for link, _ in links])}
int main(void) {{
  const unsigned long long need = ~0ull;
  int i;
{body}  return 0;
}}
"""


@pytest.mark.sampled(3)
@pytest.mark.parametrize("loaded", [False, True])
@pytest.mark.parametrize("table", [PLANE, SPACE], ids=["plane", "space"])
@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.long)])
def test_curves_are_those_of_the_law(seed, table, loaded, tmp_path):
    """Each value is the force at its place, and the largest of each force is the law's."""
    generator = np.random.default_rng(seed)
    laws = [drawn(generator, table, loaded) for _ in range(LINKS)]
    (tmp_path / "curves.c").write_text(program(laws))
    result = cc(["cc", "-std=c99", "-Wno-unused-function"], tmp_path, "curves.c")
    assert result.returncode == 0, result.stderr
    told = subprocess.run([tmp_path / "program"], capture_output=True, text=True, check=True).stdout
    for law, line in zip(laws, told.splitlines(), strict=True):
        (link, _), found = along_of(law), np.array(line.split(), float)
        count = sum(map(len, link.places))
        values, places = found[:count], found[count:]
        assert places.size == link.rows
        first = 0
        for force, rows in zip(table.forces, link.places, strict=True):
            own, first = values[first : first + len(rows)], first + len(rows)
            u = np.array(
                [
                    {"BASE": 0.0, "TIP": 1.0}[row] if isinstance(row, str) else places[row]
                    for row in rows
                ]
            )
            scale = np.abs(own).max() + 1.0
            sides = np.stack([law.at(force, u[None], side)[0] for side in ("tip", "base")])
            assert np.abs(sides - own).min(axis=0).max() <= 1e-12 * scale, force
            _, largest = law.extreme(force)
            assert abs(np.abs(own).max() - abs(largest[0])) <= 1e-12 * scale, force
            ours = np.sort(np.abs(law.curves(force)[1][0]))
            assert math.isclose(ours[-1], np.abs(own).max(), rel_tol=1e-11, abs_tol=1e-12)


@pytest.mark.sampled(5)
@pytest.mark.parametrize("table", [PLANE, SPACE], ids=["plane", "space"])
def test_nothing_along_a_loaded_link_is_beyond_what_the_law_finds(table):
    """Smallest, largest and largest in size are forces at their places, and no point of a fine grid
    is beyond them.
    """
    generator = np.random.default_rng(3)
    xi = np.linspace(0.0, 1.0, 5001)
    for _ in range(LINKS):
        law = drawn(generator, table, loaded=True)
        for force in table.forces:
            grid = np.concatenate([law.at(force, xi[None], side)[0] for side in ("tip", "base")])
            places, found = law.reached(force)
            size = np.abs(grid).max()
            assert found[0, 0] <= grid.min() + 1e-12 * size, force
            assert found[1, 0] >= grid.max() - 1e-12 * size, force
            assert abs(found[2, 0]) >= size * (1 - 1e-12), force
            assert abs(abs(law.extreme(force)[1][0]) - abs(found[2, 0])) <= 1e-12 * size, force
            there = np.stack([law.at(force, places.T, side)[0] for side in ("tip", "base")])
            assert np.abs(there - found[:, 0]).min(axis=0).max() <= 1e-12 * size, force
