"""Models of beams that load cases are written as, in CalculiX itself."""

from __future__ import annotations

import re
import subprocess

import numpy as np
import pytest
from mechanisms import crank_and_rod
from strong import robot

from lagrange_casadi import beams, evaluate, link_load_cases, write_load_cases

pytestmark = pytest.mark.usefixtures("interpreted")

FORCES, MOMENTS = ("axial", "shear_y", "shear_z"), ("torsion", "bending_y", "bending_z")


PLANAR = ("axial", "shear", "", "", "", "bending")


SPRING = 1e7


SUPPORTS = [(node, k) for node, ks in (("BASE", (1, 2, 3)), ("TIP", (2, 3))) for k in ks]
"""Springs in place of the supports of a model: what they bear is their length, with all digits."""


_, GAUSS = np.polynomial.legendre.leggauss(3)


ROOT = np.sqrt(0.6)


# The order of 27 points of an element: along x, then z downwards, then y.
Y, Z, _ = (a.ravel() for a in np.meshgrid([-1, 0, 1], [1, 0, -1], [0, 0, 0], indexing="ij"))


WEIGHTS = np.einsum("i,j,k->ijk", GAUSS, GAUSS, GAUSS).ravel() / 8


def on_springs(text):
    """Return a model whose supports are springs, but for that against twisting."""
    nodes = {name: int(re.search(rf"NSET={name}\n(\d+)", text)[1]) for name in ("BASE", "TIP")}
    found = []
    for number, (name, k) in enumerate(SUPPORTS, 900001):
        found += [f"*ELEMENT, TYPE=SPRING1, ELSET={name}{k}", f"{number}, {nodes[name]}"]
        found += [f"*SPRING, ELSET={name}{k}", f"{k}", f"{SPRING:.1f}"]
    found += ["*BOUNDARY", "WITHIN, 4", "*STEP"]
    text = text.replace("*BOUNDARY\nBASE, 1, 3\nTIP, 2, 3\nWITHIN, 4\n*STEP", "\n".join(found))
    elements = re.findall(r"\*ELEMENT, TYPE=B32, ELSET=(\S+)", text)
    asked = "*NODE PRINT, NSET=NODES\nU\n"
    asked += "".join(f"*EL PRINT, ELSET={name}\nS\n" for name in elements)
    return text.replace("*NODE FILE\nU\n*EL FILE\nS\n", asked)


def run(folder, name, text):
    """Run a model: displacements by node, and stresses (points, 6) by element."""
    (folder / f"{name}.inp").write_text(text)
    command = ["ccx", name]
    done = subprocess.run(command, cwd=folder, capture_output=True, timeout=60, check=False)
    assert done.returncode == 0, done.stdout
    moved, stressed = {}, {}
    for line in (folder / f"{name}.dat").read_text().splitlines():
        row = line.split()
        if len(row) == 8 and row[0].isdigit():
            stressed.setdefault(int(row[0]), []).append([float(x) for x in row[2:]])
        elif len(row) == 4 and row[0].isdigit():
            moved[int(row[0])] = [float(x) for x in row[1:]]
    return moved, {k: np.array(rows) for k, rows in stressed.items()}


def elements_of(text):
    """Yield the numbers of elements, the x of their ends, height and width of their sections."""
    place = dict(re.findall(r"^(\d+), (\S+), 0, 0$", text, re.MULTILINE))
    for rows, sizes in re.findall(
        r"TYPE=B32[^\n]*\n([\d, \n]+).*?SECTION=RECT\n(.*?)\n", text, re.S
    ):
        for row in rows.split("\n"):
            if row:
                number, first, _, last = row.split(", ")
                ends = float(place[first]), float(place[last])
                yield int(number), ends, [float(x) for x in sizes.split(", ")]


def means(stresses, height, width):
    """Section forces of an element in the mean over its length, by virtual work."""
    y, z = (np.repeat(a[::3], 3) * ROOT / 2 for a in (Y, Z))
    y, z = y * height, z * width
    normal, along_y, along_z = stresses[:, 0], stresses[:, 3], stresses[:, 4]
    area = height * width * WEIGHTS
    parts = (normal, along_y, along_z, y * along_z - z * along_y, z * normal, -y * normal)
    return np.array([area @ part for part in parts])


def press():
    """A rod that bears a force beside its axis."""
    tapered = beams.tapered(beams.rectangle(0.06, 0.03), beams.rectangle(0.04, 0.02))
    return crank_and_rod(
        {"beam": beams.Beam(tapered, beams.material("S355"))},
        loads=lambda m, parts: m.force("push", parts["b"].at(0.13, 0.02), x=-3000.0, y=500.0),
    )


CASES = {
    "press": (press, ("b",)),
    "robot": (lambda: robot(beams.rectangle(0.25, 0.2)), ("upper",)),  # in space
}


@pytest.mark.parametrize("name", CASES)
def test_section_forces_are_the_law_and_supports_bear_nothing(name, tmp_path):
    """CalculiX prints stresses in 7 digits, so a stout beam shows its shear force to 1e-6."""
    made, links = CASES[name]
    solution = evaluate(made(), wanted=["all"], t=None)
    for link in links:
        case = link_load_cases(solution, link)[0]
        write_load_cases([case], tmp_path, ["beam"])
        text = (tmp_path / f"{link}_1.beam.inp").read_text()
        moved, stressed = run(tmp_path, f"{link}_1", on_springs(text))
        found, expected = [], []
        for element, ends, sizes in elements_of(text):
            found.append(means(stressed[element], *sizes))
            expected.append(of_law(solution, case, ends))
        found, expected = np.array(found), np.array(expected)
        for names, kind in ((FORCES, slice(0, 3)), (MOMENTS, slice(3, 6))):
            names = [x for x in (*names, "shear", "bending") if x in solution.table.forces]
            largest = max(abs(solution.peak(f"section:{link}:{name}").value) for name in names)
            assert np.abs(found - expected)[:, kind].max() < 1e-6 * largest
        largest = max(np.linalg.norm(load.force) for load in case.loads)
        for node, k in SUPPORTS:
            number = int(re.search(rf"NSET={node}\n(\d+)", text)[1])
            assert SPRING * abs(moved[number][k - 1]) < 1e-9 * largest


def of_law(solution, case, ends):
    """Section forces in the mean from one x to another, by the section law."""
    law, length = solution.section(case.link).law, solution.section(case.link).law.length
    nodes, weights = np.polynomial.legendre.leggauss(6)
    at = ((ends[0] + ends[1]) / 2 + (ends[1] - ends[0]) / 2 * nodes) / length
    space = "shear_y" in solution.table.forces
    names = (*FORCES, *MOMENTS) if space else PLANAR
    found, k = np.zeros(6), int(np.argmin(np.abs(solution.t - case.t)))
    for row, name in enumerate(names):
        if name:
            found[row] = law.at(name, np.tile(at, (solution.t.size, 1)))[k] @ weights / 2
    return found
