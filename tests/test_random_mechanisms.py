"""Random mechanisms of any pattern that can be declared: right by the oracle, or refused in words;
never else.

Each seed is a mechanism of its own. One that fails is printed as Python to paste, with what is
wrong; ``random_verdict`` says what right means.
"""

import functools
from dataclasses import replace

import numpy as np
import pytest
from internals import Output
from random_comparison import CONDEMNED, WITHHELD
from random_mechanisms import draw
from random_verdict import compare, is_regular, judge

from lagrange_casadi import evaluate

QUICK, LONG = range(10), range(10, 1000)
REFUSED = 0.02
"""How many of the regular mechanisms may be refused."""


@functools.cache
def verdict(seed):
    """By the default backend for every fourth mechanism, else without a compiler."""
    drawn = draw(seed)
    found = judge(drawn, **({"backend": "vm"} if seed % 4 else {}))
    told = (
        ""
        if found.kind in ("right", "refused")
        else "\n".join([drawn.describe(), *found.details[:20]])
    )
    return found, told


@pytest.mark.sampled(7)
@pytest.mark.parametrize("seed", QUICK)
def test_right_or_refused(seed):
    found, told = verdict(seed)
    assert found.kind in ("right", "refused"), f"{found.kind}: {found.why}\n{told}"


@pytest.mark.long
@pytest.mark.parametrize("seed", LONG)
def test_right_or_refused_of_many(seed):
    found, told = verdict(seed)
    assert found.kind in ("right", "refused"), f"{found.kind}: {found.why}\n{told}"


def few_are_refused(seeds):
    found = [verdict(seed)[0] for seed in seeds]
    refused = [f"{v.seed}: {v.why}" for v in found if v.kind == "refused" and v.regular]
    assert len(refused) <= REFUSED * sum(v.regular for v in found), "\n".join(refused)


@pytest.mark.long
def test_few_regular_mechanisms_are_refused():
    few_are_refused(QUICK)


@pytest.mark.long
def test_few_regular_mechanisms_of_many_are_refused():
    few_are_refused([*QUICK, *LONG])


def doubts(seeds, what):
    """What is said of right results, by seed."""
    found = [verdict(seed)[0] for seed in seeds]
    return {
        v.seed: notes
        for v in found
        if v.kind == "right" and (notes := [note for note in v.notes if what in note])
    }


def all_are_certified(seeds):
    condemned = doubts(seeds, CONDEMNED)
    assert not condemned, "\n".join(
        f"{seed}: {'; '.join(notes)}" for seed, notes in condemned.items()
    )


def test_right_results_are_certified():
    all_are_certified(QUICK)


@pytest.mark.long
def test_many_right_results_are_certified():
    all_are_certified([*QUICK, *LONG])


def nothing_unique_is_withheld(seeds):
    withheld = doubts(seeds, WITHHELD)
    assert not withheld, "\n".join(
        f"{seed}: {'; '.join(notes)}" for seed, notes in withheld.items()
    )


def test_nothing_that_is_unique_is_withheld():
    nothing_unique_is_withheld(QUICK)


@pytest.mark.long
def test_nothing_of_many_that_is_unique_is_withheld():
    nothing_unique_is_withheld([*QUICK, *LONG])


REGULAR, ITERATED = [3, 4, 6, 7], [1, 5, 12, 21]


@pytest.mark.sampled(9)
@pytest.mark.parametrize("seed", REGULAR)
@pytest.mark.parametrize("backend", ["lanes", "c"])
def test_every_backend_is_right(seed, backend):
    found = judge(draw(seed), backend=backend)
    assert found.kind == "right", found.details


@pytest.mark.sampled(5)
@pytest.mark.parametrize("seed", ITERATED)
def test_counted_steps_are_as_right_as_they_claim(seed):
    found = judge(draw(seed), newton=3, claims=10.0)
    assert found.kind == "right", found.details


@pytest.mark.sampled(9)
@pytest.mark.parametrize("seed", REGULAR)
def test_single_precision_is_as_right_as_it_claims(seed):
    found = judge(draw(seed), precision="single", tolerance=1e-4, claims=10.0)
    assert found.kind == "right", found.details


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
