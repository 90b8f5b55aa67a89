"""Angles that loads see with their turns, against vector Newton-Euler that is followed from the
start in small steps.

The oracle carries directions as numbers that go on continuously: it counts turns by having been
there.
"""

import math

import casadi as ca
import numpy as np
import pytest
from balance import columns_at, oracle_of, postures
from compiled import EVALUATED, told
from hypothesis import given, settings
from hypothesis import strategies as st
from internals import DesignEngine, EvaluationMethod, Status, depends_on_turns, refine
from mechanisms import (
    DAMPING,
    DRAG_LINK,
    FREE,
    STIFFNESS,
    coil,
    slider_crank,
    sprung,
    truss_platform,
)

from lagrange_casadi import Mechanism, Scene, derive, evaluate, export, table
from lagrange_casadi.errors import AssemblyError, DeclarationError
from lagrange_casadi.motion import harmonic, polynomial

pytestmark = pytest.mark.usefixtures("interpreted")

SMALL = 0.05


class Coil:
    """The same spring for the oracle; its angle starts in (-pi, pi]."""

    def __init__(self, joint):
        self.child, self.parent = (
            (p.body.name, float(p.x), float(p.y)) for p in (joint.child, joint.parent)
        )
        self.turns = None

    def __call__(self, place):
        child, parent = place(self.child)[2], place(self.parent)[2]
        bend = child - parent
        if self.turns is None:
            self.turns = -math.ceil(bend.v / math.tau - 0.5)
        couple = -STIFFNESS * (bend.v + math.tau * self.turns - FREE) - DAMPING * bend.d
        return [(self.child, 0.0, 0.0, couple), (self.parent, 0.0, 0.0, -couple)]


def assert_followed(scene, joints, count=5, **keywords):
    """Efforts, reactions, section forces and springs at some instants, with the oracle followed to
    them.
    """
    m, (start, stop, _) = scene.mechanism, scene.t
    values = m.values(keywords.get("parameters"))
    solution = evaluate(scene, t=(start, stop, count), **keywords)
    program = derive(scene)
    oracle = oracle_of(m, values, loads=[Coil(m.joints[joint]) for joint in joints])
    found, drives = columns_at(program, start, values)
    guess, before, worst = postures(m, found, drives, 0.02), start, 0.0
    for joint, (drive, *_) in drives.items():
        parent, child = (guess.get(body.name, (0.0, 0.0, 0.0)) for body in m.joints[joint].bodies)
        if m.joints[joint].coordinate == "angle":
            # The oracle wants the drive's turns between its two bodies.
            turns = round((parent[2] + drive - child[2]) / math.tau)
            guess[m.joints[joint].child.body.name] = (*child[:2], child[2] + math.tau * turns)
    size = max(
        np.abs(solution.reaction(name).fx).max() + np.abs(solution.reaction(name).fy).max()
        for name in m.joints
    )
    for i, t in enumerate(solution.t):
        fast = max(
            abs(rate)
            for moment in (before, t)
            for rate in program.motion(moment, list(values.values()))[1].full().ravel()
        )
        for step in np.linspace(before, t, 2 + int(fast * (t - before) / SMALL))[1:] if i else [t]:
            d = [x.full().ravel() for x in program.motion(step, list(values.values()))]
            drives = {joint: tuple(row[k] for row in d) for k, joint in enumerate(program.driven)}
            # On the way the motion is enough.
            solved = oracle.solve(drives, guess) if step == t else oracle.move(drives, guess)
            guess = {body: tuple(x.v for x in q) for body, q in solved.q.items()}
        before = t
        gaps = [solution.effort(joint)[i] - effort for joint, effort in solved.efforts.items()]
        for name, (fx, fy, _) in solved.reactions.items():
            gaps += [solution.reaction(name).fx[i] - fx, solution.reaction(name).fy[i] - fy]
        for link in solution.links_with_sections:
            law = solution.section(link).law
            for u in (0.0, 0.37, 0.81):
                forces = zip(("axial", "shear", "bending"), solved.sections[link](u), strict=True)
                gaps += [
                    law.at(force, np.full((count, 1), u))[i, 0] - true for force, true in forces
                ]
        worst = max(worst, *map(abs, gaps))
    assert worst < 1e-10 * size
    return solution


