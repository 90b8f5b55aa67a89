"""Scenes: only what is wanted, and what is refused."""

import numpy as np
import pytest
from internals import outputs
from mechanisms import four_bar, slider_crank

from lagrange_casadi import Mechanism, Scene, derive, evaluate
from lagrange_casadi.errors import DeclarationError, SizeError, UnknownNameError
from lagrange_casadi.motion import polynomial

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]


def test_outputs():
    assert outputs(slider_crank().mechanism) == [
        "all", "effort", "motion", "reaction:O", "reaction:A", "reaction:B", "reaction:guide",
            "section:crank", "section:rod",
        "sensitivity:r", "sensitivity:l", "sensitivity:m1", "sensitivity:m2", "sensitivity:m3",
    ]  # fmt: skip


def groups(program):
    return {name.split(":")[0] for name in program.names if not name.startswith("_")}


@pytest.mark.parametrize(
    ("wanted", "expected"),
    [
        (["effort"], {"effort"}),
        (["motion"], {"motion", "pose"}),
        (["reaction:guide"], {"reaction"}),
        (["section:rod"], {"section"}),
        (["effort", "section:crank"], {"effort", "section"}),
    ],
)
def test_a_graph_holds_what_is_wanted(wanted, expected):
    assert groups(derive(slider_crank(), wanted)) == expected


@pytest.mark.parametrize(
    ("wanted", "same"),
    [
        (["section"], ["section:crank", "section:rod"]),
        (
            ["reaction", "effort"],
            ["effort", "reaction:O", "reaction:A", "reaction:B", "reaction:guide"],
        ),
        (["section", "section:rod"], ["section:rod", "section:crank"]),
    ],
)
def test_a_kind_is_all_of_that_kind(wanted, same):
    scene = slider_crank()
    assert derive(scene, wanted).names == derive(scene, same).names


def test_a_kind_of_which_there_is_none_is_refused():
    with pytest.raises(
        DeclarationError,
        match="output 'load': not an output of mechanism 'slider_crank'; valid: all, effort,"
        " motion",
    ):
        derive(slider_crank(), ["effort", "load"])
    with pytest.raises(
        UnknownNameError, match=r"unknown output 'sections' \(did you mean 'section'\?\)"
    ):
        derive(slider_crank(), ["sections"])


def test_what_is_not_wanted_costs_nothing():
    """The effort alone is a graph without a mobility: as many instructions whether or not the links
    could be cut.
    """
    scene = four_bar()
    effort, everything = derive(scene, ["effort"]), derive(scene, ["all"])
    section = derive(scene, ["effort", "section:b"])
    count = [sum(program.instructions.values()) for program in (effort, section, everything)]
    assert count == sorted(count)
    assert count[0] < 0.7 * count[2]
    motion = derive(scene, ["motion"])
    assert sum(motion.instructions.values()) < count[2]


def test_instructions_do_not_creep_back():
    """The paper's mechanism, beside its 42 columns, 8 inputs and few constants: everything, and the
    effort alone.
    """
    counts = [
        derive(slider_crank(), wanted).instructions["instant"] for wanted in (["all"], ["effort"])
    ]
    assert counts[0] <= 183
    assert counts[1] <= 84


def test_the_law_of_a_driven_link_is_its_motion():
    """Material turns with its link: n2 is the rate squared and f2 less the angular acceleration, to
    the last bit.
    """
    solution = evaluate(slider_crank(), wanted=["motion", "section:crank"])
    crank = solution.motion("O")
    law = {name: solution.array(f"section:crank:law:{name}") for name in ("n2", "f2")}
    np.testing.assert_array_equal(law["n2"], crank.rate**2)
    np.testing.assert_array_equal(law["f2"], -crank.acceleration)


def test_a_single_link_gives_each_output_alone():
    m = Mechanism("m")
    m.revolute("J", m.ground, m.link("a", length=1, mass=3))
    scene = Scene(m, {"J": polynomial(0.3, 1.0)}, t=(0, 1, 3))
    whole = evaluate(scene)
    for wanted in ("effort", "reaction:J", "section:a", "motion"):
        alone = evaluate(scene, wanted=[wanted])
        for name in alone.series:
            np.testing.assert_allclose(
                alone.series[name], whole.series[name], rtol=1e-14, err_msg=name
            )


def test_the_order_of_wanting_does_not_matter():
    one, two = (
        derive(slider_crank(), wanted)
        for wanted in (["section:rod", "effort"], ["effort", "section:rod"])
    )
    assert one.columns == two.columns


def test_loops_are_closed_alike_whatever_is_wanted():
    """A guide carried by a link that is cut, at the cut side: the closed
    form does not see the cut.
    """
    m = Mechanism("m")
    a = m.link("a", length=0.3, mass=1.0)
    b = m.link("b", length=1.0, mass=1.0)
    p = m.point_mass("p", 1.0)
    m.revolute("O", m.ground, a)
    m.revolute("Q", m.ground.at(0, -0.5), b)
    m.revolute("A", a.tip, p)
    m.prismatic("P", b.tip, p, axis=(1, 0))
    scene = Scene(m, {"O": polynomial(0.3, 1.0)}, posture={"b": 1.5}, t=(0, 1, 3))
    for wanted in (["effort"], ["section:b"], ["all"]):
        program = derive(scene, wanted)
        assert program.newton is None
        assert "_closure:P" in program.names


