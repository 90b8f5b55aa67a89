"""Random mechanisms whose links are made of something: the least of strain energies."""

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

pytestmark = pytest.mark.usefixtures("interpreted")

STEEL = beams.material("S235")
SHAPES = [
    beams.rectangle(0.05, 0.02),
    beams.c_section(0.05, 0.03, 0.004, 0.004),
    beams.tapered(beams.rectangle(0.05, 0.02), beams.rectangle(0.02, 0.03)),
    beams.stepped([0.4], [beams.round_bar(0.03), beams.round_bar(0.02)]),
]


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
        beams_of = functools.partialmethod(functools.partial(with_beam, kind.link))
        monkeypatch.setattr(kind, "link", beams_of)


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


@pytest.mark.parametrize(
    "seed", [2, *(pytest.param(seed, marks=pytest.mark.long) for seed in (50, 82, 97, 102))]
)
def test_random_mechanisms(made, seed):
    drawn = draw(seed)
    start, stop, count = drawn.grid
    given = {"parameters": drawn.keywords.get("parameters"), "t": (start, stop, min(count, 5))}
    assert all(least(drawn.scene(), given))


@pytest.mark.long
def test_a_loop_in_space(made):
    assert all(least(declared(plain(FAMILIES["bennett"](0))), {"t": (0, 0.05, 3)}))
