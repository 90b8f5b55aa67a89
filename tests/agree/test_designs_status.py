"""Why a design has no result: as its own evaluation is refused."""

import math

import numpy as np
import pytest
from conftest import CASES
from design_rows import around, values
from internals import DesignEngine, EvaluationMethod, Status, run
from internals import refusal_refusal as refusal
from mechanisms import double_crank, slider_crank, truss_platform
from parametric import declared

from lagrange_casadi import Mechanism, Scene, load_case
from lagrange_casadi.errors import ParameterError
from lagrange_casadi.motion import polynomial


def statuses(scene, p, method, instants=None):
    """The statuses of designs, as they are found and as their own evaluations are refused."""
    designs = DesignEngine.of(scene, t=instants, method=method)
    found, expected = designs.evaluate(p).status, []
    for row in p:
        try:
            scene.mechanism.values(values(scene, row))
        except ParameterError:
            expected.append(Status.IMPOSSIBLE if np.isfinite(row).all() else Status.INVALID)
            continue
        table, _ = run(designs.program, designs.t, row, method)
        why = refusal(designs.program, table, designs.t, row, method)
        expected.append(why.status if why else Status.OK)
    return found.tolist(), expected


both = pytest.mark.parametrize("backend", ["lanes", "vm"])


@pytest.mark.sampled(2)
@pytest.mark.parametrize("backend", ["lanes", "c", pytest.param("vm", marks=pytest.mark.long)])
def test_lengths_about_a_dead_centre(backend):
    """A crank as long as its rod, all but, and longer; on the instants of dead centres and beside
    them.
    """
    near = [1 + sign * 10.0**k for sign in (-1, 1) for k in (-13, -10, -6, -4, -3)]
    ratios = [*near, 1.0, 1.01, 1.5, -1.0, 0.0, math.nan]
    p = np.array([[0.1, 0.1 * ratio, 0.1, 0.1, 0.1] for ratio in ratios])
    seen = set()
    for count in (81, 802):
        # Without a compiler one effort is looked at, for peaks along links take long.
        scene = slider_crank(["effort"] if backend == "vm" else ["all"])
        found, expected = statuses(scene, p, EvaluationMethod(backend), (0, 0.08, count))
        # Between two instants all but dead centres are passed: what is worth looking at is left to
        # rounding, or has no end.
        for k, ratio in enumerate(ratios):
            if abs(ratio - 1) < 1e-9 and found[k] == Status.PEAK_NOT_TOLD:
                found[k] = Status.OK
        assert found == expected
        seen |= set(found)
    assert seen >= {
        Status.OK,
        Status.OUT_OF_REACH,
        Status.PASSES_DEAD_CENTRE,
        Status.IMPOSSIBLE,
        Status.INVALID,
    }


@both
def test_a_dead_centre_on_an_instant(backend):
    m = Mechanism("dead")
    a = m.link("a", length=1.0, mass=1.0)
    b = m.link("b", length=m.parameter("l", 1.0), mass=1.0)
    p = m.point_mass("p", 1.0)
    m.revolute("O", m.ground, a)
    m.revolute("A", a.tip, b)
    m.revolute("B", b.tip, p)
    m.prismatic("guide", m.ground, p, axis=(1, 0))
    scene = Scene(m, {"O": polynomial(0.0, math.pi / 2)}, t=(0, 1, 3), posture={"b": 0.0})
    found, expected = statuses(scene, np.array([[1.0], [1.1], [0.9]]), EvaluationMethod(backend))
    assert found == expected == [Status.DEAD_CENTRE, Status.OK, Status.OUT_OF_REACH]


@both
def test_four_bars_of_every_kind(backend):
    """Crank-rockers, double rockers, change points and what cannot be closed."""
    scene = load_case(CASES / "four_bar").scene
    some = 6 if backend == "vm" else 60
    p = around(scene, some, spread=0.6, seed=4)
    found, expected = statuses(scene, p, EvaluationMethod(backend), (*scene.t[:2], 101))
    assert found == expected
    assert len(set(found)) > 1


@pytest.mark.sampled(2)
@pytest.mark.parametrize("backend", ["c", "vm"])
def test_iterated_loops_begin_from_the_guess_and_say_what_fails(backend):
    scene = truss_platform()
    p = np.array([[0.05], [0.06], [5.0], [0.04]])
    found, expected = statuses(scene, p, EvaluationMethod(backend))
    assert found == expected == [Status.OK, Status.OK, Status.NOT_CONVERGED, Status.OK]
    for step, status in ((1.0, Status.OK), (2.3, Status.JUMPED)):
        found, expected = statuses(double_crank(step), np.zeros((1, 0)), EvaluationMethod(backend))
        assert found == expected == [status]


@pytest.mark.parametrize("backend", ["lanes", pytest.param("vm", marks=pytest.mark.long)])
def test_what_does_not_fit_and_what_a_row_forbids(backend):
    m = Mechanism("bridge")
    a, b = m.link("a", length=1, mass=1), m.link("b", length=1, mass=1)
    m.weld("W1", m.ground, a)
    m.weld("W2", m.ground.at(1, 0), b)
    m.weld("W3", a.tip, b, angle=m.parameter("angle", 0.0, "rad"))
    found, expected = statuses(
        Scene(m, {}, ("motion",), t=(0, 1, 3)),
        np.array([[0.0], [math.pi], [0.1]]),
        EvaluationMethod(backend),
    )
    assert found == expected == [Status.OK, Status.MISFIT, Status.MISFIT]
    scene = declared(CASES / "sleigh")
    found, expected = statuses(
        scene, around(scene, 3, spread=0.3), EvaluationMethod(backend), (*scene.t[:2], 41)
    )
    assert found == expected
