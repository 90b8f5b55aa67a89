"""What rubs comes to rest, turns back or jams: what is then open, what may be needed to hold it,
and what is told of the instants that move.
"""

from __future__ import annotations

import math
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
import rubbing
from balance import columns_at, oracle_of, postures
from mechanisms import links_of, pins_of
from packer import scene as packer

from lagrange_casadi import (
    Mechanism,
    Scene,
    SpatialMechanism,
    check,
    derive,
    evaluate,
    holding,
    load,
    prepare,
    save,
    sweep,
    tolerances,
)
from lagrange_casadi.actuators import duty_of
from lagrange_casadi.errors import AssemblyError, DeclarationError
from lagrange_casadi.motion import dwell, expression, move, moves, polynomial

pytestmark = pytest.mark.usefixtures("interpreted")

WEIGHT, ARM = 50.0, 0.2


every = pytest.mark.parametrize("backend", ["lanes", "c", "vm"])


def pushed_beside():
    """A block on a guide, pushed along it at an arm: it locks where the guide is shorter than 2 mu
    times the arm.
    """
    m = Mechanism("drawer")
    mu, length = m.parameter("mu", 0.2), m.parameter("length", 0.1, "m")
    block, pusher = links_of(m, block=(0.3, 2.0), pusher=(0.1, 0.0))
    m.set_gravity(0.0, 0.0)
    m.prismatic("O", m.ground.at(0.0, ARM), pusher, axis=(1, 0))
    guide = m.prismatic("guide", m.ground, block, axis=(1, 0))
    m.slot("hand", pusher, block.at(0.0, ARM), axis=(0, 1))
    m.force("load", block, x=-WEIGHT)
    m.friction("rub", guide, mu=mu, length=length)
    return Scene(m, {"O": polynomial(0.0, 0.5)}, t=(0, 0.1, 9))


@every
def test_a_drawer_pushed_beside_its_guide(backend):
    """F = W/(1 - 2 mu e/b) closed form; without end where b comes to 2 mu e, and none beyond."""
    scene = pushed_beside()
    for mu, length in ((0.2, 0.1), (0.2, 0.081), (0.35, 0.9), (0.0, 0.01)):
        solution = evaluate(scene, parameters={"mu": mu, "length": length}, backend=backend)
        assert solution.certified
        force = WEIGHT / (1 - 2 * mu * ARM / length)
        assert solution.effort("O") == pytest.approx(force, rel=1e-12 / (1 - 2 * mu * ARM / length))
        assert solution.series["friction:rub:along"] == pytest.approx(
            WEIGHT - force, rel=1e-10, abs=1e-12
        )
        assert solution.series["friction:rub:loss"] == pytest.approx(
            0.5 * (force - WEIGHT), rel=1e-10, abs=1e-12
        )
    for length in (0.08, 0.0799999, 0.05):
        with pytest.raises(
            AssemblyError, match=r"friction 'rub': the mechanism jams at t = 0 s, where O = 0 m: "
        ):
            evaluate(scene, parameters={"length": length}, backend=backend)


@pytest.mark.parametrize("backend", ["lanes", "c"])
def test_designs_that_jam_have_no_numbers(backend):
    ready = prepare(pushed_beside(), backend=backend)
    found = ready.designs(np.array([[0.2, 0.1], [0.2, 0.08], [0.2, 0.05], [0.1, 0.05]]))
    assert (found.status == 0).tolist() == [True, False, False, True]
    told = np.array([WEIGHT / 0.2, np.nan, np.nan, WEIGHT / 0.2])
    efforts = found.value[:, ready.quantities.index("effort:O")]
    np.testing.assert_allclose(efforts, told, rtol=1e-11)


def reciprocating(motion, **options):
    m = Mechanism("reciprocating")
    mu = m.parameter("mu", 0.15)
    crank, rod = m.link("crank", length=0.1, mass=0.8), m.link("rod", length=0.25, mass=1.1)
    piston = m.link("piston", length=0.05, mass=0.6, centre=(0.0, 0.0), inertia=1e-4)
    pins_of(m, O=(m.ground, crank), A=(crank.tip, rod))
    wrist = m.revolute("B", rod.tip, piston)
    bore = m.prismatic("bore", m.ground, piston, axis=(1, 0))
    m.force("gas", piston, x=-900.0)
    m.friction("ring", bore, mu=mu, length=0.06)
    m.friction("pin", wrist, mu=mu, radius=0.01)
    return Scene(m, {"O": motion}, posture={"rod": 0.0}, **options)


