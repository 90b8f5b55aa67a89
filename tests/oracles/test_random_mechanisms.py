"""Random mechanisms of any pattern that can be declared: right by the oracle, refused in words;
never else.

Each seed is a mechanism of its own, of any kind or of one that is asked for. One that fails is
printed as Python to paste, with what is wrong; ``random_verdict`` says what right means: efforts,
reactions, section forces, peaks between instants, certificates and stated errors.
"""

import contextlib
import functools

import pytest
from random_comparison import CONDEMNED, WITHHELD
from random_exported import by_exported_c
from random_mechanisms import KINDS, draw
from random_verdict import compare, judge, peaks_off

from lagrange_casadi import derive, evaluate
from lagrange_casadi.errors import LagrangeCasadiError
from lagrange_casadi.peaks import forces

COUNT, LONG, QUICK = 10, 100, 2
"""Mechanisms of each kind by default, with ``--long``, and for whoever is editing."""

ANY, LONG_ANY, AT_ONCE = [*range(20), 700042], range(20, 1000), 10
"""Seeds of mechanisms of any kind, of which the first are for whoever is editing; of the last one
gears rest while drives move.
"""

FIRST = {"one_way": 1000}
"""The first seed of a kind, 0 for others."""

DENSE = 2001
REFUSED = 0.02
"""How many of the regular mechanisms may be refused."""

CLOSED = ("bushes", "plate", "bent", "cam", "cylinder", "damper", "torsion", "oldham")
"""Kinds whose first mechanisms are of dyads alone, which have closed forms, told in any order."""

SMALL = 6
"""Bodies of a mechanism whose peaks are looked at."""

TOGETHER = 6
"""Mechanisms in one exported program."""


def cases():
    """Kinds and seeds: parameters of a test."""
    found = [("", k, k < AT_ONCE, k in LONG_ANY) for k in (*ANY, *LONG_ANY)]
    for kind in KINDS:
        for k in range(LONG):
            found.append((kind, FIRST.get(kind, 0) + k, k < QUICK, k >= COUNT))
    for kind, seed, quick, long in found:
        marks = [pytest.mark.quick] * quick + [pytest.mark.long] * long
        yield pytest.param(kind, seed, marks=marks, id=f"{kind or 'any'}-{seed}")


@functools.lru_cache(maxsize=4)
def verdict(seed, kind=""):
    """With peaks of every other one, where these take little time."""
    drawn = draw(seed, kind)
    few = kind != "one_way" and len(drawn.draft.bodies) <= SMALL
    return judge(drawn, backend="vm", peaks=few and seed % 2 == 0)


@pytest.mark.parametrize(("kind", "seed"), cases())
def test_right_and_certified_or_refused(kind, seed):
    """And nothing that is unique is withheld."""
    found = verdict(seed, kind)
    told = "\n".join([draw(seed, kind).describe(), *found.details[:20]])
    refused = found.kind == "refused" and not (kind and found.regular)
    assert found.kind == "right" or refused, f"{found.kind}: {found.why}\n{told}"
    if kind in CLOSED and seed < 5:
        assert derive(draw(seed, kind).scene()).newton is None
    doubts = [note for note in found.notes if CONDEMNED in note or WITHHELD in note]
    assert not doubts, "; ".join(doubts)


def in_c():
    """One of every other kind, and two of any, several in one program."""
    every = [("", seed) for seed in ANY[5::10]]
    every += [(kind, FIRST.get(kind, 0) + 4) for kind in [*KINDS][::2]]
    return [every[k : k + TOGETHER] for k in range(0, len(every), TOGETHER)]


@pytest.mark.parametrize("several", in_c(), ids=lambda many: "-".join(k or "any" for k, _ in many))
def test_exported_c_has_the_same(several, tmp_path):
    many = []
    for kind, seed in several:
        drawn = draw(seed, kind)
        given = {**drawn.keywords, "backend": "vm", "certificate": False}
        scene, moves = drawn.scene(), drawn.draft.laws or drawn.draft.guides
        with contextlib.suppress(LagrangeCasadiError):
            if moves and "wanted" not in given:
                many.append((drawn, scene, evaluate(scene, **given)))
    assert len(many) >= len(several) / 2
    for drawn, solution, off in by_exported_c(many, tmp_path):
        found = compare(drawn, solution)
        told = "\n".join([drawn.describe(), *found.details[:20]])
        assert found.kind == "right", f"{found.why}\n{told}"
        assert off < 1e-13, drawn.describe()


@pytest.mark.sampled(2)
@pytest.mark.parametrize("seed", range(1000, 1020, 2))
def test_peaks_of_one_way_forces_are_those_of_many_instants(seed):
    drawn = draw(seed, "one_way")
    if verdict(seed, "one_way").kind != "right" or drawn.grid[2] < 2 or "wanted" in drawn.keywords:
        pytest.skip("it is refused, at one instant, or tells some quantities alone")
    scene, (start, stop, count) = drawn.scene(), drawn.grid
    given = {"parameters": drawn.keywords.get("parameters"), "backend": "vm", "certificate": False}
    solution, dense = (evaluate(scene, t=(start, stop, n), **given) for n in (count, DENSE))
    off = peaks_off(scene, solution, dense, forces(solution))
    assert not off, "\n".join([*off, drawn.describe()])


@pytest.mark.long
@pytest.mark.parametrize("seeds", [ANY, [*ANY, *LONG_ANY]], ids=["few", "many"])
def test_few_regular_mechanisms_are_refused(seeds):
    found = [verdict(seed) for seed in seeds]
    refused = [f"{v.seed}: {v.why}" for v in found if v.kind == "refused" and v.regular]
    assert len(refused) <= REFUSED * sum(v.regular for v in found), "\n".join(refused)
