"""The forces inside a link in every form that has them, against quadrature of what is beyond a
section.
"""

import json
import subprocess
from importlib import resources

import alive
import numpy as np
import pytest
from compiled import PEDANTIC, cc
from internals import (
    END,
    PLANE,
    SIDES,
    SPACE,
    NumericDensity,
    Output,
    SectionInputs,
    grids,
    law_of,
    print_functions,
    section,
    section_entries,
)

from lagrange_casadi import Mechanism, Scene, evaluate
from lagrange_casadi.motion import harmonic

chromium = alive.chromium

SLACK, INSTANTS = END["double"], 2
NODES, WEIGHTS = np.polynomial.legendre.leggauss(8)
SIZES = {"shear": ("shear_y", "shear_z"), "bending": ("bending_y", "bending_z")}
BENT = {
    "bending": ("f", 1, "qf", ""),
    "bending_z": ("fy", 1, "qfy", "cz"),
    "bending_y": ("fz", -1, "qfz", "cy"),
}
PLAIN = {
    "axial": ("n", "qn"),
    "shear": ("f", "qf"),
    "shear_y": ("fy", "qfy"),
    "shear_z": ("fz", "qfz"),
}


class Link:
    """A link as files have it, with load points anywhere, some of them moving, some at one place or
    at ends but for rounding.
    """

    def __init__(self, random, table):
        self.table, self.length = table, float(random.uniform(0.1, 3.0))
        many = int(random.integers(1, 4))
        breaks = (
            0.0,
            *map(float, sorted(random.choice([0.2, 0.25, 0.5, 0.7], many - 1, replace=False))),
            1.0,
        )
        cells = tuple(
            tuple(random.uniform(0.1, 2.0, int(random.integers(1, 5))).tolist())
            for _ in range(many)
        )
        self.density, self.outputs = NumericDensity(breaks, cells), {}
        for member in table.law:
            self.outputs[Output("law", "rod", member)] = random.normal(size=INSTANTS)
        for k in range(int(random.integers(0, 5))):
            still = float(
                random.choice([0.0, 1e-15, 0.1 / 0.3, 1 / 3, 0.25, 0.8, 1.0 - 1e-15, 1.0])
            )
            moves = (
                random.uniform(0.05, 0.95, INSTANTS)
                if random.random() < 0.3
                else np.full(INSTANTS, still)
            )
            for member in table.load_point:
                values = moves if member == "station" else random.normal(size=INSTANTS)
                self.outputs[Output("station", "rod", member, f"load {k}")] = values
        for k in range(int(random.integers(0, 3))):
            start, end = sorted(random.choice([0.0, 0.1, 0.35, 0.62, 1.0], 2, replace=False))
            couples = table is SPACE and random.random() < 0.5
            members = table.couples if couples else table.distributed
            for member, value in (("width", end - start), ("end", end)):
                self.outputs[Output("spread", "rod", member, f"along {k}")] = np.full(
                    INSTANTS, value
                )
            for power in range(int(random.integers(1, 5))):
                for member in members:
                    self.outputs[Output("spread", "rod", member, f"along {k}", power)] = (
                        random.normal(size=INSTANTS)
                    )

    @property
    def law(self):
        return law_of("rod", self.outputs, self.length, self.density)

    @property
    def matter(self):
        return [self.length, *(c for cell in self.density.cells for c in cell)]

    def ratios(self):
        places = [
            x
            for output, values in self.outputs.items()
            if output.member == "station"
            for x in values
        ]
        near = [x + off for x in places for off in (-3e-12, 1e-14, 3e-12)]
        return np.unique(
            [u for u in [0.0, 0.25, 1 / 3, 0.6180339887, 1.0, *places, *near] if 0.0 <= u <= 1.0]
        )

    def function(self, side="tip", name="section"):
        return section(
            self.inputs.alike(),
            self.density.breaks,
            list(map(len, self.density.cells)),
            SLACK,
            side,
            name,
        )

    @property
    def inputs(self):
        return SectionInputs.of(self.outputs, "rod")

    def rows(self, i):
        """What the function takes at an instant."""
        return [
            [self.outputs[output][i] for output in outputs]
            for outputs in (self.inputs.law, self.inputs.acting)
        ]

    def of(self, group, member, i, station="", power=None):
        return self.outputs.get(Output(group, "rod", member, station, power), np.zeros(INSTANTS))[i]

    def expected(self, force, u, i, side):
        """By Gauss' rule over what is beyond the section."""
        if self.table is SPACE and force in SIZES:
            return float(np.hypot(*(self.expected(part, u, i, side) for part in SIZES[force])))
        if force in BENT:
            across, sign, along, couple = BENT[force]
            acting = {"bending": "m", "bending_z": "mz", "bending_y": "my"}[force]
            found = self.of("law", f"{acting}0", i) + sign * self.length * (1 - u) * self.of(
                "law", f"{across}0", i
            )
        else:
            (across, along), couple, sign, acting = (
                PLAIN.get(force, ("", "")),
                "cx" if force == "torsion" else "",
                0,
                "",
            )
            found = self.of("law", f"{across}0" if across else "mx0", i)

        def lever(v):
            return sign * self.length * (v - u) if sign else 1.0

        def over(a, b):
            return (a + b) / 2 + (b - a) / 2 * NODES, WEIGHTS * max(b - a, 0.0) / 2

        for a, b, cell in zip(
            self.density.breaks, self.density.breaks[1:], self.density.cells, strict=False
        ):
            v, w = over(max(a, u), max(b, u))
            pulled = (
                self.of("law", f"{across}1", i) + self.of("law", f"{across}2", i) * self.length * v
                if across
                else 0.0
            )
            found += np.sum(w * np.polynomial.polynomial.polyval(v, cell) * pulled * lever(v))
        for name in dict.fromkeys(
            output.load_point for output in self.outputs if output.load_point
        ):
            place = self.of("station", "station", i, name)
            if Output("station", "rod", "station", name) in self.outputs and self.feels(
                u, place, side
            ):
                found += self.of("station", acting or across or "mx", i, name)
                found += self.of("station", across, i, name) * lever(place) if sign else 0.0
            width, end = (self.of("spread", member, i, name) for member in ("width", "end"))
            v, w = over(max(end - width, u), max(end, u))
            for power in range(4 if width else 0):
                told = self.length * w * ((end - v) / width) ** power
                found += np.sum(told * self.of("spread", along, i, name, power) * lever(v))
                found += np.sum(told * self.of("spread", couple, i, name, power))
        return float(found)

    @staticmethod
    def feels(u, place, side):
        at_base, at_tip = place <= SLACK, place >= 1.0 - SLACK
        at = abs(place - u) <= SLACK
        return at_tip or (not at_base and (side == "base" if at else place > u))


