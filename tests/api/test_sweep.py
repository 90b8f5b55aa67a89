"""Sweeps: designs and their order, beside plain evaluations; what is read, selected, chosen and
refused. Drawn where a design is a number.
"""

import contextlib
import itertools
import math
import operator
from decimal import Decimal

import numpy as np
import pytest
from conftest import CASES
from hypothesis import given, settings
from hypothesis import strategies as st
from mechanisms import pendulum, press
from random_mechanisms import draw

from lagrange_casadi import (
    Mechanism,
    Scene,
    Sweep,
    best,
    evaluate,
    load_case,
    motion,
    peaks,
    prepare,
    read_designs,
    refine,
    sweep,
)
from lagrange_casadi.errors import (
    DeclarationError,
    LagrangeCasadiError,
    ParameterError,
    SizeError,
    UnknownNameError,
)

SPAN = (0, 0.08, 129)
LENGTHS, CRANKS = (0.09, 0.13, 0.25), (0.06, 0.1)
BENDING, EFFORT = "peak:section:rod:bending", "peak:effort:O"


@pytest.fixture(scope="module")
def swept(slider_crank):
    """A grid of which one design cannot be closed, with all that is kept."""
    grid = {"l": LENGTHS, "r": CRANKS}
    return sweep(slider_crank, grid, t=SPAN, xi=(0, 1, 5), keep="histories", parameters={"m3": 0.3})


@pytest.fixture(scope="module")
def plain(slider_crank):
    """Every design that can be closed, evaluated by itself."""
    return {
        (i, j): evaluate(
            slider_crank.scene, parameters={"l": l, "r": r, "m3": 0.3}, t=SPAN, xi=(0, 1, 5)
        )
        for (i, l), (j, r) in itertools.product(enumerate(LENGTHS), enumerate(CRANKS))
        if l > r
    }


def test_all_that_is_kept_is_of_plain_evaluations(slider_crank, swept, plain):
    """Peaks between the instants, means, histories and section forces along the link."""
    for place, solution in plain.items():
        for peak in refine(slider_crank.scene, solution, peaks.forces(solution)):
            if abs(peak.value) > 1e-9:
                found = swept[f"peak:{peak.name}"][place]
                assert found == pytest.approx(peak.value, rel=1e-8), peak.name
        told = solution.statistics("effort:O")
        size = told.largest.value
        assert swept["mean:effort:O"][place] == pytest.approx(told.mean, abs=1e-12 * size)
        assert swept["rms:effort:O"][place] == pytest.approx(told.rms, rel=1e-12)
        for name in ("effort:O", "reaction:guide:fy", "section:rod:bending", "section:rod:axial"):
            expected = solution.array(name)
            size = np.abs(expected).max()
            history = swept[f"history:{name}"][place]
            np.testing.assert_allclose(history, expected, atol=1e-11 * size, err_msg=name)
        largest = np.abs(swept["peak_at:section:rod:shear"][place])
        expected = np.abs(solution.section("rod").shear).max(axis=0)
        np.testing.assert_allclose(largest, expected, atol=1e-11 * expected.max())
    for name in swept.columns:
        if name != "status":
            assert np.isnan(swept[name][0, 1]).all(), name
    assert (swept["status"] != 0).tolist() == [[False, True], [False, False], [False, False]]
    word, sentence = swept.statuses[int(swept["status"][0, 1])]
    assert word != "ok"
    assert sentence


def arm():
    """One swinging link with parameters of every kind; cheap."""
    m = Mechanism("arm")
    values = {name: m.parameter(name, 1.0, "m") for name in ("a", "b", "c")}
    phi = m.parameter("phi", 0.3, "rad")
    beam = m.link("beam", length=2.0, mass=1.0)
    m.revolute("O", m.ground, beam)
    m.torque("push", beam, values["a"] + 10 * values["b"] + 100 * values["c"])
    return Scene(m, {"O": motion.polynomial(phi)}, ["effort"], t=(0, 1, 2))


ARM = arm()


def swept_arm(grid, **words):
    return sweep(ARM, grid, **words)


@settings(max_examples=6)
@given(st.integers(-(10**6), 10**6), st.integers(1, 10**6), st.integers(2, 90), st.integers(0, 6))
def test_decimals_of_a_range_are_rounded_once(first, step, count, digits):
    """Against the decimals themselves, read one by one; the same values are one sweep."""
    texts = [str(Decimal(first + k * step).scaleb(-digits)) for k in range(count)]
    numbers = [float(text) for text in texts]
    found = swept_arm({"a": (numbers[0], numbers[-1], count)})
    assert found["a"].tolist() == numbers
    assert found.identity["grid"] == swept_arm({"a": numbers}).identity["grid"]