TURN = 2 * math.pi / 30.0


@every
def test_at_a_dead_centre_the_sign_is_that_of_the_instants_right_after(backend):
    """The end of a stroke is an instant among others: it has the values right after, on either side
    of the stroke.
    """
    scene = reciprocating(polynomial(0.0, 30.0), t=(0, TURN, 9))
    solution, after = (
        evaluate(scene, backend=backend, t=t) for t in ((0, TURN, 9), (1e-11, TURN + 1e-11, 9))
    )
    assert solution.certified
    assert not solution.resting.any()
    assert solution.motion("bore").rate[[0, 4, 8]] == pytest.approx(0.0, abs=1e-12)
    ring = solution.series["friction:ring:along"]
    assert ring == pytest.approx(after.series["friction:ring:along"], rel=1e-6)
    assert solution.effort("O") == pytest.approx(after.effort("O"), rel=1e-6, abs=1e-6)
    assert ring[0] > 0.0 > ring[4]


def start_and_stop(t):
    """From rest to rest in half a second, then at rest."""
    u = ca.fmin(t / 0.5, 1.0)
    return 0.3 + 10 * u**3 - 15 * u**4 + 6 * u**5


@pytest.mark.sampled(4)
@pytest.mark.parametrize(
    "options", [{"backend": "lanes"}, {"backend": "c"}, {"backend": "vm"}, {"precision": "single"}]
)
def test_at_rest_friction_is_open_and_all_else_is_not(options, tmp_path):
    scene = reciprocating(expression(start_and_stop), t=(0, 1, 41))
    solution = evaluate(scene, **options)
    resting = (solution.t >= 0.5) | (solution.t == 0.0)
    assert solution.certified
    for name in ("effort:O", "friction:ring:along", "reaction:bore:fy", "load:pin:mz"):
        assert np.isnan(solution.array(name)).tolist() == resting.tolist(), name
        assert np.isfinite(solution.peak(name).value), name
    for name in ("motion:bore", "load:gas:fx"):
        assert np.isfinite(solution.array(name)).all()
    note, held = solution.notes
    assert held.startswith("held at rest: effort:O may be anything from")
    assert "is at rest at 22 of 41 instants, first at t = 0 s" in note
    assert "ring, pin" in note
    save(solution, tmp_path / "rest.h5")
    assert check(tmp_path / "rest.h5") == []
    assert load(tmp_path / "rest.h5").resting.tolist() == resting.tolist()


DRAWN = 3000


def drawn_scene(seed, kind):
    """A slider-crank or a four-bar all of whose joints rub, at rest at a posture, under loads."""
    rng = np.random.default_rng(seed)
    m = Mechanism("held")
    crank, rod = links_of(
        m,
        crank=(rng.uniform(0.06, 0.1), rng.uniform(0.2, 2.0)),
        rod=(rng.uniform(0.25, 0.35), rng.uniform(0.2, 2.0)),
    )
    pins = [m.revolute("O", m.ground, crank), m.revolute("A", crank.tip, rod)]
    last = m.link("last", length=0.25, mass=2.0)
    pins.append(m.revolute("B", rod.tip, last if kind == "slider" else last.tip))
    if kind == "slider":
        guide = m.prismatic("C", m.ground.at(0.0, rng.uniform(-0.03, 0.03)), last, axis=(1, 0))
        m.friction("rub_C", guide, mu=rng.uniform(0.05, 0.25), length=rng.uniform(0.05, 0.2))
    else:
        pins.append(m.revolute("C", m.ground.at(0.3, 0.0), last))
    for pin in pins:
        m.friction(f"rub_{pin.name}", pin, mu=rng.uniform(0.1, 0.3), radius=rng.uniform(0.01, 0.04))
    m.force(
        "push",
        last.at(rng.uniform(0.0, 0.2), 0.0),
        x=rng.uniform(-300, 300),
        y=rng.uniform(-300, 300),
    )
    m.torque("twist", rod, rng.uniform(-10, 10))
    law = moves([dwell(0.1), move(0.2, time=0.3)], start=rng.uniform(0.3, 2.5))
    law = polynomial(rng.uniform(0.3, 2.5)) if seed % 2 else law
    return Scene(
        m, {"O": law}, ["effort", "motion", "friction"], t=(0, 0.05, 2), posture={"rod": 0.5}
    )


