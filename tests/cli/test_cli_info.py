"""The command ``info`` of a case: the whole scene in lines."""

import pytest
from internals import describe_coordinate

from lagrange_casadi.cli import main

pytestmark = pytest.mark.quick

EVERYTHING = """
import casadi as ca
from math import pi
from lagrange_casadi import Mechanism, Scene, motion

def scene():
    m = Mechanism("everything")
    k = m.parameter("k", 30.0, "N/m")
    crank, rod, block = m.link("crank", length=0.1, mass=1.0), m.link("rod", length=0.4, mass=1.0), m.point_mass("block", 2.0)
    pendulum = m.link("pendulum", length=0.3, mass=1.0)
    wheel = m.link("wheel", length=0.1, mass=1.0, centre=(0.0, 0.0), inertia=0.01)
    hub = m.link("hub", length=0.1, mass=0.1)
    O = m.revolute("O", m.ground, crank)
    m.revolute("A", crank.tip, rod)
    m.revolute("B", rod.tip, block)
    m.prismatic("guide", m.ground, block, axis=(1, 0))
    P = m.revolute("P", m.ground.at(1.0, 0.0), pendulum)
    way = m.prismatic("way", m.ground.at(0.0, 0.2), hub, axis=(0, 2), angle=pi / 2)
    turn = m.revolute("turn", hub, wheel)
    m.gear("mesh", O, P, ratio=-0.5)
    m.nonholonomic("rolling", m.velocity(hub)[1] + 0.1 * m.rate(turn), replaces=turn)
    m.force("push", block, x=-k * m.coordinate(O), y=2.5)
    m.force("wind", rod.at(0.2), x=1.0, turning=True)
    m.torque("brake", pendulum, -0.1 * m.rate(P), against=crank)
    m.spring("mount", m.ground.at(0.1, 0.3), rod.at(0.2), stiffness=k, length=0.25, damping=3.0)
    motions = {"O": motion.harmonic(0.5, 0.25, 2.0), "way": motion.samples([0, 0.2, 0.4, 0.7, 1], [0, 0.1, 0.2, 0.35, 0.5])}
    motions["turn"] = motion.samples([0, 0.2, 0.4, 0.7, 1], [0, -1, -2, -3.5, -5])
    return Scene(m, motions, wanted=["effort", "section"], t=(0, 1, 11), posture={"rod": -0.0}, assembly={"k": 20})
"""  # noqa: E501


def test_info_shows_the_whole_scene(here, capsys):
    (here / "everything.py").write_text(EVERYTHING)
    assert main(["info", "everything.py"]) == 0
    lines = capsys.readouterr().out.splitlines()
    for line in (
        "  prismatic joint guide: ground (0, 0) - block (0, 0), along (1, 0) of ground",
        (
            "  prismatic joint way: ground (0, 0.2) - hub (0, 0), along (0, 1) of ground, at 1.5708"
            " rad (90 deg), driven"
        ),
        "  gravity: (0, -9.81) m/s^2",
        "degrees of freedom: 3, driven at O, way, turn",
        "  drive way: a spline through 5 samples from 0 to 1 s; from 0 m to 0.5 m",
        "load push: force on block, x = (-(k*O)) N, y = 2.5 N, in ground axes",
        "load wind: force on rod, x = 1 N, y = 0 N, in the axes of rod",
        "load brake: torque on pendulum against crank, (-0.1*P_rate) N m",
        (
            "load mount: spring between ground and rod, stiffness k N/m, free length 0.25 m,"
            " damping 3 N s/m"
        ),
        "constraint mesh: 0 = (P-(-0.5*O))",
        (
            "non-holonomic constraint rolling: 0 = (hub_y_rate+(0.1*turn_rate)); it moves joint"
            " turn, without an effort"
        ),
        "posture: rod = 0 rad (0 deg)",
        "assembled first with: k = 20",
        "wanted: effort, section",
    ):
        assert line in lines, line
    assert next(line for line in lines if line.startswith("outputs:")).endswith(
        "all of a kind: reaction, multiplier, load, section, sensitivity"
    )


def test_long_expressions_are_cut(capsys):
    assert main(["info", "engine"]) == 0
    gas = next(
        line for line in capsys.readouterr().out.splitlines() if line.startswith("load gas:")
    )
    assert "... N, in ground axes" in gas
    assert len(gas) < 300


