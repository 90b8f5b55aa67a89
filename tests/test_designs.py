"""Many designs at once: each against its own evaluation and refined peaks, on every rung, whatever the neighbours."""

import math
import subprocess

import casadi as ca
import numpy as np
import pytest
from builders import crank_and_rod, four_bar, slider_crank
from conftest import CASES
from parametric import declared
from test_codegen import PEDANTIC, SCENES
from test_kinematics import double_crank, flat_parallelogram
from test_mobility import truss_platform
from test_peaks import lobes, pendulum
from test_redundancy import parallelogram

from lagrange_casadi import Mechanism, Scene, codegen, density, derive, evaluate, load_case, motion
from lagrange_casadi.backends import run
from lagrange_casadi.codegen import library
from lagrange_casadi.designs import DesignEngine
from lagrange_casadi.designs_plan import Kept, stages_of
from lagrange_casadi.errors import AssemblyError, DeclarationError, ParameterError
from lagrange_casadi.motion import polynomial
from lagrange_casadi.peaks import forces, refine
from lagrange_casadi.refusal import Status, refusal
from lagrange_casadi.rung import Rung

NAMES = sorted(path.name for path in CASES.iterdir() if (path / "case.py").exists())
INSTANTS = 128
FIELDS = ("status", "value", "t", "xi", "mean", "rms")


def around(scene, count, spread=0.03, seed=0):
    """So many designs, the first with the defaults, the others so far around them."""
    base = np.array(list(scene.mechanism.values().values()))
    p = base * np.random.default_rng(seed).uniform(1 - spread, 1 + spread, (count, base.size))
    p[0] = base
    return p


def values(scene, row):
    return dict(zip(scene.mechanism.parameters, row.tolist(), strict=True))


def peaks_of(designs, outcome, row):
    """Value, time and ratio of each quantity of a design."""
    return {name: (outcome.value[row, k], outcome.t[row, k], outcome.xi[row, k]) for k, name in enumerate(designs.quantities)}


def scales(designs, outcome, row):
    """The largest peak of each quantity's unit."""
    units, sizes = np.array(designs.units), np.abs(np.where(np.isfinite(outcome.value[row]), outcome.value[row], 0.0))
    return {name: sizes[units == unit].max() for name, unit in zip(designs.quantities, designs.units, strict=True)}


def assert_refined(scene, designs, outcome, row, p, tolerance=1e-11, noise=1e-12):
    """A design's peaks are the refined ones of its own evaluation; one that is larger is what the graph gives there."""
    grid = (designs.t[0], designs.t[-1], designs.t.size)
    solution = evaluate(scene, parameters=values(scene, p), t=grid, backend="c", certificate=False)
    found, scale = peaks_of(designs, outcome, row), scales(designs, outcome, row)
    names = [name for name in designs.quantities if name in set(solution.names())]
    assert len(names) > len(designs.quantities) / 2
    for peak in refine(scene, solution, names):
        value, t, xi = found[peak.name]
        if math.isinf(peak.value) or math.isinf(value):
            assert math.isinf(peak.value), peak.name
            assert math.isinf(value), peak.name
            continue
        allowed = tolerance * abs(value) + noise * scale[peak.name]
        assert abs(value) >= abs(peak.value) - allowed, peak.name
        if abs(value) > abs(peak.value) + allowed:
            assert derive(scene).newton is None
            there = evaluate(scene, parameters=values(scene, p), t=(t, t, 1), backend="c", certificate=False)
            assert there.peak(peak.name).value == pytest.approx(value, rel=1e-10), peak.name
        assert np.isnan(xi) == (peak.xi is None)
    for joint in {name.split(":")[1] for name in names if name.startswith("reaction:")}:
        reaction = solution.reaction(joint)
        size = np.hypot(reaction.fx, reaction.fy)
        assert found[f"reaction:{joint}"][0] >= size.max() * (1 - 1e-14)
        assert found[f"reaction:{joint}"][0] <= size.max() * 1.2 or math.isinf(found[f"reaction:{joint}"][0])


