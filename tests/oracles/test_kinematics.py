"""Loops: closure, rates, branches, and what is said where they cannot be closed."""

import dataclasses
import math

import casadi as ca
import numpy as np
import pytest
from balance import instant_at
from internals import LinearSystem
from mechanisms import (
    INSTANT,
    PATTERNS,
    block,
    cross_slide,
    double_crank,
    flat_parallelogram,
    four_bar,
    slider_crank,
    truss_platform,
)
from stepped import pinned

from lagrange_casadi import Mechanism, Scene, derive, evaluate, load_case
from lagrange_casadi.errors import AssemblyError, DeclarationError, MobilityError
from lagrange_casadi.motion import expression, polynomial

pytestmark = pytest.mark.usefixtures("interpreted")


@pytest.mark.sampled(3)
@pytest.mark.quick
@pytest.mark.parametrize("name", PATTERNS)
def test_every_dyad_has_a_closed_form(name):
    """RRR, RRP, RPR, PRP and a guided point: none of these cases iterates."""
    assert derive(PATTERNS[name]()).newton is None


@pytest.mark.quick
@pytest.mark.parametrize(
    "scene", [four_bar(), block(), cross_slide(), PATTERNS["inverted_block_carries"]()], ids=str
)
def test_rates_are_the_derivatives_of_positions(scene):
    """Against differences in time that use positions alone."""
    h = 1e-4
    program = derive(scene, ["motion"])
    rows = [instant_at(program, INSTANT + k * h).full().ravel() for k in range(-3, 4)]
    columns = dict(zip(program.names, np.unwrap(np.array(rows), axis=0).T, strict=True))
    for name, values in columns.items():
        if name.startswith("motion:") and f"{name}_rate" in columns:
            first = (
                -values[0]
                + 9 * values[1]
                - 45 * values[2]
                + 45 * values[4]
                - 9 * values[5]
                + values[6]
            ) / (60 * h)
            rate = columns[f"{name}_rate"]
            second = (
                -rate[0] + 9 * rate[1] - 45 * rate[2] + 45 * rate[4] - 9 * rate[5] + rate[6]
            ) / (60 * h)
            assert first == pytest.approx(rate[3], abs=1e-9, rel=1e-9)
            assert second == pytest.approx(columns[f"{name}_acceleration"][3], abs=1e-8, rel=1e-8)


def test_an_undriven_angle_starts_within_half_a_turn():
    """However far the drive has turned before."""
    mechanism = slider_crank().mechanism
    scenes = (
        Scene(mechanism, {"O": polynomial(start, 9.0)}, posture={"rod": 0.0})
        for start in (0.5, 0.5 + 20 * math.pi)
    )
    near, far = (evaluate(scene, wanted=["motion"]).motion("A").value for scene in scenes)
    assert -math.pi < far[0] <= math.pi
    np.testing.assert_allclose(far, near, rtol=0, atol=1e-13)


@pytest.mark.quick
def test_the_posture_chooses_the_branch():
    for rocker, sign in ((1.5, 1), (-1.5, -1)):
        solution = evaluate(four_bar(rocker=rocker), wanted=["motion"])
        assert math.copysign(1, math.sin(solution.pose("c").angle[0])) == sign


def test_the_branch_is_asked_for_where_it_is_open():
    scene = slider_crank(posture={})
    says = (
        r"joint 'guide' can be assembled in two ways.*rod = .*\(0 deg\).* or rod = .*180"
        r" deg.*posture=\{'rod'"
    )
    with pytest.raises(DeclarationError, match=says):
        derive(scene)


def test_a_posture_between_the_branches_is_no_answer():
    with pytest.raises(DeclarationError, match="two ways"):
        derive(slider_crank(posture={"rod": math.pi / 2}))


@pytest.mark.quick
def test_a_loop_that_cannot_close_at_the_start_is_named():
    with pytest.raises(
        AssemblyError,
        match=(
            r"closed by joint 'B' cannot be closed at the start of the motion, where O = 1\.46 rad"
        ),
    ):
        derive(four_bar(lengths=(0.1, 0.1, 0.1), frame=(1.0, 0.0)))


@pytest.mark.parametrize("case", ["slider_crank", "spatial_slider_crank"])
def test_a_motion_that_is_no_number_at_the_start_is_named(case):
    scene = load_case(case).scene
    (drive,) = scene.motion
    motion = {drive: expression(lambda t: ca.log(t - 5.0))}
    with pytest.raises(DeclarationError, match=rf"no number where it starts.* {drive} = nan rad"):
        derive(dataclasses.replace(scene, motion=motion))


