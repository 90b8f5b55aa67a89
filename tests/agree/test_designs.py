"""Many designs at once: each against its own evaluation and refined peaks, on every rung, whatever
the neighbours.
"""

import numpy as np
import pytest
from design_rows import around
from internals import (
    DesignEngine,
    EvaluationMethod,
    library,
)
from mechanisms import four_bar, slider_crank
from stepped import iterated

from lagrange_casadi import Mechanism, Scene, evaluate, load_case, motion
from lagrange_casadi.errors import DeclarationError

FIELDS = ("status", "value", "t", "xi", "mean", "rms")


@pytest.mark.sampled(11)
@pytest.mark.parametrize(
    "method",
    [EvaluationMethod("lanes"), EvaluationMethod("c"), EvaluationMethod("lanes", "single")],
    ids=lambda method: method.options,
)
@pytest.mark.parametrize("made", [slider_crank, lambda: load_case("four_bar").scene, iterated])
def test_a_row_has_the_same_bytes_whatever_stands_beside_it(made, method, monkeypatch):
    scene = made()
    designs = DesignEngine.of(scene, t=(*scene.t[:2], 61), method=method)
    p = around(scene, 40, spread=0.7)
    whole = designs.evaluate(p, threads=1, histories=True)
    assert len(set(whole.status.tolist())) > 1
    for fresh in (designs, DesignEngine.of(scene, t=(*scene.t[:2], 61), method=method)):
        order = np.random.default_rng(1).permutation(40)
        other = fresh.evaluate(p[order], histories=True)
        assert all(
            getattr(other, f).tobytes() == getattr(whole, f)[order].tobytes()
            for f in (*FIELDS, "series")
        )
    monkeypatch.setattr(library, "_WORTH_A_THREAD", 0)
    monkeypatch.setattr(library, "_LONGEST", 3)
    cut = DesignEngine.of(scene, t=(*scene.t[:2], 61), method=method)
    assert cut.library.share(61) == 1
    for threads in (1, 2, 3, 7):
        other = cut.evaluate(p, threads=threads)
        assert all(getattr(other, f).tobytes() == getattr(whole, f).tobytes() for f in FIELDS)


def test_a_speed_that_is_a_parameter_keeps_its_phase():
    """Where parameters set how far a drive turns, its turns are counted in pairs, whatever the
    defaults.
    """
    m = Mechanism("fast")
    speed = m.parameter("speed", 1.0, "rad/s")
    m.revolute("pin", m.ground, m.link("arm", length=0.5, mass=1.2))
    scene = Scene(m, {"pin": motion.expression(lambda t: speed * t)}, t=(1.0, 1.0 + 1e-7, 41))
    designs = DesignEngine.of(scene, method=EvaluationMethod("c"))
    p = np.array([[1.0], [1e8]])
    outcome = designs.evaluate(p, histories=True)
    k = designs.columns.index("effort:pin")
    for row in range(2):
        solution = evaluate(scene, parameters={"speed": p[row, 0]}, backend="c", certificate=False)
        np.testing.assert_allclose(
            outcome.series[row, k], solution.effort("pin"), rtol=0, atol=1e-14 * 3
        )


def test_misuse_is_named():
    scene = four_bar()
    with pytest.raises(DeclarationError, match=r"expected an array of shape \(n, 0\), got \(3,\)"):
        DesignEngine.of(scene).evaluate(np.zeros(3))
    empty = DesignEngine.of(scene).evaluate(np.zeros((0, 0)))
    assert empty.value.shape == (0, len(DesignEngine.of(scene).quantities))
