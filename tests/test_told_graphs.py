"""What least strain energy tells within the graphs of sweeps, prepared scenes and exported C, against one instant after another."""

import subprocess

import casadi as ca
import numpy as np
import pytest
from elastic_mechanisms import four_bar, made, three_cranks

from lagrange_casadi import Mechanism, Scene, beams, derive, evaluate, export, prepare, sweep
from lagrange_casadi.base.quantities import Output
from lagrange_casadi.equations import least_work
from lagrange_casadi.equations.checks import Check
from lagrange_casadi.errors import DeclarationError
from lagrange_casadi.instants.backends import run
from lagrange_casadi.instants.determinacy import determinate, undetermined
from lagrange_casadi.instants.rung import Rung
from lagrange_casadi.motion import harmonic, polynomial

ROUND, BAR = beams.round_bar(0.01), beams.rectangle(0.02, 0.01)


def moving():
    return Scene(four_bar(), {"O": polynomial(0.2, 30.0, 40.0)}, posture={"A": 0.5, "C": 1.5}, t=(0, 8e-3, 5), elastic=True)


def cranks(elastic=True):
    """Three cranks on one bar, whose outer one may be of any thickness."""
    m = Mechanism("cranks")
    d = m.parameter("d", 0.01, "m", low=0.0)
    bar = m.link("bar", length=1.0, beam=made(BAR))
    for k, place in enumerate((bar.base, bar.at(0.5), bar.tip)):
        crank = m.link(f"c{k}", length=0.2, beam=made(beams.round_bar(d) if k else ROUND))
        m.revolute(f"G{k}", m.ground.at(0.5 * k, 0.0), crank)
        m.revolute(f"B{k}", crank.tip, place)
    posture = {"c0": 1.2, "c1": 1.2, "c2": 1.2, "bar": 0.0}
    return Scene(m, {"G0": harmonic(1.2, 0.3, 1.0)}, posture=posture, t=(0, 1, 33), elastic=elastic)


def stepped():
    """A beam held at both ends, one half of which may be of any height."""
    m = Mechanism("stepped")
    h = m.parameter("h", 0.05, "m", low=0.0)
    shape = beams.stepped([0.5], [beams.rectangle(h, 0.02), beams.rectangle(0.04, 0.02)])
    bar = m.link("bar", length=2.0, beam=made(shape))
    m.weld("A", m.ground, bar)
    m.weld("B", m.ground.at(2.0, 0), bar.tip)
    m.force("push", bar.at(0.6), x=500.0, y=-1000.0)
    return Scene(m, {}, t=(0, 0, 1), elastic=True)


SCENES = {
    "stepped": stepped,
    "cranks": lambda: three_cranks(made(ROUND), made(beams.tapered(BAR, beams.rectangle(0.012, 0.008)))),
    "named": lambda: three_cranks(made(ROUND), elastic=["a", "b", "c"]),
    "in space": moving,
}


@pytest.mark.sampled(4)
@pytest.mark.parametrize("name", SCENES)
def test_graphs_tell_what_is_told_instant_after_instant(name):
    """The least of squares by singular values on numbers, and the gradient of the energy as an expression."""
    scene = SCENES[name]()
    solution = evaluate(scene, backend="vm", certificate=False)
    assert solution.elasticity.told
    graph = derive(scene, ["all"])
    p = np.array(list(scene.mechanism.values().values()))
    found, _ = run(graph, solution.t, p, Rung("vm"))
    assert not undetermined(graph, found.out, p, Rung())
    sizes = {}
    for output, values in solution.outputs.items():
        unit = solution.unit(output)
        sizes[unit] = max(sizes.get(unit, 0.0), np.abs(values).max())
    for output, k in graph.outputs.items():
        size = sizes[solution.unit(output)]
        np.testing.assert_allclose(found.out[k], solution.outputs[output], atol=1e-11 * size, err_msg=str(output))


def test_only_what_is_wanted_is_in_the_graph():
    graph = derive(stepped(), ["reaction:A"])
    assert {str(output) for output in graph.outputs} == {"reaction:A:fx", "reaction:A:fy", "reaction:A:mz"}


STRENGTH = {"stress:bar": "stress:bar:von_mises", "deflection:bar": "deflection:bar:across"}