@pytest.mark.parametrize(
    ("kind", "value", "words"),
    [
        ("angle", -0.0, "x = 0 rad (0 deg)"),
        ("angle", -1.2e-16, "x = 0 rad (0 deg)"),
        ("angle", -0.5235987755982988, "x = -0.523599 rad (-30 deg)"),
        ("slide", -0.0, "x = 0 m"),
        ("slide", -3e-17, "x = 0 m"),
        ("slide", 2.5e-7, "x = 2.5e-07 m"),
    ],
)
def test_nobody_reads_minus_zero(kind, value, words):
    assert describe_coordinate("x", kind, value) == words


PLOTTER = """
from lagrange_casadi import Mechanism, Scene, motion

def scene():
    m = Mechanism("crane")
    speed = m.parameter("speed", 2.0, "Hz", low=0.01)
    arm, load = m.link("arm", length=1.0, mass=2.0), m.point_mass("load", 5.0)
    swing = m.revolute("swing", m.ground, arm)
    m.prismatic("reach", arm, load, axis=(1, 0))
    m.line_load("wind", arm, y=(0.0, -40.0))
    m.line_load("snow", arm, y=lambda xi: -40.0 * xi**2, between=(0.5, 1.0), turning=True)
    m.path("hook", load)
    m.output("power", m.results.effort(swing) * m.rate(swing), unit="W")
    line = {"hook": (motion.polynomial(0.8), motion.harmonic(0.1, 0.2, speed))}
    return Scene(m, line, t=(0, 1 / speed, 11), posture={"arm": 0.0, "reach": 0.9}, drives=["swing", "reach"])
"""  # noqa: E501


def test_motions_of_points_drives_elsewhere_and_own_outputs(tmp_path, capsys):
    """The bounds of time are expressions, and the motion is told over them."""
    case = tmp_path / "crane.py"
    case.write_text(PLOTTER)
    assert main(["info", str(case)]) == 0
    told = capsys.readouterr().out
    assert "degrees of freedom: 2, driven at swing, reach\n" in told
    assert "  motion hook.x: 0.8 of the time t; from 0.8 m to 0.8 m\n" in told
    assert "from 0.1 m to 0.1 m, within -0.1 m and 0.3 m\n" in told
    assert "load wind: line load on arm, x = 0 N/m, y = 0 to -40 N/m, in ground axes\n" in told
    snow = "x = 0 N/m, y = -10 to -40 N/m by a polynomial of degree 2, in the axes of arm"
    assert f"load snow: line load on arm between 0.5 and 1 m, {snow}\n" in told
    assert "output power [W]: (effort:swing*swing_rate)\n" in told
    assert "nan" not in told


IN_SPACE = """
from lagrange_casadi import Scene, SpatialMechanism, motion

def scene():
    m = SpatialMechanism("in_space")
    crank, rod, ram = (m.link(name, length=l, mass=1.0) for name, l in (("crank", 0.1), ("rod", 0.5), ("ram", 0.1)))
    m.revolute("O", m.ground.at(0, 0, 0.2), crank, axis=(0, 0, 1))
    m.spherical("A", crank.tip, rod)
    m.spherical("B", rod.tip, ram)
    m.screw("N", m.ground.at(0.4, 0.1, 0), ram, axis=(0.6, 0, 0.8), lead=0.3)
    m.torque("brake", ram, x=1.0, z=-2.0, turning=True)
    return Scene(m, {"O": motion.polynomial(0, 1)}, t=(0, 0.1, 3), posture={"N": 0.2})
"""  # noqa: E501


def test_info_says_how_joints_in_space_move(tmp_path, capsys):
    (tmp_path / "case.py").write_text(IN_SPACE)
    assert main(["info", str(tmp_path / "case.py")]) == 0
    told = capsys.readouterr().out
    assert (
        "  revolute joint O: ground (0, 0, 0.2) - crank (0, 0, 0), about (0, 0, 1) of ground,"
        " driven\n" in told
    )
    assert "  spherical joint A: crank (0.1, 0, 0) - rod (0, 0, 0)\n" in told
    assert (
        "  screw joint N: ground (0.4, 0.1, 0) - ram (0, 0, 0), about (0.6, 0, 0.8) of ground (0.3"
        " m a turn)\n" in told
    )
    assert "  two-force links, whose spin has no effect: rod\n" in told
    assert (
        "load brake: torque on ram against ground, x = 1 N m, y = 0 N m, z = -2 N m, in the axes of"
        " ram\n" in told
    )
