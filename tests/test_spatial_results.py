"""What follows from the section laws of a spatial scene: its solution and file, peaks between
instants, sweeps, figures, C.
"""

import importlib
import itertools
import subprocess

import h5py
import numpy as np
import pytest
from compiled import cc
from internals import (
    SCHEMA,
    SPACE,
    DesignEngine,
    EvaluationMethod,
    Harvest,
    InstantAxis,
    MechanismDrawing,
    SectionMaps,
    Status,
    check,
    default_figures,
    export,
)
from internals import seal_seal as seal
from spatial_scenes import beams

from lagrange_casadi import Scene, SpatialMechanism, evaluate, load, motion, refine, save

LINKS = ("beam", "taper", "bead")


@pytest.fixture(scope="module")
def scene():
    return beams()


@pytest.fixture(scope="module")
def solution(scene):
    return evaluate(scene, xi=(0, 1, 21), certificate=False)


@pytest.fixture(scope="module")
def dense(scene):
    return evaluate(scene, t=(0, 2, 12_001), xi=(0, 1, 3), certificate=False)


@pytest.fixture(scope="module")
def fine(scene, solution):
    """The peaks between instants by their names."""
    quantities = DesignEngine.of(scene, method=EvaluationMethod("vm")).quantities
    return {
        peak.name: peak
        for peak in refine(scene, solution, [name for name in quantities if "load" not in name])
    }


@pytest.fixture(scope="module")
def half(scene):
    """Far finer instants of half the mass."""
    return evaluate(scene, parameters={"mass": 3.0}, t=(0, 2, 4001), certificate=False)


@pytest.fixture
def no_certificate(monkeypatch):
    """What is tested here is not what is judged: residuals of nothing."""

    def residuals(solution, *_):
        return {name: np.zeros(solution.t.size) for name in ("balance", "power", "closure", "ends")}

    monkeypatch.setattr(
        importlib.import_module("lagrange_casadi.studies.solving"), "residuals_of", residuals
    )


def test_a_solution_names_its_quantities(solution):
    names = set(solution.names())
    assert {f"section:{link}:{force}" for link in LINKS for force in SPACE.forces} <= names
    assert {f"reaction:A:{member}" for member in ("fx", "fy", "fz", "mx", "my", "mz")} <= names
    reaction, section = solution.reaction("A"), solution.section("beam")
    np.testing.assert_allclose(
        solution.array("reaction:A:resultant"),
        np.linalg.norm([reaction.fx, reaction.fy, reaction.fz], axis=0),
    )
    np.testing.assert_allclose(
        solution.array("reaction:A:moment"),
        np.linalg.norm([reaction.mx, reaction.my, reaction.mz], axis=0),
    )
    np.testing.assert_array_equal(reaction.resultant, solution.array("reaction:A:resultant"))
    np.testing.assert_array_equal(reaction.moment, solution.array("reaction:A:moment"))
    np.testing.assert_allclose(
        section.bending, np.hypot(section.bending_y, section.bending_z), rtol=1e-14
    )
    assert solution.unit("section:beam:torsion") == solution.unit("reaction:A:moment") == "N m"
    found = solution.statistics("section:beam:bending")
    assert 0.0 <= found.smallest.value <= np.min(section.bending)
    assert found.largest.value >= np.max(section.bending)


def test_poses_have_axes(scene):
    found = evaluate(scene, wanted=["motion"], certificate=False)
    pose = found.pose("bead")
    assert pose.angle is None
    assert pose.axes.shape == (61, 3, 3)
    np.testing.assert_allclose(
        pose.axes @ np.swapaxes(pose.axes, 1, 2), np.broadcast_to(np.eye(3), (61, 3, 3)), atol=1e-14
    )
    np.testing.assert_array_equal(pose.axes[:, 2, 0], found.array("pose:bead:zx"))
    np.testing.assert_array_equal(pose.z, found.array("pose:bead:z"))