@settings(max_examples=10)
@given(st.lists(st.integers(1, 5), min_size=3, max_size=3), st.data())
def test_designs_are_the_product_in_its_order_and_selections_are_parts(lengths, data):
    """Numbers, values, columns, selections and blocks, beside NumPy's."""
    names = ("a", "b", "c")
    axes = [[float(k + 1 + 10**i) for k in range(n)] for i, n in enumerate(lengths)]
    found = swept_arm(dict(zip(names, axes, strict=True)))
    product = list(itertools.product(*axes))
    assert (found.shape, found.size) == (tuple(lengths), len(product))
    number = data.draw(st.integers(0, len(product) - 1))
    assert tuple(found.design(number).values()) == product[number]
    torque = np.array(product) @ [1, 10, 100]
    base = found["mean:effort:O"].ravel() + torque
    np.testing.assert_allclose(base, base[0], atol=1e-9)
    picked = [sorted(data.draw(st.sets(st.sampled_from(axis), min_size=1))) for axis in axes]
    part = found.select(a=picked[0], b=(picked[1][0], picked[1][-1]), c=picked[2][0])
    inside = [v for v in axes[1] if picked[1][0] <= v <= picked[1][-1]]
    kept = [
        k
        for k, (a, b, c) in enumerate(product)
        if a in picked[0] and b in inside and c == picked[2][0]
    ]
    np.testing.assert_array_equal(part[EFFORT].ravel(), found[EFFORT].ravel()[kept])
    rows = [
        (n, x) for numbers, at in part.blocks(["b"]) for n, x in zip(numbers, at["b"], strict=True)
    ]
    assert rows == [(k, product[k][1]) for k in kept]


def test_a_list_is_its_rows(tmp_path):
    """Angles have a unit; heads too; a design is a line."""
    (tmp_path / "d.csv").write_text("phi,a [mm],b\n30 deg,200,1\n0.5,300,2\n-90deg,50,3\n")
    found = swept_arm(read_designs(tmp_path / "d.csv"))
    rows = np.array([[math.pi / 6, 0.2, 1.0], [0.5, 0.3, 2.0], [-math.pi / 2, 0.05, 3.0]])
    for name, column in zip(("phi", "a", "b"), rows.T, strict=True):
        np.testing.assert_array_equal(found[name], column)
    assert list(found.design(1).values()) == rows[1].tolist()
    assert found.select(a=(0.1, 1.0), phi="30 deg")["b"].tolist() == [1.0]
    assert found.to_xarray()[EFFORT].dims == ("design",)


