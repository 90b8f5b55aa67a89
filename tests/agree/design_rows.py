"""Designs around a scene, and what their peaks are compared with."""

import math

import numpy as np
import pytest

from lagrange_casadi import density, derive, evaluate, refine


def around(scene, count, spread=0.03, seed=0):
    """So many designs, the first with the defaults, the others so far around them."""
    base = np.array(list(scene.mechanism.values().values()))
    p = base * np.random.default_rng(seed).uniform(1 - spread, 1 + spread, (count, base.size))
    p[0] = base
    return p


def values(scene, row):
    return dict(zip(scene.mechanism.parameters, row.tolist(), strict=True))


def alone(scene, row, grid, **keywords):
    """A design's own evaluation."""
    words = {"backend": "c", "certificate": False}
    return evaluate(scene, parameters=values(scene, row), t=grid, **words, **keywords)


def peaks_of(designs, outcome, row):
    """Value, time and ratio of each quantity of a design."""
    return {
        name: (outcome.value[row, k], outcome.t[row, k], outcome.xi[row, k])
        for k, name in enumerate(designs.quantities)
    }


def scales(designs, outcome, row):
    """The largest peak of each quantity's unit."""
    units = np.array(designs.units)
    sizes = np.abs(np.where(np.isfinite(outcome.value[row]), outcome.value[row], 0.0))
    return {
        name: sizes[units == unit].max()
        for name, unit in zip(designs.quantities, designs.units, strict=True)
    }


def assert_refined(scene, designs, outcome, row, p, tolerance=1e-11, noise=1e-12):
    """A design's peaks are the refined ones of its own evaluation; one that is larger is what the
    graph gives there.
    """
    grid = (designs.t[0], designs.t[-1], designs.t.size)
    solution = alone(scene, p, grid)
    found, scale = peaks_of(designs, outcome, row), scales(designs, outcome, row)
    names = [name for name in designs.quantities if name in set(solution.names())]
    assert len(names) > len(designs.quantities) / 2
    for peak in refine(scene, solution, names):
        value, t, xi = found[peak.name]
        if math.isinf(peak.value) or math.isinf(value):
            assert math.isinf(peak.value), peak.name
            assert math.isinf(value), peak.name
            continue
        allowed = tolerance * abs(value) + noise * scale[peak.name]
        assert abs(value) >= abs(peak.value) - allowed, peak.name
        if abs(value) > abs(peak.value) + allowed:
            assert derive(scene).newton is None
            there = alone(scene, p, (t, t, 1))
            assert there.peak(peak.name).value == pytest.approx(value, rel=1e-10), peak.name
        assert np.isnan(xi) == (peak.xi is None)
    for name in (name for name in designs.quantities if name.endswith(":resultant")):
        size, resultant = solution.array(name), found[name][0]
        parts = [abs(found[name.replace("resultant", member)][0]) for member in ("fx", "fy")]
        assert resultant >= max(size.max() * (1 - 1e-14), *(part * (1 - 1e-11) for part in parts))
        assert resultant <= math.hypot(*parts) * (1 + 1e-11)


def loaded(mechanism, parts):
    """Loads at stations, two of them at one, and one at the very tip."""
    rod, where = parts["b"], mechanism.parameter("where", 0.2, "m")
    mechanism.force("push", rod.at(where), x=30.0, y=-40.0)
    mechanism.force("pull", rod.at(where), y=25.0)
    mechanism.torque("twist", rod.at(0.1), 4.0)
    mechanism.force("end", rod.tip, y=12.0)


DENSITIES = {
    "uniform": lambda: {"mass": 0.7},
    "tapered": lambda: {"density": density.polynomial(4.0, -3.0)},
    "cubic": lambda: {"density": density.polynomial(1.0, 2.0, -4.0, 3.0)},
    "table": lambda: {
        "density": density.tabulated([0, 0.2, 0.25, 0.9, 1], [1.0, 3.0, 0.5, 0.5, 4.0])
    },
}
