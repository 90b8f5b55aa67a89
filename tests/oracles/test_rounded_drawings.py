"""Mechanisms in space as a drawing rounds them: forces are right but for the rounding, and what was
meant stays.
"""

import casadi as ca
import numpy as np
import pytest
from conftest import SPATIAL
from drawings import drawing, drawn
from mechanisms import PLAIN

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, check, evaluate, load, save, sweep
from lagrange_casadi.errors import AssemblyError, ParameterError
from lagrange_casadi.motion import polynomial

FACTOR = 100.0
"""By how many times its rounding a mechanism's forces may be off, of the largest of their kind.

Places are off in metres, and cranks are some centimetres.
"""

LAST = 1e-12
"""And by how much at the least: of such sums the last digits."""


def assert_near(found, exact, noise):
    """All that both tell, by units."""
    assert found.certified == exact.certified
    size = {}
    for output, values in exact.outputs.items():
        unit = exact.unit(str(output))
        size[unit] = max(size.get(unit, 0.0), float(np.nanmax(np.abs(values), initial=0.0)))
    for output, values in exact.outputs.items():
        told = found.outputs[output]
        known = np.isfinite(values) & np.isfinite(told)
        gap = np.max(np.abs(told - values)[known], initial=0.0)
        assert gap <= (FACTOR * noise + LAST) * size[exact.unit(str(output))], (output, gap)


def vm(scene, count=5):
    return evaluate(scene, wanted=["effort"], t=(*scene.span, count), backend="vm")


@pytest.mark.sampled(9)
@pytest.mark.parametrize("noise", [1e-15, 1e-12, 1e-9, 1e-7])
@pytest.mark.parametrize("name", [case for case in PLAIN if case.values[0] in SPATIAL])
def test_every_case_in_space(name, noise):
    exact = vm(drawn(name, 0.0), 9)
    assert_near(vm(drawn(name, noise), 9), exact, noise)


def test_a_screw_in_a_loop_keeps_its_turns():
    """Each step of the motor is more than a half turn: a loop that is iterated from one instant to
    the next would lose some.
    """
    found, exact = (
        evaluate(drawn("screw_lift", noise), wanted=["effort"], backend="vm")
        for noise in (3e-7, 0.0)
    )
    assert_near(found, exact, 3e-7)


def linkage(m, lengths, mass, pins=(0.3, 0.05, 0.0), base=None, **turned):
    """Crank, rod and rocker, pinned to a base in its plane, or in one that is told."""
    base, told = base or m.ground, ("crank", "rod", "rocker")
    crank, rod, rocker = (
        m.link(name, length=length, mass=mass) for name, length in zip(told, lengths, strict=True)
    )
    m.revolute("O", base, crank, **turned)
    m.revolute("A", crank.tip, rod)
    m.revolute("C", base.at(*pins), rocker, **turned)
    m.revolute("B", rod.tip, rocker.tip)


def moving(m, **laws):
    laws = {"O": polynomial(0.1, 10.0)} | laws
    return Scene(m, laws, t=(0.0, 0.6, 7), posture={"A": 0.7, "C": 1.5}, wanted=["effort"])


def turned_four_bar(seed, noise):
    """A crank-rocker in some plane, whose posture is given roughly."""
    rng = np.random.default_rng(seed)
    (*x, w), lengths = rng.normal(size=4), [0.1, *rng.uniform(0.3, 0.4, 2)]
    x = np.array(x) / np.hypot(np.linalg.norm(x), w)
    w = np.sqrt(1.0 - x @ x)
    u, v, n = (tuple(axis + 2.0 * np.cross(x, np.cross(x, axis) + w * axis)) for axis in np.eye(3))
    m = drawing(noise, seed)("turned")
    pins = tuple(0.3 * np.array(u) + rng.uniform(-0.1, 0.1) * np.array(v))
    linkage(m, lengths, 0.5, pins, axis=n, turned=(u, v))
    side = rng.choice([-1.0, 1.0])
    laws = {"O": polynomial(rng.uniform(-3.0, 3.0), 10.0)}
    rough = {"A": side * rng.uniform(0.5, 1.0), "C": side * rng.uniform(1.0, 2.0)}
    return Scene(m, laws, t=(0.0, 0.6, 7), posture=rough, wanted=["effort"])


