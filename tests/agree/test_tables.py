"""Cycle tables: against the graphs that they are of, at any angle and motion; what has none; and
the code that reads them.
"""

import math
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from compiled import STRICT, cc
from exported import by_c99, compare, expected, exported, instants, solve
from internals import cycle_table
from mechanisms import (
    bracket,
    crank_and_rod,
    driven_slider,
    flat_parallelogram,
    four_bar,
    parallelogram,
    pins_of,
    slider_crank,
    standing_rod,
    truss_platform,
)
from packer import scene as packer

from lagrange_casadi import Mechanism, Scene, beams, evaluate, load_case, motion
from lagrange_casadi.errors import DeclarationError

CLAIM = 3.0  # what a table claims is what it was seen to miss halfway between its nodes


def case(name):
    return load_case(name).scene


def arm(load=None, law=None, **keywords):
    """A link on a pin, with a torque by its angle, its rate and the time."""
    m = Mechanism("arm")
    link = m.link("link", length=0.5, mass=1.2)
    pin = m.revolute("pin", m.ground, link)
    if load is not None:
        m.torque("load", link, load(m.coordinate(pin), m.rate(pin), m.time))
    return Scene(m, {"pin": law or motion.polynomial(0.1, 2.0)}, **keywords)


def geared(ratio):
    m = Mechanism("geared")
    wheel, link = m.link("wheel", length=0.05, mass=0.2), m.link("link", length=0.1, mass=0.3)
    first, second = pins_of(m, first=(m.ground.at(-0.2, 0), wheel), second=(m.ground, link))
    m.gear("mesh", first, second, ratio=ratio)
    return Scene(m, {"first": motion.polynomial(0.2, 3.0)}, t=(0.0, 1.0, 31))


def damped():
    def damper(m, parts):
        held, other = m.ground.at(0.2, 0.5), parts["b"].at(0.1)
        m.spring("damper", held, other, stiffness=300.0, length=0.3, damping=40.0)

    return crank_and_rod({"mass": 0.4}, loads=damper)


def called():
    x = ca.SX.sym("x")
    function = ca.Function("called", [x], [ca.sin(x) * 3], {"never_inline": True})
    return arm(lambda q, w, t: function(q) * w)


SMOOTH = {
    name: lambda name=name: case(name)
    for name in ("slider_crank", "four_bar", "six_bar", "andrews_squeezer")
}
SMOOTH |= {
    "drag_link": lambda: four_bar(lengths=(0.3, 0.25, 0.35), frame=(0.1, 0.0), rocker=1.0),
    "redundant": parallelogram,
    "arm": arm,
    "damped": damped,
    "called": called,
    "geared": lambda: geared(-1 / 3),
}
METHODS = {
    "accuracy": {"table": 1e-9},
    "nodes": {"table": 256},
    "single": {"table": 1e-6, "precision": "single"},
}


@pytest.mark.sampled(5)
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", SMOOTH)
def test_a_table_gives_what_the_graph_gives(name, method):
    """For motions that were not those of the table: swings either way, of some turns, and late; for
    1e-9 of each column's peak, within what is claimed.
    """
    scene, asked = SMOOTH[name](), METHODS[method]
    (drive,) = scene.laws
    start = float(scene.laws[drive](scene.t[0])) if callable(scene.laws[drive]) else 0.2
    swing = motion.harmonic(start, 9.0, 0.5)
    for law, span in ((swing, (0.0, 1.9, 301)), (motion.polynomial(start, -6.0), (0.0, 5.0, 401))):
        moved = replace(scene, motion={drive: law}, t=span)
        exact, read = evaluate(moved, backend="vm"), evaluate(moved, **asked)
        for each in filter(exact.determined, exact.names()):
            gap = np.abs(exact.array(each) - read.array(each)).max()
            peak = np.abs(exact.array(each)).max()
            rounded = 10 * exact.errors.get(each, 0.0) + 1e-12 * peak
            assert gap <= CLAIM * read.errors.get(each, 0.0) + rounded, each
            if asked["table"] == 1e-9 and each.startswith(("effort", "reaction")):
                assert gap <= 1.1e-9 * peak + rounded, each


def test_rounding_is_not_taken_for_what_does_not_repeat():
    """In phase, no force goes with the rate: all that do are rounding."""
    asked = {"parameters": {"phase": 0.0, "load": 0.0}, "table": 1e-6}
    assert evaluate(case("cardan_shaft"), **asked).certified


@pytest.mark.parametrize("turns", [-1000, 100_000])
def test_after_many_turns_all_is_as_before(turns):
    """The angle as it is decides: nothing is lost of it but its own last digits."""
    scene = case("slider_crank")
    law = motion.polynomial(0.3 + turns * math.tau, 60.0)
    found = [
        evaluate(replace(scene, motion={"O": moved}), wanted=["effort", "reaction"], table=1e-10)
        for moved in (motion.polynomial(0.3, 60.0), law)
    ]
    for each in ("effort:O", "reaction:guide:fy"):
        first, later = (one.array(each) for one in found)
        assert np.abs(later - first).max() < 2e-9 * np.abs(first).max()


def test_errors_fall_with_the_sixth_power_of_the_distance():
    scene = slider_crank(["effort"])
    exact = evaluate(scene).effort("O")
    coarse, fine = (
        np.abs(evaluate(scene, table=nodes).effort("O") - exact).max() for nodes in (32, 128)
    )
    assert 10.5 < math.log2(coarse / fine) < 13.5


