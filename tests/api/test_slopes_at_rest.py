"""Slopes where a joint that rubs is at rest: only what depends on its friction has none there."""

import pytest

from lagrange_casadi import Mechanism, Scene, prepare, tolerances
from lagrange_casadi.motion import dwell, move, moves


def beside():
    """A slide that rubs and rests, and an arm beside it with which its
    friction has nothing to do.
    """
    m = Mechanism("beside")
    l, mu = m.parameter("l", 0.4, "m"), m.parameter("mu", 0.15)
    ram = m.link("ram", length=0.05, mass=2.0, centre=(0.0, 0.0), inertia=1e-3)
    m.friction("rub", m.prismatic("bore", m.ground, ram, axis=(1, 0)), mu=mu, length=0.06)
    m.revolute("O", m.ground.at(1.0, 0.0), m.link("arm", length=l, mass=3.0))
    laws = {
        joint: moves([dwell(0.2), move(by=by, time=0.3), dwell(0.2)])
        for joint, by in (("bore", 0.1), ("O", 1.0))
    }
    return Scene(m, laws, wanted=["effort", "reaction", "friction"], t=(0, 0.7, 36))


@pytest.mark.parametrize("backend", ["auto", "c", pytest.param("vm", marks=pytest.mark.long)])
def test_slopes_of_what_friction_at_rest_has_nothing_to_do_with(backend):
    """There they are no numbers only of what depends on friction: of peaks at rest, and of means
    over all instants.
    """
    f = prepare(beside(), backend=backend)
    gradient = f.gradient()
    for name, bears in (("resultant", 19.62), ("fy", 19.62), ("fx", 0.0), ("mz", 0.0)):
        k = f.quantities.index(f"reaction:bore:{name}")
        assert abs(gradient.value[k]) == pytest.approx(bears)
        assert gradient.slopes[k].tolist() == [0.0, 0.0]
    step = 1e-4
    above, below = f.copy().peaks(l=0.4 + step), f.copy().peaks(l=0.4 - step)
    k = f.efforts.index("effort:O")
    for found, difference in (
        (gradient.mean, above.mean - below.mean),
        (gradient.rms, above.rms - below.rms),
    ):
        assert found["effort:O"]["l"] == pytest.approx(difference[k] / (2 * step), rel=1e-6)
    # A friction of none at all has its peak at an instant that counts.
    frictionless = f.peaks(mu=0.0)
    assert frictionless.t[f.quantities.index("friction:rub:along")] == pytest.approx(0.22)
    spread = tolerances(beside(), {"l": "1mm", "mu": 0.01}, samples=20, backend=backend).peaks[
        "reaction:bore:fx"
    ]
    assert (spread.worst, spread.sigma) == (0.0, 0.0)