@pytest.mark.parametrize("seed", range(3))
def test_planar_loops_in_any_plane_are_on_the_branch_of_exact_axes(seed):
    noise = 1e-8
    found, exact = (evaluate(turned_four_bar(seed, off), backend="vm") for off in (noise, 0.0))
    assert rounded(found)
    assert_near(found, exact, noise)


def four_bar(tilt=None):
    """A four-bar whose plane is tilted as was meant, about x, by a number or by a parameter."""
    m = SpatialMechanism("four_bar")
    tilt = ca.SX(m.parameter("tilt", 0.0, "rad") if tilt is None else tilt)
    m.set_gravity(0.0, -9.81, -3.0)
    sine, cosine = ca.sin(tilt), ca.cos(tilt)
    if tilt.is_constant():
        sine, cosine = float(sine), float(cosine)
    turned = {"axis": (0.0, -sine, cosine), "turned": ((1.0, 0.0, 0.0), (0.0, cosine, sine))}
    linkage(m, (0.1, 0.35, 0.25), 0.5, (0.3, 0.05 * cosine, 0.05 * sine), **turned)
    return moving(m)


def hung(noise):
    """An arm that two bars of hard points hold, one of them loaded by a spring in its middle."""
    m = drawing(noise)("hung")
    arm = m.link("arm", between=((0.0, 0.0, 0.0), (0.4, 0.0, 0.1)), mass=2.0)
    slide = m.link("slide", between=((0.4, 0.5, 0.3), (0.8, 0.5, 0.3)), mass=1.0)
    bar = m.link("bar", between=((0.4, 0.0, 0.1), (0.4, 0.5, 0.3)), mass=0.5)
    m.revolute("O", m.ground, arm, at=(0.0, 0.0, 0.0), axis=(0.0, 0.2, 1.0))
    m.spherical("A", arm, bar, at=(0.4, 0.0, 0.1))
    m.spherical("B", bar, slide, at=(0.4, 0.5, 0.3))
    m.prismatic("S", m.ground, slide, at=(0.4, 0.5, 0.3), axis=(0.1, 1.0, 0.0))
    off = [noise * x for x in (0.3, -0.7, 0.9)]
    m.spring(
        "pull",
        m.ground.at(0.1, 0.2, 1.0),
        m.at(bar, 0.4 + off[0], 0.25 + off[1], 0.2 + off[2]),
        stiffness=300.0,
        length=0.5,
    )
    return Scene(m, {"O": polynomial(0.0, 1.0)}, t=(0.0, 0.3, 5), wanted=["effort"])


@pytest.mark.parametrize("noise", [1e-11, 1e-7])
def test_a_bar_of_hard_points_may_be_loaded(noise):
    found = vm(hung(noise))
    assert found.description.bars == ("bar",)
    assert_near(found, vm(hung(0.0)), noise)


def placed_four_bar(noise, turn):
    """A crank-rocker whose places fit where the motion begins, however its axes are rounded."""
    m, (c, s) = drawing(noise, 3)("placed"), (np.cos(turn), np.sin(turn))
    plan = {"O": (0.0, 0.0), "A": (0.0, 0.1), "C": (0.3, 0.05), "B": (0.28, 0.3)}
    at = {name: (c * x, y, s * x) for name, (x, y) in plan.items()}
    ends = {"crank": "OA", "rod": "AB", "rocker": "CB"}
    crank, rod, rocker = (
        m.link(name, between=(at[a], at[b]), mass=0.5) for name, (a, b) in ends.items()
    )
    pairs = {"O": (m.ground, crank), "A": (crank, rod), "C": (m.ground, rocker), "B": (rod, rocker)}
    for name, pair in pairs.items():
        m.revolute(name, *pair, at=at[name], axis=(-s, 0.0, c))
    wanted = ["effort", "reaction"]
    return Scene(m, {"O": polynomial(0.0, 10.0)}, t=(0.0, 0.6, 13), wanted=wanted)