@pytest.mark.parametrize("name", NAMES)
def test_designs_are_their_own_evaluations(name):
    """Every number of a case a parameter."""
    scene = declared(CASES / name)
    designs = DesignEngine.of(scene, t=(*scene.t[:2], INSTANTS), rung=Rung("c"))
    p = around(scene, 3)
    outcome = designs.evaluate(p)
    assert outcome.status.tolist() == [Status.OK] * 3
    for row in range(3):
        assert_refined(scene, designs, outcome, row, p[row])
        solution = evaluate(scene, parameters=values(scene, p[row]), t=(*scene.t[:2], INSTANTS), backend="c", certificate=False)
        for k, effort in enumerate(designs.efforts):
            series = solution.effort(effort.partition(":")[2])
            weights = np.ones(series.size)
            weights[[0, -1]] = 0.5
            size = 1e-13 * np.abs(series).max()
            assert outcome.mean[row, k] == pytest.approx(np.average(series, weights=weights), abs=size)
            assert outcome.rms[row, k] == pytest.approx(math.sqrt(np.average(series**2, weights=weights)), rel=1e-13)


@pytest.mark.parametrize("name", ["slider_crank", "quick_return", "sleigh", "rrr3"])
def test_all_rungs_agree(name):
    """Packs, scalar C and NumPy to rounding; single precision as far as it goes; steps of Newton's method where they are enough."""
    scene = declared(CASES / name)
    p, grid = around(scene, 9), (*scene.t[:2], INSTANTS)
    p[1, 0] = math.nan
    exact = DesignEngine.of(scene, t=grid, rung=Rung("c"))
    expected = exact.evaluate(p)
    rungs = [(Rung("lanes"), 1e-12), (Rung("vm"), 1e-12), (Rung("lanes", newton=4), 1e-12)]
    rungs += [(Rung(backend, "single"), 2e-5) for backend in ("lanes", "c")]
    for rung, tolerance in rungs:
        some = 2 if rung.backend == "vm" else 9
        designs = DesignEngine.of(scene, t=grid, rung=rung)
        assert (designs.quantities, designs.provenance.backend) == (exact.quantities, rung.backend)
        outcome = designs.evaluate(p[:some])
        assert np.array_equal(outcome.status, expected.status[:some])
        assert outcome.status[1] == Status.INVALID
        for row in np.flatnonzero(outcome.status == Status.OK):
            scale = scales(exact, expected, row)
            for k, quantity in enumerate(exact.quantities):
                one, other = abs(outcome.value[row, k]), abs(expected.value[row, k])
                assert one == other or abs(one - other) <= tolerance * (other + scale[quantity]), (rung, quantity)
            np.testing.assert_allclose(outcome.rms[row], expected.rms[row], rtol=50 * tolerance)


@pytest.mark.parametrize("rung", [Rung("lanes"), Rung("c"), Rung("lanes", "single")], ids=lambda rung: rung.options)
@pytest.mark.parametrize("name", ["slider_crank", "quick_return", "rrr3"])
def test_a_row_has_the_same_bytes_whatever_stands_beside_it(name, rung, monkeypatch):
    scene = declared(CASES / name)
    designs = DesignEngine.of(scene, t=(*scene.t[:2], 61), rung=rung)
    p = around(scene, 40, spread=0.7 if name == "slider_crank" else 0.3)
    whole = designs.evaluate(p, threads=1, histories=True)
    assert len(set(whole.status.tolist())) > 1
    for fresh in (designs, DesignEngine.of(scene, t=(*scene.t[:2], 61), rung=rung)):
        order = np.random.default_rng(1).permutation(40)
        other = fresh.evaluate(p[order], histories=True)
        assert all(getattr(other, f).tobytes() == getattr(whole, f)[order].tobytes() for f in (*FIELDS, "series"))
    monkeypatch.setattr(library, "_WORTH_A_THREAD", 0)
    monkeypatch.setattr(library, "_LONGEST", 3)
    cut = DesignEngine.of(scene, t=(*scene.t[:2], 61), rung=rung)
    assert cut.library.share == 1
    for threads in (1, 2, 3, 7):
        other = cut.evaluate(p, threads=threads)
        assert all(getattr(other, f).tobytes() == getattr(whole, f).tobytes() for f in FIELDS)


