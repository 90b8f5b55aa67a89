"""What follows from the section laws of a spatial scene: its solution and file, peaks between
instants, sweeps, figures, C.
"""

import h5py
import numpy as np
import pytest
from internals import (
    SCHEMA,
    SPACE,
    DesignEngine,
    EvaluationMethod,
    MechanismDrawing,
    SectionMaps,
    Status,
    Task,
    check,
    default_figures,
)
from internals import seal_seal as seal
from spatial_scenes import beams

from lagrange_casadi import Scene, SpatialMechanism, derive, evaluate, load, motion, refine, save

LINKS = ("beam", "taper", "bead")


@pytest.fixture(scope="module")
def scene():
    return beams()


@pytest.fixture(scope="module")
def solution(scene):
    return evaluate(scene, xi=(0, 1, 21), certificate=False)


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


def test_a_changed_resultant_is_found(solution, tmp_path):
    path = tmp_path / "beams.h5"
    save(solution, path)
    with h5py.File(path, "r+") as file:
        file["section/beam/bending"][3, 4] += 1e-6
    content = path.read_bytes()
    path.write_bytes(content[:-256] if b"lagrange-casadi seal" in content[-256:] else content)
    seal(path, SCHEMA)
    assert any("section/beam/bending: differs from its law" in line for line in check(path))


def test_a_sweep_keeps_peaks_along_links(scene, solution):
    task, xi = (
        Task(scene.timing(None), (0, 1, 7), "histories", EvaluationMethod()),
        np.linspace(0, 1, 7),
    )
    harvest = task.harvest(derive(scene))
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
            whole = found[f"history:section:{link}:{force}"][0]
            largest = found[f"peak_at:section:{link}:{force}"][0]
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


def test_slides_that_stand_still_are_rounding_beside_what_turns():
    """A loop that cannot move is carried about: no length changes, so no other length tells how
    little rounding is.
    """
    m = SpatialMechanism("carried")
    a = m.link("a", length=0.5, mass=1.0)
    b = m.link("b", length=0.4, mass=2.0, centre=(0.1, 0.2, 0.0), inertia=(0.1, 0.1, 0.15))
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
