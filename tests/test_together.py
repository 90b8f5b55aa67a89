"""What each feature does is tested beside it; here all meet in one machine, in the plane and in
space, and go all ways.
"""

import numpy as np
import pytest
from exported import by_c99, compare, expected, exported, instants, solve
from internals import Film, check, write_animation

from lagrange_casadi import (
    Mechanism,
    Scene,
    SpatialMechanism,
    beams,
    density,
    evaluate,
    load,
    prepare,
    refine,
    save,
    sensitivities,
    shaking,
    sweep,
)
from lagrange_casadi.motion import harmonic, polynomial

STEEL = beams.material("C45+QT").but(endurance=220e6)
PARAMETERS = {"l": 0.4, "mu": 0.1, "d": 0.02}


def plane():
    """A slider-crank of a tapered rod: friction in all joints, wind along the rod, an output inside
    it, its shaking force.
    """
    m = Mechanism("together")
    l, mu, d = (
        m.parameter("l", 0.4, "m", low=0.2),
        m.parameter("mu", 0.1, low=0.0),
        m.parameter("d", 0.02, "m", low=0.005),
    )
    shape = beams.tapered(beams.rectangle(d, 0.012), beams.rectangle(0.6 * d, 0.012))
    crank = m.link("crank", length=0.1, mass=1.0)
    rod = m.link(
        "rod", length=l, beam=beams.Beam(shape, STEEL, notches=[beams.Notch(0.5, bending=1.5)])
    )
    piston = m.link("piston", length=0.06, mass=0.5, centre=(0.0, 0.0), inertia=4e-4)
    m.friction("main", m.revolute("O", m.ground, crank), mu=0.05, radius=0.02)
    m.friction("big_end", m.revolute("A", crank.tip, rod), mu=mu, radius=0.018, viscous=1e-3)
    m.friction("pin", m.revolute("B", rod.tip, piston), mu=mu, radius=0.01)
    guide = m.prismatic("bore", m.ground, piston, axis=(1, 0))
    m.friction("rings", guide, mu=mu, length=0.05, static=0.2, stribeck=0.05)
    m.line_load("wind", rod, y=(30.0, 60.0), between=(0.1, 0.25))
    m.force("gas", piston, x=-200.0)
    m.output("inside", m.results.section(rod, 0.4).bending, unit="N m")
    shaking(m)
    return Scene(
        m, {"O": polynomial(0.1, 60.0)}, t=(0, 0.1, 31), posture={"rod": 0.0}, xi=(0, 1, 8)
    )


def space():
    """One in space that rubs, of a thick crank and a tube, with a spring, wind, outputs inside and
    its shaking force.
    """
    m = SpatialMechanism("together_in_space")
    l, mu, d = (
        m.parameter("l", 0.4, "m", low=0.2),
        m.parameter("mu", 0.1, low=0.0),
        m.parameter("d", 0.02, "m", low=0.005),
    )
    thick = density.thick(density.polynomial(8.0, 2.0), yy=1e-3, zz=density.polynomial(1e-3, 1e-4))
    crank = m.link("crank", length=0.1, density=thick)
    rod = m.link("rod", length=l, beam=beams.Beam(beams.tube(d, 0.003), STEEL))
    slider = m.link(
        "slider", length=0.06, mass=0.5, centre=(0.0, 0.0, 0.01), inertia=(1e-4, 2e-4, 2e-4)
    )
    O = m.revolute("O", m.ground.at(0.0, 0.02, 0.03), crank, axis=(0.1, 0.3, 1))
    m.spherical("A", crank.tip, rod)
    m.universal("B", slider, rod.tip, axis=(0, 0, 1), second=(0, 1, 0))
    m.prismatic("G", m.ground, slider, axis=(1, 0, 0.1))
    m.friction("main", O, mu=mu, radius=0.02, length=0.05)
    m.line_load("wind", rod, y=(30.0, 60.0), z=5.0, between=(0.1, 0.25))
    m.spring("coil", m.ground.at(0.5, 0, 0.1), slider, stiffness=200.0, length=0.1)
    m.force("gas", slider, x=-200.0)
    m.output(
        "inside",
        m.results.section(rod, 0.4).bending_y + m.results.section(crank, 0.3).torsion,
        unit="N m",
    )
    shaking(m)
    rough = {"G": 0.4, "B:turn_1": 0.1, "B:turn_2": 0.1}
    return Scene(m, {"O": harmonic(0.1, 2.0, 5.0)}, t=(0, 0.2, 31), posture=rough, xi=(0, 1, 8))


