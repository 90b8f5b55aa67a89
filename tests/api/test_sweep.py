"""Sweeps: designs and their order, beside plain evaluations; what is read, selected, chosen and
refused. Drawn where a design is a number.
"""

import itertools
import math
import operator
from decimal import Decimal

import casadi as ca
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


def test_the_instant_and_the_ratio_of_a_peak_give_its_value(slider_crank, swept):
    for i, l in enumerate(LENGTHS):
        at, xi = (
            float(swept[f"{kind}:section:rod:bending"][i, 0]) for kind in ("peak_t", "peak_xi")
        )
        values = {"l": l, "r": CRANKS[0], "m3": 0.3}
        there = evaluate(slider_crank.scene, parameters=values, t=(at, at, 1))
        value = there.section("rod").law.at("bending", np.array([[xi]]))[0, 0]
        np.testing.assert_allclose(value, swept[BENDING][i, 0], rtol=1e-9)


def test_what_is_kept_and_its_units(slider_crank, swept):
    def kinds(**keywords):
        found = sweep(slider_crank, {"l": [0.2, 0.3]}, t=(0, 0.08, 9), **keywords)
        return {name.partition(":")[0] for name in found.columns}

    all_peaks = {"status", "peak", "peak_t", "peak_xi", "mean", "rms"}
    assert kinds() == all_peaks
    assert kinds(xi=(0, 1, 3)) == all_peaks | {"peak_at"}
    assert kinds(wanted=["effort"]) == all_peaks - {"peak_xi"}
    assert kinds(keep="laws") == all_peaks | {"history"}
    units = {"peak:reaction:A:resultant": "N", "rms:effort:O": "N m", "peak_t:effort:O": "s"}
    units |= {"peak_xi:section:rod:bending": "1", "status": "1", "l": "m"}
    assert {name: swept.unit(name) for name in units} == units


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
    return sweep(ARM, grid, backend="vm", **words)


@settings(max_examples=15)
@given(st.integers(-(10**6), 10**6), st.integers(1, 10**6), st.integers(2, 90), st.integers(0, 6))
def test_decimals_of_a_range_are_rounded_once(first, step, count, digits):
    """Against the decimals themselves, read one by one; the same values are one sweep."""
    texts = [str(Decimal(first + k * step).scaleb(-digits)) for k in range(count)]
    numbers = [float(text) for text in texts]
    found = swept_arm({"a": (numbers[0], numbers[-1], count)})
    assert found["a"].tolist() == numbers
    assert found.identity["grid"] == swept_arm({"a": numbers}).identity["grid"]


@settings(max_examples=8)
@given(st.floats(1e-6, 1e3), st.floats(1.5, 1e6), st.integers(2, 90))
def test_a_log_range_goes_in_equal_ratios(start, ratio, count):
    values = swept_arm({"a": (start, start * ratio, count, True)})["a"]
    assert (values[0], values[-1]) == (start, start * ratio)
    np.testing.assert_allclose(values[1:] / values[:-1], ratio ** (1 / (count - 1)), rtol=1e-12)


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


def test_what_a_grid_rounds_is_what_was_meant():
    found = swept_arm({"a": [0.1, 0.2, 0.30000000000000004, 0.4]})
    for condition, count in (("a<=0.3", 3), ("a<0.3", 2), ("a==0.3", 1), ("a<inf", 4)):
        assert len(best(found, minimise="a", where=condition, count=9)) == count
    assert found.select(a=0.3).size == 1


def test_as_python_and_xarray_see_it(swept):
    assert set(swept) >= {"l", "r", "xi", "t", "status", EFFORT}
    assert "6 designs over l, r" in repr(swept)
    found = swept.select(l=(0.1, 0.3)).to_xarray([EFFORT, "peak_at:section:rod:axial"])
    assert found["peak_at:section:rod:axial"].dims == ("l", "r", "xi")
    assert found[EFFORT].attrs["units"] == "N m"
    assert float(found[EFFORT].sel(l=0.25, r=0.1)) == swept[EFFORT][2, 1]
    ((numbers, rows),) = swept.blocks(["r", "history:effort:O", "t"], ["t"])
    np.testing.assert_array_equal(numbers, np.repeat(np.arange(6), 129))
    np.testing.assert_array_equal(rows["history:effort:O"], swept["history:effort:O"].ravel())
    np.testing.assert_array_equal(rows["t"], np.tile(swept["t"], 6))
    text = swept._repr_html_()
    assert "6 designs over l, r: 5 with a result; " in text


