"""Random mechanisms whose links are made of something: deflections by sums over fine grids, and the
least of strain energies.
"""

import dataclasses
import functools
import itertools

import numpy as np
import pytest
from elastic_mechanisms import work
from random_mechanisms import draw
from spatial_bridge import declared, plain
from spatial_mechanisms import FAMILIES

from lagrange_casadi import Mechanism, SpatialMechanism, beams, evaluate
from lagrange_casadi.errors import DeclarationError

pytestmark = pytest.mark.usefixtures("interpreted")

STEEL = beams.material("S235")
E, G = STEEL.elasticity, STEEL.shear_modulus
SHAPES = [
    beams.rectangle(0.05, 0.02),
    beams.c_section(0.05, 0.03, 0.004, 0.004),
    beams.tapered(beams.rectangle(0.05, 0.02), beams.rectangle(0.02, 0.03)),
    beams.stepped([0.4], [beams.round_bar(0.03), beams.round_bar(0.02)]),
]
PIECES = 20_000


@pytest.fixture
def made(monkeypatch):
    """Whatever is declared as a link of any density is a beam, of one shape after another."""
    shapes = itertools.cycle(SHAPES)

    def with_beam(link, self, *args, **given):
        return link(
            self,
            *args,
            **given if "centre" in given else {"beam": beams.Beam(next(shapes), STEEL), **given},
        )

    for kind in (Mechanism, SpatialMechanism):
        monkeypatch.setattr(
            kind, "link", functools.partialmethod(functools.partial(with_beam, kind.link))
        )


def planar(seed):
    drawn = draw(seed)
    start, stop, count = drawn.grid
    given = {"parameters": drawn.keywords["parameters"]} if "parameters" in drawn.keywords else {}
    return drawn.scene(), {"t": (start, stop, min(count, 5)), **given}


def spatial(family, seed):
    return declared(plain(FAMILIES[family](seed))), {"t": (0.0, 0.05, 3)}


def summed(found):
    """The largest size of a deflection at every instant, by midpoint sums."""
    member, u = found.member, (np.arange(PIECES) + 0.5) / PIECES
    f = dict(
        zip(member.forces, member.at(np.broadcast_to(u, (member.t.size, PIECES))), strict=True)
    )
    cells = np.searchsorted(member.beam.course.breaks[1:-1], u, side="right")
    p = {
        name: np.empty(PIECES)
        for name in ("iy", "iz", "iyz", "shear_y", "shear_z", "torsion", "centre_y", "centre_z")
    }
    for cell in np.unique(cells):
        for name, values in p.items():
            values[cells == cell] = getattr(
                member.cross.properties(int(cell), u[cells == cell]), name
            )

    def across(curvature, shear):
        piece = member.law.length / PIECES
        turn = np.cumsum(curvature, axis=1) * piece - curvature * piece / 2
        y = np.cumsum(turn + shear, axis=1) * piece
        return y - (u + 0.5 / PIECES) * y[:, -1:] if found.against == "ends" else y

    whole = E * (p["iy"] * p["iz"] - p["iyz"] ** 2)
    if not member.space:
        return np.abs(across(f["bending"] * p["iy"] / whole, f["shear"] / (G * p["shear_y"]))).max(
            axis=1
        )
    twist = (f["torsion"] + p["centre_z"] * f["shear_y"] - p["centre_y"] * f["shear_z"]) / (
        G * p["torsion"]
    )
    about_z = (p["iyz"] * f["bending_y"] + p["iy"] * f["bending_z"]) / whole
    about_y = (p["iz"] * f["bending_y"] + p["iyz"] * f["bending_z"]) / whole
    y = across(about_z, f["shear_y"] / (G * p["shear_y"]) + p["centre_z"] * twist)
    return np.hypot(
        y, across(-about_y, f["shear_z"] / (G * p["shear_z"]) - p["centre_y"] * twist)
    ).max(axis=1)


def bends_as_it_should(scene, given):
    links = [name for name, link in scene.mechanism.links.items() if link.beam is not None]
    solution = evaluate(scene, wanted=["deflection"], certificate=False, xi=(0, 1, 3), **given)
    for link in links:
        if not solution.determined(
            f"section:{link}:bending" if not scene.mechanism.space else f"section:{link}:bending_z"
        ):
            continue
        try:
            found = solution.deflection(link)
        except DeclarationError:  # of open shear or axial force
            continue
        exact = np.abs(found.largest()[0])
        size = exact.max()
        if size > 1e-15:
            # At a couple within the link midpoints miss half a piece.
            assert summed(found) == pytest.approx(exact, abs=2e-3 * size), link
            assert solution.array(f"deflection:{link}:across") == pytest.approx(
                exact, abs=1e-5 * size
            ), link


def least(scene, given):
    """The energy is the least: forces that are those of other stiffnesses differ by what its
    strains do no work on.
    """
    scene = dataclasses.replace(scene, elastic=True)
    solution = evaluate(scene, wanted=["all"], **given)
    assert solution.certified
    assert not solution.undetermined
    links = [name for name, link in scene.mechanism.links.items() if link.beam is not None]
    others = [
        evaluate(dataclasses.replace(scene, elastic=[link]), wanted=["all"], **given)
        for link in links
    ]
    told = [other for other in others if other.certified and not other.undetermined]
    energy, _ = work(solution, solution, links)
    for other in told:
        between, size = work(other, solution, links)
        np.testing.assert_allclose(between, energy, atol=1e-9 * max(size.max(), energy.max()))
    return len(solution.elasticity.completed), len(told)


@pytest.mark.long
@pytest.mark.parametrize("seed", [2, 3, 50, 82, 97, 102])
def test_random_mechanisms(made, seed):
    bends_as_it_should(*planar(seed))
    if seed != 3:  # of which equilibrium determines all
        assert all(least(*planar(seed)))


@pytest.mark.long
@pytest.mark.parametrize("family", ["planar_four_bar", "bennett", "bricard"])
def test_random_loops_in_space(made, family):
    assert all(least(*spatial(family, 0)))