def bare(designs, p):
    """What the C leaves in arrays that held NaN."""
    n, q, e = len(p), len(designs.quantities), len(designs.efforts)
    results = [np.full(n, -1, np.int8), *(np.full((n, q), np.nan) for _ in range(3)), *(np.full((n, e), np.nan) for _ in range(2))]
    designs.library.evaluate(p, [*results, np.full((n, len(designs.graph.columns), designs.t.size), np.nan)])
    return results


@pytest.mark.parametrize("backend", ["lanes", "c"])
def test_every_value_is_written_or_is_nan(backend):
    scene = slider_crank()
    designs = DesignEngine.of(scene, rung=Rung(backend))
    p = around(scene, 5)
    p[2, 1] = 0.05
    status, value, t, xi, mean, rms = bare(designs, p)
    good = status == Status.OK
    assert good.tolist() == [True, True, False, True, True]
    along = np.array([name.startswith("section:") for name in designs.quantities])
    for array in (value, t, mean, rms):
        assert np.isfinite(array[good]).all()
        assert np.isnan(array[~good]).all()
    assert np.array_equal(np.isfinite(xi), good[:, None] & along)
    # And what held numbers holds NaN after a design without a result.
    results = [np.zeros_like(array) for array in (status, value, t, xi, mean, rms)]
    designs.library.evaluate(p, [*results, None])
    assert all(np.isnan(array[2]).all() for array in results[1:])


def statuses(scene, p, rung, instants=None):
    """The statuses of designs, as they are found and as their own evaluations are refused."""
    designs = DesignEngine.of(scene, t=instants, rung=rung)
    found, expected = designs.evaluate(p).status, []
    for row in p:
        try:
            scene.mechanism.values(values(scene, row))
        except ParameterError:
            expected.append(Status.IMPOSSIBLE if np.isfinite(row).all() else Status.INVALID)
            continue
        table, _ = run(designs.graph, designs.t, row, rung)
        why = refusal(designs.graph, table, designs.t, row, rung)
        expected.append(why.status if why else Status.OK)
    return found.tolist(), expected


both = pytest.mark.parametrize("backend", ["lanes", "vm"])


@pytest.mark.parametrize("backend", ["lanes", "c", "vm"])
def test_lengths_about_a_dead_centre(backend):
    """A crank as long as its rod, all but, and longer; on the instants of dead centres and beside them."""
    near = [1 + sign * 10.0**k for sign in (-1, 1) for k in (-13, -10, -6, -4, -3)]
    ratios = [*near, 1.0, 1.01, 1.5, -1.0, 0.0, math.nan]
    p = np.array([[0.1, 0.1 * ratio, 0.1, 0.1, 0.1] for ratio in ratios])
    seen = set()
    for count in (81, 802):
        found, expected = statuses(slider_crank(), p, Rung(backend), (0, 0.08, count))
        assert found == expected
        seen |= set(found)
    assert seen >= {Status.OK, Status.OUT_OF_REACH, Status.PASSES_DEAD_CENTRE, Status.IMPOSSIBLE, Status.INVALID}


