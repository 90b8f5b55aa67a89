"""A line says where a drive that turns makes no whole turn, or not the same in every design; a
drive that swings is left alone.
"""

import math

import casadi as ca
import numpy as np
import pytest
from internals import kinds_of_described, note, template, turning_note
from mechanisms import press, uneven

from lagrange_casadi import Mechanism, Scene, motion

pytestmark = pytest.mark.quick


def said(scene, rows=((600.0, 0.5),), **asked):
    return note(
        scene.prescribed,
        kinds_of_described(template(scene).content),
        scene.timing(**asked),
        np.array(rows),
    )


@pytest.mark.parametrize(
    "law",
    [
        motion.polynomial,
        uneven,
        lambda _, w: motion.polynomial(0, 0, 100.0),
        lambda _, w: sampled(),
    ],
)
def test_less_than_a_turn_is_said_with_what_makes_it_whole(law):
    found = said(press(law), t=(0, 0.05, 31))
    assert found.startswith("drive 'O' makes 0.")
    assert found.endswith("of a revolution; instants over O=0deg:360deg:31 make it a whole number")


def sampled():
    return motion.samples(np.linspace(0, 0.2, 41), 60 * np.linspace(0, 0.2, 41))


def test_the_line_begins_where_the_motion_does_and_goes_its_way():
    back = press(lambda _, w: motion.polynomial(1.0, -w))
    assert (
        said(back, t=(0, 0.01, 9))
        == "drive 'O' makes 0.1 of a revolution; instants over O=57.2958deg:-302.704deg:9 make it"
        " a whole number"
    )


@pytest.mark.parametrize(
    "asked",
    [{"t": (0, 0.1, 31)}, {"t": (0, 0.35, 31)}, {"over": ("O", 0, 1, 5)}, {"t": (0.02, 0.02, 1)}],
)
def test_nothing_is_said_of_whole_turns_of_one_instant_and_of_what_was_asked_for_by_the_drive(
    asked,
):
    assert said(press(), **asked) == ""


@pytest.mark.parametrize(
    "law",
    [
        motion.harmonic(0.3, 1.2, 2.0),
        motion.harmonic(0.3, 1.2, 0.5),
        motion.polynomial(0.0, 0.0, 300.0, -2000.0),
        motion.expression(lambda t: ca.if_else(t < 0.1, 1.0 - ca.cos(10 * math.pi * t), 2.0)),
        motion.polynomial(1.0),
        motion.samples([0, 0.05, 0.1, 0.15], [0, 0.5, 1.0, 1.5]),
    ],
)
def test_a_drive_that_swings_rests_or_is_known_for_less_than_a_turn_is_left_alone(law):
    for stop in (0.02, 0.05, 0.1):
        assert said(press(lambda *_: law), t=(0, stop, 31)) == ""


def test_a_slide_and_several_drives_have_no_turns():
    m = Mechanism("m")
    first, second = m.link("a", length=0.2, mass=1.0), m.link("b", length=0.2, mass=1.0)
    m.revolute("O", m.ground, first)
    m.revolute("P", first.tip, second)
    scene = Scene(m, {"O": motion.polynomial(0, 1.0), "P": motion.polynomial(0, 2.0)})
    assert said(scene, np.zeros((1, 0))) == ""
    m = Mechanism("m")
    m.prismatic("S", m.ground, m.point_mass("a", 1.0), axis=(1, 0))
    scene = Scene(m, {"S": motion.polynomial(0, 1.0)})
    assert said(scene, np.zeros((1, 0))) == ""


def test_a_sweep_says_where_designs_make_different_turns():
    scene = press(t=(0, 0.1, 31))
    rows = [[600.0, 0.5], [6000.0, 0.5], [0.0, 0.5]]
    assert (
        said(scene, rows[:2])
        == "drive 'O' makes 1 to 10 turns, not the same in every design; instants over"
        " O=0deg:3600deg:31 make it a whole number"
    )
    found = turning_note(scene, scene.timing(), {"rpm": (300.0, 1200.0, 4)}, {"l": 0.4})
    assert found.startswith("drive 'O' makes 0.5 to 2 turns, not the same in every design")
    assert turning_note(scene, scene.timing(), {"l": (0.3, 0.5, 4)}, {}) == ""
    whole = press(t=lambda rpm: (0, 60 / rpm, 31))
    assert turning_note(whole, whole.timing(), {"rpm": (300.0, 1200.0, 4)}, {}) == ""
