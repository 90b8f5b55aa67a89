"""Dead centres between instants: what passes one is refused, what touches one or comes near is not.

Linkages are drawn of every kind that has a dead centre within a turn of its drive, with steps of
0.1 to 30 degrees, and instants from 1e-10 to 1e-2 rad beside it. How near an instant is comes from
the cosine rule in forty digits.
"""

import cmath
import functools
import math
import subprocess

import mpmath
import numpy as np
import pytest
from design_rows import values
from internals import DesignEngine, EvaluationMethod, Status, run
from internals import refusal_refusal as refusal
from mechanisms import pins_of
from structured import blocks

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, evaluate, export
from lagrange_casadi.errors import AssemblyError
from lagrange_casadi.motion import expression, polynomial

COUNT = 13
BAND = 8.4e-8
"""Sine of the transmission angle below which a double does not tell the assembly."""


def law(m, start):
    """The drive's angle [rad] start + rate t + curve t^2, of parameters."""
    return polynomial(
        m.parameter("start", start), m.parameter("rate", 1.0), m.parameter("curve", 0.0)
    )


@functools.cache
def four_bar(crossed=False, space=False, iterated=False):
    """A crank, a coupler, a rocker, and a ground of any lengths, in one of both assemblies."""
    m = (SpatialMechanism if space else Mechanism)("four_bar")
    sizes = {"a": 0.1, "b": 0.3, "c": 0.1, "g": 0.3}
    a, b, c, g = (m.parameter(name, size, low=0.0) for name, size in sizes.items())
    lengths = {"crank": a, "coupler": b, "rocker": c}
    crank, coupler, rocker = (m.link(name, length=l, mass=1.0) for name, l in lengths.items())
    foot = m.ground.at(g, 0, 0) if space else m.ground.at(g, 0)
    m.revolute("O", m.ground, crank)
    if space:
        m.spherical("A", crank.tip, coupler)
        m.spherical("B", coupler.tip, rocker.tip)
    else:
        pins_of(m, A=(crank.tip, coupler), B=(coupler.tip, rocker.tip))
    hinge = m.revolute("C", foot, rocker)
    if iterated:
        wheel = m.link("wheel", length=0.1, mass=0.1)
        m.gear("mesh", hinge, m.revolute("G", m.ground.at(g + 0.4, 0), wheel), ratio=-2.0)
    # The other place where the rocker's circle meets the coupler's: the image beyond the line from
    # the foot to the elbow.
    elbow = 0.1 * cmath.exp(0.9j)
    tip, way = 0.3 + elbow, 0.3 - elbow
    tip = elbow + way * ((tip - elbow) / way).conjugate() if crossed else tip
    told = {"C": cmath.phase(tip - 0.3)}
    if not space:
        told = {"coupler": cmath.phase(tip - elbow), "rocker": told["C"]}
    return Scene(m, {"O": law(m, 0.9)}, posture=told, t=(0, 1, COUNT), wanted=["effort"])


def slider_crank():
    """A crank, a rod and a slider, whose line is offset."""
    m = Mechanism("slider_crank")
    r, l, e = (m.parameter(name, value) for name, value in (("r", 0.1), ("l", 0.1), ("e", 0.0)))
    crank, rod = m.link("crank", length=r, mass=1.0), m.link("rod", length=l, mass=1.0)
    slider = m.point_mass("slider", 1.0)
    pins_of(m, O=(m.ground, crank), A=(crank.tip, rod), B=(rod.tip, slider))
    m.prismatic("guide", m.ground.at(0, e), slider, axis=(1, 0))
    return Scene(m, {"O": law(m, 0.9)}, posture={"rod": -0.9}, t=(0, 1, COUNT), wanted=["effort"])


def sine_of_four_bar(angle, a, b, c, g):
    """Square of the sine between coupler and rocker, negative where they do not meet."""
    d2 = a * a + g * g - 2 * a * g * mpmath.cos(angle)
    return 1 - ((b * b + c * c - d2) / (2 * b * c)) ** 2


def sine_of_slider_crank(angle, r, l, e):
    """Square of the cosine of the angle between rod and guide."""
    return 1 - ((r * mpmath.sin(angle) - e) / l) ** 2


def lengths_of(r, kind):
    """Lengths that have a dead centre, and the drive's angle there."""
    a, b = r.uniform(0.05, 0.15), r.uniform(0.2, 0.4)
    if kind == "slider":
        l = r.uniform(0.5, 1.0) * a if r.random() < 0.3 else a + r.uniform(0.0, 0.2)
        return (a, l, a - l), math.pi / 2
    if kind == "kite":
        side = a * r.uniform(0.4, 2.0)
        return (a, side, side, a), 0.0
    if kind == "parallelogram":
        return (a, b, a, b), r.choice([0.0, math.pi])
    # Crank and ground stretched are coupler and rocker stretched, or folded are they folded.
    c = a + r.uniform(0.02, 0.1)
    if r.random() < 0.5:
        return (a, b, c, b + c - a), math.pi
    return (a, b, c, b - c + a), 0.0


