"""The formulas themselves: the graphs' instructions in 50 digits against Newton-Euler in 50 digits, where no rounding can hide.

What differs after forty digits differs in kind. Every number of a case is a parameter (:mod:`parametric`), and what constants are
left in its graphs are taken for what they mean.
"""

from dataclasses import replace

import mpmath
import numpy as np
import pytest
from parametric import declared, meant
from precise import precise
from test_cases import CASES, NAMES

from lagrange_casadi import derive
from lagrange_casadi.backends import run
from lagrange_casadi.interpret import interpret
from lagrange_casadi.parts import RigidMass
from lagrange_casadi.reference import arithmetic, reference
from lagrange_casadi.rung import Rung

MP = mpmath.mp
EXACT = replace(arithmetic(), constant=meant(MP.mpf))
RATIOS = (0.0, 0.1234567, 0.5012345, 0.9034567, 1.0)
# Of the engine, where the gas's pressure lies between table entries that are doubles.
PARTS = {"engine": (340 / 720, 371.5 / 720, 397 / 720)}


@pytest.mark.parametrize("name", NAMES)
def test_formulas_to_forty_digits(name, monkeypatch):
    monkeypatch.setattr("lagrange_casadi.reference.arithmetic", lambda: EXACT)
    scene = declared(CASES / name)
    graph, p = derive(scene, ["all"]), list(scene.mechanism.values().values())
    t = scene.t[0] + np.array(PARTS.get(name, (0.0, 0.4, 0.77))) * (scene.t[1] - scene.t[0])
    grid = np.unique([*np.linspace(scene.t[0], t[-1], 100), *t])
    table, _ = run(graph, grid, np.array(p), Rung("vm"))
    rows = reference(graph, t, p, z=table.iterated[:, np.searchsorted(grid, t)])
    with MP.workdps(60):
        for moment, row in zip(t, rows, strict=True):
            driven = interpret(graph.motion, [[MP.mpf(moment)], [MP.mpf(x) for x in p]], EXACT)
            drives = {joint: tuple(order[k] for order in driven) for k, joint in enumerate(graph.driven)}
            expected, found = precise(scene, float(moment), drives), dict(zip(graph.columns, row, strict=True))
            assert_equal(expected, found, scene.mechanism)


def assert_equal(expected, found, mechanism):
    """To forty digits: forces of the largest force, places of a metre, angles up to whole turns."""
    forces = max(abs(value) for name, value in expected.items() if name.startswith("reaction"))
    compared = set()
    for name, value in expected.items():
        if name.startswith("section"):
            _, link, force = name.split(":")
            gaps = [section(found, link, mechanism, ratio)[force] - value(MP.mpf(ratio)) for ratio in RATIOS]
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
    assert {n for n in found if n.startswith(("effort", "reaction", "pose", "multiplier"))} <= set(expected)


def section(found, link, mechanism, ratio):
    """A link's section forces from its law and stations, with the moments of its density as they are defined."""
    body, values = mechanism.links[link], mechanism.values()
    assert not isinstance(body.mass, RigidMass)
    assert len(body.mass.cells) == 1
    l, u = MP.mpf(mechanism.number(body.length, values)), MP.mpf(ratio)
    cell = [MP.mpf(mechanism.number(c, values)) * (l if body.mass.per_length else 1) for c in body.mass.cells[0]]
    mu = [l**k * sum(c * (1 - u ** (j + k + 1)) / (j + k + 1) for j, c in enumerate(cell)) for k in range(3)]
    law = {k: found[f"section:{link}:law:{k}"] for k in ("n0", "n1", "n2", "f0", "f1", "f2", "m0")}
    xi = u * l
    forces = {
        "axial": law["n0"] + law["n1"] * mu[0] + law["n2"] * mu[1],
        "shear": law["f0"] + law["f1"] * mu[0] + law["f2"] * mu[1],
        "bending": law["m0"] + law["f0"] * (l - xi) + law["f1"] * (mu[1] - xi * mu[0]) + law["f2"] * (mu[2] - xi * mu[1]),
    }
    for name in found:
        if name.startswith(f"section:{link}:") and name.endswith(":station"):
            n, f, m, station = (found[name.removesuffix("station") + member] for member in ("n", "f", "m", "station"))
            if u < station:
                forces["axial"] += n
                forces["shear"] += f
                forces["bending"] += m + f * (station - u) * l
    return forces


@pytest.mark.parametrize(
    ("x", "value"),
    [
        (1 / 3, lambda pi: MP.mpf(1) / 3),
        (-1 / 12, lambda pi: MP.mpf(-1) / 12),
        (0.1, lambda pi: MP.mpf(1) / 10),
        (0.12345678, lambda pi: MP.mpf(0.12345678)),
        (2 * np.pi, lambda pi: 2 * pi),
        (180 / np.pi, lambda pi: 180 / pi),
        (0.0, lambda pi: 0),
        (np.inf, lambda pi: MP.inf),
    ],
)
def test_what_constants_mean(x, value):
    with MP.workdps(50):
        exact = value(MP.mpf(np.pi))
        assert meant(MP.mpf)(float(x)) == exact or abs(meant(MP.mpf)(float(x)) / exact - 1) < MP.mpf(10) ** -48
