"""Solutions: names, shapes, units, peaks, sections, poses, notes; in the plane and in space."""

from dataclasses import replace

import numpy as np
import pytest
from mechanisms import bracket, pins_of

from lagrange_casadi import Mechanism, Scene, evaluate, load, save
from lagrange_casadi.errors import DeclarationError
from lagrange_casadi.motion import polynomial

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]


@pytest.mark.parametrize(
    ("asked", "says"),
    [
        (lambda s: s["effort:O"], r"a Solution takes no brackets: expected \.array\('effort:O'\)"),
        (lambda s: s.section("sider"), "unknown link with sections 'sider'; valid: crank, rod"),
        (lambda s: s.reaction("gide"), r"joint with a reaction 'gide' \(did you mean 'guide'\?\)"),
        (lambda s: s.effort("A"), "unknown drive 'A'; valid: O"),
        (lambda s: s.peak("section:rod:torsion"), "unknown quantity 'section:rod:torsion'"),
        (lambda s: s.peak("reaction:Q:resultant"), "unknown quantity 'reaction:Q:resultant'"),
        (lambda s: s.array("reaction:O:fz"), "unknown quantity 'reaction:O:fz'"),
        (lambda s: s.output("x"), "valid: none are declared"),
        (lambda s: s.multiplier("x"), "unknown constraint or row with a multiplier 'x'"),
        (lambda s: s.during(3), "during: expected a slice, or True or False for each instant"),
        (lambda s: s.safety("O"), "nothing is fitted to joint 'O'; joints with a pin .*: none"),
    ],
)
def test_unknown_names_list_the_valid(solution, asked, says):
    with pytest.raises(DeclarationError, match=says):
        asked(solution)


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
        (replace(slider_crank.scene, t=(0, "80 ms", 801)), scene.replace("0.08 s", "80 ms")),
        (slider_crank, f"<Case slider_crank: {scene}>"),
        (Mechanism("new"), "<Mechanism new: no body yet; joints: none yet>"),
    ):
        assert repr(shown) == words


# Points that slide beyond the end of a link: the forces are those of a bracket, and it is said.


def slotted(x=0.05, axis=(1, 0), **rigid):
    """A crank's pin in the slot of a rocker that is too short for it."""
    m = Mechanism("slotted")
    a, b = m.link("a", length=0.1, mass=0.3), m.link("b", length=0.32, mass=0.5, **rigid)
    pins_of(m, O=(m.ground, a), Q=(m.ground.at(x, -0.3), b))
    m.slot("S", b, a.tip, axis=axis)
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
        # Beyond both ends, but by rounding.
        (bracket(reach=0.25 + 1e-11), ["all"], None),
    ],
)
def test_it_is_said_which_joint_leaves_when_and_how_far(scene, wanted, says, tmp_path):
    found = evaluate(scene, wanted=wanted)
    save(found, tmp_path / "x.h5")
    assert load(tmp_path / "x.h5").notes == found.notes
    assert len(found.notes) == (says is not None)
    assert all(note.startswith(says + LEAVES) for note in found.notes)


@pytest.mark.parametrize("axis", [(1, 0), (-1, 0)])
def test_the_slot_of_a_rigid_body_ends_too(axis):
    """A rigid body may lie on both sides of its base, as a wheel does."""
    scene = replace(
        slotted(axis=axis, centre=(0.0, 0.0), inertia=4e-3), posture={"b": axis[0] * 1.5}
    )
    (note,) = evaluate(scene, wanted=["motion"]).notes
    ends = "0.6379 to 1.263" if axis[0] > 0 else "-1.263 to -0.6379"
    assert note == (
        f"joint 'S' leaves link 'b' at t = 0 s (xi/l from {ends}); beyond the end of the link the"
        " line along which the joint slides is taken to go on"
    )
    assert evaluate(replace(scene, t=(0.6, 0.8, 9)), wanted=["motion"]).notes == ()


def test_angles_go_on_over_turns(slider_crank):
    turns = evaluate(slider_crank.scene, t=(0, 0.8, 2001), wanted=["motion"])
    crank = turns.pose("crank").angle
    np.testing.assert_allclose(crank, turns.motion("O").value, atol=1e-12)
    np.testing.assert_allclose(turns.motion("A").value, turns.pose("rod").angle - crank, atol=1e-12)
