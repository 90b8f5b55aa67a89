"""The curves of a spatial link's section forces in C, as sweeps have them, over random laws: the same as in Python."""

import math
import subprocess
from importlib import resources

import numpy as np
import pytest
from compiled import cc

from lagrange_casadi.codegen.link_curves import Along, in_space, matter_of
from lagrange_casadi.declare.density import NumericDensity
from lagrange_casadi.instants.section_law import SectionLaw
from lagrange_casadi.instants.station_loads import SpatialStationLoad
from lagrange_casadi.tables import SPACE

HEAD = """#include <math.h>
#include <stdio.h>
#define casadi_real double
#define DESIGNS_REAL double
#define DESIGNS_HALF 0.5
#define DESIGNS_SIXTH (1.0/6)
#define DESIGNS_FABS fabs
#define DESIGNS_ROOT sqrt
#define DESIGNS_CLOSE 1e-15
"""
LINKS = 30


def drawn(generator):
    """A law at one instant: of a link of any density, with stations anywhere but at breaks of the density, or without."""
    many = int(generator.integers(1, 4))
    breaks = (0.0, *map(float, sorted(generator.choice([0.2, 0.45, 0.5, 0.7], many - 1, replace=False))), 1.0)
    cells = tuple(tuple(generator.uniform(0.1, 2.0, int(generator.integers(1, 5))).tolist()) for _ in range(many))
    stations = generator.choice([0.0, 0.25, 0.3, 0.75, 0.8, 0.95], int(generator.integers(0, 4)), replace=False)
    loads = tuple(SpatialStationLoad("", np.array([x]), *generator.normal(size=(6, 1))) for x in stations)
    coefficients = {name: generator.normal(size=1) * (5.0 if name[-1] == "2" else 1.0) for name in SPACE.law}
    return SectionLaw(float(generator.uniform(0.1, 3.0)), NumericDensity(breaks, cells), coefficients, loads)


def along_of(law):
    terms = max(map(len, law.density.cells))
    return Along(tuple(range(12)), tuple((0,) * 7 for _ in law.loads), law.density.breaks, terms)


def numbers(values):
    return ", ".join(repr(float(x)) for x in values)


def program(laws):
    """C that prints all values and places of each law."""
    alongs = [along_of(law) for law in laws]
    body = ""
    for law, along in zip(laws, alongs, strict=True):
        stations, parts = len(law.loads), len(law.loads) + 1
        acting = [float(getattr(load, name)[0]) for load in law.loads for name in SPACE.place_first]
        values = sum(map(len, along.places))
        shear, bending = along.degrees
        body += f"""  {{
    static const double breaks_of[] = {{{numbers(law.density.breaks)}}};
    static const double matter[] = {{{numbers(matter_of(along, law.length, law.density.cells))}}};
    static const double law[] = {{{numbers(law.coefficients[name][0] for name in SPACE.law)}}};
    static const double loads[] = {{{numbers(acting or [0.0])}}};
    const designs_link link = {{{len(law.density.cells)}, {along.terms}, {stations}, breaks_of, matter, law, loads}};
    double value[{values}], place[{along.rows}], marks[{parts}], room[1000];
    designs_along_in_space(&link, &designs_nodes{shear}, &designs_nodes{bending}, marks, room, value, place);
    for (i = 0; i < {values}; ++i) printf("%.17g ", value[i]);
    for (i = 0; i < {along.rows}; ++i) printf("%.17g ", place[i]);
    printf("\\n");
  }}
"""
    sections = resources.files("lagrange_casadi.codegen").joinpath("sections.c").read_text()
    return f"""{HEAD}{sections}{in_space(alongs)}
int main(void) {{
  int i;
  (void) designs_uniform; (void) designs_larger;
{body}  return 0;
}}
"""


@pytest.mark.parametrize("seed", [1, 2])
def test_curves_are_those_of_the_law(seed, tmp_path):
    """Each value is the force at its place, and the largest of each force is the law's."""
    generator = np.random.default_rng(seed)
    laws = [drawn(generator) for _ in range(LINKS)]
    (tmp_path / "curves.c").write_text(program(laws))
    result = cc(["cc", "-std=c99"], tmp_path, "curves.c")
    assert result.returncode == 0, result.stderr
    told = subprocess.run([tmp_path / "program"], capture_output=True, text=True, check=True).stdout
    for law, line in zip(laws, told.splitlines(), strict=True):
        along, found = along_of(law), np.array(line.split(), float)
        count = sum(map(len, along.places))
        values, places = found[:count], found[count:]
        assert places.size == along.rows
        first = 0
        for force, rows in zip(SPACE.forces, along.places, strict=True):
            own, first = values[first : first + len(rows)], first + len(rows)
            u = np.array([{"BASE": 0.0, "TIP": 1.0}[row] if isinstance(row, str) else places[row] for row in rows])
            scale = np.abs(own).max() + 1.0
            sides = np.stack([law.at(force, u[None], side)[0] for side in ("tip", "base")])
            assert np.abs(sides - own).min(axis=0).max() <= 1e-12 * scale, force
            _, largest = law.extreme(force)
            assert abs(np.abs(own).max() - abs(largest[0])) <= 1e-12 * scale, force
            ours = np.sort(np.abs(law.curves(force)[1][0]))
            assert math.isclose(ours[-1], np.abs(own).max(), rel_tol=1e-11, abs_tol=1e-12)


def test_planar_links_need_none_of_it():
    assert in_space([Along(tuple(range(7)), (), (0.0, 1.0), 1)]) == ""
