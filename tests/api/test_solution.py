"""Solutions: names, shapes, units, peaks, sections, poses, notes; in the plane and in space."""

import math
from dataclasses import replace

import numpy as np
import pytest
from balance import assert_balanced
from mechanisms import bracket
from spatial_scenes import beams

from lagrange_casadi import (
    Mechanism,
    Scene,
    SpatialMechanism,
    check,
    evaluate,
    load,
    prepare,
    refine,
    save,
)
from lagrange_casadi.errors import UnknownNameError
from lagrange_casadi.motion import harmonic, polynomial

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]


@pytest.fixture(scope="module")
def spatial():
    return evaluate(beams(), xi=(0, 1, 21), certificate=False)


PLANAR = {"axial", "shear", "bending"}
SPACE = PLANAR | {"torsion", "shear_y", "shear_z", "bending_y", "bending_z"}


def test_names_lead_to_arrays(solution, spatial):
    for one, link, forces in ((solution, "rod", PLANAR), (spatial, "beam", SPACE)):
        for name in one.names():
            section = name.startswith("section:") and ":law:" not in name
            shape = (one.t.size, one.xi.size) if section else (one.t.size,)
            assert one.array(name).shape in (shape, shape[:1]), name
            assert np.isfinite(one.array(name)).all()
        found = {name for name in one.names() if name.startswith(f"section:{link}:")}
        assert {f"section:{link}:{force}" for force in forces} <= found
    assert solution.reaction("guide").fy is solution.array("reaction:guide:fy")
    assert solution.reaction("guide").mz is None
    assert solution.section("rod").bending is solution.array("section:rod:bending")
    assert solution.effort("O") is solution.array("effort:O")
    assert solution.pose("slider").angle is None


def test_resultants_and_axes_in_space(spatial):
    reaction, section = spatial.reaction("A"), spatial.section("beam")
    for name, parts in (("resultant", "fx fy fz"), ("moment", "mx my mz")):
        size = np.linalg.norm([getattr(reaction, part) for part in parts.split()], axis=0)
        np.testing.assert_allclose(spatial.array(f"reaction:A:{name}"), size)
        np.testing.assert_array_equal(getattr(reaction, name), spatial.array(f"reaction:A:{name}"))
    bent = np.hypot(section.bending_y, section.bending_z)
    np.testing.assert_allclose(section.bending, bent, rtol=1e-14)
    found = spatial.statistics("section:beam:bending")
    assert 0.0 <= found.smallest.value <= np.min(section.bending)
    assert found.largest.value >= np.max(section.bending)
    pose = evaluate(beams(), wanted=["motion"], certificate=False).pose("bead")
    assert (pose.angle, pose.axes.shape) == (None, (61, 3, 3))
    square = pose.axes @ np.swapaxes(pose.axes, 1, 2)
    np.testing.assert_allclose(square, np.broadcast_to(np.eye(3), (61, 3, 3)), atol=1e-14)


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("effort:O", "N m"),
        ("motion:O", "rad"),
        ("motion:guide_rate", "m/s"),
        ("motion:O_acceleration", "rad/s^2"),
        ("reaction:guide:fx", "N"),
        ("section:rod:axial", "N"),
        ("section:rod:bending", "N m"),
        ("section:rod:law:m0", "N m"),
        ("section:rod:law:n1", "m/s^2"),
    ],
)
def test_units(solution, name, unit):
    assert solution.unit(name) == unit


def test_names_of_parts_may_look_like_members():
    """No two outputs have one name: joints and links that are called as members are."""
    m = Mechanism("m")
    law, swing = m.link("law", length=1.0, mass=1.0), m.link("swing", length=1.0, mass=1.0)
    m.revolute("O", m.ground, law)
    m.revolute("O_rate", law.tip, swing)
    laws = {"O": polynomial(0.1, 2.0, 3.0), "O_rate": polynomial(0.4, 5.0, 6.0)}
    found = evaluate(Scene(m, laws, t=(0.0, 0.0, 1)))
    assert len(set(found.names())) == len(list(found.names()))
    for name, value in (("O", 0.1), ("O_rate.coordinate", 0.4), ("O_rate_rate", 5.0)):
        assert found.array(f"motion:{name}")[0] == pytest.approx(value)
    assert (found.motion("O").rate[0], found.motion("O_rate").value[0]) == (2.0, 0.4)
    assert found.section("law").bending.shape == (1, found.xi.size)


