"""Corners and jumps of what is differentiated twice: refused with the way out, by whatever way, for
the parameters that have them.
"""

import functools
import math
import re

import casadi as ca
import numpy as np
import pytest
from drawn_curves import cam, constraint, slide
from hypothesis import given, settings
from hypothesis import strategies as st
from outside import doubled

from lagrange_casadi import Mechanism, Scene, evaluate, export, prepare, sweep, table
from lagrange_casadi.errors import AssemblyError, DeclarationError
from lagrange_casadi.motion import expression

pytestmark = pytest.mark.usefixtures("interpreted")

X, Y, T = (ca.SX.sym(name) for name in "xyt")


TURN = np.linspace(0.0, math.tau, 37)


def kink(program, span=(-20.0, 20.0), count=4001):
    """The refusal of a slide that moves by an expression; None if there is none."""
    m = Mechanism("m")
    m.prismatic("way", m.ground, m.point_mass("body", 2.0), axis=(1, 0))
    symbols = ca.vertcat(X, Y, T)
    law = expression(lambda t: ca.substitute(program, symbols, ca.vertcat(t, -0.27, t)))
    try:
        evaluate(Scene(m, {"way": law}, t=(*span, count)), wanted=["effort"], certificate=False)
    except DeclarationError as error:
        return str(error)
    return None


def rise(u):
    """From 0 to 1 over u from 0 to 1, with no slope and no bend at either end."""
    return ca.if_else(u < 0, 0, ca.if_else(u < 1, u**3 * (10 - 15 * u + 6 * u**2), 1))


SMOOTH = {
    "nothing that could": ca.sin(X) * Y + X**3 - ca.sqrt(1 + Y**2),
    "pieces that go on": Y - rise(X) + 0.3 * rise(2 * X - 3),
    "an acceleration that jumps": Y - ca.if_else(X < 0.3, X**2, 0.09 + 0.6 * (X - 0.3)),
    "a square of a size": ca.fabs(X) * X + Y,
    "a square of what is left": Y - ca.fmax(X - 0.3, 0) ** 2,
    "a sine of a remainder": Y - ca.sin(ca.remainder(X, math.tau)) * ca.cos(ca.fmod(Y, math.tau)),
    "a curve that comes round": Y - rise(ca.fmod(X, 3.0)) + rise(ca.fmod(X, 3.0) - 1.5),
    "whole parts of a parameter alone": Y * ca.floor(2.5),
    "the same where it is kept from noise": (
        Y - ca.if_else(ca.fabs(X) < 1e-3, 0.5 - X**2 / 24, (1 - ca.cos(X)) / X**2)
    ),
    "a bump": Y - ca.if_else(X > 0.5, ca.exp(-1 / (X - 0.5)), 0),
    "a size of what only touches zero": Y - ca.fabs(ca.sin(7 * X + 0.0652521) + 1),
    "a corner that is rounded": Y - ca.sqrt((X - 0.3) ** 2 + 1e-9),
}


BROKEN = {
    "a table": (Y - table(X, TURN, np.sin(TURN)), "slope"),
    "a table of micrometres": (
        Y - table(X, 0.3 + 1e-5 * np.arange(5), 1e-5 * np.arange(5) ** 2),
        "slope",
    ),
    "a table of time": (Y - table(T, [0.0, 3.0, 5.0], [0.0, 1.0, 0.0]), "slope"),
    "a table within": (Y - ca.sin(table(ca.cos(X) + Y, [0.0, 0.5, 1.0], [0.0, 0.1, 0.4])), "slope"),
    "CasADi's own": (Y - ca.pw_lin(X, ca.DM([0, 1, 2]), ca.DM([0, 1, 4])), "slope"),
    "a size": (Y - ca.fabs(X), "slope"),
    "the larger one": (Y - ca.fmax(X, Y * T), "slope"),
    "the smaller one": (Y - ca.fmin(X, 0.3), "slope"),
    "a piece too steep": (Y - ca.if_else(X < 1, X, 1 + 1.0001 * (X - 1)), "slope"),
    "a piece too high": (Y - ca.if_else(X < 1, X, X + 1e-3), "value"),
    "whole parts": (Y - ca.floor(X), "value"),
    "a sign": (Y - ca.sign(X - Y), "value"),
    "a remainder": (Y - ca.remainder(X, 1.0), "value"),
    "the angle of a sine": (Y - ca.asin(ca.sin(X)), "slope"),
    "the artanh of a sine": (Y - ca.atanh(ca.sin(X)), "value"),
    "the angle of a cosine": (Y - ca.acos(ca.cos(X)), "slope"),
    "the area cosine of a cosine": (Y - ca.acosh(ca.cosh(X / 9)), "slope"),
    "a cube root": (Y - ca.sign(X - 0.3) * ca.fabs(X - 0.3) ** (1 / 3), "slope"),
    "a size by its logarithm": (Y - (X - 0.3) * ca.log(ca.fabs(X - 0.3)), "slope"),
    "an exponential of an inverse": (Y - ca.exp(-1 / (X - 15.0013)), "value"),
    "waves without end": (Y - (X - 0.3) ** 2 * ca.sin(1 / (X - 0.3)), "slope"),
    "a cut just off the instants": (Y - ca.atan2(ca.sin(X - 1.2e-9), ca.cos(X - 1.2e-9)), "value"),
    "a size by its sign": (Y - ca.copysign(ca.sin(X), 2 + ca.cos(X)), "slope"),
    "a sine's size": (Y - ca.fabs(ca.sin(X)), "slope"),
    "two sizes in 0.45 of a step": (Y - ca.fabs((X - 0.0045) ** 2 - 1e-8), "slope"),
}


