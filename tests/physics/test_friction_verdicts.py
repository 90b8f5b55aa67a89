"""Where friction has no result, or no one result: jams, rest, reversals; the same for values,
designs and exported C.
"""

import math

import casadi as ca
import numpy as np
import pytest
from compiled import told
from internals import (
    DesignEngine,
    EvaluationMethod,
    Film,
    Status,
    check,
    check_sweep,
    load,
    write_animation,
)
from internals import runs_save as save

from lagrange_casadi import Mechanism, Scene, evaluate, export, prepare, refine, sweep
from lagrange_casadi.errors import AssemblyError
from lagrange_casadi.motion import expression, harmonic, polynomial

WEIGHT, ARM = 50.0, 0.2
every = pytest.mark.parametrize("backend", ["lanes", "c", "vm"])


def pushed_beside():
    """A block on a guide, pushed along it at an arm: it locks where the guide is shorter than 2 mu
    times the arm.
    """
    m = Mechanism("drawer")
    mu, length = m.parameter("mu", 0.2), m.parameter("length", 0.1, "m")
    block = m.link("block", length=0.3, mass=2.0)
    pusher = m.link("pusher", length=0.1, mass=0.0)
    m.set_gravity(0.0, 0.0)
    m.prismatic("O", m.ground.at(0.0, ARM), pusher, axis=(1, 0))
    guide = m.prismatic("guide", m.ground, block, axis=(1, 0))
    m.slot("hand", pusher, block.at(0.0, ARM), axis=(0, 1))
    m.force("load", block, x=-WEIGHT)
    m.friction("rub", guide, mu=mu, length=length)
    return Scene(m, {"O": polynomial(0.0, 0.5)}, t=(0, 0.1, 9))


@every
def test_a_drawer_pushed_beside_its_guide(backend):
    """F = W/(1 - 2 mu e/b) closed form; without end where b comes to 2 mu e, and none beyond."""
    scene = pushed_beside()
    for mu, length in ((0.2, 0.1), (0.2, 0.081), (0.35, 0.9), (0.0, 0.01)):
        solution = evaluate(scene, parameters={"mu": mu, "length": length}, backend=backend)
        assert solution.certified
        force = WEIGHT / (1 - 2 * mu * ARM / length)
        assert solution.effort("O") == pytest.approx(force, rel=1e-12 / (1 - 2 * mu * ARM / length))
        assert solution.series["friction:rub:along"] == pytest.approx(
            WEIGHT - force, rel=1e-10, abs=1e-12
        )
        assert solution.series["friction:rub:loss"] == pytest.approx(
            0.5 * (force - WEIGHT), rel=1e-10, abs=1e-12
        )
    for length in (0.08, 0.0799999, 0.05):
        with pytest.raises(
            AssemblyError, match=r"friction 'rub': the mechanism jams at t = 0 s, where O = 0 m: "
        ):
            evaluate(scene, parameters={"length": length}, backend=backend)


@every
def test_designs_that_jam_have_their_status(backend):
    designs = DesignEngine.of(pushed_beside(), method=EvaluationMethod(backend))
    p = np.array([[0.2, 0.1], [0.2, 0.08], [0.2, 0.05], [0.1, 0.05]])
    found = designs.evaluate(p)
    assert found.status.tolist() == [Status.OK, Status.JAMS, Status.JAMS, Status.OK]
    forces = found.value[:, [str(name) for name in designs.kept.quantities].index("effort:O")]
    assert forces[[0, 3]] == pytest.approx([WEIGHT / (1 - 0.8), WEIGHT / (1 - 0.8)], rel=1e-11)
    assert np.isnan(forces[1:3]).all()


SHORT = """
  parameters.length = %s;
  status = @_prepare(&model, &parameters);
  status = @_motion(&model, 0.05, &inputs);
  status = @_evaluate(&model, &inputs, &outputs);
"""


def test_exported_c_refuses_a_jam(tmp_path):
    made = export(pushed_beside(), tmp_path)
    (status, force, _), (jams, _, sentence) = told(tmp_path, made, SHORT % "0.1", SHORT % "0.05")
    assert (status, force) == (0, pytest.approx(WEIGHT / (1 - 0.8), rel=1e-5))
    assert jams != 0
    assert sentence == Status.JAMS.meaning


def reciprocating(motion, **options):
    m = Mechanism("reciprocating")
    mu = m.parameter("mu", 0.15)
    crank, rod = m.link("crank", length=0.1, mass=0.8), m.link("rod", length=0.25, mass=1.1)
    piston = m.link("piston", length=0.05, mass=0.6, centre=(0.0, 0.0), inertia=1e-4)
    m.revolute("O", m.ground, crank)
    m.revolute("A", crank.tip, rod)
    wrist = m.revolute("B", rod.tip, piston)
    bore = m.prismatic("bore", m.ground, piston, axis=(1, 0))
    m.force("gas", piston, x=-900.0)
    m.friction("ring", bore, mu=mu, length=0.06)
    m.friction("pin", wrist, mu=mu, radius=0.01)
    return Scene(m, {"O": motion}, posture={"rod": 0.0}, **options)


