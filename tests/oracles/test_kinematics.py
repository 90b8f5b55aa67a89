"""Loops: closure, rates, branches, and what is said where they cannot be closed."""

import dataclasses
import math

import casadi as ca
import numpy as np
import pytest
from mechanisms import (
    crank_slider,
    double_crank,
    flat_parallelogram,
    four_bar,
    links_of,
    pins_of,
    slider_crank,
    truss_platform,
)
from stepped import pinned

from lagrange_casadi import Mechanism, Scene, derive, evaluate, load_case
from lagrange_casadi.errors import AssemblyError, DeclarationError, MobilityError
from lagrange_casadi.motion import expression, polynomial

pytestmark = pytest.mark.usefixtures("interpreted")


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


def three_cranks():
    """A bar on three cranks that hold each other at their dead centres."""
    m, r = Mechanism("cranks"), 0.2
    bar = m.link("bar", length=1.0, mass=1.0)
    for k, (x, y) in enumerate([(0.0, 0.0), (0.4, 0.0), (0.76, 0.28)]):
        crank = m.link(f"crank{k}", length=r, mass=0.1)
        m.revolute(f"O{k}", m.ground.at(x, y), crank)
        m.revolute(f"A{k}", crank.tip, bar.at(x, y) if x else bar)
    posture = {"bar": 0.0, "crank1": 1.0, "crank2": 1.0}
    return Scene(m, {"O0": polynomial(1.0, 4.0)}, posture=posture, t=(0, 1.5, 201))


def stretched(pin):
    """A ram draws a crank and its rod straight."""
    law, posture = {"guide": polynomial(0.4, 0.05)}, {"crank": 1.0, "rod": -0.3}
    return Scene(crank_slider(pin, (0.1, 0.35)), law, posture=posture, t=(0, 1, 41))


def driven(*drives):
    return lambda: Scene(four_bar().mechanism, {name: polynomial(0.1) for name in drives})


def twice():
    """As many drives as freedoms, but a loop has two and the open chain beside it none."""
    m = Mechanism("twice")
    a, b, c, d = (m.link(n, length=1.0, mass=1.0) for n in "abcd")
    pins_of(m, O=(m.ground, a), A=(a.tip, b))
    m.prismatic("P", m.ground.at(0, 1), b, axis=(1, 0))
    pins_of(m, Q=(m.ground.at(3, 0), c), R=(c.tip, d))
    return Scene(m, {"O": polynomial(0.5), "P": polynomial(0.1)}, posture={"b": 0.0})


def never(case):
    """A motion that is no number where it starts."""

    def made():
        scene = load_case(case).scene
        (drive,) = scene.motion
        return dataclasses.replace(scene, motion={drive: expression(lambda t: ca.log(t - 5.0))})

    return made


