"""Corners and jumps that appear for other parameters than the defaults: no effort is told for them,
by whatever way.
"""

import casadi as ca
import numpy as np
import pytest
from internals import DesignEngine, Live, Smooth, Status, contents, cylindrical_cam, disc_cam

from lagrange_casadi import (
    Mechanism,
    Scene,
    SpatialMechanism,
    evaluate,
    export,
    optimise,
    prepare,
    sweep,
)
from lagrange_casadi.errors import AssemblyError, DeclarationError
from lagrange_casadi.motion import expression, polynomial

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]


def bend(x, k):
    """Smooth for k = 0; else with a corner of that size at x = 0.5."""
    return 0.02 * (ca.sin(x) + k * ca.fabs(ca.sin(x - 0.5)))


def slide(law, default=0.0):
    """A slide that follows a law of the time and of a parameter k."""
    m = Mechanism("slide")
    body, k = m.point_mass("body", 2.0), m.parameter("k", default)
    m.prismatic("way", m.ground, body, axis=(1, 0))
    return Scene(m, {"way": expression(lambda t: law(t, k))}, t=(0.0, 1.0, 101))


def jump(t, k):
    """The angle of 7 t, which atan2 takes back by a turn, where k is not 0."""
    return ca.atan2(k * ca.sin(7 * t), 1 - k + k * ca.cos(7 * t))


def motion(default=0.0):
    return slide(bend, default)


def cut(default=0.0):
    return slide(jump, default)


def constraint(default=0.0):
    """A slide whose place is a function of a crank's angle."""
    m = Mechanism("constraint")
    crank = m.link("crank", length=0.1, mass=1.0)
    body = m.point_mass("body", 2.0)
    k = m.parameter("k", default)
    turn = m.revolute("turn", m.ground, crank)
    way = m.prismatic("way", m.ground.at(0.0, 0.2), body, axis=(0, 1))
    m.constraint("profile", m.coordinate(way) - bend(m.coordinate(turn), k))
    return Scene(m, {"turn": polynomial(0.1, 1.0)}, t=(0.0, 1.0, 101))


def disc(default=0.0):
    m = Mechanism("disc")
    wheel = m.link("wheel", length=0.1, mass=1.0)
    rod = m.link("rod", length=0.1, mass=1.0)
    k = m.parameter("k", default)
    main = m.revolute("turn", m.ground, wheel)
    lead = m.prismatic("lead", m.ground, rod, axis=(0, 1), angle="90 deg")
    disc_cam(m, "profile", main, lead, lambda x: 0.1 * bend(x, k), base_radius=0.1, roller=0.01)
    return Scene(m, {"turn": polynomial(0.1, 1.0)}, t=(0.0, 1.0, 101))


def drum(default=0.0):
    m = SpatialMechanism("drum")
    wheel = m.link("wheel", length=0.1, mass=1.0)
    cart = m.point_mass("cart", 1.0)
    k = m.parameter("k", default)
    main = m.revolute("turn", m.ground, wheel, axis=(1, 0, 0))
    lead = m.prismatic("lead", m.ground.at(0.0, 0.0, 0.05), cart, axis=(1, 0, 0))
    cylindrical_cam(m, "profile", main, lead, lambda x: 0.1 * bend(x, k))
    return Scene(m, {"turn": polynomial(0.1, 1.0)}, t=(0.0, 1.0, 101))


PLACES = {
    motion: "the motion of joint 'way': its slope jumps",
    cut: "the motion of joint 'way': its value jumps",
    constraint: "constraint 'profile': its slope jumps",
    disc: "cam 'profile': its lift: its slope jumps",
    drum: "cam 'profile': its lift: its slope jumps",
}
SCENES = pytest.mark.parametrize("scene", PLACES, ids=[one.__name__ for one in PLACES])


@SCENES
def test_a_scene_is_evaluated_where_it_is_smooth_and_refused_where_it_is_not(scene):
    made = scene()
    assert evaluate(made).certified
    with pytest.raises(DeclarationError, match=PLACES[scene]):
        evaluate(made, parameters={"k": 1.0})


@SCENES
def test_a_prepared_scene_refuses_the_values_that_it_is_called_with(scene):
    f = prepare(scene(), wanted=["effort"])
    f(k=0.0)
    for asked in (f, f.peaks, f.gradient):
        with pytest.raises((DeclarationError, AssemblyError), match=PLACES[scene]):
            asked(k=1.0)
    f.peaks(k=0.0)


@SCENES
def test_designs_without_a_corner_keep_their_results_beside_those_with_one(scene):
    made = scene()
    p = np.array([[0.0], [1.0], [0.0], [0.7]])
    if scene is cut:
        p[3] = 1.0
    engine = DesignEngine.of(made, ["effort"])
    found, whole = engine.evaluate(p), engine.evaluate(p, histories=True)
    for one in (found, whole):
        assert one.status.tolist() == [Status.OK, Status.CORNER, Status.OK, Status.CORNER]
        assert np.isnan(one.value[1::2]).all()
        assert np.isfinite(one.value[::2]).all()
    assert np.isnan(whole.series[1::2]).all()
    np.testing.assert_array_equal(found.value[0], engine.evaluate(p[:1]).value[0])