@both
def test_a_dead_centre_on_an_instant(backend):
    m = Mechanism("dead")
    a, b, p = m.link("a", length=1.0, mass=1.0), m.link("b", length=m.parameter("l", 1.0), mass=1.0), m.point_mass("p", 1.0)
    m.revolute("O", m.ground, a)
    m.revolute("A", a.tip, b)
    m.revolute("B", b.tip, p)
    m.prismatic("guide", m.ground, p, axis=(1, 0))
    scene = Scene(m, {"O": polynomial(0.0, math.pi / 2)}, t=(0, 1, 3), posture={"b": 0.0})
    found, expected = statuses(scene, np.array([[1.0], [1.1], [0.9]]), Rung(backend))
    assert found == expected == [Status.DEAD_CENTRE, Status.OK, Status.OUT_OF_REACH]


@both
def test_four_bars_of_every_kind(backend):
    """Crank-rockers, double rockers, change points and what cannot be closed."""
    scene = load_case(CASES / "four_bar").scene
    some = 6 if backend == "vm" else 60
    p = around(scene, some, spread=0.6, seed=4)
    found, expected = statuses(scene, p, Rung(backend), (*scene.t[:2], 101))
    assert found == expected
    assert len(set(found)) > 1


@both
def test_a_change_point_is_passed_between_instants(backend):
    scene = flat_parallelogram()
    found, expected = statuses(scene, np.zeros((1, 0)), Rung(backend))
    assert found == expected == [Status.PASSES_DEAD_CENTRE]


@pytest.mark.parametrize("backend", ["c", "vm"])
def test_iterated_loops_begin_from_the_guess_and_say_what_fails(backend):
    scene = truss_platform()
    p = np.array([[0.05], [0.06], [5.0], [0.04]])
    found, expected = statuses(scene, p, Rung(backend))
    assert found == expected == [Status.OK, Status.OK, Status.NOT_CONVERGED, Status.OK]
    for step, status in ((1.0, Status.OK), (2.3, Status.JUMPED)):
        found, expected = statuses(double_crank(step), np.zeros((1, 0)), Rung(backend))
        assert found == expected == [status]


@both
def test_what_does_not_fit_and_what_a_row_forbids(backend):
    m = Mechanism("bridge")
    a, b = m.link("a", length=1, mass=1), m.link("b", length=1, mass=1)
    m.weld("W1", m.ground, a)
    m.weld("W2", m.ground.at(1, 0), b)
    m.weld("W3", a.tip, b, angle=m.parameter("angle", 0.0, "rad"))
    found, expected = statuses(Scene(m, {}, ("motion",), t=(0, 1, 3)), np.array([[0.0], [math.pi], [0.1]]), Rung(backend))
    assert found == expected == [Status.OK, Status.MISFIT, Status.MISFIT]
    scene = declared(CASES / "sleigh")
    found, expected = statuses(scene, around(scene, 3, spread=0.3), Rung(backend), (*scene.t[:2], 41))
    assert found == expected


def loaded(mechanism, parts):
    """Loads at stations, two of them at one, and one at the very tip."""
    rod, where = parts["b"], mechanism.parameter("where", 0.2, "m")
    mechanism.force("push", rod.at(where), x=30.0, y=-40.0)
    mechanism.force("pull", rod.at(where), y=25.0)
    mechanism.torque("twist", rod.at(0.1), 4.0)
    mechanism.force("end", rod.tip, y=12.0)


DENSITIES = {
    "uniform": lambda: {"mass": 0.7},
    "tapered": lambda: {"density": density.polynomial(4.0, -3.0)},
    "cubic": lambda: {"density": density.polynomial(1.0, 2.0, -4.0, 3.0)},
    "table": lambda: {"density": density.tabulated([0, 0.2, 0.25, 0.9, 1], [1.0, 3.0, 0.5, 0.5, 4.0])},
}


