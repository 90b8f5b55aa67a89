"""Stresses about the axes that were declared: the spatial oracle's forces, resolved on these axes,
and a textbook's formulas.
"""

import dataclasses

import numpy as np
import pytest
from spatial_anyhow import anyhow
from spatial_bridge import BESIDE, declared, find_two_force_links, plain
from spatial_mechanisms import FAMILIES
from spatial_oracle import SECTION

from lagrange_casadi import beams, evaluate

pytestmark = pytest.mark.usefixtures("interpreted")

STEEL = beams.material("C45+QT")
DRAWS = FAMILIES | {"anyhow": anyhow}
RATIOS = (0.0, 0.25, 0.5, 0.75, 1.0)
QUICK = [("anyhow", 8), ("rssr", 0), ("rssp", 1), ("tree", 3)]
MANY = [("anyhow", 0), ("rsur", 1), ("suspension", 0), ("loop", 1)]
COUNTS = {"anyhow": 300, "suspension": 10, "arm": 10}
COUNTS |= dict.fromkeys(("tree", "loop", "rssr", "rsur", "rssp", "rsup"), 30)
MANY += [(name, 100 + k) for name, count in COUNTS.items() for k in range(count)]


class Section:
    """A cross-section in numbers of its own: area, second moments, and where its corners are."""

    def __init__(self, rng) -> None:
        self.height, self.width = rng.uniform(0.01, 0.04), rng.uniform(0.005, 0.03)
        self.area = self.height * self.width
        self.iz, self.iy = self.width * self.height**3 / 12, self.height * self.width**3 / 12
        self.is_rectangle = rng.random() < 0.6
        self.iyz = 0.0 if self.is_rectangle else rng.uniform(-0.6, 0.6) * np.sqrt(self.iz * self.iy)

    def shape(self):
        if self.is_rectangle:
            return beams.rectangle(self.height, self.width)
        sides = {"top": self.height / 2, "side": self.width / 2, "iyz": self.iyz}
        return beams.given(self.area, self.iz, self.iy, **sides, torsion=1e-9, torsion_modulus=1e-6)

    def normal(self, forces, y_sign, z_sign):
        """The normal stress at a corner: N/A + a y + b z, of which the moments about both axes are
        the bending moments.
        """
        n, _, _, _, about_y, about_z = forces
        a, b = np.linalg.solve([[self.iz, self.iyz], [self.iyz, self.iy]], [-about_z, about_y])
        return n / self.area + a * y_sign * self.height / 2 + b * z_sign * self.width / 2

    def corners(self, forces):
        words = {1: "+", -1: "-"}
        return {
            f"corner {words[i]}y {words[j]}z": self.normal(forces, i, j)
            for i in (1, -1)
            for j in (1, -1)
        }


def made(name, seed):
    """A drawn mechanism whose rods have cross-sections; of some all the mass
    is that of the beam.
    """
    drawn, rng = plain(DRAWS[name](seed)), np.random.default_rng([seed, 7])
    sections = {rod: Section(rng) for rod in drawn.rods}
    bodies = []
    for body in drawn.mechanism.bodies:
        if body.name in sections and not body.polar and rng.random() < 0.5:
            body = dataclasses.replace(body, density=(STEEL.density * sections[body.name].area,))
        bodies.append(body)
    return dataclasses.replace(
        drawn, mechanism=dataclasses.replace(drawn.mechanism, bodies=bodies)
    ), sections


def declared_axes(drawn, rod, pose):
    """The axes of a rod as columns: of a bar y is the part across it of the direction beside, which
    the ground carries.
    """
    R = np.asarray(pose.R, float)
    if rod not in find_two_force_links(drawn):
        return R
    x, beside = R[:, 0], np.asarray(drawn.guess[rod][1], float) @ BESIDE
    y = beside - x * (x @ beside)
    y /= np.linalg.norm(y)
    return np.column_stack([x, y, np.cross(x, y)])


def compare(name, seed, instants):
    """The rods whose stresses were compared."""
    drawn, sections = made(name, seed)
    scene = declared(
        drawn, beams={rod: beams.Beam(section.shape(), STEEL) for rod, section in sections.items()}
    )
    solution = evaluate(scene, xi=(0, 1, 5))
    assert solution.certified
    assert {*solution.description.bars} == find_two_force_links(drawn)
    compared = set()
    for k in instants:
        true = drawn.solve(float(solution.t[k]))
        reactions = [np.abs(np.asarray(x, float)) for x in true.reactions.values()]
        force = max(1.0, *(x[:3].max() for x in reactions))
        moment = max(1.0, *(x[3:].max() for x in reactions), force * true.size)
        for rod, section in sections.items():
            if any(not solution.determined(f"section:{rod}:{member}") for member in SECTION):
                continue
            axes = declared_axes(drawn, rod, true.poses[rod])
            assert np.abs(solution.pose(rod).axes[k] - axes.T).max() < 1e-11, rod
            stress, law = solution.stress(rod), solution.section(rod)
            size = force / section.area + moment * np.hypot(
                section.height, section.width
            ) / 2 / min(np.linalg.eigvalsh([[section.iz, section.iyz], [section.iyz, section.iy]]))
            for i, xi in enumerate(RATIOS):
                own = true.sections[rod].at(xi).astype(float).reshape(2, 3)
                forces = (own @ np.asarray(true.poses[rod].R, float).T @ axes).ravel()
                told = np.array([getattr(law, member)[k, i] for member in SECTION])
                assert np.all(
                    np.abs(told - forces) < 1e-12 * np.array([force] * 3 + [moment] * 3)
                ), (rod, xi)
                values = dict(zip(stress.fibres(xi), stress.at(xi)[:, :, k].T, strict=True))
                for corner, value in section.corners(forces).items():
                    assert abs(values[corner][0] - value) < 1e-12 * size, (rod, xi, corner)
                if section.is_rectangle:
                    middle = [forces[0] / section.area, *(1.5 * forces[1:3] / section.area)]
                    assert np.abs(values["centre"] - middle).max() < 1e-12 * size, (rod, xi)
            compared.add(rod)
    return compared, find_two_force_links(drawn)


@pytest.mark.parametrize("case", QUICK, ids=lambda case: "-".join(map(str, case)))
def test_stresses_are_about_declared_axes(case):
    compare(*case, (4,))


@pytest.mark.long
@pytest.mark.parametrize("case", MANY, ids=lambda case: "-".join(map(str, case)))
def test_stresses_are_about_declared_axes_of_many(case):
    compare(*case, (1, 8))