TURN = 2 * math.pi / 30.0


@every
def test_at_a_dead_centre_the_sign_is_that_of_the_instants_right_after(backend):
    """The end of a stroke is an instant among others: it has the values right after, on either side
    of the stroke.
    """
    scene = reciprocating(polynomial(0.0, 30.0), t=(0, TURN, 9))
    solution, after = (
        evaluate(scene, backend=backend, t=t) for t in ((0, TURN, 9), (1e-11, TURN + 1e-11, 9))
    )
    assert solution.certified
    assert not solution.resting.any()
    assert solution.motion("bore").rate[[0, 4, 8]] == pytest.approx(0.0, abs=1e-12)
    ring = solution.series["friction:ring:along"]
    assert ring == pytest.approx(after.series["friction:ring:along"], rel=1e-6)
    assert solution.effort("O") == pytest.approx(after.effort("O"), rel=1e-6, abs=1e-6)
    assert ring[0] > 0.0 > ring[4]


@pytest.mark.sampled(3)
@every
def test_where_the_drive_itself_turns_back_too(backend):
    """Its rate there is what rounding leaves of a cosine, of any sign."""
    law = harmonic(0.4, 0.3, 5.0, 0.1)
    t = [(math.pi * (0.5 + k) - 0.1) / (2 * math.pi * 5.0) for k in range(8)]
    for at in t:
        scene = reciprocating(law, t=(at, at + 1.0, 2))
        solution, after = (
            evaluate(scene, backend=backend, t=(one, one + 1.0, 2)) for one in (at, at + 1e-9)
        )
        assert abs(solution.motion("O").rate[0]) < 1e-12
        for name in ("friction:ring:along", "friction:pin:along", "effort:O"):
            assert solution.array(name)[0] == pytest.approx(after.array(name)[0], rel=1e-6)


def start_and_stop(t):
    """From rest to rest in half a second, then at rest."""
    u = ca.fmin(t / 0.5, 1.0)
    return 0.3 + 10 * u**3 - 15 * u**4 + 6 * u**5


@pytest.mark.sampled(4)
@pytest.mark.parametrize(
    "options", [{"backend": "lanes"}, {"backend": "c"}, {"backend": "vm"}, {"precision": "single"}]
)
def test_at_rest_friction_is_open_and_all_else_is_not(options, tmp_path):
    scene = reciprocating(expression(start_and_stop), t=(0, 1, 41))
    solution = evaluate(scene, **options)
    resting = solution.t >= 0.5
    resting[0] = True
    assert solution.resting.tolist() == resting.tolist()
    assert solution.certified
    for name in (
        "effort:O",
        "friction:ring:along",
        "friction:pin:loss",
        "reaction:bore:fy",
        "load:pin:mz",
    ):
        assert np.isnan(solution.array(name)[resting]).all(), name
        assert np.isfinite(solution.array(name)[~resting]).all(), name
        assert np.isfinite(solution.peak(name).value), name
    assert np.isfinite(solution.motion("bore").value).all()
    assert np.isfinite(solution.series["load:gas:fx"]).all()
    note, held = solution.notes
    assert held.startswith("held at rest: effort:O may be anything from")
    assert note.startswith(
        "a joint with friction is at rest at 22 of 41 instants, first at t = 0 s"
    )
    assert "ring, pin" in note
    save(solution, tmp_path / "rest.h5")
    assert check(tmp_path / "rest.h5") == []
    assert load(tmp_path / "rest.h5").resting.tolist() == resting.tolist()
    solution.report(tmp_path / "rest.html")
    assert "friction:ring:loss" in (tmp_path / "rest.html").read_text()
    write_animation(solution, tmp_path / "rest.svg", Film(forces=True, section="bending"))
    assert "nan" not in (tmp_path / "rest.svg").read_text().lower()


