"""Random mechanisms of any pattern that can be declared: right by the oracle, or refused in words;
never else.

Each seed is a mechanism of its own. One that fails is printed as Python to paste, with what is
wrong; ``random_verdict`` says what right means.
"""

import functools
from dataclasses import replace

import numpy as np
import pytest
from internals import Output, forces
from random_comparison import CONDEMNED, WITHHELD
from random_mechanisms import draw
from random_verdict import compare, is_regular, judge, peaks_off

from lagrange_casadi import evaluate

QUICK, LONG = [*range(130), 700042], range(130, 1000)
"""Seeds; of the last of the quick ones gears rest while drives move."""

SWITCHED, LONG_SWITCHED = range(1000, 1024), range(1024, 1500)
"""Seeds of mechanisms that have one-way forces too."""

AT_ONCE = 40
"""So many of the seeds are for whoever is editing."""

DENSE = 2001
REFUSED = 0.02
"""How many of the regular mechanisms may be refused."""

REGULAR = [3, 4, 6, 7]


@functools.cache
def verdict(seed, switched=False):
    """By compiled code for every tenth mechanism, else without a compiler."""
    backend = "vm" if seed % 10 else ("lanes", "c")[seed // 10 % 2]
    return judge(draw(seed, switched), backend=backend)


def seeds(usual, long):
    """Parameters of a test: the first of the usual ones are quick."""
    return [
        *(pytest.param(seed, marks=pytest.mark.quick) for seed in usual[:AT_ONCE]),
        *usual[AT_ONCE:],
        *(pytest.param(seed, marks=pytest.mark.long) for seed in long),
    ]


@pytest.mark.parametrize("seed", seeds(QUICK, LONG))
def test_right_and_certified_or_refused(seed):
    """And nothing that is unique is withheld."""
    holds(seed, switched=False)


@pytest.mark.parametrize("seed", seeds(SWITCHED, LONG_SWITCHED))
def test_right_under_one_way_forces(seed):
    holds(seed, switched=True)


def holds(seed, switched):
    found = verdict(seed, switched)
    told = "\n".join([draw(seed, switched).describe(), *found.details[:20]])
    assert found.kind in ("right", "refused"), f"{found.kind}: {found.why}\n{told}"
    doubts = [note for note in found.notes if CONDEMNED in note or WITHHELD in note]
    assert not doubts, "; ".join(doubts)


@pytest.mark.parametrize("seed", SWITCHED[::2])
def test_peaks_are_those_of_many_instants(seed):
    drawn = draw(seed, True)
    if verdict(seed, True).kind != "right" or drawn.grid[2] < 2 or "wanted" in drawn.keywords:
        pytest.skip("it is refused, at one instant, or tells some quantities alone")
    scene, (start, stop, count) = drawn.scene(), drawn.grid
    given = {"parameters": drawn.keywords.get("parameters"), "backend": "vm", "certificate": False}
    solution, dense = (evaluate(scene, t=(start, stop, n), **given) for n in (count, DENSE))
    off = peaks_off(scene, solution, dense, forces(solution))
    assert not off, "\n".join([*off, drawn.describe()])


@pytest.mark.long
@pytest.mark.parametrize("seeds", [QUICK, [*QUICK, *LONG]], ids=["few", "many"])
def test_few_regular_mechanisms_are_refused(seeds):
    found = [verdict(seed) for seed in seeds]
    refused = [f"{v.seed}: {v.why}" for v in found if v.kind == "refused" and v.regular]
    assert len(refused) <= REFUSED * sum(v.regular for v in found), "\n".join(refused)


def test_a_seed_is_a_mechanism():
    one, two = draw(11), draw.__wrapped__(11)
    assert one is not two
    assert one.describe() == two.describe()
    assert draw(12).describe() != one.describe()


def test_what_is_printed_runs():
    drawn = draw(REGULAR[0])
    space = {}
    exec(drawn.describe(), space)
    solution = evaluate(drawn.scene(), **drawn.keywords)
    assert set(solution.series) == set(space["solution"].series)
    for name, values in solution.series.items():
        np.testing.assert_array_equal(space["solution"].series[name], values, name)


@pytest.fixture(scope="module")
def right():
    whole = (
        d
        for d in map(draw, REGULAR)
        if d.draft.limited and "wanted" not in d.keywords and is_regular(d)
    )
    drawn = min(whole, key=lambda d: len(d.draft.bodies))
    solution = evaluate(drawn.scene(), **drawn.keywords, backend="vm", certificate=False)
    assert compare(drawn, solution).kind == "right"
    return drawn, solution


@pytest.mark.sampled(2)
def test_a_small_fault_in_any_quantity_is_found(right):
    """A millionth of what is largest of its kind, in every third quantity."""
    drawn, solution = right
    seen = 0
    for name, values in list(solution.series.items())[::3]:
        kinds = {
            n: np.max(np.abs(v))
            for n, v in solution.series.items()
            if n.split(":")[0] == name.split(":")[0]
        }
        if name.startswith("load:") or name.endswith(":station") or not max(kinds.values()):
            continue
        if (
            name.startswith("section:")
            and name[-1] in "12"
            and drawn.draft.bodies[name.split(":")[1]].mass < 0.05
        ):
            continue  # what these are multiplied by is the link's mass
        if np.min(solution.series.get(f"{name.rpartition(':')[0]}:station", 1.0)) <= 0.0:
            continue  # no section of the link sees it
        off = {Output.of(name): values + 1e-6 * max(kinds.values())}
        found = compare(drawn, replace(solution, outputs={**solution.outputs, **off}))
        assert found.kind == "wrong", name
        seen += 1
    assert seen > 5


def test_what_is_not_finite_is_found(right):
    drawn, solution = right
    name = next(name for name in solution.series if name.startswith("reaction:"))
    nothing = {Output.of(name): np.full_like(solution.t, np.nan)}
    assert (
        compare(drawn, replace(solution, outputs={**solution.outputs, **nothing})).kind == "wrong"
    )


def test_another_motion_is_found(right):
    drawn, solution = right
    late = {
        output: np.roll(values, 1) if solution.t.size > 2 else values[::-1]
        for output, values in solution.outputs.items()
    }
    assert compare(drawn, replace(solution, outputs=late)).kind == "wrong"