def by_drawing(scene, rng):
    """The efforts of the first instant with all frictions at limits, and with frictions that are
    drawn within them.
    """
    m = scene.mechanism
    found, drives = columns_at(derive(scene), 0.0, m.values())
    plain = oracle_of(m, m.values())
    joints = {joint.name: joint for joint in plain.joints}
    loads = [load for load in m.loads.values() if type(load).__name__ == "Friction"]
    rubs = [rubbing.Rub(joints[load.joint.name], **load.numbers) for load in loads]
    push, twist = m.loads["push"], m.loads["twist"]
    given = [((push.point.body.name, push.point.x, 0.0), *push.components)]
    given += [(("rod", 0.0, 0.0), 0.0, 0.0, twist.components[2])]
    rubbed = replace(plain, loads=(lambda place: given, *(rub.acts for rub in rubs)))
    guess = postures(m, found, drives, 0.02)

    def balanced(forces):
        for rub, force in zip(rubs, forces, strict=True):
            rub.force = force
        result = rubbed.solve(drives, guess)
        return np.array(
            [result.efforts["O"], *(x for rub in rubs for x in result.reactions[rub.joint.name])]
        )

    alone = balanced(np.zeros(len(rubs)))
    slopes = np.stack([balanced(unit) - alone for unit in np.eye(len(rubs))], axis=-1)
    corners = np.array(np.meshgrid(*[[-1.0, 1.0]] * len(rubs))).reshape(len(rubs), -1)
    within = rng.uniform(-1, 1, (len(rubs), DRAWN))
    within[rng.random(within.shape) < 0.3] = 0.0
    shares = np.concatenate([corners, within], axis=1)
    s = np.zeros_like(shares)
    for _ in range(200):
        borne = (alone[:, None] + slopes @ s)[1:].reshape(len(rubs), 3, -1)
        s = shares * np.array(
            [limit(rub, *reaction) for rub, reaction in zip(rubs, borne, strict=True)]
        )
    efforts = (alone[:, None] + slopes @ s)[0]
    return efforts[: corners.shape[1]], efforts[corners.shape[1] :]


def limit(rub, fx, fy, mz):
    if not rub.joint.slides:
        return rub.mu * rub.radius * np.hypot(fx, fy)
    return rub.mu * (abs(fy / 2 + mz / rub.length) + abs(fy / 2 - mz / rub.length))


@pytest.mark.parametrize("kind", ["slider", "four-bar"])
@pytest.mark.parametrize(
    "seed", [*range(2), *(pytest.param(seed, marks=pytest.mark.long) for seed in range(2, 4))]
)
def test_no_friction_within_its_limits_asks_for_more(seed, kind):
    scene = drawn_scene(seed, kind)
    held = holding(scene, evaluate(scene))["O"]
    assert held.reason == ""
    corners, within = by_drawing(scene, np.random.default_rng(seed))
    size = np.abs(corners).max()
    assert held.least[0] == pytest.approx(corners.min(), abs=1e-9 * size)
    assert held.largest[0] == pytest.approx(corners.max(), abs=1e-9 * size)
    assert (
        held.least[0] - 1e-9 * size <= within.min() <= within.max() <= held.largest[0] + 1e-9 * size
    )
    assert within.max() - within.min() > 0.3 * (corners.max() - corners.min())


def in_space(kind):
    """A rod in a bush that slides and turns, or a bar on a ball: both at rest."""
    m = SpatialMechanism(kind)
    link = m.link("link", length=0.2, mass=2.0, centre=(0.1, 0, 0), inertia=(1e-3, 1e-2, 1e-2))
    if kind == "bush":
        joint = m.cylindrical("C", m.ground, link, axis=(1, 0, 0))
        for along in ("slide", "turn"):
            m.friction(f"rub_{along}", joint, along=along, mu=0.1, radius=0.01, length=0.1)
    else:
        m.friction("rub_ball", m.spherical("C", m.ground, link), mu=0.1, radius=0.01)
    motion = {name: polynomial(0.1) for name in m.coordinates}
    return Scene(m, motion, ["effort", "motion", "friction"], t=(0, 1, 2))


