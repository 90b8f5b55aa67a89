"""Random mechanisms in space: the spatial oracle agrees with what must hold of any, and with the
planar oracle.
"""

import numpy as np
import oracle
import pytest
from spatial_algebra import arithmetic_of, cross, skew, vector
from spatial_bodies import GROUND, KINDS, Rigid
from spatial_mechanisms import (
    FAMILIES,
    arm,
    bennett,
    bricard,
    loop,
    planar_four_bar,
    planar_slider_crank,
    tree,
)
from spatial_motion import Motion, solve_motion

XI = (0.0, 0.1234567, 0.5012345, 0.9034567, 1.0)
LOOPS = [name for name in FAMILIES if name not in ("tree", "arm", "loop")]
CASES = (
    [("tree", seed) for seed in range(24)] + [("arm", 0)] + [("loop", seed) for seed in range(12)]
)
CASES += [(name, seed) for name in LOOPS for seed in range(2)]
PRECISE = [("tree", seed) for seed in range(8)] + [("loop", seed) for seed in range(5)]
PRECISE += [(name, 1) for name in LOOPS if name != "stewart"]
DIGITS = 40


def drawn(case):
    name, seed = case
    return FAMILIES[name](seed)


def largest(result):
    """The largest force, and the largest moment with the largest force at the mechanism's size."""
    force = max(float(max(abs(x[:3]))) for x in result.reactions.values())
    moment = max(float(max(abs(x[3:]))) for x in result.reactions.values())
    return 1.0 + force, 1.0 + moment + force * result.size


def identity(case):
    return "-".join(map(str, case))


@pytest.mark.sampled(9)
@pytest.mark.parametrize("case", CASES, ids=identity)
def test_both_sides_of_a_section_tell_the_same(case):
    one = drawn(case)
    found = one.solve(0.4 * one.span)
    force, moment = largest(found)
    for rod in one.rods:
        for xi in XI:
            gap = np.abs(found.sections[rod].at(xi) - found.sections[rod].at(xi, from_base=True))
            assert max(gap[:3]) < 1e-13 * force
            assert max(gap[3:]) < 1e-13 * moment


@pytest.mark.sampled(9)
@pytest.mark.parametrize("case", CASES, ids=identity)
def test_efforts_do_the_power_of_any_motion(case):
    """For a unit rate of each coordinate that is driven: d'Alembert's principle, in which no
    reaction is.
    """
    one = drawn(case)
    found, drives = one.solve(0.4 * one.span), one.drives(0.4 * one.span)
    balance, mechanism = found.balance, one.mechanism
    for driven in drives:
        rates = {key: (q, float(key == driven), 0.0) for key, (q, *_) in drives.items()}
        guess = {name: (pose.r, pose.R) for name, pose in found.poses.items()}
        poses, coordinates, _ = solve_motion(
            Motion(mechanism, drives, arithmetic_of(None), balance.pushed), rates, guess
        )
        told = sum(effort * coordinates[key][1] for key, effort in found.efforts.items())
        powers = []
        for body in mechanism.bodies:
            force, moment, _ = balance.inertia(body)
            powers += [
                force @ poses[body.name].velocity(body.inertias(arithmetic_of(None))[1]),
                moment @ poses[body.name].w,
            ]
        for act in balance.given():
            pose = poses[act.body]
            powers += [
                -act.force @ (pose.v + cross(pose.w, act.place - pose.r)),
                -act.moment @ pose.w,
            ]
        assert abs(told - sum(powers)) < 1e-11 * max(1.0, *(abs(x) for x in powers))
        for joint in mechanism.joints:
            # What a joint bears is what lets its own motions be.
            at, (parent, child) = (
                found.poses[joint.child].at(np.array(joint.at_child)),
                (poses[joint.parent], poses[joint.child]),
            )
            apart = (
                child.v + cross(child.w, at - child.r) - parent.v - cross(parent.w, at - parent.r)
            )
            power = found.reactions[joint.name] @ np.concatenate([apart, child.w - parent.w])
            assert abs(power) < 1e-11 * sum(largest(found)) * (
                1 + np.max(np.abs(apart)) + np.max(np.abs(child.w))
            )