@pytest.mark.parametrize("backend", ["lanes", "c"])
@pytest.mark.parametrize("matter", DENSITIES)
def test_any_density_and_any_station(matter, backend):
    """Along the link exact: nothing on a fine grid is larger, and the peaks are those of the section law."""
    scene = crank_and_rod(DENSITIES[matter](), loads=loaded)
    grid = (0.3, 2.3, 61)
    p = np.array([[0.2], [0.1], [0.35], [0.0], [0.31], [0.36]])
    designs = DesignEngine.of(scene, t=grid, rung=Rung(backend))
    outcome = designs.evaluate(p)
    assert outcome.status.tolist() == [Status.OK] * 5 + [Status.IMPOSSIBLE]
    for row in range(5):
        assert_refined(scene, designs, outcome, row, p[row])
        found = peaks_of(designs, outcome, row)
        for name in ("section:b:axial", "section:b:shear", "section:b:bending"):
            value, t, xi = found[name]
            there = evaluate(scene, parameters=values(scene, p[row]), t=(t, t, 1), xi=(0, 1, 4001), backend="c", certificate=False)
            assert abs(value) >= np.abs(there.array(name)).max() * (1 - 1e-13)
            law = there.section("b").law
            sides = [float(law.at(name.split(":")[2], np.array([[xi]]), side)[0, 0]) for side in ("tip", "base")]
            assert min(abs(value - side) for side in sides) <= 1e-11 * abs(value)


@both
def test_peaks_of_a_turning_pendulum_are_exact(backend):
    """The effort is m g l/2 cos theta; its mean over a whole turn is zero and its rms the peak over the root of two."""
    speed, start, turn = 3.0, 0.1, 2 * math.pi / 3.0
    scene = pendulum(polynomial(start, speed), t=(0, turn, 41))
    designs = DesignEngine.of(scene, rung=Rung(backend))
    outcome = designs.evaluate(np.zeros((1, 0)))
    value, t, _ = peaks_of(designs, outcome, 0)["effort:pin"]
    peak = 1.2 * 9.81 * 0.5 / 2
    assert abs(value) == pytest.approx(peak, rel=1e-13)
    assert (start + speed * t) % math.pi == pytest.approx(0.0, abs=1e-6) or (start + speed * t) % math.pi == pytest.approx(math.pi)
    assert outcome.mean[0, 0] == pytest.approx(0.0, abs=1e-13)
    assert outcome.rms[0, 0] == pytest.approx(peak / math.sqrt(2), rel=1e-13)


@both
def test_of_peaks_as_large_the_first_is_told(backend):
    """Else rounding would choose between tops and troughs of many turns, and the sign with them."""
    designs = DesignEngine.of(pendulum(polynomial(0.1, 3.0), t=(0, 6.0, 91), wanted=["effort"]), rung=Rung(backend))
    value, t, _ = peaks_of(designs, designs.evaluate(np.zeros((1, 0))), 0)["effort:pin"]
    assert value == pytest.approx(-1.2 * 9.81 * 0.25, rel=1e-12)
    assert t == pytest.approx((math.pi - 0.1) / 3.0, abs=1e-6)


@both
@pytest.mark.parametrize("count", [1, 2, 3, 4, 6, 7, 8, 9, 15, 16, 17])
def test_any_number_of_instants(count, backend):
    """The peak of one instant is its own; of two and more the refined one where a rise between them can be told."""
    scene = pendulum(polynomial(0.1, 1.0))
    grid = (0.2, 0.2, 1) if count == 1 else (0.0, 4.0, count)
    designs = DesignEngine.of(scene, t=grid, rung=Rung(backend))
    outcome = designs.evaluate(np.zeros((1, 0)))
    assert outcome.status.tolist() == [Status.OK]
    found = peaks_of(designs, outcome, 0)
    solution = evaluate(scene, t=grid, backend="vm", certificate=False)
    for peak in refine(scene, solution, forces(solution)):
        assert abs(found[peak.name][0]) >= abs(solution.peak(peak.name).value) * (1 - 1e-14)
        if count not in (2, 3):
            assert abs(found[peak.name][0]) == pytest.approx(abs(peak.value), rel=1e-10), peak.name