def links(seed):
    random = np.random.default_rng(seed)
    return [Link(random, table) for table in (PLANE, SPACE) * 4]


def by_c(links, folder):
    """What exported C has: CasADi's own code of the functions, at all instants and ratios of each
    link, tip's side.
    """
    functions = {
        f"section_of_{k}": link.function(name=f"section_of_{k}") for k, link in enumerate(links)
    }
    body = ""
    for k, link in enumerate(links):
        many = len(link.table.forces)
        for i in range(INSTANTS):
            rows = [*link.rows(i), link.matter, link.ratios()]
            law, acting, matter, ratios = (
                ", ".join(repr(float(x)) for x in row) or "0" for row in rows
            )
            body += f"""  {{
    static const double law[] = {{{law}}}, acting[] = {{{acting}}}, matter[] = {{{matter}}}, ratios[] = {{{ratios}}};
    const double* arg[4] = {{law, acting, matter, 0}};
    double found[{many}], *res[1];
    int i, j;
    res[0] = found;
    for (i = 0; i < {link.ratios().size}; ++i) {{
      arg[3] = ratios + i;
      for (j = 0; j < {many}; ++j) found[j] = NAN;
      section_of_{k}(arg, res);
      for (j = 0; j < {many}; ++j) printf("%.17g ", found[j]);
    }}
  }}
"""  # noqa: E501
    printed = print_functions(functions, "double", prefix="table")
    text = f"#include <math.h>\n#include <stdio.h>\n#define casadi_real double\n{printed}"
    (folder / "forms.c").write_text(f"{text}int main(void) {{\n{body}  return 0;\n}}\n")
    result = cc(["cc", *PEDANTIC], folder, "forms.c")
    assert result.returncode == 0, result.stderr
    told = subprocess.run([folder / "program"], capture_output=True, text=True, check=True).stdout
    values = iter(map(float, told.split()))
    return [
        np.array(
            [
                [[next(values) for _ in link.table.forces] for _ in link.ratios()]
                for _ in range(INSTANTS)
            ]
        )
        for link in links
    ]