@pytest.mark.quick
@pytest.mark.parametrize("name", SMOOTH)
def test_smooth(name):
    for span in ((-20.0, 20.0), (-0.2, 0.8)):
        assert kink(SMOOTH[name], span) is None


@pytest.mark.parametrize("name", BROKEN)
def test_broken(name):
    program, what = BROKEN[name]
    assert re.match(f"the motion of joint 'way': its {what} (jumps|has no limit)", kink(program))


def test_what_another_program_tells_is_followed_too(monkeypatch):
    """Its marks are not known; waves that are too fast to be followed are refused."""
    monkeypatch.setattr("lagrange_casadi.engine.instants.refusing._SAMPLED", 41)
    assert "its slope jumps" in kink(Y - ca.fabs(doubled(X - 0.333)), count=41)
    monkeypatch.setattr("lagrange_casadi.model.kinks._MOST", 8)
    assert "changes too fast between two instants" in kink(Y - ca.sin(100 * doubled(X)), count=41)


def test_it_says_by_how_much_and_where():
    says = "its slope jumps by 33.3 % where t = 0.7"
    assert says in kink(ca.if_else(X < 0.7, 3 * X, 2.1 + 2 * (X - 0.7)))
    assert "as curve(x, y) in place of a table" in kink(table(X, TURN, np.sin(TURN)))


@settings(max_examples=20, deadline=None)
@given(
    places=st.lists(st.integers(-600, 600), min_size=3, max_size=12, unique=True),
    values=st.lists(st.integers(-300, 300), min_size=12, max_size=12),
    scale=st.sampled_from([1e-4, 1e-2, 1.0]),
)
def test_tables_are_refused_unless_they_are_straight_lines(places, values, scale):
    """By the slopes that the table itself tells."""
    at, to = scale * np.sort(places), np.array(values[: len(places)], float)
    slopes = np.diff(to) / np.diff(at)
    bent = np.abs(np.diff(slopes)).max() > 1e-6 * np.abs(slopes).max()
    assert (kink(table(X, at, to), (at[0] - scale, at[-1] + scale), 501) is not None) is bool(bent)


@pytest.mark.parametrize(
    ("law", "span", "broken"),
    [
        *((ca.fmax(ca.fmin(2 * T, 1.0), 0.0), span, broken) for span, broken in (
            ((0.1, 0.4), False), ((0.6, 3.0), False), ((0.1, 0.6), True), ((-1.0, 0.2), True))),
        (T**2.5, (0.0, 1.0), False),
        (T**0.5, (0.0, 1.0), True),
    ],
)  # fmt: skip
def test_only_what_is_within_a_span_is_looked_at(law, span, broken):
    """At the end of a path one side has a limit or not."""
    assert (kink(law, span) is not None) is broken


def bend(x, k):
    """Smooth for k = 0; else with a corner of that size at x = 0.5."""
    return 0.02 * (ca.sin(x) + k * ca.fabs(ca.sin(x - 0.5)))


def jump(t, k):
    """The angle of 7 t, which atan2 takes back by a turn, where k is not 0."""
    return ca.atan2(k * ca.sin(7 * t), 1 - k + k * ca.cos(7 * t))


PLACES = {
    functools.partial(slide, bend): "the motion of joint 'way': its slope jumps",
    functools.partial(slide, jump): "the motion of joint 'way': its value jumps",
    functools.partial(constraint, bend): "constraint 'profile': its slope jumps",
    functools.partial(
        cam, lambda x, k: 0.1 * bend(x, k)
    ): "cam 'profile': its lift: its slope jumps",
}


SCENES = pytest.mark.parametrize("scene", PLACES)


@SCENES
def test_parameters_with_a_corner_are_refused_by_every_way(scene, tmp_path):
    """And others beside them have their results."""
    made, says = scene(), PLACES[scene]
    assert evaluate(made, wanted=["all"]).certified
    f = prepare(made, wanted=["effort"])
    for refused in (
        lambda: evaluate(made, parameters={"k": 1.0}),
        *(lambda asked=asked: asked(k=1.0) for asked in (f, f.peaks, f.gradient)),
        lambda: export(made, tmp_path / "c", parameters={"k": 1.0}, wanted=["effort"]),
    ):
        with pytest.raises((DeclarationError, AssemblyError), match=says):
            refused()
    assert not (tmp_path / "c").exists()
    found = f.designs([[0.0], [1.0], [0.0]], histories=True)
    assert (found.status != 0).tolist() == [False, True, False]
    assert np.isnan([*found.value[1], *found.series[1].ravel()]).all()
    assert np.isfinite(found.value[::2]).all()
    assert (sweep(made, {"k": [0.0, 1.0]}, wanted=["effort"])["status"] != 0).tolist() == [0, 1]


@pytest.mark.sampled(2)
@SCENES
def test_a_scene_whose_defaults_have_a_corner_serves_for_values_that_have_none(scene, tmp_path):
    made = scene(default=1.0)
    f = prepare(made, wanted=["effort"])
    for refused in (lambda: evaluate(made), f):
        with pytest.raises(DeclarationError, match=PLACES[scene]):
            refused()
    assert evaluate(made, wanted=["all"], parameters={"k": 0.0}).certified
    one, other = (next(iter(g(k=0.0).values())) for g in (f, prepare(scene(), wanted=["effort"])))
    np.testing.assert_array_equal(one, other)
    export(made, tmp_path / "c", parameters={"k": 0.0}, wanted=["effort"])
    text = (tmp_path / "c" / "README.md").read_text()
    assert "corners" in text.lower()