def test_a_file_says_what_it_is_and_is_read_back(solution, tmp_path):
    save(solution, tmp_path / "beams.h5")
    assert check(tmp_path / "beams.h5") == []
    again = load(tmp_path / "beams.h5")
    assert list(again.series) == list(solution.series)
    for name in solution.names():
        assert again.array(name).tobytes() == solution.array(name).tobytes(), name
    with h5py.File(tmp_path / "beams.h5") as file:
        assert file.attrs["schema_version"] == 4
        assert file.attrs["conventions"] == SPACE.conventions
        assert file["section/beam/shear"].attrs["sign"] == "never negative"
        assert file["section/beam/bending_y"].attrs["units"] == "N m"


def test_a_changed_resultant_is_found(solution, tmp_path):
    path = tmp_path / "beams.h5"
    save(solution, path)
    with h5py.File(path, "r+") as file:
        file["section/beam/bending"][3, 4] += 1e-6
    content = path.read_bytes()
    path.write_bytes(content[:-256] if b"lagrange-casadi seal" in content[-256:] else content)
    seal(path, SCHEMA)
    assert any("section/beam/bending: differs from its law" in line for line in check(path))


def test_peaks_between_instants_are_those_of_dense_ones(scene, solution, dense):
    """Resultants too, some of them between the ends of their link."""
    names = [f"section:{link}:{force}" for link in LINKS for force in SPACE.forces]
    names += ["reaction:S:resultant", "reaction:S:moment"]
    inner = set()
    for peak in refine(scene, solution, names):
        truth = dense.peak(peak.name)
        scale = max(abs(truth.value), 1e-9)
        assert abs(peak.value) >= abs(truth.value) * (1 - 1e-12), peak
        assert abs(peak.value) <= abs(truth.value) + 1e-6 * scale, peak
        if peak.xi is not None and 0.1 < peak.xi < 0.9:
            inner.add(peak.name)
    assert {"section:beam:bending", "section:beam:bending_y", "section:beam:bending_z"} <= inner


@pytest.mark.sampled(5)
@pytest.mark.parametrize(
    ("method", "tolerance"),
    [
        (EvaluationMethod("lanes"), 1e-11),
        (EvaluationMethod("c"), 1e-11),
        (EvaluationMethod("vm"), 1e-11),
        (EvaluationMethod("lanes", "single"), 1e-5),
    ],
)
def test_designs_have_the_same_peaks(scene, fine, half, method, tolerance):
    designs = DesignEngine.of(scene, method=method)
    outcome = designs.evaluate(np.array([[6.0], [3.0]]))
    assert (outcome.status == 0).all()
    largest = {
        unit: max(abs(peak.value) for peak in fine.values() if peak.unit == unit)
        for unit in ("N", "N m")
    }
    assert {
        "reaction:A:resultant",
        "reaction:A:moment",
        "section:beam:bending",
        "section:taper:torsion",
    } <= set(fine)
    for k, name in enumerate(designs.quantities):
        peak = fine[name]
        assert abs(abs(outcome.value[0, k]) - abs(peak.value)) <= tolerance * (
            abs(peak.value) + 1e-2 * largest[peak.unit]
        ), name
    bending = designs.quantities.index("section:beam:bending")
    assert outcome.value[1, bending] == pytest.approx(
        half.peak("section:beam:bending").value, rel=1e-6
    )


def test_a_sweep_keeps_peaks_along_links(scene, solution):
    engine, timing, xi = DesignEngine.of(scene), scene.timing(None), np.linspace(0, 1, 7)
    data = engine.program.data
    harvest = Harvest(engine, engine.program, "histories", InstantAxis.of(data, timing), xi)
    found = dict(
        zip(
            (column.name for column in harvest.columns),
            harvest.evaluate(np.array([[6.0], [2.0]])),
            strict=True,
        )
    )
    attributes = {column.name: column.attributes for column in harvest.columns}
    for link in LINKS:
        law = solution.section(link).law
        for force in SPACE.forces:
            grid = law.on_grid(force, xi)
            whole, largest = (
                found[f"history:section:{link}:{force}"][0],
                found[f"peak_at:section:{link}:{force}"][0],
            )
            np.testing.assert_allclose(whole, grid, rtol=0, atol=1e-12 * (np.abs(grid).max() + 1.0))
            np.testing.assert_allclose(
                np.abs(largest),
                np.abs(grid).max(axis=0),
                rtol=0,
                atol=1e-12 * (np.abs(grid).max() + 1.0),
            )
    assert (
        attributes["peak:section:beam:shear"]["long_name"]
        == "largest magnitude over time: resultant shear force"
    )