@pytest.mark.parametrize("backend", ["lanes", "vm", pytest.param("c", marks=pytest.mark.long)])
def test_peaks_and_means_of_a_design_are_those_of_the_instants_that_move(backend):
    """As a run tells them, between the instants too; what is at rest throughout has none, and what
    does not rub has all.
    """
    scene = reciprocating(
        expression(start_and_stop), t=(0, 1, 41), wanted=["effort", "motion", "section:rod"]
    )
    designs = DesignEngine.of(scene, method=EvaluationMethod(backend))
    found = designs.evaluate(np.array([[0.1]]))
    assert found.status.tolist() == [Status.OK]
    alone = evaluate(scene, parameters={"mu": 0.1}, backend="vm")
    names = [name for name in designs.quantities if not name.startswith("section")]
    for peak in refine(scene, alone, [*names, "section:rod:axial"]):
        k = designs.quantities.index(peak.name)
        assert abs(found.value[0, k]) == pytest.approx(abs(peak.value), rel=1e-9, abs=1e-12), (
            peak.name
        )
        assert abs(peak.value) >= abs(alone.peak(peak.name).value) * (1 - 1e-12), peak.name
    effort = alone.statistics("effort:O")
    moving = alone.effort("O")[~alone.resting]
    assert (effort.smallest.value, effort.largest.value) == (moving.min(), moving.max())
    assert effort.mean == pytest.approx(np.trapezoid(moving) / (moving.size - 1), rel=1e-12)
    assert found.mean[0, 0] == pytest.approx(effort.mean, rel=1e-9)
    assert found.rms[0, 0] == pytest.approx(effort.rms, rel=1e-9)
    designs_at_rest = DesignEngine.of(
        scene, t=(0.6, 0.9, 21), method=EvaluationMethod(backend)
    ).evaluate(np.array([[0.1]]))
    assert designs_at_rest.status.tolist() == [Status.OK]
    assert np.isnan(designs_at_rest.value[0, designs.quantities.index("effort:O")])
    assert np.isfinite(designs_at_rest.value[0, designs.quantities.index("motion:O")])
    assert np.isnan(designs_at_rest.mean).all()


@pytest.mark.sampled(3)
@every
def test_prepared_scenes_and_designs_tell_the_series_of_what_comes_to_rest(backend):
    """As a single evaluation does: numbers where it moves, none where it rests."""
    scene = reciprocating(expression(start_and_stop), t=(0, 1, 41), wanted=["effort", "motion"])
    alone = evaluate(scene, parameters={"mu": 0.1}, backend=backend)
    ready = prepare(scene, backend=backend)
    series = ready(mu=0.1)
    for name in ("effort:O", "motion:bore"):
        assert series[name].tolist() == pytest.approx(
            alone.array(name).tolist(), rel=1e-12, abs=1e-12, nan_ok=True
        )
    assert np.isnan(series["effort:O"]).tolist() == alone.resting.tolist()
    found = ready.designs(np.array([[0.1], [0.2]]), histories=True)
    assert found.status.tolist() == [Status.OK, Status.OK]
    assert np.isfinite(found.value).all()
    effort = found.series[0, ready.outputs.index("effort:O")]
    assert effort.tolist() == pytest.approx(series["effort:O"].tolist(), nan_ok=True)
    assert ready.peaks(mu=0.1).value == pytest.approx(found.value[0], rel=1e-12)


def test_a_sweep_keeps_the_histories_of_what_comes_to_rest(tmp_path):
    scene = reciprocating(
        expression(start_and_stop), t=(0, 1, 21), wanted=["effort", "section:rod"]
    )
    found = sweep(
        scene,
        {"mu": [0.1, 0.2]},
        keep="histories",
        xi=(0, 1, 2),
        out=tmp_path / "rest.h5",
        backend="vm",
    )
    assert check_sweep(tmp_path / "rest.h5") == []
    assert found["status"].tolist() == [Status.OK] * 2
    for name in ("effort:O", "section:rod:axial"):
        moving = np.isfinite(found[f"history:{name}"]).reshape(2, 21, -1)
        assert moving[:, 1:10].all()
        assert not moving[:, 10:].any()
        assert np.isfinite(found[f"peak:{name}"]).all()
    assert np.isfinite(found["peak_at:section:rod:axial"]).all()


@every
def test_a_jam_is_told_before_rest(backend):
    """Whichever comes first: at rest a design has a series, and in a jam it has none."""
    scene = pushed_beside()
    scene = Scene(
        scene.mechanism,
        {"O": expression(lambda t: 0.1 * ca.fmax(t - 0.05, 0.0) ** 3)},
        t=(0, 0.1, 9),
    )
    designs = DesignEngine.of(scene, method=EvaluationMethod(backend))
    found = designs.evaluate(np.array([[0.2, 0.1], [0.2, 0.05]]), histories=True)
    assert found.status.tolist() == [Status.OK, Status.JAMS]
    assert np.isfinite(found.series[0]).any()
    assert np.isnan(found.series[1]).all()