def arm(count):
    """Links one after another, with friction in each joint, that do not move."""
    m = Mechanism("arm")
    parent = m.ground
    for k in range(count):
        link = m.link(f"link{k}", length=0.1, mass=1.0)
        m.friction(f"rub{k}", m.revolute(f"J{k}", parent, link), mu=0.1, radius=0.01)
        parent = link.tip
    motion = {name: polynomial(0.1) for name in m.coordinates}
    return Scene(m, motion, ["effort", "motion", "friction"], t=(0, 1, 2))


@pytest.mark.parametrize(
    ("scene", "joint", "why"),
    [
        (
            in_space("bush"),
            "C:slide",
            "friction 'rub_slide' may hold its joint in more than one direction",
        ),
        (
            in_space("ball"),
            "C:turn_1",
            "friction 'rub_ball' may hold its joint in more than one direction",
        ),
        (arm(11), "J3", "11 frictions are at rest, at most 10 are supported"),
    ],
)
def test_what_is_not_exact_is_not_told(scene, joint, why):
    solution = evaluate(scene)
    ranges = holding(scene, solution)
    assert ranges[joint].reason == why
    assert f"held at rest: effort:{joint} is not evaluated: {why}" in solution.notes
    open_ = np.isnan(solution.effort(joint))
    assert open_.any()
    assert np.isnan(ranges[joint].least[open_]).all()
    with pytest.raises(
        DeclarationError, match=f"joints with friction are at rest there, and {why}"
    ):
        duty_of(solution, joint, holding=ranges[joint])


def test_a_drive_is_sized_by_what_may_be_needed_at_rest():
    solution = evaluate(packer())
    held, rests = holding(packer(), solution)["O"], np.isnan(solution.effort("O"))
    duty = duty_of(solution, "O", efficiency=0.8, holding=held)
    assert duty.torque[rests] == pytest.approx(held.worst[rests] / 0.8, rel=1e-12)
    moving = duty_of(solution.during(~rests), "O", efficiency=0.8)
    assert duty.torque[~rests] == pytest.approx(moving.torque)
    assert duty_of(solution, "O", efficiency=0.8).torque.tolist() == duty.torque.tolist()
    with pytest.raises(DeclarationError, match=r"use the range of holding\(\)"):
        duty_of(replace(solution, holding={}), "O")


@pytest.mark.parametrize(
    "seed", [*range(1), *(pytest.param(seed, marks=pytest.mark.long) for seed in range(1, 3))]
)
def test_any_dwell_is_as_if_the_instants_at_rest_were_not_there(seed):
    draw = np.random.default_rng(seed)
    drawn = packer(draw.uniform(0.05, 0.3), draw.uniform(0.3, 2.0), int(draw.integers(41, 81)))
    solution = evaluate(drawn)
    assert 0 < np.count_nonzero(solution.resting) < solution.t.size
    moving = solution.during(~solution.resting)
    assert solution.safety("rod") == moving.safety("rod")
    assert solution.life("rod").damage == moving.life("rod").damage
    assert solution.stress("rod").peak("tresca") == moving.stress("rod").peak("tresca")
    largest = solution.stress("rod").largest("von_mises").value
    assert np.isnan(largest).tolist() == solution.resting.tolist()
    assert np.nanmax(largest) == pytest.approx(
        solution.stress("rod").peak("von_mises").value, rel=1e-9
    )
    for name in ("effort:O", "reaction:bore:fy", "section:rod:axial"):
        assert solution.peak(name) == moving.peak(name)
        assert solution.statistics(name).smallest == moving.statistics(name).smallest


def test_sweeps_and_searches_see_the_same():
    found, solution = sweep(packer(), {"r": [0.06, 0.08]}), evaluate(packer())
    assert found["status"].tolist() == [0, 0]
    mean = solution.statistics("effort:O").mean
    assert found["mean:effort:O"][1] == pytest.approx(mean, rel=1e-9)
    assert found["life:rod"][1] == solution.life("rod").cycles
    told = solution.safety("rod").against("fatigue")
    assert found["least:fatigue:rod"][1] == pytest.approx(told, rel=1e-2)
    spread = tolerances(packer(), {"r": 0.001}, wanted=["effort"], samples=32)
    assert spread.failed == 0
    assert np.isfinite(spread.peaks["effort:O"].sigma)
