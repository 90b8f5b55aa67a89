"""Errors put into graphs: of the size that rounding has, and none over a jump."""

import math

import casadi as ca
import numpy as np
import pytest
from internals import TRIALS, EvaluationMethod, Instants, compensated, effects, plain, points, run

from lagrange_casadi import Mechanism, Scene, derive
from lagrange_casadi.motion import harmonic

pytestmark = pytest.mark.quick

STAGES = {
    "double": plain,
    "pairs": lambda program: compensated(program, "double"),
    "single": lambda program: compensated(program, "single"),
}


def of_load(load, stages="double", given=None):
    """What errors do to the torque on a driven link, (trials and the result, n), and the torque;
    ``given`` is what the result has at the seventh instant, and the effort that goes with it.
    """
    m = Mechanism("arm")
    link = m.link("arm", length=1.0, mass=1.0)
    joint = m.revolute("J", m.ground, link)
    m.torque("t", link, load(m.time, m.coordinate(joint), m.rate(joint)))
    law = {"J": harmonic(0.3, 1.0, 1.0)}
    program = derive(Scene(m, law, ["effort", "load:t"], t=(0.0, 1.0, 41)))
    t, p = points((0.0, 1.0, 41)), np.zeros(0)
    found, _ = run(program, t, p, EvaluationMethod("vm"))
    out, row = np.array(found.out), program.names.index("load:t:mz")
    if given is not None:
        out[-1, 7] += out[row, 7] - given
        out[row, 7] = given
    angles = np.array([name in program.loop_angles for name in program.columns])
    changes, columns = effects(Instants(STAGES[stages](program), t, p, found.iterated), out, angles)
    return changes[row], columns[row]


@pytest.mark.parametrize("stages", STAGES)
def test_what_rounds_has_errors_of_that_size(stages):
    """A product of numbers of many bits; and a difference that magnifies what a sum has rounded."""
    unit = 2.0**-24 if stages == "single" else 2.0**-53
    changes, columns = of_load(lambda t, q, w: 0.1 * w, stages)
    assert 0.2 * unit < np.max(np.abs(changes[:TRIALS])) / np.max(np.abs(columns)) < 6 * unit
    changes, _ = of_load(lambda t, q, w: 1e3 * ((w + 1e3) - 999.9), stages)
    assert 0.2 * unit * 1e6 < np.max(np.abs(changes[:TRIALS])) < 2 * unit * 1e6


AT = 0.3 + math.sin(2 * math.pi * 7 / 40)
"""Where the arm is at the seventh instant, but for rounding."""


@pytest.mark.parametrize(
    "jump",
    [lambda q: ca.sign(q - AT), lambda q: ca.copysign(1.0, q - AT), lambda q: 1 - 2 * (q < AT)],
)
def test_the_side_that_a_result_took_is_found(jump):
    """On either side of a jump, where rounding decides, a result is none the worse; one on no side
    is an error.
    """
    for load in (-1e3, 1e3, 400.0):
        changes, columns = of_load(lambda t, q, w: 1e3 * jump(q), given=load)
        assert np.max(np.abs(changes[:TRIALS])) < 1e-9
        if load == 400.0:
            assert 400.0 <= np.max(np.abs(changes[TRIALS])) <= 1400.0
        else:
            assert columns[7] == load
            assert np.max(np.abs(changes)) < 1e-9
