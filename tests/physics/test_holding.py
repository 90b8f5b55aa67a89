"""The efforts that hold a mechanism at rest, beside frictions drawn within their limits around
vector Newton-Euler.
"""

from dataclasses import replace

import numpy as np
import pytest
import rubbing
from balance import apart, columns_at, oracle_of, postures
from click.testing import CliRunner
from commands import words
from internals import contents
from packer import CASE
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
    save,
)
from lagrange_casadi.actuators import duty_of
from lagrange_casadi.cli import program
from lagrange_casadi.errors import DeclarationError
from lagrange_casadi.motion import dwell, move, moves, polynomial

pytestmark = pytest.mark.usefixtures("interpreted")

DRAWN = 3000


def drawn_scene(seed, kind):
    """A slider-crank or a four-bar all of whose joints rub, at rest at a posture, under loads."""
    rng = np.random.default_rng(seed)
    m = Mechanism("held")
    crank = m.link("crank", length=rng.uniform(0.06, 0.1), mass=rng.uniform(0.2, 2.0))
    rod = m.link("rod", length=rng.uniform(0.25, 0.35), mass=rng.uniform(0.2, 2.0))
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
    drives, _ = apart(m, drives, m.values())
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


def test_a_slide_on_a_table_that_goes_on():
    """Its weight of 19.62 N, and mu times what its two edges bear of 40 N and of the moments; the
    table feels none of it.
    """
    m = Mechanism("two")
    table = m.link("table", length=0.2, mass=3.0, centre=(0.0, 0.0), inertia=0.01)
    slide = m.link("slide", length=0.2, mass=2.0, centre=(0.05, 0.0), inertia=0.01)
    m.friction("ways", m.prismatic("X", m.ground, table, axis=(1, 0)), mu=0.1, length=0.3)
    m.friction("gib", m.prismatic("Y", table, slide, axis=(0, 1)), mu=0.2, length=0.1)
    m.force("cut", slide, x=40.0)
    laws = {"X": polynomial(0.0, 0.3), "Y": moves([move(0.1, time=0.2), dwell(0.2)])}
    scene = Scene(m, laws, ["effort", "motion", "friction"], t=(0.25, 0.35, 3))
    solution = evaluate(scene)
    ranges = holding(scene, solution)
    assert (
        ranges["X"].least.tolist()
        == ranges["X"].largest.tolist()
        == pytest.approx(solution.effort("X"), nan_ok=True)
    )
    tilt = 2 * 9.81 * 0.05 / 0.1
    share = 0.2 * (abs(40 / 2 + tilt) + abs(40 / 2 - tilt))
    assert ranges["Y"].least == pytest.approx(19.62 - share, rel=1e-12)
    assert ranges["Y"].largest == pytest.approx(19.62 + share, rel=1e-12)
    assert ranges["Y"].worst == pytest.approx(19.62 + share, rel=1e-12)


def carried_along():
    """A carriage that goes on, and a link that it carries along without turning: its pin rests, its
    feet and the ways slide.
    """
    m = Mechanism("carried")
    carriage = m.link("carriage", length=0.2, mass=3.0, centre=(0.0, 0.0), inertia=0.01)
    link = m.link("link", length=0.2, mass=2.0)
    m.friction("ways", m.prismatic("X", m.ground, carriage, axis=(1, 0)), mu=0.1, length=0.3)
    m.friction("stiff", m.revolute("pin", carriage, link), mu=0.3, radius=0.02)
    m.slot("feet", m.ground.at(0.0, 0.05), link.tip, axis=(1, 0))
    laws = {"X": polynomial(0.1, 0.3)}
    return Scene(m, laws, ["effort", "motion", "friction"], t=(0, 0.1, 3), posture={"link": 0.2})


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


@pytest.mark.parametrize(
    ("scene", "joint", "why"),
    [
        (carried_along(), "X", "friction 'ways' slides, and depends on those at rest"),
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


def test_a_drive_is_sized_by_what_may_be_needed_at_rest(tmp_path):
    (tmp_path / "packer.py").write_text(CASE)
    scene = packer()
    solution = evaluate(scene)
    held = holding(scene, solution)["O"]
    duty = duty_of(solution, "O", efficiency=0.8, holding=held)
    rests = np.isnan(solution.effort("O"))
    assert duty.torque[rests] == pytest.approx(held.worst[rests] / 0.8, rel=1e-12)
    assert duty.torque[~rests] == pytest.approx(
        duty_of(solution.during(~rests), "O", efficiency=0.8).torque
    )
    assert duty_of(solution, "O", efficiency=0.8).torque.tolist() == duty.torque.tolist()
    with pytest.raises(DeclarationError, match=r"use the range of holding\(\)"):
        duty_of(replace(solution, holding={}), "O")
    told = (
        f"held at rest: effort:O may be anything from {held.least[rests].min():.5g} to"
        f" {held.largest[rests].max():.5g} N m"
    )
    out = ["--no-figures", "--out", str(tmp_path / "packer.h5")]
    for command in (["drive"], ["run", *out]):
        found = CliRunner().invoke(program, [command[0], str(tmp_path / "packer.py"), *command[1:]])
        assert found.exit_code == 0, found.output
        assert told in found.output
    out = [*words("--grid r=0.06,0.08 --want effort --quiet --out"), str(tmp_path / "sweep.h5")]
    found = CliRunner().invoke(program, ["sweep", str(tmp_path / "packer.py"), *out])
    assert found.exit_code == 0, found.output
    line = (
        f"note: in design 0 a joint with friction is at rest at {np.count_nonzero(rests)} of"
        f" {rests.size} instants"
    )
    assert found.output.count(line) == 1


@pytest.mark.parametrize(
    "scene",
    [packer(), carried_along(), in_space("bush"), drawn_scene(0, "four-bar")],
    ids=lambda s: s.mechanism.name,
)
def test_ranges_are_in_the_file_and_on_the_page(scene, tmp_path):
    solution = evaluate(scene)
    assert solution.holding
    assert solution.holding.keys() <= holding(scene, solution).keys()
    save(solution, tmp_path / "held.h5")
    assert check(tmp_path / "held.h5") == []
    read = load(tmp_path / "held.h5")
    assert read.notes == solution.notes
    shown = solution.during(slice(1, None))
    for name, held in solution.holding.items():
        again = read.holding[name]
        assert (again.unit, again.reason) == (held.unit, held.reason)
        for end in ("least", "largest"):
            np.testing.assert_array_equal(getattr(again, end), getattr(held, end))
            np.testing.assert_array_equal(getattr(shown.holding[name], end), getattr(held, end)[1:])
    for found in (solution, read):
        page = contents(found)
        assert {
            f"holding:{name}:{end}" for name in solution.holding for end in ("least", "largest")
        } <= {one["name"] for one in page["series"]}
        assert set(solution.notes) <= set(page["notes"])


@pytest.mark.parametrize("mistake", [(None, None), ("scene", None), (None, "solution")])
def test_misuse_is_told(mistake):
    with pytest.raises(DeclarationError, match=r"holding: (scene|solution): expected a S"):
        holding(*mistake)
