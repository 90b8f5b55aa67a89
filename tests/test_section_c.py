"""The section law in C, as sweeps and exported programs have it, over random laws: the same forces as in Python."""

import subprocess
from importlib import resources
from string import Template

import numpy as np
import pytest
from compiled import cc

from lagrange_casadi.codegen.link_curves import Along, matter_of
from lagrange_casadi.declare.density import NumericDensity

SWEEPS = """#include <math.h>
#include <stdio.h>
#define casadi_real double
#define DESIGNS_REAL double
#define DESIGNS_HALF 0.5
#define DESIGNS_SIXTH (1.0/6)
#define DESIGNS_FABS fabs
#define DESIGNS_ROOT sqrt
#define DESIGNS_CLOSE 1e-15
#define DESIGNS_END 1e-12
"""
EXPORTED = """
#define SEAL 1u
typedef double x_real;
typedef enum { X_OK, X_NOT_PREPARED, X_BAD_RATIO, X_NO_LINK, X_NOT_FINITE } x_status;
typedef int x_link;
typedef struct { unsigned seal; double matter[MATTER]; } x_model;
typedef struct { double v[OUTPUTS]; } x_outputs;
typedef struct { double axial, shear, bending; } x_forces;
static const double nothing = NAN;
static int is_finite(double x) { return x - x == 0; }
x_status x_section(const x_model* model, const x_outputs* outputs, x_link link, x_real xi, x_forces* forces);
x_status x_sections(const x_model* model, const x_outputs* outputs, x_link link, long many, const x_real* xi, x_forces* forces);
"""
LINKS, RATIOS = 40, (0.0, 0.1, 0.25, 0.4, 0.5, 0.6180339887, 0.75, 0.9, 1.0)


def drawn(generator):
    """A link: length, breaks, cells, law and what acts at stations, of which some are at breaks, ends, or asked for."""
    many = int(generator.integers(1, 4))
    breaks = (0.0, *sorted(generator.choice([0.2, 0.25, 0.5, 0.7], many - 1, replace=False)), 1.0)
    cells = tuple(tuple(generator.uniform(0.1, 2.0, int(generator.integers(1, 5)))) for _ in range(many))
    stations = generator.choice([0.0, 1e-15, 0.25, 0.3, 0.75, 0.8, 1.0 - 1e-15, 1.0], int(generator.integers(0, 4)), replace=False)
    loads = [(x, *generator.normal(size=3)) for x in stations]
    return float(generator.uniform(0.1, 3.0)), tuple(map(float, breaks)), cells, generator.normal(size=7), loads


def forces(link, u):
    """By the package's own moments, the law as the paper writes it."""
    length, breaks, cells, law, loads = link
    T = [float(part[0]) for part in NumericDensity(breaks, cells).tails(np.array([u]))]
    first = length * (u * T[0] + T[1])
    found = [law[0] + law[1] * T[0] + law[2] * first, law[3] + law[4] * T[0] + law[5] * first]
    arm = length * (1 - u)
    found.append(law[6] + law[3] * arm + law[4] * length * T[1] + law[5] * length**2 * (u * T[1] + T[2]))
    for x, n, f, m in loads:
        if x > 1e-12 and (u < x or x >= 1.0 - 1e-12):
            found = [found[0] + n, found[1] + f, found[2] + m + f * length * (x - u)]
    return found


def numbers(values):
    return ", ".join(repr(float(x)) for x in values)


def program(links):
    """C that prints the forces of each link at each ratio twice, by sweeps' functions and by exported ones."""
    sweeps = resources.files("lagrange_casadi.codegen").joinpath("sections.c").read_text()
    templates = resources.files("lagrange_casadi.portable").joinpath("templates")
    exported = Template("\n".join(templates.joinpath(name).read_text() for name in ("tails.c", "sections.c", "many_sections.c")))
    body, cases, shapes, matter, outputs, breaks, sizes = "", "", [], [], [], [], []
    for k, (length, edges, cells, law, loads) in enumerate(links):
        terms = max(map(len, cells))
        along = Along(tuple(range(7)), ((0, 0, 0, 0), *((0, 0, 0, 0) for _ in loads)), edges, terms)
        acting = [x for load in loads for x in load]
        body += f"""  {{
    static const double breaks_of[] = {{{numbers(edges)}}}, matter[] = {{{numbers(matter_of(along, length, cells))}}};
    static const double law[] = {{{numbers(law)}}}, loads[] = {{{numbers(acting or [0.0])}}};
    const designs_link link = {{{len(cells)}, {terms}, {len(loads)}, breaks_of, matter, law, loads, 0, 0, 0, 0, 0}};
    print_both(&link, {k});
  }}
"""
        shapes.append(f"  {{{len(cells)}, {len(breaks)}, {len(sizes)}}}")
        cases += f"  case {k}:\n    matter_of = model->matter + {len(matter)};\n    stations = {len(loads)};\n"
        cases += "".join(f"    law[{i}] = outputs->v[{len(outputs) + i}];\n" for i in range(7))
        cases += "".join(f"    acting[{i}] = outputs->v[{len(outputs) + 7 + i}];\n" for i in range(len(acting))) + "    break;\n"
        matter += [length, *(c for cell in cells for c in cell)]
        outputs += [*law, *acting]
        breaks += edges
        sizes += map(len, cells)
    filled = exported.substitute(
        p="x",
        P="X",
        most=max(sizes),
        breaks=numbers(breaks),
        sizes=", ".join(map(str, sizes)),
        shapes=",\n".join(shapes),
        loads=4 * max(len(link[-1]) for link in links),
        slack="1e-12",
        laws=cases,
        declared="",
        spread="",
        indent="",
    )
    types = EXPORTED.replace("MATTER", str(len(matter))).replace("OUTPUTS", str(len(outputs)))
    return f"""{SWEEPS}{sweeps}{types}{filled}
static const x_model model = {{1u, {{{numbers(matter)}}}}};
static const x_outputs outputs = {{{{{numbers(outputs)}}}}};
static void print_both(const designs_link* link, int k) {{
  static const double ratios[] = {{{numbers(RATIOS)}}};
  double sides[2][3];
  x_forces found;
  int i;
  for (i = 0; i < {len(RATIOS)}; ++i) {{
    designs_beside(link, ratios[i], sides);
    if (x_section(&model, &outputs, k, ratios[i], &found) != X_OK) printf("refused");
    printf("%.17g %.17g %.17g ", sides[0][0], sides[0][1], sides[0][2]);
    printf("%.17g %.17g %.17g\\n", found.axial, found.shear, found.bending);
  }}
}}
int main(void) {{
  (void) designs_uniform; (void) designs_along;
{body}  return 0;
}}
"""


@pytest.mark.parametrize("seed", [1, 2])
def test_the_section_law_is_one(seed, tmp_path):
    generator = np.random.default_rng(seed)
    links = [drawn(generator) for _ in range(LINKS)]
    (tmp_path / "both.c").write_text(program(links))
    result = cc(["cc", "-std=c99"], tmp_path, "both.c")
    assert result.returncode == 0, result.stderr
    told = subprocess.run([tmp_path / "program"], capture_output=True, text=True, check=True).stdout
    found = np.array([line.split() for line in told.splitlines()], float).reshape(LINKS, len(RATIOS), 2, 3)
    expected = np.array([[forces(link, u) for u in RATIOS] for link in links])
    for way in range(2):
        np.testing.assert_allclose(found[:, :, way], expected, rtol=0, atol=1e-13 * np.abs(expected).max())