def test_a_loop_that_opens_on_the_way_is_named_with_its_angle():
    scene = slider_crank(posture={"rod": 0.0})
    with pytest.raises(
        AssemblyError,
        match=r"closed by joint 'guide' cannot be closed at t = 0\.01 s, where O = 0\.785.*\(45\.",
    ):
        evaluate(scene, parameters={"r": 0.3})


@pytest.mark.quick
def test_a_dead_centre_is_named():
    """r = l and the crank exactly at 90 deg: the rod stands on the guide's normal, and no force is
    determined.
    """
    m = Mechanism("dead")
    a = m.link("a", length=1.0, mass=1.0)
    b = m.link("b", length=1.0, mass=1.0)
    p = m.point_mass("p", 1.0)
    m.revolute("O", m.ground, a)
    m.revolute("A", a.tip, b)
    m.revolute("B", b.tip, p)
    m.prismatic("guide", m.ground, p, axis=(1, 0))
    scene = Scene(m, {"O": polynomial(0.0, math.pi / 2)}, t=(0, 1, 3), posture={"b": 0.0})
    with pytest.raises(
        AssemblyError,
        match=r"joint 'guide' is at a dead centre at t = 1 s, where O = 1\.5708 rad \(90 deg\)",
    ):
        evaluate(scene)


@pytest.mark.parametrize(("precision", "steps"), [("double", 24), ("single", 12)])
def test_a_dead_centre_that_is_iterated_is_named(precision, steps):
    """A ram draws a crank and its rod straight: Newton's method comes as near as rounding lets it,
    in either precision.
    """
    m = Mechanism("straightened")
    crank, rod = m.link("crank", length=0.1, mass=0.3), m.link("rod", length=0.35, mass=0.5)
    ram = m.point_mass("ram", 0.6)
    m.revolute("O", m.ground, crank)
    m.revolute("A", crank.tip, rod)
    pinned(m, "B", rod.tip, ram)
    m.prismatic("P", m.ground, ram, axis=(1, 0))
    scene = Scene(
        m, {"P": polynomial(0.4, 0.05)}, posture={"crank": 1.0, "rod": -0.3}, t=(0, 1, 41)
    )
    with pytest.raises(
        AssemblyError,
        match=r"constraint 'B_y' is at a dead centre at t = 1 s, where P = 0\.45 m, within",
    ):
        evaluate(scene, precision=precision, newton=steps)


@pytest.mark.parametrize(
    ("drives", "says"), [((), "1 degree.* and 0 drive"), (("O", "A"), "1 degree.* and 2 drive")]
)
def test_drives_must_match_the_freedom(drives, says):
    base = four_bar()
    with pytest.raises(MobilityError, match=says):
        derive(Scene(base.mechanism, {name: polynomial(0.1) for name in drives}))


def test_drives_that_do_not_fit_are_refused():
    """As many drives as freedoms, but a loop has two and the open chain beside it none."""
    m = Mechanism("twice")
    a, b, c, d = (m.link(n, length=1.0, mass=1.0) for n in "abcd")
    m.revolute("O", m.ground, a)
    m.revolute("A", a.tip, b)
    m.prismatic("P", m.ground.at(0, 1), b, axis=(1, 0))
    m.revolute("Q", m.ground.at(3, 0), c)
    m.revolute("R", c.tip, d)
    with pytest.raises(
        MobilityError, match=r"and 2 drive\(s\); but these over-determine some loops"
    ):
        derive(Scene(m, {"O": polynomial(0.5), "P": polynomial(0.1)}, posture={"b": 0.0}))


def test_a_loop_without_closed_form_needs_a_posture():
    base = truss_platform()
    with pytest.raises(
        DeclarationError, match=r"have no closed form; also give a rough posture of .*leg0"
    ):
        derive(Scene(base.mechanism, base.motion, posture={"bar0": 0.0}))


@pytest.mark.quick
def test_iteration_follows_the_motion():
    """Every loop stays closed, on both backends, over the whole motion."""
    scene = truss_platform()
    solution = evaluate(scene)
    for i in range(3):
        leg, bar = solution.pose(f"leg{i}"), solution.pose(f"bar{i}")
        length = solution.description["bodies"][f"leg{i}"]["length"]
        np.testing.assert_allclose(leg.x + length * np.cos(leg.angle), bar.x, atol=1e-15)
        np.testing.assert_allclose(leg.y + length * np.sin(leg.angle), bar.y, atol=1e-15)
    machine = evaluate(scene, backend="vm")
    for name in solution.names():
        np.testing.assert_allclose(
            solution.array(name), machine.array(name), rtol=1e-12, atol=1e-12, err_msg=name
        )