REFUSED = {
    "two ways": (
        DeclarationError,
        lambda: slider_crank(posture={}),
        r"joint 'guide' can be .* in two ways.*rod = .*\(0 deg\).* or rod = .*180.*posture=\{'rod'",
    ),
    "between the ways": (
        DeclarationError,
        lambda: slider_crank(posture={"rod": math.pi / 2}),
        "two ways",
    ),
    "apart at the start": (
        AssemblyError,
        lambda: four_bar(lengths=(0.1, 0.1, 0.1), frame=(1.0, 0.0)),
        r"closed by joint 'B' cannot be closed at the start of the motion, where O = 1\.46 rad",
    ),
    **{
        f"stretched at the start, but for rounding by {rounding}, over {scale}": (
            AssemblyError,
            lambda rounding=rounding, scale=scale: four_bar(
                lengths=(0.1 * scale, (0.15 + rounding) * scale, 0.25 * scale), frame=(0.0, 0.0)
            ),
            r"closed by joint 'B' is at a dead centre at the start of the motion",
        )
        for rounding in (-1e-16, 0.0, 1e-16)
        for scale in (1.0, 2.0**40)
    },
    "no number": (
        DeclarationError,
        never("slider_crank"),
        r"no number where it starts.* O = nan rad",
    ),
    "no number in space": (
        DeclarationError,
        never("spatial_slider_crank"),
        r"no number where it starts.* = nan rad",
    ),
    "no drive": (MobilityError, driven(), "1 degree.* and 0 drive"),
    "two drives": (MobilityError, driven("O", "A"), "1 degree.* and 2 drive"),
    "drives of one loop": (
        MobilityError,
        twice,
        r"and 2 drive\(s\); but these over-determine some loops",
    ),
    "no posture": (
        DeclarationError,
        lambda: dataclasses.replace(truss_platform(), posture={"bar0": 0.0}),
        r"have no closed form; also give a rough posture of .*leg0",
    ),
}
OPEN = {
    "on the way": (
        lambda: slider_crank(posture={"rod": 0.0}),
        {"parameters": {"r": 0.3}},
        r"closed by joint 'guide' cannot be closed at t = 0\.01 s, where O = 0\.785.*\(45\.",
    ),
    "at a dead centre": (
        lambda: stretched(Mechanism.revolute),
        {},
        r"joint '\w+' is at a dead centre at t = 1 s, where guide = 0\.45 m",
    ),
    "at a dead centre, in singles": (
        lambda: stretched(Mechanism.revolute),
        {"precision": "single"},
        r"joint '\w+' is at a dead centre at t = 1 s",
    ),
    "at a dead centre, of two instants": (
        lambda: stretched(Mechanism.revolute),
        {"t": (0, 1, 2)},
        r"joint '\w+' is at a dead centre at t = 1 s",
    ),
    "at one that is iterated": (
        lambda: stretched(pinned),
        {"newton": 24},
        r"constraint 'B_y' is at a dead centre at t = 1 s, where guide = 0\.45 m, within",
    ),
    "at one that is iterated, in singles": (
        lambda: stretched(pinned),
        {"newton": 12, "precision": "single"},
        r"constraint 'B_y' is at a dead centre at t = 1 s, where guide = 0\.45 m, within",
    ),
    # A shaft of 5 m carries the first leg's foot out of reach.
    "out of reach, iterated": (
        truss_platform,
        {"parameters": {"shaft": 5.0}},
        r"did not converge at t = 0 s, where O = 0 rad \(0 deg\)",
    ),
    # A parallelogram lies flat at 180 deg, where it may go on as one or turn over.
    "between instants": (
        flat_parallelogram,
        {},
        r"joint 'B' passes a dead centre after t = 0\.6\d* s, where O = 3\.1\d* rad",
    ),
    "jumped": (
        lambda: double_crank(2.3),
        {},
        r"closed by joint 'B' has jumped to another branch at t = 2\.3 s, where O = 2\.5 rad",
    ),
    # The third crank holds the others at their dead centre: enough instants are all it takes.
    "too few instants": (
        three_cranks,
        {"t": (0, 1.5, 4)},
        r"did not converge at t = 1 s.*, or the instant before is too far off",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_derived_is_refused(name):
    error, made, says = REFUSED[name]
    with pytest.raises(error, match=says):
        derive(made())


@pytest.mark.parametrize("backend", ["c", "vm"])
@pytest.mark.parametrize("name", OPEN)
def test_an_instant_that_cannot_be_closed_is_named(name, backend):
    made, keywords, says = OPEN[name]
    if keywords.get("precision") == "single" and backend == "vm":
        pytest.skip("singles are compiled")
    with pytest.raises(AssemblyError, match=says):
        evaluate(made(), backend=backend, **keywords)


@pytest.mark.parametrize(
    ("made", "keywords"),
    [
        (flat_parallelogram, {"t": (0, 0.6, 61)}),
        (slider_crank, {"parameters": {"l": 0.1005}, "t": (0, 0.08, 801)}),
        (lambda: double_crank(1.0), {}),
        (three_cranks, {}),
    ],
)
def test_what_comes_near_is_closed(made, keywords):
    assert evaluate(made(), backend="vm", **keywords).certified


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
    crank, bar = links_of(m, crank=(0.2, 1.0), bar=(0.4, 1.0))
    foot = m.point_mass("foot", 0.1)
    pins_of(m, O=(m.ground, crank), A=(crank.tip, bar.at(0.2)), B=(bar, foot))
    for k in range(guides):
        m.prismatic(f"X{k}", m.ground, foot, axis=(1, 0))
    scene = Scene(m, {"O": polynomial(1.0, 1.0)}, posture={"bar": 2.14, "X0": 0.2}, t=(0, 1, 101))
    with pytest.raises(AssemblyError, match=r"passes a dead centre after t = 0\.57 s"):
        evaluate(scene, backend="vm")