GRIDS = [
    ({}, DeclarationError, "grid: expected at least one axis"),
    ({"a": (0.4, 0.1, 5)}, DeclarationError, "grid of a: STOP must be after START"),
    ({"a": (0.1, 0.4, 0)}, DeclarationError, "COUNT must be at least 1"),
    ({"a": (0.1, np.nan, 5)}, DeclarationError, "START and STOP must be finite"),
    ({"a": (0.1, 0.4, 1)}, DeclarationError, "COUNT be 2 or more"),
    ({"a": (0.0, 0.4, 5, True)}, DeclarationError, "a log range must begin above 0"),
    ({"a": []}, DeclarationError, "expected at least one value"),
    ({"a": [0.1, 0.2, 0.1]}, DeclarationError, r"the value 0\.1 is listed twice"),
    ({"a": "abc"}, DeclarationError, r"expected \(start, stop, count\) or numbers, got 'abc'"),
    ({"q": [1.0], "k": [1.0]}, UnknownNameError, "unknown parameters 'q', 'k'; valid: a, b, c"),
    (None, DeclarationError, "expected a mapping by name"),
]


@pytest.mark.parametrize(("grid", "error", "says"), GRIDS)
def test_what_is_no_grid_is_named(grid, error, says):
    with pytest.raises(error, match=says):
        swept_arm(grid)


@pytest.mark.parametrize(
    ("words", "error", "says"),
    [
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
    ],
)
def test_what_cannot_be_swept_is_named(slider_crank, tmp_path, words, error, says):
    with pytest.raises(error, match=says):
        sweep(slider_crank, {"l": [0.2, 0.3]}, out=tmp_path / "x.h5", **words)
    assert list(tmp_path.iterdir()) == []