RELATIONS = {"<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge}
RELATIONS |= {"==": operator.eq, "=": operator.eq, "!=": operator.ne}


@settings(max_examples=60)
@given(data=st.data())
def test_the_best_are_those_of_a_search_of_all(swept, data):
    """By size of a peak, where conditions hold; of two columns those that nothing beats."""
    names = ["l", "r", BENDING, EFFORT, "rms:effort:O"]
    table = {name: np.broadcast_to(swept[name], swept.shape) for name in names[2:]}
    table |= {"l": np.repeat(swept["l"], 2), "r": np.tile(swept["r"], 3)}
    cost = {name: np.abs(np.ravel(column)) for name, column in table.items()}
    there = np.ravel(swept["status"] == 0)
    where = []
    for _ in range(data.draw(st.integers(0, 2))):
        name, word = data.draw(st.sampled_from(names)), data.draw(st.sampled_from([*RELATIONS]))
        limit = float(data.draw(st.sampled_from(cost[name][np.isfinite(cost[name])].tolist())))
        where.append(f"{name}{word}{limit!r}")
        there &= RELATIONS[word](cost[name], limit)
    objectives = data.draw(st.lists(st.sampled_from(names), min_size=1, max_size=2, unique=True))
    ways = [data.draw(st.sampled_from(["minimise", "maximise"])) for _ in objectives]
    asked = {
        way: [o for o, w in zip(objectives, ways, strict=True) if w == way] for way in set(ways)
    }
    signed = [
        cost[o] if w == "minimise" else -cost[o] for o, w in zip(objectives, ways, strict=True)
    ]
    kept = np.flatnonzero(there)
    numbers = [one.number for one in best(swept, **asked, where=where, count=10)]
    if len(objectives) == 1:
        assert signed[0][numbers].tolist() == sorted(signed[0][kept])
        assert set(numbers) == set(kept)
        return
    pairs = np.array(signed).T
    front = {
        tuple(p)
        for p in pairs[kept]
        if not any((q <= p).all() and (q < p).any() for q in pairs[kept])
    }
    assert {tuple(pairs[k]) for k in numbers} == front


GRIDS = [
    ({}, DeclarationError, "grid: expected at least one axis"),
    ({"a": (0.4, 0.1, 5)}, DeclarationError, "grid of a: STOP must be after START"),
    ({"a": (0.1, 0.4, 0)}, DeclarationError, "COUNT must be at least 1"),
    ({"a": (0.1, np.nan, 5)}, DeclarationError, "START and STOP must be finite"),
    ({"a": (0.1, 0.4, 1)}, DeclarationError, "COUNT be 2 or more"),
    ({"a": (0.0, 0.4, 5, True)}, DeclarationError, "a log range must begin above 0"),
    ({"a": []}, DeclarationError, "expected at least one value"),
    ({"a": [0.1, 0.2, 0.1]}, DeclarationError, r"the value 0\.1 is listed twice"),
    ({"a": np.array([0.2, 0.2])}, DeclarationError, r"the value 0\.2 is listed twice"),
    ({"a": {0.1, 0.2}}, DeclarationError, "grid of a: expected numbers, got"),
    ({"a": (0.1, 0.4, 5, "log")}, DeclarationError, "expected True or False"),
    ({"a": "abc"}, DeclarationError, r"expected numbers, got \['abc'\]"),
    ({"q": [1.0], "k": [1.0]}, UnknownNameError, "unknown parameters 'q', 'k'; valid: a, b, c"),
    (None, DeclarationError, "expected a mapping by name"),
]


WORDS = [
    ({"keep": "all"}, UnknownNameError, "valid: peaks, laws, histories"),
    ({"wanted": ["effort"], "xi": (0, 1, 3)}, DeclarationError, "ratios apply to section"),
    ({"wanted": ["effort"], "keep": "laws"}, DeclarationError, "laws describe section forces"),
    ({"xi": (0, 2, 3)}, DeclarationError, r"ratios xi/l must lie in \[0, 1\]"),
    ({"parameters": {"l": 0.3}}, DeclarationError, r"'l' is swept and set to 0\.3 as well"),
    ({"parameters": {"r": -1.0}}, ParameterError, "'r' = -1 m is out of its range"),
    ({"wanted": ["sensitivity:l"]}, DeclarationError, "sensitivities need other outputs"),
    ({"over": ("O", 0, 1, 5), "t": (0, 1, 5)}, DeclarationError, "t and over exclude"),
    ({"peaks": "sampled", "wanted": ["sensitivity", "effort"]}, DeclarationError, "exact ones"),
    (
        {"t": (0, 0.08, 1_000_000), "xi": (0, 1, 601), "keep": "histories"},
        SizeError,
        r"history:section:crank:axial of one design takes 4\.48 GiB, a chunk 2 GiB at most",
    ),
]


READS = [
    (lambda s: s.select(m3=0.1, q=1), "unknown swept parameters 'm3', 'q'; valid: l, r"),
    (lambda s: s.select(l=0.21), r"no design has l = 0\.21; nearest: 0\.25, 0\.13"),
    (lambda s: s.select(l=(0.21, 0.24)), r"no design has l up to 0\.24 and from 0\.21; nearest"),
    (lambda s: s.select(l=(0.3, 0.2)), "the range is reversed"),
    (lambda s: s.select(l="30 deg"), r"l: \'30 deg\' is an angle; expected a length \[m\]"),
    (lambda s: s.select(l=[0.2, np.nan]), "expected a number, a list of numbers, or a tuple"),
    (lambda s: s["peak:effort:Q"], r"unknown column 'peak:effort:Q' \(did you mean '"),
    (lambda s: s[0], "name: expected a text, got 0"),
    (lambda s: s.design(6), "design 6: expected a number from 0 to 5"),
    (lambda s: s.column("xi"), "'xi' is no column but an axis: it needs a column over xi"),
    (lambda s: s.values(0, ["history:effort:O"]), "has a value for every t, not one a design"),
    (lambda s: s.axes_of([EFFORT, "history:effort:O", "peak_at:section:rod:axial"]), "a table for"),
    (lambda s: best(s), "expected one column to minimise or maximise, or two for their front"),
    (lambda s: best(s, minimise=["l", "r"], maximise=EFFORT), "got 3"),
    (lambda s: best(s, minimise="bending"), "unknown column 'bending'"),
    (lambda s: best(s, minimise=EFFORT, where="l"), "expected a condition like"),
    (lambda s: best(s, minimise=EFFORT, where="l<<3"), "expected a condition like"),
    (lambda s: best(s, minimise=EFFORT, count=0), "at least 1, got 0"),
    (lambda s: s.axes_of(3), "columns: expected a name, or a list of names, got 3"),
]


@pytest.mark.parametrize(("read", "says"), READS)
def test_what_cannot_be_read_is_named(swept, read, says):
    with pytest.raises((DeclarationError, UnknownNameError), match=says):
        read(swept)


@pytest.mark.parametrize("asked", ["over", "t"])
def test_designs_with_instants_of_their_own(tmp_path, asked):
    """Over a drive's coordinate, or over times that are expressions: the same peaks, histories on
    an axis that all designs share, and no numbers where there are no instants.
    """
    scene = press(wanted=["effort"], t=lambda rpm: (0, 60 / rpm, 37))
    words = {"over": ("O", 0, "360 deg", 37)} if asked == "over" else {}
    grid = {"rpm": [60.0, 600.0], "l": (0.3, 0.5, 3)}
    found = sweep(scene, grid, **words, keep="histories", out=tmp_path / "x.h5")
    axis = {"over": "over", "t": "cycle"}[asked]
    assert found.column("history:effort:O").axes == (axis,)
    np.testing.assert_allclose(found[axis], np.arange(37) / 36 * (math.tau if words else 1.0))
    times = found["history:t"][:, 0]
    np.testing.assert_allclose(times, [np.arange(37) / 36, np.arange(37) / 360], rtol=1e-14)
    assert found.to_xarray()["history:effort:O"].dims == ("rpm", "l", axis)
    if words:
        angle = found["peak_t:effort:O"] * math.tau * np.array([[1.0], [10.0]])
        np.testing.assert_allclose(found["peak_over:effort:O"], angle, rtol=1e-14)
        still = sweep(scene, {"rpm": [0.0, 60.0]}, **words)
        assert still.statuses[int(still["status"][0])][0] == "no_instants"
        assert np.isnan(still[EFFORT]).tolist() == [True, False]


def test_derivatives_are_those_of_a_prepared_scene(slider_crank):
    wanted = ["effort", "section:rod", "sensitivity:m3"]
    found = sweep(slider_crank, {"l": LENGTHS, "r": CRANKS}, t=SPAN, wanted=wanted)
    f = prepare(slider_crank.scene, t=SPAN, wanted=wanted)
    for (i, l), (j, r) in itertools.product(enumerate(LENGTHS[1:], 1), enumerate(CRANKS)):
        gradient = f.gradient(l=l, r=r)
        slopes = {f"peak:{name}": gradient[name] for name in f.quantities}
        slopes |= {f"{way}:effort:O": getattr(gradient, way)["effort:O"] for way in ("mean", "rms")}
        for name, slope in slopes.items():
            assert found[f"sensitivity:m3:{name}"][i, j] == slope["m3"]
    assert found.unit("sensitivity:m3:peak:section:rod:axial") == "N/kg"


def test_what_is_kept_and_how_python_sees_it(slider_crank, swept):
    peaks = {"status", "peak", "peak_t", "peak_xi", "mean", "rms"}
    for words, kept in (
        ({}, peaks),
        ({"xi": (0, 1, 3)}, peaks | {"peak_at"}),
        ({"wanted": ["effort"]}, peaks - {"peak_xi"}),
        ({"keep": "laws"}, peaks | {"history"}),
    ):
        found = sweep(slider_crank, {"l": [0.2, 0.3]}, t=(0, 0.08, 9), **words)
        assert {name.partition(":")[0] for name in found.columns} == kept
    units = {"peak:reaction:A:resultant": "N", "rms:effort:O": "N m", "peak_t:effort:O": "s"}
    units |= {"peak_xi:section:rod:bending": "1", "status": "1", "l": "m"}
    assert {name: swept.unit(name) for name in units} == units
    assert set(swept) >= {"l", "r", "xi", "t", "status", EFFORT}
    assert "6 designs over l, r" in repr(swept)
    assert "6 designs over l, r: 5 with a result; " in swept._repr_html_()
    found = swept.select(l=(0.1, 0.3)).to_xarray([EFFORT, "peak_at:section:rod:axial"])
    assert found["peak_at:section:rod:axial"].dims == ("l", "r", "xi")
    assert found[EFFORT].attrs["units"] == "N m"
    assert float(found[EFFORT].sel(l=0.25, r=0.1)) == swept[EFFORT][2, 1]
    found = swept_arm({"a": [0.1, 0.2, 0.30000000000000004, 0.4]})
    for condition, count in (("a<=0.3", 3), ("a<0.3", 2), ("a==0.3", 1), ("a<inf", 4)):
        assert len(best(found, minimise="a", where=condition, count=9)) == count


CANNOT = [
    *((lambda _, grid=grid: swept_arm(grid), error, says) for grid, error, says in GRIDS),
    *(
        (lambda case, words=words: sweep(case, {"l": [0.2, 0.3]}, **words), error, says)
        for words, error, says in WORDS
    ),
]


@pytest.mark.parametrize(("ask", "error", "says"), CANNOT)
def test_what_cannot_be_swept_is_named(slider_crank, ask, error, says):
    with pytest.raises(error, match=says):
        ask(slider_crank)


CASE_NAMES = ["slider_crank", "beam_pump", "quick_return", "arm6", "engine"]


@pytest.mark.sampled(7)
@pytest.mark.parametrize("count", [5, 19, 64])
@pytest.mark.parametrize("drawn", [*CASE_NAMES, *range(12)])
def test_the_error_of_sampled_peaks_covers_what_the_instants_miss(drawn, count):
    """They are below exact ones, by no more than they are said to miss, also of random
    mechanisms; some of these have none.
    """
    known = isinstance(drawn, str)
    scene = load_case(CASES / drawn).scene if known else draw(drawn).scene()
    asked = {"t": (*scene.span, count), "backend": "c"}
    with contextlib.nullcontext() if known else contextlib.suppress(LagrangeCasadiError):
        exact, found = (prepare(scene, peaks=way, **asked).peaks() for way in ("exact", "sampled"))
        high, low, told = np.abs(exact.value), np.abs(found.value), ~np.isnan(exact.value)
        assert (np.isnan(found.error) == ~told).all()
        assert (low[told] <= high[told]).all()
        assert (high[told] <= low[told] + found.error[told]).all()


@pytest.mark.parametrize("backend", ["lanes", "c"])
@pytest.mark.parametrize("rate", [4.0, 2.5])
def test_the_error_of_a_wave_is_what_bends_it(backend, rate):
    """An effort proportional to cos(w t): between values y it may rise by half their second
    difference, within the span or at its end.
    """
    times = np.linspace(0, 1.1, 41)
    scene = pendulum(motion.polynomial(0.3, rate), t=(0, 1.1, 41))
    f = prepare(scene, backend=backend, peaks="sampled")
    found, k = f.peaks(), f.quantities.index("effort:pin")
    y = 1.2 * 9.81 * 0.25 * np.cos(0.3 + rate * times)
    assert abs(found.value[k]) == pytest.approx(np.abs(y).max(), rel=1e-13)
    ends = [2 * b - c + np.copysign(2 * abs(2 * c - b - d), -b) for b, c, d in (y[:3], y[:-4:-1])]
    reach = np.abs(y - np.diff([ends[0], *y, ends[1]], 2) / 2).max()
    assert found.error[k] == pytest.approx(reach - np.abs(y).max(), rel=1e-9, abs=1e-11)
    few = prepare(scene, backend=backend, peaks="sampled", t=(0, 1.1, 6)).peaks()
    assert few.error[k] == np.inf


def test_a_sweep_keeps_what_sampled_peaks_may_miss(slider_crank, tmp_path):
    asked = {"wanted": ["effort", "section:rod"], "t": (0, 0.08, 33), "out": tmp_path / "x.h5"}
    found = sweep(slider_crank, {"l": (0.2, 0.4, 5)}, peaks="sampled", **asked)
    assert (found["peak_error:section:rod:bending"] >= 0.0).all()
    (chosen, *_) = best(Sweep.open(found.path), minimise=EFFORT)
    assert list(chosen.values) == ["l", EFFORT, "peak_error:effort:O"]