def drawn(r, kind):
    """A design: its lengths, its motion (start, rate, curve), and what it is about to do."""
    lengths, centre = lengths_of(r, kind)
    step = math.radians(math.exp(r.uniform(math.log(0.1), math.log(30.0))))
    which = int(r.choice([1, r.integers(2, COUNT - 2), COUNT - 2]))  # often beside both ends
    beside = r.choice([-1, 1]) * (
        min(10 ** r.uniform(-10, -2), step) if r.random() < 0.6 else step * r.uniform(0.0, 1.0)
    )
    way, does = r.choice([-1, 1]), r.choice(["passes", "touches", "near"])
    if does == "touches":
        # A parabola whose end is at an instant, or beside it.
        at = which / (COUNT - 1) + (r.uniform(-0.5, 0.5) / (COUNT - 1) if r.random() < 0.7 else 0.0)
        bend = way * r.uniform(0.2, 0.8)
        return lengths, (centre + bend * at * at, -2 * bend * at, bend), does
    if does == "near":
        off = 10 ** r.uniform(-12, -2)
        lengths = (lengths[0], lengths[1] * (1 + off), *lengths[2:])
        if kind == "kite":
            lengths = (lengths[0], lengths[1], lengths[2] * (1 + 3 * off), lengths[3] * (1 + off))
    rate = way * step * (COUNT - 1)
    return lengths, (centre + beside - rate * which / (COUNT - 1), rate, 0.0), does


def verdicts(kind, lengths, motion, does):
    """The statuses that a design may have.

    Between instants the square of the sine is least where the drive passes a multiple of 180
    degrees, of a slider-crank 90 degrees beside one.
    """
    square = {"slider": sine_of_slider_crank}.get(kind, sine_of_four_bar)
    start, rate, curve = motion
    times = np.linspace(0.0, 1.0, COUNT)
    course = start + rate * np.linspace(0.0, 1.0, 4000) + curve * np.linspace(0.0, 1.0, 4000) ** 2
    with mpmath.workdps(40):
        numbers = [mpmath.mpf(float(x)) for x in lengths]
        squares = [float(square(start + rate * t + curve * t * t, *numbers)) for t in times]
        quarter = mpmath.pi / 2 if kind == "slider" else 0
        first, last = (
            int(mpmath.ceil((end - quarter) / mpmath.pi)) for end in (course.min(), course.max())
        )
        least = min(
            [float(square(quarter + k * mpmath.pi, *numbers)) for k in range(first, last)],
            default=1.0,
        )
    at_instants, refused = min(squares), {Status.DEAD_CENTRE, Status.PASSES_DEAD_CENTRE}
    if at_instants < (BAND / 2) ** 2:
        return refused | ({Status.OUT_OF_REACH} if at_instants < 0.0 else set())
    beside = refused if at_instants < (2 * BAND) ** 2 else set()
    if does == "passes" or least < -((2 * BAND) ** 2):
        return refused
    if does == "near" and least < (4 * BAND) ** 2:
        return refused | {Status.OK}
    return beside | {Status.OK}


SCENES = {
    "parallelogram": four_bar,
    "antiparallelogram": lambda: four_bar(crossed=True),
    "kite": four_bar,
    "change": four_bar,
    "slider": slider_crank,
    "space": lambda: four_bar(space=True),
}


def check(name, backend, many, seed, compared):
    scene = SCENES[name]()
    kind = {"antiparallelogram": "parallelogram"}.get(name, name)
    r, rows, allowed, told = np.random.default_rng(seed), [], [], []
    names = [*scene.mechanism.parameters]
    for _ in range(many):
        lengths, motion, does = drawn(r, kind)
        given = dict(zip("rle" if kind == "slider" else "abcg", lengths, strict=True))
        given |= dict(zip(("start", "rate", "curve"), motion, strict=True))
        rows.append([given[key] for key in names])
        allowed.append(verdicts(kind, lengths, motion, does))
        told.append((does, given))
    method, p = EvaluationMethod(backend), np.array(rows)
    for peaks in ("exact", "sampled"):
        engine = DesignEngine.of(scene, method=method, peaks=peaks)
        found = engine.evaluate(p).status
        for status, may, what in zip(found, allowed, told, strict=True):
            # A peak beside a dead centre may have no end.
            assert Status(status) in may or (status == Status.PEAK_NOT_TOLD and Status.OK in may), (
                Status(status),
                may,
                what,
            )
    for row, status in zip(p[:compared], found, strict=False):
        t = engine.times.default[0]
        evaluated, _ = run(engine.program, t, row, method)
        why = refusal(engine.program, evaluated, t, row, method)
        assert status in (why.status if why else Status.OK, Status.PEAK_NOT_TOLD), values(
            scene, row
        )


