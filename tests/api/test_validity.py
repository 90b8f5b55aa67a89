"""What makes parts impossible: evaluations, sweeps on every backend and exported C draw the same
line.
"""

import numpy as np
import pytest
from internals import DesignEngine, EvaluationMethod, Status
from prepared import prepared

from lagrange_casadi import Mechanism, Scene, density, evaluate
from lagrange_casadi.errors import ParameterError
from lagrange_casadi.motion import polynomial


def arm(build, names, default=0.0):
    """A driven arm whose matter depends on parameters."""
    m = Mechanism("arm")
    symbols = [m.parameter(name, default) for name in names]
    m.revolute("O", m.ground, build(m, *symbols))
    return Scene(m, {"O": polynomial(0.0, 1.0)}, t=(0.0, 1.0, 3))


def rod(coefficients):
    return lambda m, c: m.link("arm", length=0.5, density=density.polynomial(*coefficients(c)))


MATTER = {
    "parabola": rod(lambda c: (1, -1, c)),
    "dips": rod(lambda c: (1, -c, c)),
    "cubic": rod(lambda c: (1, -c, 0, c)),
    "quartic": rod(lambda c: (1, -c, c, 0.5 * c, 0.1 * c)),
    "quintic": rod(lambda c: (0.1, 0, c, 0, -3 * c, 2.05 * c)),
    "line": rod(lambda c: (1, -c)),
    "uniform": lambda m, c: m.link("arm", length=0.5, mass=c),
    "length": lambda m, c: m.link("arm", length=c, density=density.polynomial(1.0, -0.5)),
    "plate": lambda m, c: m.link("arm", length=0.5, mass=1.0, centre=(0.1, 0.0), inertia=c),
    "overflow": lambda m, c: m.link("arm", length=0.5, density=density.polynomial(1.0, 1.0 / c)),
}
VALUES = [
    -30.0,
    -6.0,
    -1.0,
    -1e-3,
    0.0,
    1e-3,
    0.5,
    1.0,
    1.9,
    3.0,
    3.9,
    4.0,
    4.1,
    6.0,
    9.0,
    40.0,
    400.0,
]


def accepted(scene, values):
    found = []
    for c in values:
        try:
            scene.mechanism.values({"c": c})
        except ParameterError:
            found.append(False)
        else:
            found.append(True)
    return found


@pytest.mark.sampled(11)
@pytest.mark.parametrize("name", MATTER)
def test_all_programs_draw_the_same_line(name, tmp_path):
    scene = arm(MATTER[name], ["c"], default=0.25)
    expected = accepted(scene, VALUES)
    assert len(set(expected)) == 2
    assert prepared(scene, VALUES, tmp_path) == expected
    for backend in ("lanes", "c", "vm"):
        engine = DesignEngine.of(
            scene,
            ["effort", "section:arm"] if name != "plate" else ["effort"],
            method=EvaluationMethod(backend),
        )
        status = engine.evaluate(np.array(VALUES)[:, None]).status
        assert (status != Status.IMPOSSIBLE).tolist() == expected


def test_a_density_that_dips_below_zero_between_its_ends(tmp_path):
    """Positive at both ends, and where a sweep looked before; exported C took it."""
    scene = arm(rod(lambda c: (1, -c, c)), ["c"])
    assert prepared(scene, [0.0, 3.9, 6.0], tmp_path) == [True, True, False]
    with pytest.raises(
        ParameterError,
        match=r"link 'arm': density must not be negative, got -0\.5 kg/m at xi/l = 0\.5",
    ):
        evaluate(scene, parameters={"c": 6.0})
    narrow = arm(rod(lambda c: ((c - 0.03) ** 2 - 1e-5, -2 * (c - 0.03), 1.0)), ["c"], default=-1.0)
    engine = DesignEngine.of(narrow, ["effort"])
    assert engine.evaluate(np.array([[0.1], [-0.1]])).status.tolist() == [
        Status.IMPOSSIBLE,
        Status.OK,
    ]


@pytest.mark.parametrize("root", [1 / 3, 0.1, 0.7, 0.9])
def test_what_touches_zero_is_possible(root):
    """Rounding does not make it negative: neither of a square nor of a table that ends at zero."""
    scene = arm(rod(lambda c: (root * root * c, -2 * root * c, c)), ["c"], default=1.0)
    assert accepted(scene, [1.0, 7.0, 1e6, 0.3]) == [True] * 4
    for value in (1.0, 3.0, 0.1, 1 / 7):
        table = density.tabulated([0.0, root, 1.0], [2 * value, value, 0.0])
        arm(
            lambda m, c, table=table: m.link("arm", length=0.5, density=table), ["c"]
        ).mechanism.values()


def test_no_mass_at_all_is_impossible_everywhere(tmp_path):
    def build(m, a, b):
        link = m.link("arm", length=0.5, mass=a)
        m.weld("W", link.tip, m.point_mass("tip", b))
        return link

    scene = arm(build, ["a", "b"], default=1.0)
    rows = [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0], [-1.0, 1.0]]
    expected = [True, True, False, False]
    assert prepared(scene, rows, tmp_path) == expected
    assert (
        DesignEngine.of(scene).evaluate(np.array(rows)).status == Status.OK
    ).tolist() == expected
    with pytest.raises(
        ParameterError,
        match="mechanism 'arm' has neither mass nor load; give at least one link or point mass a"
        " mass",
    ):
        scene.mechanism.values({"a": 0.0, "b": 0.0})
    with pytest.raises(ParameterError, match="link 'arm': mass must not be negative, got -1 kg"):
        scene.mechanism.values({"a": -1.0, "b": 1.0})
    with pytest.raises(
        ParameterError, match="its whole mass must be finite and positive, got inf kg"
    ):
        scene.mechanism.values({"a": 1.5e308, "b": 1.5e308})
    with pytest.raises(ParameterError, match="mechanism 'empty' has neither mass nor load"):
        Mechanism("empty").values()


def test_what_bears_a_load_may_be_massless():
    """Forces are then those of statics: by virtual power, the drive gives what the load takes."""
    m = Mechanism("press")
    work = m.parameter("work", 80e3, "N")
    upper = m.link("upper", length=0.3, mass=0.0)
    lower = m.link("lower", length=0.3, mass=0.0)
    ram = m.point_mass("ram", 0.0)
    m.revolute("top", m.ground.at(0.0, 0.6), upper)
    m.revolute("knee", upper.tip, lower)
    m.revolute("elbow", lower.tip, ram)
    m.prismatic("way", m.ground, ram, axis=(0, -1))
    m.force("pressed", ram, y=work)
    scene = Scene(m, {"top": polynomial(-1.8, 0.2)}, posture={"lower": -1.3}, t=(0, 0.9, 7))
    solution = evaluate(scene)
    assert solution.certified
    taken = 80e3 * solution.motion("way").rate
    assert np.abs(0.2 * solution.effort("top") - taken).max() < 1e-12 * np.abs(taken).max()
    assert (
        DesignEngine.of(scene).evaluate(np.array([[80e3], [0.0]])).status.tolist()
        == [Status.OK] * 2
    )