READS = [
    (lambda s: s.select(m3=0.1, q=1), "unknown swept parameters 'm3', 'q'; valid: l, r"),
    (lambda s: s.select(l=0.21), r"no design has l = 0\.21; nearest: 0\.25, 0\.13"),
    (lambda s: s.select(l=(0.21, 0.24)), r"no design has l up to 0\.24 and from 0\.21; nearest"),
    (lambda s: s.select(l=(0.3, 0.2)), "the range is reversed"),
    (lambda s: s.select(l="30 deg"), r"expected numbers \[m\], not angles"),
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
    one = evaluate(scene, over=("O", 0, math.tau, 37), parameters={"rpm": 60.0, "l": 0.4})
    np.testing.assert_allclose(found["history:effort:O"][0, 1], one.effort("O"), atol=1e-11)
    (peak,) = refine(scene, one, ["effort:O"])
    assert found[EFFORT][0, 1] == pytest.approx(peak.value, rel=1e-9)
    assert found.to_xarray()["history:effort:O"].dims == ("rpm", "l", axis)
    if words:
        angle = found["peak_t:effort:O"] * math.tau * np.array([[1.0], [10.0]])
        np.testing.assert_allclose(found["peak_over:effort:O"], angle, rtol=1e-14)
        still = sweep(scene, {"rpm": [0.0, 60.0]}, **words)
        assert still.statuses[int(still["status"][0])][0] == "no_instants"
        assert np.isnan(still[EFFORT]).tolist() == [True, False]


def test_derivatives_are_those_of_a_prepared_scene(slider_crank):
    wanted = ["effort", "section:rod", "sensitivity:l", "sensitivity:m3"]
    found = sweep(slider_crank, {"l": LENGTHS, "r": CRANKS}, t=SPAN, wanted=wanted)
    f = prepare(slider_crank.scene, t=SPAN, wanted=wanted)
    for i, j in itertools.product(range(1, 3), range(2)):
        gradient = f.gradient(l=LENGTHS[i], r=CRANKS[j])
        for by in ("l", "m3"):
            for name in f.quantities:
                assert found[f"sensitivity:{by}:peak:{name}"][i, j] == gradient[name][by]
            for way in ("mean", "rms"):
                slope = getattr(gradient, way)["effort:O"][by]
                assert found[f"sensitivity:{by}:{way}:effort:O"][i, j] == slope
    assert found.unit("sensitivity:m3:peak:section:rod:axial") == "N/kg"
    assert "sensitivity:r:peak:effort:O" not in found.columns


def test_a_design_without_its_peak_is_marked():
    """A load of 200 000 teeth, or none: a status and no number."""
    m = Mechanism("saw")
    m.set_gravity(0, 0)
    width = m.parameter("width", 10.0, "rad")
    beam = m.link("arm", length=0.5, mass=1.0)
    angle = m.coordinate(m.revolute("pin", m.ground, beam))
    m.force("push", beam.tip, x=2.0 * ca.cos(angle) + 1e-3 * ca.fmod(angle, width))
    law = {"pin": motion.polynomial(0.0, 1.0)}
    scene = Scene(m, law, t=(0.0, 2.0, 51), wanted=["load:push"])
    found = sweep(scene, {"width": [10.0, 1e-5]})
    assert "smooth the load" in found.statuses[int(found["status"][1])][1]
    np.testing.assert_allclose(found["peak:load:push:fx"], [2.0, np.nan], rtol=1e-6)


def assert_covered(scene, t, **words):
    """Sampled peaks are below exact ones, by no more than they are said to miss."""
    exact, found = (
        prepare(scene, t=t, peaks=kind, **words).peaks() for kind in ("exact", "sampled")
    )
    high, low, told = np.abs(exact.value), np.abs(found.value), ~np.isnan(exact.value)
    assert (np.isnan(found.error) == ~told).all()
    assert (low[told] <= high[told]).all()
    assert (high[told] <= low[told] + found.error[told]).all()


@pytest.mark.sampled(3)
@pytest.mark.parametrize("count", [5, 19, 64])
@pytest.mark.parametrize("name", ["slider_crank", "beam_pump", "quick_return", "arm6", "engine"])
def test_the_error_of_sampled_peaks_covers_what_the_instants_miss(name, count):
    scene = load_case(CASES / name).scene
    assert_covered(scene, (*scene.span, count), backend="c")


@pytest.mark.sampled(4)
@pytest.mark.parametrize("seed", range(12))
def test_the_error_covers_random_mechanisms(seed):
    drawn, done = draw(seed), 0
    for count in (9, 33):
        try:
            assert_covered(drawn.scene(), (*drawn.grid[:2], count), backend="c")
            done += 1
        except LagrangeCasadiError:
            continue
    assert done or seed


@pytest.mark.parametrize("backend", ["lanes", "c", "vm"])
@pytest.mark.parametrize("count", [1, 6, 16, 17, 41])
def test_the_error_of_a_wave_is_what_bends_it(backend, count):
    """An effort proportional to cos(w t): between values y it may rise by half their second
    difference; the largest value, and what that says, are those of the closed form.
    """
    times = np.linspace(0, 1.1 if count > 1 else 0, count)
    scene = pendulum(motion.polynomial(0.3, 4.0), t=(0, times[-1], count))
    f = prepare(scene, backend=backend, peaks="sampled")
    found, k = f.peaks(), f.quantities.index("effort:pin")
    y = 1.2 * 9.81 * 0.25 * np.cos(0.3 + 4.0 * times)
    largest = np.abs(y).max()
    assert abs(found.value[k]) == pytest.approx(largest, rel=1e-13)
    if count < 8:
        assert found.error[k] == pytest.approx(0.0 if count == 1 else np.inf, abs=1e-10)
        return
    ends = [2 * b - c + np.copysign(2 * abs(2 * c - b - d), -b) for b, c, d in (y[:3], y[:-4:-1])]
    longer = np.concatenate([ends[:1], y, ends[1:]])
    reach = np.abs(y - np.diff(longer, 2) / 2).max()
    assert found.error[k] == pytest.approx(reach - largest, rel=1e-9, abs=1e-11)


def test_a_sweep_keeps_what_sampled_peaks_may_miss(slider_crank, tmp_path):
    asked = {"wanted": ["effort", "section:rod"], "t": (0, 0.08, 33)}
    grid = {"l": (0.2, 0.4, 5)}
    exact = sweep(slider_crank, grid, **asked)
    found = sweep(slider_crank, grid, peaks="sampled", out=tmp_path / "x.h5", **asked)
    missed = np.abs(exact[BENDING]) - np.abs(found[BENDING])
    assert (missed >= 0).all()
    assert (missed <= found["peak_error:section:rod:bending"]).all()
    (chosen, *_) = best(Sweep.open(found.path), minimise=EFFORT)
    assert list(chosen.values) == ["l", EFFORT, "peak_error:effort:O"]
