"""Cross-sections by finite elements of another package, against closed forms; skipped where it is
not installed.
"""

import sys

import pytest
import strong

from lagrange_casadi import beams, evaluate
from lagrange_casadi.errors import DeclarationError, LagrangeCasadiError

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]

CORNERS = [(0.0, 0.0), (0.05, 0.0), (0.05, 0.03), (0.0, 0.03)]


def test_a_rectangle_is_its_closed_form():
    pytest.importorskip("sectionproperties")
    found, exact = beams.analysed(beams.polygon(CORNERS)), beams.rectangle(0.05, 0.03).properties()
    properties = found.properties(space=True)
    for name in ("area", "iy", "iz", "wy", "wz"):
        assert getattr(properties, name) == pytest.approx(getattr(exact, name), rel=1e-9)
    assert properties.torsion == pytest.approx(exact.torsion, rel=1e-3)
    twist = max(abs(fibre.along_y[2]) + abs(fibre.along_z[2]) for fibre in exact.fibres)
    assert 1 / found.dimensions["torsion_modulus"] == pytest.approx(twist, rel=5e-3)
    assert 1 / found.dimensions["shear_y"] == pytest.approx(1.5 / exact.area, rel=0.02)


@pytest.mark.long
def test_an_angle_leans_as_its_polygon_does():
    pytest.importorskip("sectionproperties")
    angle = beams.polygon(
        [(0.0, 0.0), (0.05, 0.0), (0.05, 0.004), (0.004, 0.004), (0.004, 0.03), (0.0, 0.03)]
    )
    found, polygon = beams.analysed(angle).properties(space=True), angle.properties(space=True)
    for name in ("area", "iy", "iz", "iyz"):
        assert getattr(found, name) == pytest.approx(getattr(polygon, name), rel=1e-9)
    assert found.torsion == pytest.approx((0.05 + 0.03 - 0.004) * 0.004**3 / 3, rel=0.05)
    solution = evaluate(strong.robot(beams.analysed(angle)), certificate=False)
    assert solution.safety("upper").against("yield") > 0.0


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (
            lambda: beams.rectangle(0.05, 0.03),
            "expected a polygon whose corners are numbers, got a rectangle",
        ),
        (lambda: CORNERS, "expected a polygon, or a Section of sectionproperties"),
    ],
)
def test_what_cannot_be_analysed(make, told):
    with pytest.raises(DeclarationError, match=told):
        beams.analysed(make())


def test_what_lacks_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "sectionproperties.analysis.section", None)
    with pytest.raises(LagrangeCasadiError, match=r"pip install 'lagrange_casadi\[sections\]'"):
        beams.analysed(beams.polygon(CORNERS))