def test_what_never_moves_is_open_and_what_bears_nothing_does_not_rub():
    """A bar held by two guides beside a crank that turns; and a weightless tongue that follows it
    in a slot.
    """
    m = Mechanism("held")
    crank = m.link("crank", length=0.1, mass=1.0)
    bar = m.link("bar", length=0.4, mass=1.0)
    block = m.link("block", length=0.1, mass=1.0)
    m.friction("drive", m.revolute("O", m.ground, crank), mu=0.1, radius=0.01)
    m.prismatic("one", m.ground.at(0.5, 0.0), bar, axis=(1, 0))
    m.friction("pin", m.revolute("P", bar.tip, block), mu=0.1, radius=0.01)
    m.friction(
        "held", m.prismatic("two", m.ground.at(0.9, 0.0), block, axis=(0, 1)), mu=0.1, length=0.05
    )
    tongue = m.link("tongue", length=0.5, mass=0.0)
    m.revolute("Q", crank.tip, tongue)
    m.friction("tip", m.slot("S", m.ground.at(0.0, -0.2), tongue.at(0.4), axis=(1, 0)), mu=0.1)
    solution = evaluate(
        Scene(m, {"O": polynomial(0.2, 3.0)}, t=(0, 0.2, 5), posture={"tongue": -1.0}), backend="vm"
    )
    assert solution.certified
    assert np.isnan(solution.series["friction:pin:along"]).all()
    assert np.isnan(solution.series["friction:held:along"]).all()
    assert solution.series["friction:tip:along"].tolist() == [0.0] * 5
    assert np.isfinite(solution.effort("O")).all()
    assert solution.resting.all()
    note = next(note for note in solution.notes if note.startswith("a joint with friction"))
    assert "pin, held" in note or "held, pin" in note


def test_what_friction_does_not_reach_is_told_at_rest_too():
    """A crank alone rubs: the rod's forces know nothing of it."""
    m = Mechanism("free_end")
    arm, other = m.link("arm", length=0.3, mass=1.0), m.link("other", length=0.2, mass=0.5)
    first, second = m.revolute("O", m.ground, arm), m.revolute("P", arm.tip, other)
    m.friction("rub", first, mu=0.1, radius=0.02)
    scene = Scene(m, {"O": polynomial(0.4), "P": polynomial(0.1, 2.0)}, t=(0, 1, 5))
    solution = evaluate(scene)
    assert second.name == "P"
    assert np.isnan(solution.effort("O")).all()
    assert np.isfinite(solution.effort("P")).all()
    assert np.isfinite(solution.reaction("O").fy).all()
    assert solution.certified


def test_smoothed_friction_passes_through_rest():
    m = Mechanism("smooth")
    arm = m.link("arm", length=0.3, mass=1.0)
    m.friction("rub", m.revolute("O", m.ground, arm), mu=0.1, radius=0.02, smooth=0.5)
    scene = Scene(m, {"O": expression(start_and_stop)}, t=(0, 1, 41))
    solution = evaluate(scene)
    assert solution.certified
    rate = solution.motion("O").rate
    size = 0.1 * 0.02 * np.hypot(solution.reaction("O").fx, solution.reaction("O").fy)
    assert solution.series["friction:rub:along"] == pytest.approx(
        -np.tanh(rate / 0.5) * size, abs=1e-15
    )


def test_peaks_beside_a_reversal_are_found():
    """The largest effort of a cycle is just before the friction turns
    round, between two instants.
    """
    scene = reciprocating(polynomial(0.05, 30.0), t=(0, TURN, 62))
    solution = evaluate(scene, backend="vm")
    dense = evaluate(scene, t=(0, TURN, 20001), certificate=False)
    names = [
        "effort:O",
        "friction:ring:along",
        "friction:ring:loss",
        "section:rod:axial",
        "reaction:bore:resultant",
    ]
    found = refine(scene, solution, names)
    designs = DesignEngine.of(scene, method=EvaluationMethod("c"))
    row = designs.evaluate(np.array([[0.15]])).value[0]
    swept = dict(zip(map(str, designs.kept.quantities), row, strict=True))
    for peak in found:
        sampled = abs(dense.peak(peak.name).value)
        assert sampled * (1 - 1e-12) <= abs(peak.value) <= sampled * (1 + 1e-3), peak
        assert swept[peak.name] == pytest.approx(peak.value, rel=1e-7), peak


def test_where_the_drive_itself_turns_back_the_sign_is_that_of_its_acceleration():
    """Its rate is then some rounding beside zero, of either sign, and so are all others."""
    m = Mechanism("swing")
    m.set_gravity(0, 0)
    arm = m.link("arm", length=0.5, mass=2.0)
    m.friction("rub", m.revolute("O", m.ground, arm), mu=0.1, radius=0.02)
    m.force("pull", arm.base, x=100.0)
    top = 0.25 - 0.4 / math.tau
    solution = evaluate(
        Scene(m, {"O": harmonic(0.3, 1.0, 1.0, 0.4)}, t=(top, top + 8.0, 17)), backend="vm"
    )
    assert solution.certified
    assert np.abs(solution.motion("O").rate).max() < 1e-12
    found = solution.series["friction:rub:along"]
    assert np.sign(found).tolist() == np.sign(-solution.motion("O").acceleration).tolist()
    assert np.abs(found).min() > 0.1
