"""The command ``info`` of cases in space: joints with their axes, drives elsewhere, loops, bars and
the posture of reference.
"""

import pytest

from lagrange_casadi.cli import main

pytestmark = pytest.mark.quick

TOLD = {
    "rssr": (
        """
  revolute joint Q: ground (0.3, -0.1, 0.2) - rocker (0, 0, 0)
    , about (0.48, 0.8, 0.36) of ground
  spherical joint B: coupler (0.4, 0, 0) - rocker (0.25, 0, 0)
  gravity: (0, -9.81, 0) m/s^2
  two-force links, whose spin has no effect: coupler
load brake: torque on rocker against ground
    , x = (-(0.48*brake)) N m, y = (-(0.8*brake)) N m, z = (-(0.36*brake)) N m, in ground axes
"""
    ),
    "stewart_gough": (
        """
  universal joint U1: ground (-0.1545, 0.4755, 0) - cylinder1 (0, 0, 0)
    , turn_1 about (1, 0, 0) of ground, turn_2 about (0, 1, 0)
  prismatic joint P0: cylinder0 (0, 0, 0) - piston0 (0, 0, 0), along (1, 0, 0) of cylinder0, driven
  spherical joint S5: piston5 (0.45, 0, 0) - platform (0.2007, -0.2229, 0)
    , closes a loop: its angles are not evaluated
degrees of freedom: 6, driven at P0, P1, P2, P3, P4, P5
"""
    ),
    "delta": (
        """
  free joint tool: ground (0, 0, 0) - platform (0, 0, 0)
    , slide_1 along (1, 0, 0) of ground, motion given
    , slide_2 along (0, 1, 0), motion given
    , slide_3 along (0, 0, 1), motion given
    , turn_1 about (1, 0, 0), turn_2 about (0, 1, 0), turn_3 about (0, 0, 1)
  two-force links, whose spin has no effect: left0, right0, left1, right1, left2, right2
"""
    ),
    "five_link_suspension": (
        """
  free joint wheel: ground (0, 0.7, 0.3) - hub (0.1, 0, 0)
    , slide_1 along (1, 0, 0) of ground, slide_2 along (0, 1, 0), slide_3 along (0, 0, 1), driven
    , turn_1 about (1, 0, 0), turn_2 about (0, 1, 0), turn_3 about (0, 0, 1)
  two-force links, whose spin has no effect: upper_front, upper_rear, lower_front, lower_rear, toe
posture: the reference posture, in which the parts are declared
"""
    ),
    "cardan_shaft": (
        """
  cylindrical joint far: ground (0.6, 0.15, 0) - output (0, 0, 0)
    , slide along (1, 0, 0) of ground, turn about (1, 0, 0)
posture: first:turn_1 = 0.3 rad (17.1887 deg), first:turn_2 = 0 rad (0 deg)
    , far:turn = 0 rad (0 deg), far:slide = 0 m
"""
    ),
    "arm6": (
        """
  weld joint grip: link6 (0.08, 0, 0) - tool (0, 0, 0)
posture: none
"""
    ),
}
"""Lines of what is told of cases; one that goes on is indented and begins with a comma."""


def told(capsys, case):
    assert main(["info", str(case)]) == 0
    return capsys.readouterr().out.splitlines()


def lines_of(text):
    return text.replace("\n    ,", ",").strip("\n").split("\n")


@pytest.mark.sampled(3)
@pytest.mark.parametrize("case", TOLD)
def test_info_tells_what_is_in_space(capsys, case):
    found = told(capsys, case)
    for line in lines_of(TOLD[case]):
        assert line in found, line
    bars = [line for line in found if line.startswith("  bars")]
    assert len(bars) == TOLD[case].count("bars")


PARTLY = """
from lagrange_casadi import Scene, SpatialMechanism, motion

def scene():
    m = SpatialMechanism("partly")
    lever = m.link("lever", between=((0, 0, 0), (0.3, 0, 0)), mass=1.0)
    rest = m.link("rest", length=0.2, mass=1.0)
    m.revolute("hinge", m.ground, lever, axis=(0, 1, 0), at=(0, 0, 0))
    m.cylindrical("slip", lever.tip, rest, axis=(0, 0, 1))
    laws = {"hinge": motion.polynomial(0.1, 1.0), "slip:slide": motion.polynomial(0.2), "slip:turn": motion.polynomial(0.0, 2.0)}
    return Scene(m, laws, t=(0, 0.1, 3), posture=POSTURE, drives=["hinge", "slip:slide", "slip:turn"])
"""  # noqa: E501


@pytest.mark.parametrize(
    ("posture", "line"),
    [
        (
            {"slip:slide": 0.25},
            (
                "posture: slip:slide = 0.25 m, else the reference posture, in which the parts are"
                " declared"
            ),
        ),
        ({"hinge": 0.1}, "posture: hinge = 0.1 rad (5.72958 deg)"),
    ],
)
def test_a_posture_that_is_told_in_part(tmp_path, capsys, posture, line):
    (tmp_path / "case.py").write_text(PARTLY.replace("POSTURE", repr(posture)))
    found = told(capsys, tmp_path / "case.py")
    slip = """
  cylindrical joint slip: lever (0.3, 0, 0) - rest (0, 0, 0)
    , slide along (0, 0, 1) of lever, driven, motion given
    , turn about (0, 0, 1), driven, motion given
"""
    for one in (line, *lines_of(slip)):
        assert one in found, one
