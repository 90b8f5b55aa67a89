"""Redundant trusses of textbooks: their published forces, by least strain energy."""

import itertools
import math

import numpy as np
import pytest
from elastic_mechanisms import LIGHT, made

from lagrange_casadi import Mechanism, Scene, beams, evaluate

pytestmark = pytest.mark.usefixtures("interpreted")


def panel(width, height, load):
    """A, D below and B, C above, all six joined by bars alike; a pin at A, a roller at D, a load at
    C to the right.
    """
    places = {"A": (0.0, 0.0), "B": (0.0, height), "C": (width, height), "D": (width, 0.0)}
    m = Mechanism("panel")
    m.set_gravity(0.0, 0.0)
    nodes = {name: m.point_mass(name, 0.0) for name in "BCD"}
    m.prismatic("roller", m.ground, nodes["D"], axis=(1, 0))
    posture = {"roller": width}
    for first, last in itertools.combinations("ABCD", 2):
        (x, y), (u, v) = places[first], places[last]
        bar = m.link(
            first + last, length=math.hypot(u - x, v - y), beam=made(beams.round_bar(0.02), LIGHT)
        )
        m.revolute(f"{first}{last}_at_{first}", nodes.get(first, m.ground), bar)
        m.revolute(f"{first}{last}_at_{last}", bar.tip, nodes[last])
        posture[first + last] = math.atan2(v - y, u - x)
    m.force("load", nodes["C"], x=load)
    return Scene(m, {}, t=(0, 0, 1), xi=(0, 1, 3), posture=posture, elastic=True)


@pytest.mark.parametrize(
    ("width", "height", "load", "printed", "known"),
    [
        # Hibbeler, Structural Analysis, 8th edition, example 10.7: 324 lb in the diagonal AC of a
        # panel of 8 ft by 6 ft.
        pytest.param(8.0, 6.0, 400.0, 0.5, {"AC": 324.0}, id="Hibbeler"),
        # "Statically Indeterminant Truss", studylib.net/doc/10653767, by least work: -0.56 P in the
        # diagonal BD of a square.
        pytest.param(1.0, 1.0, 1.0, 0.005, {"BD": -0.56}, id="square"),
    ],
)
def test_a_panel_with_both_diagonals(width, height, load, printed, known):
    solution = evaluate(panel(width, height, load))
    assert not solution.undetermined
    assert solution.certified
    found = {
        name: solution.section(name).axial[0, 0] for name in ("AB", "BC", "CD", "AD", "AC", "BD")
    }
    for name, force in known.items():
        assert found[name] == pytest.approx(force, abs=printed)
    # By hand: a unit in a diagonal is -width/diagonal in what lies, -height/diagonal in what
    # stands.
    diagonal = math.hypot(width, height)
    unit = {
        "AB": -height,
        "CD": -height,
        "BC": -width,
        "AD": -width,
        "AC": diagonal,
        "BD": diagonal,
    }
    without = {
        "AB": 0.0,
        "BC": 0.0,
        "AD": 0.0,
        "CD": -load * height / width,
        "AC": load * diagonal / width,
        "BD": 0.0,
    }
    length = {"AB": height, "CD": height, "BC": width, "AD": width, "AC": diagonal, "BD": diagonal}
    n = np.array([[unit[k] / diagonal, without[k], length[k]] for k in found]).T
    redundant = -np.sum(n[0] * n[1] * n[2]) / np.sum(n[0] ** 2 * n[2])
    np.testing.assert_allclose(list(found.values()), n[1] + redundant * n[0], atol=1e-7 * load)