def test_peaks_are_those_of_a_fine_grid(solution, slider_crank):
    fine = evaluate(slider_crank.scene, xi=(0, 1, 4001), wanted=["section:rod"])
    for force in sorted(PLANAR):
        peak, grid = solution.peak(f"section:rod:{force}"), fine.array(f"section:rod:{force}")
        i, j = np.unravel_index(np.argmax(np.abs(grid)), grid.shape)
        assert peak.value == pytest.approx(grid[i, j], rel=1e-7)
        assert abs(peak.value) >= abs(grid[i, j]) * (1 - 1e-14)
        assert (peak.t, peak.xi) == pytest.approx((fine.t[i], fine.xi[j]), abs=3e-4)
    peak = solution.peak("effort:O")
    assert abs(peak.value) == np.max(np.abs(solution.effort("O")))
    assert solution.effort("O")[np.searchsorted(solution.t, peak.t)] == peak.value
    assert (peak.unit, peak.xi) == ("N m", None)


def test_extremes_are_the_largest_along_the_link(solution):
    values, places = solution.extremes("section:rod:bending")
    section = solution.section("rod")
    assert np.all(np.abs(values) >= np.abs(section.bending).max(axis=1) * (1 - 1e-14))
    at = section.law.at("bending", places[:, None])[:, 0]
    np.testing.assert_allclose(values, at, rtol=1e-14)
    values, places = solution.extremes("effort:O")
    assert (values is solution.effort("O"), places) == (True, None)


def test_angles_are_continuous(slider_crank):
    turns = evaluate(slider_crank.scene, t=(0, 0.8, 2001), wanted=["motion"])
    crank = turns.pose("crank").angle
    assert np.max(np.abs(np.diff(crank))) < 0.1
    np.testing.assert_allclose(crank, turns.motion("O").value, atol=1e-12)
    np.testing.assert_allclose(turns.motion("A").value, turns.pose("rod").angle - crank, atol=1e-12)


@pytest.mark.parametrize(
    ("asked", "says"),
    [
        (lambda s: s.section("sider"), "unknown link with sections 'sider'; valid: crank, rod"),
        (lambda s: s.reaction("gide"), r"joint with a reaction 'gide' \(did you mean 'guide'\?\)"),
        (lambda s: s.effort("A"), "unknown drive 'A'; valid: O"),
        (lambda s: s.peak("section:rod:torsion"), "unknown quantity 'section:rod:torsion'"),
        (lambda s: s.array("reaction:O:fz"), "unknown quantity 'reaction:O:fz'"),
        (lambda s: s.output("x"), "valid: none are declared"),
    ],
)
def test_unknown_names_list_the_valid(solution, asked, says):
    with pytest.raises(UnknownNameError, match=says):
        asked(solution)


def test_a_section_is_made_when_asked_for(slider_crank):
    """The law is seven numbers an instant; a grid of xi costs nothing until somebody looks."""
    asked = {"t": (0, 0.08, 11), "xi": (0, 1, 100_000), "wanted": ["section:rod"]}
    found = evaluate(slider_crank.scene, **asked)
    assert sum(values.size for values in found.series.values()) == 7 * 11
    assert found.section("rod").bending.shape == (11, 100_000)


def test_to_xarray(solution):
    dataset = solution.to_xarray()
    assert dataset["section:rod:bending"].dims == ("t", "xi")
    assert dataset["section:rod:bending"].attrs["units"] == "N m"
    assert "tension" in dataset["section:rod:axial"].attrs["sign"]
    assert float(dataset["effort:O"].sel(t=0.03, method="nearest")) == solution.effort("O")[300]


def test_what_is_shown_is_a_line(solution, slider_crank):
    scene = "<Scene of slider_crank: drives O, wants all, 801 instants from 0 to 0.08 s>"
    told = "<Solution of slider_crank: 801 instants, 101 ratios, 32 quantities, {}>"
    wrong = replace(solution, certificate={"balance": np.ones(801)})
    for shown, words in (
        (solution, told.format("certified")),
        (replace(solution, certificate={}), told.format("no certificate")),
        (wrong, told.format("its certificate fails")),
        (solution.section("rod"), "<Section of a link of 0.2 m: 801 instants, 101 ratios>"),
        (
            slider_crank.scene.mechanism,
            "<Mechanism slider_crank: crank, rod, slider; joints: O, A, B, guide>",
        ),
        (slider_crank.scene, scene),
        (slider_crank, f"<Case slider_crank: {scene}>"),
        (Mechanism("new"), "<Mechanism new: no body yet; joints: none yet>"),
    ):
        assert repr(shown) == words


def test_a_file_is_the_solution_to_the_last_bit(spatial, tmp_path):
    save(spatial, tmp_path / "beams.h5")
    assert check(tmp_path / "beams.h5") == []
    again = load(tmp_path / "beams.h5")
    assert list(again.series) == list(spatial.series)
    for name in spatial.names():
        assert again.array(name).tobytes() == spatial.array(name).tobytes(), name