@pytest.mark.sampled(13)
@pytest.mark.parametrize("case", PRECISE, ids=identity)
def test_rates_are_derivatives_and_power_is_what_energy_gains(case):
    one, h = drawn(case), arithmetic_of(DIGITS).number("1e-10")
    t = arithmetic_of(DIGITS).number(0.4 * one.span)
    guess = one.followed(t)
    before, now, after = (one.solve(x, DIGITS, guess) for x in (t - h, t, t + h))
    for name, pose in now.poses.items():
        a, b = before.poses[name], after.poses[name]
        spins = np.max(np.abs(now.idle[name]), initial=0.0) > 1e-9
        columns = slice(1) if spins else slice(3)
        spin = skew(pose.w)
        for gap in (
            (b.r - a.r) / (2 * h) - pose.v,
            (b.r - 2 * pose.r + a.r) / h**2 - pose.a,
            ((b.R - a.R) / (2 * h) - spin @ pose.R)[:, columns],
            ((b.R - 2 * pose.R + a.R) / h**2 - (skew(pose.alpha) + spin @ spin) @ pose.R)[
                :, columns
            ],
        ):
            assert np.max(np.abs(gap)) < 1e-15
    for key, (_, rate, acceleration) in now.coordinates.items():
        a, q, b = (x.coordinates[key][0] for x in (before, now, after))
        assert abs((b - a) / (2 * h) - rate) < 1e-15
        assert abs((b - 2 * q + a) / h**2 - acceleration) < 1e-15
    power = sum(effort * now.coordinates[key][1] for key, effort in now.efforts.items())
    for act in now.balance.given():
        pose = now.poses[act.body]
        power += act.force @ (pose.v + cross(pose.w, act.place - pose.r)) + act.moment @ pose.w
    gain = (energy(one.mechanism, after) - energy(one.mechanism, before)) / (2 * h)
    assert abs(gain - power) < 1e-13 * (1 + abs(gain))


def energy(mechanism, result):
    """Kinetic energy and that of weights."""
    arithmetic, total = arithmetic_of(DIGITS), 0
    for body in mechanism.bodies:
        mass, centre, inertia = body.inertias(arithmetic)
        pose = result.poses[body.name]
        v, w = pose.velocity(centre), pose.R.T @ pose.w
        total += (
            mass * (v @ v) / 2
            + w @ inertia @ w / 2
            - mass * (vector(arithmetic, mechanism.gravity) @ pose.at(centre))
        )
    return total


@pytest.mark.sampled(13)
@pytest.mark.parametrize("case", [*PRECISE, ("stewart", 0)], ids=identity)
def test_doubles_are_as_right_as_doubles_can_be(case):
    one = drawn(case)
    t = 0.4 * one.span
    rough = one.solve(t)
    found = one.solve(t, DIGITS, one.followed(t))
    force, moment = largest(rough)
    assert rough.open == found.open
    for joint, reaction in rough.reactions.items():
        for k, size in ((slice(3), force), (slice(3, 6), moment)):
            shut = [not {(joint, m)} & rough.open for m in ("fx", "fy", "fz", "mx", "my", "mz")][k]
            assert (
                np.max(
                    np.abs((reaction - found.reactions[joint].astype(float))[k][shut]), initial=0.0
                )
                < 1e-12 * size
            )
    for rod in one.rods:
        shut = ~np.array(rough.open_section(rod, 0.3))
        gap = np.abs(rough.sections[rod].at(0.3) - found.sections[rod].at(0.3).astype(float))
        assert np.max(gap[shut] / np.array([force] * 3 + [moment] * 3)[shut], initial=0.0) < 1e-12