WANTED = ["effort", "output", "section:rod"]
SCENES = {"plane": plane, "space": space}


@pytest.fixture(scope="module", params=SCENES)
def both(request):
    scene = SCENES[request.param]()
    return scene, evaluate(scene, backend="vm")


def sizes(solution):
    """The largest of each unit."""
    found = {}
    for name in solution.names():
        found[solution.unit(name)] = max(
            found.get(solution.unit(name), 0.0), np.nanmax(np.abs(solution.array(name)))
        )
    return found


def agree(found, told, share):
    assert list(found.names()) == list(told.names())
    largest = sizes(told)
    for name in told.names():
        gap = np.abs(found.array(name) - told.array(name)).max()
        assert gap <= share * largest[told.unit(name)], (name, gap)


@pytest.mark.sampled(2)
def test_it_is_certified_kept_and_shown(both, tmp_path):
    _, solution = both
    assert solution.certified
    save(solution, tmp_path / "one.h5")
    assert check(tmp_path / "one.h5") == []
    agree(load(tmp_path / "one.h5"), solution, 0.0)
    solution.report(tmp_path / "one.html")
    assert "friction:main:loss" in (tmp_path / "one.html").read_text()
    for end in ("svg", "glb"):
        write_animation(solution, tmp_path / f"one.{end}", Film())
        assert (tmp_path / f"one.{end}").stat().st_size > 1000


@pytest.mark.parametrize(
    ("way", "share"),
    [
        ({"backend": "c"}, 1e-12),
        pytest.param({"backend": "lanes"}, 1e-12, marks=pytest.mark.long),
        pytest.param({"precision": "single"}, 1e-5, marks=pytest.mark.long),
    ],
)
def test_every_way_of_evaluating_agrees(both, way, share):
    scene, solution = both
    agree(evaluate(scene, certificate=False, **way), solution, share)


@pytest.mark.long
def test_series_and_sections_change_as_they_say(both):
    scene, solution = both
    changes, largest = sensitivities(scene, solution, backend="vm"), sizes(solution)
    for parameter, value in PARAMETERS.items():
        step = 1e-4 * value
        moved = {
            k: evaluate(
                scene, parameters={parameter: value + k * step}, backend="vm", certificate=False
            )
            for k in (-2, -1, 1, 2)
        }
        for name in solution.names():
            if ":law:" in name or name.startswith("certificate"):
                continue
            four = {k: one.array(name) for k, one in moved.items()}
            exact = (8 * (four[1] - four[-1]) - (four[2] - four[-2])) / (12 * step)
            size = np.abs(exact).max() + largest[solution.unit(name)] / value
            assert np.abs(changes.array(name, parameter) - exact).max() <= 1e-8 * size, (
                name,
                parameter,
            )


@pytest.mark.long
def test_sweeps_and_prepared_scenes_have_the_peaks_of_solutions(both, tmp_path):
    scene, _ = both
    lengths = np.array([0.36, 0.4, 0.44])
    swept = sweep(scene, {"l": lengths.tolist()}, wanted=WANTED, out=tmp_path / "sweep.h5")
    names = (
        "effort:O",
        "output:inside",
        "section:rod:torsion" if scene.mechanism.space else "section:rod:bending",
    )
    f = prepare(scene, wanted=WANTED)
    for k, l in enumerate(lengths):
        solution = evaluate(scene, parameters={"l": l}, wanted=WANTED, certificate=False)
        peaks = {peak.name: peak.value for peak in refine(scene, solution, names)}
        own = dict(zip(map(str, f.quantities), f.peaks(l=l).value, strict=True))
        for name in names:
            assert swept[f"peak:{name}"][k] == pytest.approx(peaks[name], rel=1e-9)
            assert own[name] == pytest.approx(peaks[name], rel=1e-9)


@pytest.mark.long
def test_exported_c_has_the_numbers_of_the_api(both, tmp_path):
    scene, _ = both
    made, told = exported(scene, tmp_path)
    solution = solve(scene, "double")
    compare(
        by_c99(tmp_path, told, instants(solution.t, "double")),
        expected(scene, told, solution),
        told,
        made,
        solution,
    )