@pytest.mark.parametrize(
    "seed", [1, pytest.param(2, marks=pytest.mark.long), pytest.param(3, marks=pytest.mark.long)]
)
def test_every_form_has_the_forces_of_what_is_beyond_a_section(seed, tmp_path, monkeypatch):
    drawn = links(seed)
    for link, in_c in zip(drawn, by_c(drawn, tmp_path), strict=True):
        law, u = link.law, link.ratios()
        functions = {side: link.function(side) for side in SIDES}
        ways = {
            (i, side): functions[side](*link.rows(i), link.matter, u[None]).full().T
            for i in range(INSTANTS)
            for side in SIDES
        }
        for k, force in enumerate(link.table.forces):
            expected = {
                side: np.array(
                    [[link.expected(force, x, i, side) for x in u] for i in range(INSTANTS)]
                )
                for side in SIDES
            }
            off = {
                "rtol": 0,
                "atol": (
                    2e-13 * max(1.0, np.abs(expected["tip"]).max(), np.abs(expected["base"]).max())
                ),
            }
            for side in SIDES:
                np.testing.assert_allclose(
                    law.at(force, np.tile(u, (INSTANTS, 1)), side), expected[side], **off
                )
                np.testing.assert_allclose(
                    [ways[i, side][:, k] for i in range(INSTANTS)], expected[side], **off
                )
            np.testing.assert_allclose(in_c[:, :, k], expected["tip"], **off)
            for worth in (0, 10**12):
                monkeypatch.setattr(grids, "WORTH_COMPILING", worth)
                np.testing.assert_allclose(law.on_grid(force, u), expected["tip"], **off)


def test_links_of_one_kind_have_one_function():
    first, second = Link(np.random.default_rng(5), PLANE), Link(np.random.default_rng(5), PLANE)
    renamed = {
        Output(
            one.group, "bar", one.member, one.load_point and f"other {one.load_point}", one.power
        ): values
        for one, values in second.outputs.items()
    }
    assert SectionInputs.of(renamed, "bar").alike() == first.inputs.alike()
    assert SectionInputs.of(renamed, "bar") != first.inputs


def loaded(place, ratios):
    """A bar at rest with a force at a place, and outputs of what sections feel of it."""
    m = Mechanism("bar")
    bar = m.link("bar", length=0.3, mass=1e-12)
    m.revolute("O", m.ground, bar)
    m.force("F", bar.at(place), y=-10.0)
    for k, ratio in enumerate(ratios):
        m.output(f"shear_{k}", m.results.section(bar, ratio).shear, unit="N")
    return evaluate(Scene(m, {"O": harmonic(0.0, 0.0, 1.0)}, t=(0.0, 1.0, 2)), xi=(0, 1, 4))


@pytest.mark.parametrize(
    ("place", "rest"),
    [(0.1, [-10, 0, 0, 0]), (0.2, [-10, -10, 0, 0]), (0.3, [-10] * 4), (0.0, [0] * 4)],
)
def test_a_section_at_a_load_point_is_on_its_tip_s_side_whatever_rounding_says(place, rest):
    """A tenth of a metre over three tenths is not one third in doubles."""
    assert np.linspace(0, 1, 4)[1] != 0.1 / 0.3
    found = loaded(place, np.linspace(0, 1, 4).tolist())
    np.testing.assert_allclose(found.section("bar").shear[0], rest, atol=1e-9)
    np.testing.assert_allclose([found.output(f"shear_{k}")[0] for k in range(4)], rest, atol=1e-9)


def test_opposite_loads_at_one_place_are_felt_by_no_section():
    """Not either by one between them, where rounding puts their places apart."""
    link = Link(np.random.default_rng(0), PLANE)
    link.outputs = {output: np.zeros(INSTANTS) for output in link.outputs if output.group == "law"}
    for name, place, force in (("a", 0.1 / 0.3, 10.0), ("b", 1 / 3, -10.0)):
        values = {"station": place, "n": 0.0, "f": force, "m": 0.0}
        link.outputs |= {
            Output("station", "rod", member, name): np.full(INSTANTS, x)
            for member, x in values.items()
        }
    assert np.abs(link.law.reached("shear")[1]).max() == 0.0
    assert np.abs(link.law.extreme("bending")[1]).max() < 1e-14


class Numbers(list):
    """Arrays of a page as lists."""

    def add(self, values, *_):
        self.append(values.tolist())
        return len(self) - 1


@alive.NEEDS_BROWSER
def test_a_page_has_the_same_forces_beside_load_points(chromium):
    found, numbers = loaded(0.1, [0.5]), Numbers()
    entries = list(section_entries(found, np.arange(2), numbers))
    law = found.section("bar").law
    places = [0.0, 0.1, 1 / 3, 0.1 / 0.3, 1 / 3 - 3e-12, 1 / 3 + 3e-12, 0.7, 1.0]
    asked = [(force, u, side) for force in PLANE.forces for u in places for side in SIDES]
    text = resources.files("lagrange_casadi.report").joinpath("assets", "law.js").read_text()
    forces = chromium.run(f"""(() => {{
        const contents = {{ sections: {json.dumps(entries)} }};
        const array = (number) => {json.dumps(numbers)}[number];
        {text}
        return {json.dumps(asked)}.map(([force, u, side]) => sectionForceAt(sections[0], force, 0, u, side));
    }})()""")  # noqa: E501
    expected = [law.at(force, np.full((2, 1), u), side)[0, 0] for force, u, side in asked]
    np.testing.assert_allclose(forces, expected, rtol=0, atol=1e-11)
