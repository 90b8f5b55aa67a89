"""The formulas themselves: the graphs' instructions in 50 digits against Newton-Euler in 50 digits,
where no rounding can hide.

What differs after forty digits differs in kind. Every number of a case is a parameter
(:mod:`parametric`), and what constants are left in its graphs are taken for what they mean.
"""

from dataclasses import replace

import mpmath
import numpy as np
import pytest
from conftest import CASES, PLANAR
from internals import EvaluationMethod, arithmetic, interpret, reference, run
from oracle import SECTION
from parametric import declared, meant
from precise import precise
from truth import matter_of, section

from lagrange_casadi import derive

MP = mpmath.mp
EXACT = replace(arithmetic(), constant=meant(MP.mpf))
RATIOS = (0.0, 0.1234567, 0.5012345, 0.9034567, 1.0)
# Of the engine, where the gas's pressure lies between table entries that are doubles.
# Of the servo press, where its ram meets no part: what that bears is a table too.
PARTS = {"engine": (340 / 720, 371.5 / 720, 397 / 720), "servo_press": (0.0, 0.13, 0.77)}
# Of the connecting rod the oracle has densities that doubles work out of dimensions, not to forty
# digits; and for the cam's right angle the package takes the double nearest to it, which the oracle
# takes as it is, 6e-17 off. So it is with a third of a turn.
EXACTLY = [
    name for name in PLANAR if name not in ("connecting_rod", "roller_cam", "planetary_gear")
]


@pytest.mark.sampled(7)
@pytest.mark.parametrize("name", EXACTLY)
def test_formulas_to_forty_digits(name, monkeypatch):
    monkeypatch.setattr("lagrange_casadi.results.verification.reference.arithmetic", lambda: EXACT)
    scene = declared(CASES / name)
    program, p = derive(scene, ["all"]), list(scene.mechanism.values().values())
    t = scene.t[0] + np.array(PARTS.get(name, (0.0, 0.4, 0.77))) * (scene.t[1] - scene.t[0])
    grid = np.unique([*np.linspace(scene.t[0], t[-1], 100), *t])
    table, _ = run(program, grid, np.array(p), EvaluationMethod("vm"))
    rows = reference(program, t, p, table.iterated[:, np.searchsorted(grid, t)])
    with MP.workdps(60):
        for moment, row in zip(t, rows, strict=True):
            driven = interpret(program.motion, [[MP.mpf(moment)], [MP.mpf(x) for x in p]], EXACT)
            drives = {
                joint: tuple(order[k] for order in driven) for k, joint in enumerate(program.driven)
            }
            expected = precise(scene, float(moment), drives)
            found = dict(zip(program.names, row, strict=True))
            assert_equal(expected, found, scene.mechanism)


def assert_equal(expected, found, mechanism):
    """To forty digits: forces of the largest force, places of a metre, angles up to whole turns."""
    forces = max(abs(value) for name, value in expected.items() if name.startswith("reaction"))
    compared = set()
    for name, value in expected.items():
        if name.startswith("section"):
            _, link, force = name.split(":")
            k, matter = SECTION.index(force), matter_of(mechanism, mechanism.values(), link)
            gaps = [
                section(found, matter, link, ratio)[k] - value(MP.mpf(ratio)) for ratio in RATIOS
            ]
        elif name in found:
            gaps = [found[name] - MP.mpf(value)]
        else:
            assert value == 0, name  # a moment that the joint does not bear
            continue
        if name.endswith(":angle"):
            gaps = [gap - 2 * MP.pi * MP.nint(gap / (2 * MP.pi)) for gap in gaps]
        size = 1 if name.startswith("pose") else forces
        assert max(map(abs, gaps)) < MP.mpf(10) ** -40 * size, name
        compared.add(name.partition(":")[0])
    assert {"effort", "reaction", "pose"} <= compared
    assert {n for n in found if n.startswith(("effort", "reaction", "pose", "multiplier"))} <= set(
        expected
    )