def test_slides_that_stand_still_are_rounding_beside_what_turns():
    """A loop that cannot move is carried about: no length changes, so no other length tells how
    little rounding is.
    """
    m = SpatialMechanism("carried")
    told = {"centre": (0.1, 0.2, 0.0), "inertia": (0.1, 0.1, 0.15)}
    a, b = m.link("a", length=0.5, mass=1.0), m.link("b", length=0.4, mass=2.0, **told)
    m.universal("U", m.ground, a, axis=(0.3, 0.5, 1.0), second=(1.0, 0.4, -0.5))
    m.cylindrical("C", a.tip, b, axis=(0.2, 1.0, -0.4))
    m.planar("P", a.at(0.1, 0.2, 0.1), b.at(0.3, 0.1, -0.2), axis=(1.0, -0.3, 0.5))
    laws = {"U": (polynomial(0.0, 0.7, 0.2), polynomial(0.0, -0.5, 0.1))}
    scene = Scene(m, laws, t=(0, 0.3, 9), posture={"C:slide": 0.0, "C:turn": 0.0})
    peaks = refine(scene, evaluate(scene, wanted=["motion"]))
    found = [(peak.name, peak.value) for peak in peaks]
    prepared = prepare(scene, wanted=["motion"])
    found += zip(prepared.quantities, prepared.peaks().value, strict=True)
    for name, value in found:
        if name.startswith(("motion:C:slide", "motion:P:slide")) and name.endswith(
            ("rate", "tion")
        ):
            assert abs(value) < 1e-13, name


# Points that slide beyond the end of a link: the forces are those of a bracket, and it is said.


def slotted(x=0.05):
    """A crank's pin in the slot of a rocker that is too short for it."""
    m = Mechanism("slotted")
    a, b = m.link("a", length=0.1, mass=0.3), m.link("b", length=0.32, mass=0.5)
    m.revolute("O", m.ground, a)
    m.revolute("Q", m.ground.at(x, -0.3), b)
    m.slot("S", b, a.tip)
    return Scene(m, {"O": polynomial(0.2, 6.0)}, posture={"b": 1.5}, t=(0.0, 1.1, 111))


LEAVES = "; beyond the end of the link the joint's force acts on that end"


@pytest.mark.parametrize(
    ("scene", "wanted", "says"),
    [
        *(
            (bracket(), wanted, "joint 'S' leaves link 'arm' at t = 0.05 s (xi/l from -1.3 to 2.3)")
            for wanted in (["all"], ["motion"], ["section:arm"])
        ),
        # The pivot is 0.3041 m from the crank's.
        (slotted(), ["all"], "joint 'S' leaves link 'b' at t = 0 s (xi/l from 0.6379 to 1.263)"),
        (bracket(), ["effort"], None),
        (bracket(reach=0.2), ["all"], None),
    ],
)
def test_it_is_said_which_joint_leaves_when_and_how_far(scene, wanted, says, tmp_path):
    found = evaluate(scene, wanted=wanted)
    save(found, tmp_path / "x.h5")
    assert load(tmp_path / "x.h5").notes == found.notes
    assert len(found.notes) == (says is not None)
    assert all(note.startswith(says + LEAVES) for note in found.notes)


def test_an_end_missed_by_rounding_is_no_leaving():
    m = Mechanism("m")
    arm, p = m.link("arm", length=0.3, mass=1.0), m.point_mass("p", 2.0)
    m.revolute("J", m.ground, arm)
    m.prismatic("S", arm, p, axis=(1, 0))
    assert evaluate(Scene(m, {"J": polynomial(0, 1), "S": polynomial(0.1 + 0.2)})).notes == ()


@pytest.mark.parametrize("t", [0.0, 0.25, 0.75])
@pytest.mark.parametrize("scene", [bracket, slotted])
def test_forces_beyond_the_ends_are_those_of_newton(scene, t):
    """At 1/4 of the period the point is beyond the tip, at 3/4 before the base."""
    assert_balanced(scene(), t=t)


@pytest.mark.parametrize(("reach", "lever", "side"), [(0.9, 1.15, 1), (-0.9, 0.65, -1)])
def test_nothing_vanishes_before_the_base_or_beyond_the_tip(reach, lever, side):
    """A mass 1.15 m from the base of an arm of 0.5 m, or 0.65 m before its base; the joint bears
    the arm at u = 0.2.
    """
    m = Mechanism("still")
    arm, p = m.link("arm", length=0.5, mass=0.0), m.point_mass("p", 2.0)
    m.revolute("J", m.ground, arm.at(0.1))
    m.prismatic("S", arm, p, axis=(1, 0))
    laws = {"J": polynomial(0.0), "S": harmonic(0.25, reach, 0.0, math.pi / 2)}
    section = evaluate(Scene(m, laws, t=(0, 1, 2), xi=(0, 1, 11))).section("arm")
    u, weight = np.linspace(0, 1, 11), 2.0 * 9.81
    borne = u >= 0.2 if side > 0 else u < 0.2
    np.testing.assert_allclose(section.shear[0], np.where(borne, -side * weight, 0.0), atol=1e-12)
    bending = -weight * (lever - side * 0.5 * u)
    np.testing.assert_allclose(section.bending[0], np.where(borne, bending, 0.0), atol=1e-12)
