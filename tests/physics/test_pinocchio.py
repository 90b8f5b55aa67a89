"""Open chains against Pinocchio, where it is installed: efforts, and the six section forces of
links that it has in two pieces. Pinocchio's recursion shares nothing with the package. The
numbers at the end are its own (4.1.0), and need it no more.
"""

from __future__ import annotations

import numpy as np
import pytest

from lagrange_casadi import Scene, SpatialMechanism, evaluate, load_case, motion

RATIOS = (0.2, 0.5, 0.85)

FORCES = ("axial", "shear_y", "shear_z", "torsion", "bending_y", "bending_z")


def turned_at_random(random):
    q, _ = np.linalg.qr(random.normal(size=(3, 3)))
    return q * np.linalg.det(q)


def drawn(seed):
    """A chain of slender and rigid links on joints that turn or slide along any axis; and as pieces
    for Pinocchio.

    What slides on a slender link loads it where it is, which Pinocchio's pieces do not: rigid links
    alone carry slides.
    """
    random = np.random.default_rng(seed)
    m, near, laws, pieces, reach = SpatialMechanism("chain"), None, {}, [], 0.0
    matter = {}
    m.set_gravity(*(gravity := random.normal(size=3) * 6.0))
    for k in range(int(random.integers(2, 8))):
        length = random.uniform(0.1, 0.8)
        mass = random.uniform(0.2, 4.0)
        slender = random.random() < 0.7
        slides = random.random() < 0.5 and (not pieces or bool(matter))
        axis, turned = random.normal(size=3), turned_at_random(random)
        axis, matter = axis / np.linalg.norm(axis), {}
        if not slender:
            spread = turned_at_random(random) @ np.diag(random.uniform(0.01, 0.1, 3)) @ np.eye(3)
            spread = spread @ spread.T
            matter = {
                "centre": random.normal(size=3) * 0.1,
                "inertia": np.trace(spread) * np.eye(3) - spread,
            }
        told = {
            name: tuple(map(tuple, value)) if value.ndim == 2 else tuple(value)
            for name, value in matter.items()
        }
        link = m.link(f"link{k}", length=length, mass=mass, **told)
        joint = m.prismatic if slides else m.revolute
        directions = (tuple(turned[:, 0]), tuple(turned[:, 1]))
        joint(
            f"joint{k}",
            m.ground if near is None else near.tip,
            link,
            axis=tuple(axis),
            turned=directions,
        )
        laws[f"joint{k}"] = motion.harmonic(
            random.normal(), random.normal() * 0.5, random.uniform(0.2, 1.0), random.normal()
        )
        cuts = () if matter else RATIOS
        pieces.append(
            (
                axis,
                turned,
                (reach, 0.0, 0.0),
                mass,
                length,
                slides,
                matter.get("centre"),
                matter.get("inertia"),
                cuts,
            )
        )
        near, reach = link, length
    return Scene(m, laws, t=(0.0, 1.0, 7)), pieces, gravity


def arm6():
    """The case, and its links as pieces: a chain of six revolute joints and a tool."""
    scene = load_case("arm6").scene
    lengths, masses = (0.16, 0.42, 0.39, 0.12, 0.1, 0.08), (3.7, 8.4, 2.3, 1.2, 1.2, 0.2)
    x, z, upright = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0), np.array([[0.0, 0, -1], [0, 1, 0], [1, 0, 0]])
    reach, pieces = (0.0, *lengths), []
    for k, (axis, turned) in enumerate(
        zip((z, z, z, x, z, x), (upright, *[np.eye(3)] * 5), strict=True)
    ):
        pieces.append(
            (axis, turned, (reach[k], 0.0, 0.0), masses[k], lengths[k], False, None, None, RATIOS)
        )
    tool = (np.array([0.05, 0.01, 0.0]), np.diag([0.01, 0.02, 0.02]))
    pieces.append((None, np.eye(3), (lengths[-1], 0.0, 0.0), 5.0, 0.1, False, *tool, ()))
    return scene, pieces, (0.0, 0.0, -9.81)


def assert_same(scene, pieces, gravity, first=0):
    """Efforts and sections, to 1e-12 of the largest of all; links are numbered from ``first``."""
    solution, names = evaluate(scene), list(scene.motion)
    chain = peer().Chain([peer().Piece(*piece) for piece in pieces], gravity)
    q, v, a = (
        np.array([getattr(solution.motion(name), kind) for name in names])
        for kind in ("value", "rate", "acceleration")
    )
    found = chain.work(q, v, a)()
    size = np.abs(found).max()
    assert (
        np.abs(np.array([solution.effort(name) for name in names]) - found[chain.efforts]).max()
        <= 1e-12 * size
    )
    for (k, ratio), forces in chain.sections(found).items():
        law = solution.section(f"link{k + first}").law
        own = np.array([law.at(force, np.full((q.shape[1], 1), ratio))[:, 0] for force in FORCES])
        assert np.abs(own - forces).max() <= 1e-12 * size, (k, ratio)


def peer():
    return pytest.importorskip(
        "benchmarks.peers.pinocchio_arm",
        reason="Pinocchio is not installed: pip install '.[bench]'",
    )


@pytest.mark.sampled(13)
@pytest.mark.parametrize("seed", range(12))
def test_random_chains(seed):
    assert_same(*drawn(seed))


def test_an_arm_by_stored_numbers():
    """What Pinocchio 4.1.0 gave for the case at t = 0.7 s: efforts, then link 2 at half its
    length.
    """
    scene = load_case("arm6").scene
    solution = evaluate(scene, t=(0.7, 0.7, 1))
    law, half = solution.section("link2").law, np.array([[0.5]])
    found = [solution.effort(name)[0] for name in scene.motion]
    found += [law.at(force, half)[0, 0] for force in FORCES]
    assert found == pytest.approx(STORED, abs=1e-12 * np.abs(STORED).max())


STORED = (
    -13.366571991228078,
    -81.8860337066446,
    -35.95540567458077,
    0.5185214952163023,
    -5.1743306998229075,
    -0.0006327755976294354,
    -43.15448736579151,
    109.5231675289179,
    18.896270642899925,
    5.9552533950632105,
    -11.7118547489456,
    56.52568637869752,
)