@pytest.mark.parametrize("turn", [0.0, 1.0])
@pytest.mark.parametrize("noise", [1e-12, 5e-10])
def test_places_that_fit_at_first_hide_no_rounded_axes(noise, turn):
    """Forces would be those of wedges: what is open would be taken for determined."""
    found, exact = (evaluate(placed_four_bar(off, turn), backend="vm") for off in (noise, 0.0))
    assert found.indeterminate == exact.indeterminate
    assert_near(found, exact, noise)


def test_nothing_is_said_of_loops_that_fit_at_all_instants():
    scene = placed_four_bar(1e-9, 0.0)
    assert rounded(evaluate(scene, backend="vm"))
    assert not rounded(evaluate(scene, t=(0.0, 0.0, 1), backend="vm"))


def rounded(solution):
    return any("rounding" in note for note in solution.notes)


@pytest.mark.parametrize("tilt", [1e-5, 1e-7, -3e-10])
def test_a_tilt_that_was_meant_is_not_moved_where_loops_close(tilt):
    """Not as a number, and not as a parameter: the effort changes with it as it does with a large
    one.
    """
    level, steep = vm(four_bar(tilt=0.0)).effort("O"), vm(four_bar(tilt=1e-3)).effort("O")
    by = (steep - level) / 1e-3
    number = vm(four_bar(tilt=tilt))
    parameter = evaluate(four_bar(), parameters={"tilt": tilt}, t=(0.0, 0.6, 5), backend="vm")
    for found in (number, parameter):
        assert not rounded(found)
        assert found.effort("O") - level == pytest.approx(
            tilt * by, abs=1e-2 * abs(tilt) * np.max(np.abs(by)) + 1e-14
        )


def pressing(noise, tilt=None):
    """The four-bar on a base that turns about an axis that is tilted as was meant; the loop alone
    is rounded.
    """
    m = drawing(noise, exact=("swing",))("pressing")
    tilt = m.parameter("tilt", 0.0, "rad") if tilt is None else tilt
    mass = m.parameter("mass", 0.5, "kg", low=0.0)
    length = m.parameter("length", 0.1, "m", low=0.02, high=0.15)
    base = m.link("base", length=0.5, mass=3.0)
    m.revolute("swing", m.ground, base, axis=(0.0, tilt, 1.0))
    linkage(m, (length, 0.35, 0.25), mass, base=base)
    return moving(m, swing=polynomial(0.2, 1.0, 3.0))


def test_a_tilt_that_was_meant_stays_beside_a_loop_that_was_rounded():
    """The joint that carries it closes no loop."""
    found = vm(pressing(1e-9, 1e-7))
    assert found.description.missed == {"B": pytest.approx(1e-9, rel=0.9)}
    assert_near(found, vm(pressing(0.0, 1e-7)), 1e-9)


def test_derivatives_are_those_of_exact_axes():
    """By a length of the loop, by a mass, and by the tilt."""
    names, noise = ["length", "mass", "tilt"], 1e-8
    wanted = ["effort", *(f"sensitivity:{name}" for name in names)]
    exact, found = (evaluate(pressing(size), wanted=wanted, backend="vm") for size in (0.0, noise))
    assert rounded(found)
    for name in names:
        for joint in ("swing", "O"):
            one, other = (
                solution.sensitivities.array(f"effort:{joint}", name) for solution in (exact, found)
            )
            assert np.max(np.abs(one - other)) <= FACTOR * noise * np.max(np.abs(one))


def test_what_is_made_of_a_rounded_scene(tmp_path):
    """Peaks of designs, and files, which hold by how much loops miss."""
    noise, grid = 1e-8, {"length": (0.06, 0.12, 3), "tilt": [0.0, 1e-7, 0.1]}
    one, other = (sweep(pressing(off), grid, wanted=["effort"]) for off in (0.0, noise))
    assert not one.description.rounding
    assert other.description.rounding == 1e-6
    for name in ("peak:effort:swing", "peak:effort:O"):
        peaks, found = (
            np.array([kept.values(k, name)[name] for k in range(kept.size)])
            for kept in (one, other)
        )
        assert np.max(np.abs(found - peaks)) <= FACTOR * noise * np.max(np.abs(peaks))
    solution = evaluate(pressing(noise), wanted=["all"], parameters={"length": 0.09}, backend="vm")
    save(solution, tmp_path / "rough.h5")
    kept = load(tmp_path / "rough.h5")
    assert kept.description.missed == solution.description.missed
    assert check(tmp_path / "rough.h5") == []
    assert kept.certified
    assert rounded(kept)