@pytest.mark.sampled(7)
@pytest.mark.parametrize("draw", [planar_four_bar, planar_slider_crank])
@pytest.mark.parametrize("seed", range(6))
def test_a_planar_loop_somewhere_in_space_has_the_planar_forces(draw, seed):
    one = draw(seed)
    t, R = 0.6 * one.span, one.plane
    found = one.solve(t)
    force, moment = largest(found)
    drive = one.drives(t)["O", 0]
    guess = flattened(one, found)
    # The planar oracle counts turns.
    guess["crank"] = (*guess["crank"][:2], drive[0])
    flat = planar(one).solve({"O": drive}, guess)
    assert len(found.wrenches.null) == 3
    assert found.efforts["O", 0] == pytest.approx(flat.efforts["O"], abs=1e-12 * moment)
    within = np.zeros((3, 6))
    within[:2, :3], within[2, 3:] = R[:, :2].T, R[:, 2]
    for joint, reaction in found.reactions.items():
        assert np.max(np.abs(within @ found.loose_reactions[joint])) < 1e-9
        gap = np.abs(within @ reaction - np.array(flat.reactions[joint], dtype=float))
        assert max(gap / [force, force, moment]) < 1e-12
    for rod in one.rods:
        for xi in XI:
            assert (
                found.open_section(rod, xi)[0::5]
                == found.open_section(rod, xi)[1:2] * 2
                == (False, False)
            )
            own = found.sections[rod].at(xi)[[0, 1, 5]]
            assert max(np.abs(own - flat.sections[rod](xi)) / [force, force, moment]) < 1e-12


def planar(one):
    """The planar oracle's mechanism of a planar draw."""
    bodies, joints, R = [], [], one.plane
    for body in one.mechanism.bodies:
        if isinstance(body, Rigid):
            bodies.append(
                oracle.Body(body.name, body.mass, 0.0, tuple(body.centre[:2]), body.inertia[2][2])
            )
        else:
            bodies.append(
                oracle.from_density(
                    body.name,
                    body.length,
                    lambda u, b=body: np.polyval(b.density[::-1], u) * b.length,
                )
            )
    base = np.array(one.mechanism.joint("O").at_parent, dtype=float)
    for joint in one.mechanism.joints:
        at = np.array(joint.at_parent, dtype=float)
        at = R.T @ (at - base) if joint.parent == GROUND else at
        child = np.array(joint.at_child, dtype=float)
        joints.append(
            oracle.Joint(joint.name, joint.kind, (joint.parent, *at[:2]), (joint.child, *child[:2]))
        )
    return oracle.Oracle(bodies, joints, gravity=tuple((R.T @ one.mechanism.gravity)[:2]))


def flattened(one, found):
    R, base = one.plane, np.array(one.mechanism.joint("O").at_parent, dtype=float)
    guess = {}
    for name, pose in found.poses.items():
        at, x = R.T @ (pose.r - base), R.T @ pose.R[:, 0]
        guess[name] = (*at[:2], np.arctan2(x[1], x[0]))
    return guess


@pytest.mark.parametrize(("draw", "count"), [(bennett, 3), (bricard, 1)])
@pytest.mark.parametrize(
    "seed", [*range(2), *(pytest.param(seed, marks=pytest.mark.long) for seed in range(2, 4))]
)
def test_loops_that_move_by_their_proportions_leave_reactions_open_but_no_effort(draw, count, seed):
    one = draw(seed)
    found = one.solve(0.5 * one.span)
    assert not found.vague
    assert len(found.wrenches.null) == count
    assert np.max(np.abs(found.loose_efforts["j0", 0])) < 1e-9
    assert {joint for joint, _ in found.open} == {joint.name for joint in one.mechanism.joints}


def test_every_joint_is_drawn():
    kinds = {joint.kind for seed in range(24) for joint in tree(seed).mechanism.joints}
    assert kinds == {*KINDS}


def test_a_draw_is_the_same_again():
    for draw in (tree, arm, loop.__wrapped__):
        same, again, other = (
            np.concatenate([*draw(seed).solve(0.1).reactions.values()]) for seed in (5, 5, 6)
        )
        assert np.array_equal(same, again)
        assert not np.array_equal(same, other)