@pytest.mark.parametrize("backend", ["c", "vm"])
def test_a_loop_that_does_not_converge_is_named(backend):
    """A shaft of 5 m carries the first leg's foot out of reach."""
    with pytest.raises(
        AssemblyError, match=r"did not converge at t = 0 s, where O = 0 rad \(0 deg\)"
    ):
        evaluate(truss_platform(), backend=backend, parameters={"shaft": 5.0})


def test_a_change_point_between_instants_is_named():
    """A parallelogram lies flat at 180 deg, where it may go on as one or turn over: neither is
    guessed.
    """
    evaluate(flat_parallelogram(), t=(0, 0.6, 61))
    with pytest.raises(
        AssemblyError,
        match=r"joint 'B' passes a dead centre after t = 0\.6\d* s, where O = 3\.1\d* rad",
    ):
        evaluate(flat_parallelogram())
    with pytest.raises(AssemblyError, match=r"joint 'guide' passes a dead centre after t = 0\.01"):
        evaluate(slider_crank(), parameters={"l": 0.1}, t=(0, 0.08, 802))


def test_a_near_dead_centre_is_none():
    assert evaluate(slider_crank(), parameters={"l": 0.1005}, t=(0, 0.08, 801)).certified


@pytest.mark.parametrize("backend", ["c", "vm"])
def test_a_jump_of_branch_is_named(backend):
    assert evaluate(double_crank(1.0), backend=backend).pose("c").angle[-1] > 2.0
    with pytest.raises(
        AssemblyError,
        match=r"closed by joint 'B' has jumped to another branch at t = 2\.3 s, where O = 2\.5 rad",
    ):
        evaluate(double_crank(2.3), backend=backend)


@pytest.mark.sampled(5)
@pytest.mark.parametrize(
    "keywords", [{"backend": "c"}, {"backend": "vm"}, {"backend": "vm", "newton": 4}]
)
@pytest.mark.parametrize("begin", [2.4, 3.5])
def test_a_part_of_the_motion_is_on_the_branch_of_the_whole(begin, keywords):
    """Instants that begin far from the scene's own are led there, whatever lies nearer to its
    posture.
    """
    scene = double_crank(0.2)
    whole = evaluate(scene, **keywords, t=(0, begin + 0.4, 401))
    part = evaluate(scene, **keywords, t=(begin, begin + 0.4, 5))
    for name in ("b", "c"):
        off = part.pose(name).angle[-1] - whole.pose(name).angle[-1]
        assert math.remainder(off, math.tau) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    "guides",
    [
        1,
        pytest.param(
            2,
            marks=pytest.mark.xfail(
                reason="of one unknown and more equations the volume is one, however steep they are"
            ),
        ),
    ],
)
def test_a_dead_centre_is_passed_in_no_silence_however_often_a_guide_is_declared(guides):
    """Scott and Russell's bar upright: its foot may go on to the other side, or stay at the crank's
    pivot.
    """
    m = Mechanism("scott_russell")
    crank = m.link("crank", length=0.2, mass=1.0)
    bar = m.link("bar", length=0.4, mass=1.0)
    foot = m.point_mass("foot", 0.1)
    m.revolute("O", m.ground, crank)
    m.revolute("A", crank.tip, bar.at(0.2))
    m.revolute("B", bar, foot)
    for k in range(guides):
        m.prismatic(f"X{k}", m.ground, foot, axis=(1, 0))
    scene = Scene(m, {"O": polynomial(1.0, 1.0)}, posture={"bar": 2.14, "X0": 0.2}, t=(0, 1, 101))
    with pytest.raises(AssemblyError, match=r"passes a dead centre after t = 0\.57 s"):
        evaluate(scene, backend="vm")