@pytest.mark.parametrize("name", SCENES)
def test_what_passes_a_dead_centre_is_refused_and_nothing_else(name):
    check(name, "lanes", 50, 1, 12)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("backend", ["lanes", "c"])
@pytest.mark.parametrize("name", SCENES)
def test_many_that_pass_a_dead_centre(name, backend, seed):
    check(name, backend, 3000, 10 + seed, 300)


def test_a_linkage_has_the_transmission_angle_in_space_that_it_has_in_the_plane():
    """Also where the line from the rocker's foot to the crank's tip is short beside the coupler."""
    flat, raised = (
        evaluate(
            four_bar(space=space), parameters={"a": 0.29, "b": 0.3, "c": 0.299, "rate": 5.0}
        ).certificate["condition"]
        for space in (False, True)
    )
    assert raised == pytest.approx(flat, rel=1e-9)


@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize("step", [30.0, 10.0, 3.0, 0.1])
@pytest.mark.parametrize("share", [1e-4, 0.2, 0.5, 0.9])
def test_an_iterated_loop_has_the_same_rule(step, share, precision):
    """A gear counts the rocker; the branch is lost at any step, and kept where the drive turns
    back. Ahead of a step as wide, Newton's method may itself be lost.
    """
    scene, step = four_bar(iterated=True), math.radians(step)
    rate = step * (COUNT - 1)
    backend = {"backend": "c" if precision == "single" else "vm", "precision": precision}
    words = r"passes a dead centre after|has jumped to another|is at a dead centre|slowly"
    with pytest.raises(AssemblyError, match=words):
        evaluate(
            scene,
            parameters={"start": math.pi - (6 + share) * step, "rate": rate},
            certificate=False,
            **backend,
        )


def test_so_have_designs_of_an_iterated_loop():
    """Half of the drives pass the dead centre, half end before it."""
    scene = four_bar(iterated=True)
    given, passes = scene.mechanism.values(), []
    for step in np.radians([6.0, 2.0, 0.3]):
        for share in (0.2, 0.5, 0.9):
            passes += [given | {"start": math.pi - (6 + share) * step, "rate": step * (COUNT - 1)}]
    stays = [row | {"start": row["start"] - row["rate"]} for row in passes]
    engine = DesignEngine.of(scene, method=EvaluationMethod("lanes"))
    found = engine.evaluate(np.array([[*row.values()] for row in (*passes, *stays)])).status
    told = {Status.PASSES_DEAD_CENTRE, Status.DEAD_CENTRE, Status.JUMPED, Status.SLOW}
    assert {*found[:9].tolist()} <= told
    assert (found[9:] == Status.OK).all()


@pytest.mark.parametrize("iterated", [False, True])
@pytest.mark.parametrize("at", [0.41, 0.4584, 0.5])
def test_what_touches_and_turns_back_is_certified(at, iterated):
    """The drive swings to its dead centre and back; at half of its time that is an instant."""
    bend = 0.6
    given = {"start": math.pi - bend * at * at, "rate": 2 * bend * at, "curve": -bend}
    scene = four_bar(iterated=iterated)
    if at == 0.5:
        with pytest.raises(
            AssemblyError, match=r"at a dead centre at t = 0\.5 s|slowly at t = 0\.5"
        ):
            evaluate(scene, parameters=given, backend="vm")
    else:
        assert evaluate(scene, parameters=given, backend="vm").certified


@pytest.mark.parametrize(("power", "refused"), [(1, True), (2, False), (3, True), (4, False)])
def test_a_drive_that_stops_at_its_dead_centre_goes_on_or_turns_back(power, refused):
    """Rates of both are zero there: by the slopes of the sine the one is told from the other."""
    m = four_bar().mechanism
    scene = Scene(
        m,
        {"O": expression(lambda t: math.pi - (t - 0.46) ** power)},
        posture={"coupler": 0.0, "rocker": 3.0},
        t=(0, 1, COUNT),
    )
    if refused:
        with pytest.raises(AssemblyError, match=r"passes a dead centre after t = 0\.416"):
            evaluate(scene, backend="vm")
    else:
        assert evaluate(scene, backend="vm").certified


