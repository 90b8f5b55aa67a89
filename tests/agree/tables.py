"""Cycle tables for tests: of cases, at any angle and motion, and how far they are from their
graphs.
"""

from __future__ import annotations

import math

import numpy as np
from conftest import CASES
from internals import determinate, tabulate

from lagrange_casadi import derive, load_case

RATES = (60.0, 900.0)


def case(name):
    return load_case(CASES / name).scene


def made(scene, table=1e-9, wanted=None, rates=RATES):
    return tabulate.tabulate(graph_of(scene, wanted), values(scene), table, rates)


def graph_of(scene, wanted=None):
    """The graph of a scene, of what equilibrium determines."""
    program = derive(scene, wanted)
    return determinate(program, np.linspace(*scene.span, scene.t[2]), values(scene))[0]


def values(scene):
    return np.array(list(scene.mechanism.values().values()))


def some_motion(n=500, turns=3.0, seed=1):
    """Angles, rates and accelerations of either sign, up to the largest."""
    random = np.random.default_rng(seed)
    signs = random.uniform(-1.0, 1.0, (3, n))
    signs[:, :4] = [[0.1, 0.2, -0.1, -0.2], [1, 1, -1, -1], [1, -1, 1, -1]]
    return signs * np.array([[math.tau * turns], [RATES[0]], [RATES[1]]])


def directly(scene, angle, rate, acceleration, wanted=None):
    """Every column by CasADi's virtual machine; iterated loops are followed from angle to angle."""
    program, p = graph_of(scene, wanted), values(scene)
    places = np.zeros((len(program.newton.guess) if program.newton else 0, angle.size))
    for side in (1, -1) if program.newton else ():
        z, at = np.array(program.newton.guess), float(program.motion(scene.t[0], p)[0])
        away = side * (angle - at)
        for i in (i for i in np.argsort(away) if away[i] >= 0.0):
            for moment in np.linspace(at, angle[i], 20):
                for _ in range(6):
                    z = z + program.newton.step(z, 0.0, moment, p)[0].full().ravel()
            places[:, i], at = z, angle[i]
    return program.instant(0.0, angle[None], rate[None], acceleration[None], places, p).full()


def whole_turns_apart(program):
    """The rows that are known up to whole turns."""
    return [name in program.loop_angles for name in program.columns]


def worst_gap(scene, table, angle, rate, acceleration, wanted=None):
    """The largest difference between a table and its graph, over each column's peak; of angles less
    whole turns.
    """
    found = np.full((len(table.columns), angle.size), np.nan, table.dtype)
    table.evaluate(*(row.astype(table.dtype) for row in (angle, rate, acceleration)), found)
    gap = found - directly(scene, angle, rate, acceleration, wanted)
    loose = whole_turns_apart(graph_of(scene, wanted))
    gap[loose] -= math.tau * np.rint(gap[loose] / math.tau)
    # A table has whole turns in the angles themselves.
    gap[[name.startswith("_turns:") for name in table.columns]] = 0.0
    return np.max(np.abs(gap).max(axis=1) / np.where(table.peaks > 0, table.peaks, 1.0))