@SCENES
def test_a_sweep_tells_a_corner_by_its_status(scene):
    swept = sweep(scene(), {"k": [0.0, 1.0]}, wanted=["effort"])
    assert swept["status"].tolist() == [Status.OK, Status.CORNER]


@SCENES
def test_an_export_refuses_a_corner_at_the_parameters_that_it_is_given(scene, tmp_path):
    with pytest.raises(DeclarationError, match=PLACES[scene]):
        export(scene(), tmp_path / "c", parameters={"k": 1.0}, wanted=["effort"])
    assert not (tmp_path / "c").exists()


def test_a_search_does_not_take_a_jump_for_the_best_design():
    """Beyond k = 0.5 the law jumps; at k = 1 it is straight elsewhere, and its effort would be
    zero.
    """
    found = optimise(cut(), minimise="peak:effort:way", over={"k": (0.2, 1.0)}, starts=3)
    assert abs(found.values["k"] - 0.2) < 1e-6


@SCENES
def test_a_scene_whose_defaults_have_a_corner_serves_for_values_that_have_none(scene, tmp_path):
    made = scene(1.0)
    with pytest.raises(DeclarationError, match=PLACES[scene]):
        evaluate(made)
    assert evaluate(made, parameters={"k": 0.0}).certified
    f = prepare(made, wanted=["effort"])
    np.testing.assert_array_equal(
        *(next(iter(one(k=0.0).values())) for one in (f, prepare(scene(), wanted=["effort"])))
    )
    with pytest.raises(DeclarationError, match=PLACES[scene]):
        f()
    assert sweep(made, {"k": [0.0, 1.0]}, wanted=["effort"])["status"].tolist() == [
        Status.OK,
        Status.CORNER,
    ]
    export(made, tmp_path / "c", parameters={"k": 0.0}, wanted=["effort"])


def test_what_is_exported_says_that_corners_were_looked_for_with_the_defaults(tmp_path):
    export(motion(), tmp_path / "c", wanted=["effort"])
    for name in ("README.md", "slide.h"):
        assert "checked with the default parameters only" in (tmp_path / "c" / name).read_text()


def test_a_live_page_says_that_sliders_go_by_corners(monkeypatch):
    monkeypatch.setattr("lagrange_casadi.report.live.check_zig", lambda what: None)
    monkeypatch.setattr(Live, "entry", lambda *_: {})
    m = Mechanism("plain")
    m.prismatic("way", m.ground, m.point_mass("body", m.parameter("mass", 2.0)), axis=(1, 0))
    plain = Scene(m, {"way": polynomial(0.0, 1.0)}, t=(0.0, 1.0, 11))
    for made, many in ((constraint(), 1), (plain, 0)):
        found = contents(evaluate(made), Live.of(made, made.timing(), None, "run"))["notes"]
        assert sum("Corners" in note for note in found) == many


def test_kinks_of_a_motion_are_looked_for_once_for_what_designs_share(monkeypatch):
    m = Mechanism("shared")
    body, k = m.point_mass("body", m.parameter("mass", 2.0)), m.parameter("k", 0.0)
    m.prismatic("way", m.ground, body, axis=(1, 0))
    made = Scene(m, {"way": expression(lambda t: bend(t, k))}, t=(0.0, 1.0, 11))
    seen, look = [], Smooth.broken
    monkeypatch.setattr(
        Smooth, "broken", lambda self, paths, p: seen.append(len(paths)) or look(self, paths, p)
    )
    f = prepare(made, wanted=["effort"])
    for mass in (1.0, 2.0, 3.0):
        f(mass=mass)
    found = f.designs([[mass, k] for mass in (1.0, 2.0, 3.0) for k in (0.0, 1.0)])
    assert found.status.tolist() == [Status.OK, Status.CORNER] * 3
    assert seen == [1, 2]


def away(x, k):
    """Roots, divisors and pieces that it does not come near to while k is small."""
    return 0.02 * ca.sin(x) * ca.sqrt(2 + ca.sin(x) - k) / (1.5 - k + ca.cos(x)) + ca.if_else(
        x < 10 - 9.5 * k, 0, 0.01
    )


@pytest.mark.parametrize("scene", [motion, constraint, disc])
def test_designs_off_every_kink_are_not_looked_at_instant_by_instant(scene, monkeypatch):
    monkeypatch.setitem(
        globals(), "bend", away if scene is not disc else lambda x, k: 0.1 * away(ca.sin(x), k)
    )
    f = prepare(scene(), wanted=["effort"])
    seen, look = [], Smooth.broken
    monkeypatch.setattr(
        Smooth, "broken", lambda self, paths, p: seen.append(len(paths)) or look(self, paths, p)
    )
    for k in (0.0, 0.1, 0.2):
        f(k=k)
        f.peaks(k=k)
    f.designs([[0.05], [0.15]])
    assert seen == []
    if scene is not disc:
        assert (f.designs([[0.05], [0.99]]).status != 0).tolist() == [False, True]
        assert seen == [1]


def test_series_stay_when_peaks_of_a_watched_constraint_are_asked_for():
    f = prepare(constraint(), wanted=["effort"])
    series = next(iter(f(k=0.0).values()))
    kept = series.copy()
    f.peaks(k=0.0)
    np.testing.assert_array_equal(series, kept)