MAIN = """
#include "four_bar.h"
#include <stdio.h>
int main(void) {
  four_bar_model model;
  four_bar_parameters given = four_bar_defaults;
  four_bar_inputs before, now = {0};
  four_bar_outputs outputs;
  double x[7], t;
  int i, k, status;
  for (;;) {
    for (k = 0; k < 7; ++k) if (scanf("%lf", x + k) != 1) return 0;
    given.a = x[0]; given.b = x[1]; given.c = x[2]; given.g = x[3];
    status = four_bar_prepare(&model, &given);
    for (i = 0; i < COUNT && !status; ++i) {
      t = i/(COUNT - 1.0);
      before = now;
      now.O = x[4] + t*(x[5] + t*x[6]);
      now.O_rate = x[5] + 2*t*x[6];
      now.O_acceleration = 2*x[6];
      status = four_bar_evaluate(&model, &now, &outputs);
      if (i && !status) status = four_bar_between(&model, &before, &now, 1/(COUNT - 1.0));
    }
    puts(four_bar_message((four_bar_status) status));
  }
}
"""


def test_exported_c_has_the_same_rule(tmp_path):
    folder, r = tmp_path / "c", np.random.default_rng(5)
    export(four_bar(), folder)
    (folder / "between.c").write_text(MAIN.replace("COUNT", str(COUNT)))
    strict = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O1", "-ffp-contract=off"]
    sources = [folder / "between.c", folder / "four_bar.c", "-o", folder / "between", "-lm"]
    subprocess.run(["cc", *strict, *sources], check=True)
    some = [drawn(r, kind) for kind in ("parallelogram", "kite", "change") for _ in range(60)]
    lines = "\n".join(" ".join(map(repr, map(float, (*l, *m)))) for l, m, _ in some)
    told = subprocess.run(
        [folder / "between"], input=lines, capture_output=True, text=True, check=True
    ).stdout.splitlines()
    for (lengths, motion, does), word in zip(some, told, strict=True):
        may = verdicts("four_bar", lengths, motion, does)
        sentences = {"there is a result" if s == Status.OK else s.meaning for s in may}
        assert word in sentences, (lengths, motion, does)


@pytest.mark.parametrize("iterated", [False, True])
def test_structured_text_has_the_same_rule(tmp_path, iterated):
    export(four_bar(iterated=iterated), tmp_path, structured_text=True)
    unit = blocks((tmp_path / "four_bar.st").read_text())["mechanism_four_bar"]()
    for angle, valid in ((0.9, 1), (2.0, 1), (2.9, 1), (3.3, 0), (2.95, 1), (3.1415, 1), (3.0, 1)):
        unit(in_O=angle, in_O_rate=1.0, in_O_acceleration=0.0)
        assert unit.valid == bool(valid), angle


def spherical_four_bar(margin):
    """Four axes that meet; its crank comes so near [rad] to a dead centre as it goes round."""
    m, radius = SpatialMechanism("spherical"), 0.3
    crank, coupler, rocker = 0.45, 1.0, 1.1
    ground = crank + rocker - coupler + margin
    pivot, foot, pin = (
        radius * np.array([math.sin(a) * math.cos(b), math.sin(a) * math.sin(b), math.cos(a)])
        for a, b in ((0.0, 0.0), (ground, 0.0), (crank, 2.0))
    )
    # The joint between coupler and rocker, by its angles from both.
    a, b = pin / radius, foot / radius
    along = np.linalg.solve([[1, a @ b], [a @ b, 1]], np.cos([coupler, rocker]))
    across = np.cross(a, b)
    joint = along[0] * a + along[1] * b
    joint = radius * (joint + across * math.sqrt((1 - joint @ joint) / (across @ across)))
    places = {"crank": (pivot, pin), "coupler": (pin, joint), "rocker": (foot, joint)}
    links = [
        m.link(name, between=tuple(map(tuple, ends)), mass=1.0) for name, ends in places.items()
    ]
    axes = {"O": pivot, "A": pin, "C": foot, "B": joint}
    pairs = zip((m.ground, links[0], m.ground, links[1]), (*links, links[2]), strict=True)
    for (name, place), pair in zip(axes.items(), pairs, strict=True):
        m.revolute(name, *pair, at=tuple(place), axis=tuple(place))
    return Scene(m, {"O": polynomial(0.0, math.tau)}, t=(0, 1, 721), wanted=["effort"])


@pytest.mark.parametrize("margin", [0.05, 0.01, 0.002])
def test_a_loop_of_more_equations_than_unknowns_that_jumps_is_refused(margin):
    """Its volume has no sign: the screws of its joints have."""
    scene, jumped = spherical_four_bar(margin), []
    exact = evaluate(scene, wanted=["motion"], backend="vm").motion("C").value
    for count in (13, 19, 31, 46, 181):
        try:
            found = evaluate(scene, wanted=["motion"], t=(0, 1, count), backend="vm")
        except AssemblyError as error:
            jumped.append("jumped to another branch" in str(error))
        else:
            expected = exact[:: 720 // (count - 1)]
            np.testing.assert_allclose(found.motion("C").value, expected, atol=1e-9)
    assert all(jumped)
    assert 1 < len(jumped) < 5