@pytest.mark.parametrize("strength", [(), pytest.param(tuple(STRENGTH), marks=pytest.mark.long)])
def test_derivatives_of_what_is_told_by_parameters(strength):
    """Stiffness has a share in them: against differences of solutions."""
    scene, step = stepped(), 1e-7
    wanted = ["reaction:A", "section:bar", *strength]
    solution = evaluate(scene, wanted=[*wanted, "sensitivity:h"], backend="vm")
    assert solution.certified
    ends = [evaluate(scene, wanted=wanted, parameters={"h": 0.05 + way * step}, backend="vm") for way in (1, -1)]
    series = ["reaction:A:fx", "reaction:A:fy", "reaction:A:mz", *(STRENGTH[name] for name in strength)]
    quantities = set(map(str, solution.sensitivities.quantities))
    assert quantities == {*series, *(f"section:bar:{force}" for force in ("axial", "shear", "bending"))}
    for name in series:
        difference = (ends[0].array(name) - ends[1].array(name)) / (2 * step)
        assert solution.sensitivities.array(name, "h") == pytest.approx(difference, rel=1e-6)
    if strength:
        found = [np.abs(solution.array(name)) for name in STRENGTH.values()]
        exact = [np.abs(x) for x in (solution.stress("bar").largest("von_mises").value, solution.deflection("bar").largest()[0])]
        np.testing.assert_allclose(found, exact, rtol=1e-9)


def test_where_the_energy_is_flat_forces_are_open():
    free, t = ca.SX.sym("free", 1), ca.SX.sym("t")
    loose, held = Output("reaction", "A", "fx"), Output("reaction", "A", "fy")
    columns = least_work.Told(ca.SX(2.0), t > 0.5).completed({loose: 3.0 * free + t, held: t}, free)
    assert list(columns) == [loose, held, Check("open", loose)]
    values = ca.Function("f", [t], [ca.vertcat(*columns.values())])(np.array([[0.25, 0.75]])).full()
    np.testing.assert_array_equal(values, [[6.25, 6.75], [0.25, 0.75], [0.0, 3.0]])


def test_forces_through_a_link_without_a_beam_stay_open():
    scene, plain = (three_cranks(made(ROUND), elastic=elastic) for elastic in (True, False))
    graph = derive(scene, ["all"])
    p = np.zeros(0)
    _, left_open = determinate(graph, np.array([0.0, 0.3]), p)
    _, before = determinate(derive(plain, ["all"]), np.array([0.0, 0.3]), p)
    assert set(left_open) == set(before)
    assert Output("reaction", "B1", "fy") in left_open


def test_friction_that_follows_what_is_open_is_refused():
    m = Mechanism("guides")
    bar = m.link("bar", length=1.0, beam=made(beams.round_bar(0.02)))
    joint = m.prismatic("G1", m.ground, bar, axis=(1, 0))
    m.prismatic("G2", m.ground.at(1, 0), bar.tip, axis=(1, 0))
    m.friction("rub", joint, mu=0.1, length=0.1)
    with pytest.raises(DeclarationError, match="friction 'rub' follows a reaction that equilibrium leaves open"):
        derive(Scene(m, {"G1": polynomial(0.0, 1.0, 0.5)}, t=(0, 1, 3), elastic=True))


@pytest.mark.long
def test_sweeps_tell_it():
    """Peaks between instants, of a stress and a deflection too; designs are certified."""
    scene = cranks()
    found = sweep(scene, {"d": [0.006, 0.01]}, wanted=["reaction", "stress:c1", "deflection:bar"])
    assert not found.undetermined
    assert found["status"].tolist() == [0, 0]
    for i, d in enumerate((0.006, 0.01)):
        fine = evaluate(scene, parameters={"d": d}, t=(0, 1, 513), wanted=["all"], backend="vm", certificate=False)
        assert abs(found["peak:reaction:B1:fy"][i]) == pytest.approx(np.abs(fine.reaction("B1").fy).max(), rel=1e-5)
        assert found["peak:stress:c1:von_mises"][i] == pytest.approx(fine.stress("c1").peak("von_mises").value, rel=1e-5)
        assert found["peak:deflection:bar:across"][i] == pytest.approx(abs(fine.deflection("bar").peak().value), rel=1e-5)


@pytest.mark.long
def test_gradients_of_peaks_and_exported_c(tmp_path):
    scene = cranks()
    f = prepare(scene, wanted=["reaction:B1"])
    k = f.quantities.index("reaction:B1:fy")
    ends = [f.peaks({"d": 0.01 + way * 1e-6}).value[k].copy() for way in (1, -1)]
    assert f.gradient({"d": 0.01})["reaction:B1:fy"]["d"] == pytest.approx((ends[0] - ends[1]) / 2e-6, rel=1e-5)
    for precision in ("double", "single"):
        export(scene, tmp_path / precision, wanted=["reaction:B1", "section:bar", "deflection:bar"], precision=precision)
        build = tmp_path / precision / "build"
        for command in (
            ["cmake", "-S", tmp_path / precision, "-B", build],
            ["cmake", "--build", build],
            ["ctest", "--test-dir", build],
        ):
            done = subprocess.run(command, capture_output=True, text=True)
            assert done.returncode == 0, done.stdout + done.stderr
        assert "reaction_B1_fy" in (tmp_path / precision / "cranks.h").read_text()