@both
def test_the_higher_of_two_peaks_is_found_where_the_instants_tell_otherwise(backend):
    scene = pendulum(motion.expression(lobes), t=(0, 3.0, 31), wanted=["motion"])
    designs = DesignEngine.of(scene, rung=Rung(backend))
    value, t, _ = peaks_of(designs, designs.evaluate(np.zeros((1, 0))), 0)["motion:pin"]
    assert t == pytest.approx(2.05, abs=1e-7)
    assert value == pytest.approx(1 + 1e-5, rel=1e-11)


@both
def test_a_kink_and_a_jump(backend):
    """A cubic spline's acceleration is a polygon, whose peak is a knot's; a load that is gone from a radian on peaks there."""
    times = np.linspace(0, 2, 9)
    scene = pendulum(motion.samples(times, np.sin(2.3 * times)), gravity=0.0, t=(0.3, 1.9, 24))
    bends = np.array([float(derive(scene).motion(t, [])[2]) for t in times])
    k = 1 + int(np.argmax(np.abs(bends[1:-1])))
    designs = DesignEngine.of(scene, rung=Rung(backend))
    value, t, _ = peaks_of(designs, designs.evaluate(np.zeros((1, 0))), 0)["effort:pin"]
    assert value == pytest.approx(1.2 * 0.25 / 3 * bends[k], rel=1e-12)
    assert t == pytest.approx(times[k], abs=1e-11)
    scene = pendulum(polynomial(0.0, 2.0), load=lambda angle: 7 * angle * (angle < 1), t=(0, 1, 12))
    designs = DesignEngine.of(scene, rung=Rung(backend))
    value, t, _ = peaks_of(designs, designs.evaluate(np.zeros((1, 0))), 0)["load:push:fx"]
    assert 7 * (1 - 1e-11) < value < 7
    assert 0.5 * (1 - 1e-11) < t < 0.5


@both
def test_two_summits_between_the_same_instants(backend):
    """The higher one is found, though a polynomial through the instants may point at the other."""
    lower, upper = 0.97, 1.04

    def law(t):
        bells = [(1.0, lower, 0.03), (1.1, upper, 0.03), (0.3, 1.0, 0.3)]
        return sum(height * ca.exp(-(((t - place) / width) ** 2)) for height, place, width in bells)

    scene = pendulum(motion.expression(law), t=(0, 2.0, 21), wanted=["motion"])
    fine = evaluate(scene, t=(0.9, 1.1, 200_001), backend="vm", certificate=False).peak("motion:pin")
    designs = DesignEngine.of(scene, rung=Rung(backend))
    value, t, _ = peaks_of(designs, designs.evaluate(np.zeros((1, 0))), 0)["motion:pin"]
    assert value == pytest.approx(fine.value, rel=1e-9)
    assert t == pytest.approx(fine.t, abs=1e-4)


@pytest.mark.parametrize("name", ["slider_crank", "four_bar", "rrr3", "quick_return"])
def test_histories_are_the_series_of_an_evaluation(name):
    scene = declared(CASES / name)
    designs = DesignEngine.of(scene, t=(*scene.t[:2], 41), rung=Rung("c"))
    p = around(scene, 2)
    outcome = designs.evaluate(p, histories=True)
    assert outcome.series.shape == (2, len(designs.columns), 41)
    for row in range(2):
        solution = evaluate(scene, parameters=values(scene, p[row]), t=(*scene.t[:2], 41), backend="c", certificate=False)
        assert set(designs.columns) <= set(solution.series)
        for k, column in enumerate(designs.columns):
            assert outcome.series[row, k].tobytes() == solution.series[column].tobytes(), column
    p[:, list(designs.parameters).index("number0")] = math.nan
    assert np.isnan(designs.evaluate(p, histories=True).series).all()
    assert designs.evaluate(p).series is None