ROUND = beams.Beam(beams.round_bar(0.02), beams.material("S235"))


def loaded(load):
    return lambda: arm(load, t=(0, 1, 5))


REFUSED = {
    "two": (bracket, "expected one driven joint, whose angle determines all, got 'J', 'S'"),
    "slides": (driven_slider, "the driven joint 'P' slides; expected one that turns"),
    "time": (loaded(lambda q, w, t: ca.sin(t)), "but these depend on the time: 'load:load:mz'"),
    "sign": (loaded(lambda q, w, t: -3 * ca.sign(w)), "quadratic in the rate of joint 'pin'"),
    "size": (loaded(lambda q, w, t: -1e-3 * w * ca.fabs(w)), "depends on a rate's sign"),
    "cube": (loaded(lambda q, w, t: 1e-6 * w**3), "another power enters 'load:load:mz'"),
    "at rest": (loaded(lambda q, w, t: w**2 / ca.fabs(w)), r"is not finite at rest, where pin ="),
    "grows": (loaded(lambda q, w, t: 2 * q**2), "repeat after at most 4 turns of joint 'pin'"),
    "friction": (
        lambda: replace(packer(), wanted=["effort"]),
        "but friction 'rub' depends on its sign",
    ),
    "contact": (standing_rod, "but the margin of contact 'foot' is none; evaluate without"),
    "gear": (lambda: geared(0.7), "after at most 4 turns of joint 'first', but"),
    "iterated": (truss_platform, "expected a drive that can make whole revolutions"),
    "reach": (
        lambda: four_bar(lengths=(0.3, 0.35, 0.2)),
        "the loop closed by joint 'B' cannot be closed, where O = 2.4",
    ),
    "dead centre": (flat_parallelogram, "the loop closed by joint 'B' passes a dead centre"),
    "jump": (lambda: case("geneva"), r"'\S+' jumps near main = .*; evaluate without a table"),
    "narrow": (
        loaded(lambda q, w, t: ca.exp(-1e9 * ca.sin(q) ** 2)),
        "an accuracy of 1e-09 is not possible; the best is 0.6.*, and 'load:load:mz' is the worst",
    ),
    "stress": (
        lambda: replace(crank_and_rod({"beam": ROUND}), wanted=["stress"]),
        "stress:b:von_mises is not a polynomial of the rate; want section:b in place of it",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_has_no_table_is_refused_with_the_reason(name):
    make, says = REFUSED[name]
    with pytest.raises(DeclarationError, match=f"^table: .*{says}"):
        evaluate(make(), table=1e-9)


@pytest.mark.parametrize("table", [7, 16385, -3, True, 1.0, 0.0, 16.0, math.nan, "16"])
def test_what_is_neither_nodes_nor_an_accuracy_is_refused(table):
    says = "table: expected a (whole )?number of nodes.* 8.*, or an accuracy between 0 and 1"
    with pytest.raises(DeclarationError, match=says):
        evaluate(slider_crank(), table=table)


@pytest.mark.parametrize("place", [0.2, 0.13])
def test_a_station_that_stands_still_is_on_no_other_side_of_a_section(place, tmp_path):
    """A spline through one number rounds it: at a ratio of the grid that is the load's own, 20 N
    would be on the other side. Exported C knows it too.
    """
    m = Mechanism("loaded")
    crank, rod = m.link("crank", length=0.1, mass=1.0), m.link("rod", length=0.4, mass=1.0)
    pins_of(m, O=(m.ground, crank), A=(crank.tip, rod))
    m.slot("guide", m.ground, rod.tip)
    m.force("load", rod.at(m.parameter("place", place)), y=-20.0)
    law, grid = motion.polynomial(0.0, 10.0), {"t": (0.0, 0.6, 31), "xi": (0.0, 1.0, 41)}
    scene = Scene(m, {"O": law}, posture={"rod": 0.0}, **grid)
    read, true = (
        evaluate(scene, backend="vm", **method).section("rod") for method in ({"table": 256}, {})
    )
    np.testing.assert_allclose(read.shear, true.shear, rtol=0, atol=1e-9)
    made, told = exported(scene, tmp_path, table=256)
    solution = solve(scene, "double", table=256)
    found = by_c99(tmp_path, told, instants(solution.t, "double"))
    compare(found, expected(scene, told, solution), told, made, solution)


@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize("name", ["slider_crank", "andrews_squeezer"])
def test_however_cut_the_bits_are_the_same(name, precision):
    """In blocks between two nodes and in others, whole blocks and not, by any number of threads."""
    method = {"table": 64, "precision": precision, "certificate": False, "wanted": ["effort"]}
    scene = replace(case(name), t=(0.0, 0.5, 1003))
    whole = evaluate(scene, **method).array(f"effort:{next(iter(scene.laws))}")
    again = evaluate(scene, threads=3, **method).array(f"effort:{next(iter(scene.laws))}")
    assert again.tobytes() == whole.tobytes()


@pytest.mark.parametrize("real", ["float", "double"])
def test_the_reader_is_pedantically_clean(real, tmp_path):
    (tmp_path / "interpolate.c").write_text(cycle_table.source())
    strict = [*STRICT, "-Wconversion", f"-DREAL={real}", "-c"]
    result = cc(["cc", *strict], tmp_path, "interpolate.c", output="x.o")
    assert result.returncode == 0, result.stderr
