"""No result leaves unchecked: neither a closed form that nobody verified and that does not close
its loop, nor an output that is not finite.
"""

import numpy as np
import pytest
from compiled import EVALUATED, PREPARED, told
from internals import DesignEngine, EvaluationMethod, Status, blocks, loops, run
from mechanisms import pins_of

from lagrange_casadi import Mechanism, Scene, derive, evaluate, export
from lagrange_casadi.errors import AssemblyError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("interpreted")


def mistaken(monkeypatch):
    """A scene whose equations are taken for two circles, as a pattern that nobody verified: so they
    are where both are of the tip, as by default.
    """
    monkeypatch.setattr(loops, "_turns", lambda *_: True)
    monkeypatch.setattr(blocks, "solves", lambda *_: True)
    m = Mechanism("mistaken")
    a, b = m.link("a", length=0.6, mass=1.0), m.link("b", length=0.5, mass=1.2)
    pins_of(m, A=(m.ground, a), B=(a.tip, b))
    m.prismatic(
        "S", m.ground.at(0, -1), m.point_mass("s", m.parameter("mass", 1.0, "kg")), axis=(1, 0)
    )
    m.constraint("middle", m.place(b.at(m.parameter("station", 0.5, "m")))[0] - 0.7)
    m.constraint("height", m.place(b.tip)[1] - 0.471)
    return Scene(m, {"S": polynomial(0.0, 0.1)}, t=(0, 1, 41), posture={"a": 0.9, "b": -0.1})


@pytest.mark.sampled(5)
@pytest.mark.parametrize(
    "method",
    [
        EvaluationMethod("c"),
        EvaluationMethod("lanes"),
        EvaluationMethod("lanes", precision="single"),
    ],
)
def test_what_does_not_close_a_loop_is_refused(method, monkeypatch, fresh_cache):
    """By every backend, also where only the effort is wanted, and in sweeps."""
    scene = mistaken(monkeypatch)
    compiled = {"backend": method.backend, "precision": method.precision}
    for wanted, way in (("all", compiled), ("effort", compiled), ("all", {"backend": "vm"})):
        with pytest.raises(
            AssemblyError,
            match=r"of the loop closed by constraint 'height' does not close it at t = 0 s",
        ):
            evaluate(scene, wanted=[wanted], parameters={"station": 0.25}, **way)
    designs = DesignEngine.of(scene, ["effort"], method=method)
    outcome = designs.evaluate(np.array([[1.0, 0.25], [1.0, 0.5]]))
    assert outcome.status.tolist() == [Status.NOT_CLOSED, Status.OK]
    assert (np.isnan(outcome.value).all(axis=1) == [True, False]).all()


def test_exported_c_refuses_what_does_not_close_a_loop(monkeypatch, fresh_cache, tmp_path):
    folder = tmp_path / "c"
    made = export(mistaken(monkeypatch), folder)
    ((_, _, words),) = told(folder, made, "parameters.station = 0.25; " + PREPARED + EVALUATED)
    assert words == "the solution of a loop does not satisfy its equations"


@pytest.mark.parametrize("backend", ["vm", "c", "lanes"])
@pytest.mark.parametrize("many", [11, 67])
def test_whichever_output_is_not_finite_is_seen(backend, many):
    """Output k has no number at instant k, which stands in any place of a pack or beyond the last
    one.
    """
    m = Mechanism("poles")
    joint = m.revolute("O", m.ground, m.link("crank", length=0.1, mass=1.0))
    for k in range(11):
        m.output(f"x{k}", 1.0 / (m.coordinate(joint) - k), unit="")
    times = (0.0, many - 1.0, many)
    program = derive(Scene(m, {"O": polynomial(0.0, 1.0)}, t=times))
    t = np.linspace(*times)
    evaluated, _ = run(program, t, np.zeros(0), EvaluationMethod(backend))
    expected = np.where(t < 11, Status.NOT_FINITE, Status.OK)
    assert evaluated.status.tolist() == expected.tolist()