def test_a_speed_that_is_a_parameter_keeps_its_phase():
    """Where parameters set how far a drive turns, its turns are counted in pairs, whatever the defaults."""
    m = Mechanism("fast")
    speed = m.parameter("speed", 1.0, "rad/s")
    m.revolute("pin", m.ground, m.link("arm", length=0.5, mass=1.2))
    scene = Scene(m, {"pin": motion.expression(lambda t: speed * t)}, t=(1.0, 1.0 + 1e-7, 41))
    designs = DesignEngine.of(scene, rung=Rung("c"))
    p = np.array([[1.0], [1e8]])
    outcome = designs.evaluate(p, histories=True)
    k = designs.columns.index("effort:pin")
    for row in range(2):
        solution = evaluate(scene, parameters={"speed": p[row, 0]}, backend="c", certificate=False)
        np.testing.assert_allclose(outcome.series[row, k], solution.effort("pin"), rtol=0, atol=1e-14 * 3)


def test_what_is_not_determined_is_left_out():
    scene = parallelogram(pendulum=True)
    designs = DesignEngine.of(scene, rung=Rung("c"))
    assert not [name for name in designs.quantities if name.startswith(("reaction:A", "section:bar"))]
    assert {"effort:hang", "reaction:hang", "section:bob:bending"} <= set(designs.quantities)
    outcome = designs.evaluate(np.zeros((1, 0)))
    assert np.isfinite(outcome.value).all()
    solution = evaluate(scene, backend="c", certificate=False)
    names = ["effort:O", "effort:hang", "reaction:hang:fx", "section:bob:bending"]
    found = peaks_of(designs, outcome, 0)
    for peak in refine(scene, solution, names):
        assert found[peak.name][0] == pytest.approx(peak.value, rel=1e-11)


@pytest.mark.parametrize("name", [*SCENES, "stations", "sleigh"])
def test_emitted_c_is_pedantically_clean(name, tmp_path):
    made = {
        "stations": lambda: crank_and_rod(DENSITIES["table"](), loads=loaded),
        "sleigh": lambda: declared(CASES / "sleigh"),
    }
    scene = {**SCENES, **made}[name]()
    compiler, source = codegen.find_compiler(), tmp_path / "designs.c"
    for rung in (Rung(), Rung(newton=2), Rung(precision="single")):
        graph = derive(scene, iterate=rung.newton is not None)
        stages, kept = stages_of(graph, rung, np.linspace(*scene.t)), Kept.of(graph, rung.precision)
        source.write_text(codegen.emit_designs(graph, stages, rung.newton, kept.plan))
        command = [*compiler.command, *PEDANTIC, "-fsyntax-only", source]
        result = subprocess.run(command, capture_output=True, text=True, check=False)
        assert result.returncode == 0, result.stderr


def test_names_and_units_go_together():
    designs = DesignEngine.of(slider_crank(), ["reaction:guide", "effort", "section:rod"])
    assert designs.quantities == (
        *("effort:O", "reaction:guide", "reaction:guide:fx", "reaction:guide:fy"),
        *("section:rod:axial", "section:rod:shear", "section:rod:bending"),
    )
    assert designs.units == ("N m", "N", "N", "N", "N", "N", "N m")
    assert (designs.efforts, designs.parameters) == (("effort:O",), ("r", "l", "m1", "m2", "m3"))


def test_misuse_is_named():
    scene = four_bar()
    with pytest.raises(DeclarationError, match="not read from a table"):
        DesignEngine.of(scene, rung=Rung(table=64))
    with pytest.raises(DeclarationError, match=r"expected an array of shape \(n, 0\), got \(3,\)"):
        DesignEngine.of(scene).evaluate(np.zeros(3))
    with pytest.raises(DeclarationError, match="samples of the motion"):
        DesignEngine.of(pendulum(motion.samples([0, 1, 2, 3], [0, 1, 0, 2]), t=(0, 1, 3)), t=(0, 4, 3))
    empty = DesignEngine.of(scene).evaluate(np.zeros((0, 0)))
    assert empty.value.shape == (0, len(DesignEngine.of(scene).quantities))
    with pytest.raises(AssemblyError):
        evaluate(slider_crank(), parameters={"l": 0.05})