@pytest.mark.parametrize(
    ("wanted", "error", "says"),
    [
        (
            ["torque"],
            UnknownNameError,
            "unknown output 'torque'; valid: all, effort, motion, reaction:O",
        ),
        (
            ["section:slider"],
            DeclarationError,
            "'slider' is not a link and has no sections; links: crank, rod",
        ),
        (["reaction:X"], UnknownNameError, "unknown output 'reaction:X'"),
        ([], DeclarationError, "no output wanted"),
    ],
)
def test_outputs_that_cannot_be(wanted, error, says):
    with pytest.raises(error, match=says):
        slider_crank(wanted=wanted)


def test_a_link_known_by_its_inertia_has_no_section():
    m = Mechanism("m")
    a = m.link("a", length=1, mass=1, centre=(0.4, 0.1), inertia=0.2)
    m.revolute("O", m.ground, a)
    assert "section:a" not in outputs(m)
    with pytest.raises(
        DeclarationError, match="link 'a' has sections only if its mass is given along it"
    ):
        Scene(m, {"O": polynomial(0)}, ["section:a"])


@pytest.mark.parametrize(
    ("keywords", "says"),
    [
        (
            {"motion": {"X": polynomial(0)}},
            "unknown joint, path or body in motion 'X'; valid: O, A, guide, crank",
        ),
        ({"motion": {"B": polynomial(0)}}, "joint 'B' cannot be driven"),
        ({"motion": {"O": 3.0}}, "motion of joint 'O': expected a law"),
        (
            {"posture": {"stick": 1.0}},
            "unknown link or joint in posture 'stick'; valid: crank, rod, O, A, guide",
        ),
        ({"t": (0, 1, 0)}, "t: COUNT must be a whole number from 1 to 2\\^63 - 1, got 0"),
        ({"t": (0, 1, 1)}, "t: COUNT must be 2 or more to reach from 0 to 1, got 1"),
        ({"xi": (0, 1, 1)}, "xi: COUNT must be 2 or more to reach from 0 to 1, got 1"),
        ({"t": (0, 1, 1.5)}, "t: COUNT must be a whole number"),
        ({"t": (1, 0, 5)}, "t: STOP must be after START"),
        ({"t": (0, float("nan"), 5)}, "t: START and STOP must be finite"),
        ({"t": (-1e308, 1e308, 5)}, "t: START and STOP are too far apart"),
        ({"t": (0, 1)}, "t: expected"),
        ({"xi": (0, 1.5, 5)}, r"xi: ratios xi/l must lie in \[0, 1\], got 0 to 1.5"),
        ({"xi": (-0.1, 1, 5)}, r"xi: ratios"),
    ],
)
def test_misuse_is_named(keywords, says):
    base = slider_crank()
    with pytest.raises(DeclarationError, match=says):
        Scene(base.mechanism, **({"motion": base.motion, "posture": {"rod": 0.0}} | keywords))


def test_grids_include_both_ends():
    solution = evaluate(slider_crank(), t=(0.0, 2.0, 5), xi=(0.0, 1.0, 3))
    assert solution.t.tolist() == [0.0, 0.5, 1.0, 1.5, 2.0]
    assert solution.xi.tolist() == [0.0, 0.5, 1.0]
    assert evaluate(slider_crank(), t=(0.3, 0.3, 1)).t.tolist() == [0.3]


def test_grids_are_what_their_decimals_say():
    solution = evaluate(slider_crank(), t=(0.0, 0.7, 8), xi=(0.0, 1.0, 101))
    assert solution.t.tolist() == [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]
    assert solution.xi.tolist() == [float(f"{k}e-2") for k in range(101)]


@pytest.mark.parametrize(
    ("keywords", "says"),
    [
        (
            {"t": (0, 1, 10**12)},
            (
                r"not enough memory for the outputs over time: 2 x 51 x 1 000 000 000 000 values"
                r" are 8.16e\+05 GB, and this machine has"
            ),
        ),
        (
            {"xi": (0, 1, 10**12)},
            r"not enough memory for the points from 0 to 1: 3 x 1 000 000 000 000 values are 2\.4e",
        ),
    ],
)
def test_what_does_not_fit_into_memory_is_refused_before_it_is_tried(keywords, says):
    with pytest.raises(SizeError, match=says):
        evaluate(slider_crank(), **keywords)


@pytest.mark.parametrize(
    ("keywords", "says"),
    [
        ({"backend": "gpu"}, "unknown backend 'gpu'; valid: auto, lanes, c, vm"),
        ({"backend": None}, "evaluate: backend: expected a text, got None"),
        ({"threads": True}, "threads: expected a whole number from 1 to 1024, got True"),
        ({"threads": 0}, "threads: expected a whole number from 1 to 1024, got 0"),
        ({"threads": 1.5}, "threads: expected a whole number from 1 to 1024, got 1.5"),
    ],
)
def test_a_way_to_run_that_there_is_not_is_named(keywords, says):
    with pytest.raises(DeclarationError, match=says):
        evaluate(slider_crank(), **keywords)