def test_instants_too_far_apart_are_a_cause_that_is_told():
    """The third crank holds the others at their dead centre: enough instants are all it takes."""
    m, r = Mechanism("cranks"), 0.2
    bar = m.link("bar", length=1.0, mass=1.0)
    for k, (x, y) in enumerate([(0.0, 0.0), (0.4, 0.0), (0.76, 0.28)]):
        crank = m.link(f"crank{k}", length=r, mass=0.1)
        m.revolute(f"O{k}", m.ground.at(x, y), crank)
        m.revolute(f"A{k}", crank.tip, bar.at(x, y) if x else bar)
    posture = {"bar": 0.0, "crank1": 1.0, "crank2": 1.0}
    scene = Scene(m, {"O0": polynomial(1.0, 4.0)}, posture=posture, t=(0, 1.5, 201))
    assert evaluate(scene, backend="vm").certified
    with pytest.raises(
        AssemblyError, match=r"did not converge at t = 1 s.*, or the instant before is too far off"
    ):
        evaluate(scene, t=(0, 1.5, 4), backend="vm")


@pytest.mark.parametrize("n", [1, 2, 3, 5])
def test_linear_systems(n):
    rng = np.random.default_rng(n)
    matrix, right = rng.normal(size=(n, n)), rng.normal(size=n)
    symbols = ca.SX.sym("a", n, n)
    system = LinearSystem.of(symbols)
    f = ca.Function(
        "f",
        [symbols],
        [
            system.solve(ca.SX(right)),
            system.solve_transposed(ca.SX(right), ca.SX(0, 1)),
            system.volume,
        ],
    )
    one, two, volume = (x.full().ravel() for x in f(matrix))
    assert volume[0] == pytest.approx(
        np.linalg.det(matrix) / np.prod(np.linalg.norm(matrix, axis=0)), rel=1e-11
    )
    np.testing.assert_allclose(one, np.linalg.solve(matrix, right), rtol=1e-11)
    np.testing.assert_allclose(two, np.linalg.solve(matrix.T, right), rtol=1e-11)


@pytest.mark.parametrize(
    "given",
    [{"ratio": -2, "offset": 7.0}, {"ratio": -2, "start": 20.0}, {"ratio": 10, "count": 11}],
)
def test_a_gear_counts_turns_however_coarse_the_instants(given):
    m = Mechanism("gear")
    a, b = m.link("a", length=0.1, mass=1), m.link("b", length=0.2, mass=1)
    first, second = m.revolute("A", m.ground, a), m.revolute("B", m.ground.at(1, 0), b)
    m.gear("mesh", first, second, ratio=given["ratio"], offset=given.get("offset", 0.0))
    law = polynomial(given.get("start", 0.0), 30.0)
    solution = evaluate(Scene(m, {"A": law}, t=(0, 1, given.get("count", 101))))
    expected = given["ratio"] * solution.motion("A").value + given.get("offset", 0.0)
    np.testing.assert_allclose(solution.motion("B").value, expected, rtol=1e-14)
    np.testing.assert_allclose(solution.pose("b").angle, expected, rtol=1e-14)


@pytest.mark.parametrize("kind", ["weld", "prismatic"])
def test_a_drive_on_a_link_held_at_a_parameters_angle(kind):
    m = Mechanism("held")
    angle = m.parameter("angle", 0.3, "rad")
    a, b = m.link("a", length=1, mass=1), m.link("b", length=1, mass=1)
    motion = {"J": polynomial(0, 1)}
    if kind == "weld":
        m.weld("W", m.ground, a, angle=angle)
    else:
        m.prismatic("W", m.ground, a, axis=(1, 0), angle=angle)
        motion["W"] = polynomial(0, 1)
    m.revolute("J", a.tip, b)
    solution = evaluate(Scene(m, motion))
    assert solution.effort("J")[0] == pytest.approx(9.81 / 2 * math.cos(0.3), rel=1e-14)


@pytest.mark.sampled(5)
@pytest.mark.parametrize("size", [1e-9, 1e-6, 1.0, 1e6])
def test_a_rough_place_tells_the_branch_at_any_size(size):
    m = Mechanism("small")
    crank = m.link("crank", length=0.1 * size, mass=1)
    rod = m.link("rod", length=0.2 * size, mass=1)
    slider = m.point_mass("s", 1)
    m.revolute("O", m.ground, crank)
    m.revolute("A", crank.tip, rod)
    m.revolute("B", rod.tip, slider)
    m.prismatic("guide", m.ground, slider, axis=(1, 0))
    for side in (1, -1):
        solution = evaluate(
            Scene(m, {"O": polynomial(1.0, 1.0)}, posture={"guide": 0.2 * size * side})
        )
        assert np.sign(solution.motion("guide").value[0]) == side