def offset(by, default):
    """A four-bar with a pivot that is off its plane, by a parameter."""
    m = SpatialMechanism("offset")
    linkage(m, (0.1, 0.35, 0.25), 0.5, (0.3, 0.05, by * m.parameter("k", default)))
    return moving(m)


@pytest.mark.parametrize(("default", "raised"), [(1.0, -2.0), (0.0, 0.01), (1.0, 3.0), (0.0, 1.0)])
def test_loops_may_miss_for_the_parameters_in_use(default, raised):
    """Loops that close by default may not for others."""
    exact, found = (
        evaluate(offset(by, default), parameters={"k": raised}, backend="vm") for by in (0.0, 2e-7)
    )
    assert rounded(found)
    assert_near(found, exact, 2e-7)


def test_loops_that_are_off_by_more_for_the_parameters_in_use_are_refused():
    with pytest.raises(AssemblyError, match="over-constrained and do not fit"):
        evaluate(offset(1.0, 0.0), parameters={"k": 2e-5}, backend="vm")


def crossed(off):
    """A universal joint whose second axis a parameter turns, off a right angle."""
    m = SpatialMechanism("crossed")
    phase = m.parameter("phase", 0.0, "rad")
    arm = m.link("arm", length=0.3, mass=1.0)
    lean = m.parameter("lean", 0.0, "rad")
    m.universal(
        "C", m.ground, arm, axis=(1.0, 0.0, 0.0), second=(off + lean, ca.cos(phase), ca.sin(phase))
    )
    return Scene(
        m,
        {"C:turn_1": polynomial(0.2, 1.0), "C:turn_2": polynomial(0.1, -2.0)},
        t=(0.0, 1.0, 5),
        wanted=["effort"],
    )


@pytest.mark.parametrize("off", [1e-10, 1e-8, -9e-7])
def test_a_second_axis_of_parameters_is_made_exact(off):
    values = {"phase": 0.3}
    found, exact = (evaluate(crossed(size), parameters=values, backend="vm") for size in (off, 0.0))
    assert_near(found, exact, abs(off))
    assert found.notes == (
        f"axes of joint 'C' are taken as at right angles, moved by up to {abs(off):.2g} rad",
    )
    assert exact.notes == ()
    with pytest.raises(ParameterError, match="right angles"):
        evaluate(crossed(off), parameters={"lean": 1e-3})


def shelf(off, wind):
    """An arm whose length is a parameter, with a lump, or ``wind``, that is off by as much beyond
    each end.
    """
    m, (before, after) = Mechanism("shelf"), off
    length = m.parameter("l", 0.3, "m")
    arm = m.link("arm", length=length, mass=1.0)
    m.revolute("O", m.ground, arm)
    if wind:
        m.line_load("wind", arm, y=(-20.0, -40.0), between=(before, length + after))
    else:
        m.weld("V", arm.at(before), m.point_mass("stone", 1.0))
        m.weld("W", arm.at(length + after), m.point_mass("lump", 2.0))
    return Scene(m, {"O": polynomial(0.0, 1.0)}, t=(0.0, 1.0, 3), xi=(0, 1, 5))


@pytest.mark.parametrize("wind", [True, False])
@pytest.mark.parametrize("off", [(-1e-8, 2e-7), (0.0, 1e-9), (-2e-7, 0.0)])
def test_what_was_rounded_beyond_an_end_of_a_link_ends_there(off, wind):
    """Of a link whose length is a parameter too; and not where it is off by more."""
    found, exact = (
        evaluate(shelf(ends, wind), parameters={"l": 0.4}, backend="vm")
        for ends in (off, (0.0, 0.0))
    )
    np.testing.assert_allclose(found.effort("O"), exact.effort("O"), rtol=1e-15)
    np.testing.assert_array_equal(found.section("arm").bending, exact.section("arm").bending)
    (note,) = found.notes
    assert "taken as ends of links, moved by up to" in note
    assert f"{max(map(abs, off)):.2g} m" in note
    assert exact.notes == ()
    with pytest.raises(ParameterError, match="link 'arm'"):
        shelf((off[0], 1e-6), wind)