@pytest.mark.sampled(7)
@pytest.mark.parametrize("joint", ["A", "B", "C"])
@pytest.mark.parametrize("kind", [{}, DRAG_LINK], ids=["crank_rocker", "drag_link"])
def test_a_torsion_spring_goes_on_past_half_a_turn(kind, joint):
    """Two turns: of a crank-rocker the crank's joint goes round, of a drag link both joints at the
    ground do.
    """
    scene = sprung(joint, **kind)
    solution = assert_followed(scene, joint)
    angle = solution.motion(joint)
    fine = evaluate(scene)
    torque, angle = fine.series[f"load:coil_{joint}:mz"], fine.motion(joint)
    np.testing.assert_allclose(
        torque, -STIFFNESS * (angle.value - FREE) - DAMPING * angle.rate, rtol=0, atol=1e-12
    )
    rounds = (angle.value[-1] - angle.value[0]) / math.tau
    assert rounds == pytest.approx(
        {("A", False): -2.0, ("C", True): 2.0}.get((joint, kind == DRAG_LINK), 0.0), abs=1e-12
    )


@settings(max_examples=8, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_random_four_bars(seed):
    """Whatever goes round, from whatever posture, in either branch, backwards too: right, or the
    loop does not close.
    """
    generator = np.random.default_rng(seed)
    lengths, frame = generator.uniform(0.1, 0.5, 3), generator.uniform(-0.4, 0.4, 2)
    rate, start = generator.uniform(-9.0, 9.0), generator.uniform(-20.0, 20.0)
    joints = generator.choice(["A", "B", "C"], generator.integers(1, 4), replace=False).tolist()
    scene = sprung(
        joints,
        tuple(lengths),
        tuple(frame),
        generator.uniform(-3.0, 3.0),
        polynomial(start, rate),
        count=201,
    )
    try:
        evaluate(scene, backend="vm")
    except (AssemblyError, DeclarationError) as error:
        if not any(
            words in str(error)
            for words in ("cannot be closed", "dead centre", "assembled in two ways")
        ):
            raise
        return
    assert_followed(scene, joints, count=3)


@pytest.mark.sampled(7)
@pytest.mark.parametrize(
    "law",
    [polynomial(5.0, -3.0), harmonic(0.4, 9.0, 0.5), harmonic(100.0, 0.3, 2.0)],
    ids=["back", "both", "swing"],
)
def test_the_drive_may_go_back_and_forth(law):
    assert_followed(sprung("AC", law=law), "AC")
    assert_followed(sprung("AC", law=law, **DRAG_LINK), "AC")


def test_it_does_not_matter_which_instants_are_asked_for():
    """The second turn alone, one instant alone, and few instants far apart: what was there is
    there.
    """
    scene = sprung("AC", **DRAG_LINK)
    whole = evaluate(scene, t=(0.0, 2.0, 201))
    for grid, rows in (
        ((1.0, 2.0, 101), slice(100, None)),
        ((1.7, 1.7, 1), slice(170, 171)),
        ((0.0, 2.0, 3), slice(None, None, 100)),
    ):
        part = evaluate(scene, t=grid)
        for name in ("load:coil_A:mz", "load:coil_C:mz", "effort:O", "reaction:B:fx"):
            np.testing.assert_allclose(
                part.series[name], whole.series[name][rows], rtol=1e-12, atol=1e-12
            )


def test_a_table_serves_what_comes_round_and_says_what_does_not():
    """Where both ends of a spring go round together, the spring only swings; where one does, it
    winds up and repeats never.
    """
    together = sprung("AB", **DRAG_LINK)
    exact, read = evaluate(together), evaluate(together, table=1e-9)
    np.testing.assert_allclose(
        read.effort("O"), exact.effort("O"), rtol=0, atol=1e-8 * np.abs(exact.effort("O")).max()
    )
    with pytest.raises(
        DeclarationError,
        match=r"effort:O.* do not repeat.*a load that depends on a number of revolutions may not"
        r" repeat",
    ):
        evaluate(sprung("C", **DRAG_LINK), table=64, wanted=["effort"])


@pytest.mark.sampled(3)
@pytest.mark.parametrize("backend", ["auto", "c", "vm"])
def test_sweeps_count_the_same_and_refuse_by_name(backend):
    """Among them a crank-rocker where the defaults are a drag link: its turns are others."""
    scene = sprung("C", **DRAG_LINK, parametric=True, count=65)
    wanted = ["effort", "load:coil_C"]
    engine = DesignEngine.of(scene, wanted, None, EvaluationMethod(backend))
    # The first crank-rocker comes near a dead centre, and the last one does not.
    designs = np.array(
        [
            [0.3, 0.35, 0.32],
            [0.32, 0.36, 0.3],
            [0.05, 0.35, 0.32],
            [1.0, 0.1, 0.1],
            [0.02, 0.1, 0.1],
        ]
    )
    outcome = engine.evaluate(designs, histories=True)
    assert outcome.status.tolist() == [
        Status.OK,
        Status.OK,
        Status.TURNED,
        Status.OUT_OF_REACH,
        Status.TURNED,
    ]
    for design, series in zip(designs[:2], outcome.series[:2], strict=True):
        solution = evaluate(
            scene, parameters=dict(zip("pqr", design, strict=True)), wanted=wanted, backend="vm"
        )
        for name, values in zip(engine.columns, series, strict=True):
            np.testing.assert_allclose(values, solution.series[name], rtol=1e-12, atol=1e-12)
    with pytest.raises(
        AssemblyError,
        match=r"the angle of 'C', on whose number of revolutions a load depends, is .* deg from"
        r" the middle",
    ):
        evaluate(scene, parameters={"p": 0.05})


def test_exported_c_refuses_what_might_be_a_turn_further(tmp_path):
    """As the API does; and where it does not, a call knows nothing of the one before."""
    made = export(sprung("C", **DRAG_LINK, parametric=True), tmp_path)
    prepare = "status = @_prepare(&model, &parameters); @_motion(&model, %s, &inputs); "
    far = prepare % 1.75 + EVALUATED
    (_, effort, sentence), *others = told(
        tmp_path,
        made,
        "parameters.p = 0.05; " + prepare % 0.02 + EVALUATED,
        far,
        prepare % 0.25 + EVALUATED + far.partition("; ")[2],
    )
    assert (
        sentence
        == "a load depends on the number of revolutions of an angle, which cannot be determined"
    )
    assert math.isnan(effort)
    solution = evaluate(sprung("C", **DRAG_LINK, parametric=True), t=(0.0, 1.75, 8), backend="c")
    for status, effort, _ in others:
        assert (status, effort) == (0, pytest.approx(solution.effort("O")[-1], rel=1e-5))


def test_peaks_between_instants_see_the_turns():
    scene = sprung("C", **DRAG_LINK)
    fine = evaluate(scene, t=(0.0, 2.0, 20001), wanted=["effort"])
    (peak,) = refine(scene, evaluate(scene, t=(0.0, 2.0, 41), wanted=["effort"]), ["effort:O"])
    assert peak.value == pytest.approx(fine.peak("effort:O").value, rel=1e-6)


@pytest.mark.long
def test_loops_that_are_iterated():
    """Three bars on three legs, and springs between legs and bars; one of
    them crosses half a turn.
    """

    def loads(m):
        for joint in ("corner0", "mate1", "foot2"):
            coil(m, joint)

    scene = truss_platform(loads)
    assert derive(scene).newton is not None
    assert_followed(scene, ("corner0", "mate1", "foot2"), count=21)


def whitworth(direction=False):
    """A crank's pin in the slot of a link whose pivot lies within the crank's circle: the slotted
    link goes all the way round.
    """
    m = Mechanism("whitworth")
    a, b = m.link("a", length=0.3, mass=0.3), m.link("b", length=0.6, mass=0.5)
    m.revolute("O", m.ground, a)
    pivot = m.revolute("Q", m.ground.at(0.12, -0.05), b)
    m.slot("S", b, a.tip)
    if direction:
        m.torque("coil_Q", b, -STIFFNESS * (m.direction(b) - FREE) - DAMPING * m.rate(pivot))
    else:
        coil(m, "Q")
    return Scene(m, {"O": polynomial(0.4, 5.0)}, posture={"b": 0.7}, t=(0.0, 2.0, 101))


def test_a_link_s_direction_counts_as_its_joint_at_the_ground():
    solution = assert_followed(whitworth(), "Q")
    other = evaluate(whitworth(direction=True), t=(0.0, 2.0, 5))
    np.testing.assert_allclose(other.effort("O"), solution.effort("O"), rtol=1e-13)
    assert np.ptp(solution.motion("Q").value) > 2.5 * math.pi


def geared_five_bar():
    """Two cranks tied by a gear of ratio -2, two bars between them."""
    m = Mechanism("five_bar")
    a, b, c, d = (
        m.link(n, length=l, mass=0.3) for n, l in zip("abcd", (0.1, 0.4, 0.4, 0.12), strict=True)
    )
    first = m.revolute("O", m.ground, a)
    second = m.revolute("Q", m.ground.at(0.5, 0.0), d)
    m.revolute("A", a.tip, b)
    m.revolute("D", d.tip, c)
    m.revolute("B", b.tip, c.tip)
    m.gear("mesh", first, second, ratio=-2.0, offset=0.3)
    return m, {"O": polynomial(0.1, 4.0)}, {"b": 0.9, "c": 2.2}


def test_what_a_gear_turns_is_counted_by_the_gear():
    """Between the second crank and its bar the joint goes round twice for each turn of the drive;
    the second crank's own too.
    """
    m, motion, posture = geared_five_bar()
    coil(m, "D")
    coil(m, "Q")
    scene = Scene(m, motion, posture=posture, t=(0.0, 4.0, 161))
    solution = evaluate(scene)
    for joint in "DQ":
        angle = solution.motion(joint)
        # A gear says what the angle is; what loops set starts in (-pi, pi].
        np.testing.assert_allclose(
            solution.series[f"load:coil_{joint}:mz"],
            -STIFFNESS * (angle.value - FREE) - DAMPING * angle.rate,
            atol=1e-12,
        )
    assert solution.motion("Q").value[0] == pytest.approx(0.3 - 0.2)
    assert np.ptp(solution.motion("D").value) > 4 * math.pi


def test_two_drives():
    """Five bars: a joint between moving links goes round with either drive."""
    m = Mechanism("five_bar")
    a, b, c, d = (
        m.link(n, length=l, mass=0.3) for n, l in zip("abcd", (0.1, 0.4, 0.4, 0.12), strict=True)
    )
    m.revolute("O", m.ground, a)
    m.revolute("Q", m.ground.at(0.5, 0.0), d)
    m.revolute("A", a.tip, b)
    m.revolute("D", d.tip, c)
    m.revolute("B", b.tip, c.tip)
    for joint in "ADB":
        coil(m, joint)
    motion = {"O": polynomial(0.1, 7.0), "Q": polynomial(1.0, -3.0, -2.0)}
    assert_followed(Scene(m, motion, posture={"b": 0.9, "c": 2.2}, t=(0.0, 2.0, 101)), "ADB")


def test_a_drive_that_slides():
    """A cylinder swings a boom: nothing turns round, and the joint's angle crosses half a turn."""
    m = Mechanism("boom")
    boom = m.link("boom", length=1.0, mass=3.0)
    barrel, piston = m.link("barrel", length=0.4, mass=1.0), m.link("piston", length=0.4, mass=0.8)
    m.revolute("O", m.ground, boom)
    m.revolute("F", m.ground.at(-0.5, 0.3), barrel)
    m.prismatic("stroke", barrel, piston, axis=(1, 0), angle=math.pi)
    m.revolute("P", piston.base, boom.at(0.3))
    for joint in "OP":
        coil(m, joint)
    assert_followed(
        Scene(
            m,
            {"stroke": harmonic(0.62, 0.1, 0.7)},
            posture={"boom": 1.5, "barrel": 0.2},
            t=(0, 2, 65),
        ),
        "OP",
    )


@pytest.mark.parametrize("precision", ["double", "single"])
def test_many_turns_keep_their_phase(precision):
    """A spring that only swings, between links that go round a million times: no digit is lost on
    how many.
    """
    near, far = (
        sprung("B", law=polynomial(start, 9.0), **DRAG_LINK) for start in (0.2, 0.2 + 2e6 * math.pi)
    )
    graphs = [derive(scene, ["load:coil_B"]) for scene in (near, far)]
    assert all("_turned:B" in program.names for program in graphs)
    one, other = (
        evaluate(scene, wanted=["load:coil_B"], precision=precision).series["load:coil_B:mz"]
        for scene in (near, far)
    )
    np.testing.assert_allclose(other, one, rtol=0, atol=1e-5 if precision == "single" else 1e-8)


def test_an_angle_starts_within_half_a_turn_however_far_the_drive_has_turned():
    near, far = (sprung("AC", law=polynomial(start, 9.0)) for start in (0.5, 0.5 + 20 * math.pi))
    for name in ("load:coil_A:mz", "load:coil_C:mz", "effort:O"):
        one, other = (evaluate(scene).series[name] for scene in (near, far))
        np.testing.assert_allclose(other, one, rtol=0, atol=1e-11)


def test_what_does_not_tell_turns_apart_is_left_within_one():
    """Under a sine whole turns make no difference: no rule is sought, and nothing is held to it."""
    for see, counts in (
        (ca.sin, False),
        (lambda x: 3 * ca.cos(2 * x + 1) ** 2, False),
        (lambda x: x, True),
        (lambda x: ca.sin(x / 2), True),
    ):
        m = slider_crank().mechanism
        m = Mechanism("seen")
        a = m.link("a", length=0.1, mass=0.3)
        b = m.link("b", length=0.3, mass=0.3)
        s = m.point_mass("s", 1.0)
        m.revolute("O", m.ground, a)
        joint = m.revolute("A", a.tip, b)
        m.revolute("B", b.tip, s)
        m.prismatic("guide", m.ground, s, axis=(1, 0))
        m.torque("seen_by", b, see(m.coordinate(joint)))
        program = derive(Scene(m, {"O": polynomial(0, 6.0)}, posture={"b": 0.0}))
        assert ("_turned:A" in program.names) is counts


@pytest.mark.parametrize(
    ("see", "tells"),
    [
        (lambda x, y: ca.cos(x) * y + ca.sin(3 * x - y), False),
        (lambda x, y: ca.tan(x), False),
        (lambda x, y: ca.atan2(ca.sin(x), ca.cos(x)), False),
        (lambda x, y: ca.remainder(x, 2 * math.pi) * y, False),
        (lambda x, y: ca.remainder(2 * x + y, math.pi), False),
        (lambda x, y: ca.sin((x + y) - x), False),
        (lambda x, y: y * 2 + 1, False),
        (lambda x, y: ca.remainder(x, 3.0), True),
        (lambda x, y: ca.sin(0.5 * x), True),
        (lambda x, y: ca.sin(x * y), True),
        (lambda x, y: ca.fmod(x, 2 * math.pi), True),
        (lambda x, y: table(x, [0, 1], [0, 2]), True),
        (lambda x, y: ca.exp(x), True),
        (lambda x, y: ca.if_else(x > 1, ca.sin(x), 0), True),
        (lambda x, y: x / y, True),
    ],
)
def test_whether_an_expression_tells_turns_apart(see, tells):
    """By its operations; and where it says no, none of many whole turns makes a difference."""
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    assert depends_on_turns(see(x, y), x) is tells
    if not tells:
        f = ca.Function("f", [x, y], [see(x, y)])
        for at, other in np.random.default_rng(0).uniform(-4, 4, (50, 2)):
            assert float(f(at + 3 * math.tau, other)) == pytest.approx(
                float(f(at, other)), rel=1e-9, abs=1e-9
            )


def led(span):
    """Two slides lead a pin round the pivot of a slotted link: it goes round, and no drive does."""
    m = Mechanism("led")
    carriage = m.link("carriage", length=0.1, mass=1.0)
    pin = m.point_mass("pin", 1.0)
    b = m.link("b", length=0.6, mass=0.5)
    m.prismatic("X", m.ground, carriage, axis=(1, 0))
    m.prismatic("Y", carriage, pin, axis=(0, 1))
    m.revolute("Q", m.ground, b)
    m.slot("S", b, pin)
    coil(m, "Q")
    motion = {"X": harmonic(0.0, 0.3, 1.0, math.pi / 2), "Y": harmonic(0.0, 0.3, 1.0)}
    return Scene(m, motion, posture={"b": 0.0}, t=(0.0, span, 65))


def test_an_angle_whose_turns_nothing_tells_is_refused():
    """A part of a turn is no turn; and beyond what the scene showed nothing is known."""
    solution = evaluate(led(0.7))
    assert solution.motion("Q").value[-1] == pytest.approx(0.7 * math.tau)
    np.testing.assert_allclose(
        solution.series["load:coil_Q:mz"],
        -STIFFNESS * (0.7 * math.tau * np.linspace(0, 1, 65) - FREE) - DAMPING * math.tau,
    )
    with pytest.raises(
        AssemblyError,
        match=r"the angle of 'Q', on whose number of revolutions a load depends, is -?1\d\d deg",
    ):
        evaluate(led(0.7), t=(0.0, 2.0, 201))
    with pytest.raises(
        DeclarationError,
        match=(
            "load 'coil_Q': the angle of 'Q' enters with its number of revolutions, which cannot"
            " be determined"
        ),
    ):
        evaluate(led(1.5))
    evaluate(led(1.5), wanted=["motion"])