def test_estimates_of_errors_bound_what_single_precision_loses(scene, no_certificate):
    exact, single = (
        evaluate(scene, precision=precision, xi=(0, 1, 5)) for precision in ("double", "single")
    )
    ratios = np.array(
        [0.0, 0.1234, 0.7654, 1.0]
    )  # no station is at one of them: single precision may put it on the other side
    for link, force in itertools.product(LINKS, SPACE.forces):
        here, there = (found.section(link).law.on_grid(force, ratios) for found in (exact, single))
        error = single.errors[f"section:{link}:{force}"]
        assert np.abs(here - there).max() <= 10 * error + 1e-30, (link, force)
        assert error <= 1e-4 * (np.abs(here).max() + 1.0), (link, force)


def test_figures_show_six_maps_and_two_resultants(solution):
    specs = default_figures(solution)
    assert SectionMaps("section_beam", "beam") in specs
    assert any(isinstance(spec, MechanismDrawing) for spec in specs)
    drawn = {spec.name: spec.quantities for spec in specs if spec.name.startswith("reaction_")}
    assert drawn["reaction_A"] == tuple(
        f"reaction:A:{member}" for member in ("fx", "fy", "fz", "mx", "my", "mz")
    )
    # On the joint's own axes only where what is open is not along the ground's.
    assert "reaction_own_A" not in drawn
    figure = SectionMaps("section_taper", "taper").draw(solution)
    titles = [axes.get_title().partition(":")[0] for axes in figure.axes if axes.get_title()]
    assert titles == [SPACE.row("section", force).long_name for force in SPACE.forces]


@pytest.mark.parametrize("precision", ["double", "single"])
def test_exported_c_gives_the_section_forces(scene, precision, no_certificate, tmp_path):
    """Its own test against golden vectors passes, without a warning; and each force is called by
    its name.
    """
    export(scene, tmp_path / "out", name="beams", precision=precision)
    header = (tmp_path / "out" / "beams.h").read_text()
    for force in SPACE.forces:
        assert f"beams_real {force};" in header
    result = cc(["cc", "-std=c99"], tmp_path / "out", "beams.c", "selftest.c")
    assert result.returncode == 0, result.stderr
    told = subprocess.run(
        [tmp_path / "out" / "program"], capture_output=True, text=True, check=False
    )
    assert told.returncode == 0, told.stdout
    assert "resultant bending moment" in (tmp_path / "out" / "selftest.c").read_text()


def test_slides_that_stand_still_are_rounding_beside_what_turns():
    """A loop that cannot move is carried about: no length changes, so no other length tells how
    little rounding is.
    """
    m = SpatialMechanism("carried")
    a, b = (
        m.link("a", length=0.5, mass=1.0),
        m.link("b", length=0.4, mass=2.0, centre=(0.1, 0.2, 0.0), inertia=(0.1, 0.1, 0.15)),
    )
    m.universal("U", m.ground, a, axis=(0.3, 0.5, 1.0), second=(1.0, 0.4, -0.5))
    m.cylindrical("C", a.tip, b, axis=(0.2, 1.0, -0.4))
    m.planar("P", a.at(0.1, 0.2, 0.1), b.at(0.3, 0.1, -0.2), axis=(1.0, -0.3, 0.5))
    laws = {"U": (motion.polynomial(0.0, 0.7, 0.2), motion.polynomial(0.0, -0.5, 0.1))}
    scene = Scene(m, laws, t=(0, 0.3, 9), posture={"C:slide": 0.0, "C:turn": 0.0})
    found = {
        peak.name: abs(peak.value) for peak in refine(scene, evaluate(scene, wanted=["motion"]))
    }
    designs = DesignEngine.of(scene, ["motion"], method=EvaluationMethod("vm"))
    outcome = designs.evaluate(np.zeros((1, 0)))
    assert outcome.status.tolist() == [Status.OK]
    for name, value in zip(designs.quantities, outcome.value[0], strict=True):
        if name.startswith(("motion:C:slide_", "motion:P:slide_")) and name.endswith(
            ("rate", "acceleration")
        ):
            assert max(abs(value), found[name]) < 1e-13, name
