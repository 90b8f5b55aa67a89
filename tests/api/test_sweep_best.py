"""The best designs, against a search of all of them at once."""

import itertools

import numpy as np
import pytest
import sweeps
from hypothesis import given
from hypothesis import strategies as st
from internals import Condition, _front, best, chosen, counts, missed, reading, sweep

from lagrange_casadi.errors import DeclarationError, UnknownNameError

pytestmark = pytest.mark.quick

BENDING, EFFORT = "peak:section:rod:bending", "peak:effort:O"


@pytest.fixture
def swept(monkeypatch, tmp_path):
    sweeps.use(monkeypatch)
    monkeypatch.setattr(reading, "_BLOCK", 7)
    return sweep(sweeps.scene(), {"l": (0.15, 0.4, 20), "r": (0.05, 0.1, 6)}, out=tmp_path / "x.h5")


def test_the_best_is_the_least_in_size(swept):
    sizes = np.abs(swept[BENDING]).ravel()
    order = np.argsort(np.where(np.isnan(sizes), np.inf, sizes), kind="stable")
    found = best(swept, minimise=[BENDING], count=5, columns=["rms:effort:O"])
    assert [design.number for design in found] == order[:5].tolist()
    first = found[0]
    assert first.values["l"] == swept["l"][first.number // 6]
    assert first.values["r"] == swept["r"][first.number % 6]
    assert first.values[BENDING] == swept[BENDING].ravel()[first.number]
    assert list(first.values) == ["l", "r", BENDING, "rms:effort:O"]
    (most,) = best(swept, maximise=[BENDING])
    assert most.number == int(np.nanargmax(sizes))


def test_what_has_no_result_is_never_best(swept):
    failed = np.flatnonzero(swept["status"].ravel())
    assert failed.size
    for objectives in (
        {"minimise": ["l"]},
        {"maximise": ["r"]},
        {"minimise": ["l"], "maximise": ["r"]},
    ):
        found = best(swept, **objectives, count=1000)
        assert not {design.number for design in found} & set(failed.tolist())


def test_conditions_hold(swept):
    found = best(
        swept, minimise=[BENDING], where=["l < 0.3", "r>=0.06", f"{EFFORT}<=0.5"], count=1000
    )
    sizes, efforts = (np.abs(swept[name]) for name in (BENDING, EFFORT))
    there = (swept["l"][:, None] < 0.3) & (swept["r"] >= 0.06) & (efforts <= 0.5) & ~np.isnan(sizes)
    assert {design.number for design in found} == set(np.flatnonzero(there))
    assert best(swept, minimise=[BENDING], where=["l<0.1"]) == []


def test_one_name_may_stand_alone(swept):
    assert best(swept, minimise=BENDING, columns=EFFORT) == best(
        swept, minimise=[BENDING], columns=[EFFORT]
    )
    assert best(swept, maximise=BENDING, where="l<0.3") == best(
        swept, maximise=[BENDING], where=["l<0.3"]
    )
    condition = Condition("l", "<", 0.3)
    assert best(swept, maximise=BENDING, where=condition) == best(
        swept, maximise=[BENDING], where=[condition]
    )
    assert (
        sum(numbers.size for numbers, _ in chosen(swept, "l", "l<0.3"))
        == 6 * (swept["l"] < 0.3).sum()
    )


def test_values_that_never_are_are_told_with_the_nearest(swept):
    wanted = ["l==0.151", "r=0.05", f"{EFFORT}==3", "l<0"]
    assert missed(swept, wanted) == "; no design has l = 0.151; nearest: 0.15, 0.1631578947"
    assert (
        missed(swept, ["l=1", "r==0"])
        == "; no design has l = 1; nearest: 0.4, 0.3868421053; no design has r = 0; nearest: 0.05,"
        " 0.06"
    )


def test_how_many_meet_conditions(swept):
    there = (swept["l"] < 0.3).repeat(6)
    assert counts(swept) == (120, (swept["status"] == 0).sum())
    assert counts(swept, "l<0.3") == (there.sum(), (there & (swept["status"].ravel() == 0)).sum())


def test_a_status_is_a_whole_number(swept):
    (design,) = best(swept, minimise=BENDING, columns=["status"])
    assert type(design.values["status"]) is int


def test_the_front_of_two(swept):
    front = [design.number for design in best(swept, minimise=[BENDING, EFFORT])]
    pairs = np.stack([np.abs(swept[name]).ravel() for name in (BENDING, EFFORT)], axis=1)
    there = np.flatnonzero(~np.isnan(pairs).any(axis=1))
    expected = [
        i for i in there if not any((pairs[j] <= pairs[i]).all() and (pairs[j] < pairs[i]).any() for j in there)  # noqa: E501
    ]  # fmt: skip
    assert sorted(front) == expected
    assert (np.diff(pairs[front, 0]) > 0).all()


@given(st.lists(st.tuples(st.integers(0, 6), st.integers(0, 6)), max_size=30))
def test_a_front_is_what_nothing_beats(pairs):
    costs = np.array(pairs, float).reshape(-1, 2).T
    found = {pairs[i] for i in _front(costs)}
    beaten = {
        p for p, q in itertools.product(pairs, pairs) if q[0] <= p[0] and q[1] <= p[1] and q != p
    }
    assert found == set(pairs) - beaten
    assert len(_front(costs)) == len(found)


@pytest.mark.parametrize(
    ("relation", "expected"),
    [
        ("<", [1]),
        ("<=", [1, 2]),
        (">", [3]),
        (">=", [2, 3]),
        ("==", [2]),
        ("=", [2]),
        ("!=", [1, 3]),
    ],
)
def test_relations(relation, expected):
    values = np.array([1.0, 2.0, 3.0, np.nan])
    assert values[Condition.parse(f"l {relation} 2").holds(values)].tolist() == expected


def test_peaks_are_compared_by_size():
    assert Condition.parse("peak:effort:O>2").holds(np.array([-3.0, 1.0])).tolist() == [True, False]
    assert Condition.parse("mean:effort:O>2").holds(np.array([-3.0, 1.0])).tolist() == [
        False,
        False,
    ]


def test_what_a_grid_rounds_is_what_was_meant():
    values = np.array([0.1, 0.2, 0.30000000000000004, 0.4])
    assert values[2] > 0.3
    assert Condition.parse("l<=0.3").holds(values).tolist() == [True, True, True, False]
    assert Condition.parse("l<0.3").holds(values).tolist() == [True, True, False, False]
    assert Condition.parse("l<inf").holds(values).all()
    assert not Condition.parse("l>=inf").holds(values).any()
    assert Condition.parse("l==0.3").holds(values).tolist() == [False, False, True, False]


@pytest.mark.parametrize("text", ["l", "l<", "<3", "l<x", "l<<3", "l=<3", "l<0.1<r", "l<1_0", ""])
def test_what_is_no_condition_is_named(text):
    with pytest.raises(DeclarationError, match="expected a condition like"):
        Condition.parse(text)


def test_what_cannot_be_asked_is_named(swept):
    with pytest.raises(
        DeclarationError,
        match="expected one column to minimise or maximise, or two for their front, got 0",
    ):
        best(swept)
    with pytest.raises(DeclarationError, match="got 3"):
        best(swept, minimise=[EFFORT, BENDING], maximise=["l"])
    with pytest.raises(UnknownNameError, match="unknown column 'bending'"):
        best(swept, minimise=["bending"])
    with pytest.raises(UnknownNameError, match="unknown column 'q'"):
        best(swept, minimise=[EFFORT], where=["q<1"])
    with pytest.raises(UnknownNameError, match="unknown column 'q'"):
        best(swept, minimise=[EFFORT], columns=["q"])
    with pytest.raises(UnknownNameError, match=r"unknown columns 'p' .*, 'q', 's' \(did"):
        best(swept, minimise=[EFFORT, "p"], columns=["q", "l"], where="s<1")
    with pytest.raises(DeclarationError, match="expected a condition like"):
        best(swept, minimise=EFFORT, where="l")
    with pytest.raises(DeclarationError, match="at least 1, got 0"):
        best(swept, minimise=[EFFORT], count=0)


def test_what_is_selected_is_what_is_searched(swept):
    cut = swept.select(l=(0.2, 0.3))
    assert all(
        0.2 <= design.values["l"] <= 0.3 for design in best(cut, minimise=[BENDING], count=10)
    )
    assert sum(numbers.size for numbers, _ in chosen(cut, ["l"])) == cut.size
