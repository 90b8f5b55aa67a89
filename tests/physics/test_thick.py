"""Links in space whose slices have rotary inertia: every way of evaluating, sweeps, exported C and
files.

Random ones are held against Newton and Euler on slices in the tests of mechanisms in space.
"""

import casadi as ca
import numpy as np
import pytest
from internals import SPACE

from lagrange_casadi import (
    Mechanism,
    Scene,
    SpatialMechanism,
    curve,
    density,
    evaluate,
    motion,
)
from lagrange_casadi.cli import main
from lagrange_casadi.errors import DeclarationError, MobilityError, ParameterError


def scene(**keywords):
    """A shaft whose slices change along it, with what acts at a station and along it, and a round
    bar that swings on it.
    """
    m = SpatialMechanism("thick")
    width, push = m.parameter("width", 0.1, "m", low=0.0), m.parameter("push", 5.0, "N")
    flat = density.thick(
        density.tabulated((0.0, 0.4, 1.0), (3.0, 2.0, 2.5)),
        yy=density.polynomial(2e-2, -1e-2, 2e-2),
        zz=density.tabulated((0.0, 0.7, 1.0), (4e-2, 1e-2, 3e-2)),
        yz=2e-3,
    )
    shaft = m.link("shaft", length=0.7, density=flat)
    bar = m.link(
        "bar",
        length=0.4,
        density=density.thick(
            density.polynomial(3.0), yy=3.0 * width**2 / 16, zz=3.0 * width**2 / 16
        ),
    )
    m.revolute("O", m.ground, shaft, axis=(0.9, 0.3, 0.2))
    m.universal("K", shaft.tip, bar, axis=(0.0, 0.3, 1.0), second=(0.1, 1.0, -0.3))
    m.force("pull", shaft.at(0.35, 0.03, -0.02), x=2.0, y=push, z=-3.0)
    m.line_load("wind", shaft, y=lambda xi: push * (1 - 2 * xi), z=2.0, between=(0.1, 0.6))
    inside = m.results.section(shaft, 0.3)
    m.output("inside", inside.torsion + 2 * inside.bending_y - inside.bending_z, unit="N m")
    laws = {
        "O": motion.harmonic(0.2, 1.4, 3.0),
        "K:turn_1": motion.harmonic(0.1, 0.8, 5.0),
        "K:turn_2": motion.harmonic(0.3, 0.4, 4.0),
    }
    return Scene(m, laws, **({"t": (0.0, 1.0, 5)} | keywords))


def slices_beyond(yy, zz, yz, rate, angular):
    """The couple that slices of these second moments need: I a + w x I w, on the link's axes."""
    inertia = np.array([[yy + zz, 0, 0], [0, zz, -yz], [0, -yz, yy]])
    return inertia @ angular + np.cross(rate, inertia @ rate)


def test_a_shaft_that_is_wound_up_and_one_that_tumbles():
    """Of a uniform bar about its axis torsion falls evenly to the tip, and its effort is J times
    its acceleration.
    """
    m, l, yy, zz, yz = SpatialMechanism("shaft"), 0.5, 0.03, 0.01, 0.004
    m.set_gravity(0.0, 0.0, 0.0)
    shaft = m.link(
        "shaft", length=l, density=density.thick(density.polynomial(2.0), yy=yy, zz=zz, yz=yz)
    )
    m.spherical("S", m.ground, shaft)
    laws = [
        motion.polynomial(0.0, 2.0, 1.5),
        motion.polynomial(0.0, -3.0),
        motion.polynomial(0.0, 1.0, -2.0),
    ]
    solution = evaluate(Scene(m, {"S": laws}, t=(0, 0.1, 2), xi=(0, 1, 9)), backend="vm")
    assert solution.certified
    # At zero the axes of the turns are the link's: w = (2, -3, 1); the later turns carry theirs on.
    rate, section = np.array([2.0, -3.0, 1.0]), solution.section("shaft")
    angular = np.array([3.0, 0.0, -4.0]) + np.array([2 * -3.0 * 0, 0, 0])
    angular = angular + np.array([-3.0 * 1.0, -2.0 * 1.0, 2.0 * -3.0]) * np.array([1, 1, 1])
    couple = slices_beyond(yy, zz, yz, rate, angular)
    u, x = solution.xi, solution.xi * l
    gamma = np.array(
        [
            -(rate[1] ** 2 + rate[2] ** 2),
            angular[2] + rate[0] * rate[1],
            rate[0] * rate[2] - angular[1],
        ]
    )
    first, second = 2.0 * (l**2 - x**2) / 2, 2.0 * ((l**3 - x**3) / 3 - x * (l**2 - x**2) / 2)
    told = {
        "axial": -gamma[0] * first,
        "shear_y": -gamma[1] * first,
        "shear_z": -gamma[2] * first,
        "torsion": -couple[0] * (l - x),
        "bending_y": gamma[2] * second - couple[1] * (l - x),
        "bending_z": -gamma[1] * second - couple[2] * (l - x),
    }
    for force, values in told.items():
        np.testing.assert_allclose(
            section.array(force)[0], values, rtol=0, atol=1e-13, err_msg=force
        )
    assert u.size == 9


@pytest.fixture(scope="module")
def plain():
    return evaluate(scene(), backend="vm")


def test_forces_along_the_link_change_as_they_say_and_peak_where_they_do(plain):
    law, step = plain.section("shaft").law, 1e-6
    for u in (0.05, 0.33, 0.62, 0.9):
        low, here, high = (np.full((5, 1), u + k * step) for k in (-1, 0, 1))
        for force in SPACE.forces:
            slope = (law.at(force, high) - law.at(force, low)) / (2 * step)
            np.testing.assert_allclose(
                law.along(force, here), slope, rtol=1e-5, atol=1e-5, err_msg=f"{force} at {u}"
            )
    fine = np.linspace(0, 1, 20001)
    for force in SPACE.forces:
        largest = np.abs(law.on_grid(force, fine)).max(axis=1)
        steepest = np.abs(law.along(force, np.tile(fine, (5, 1)))).max(axis=1)
        found = np.abs(law.extreme(force)[1])
        assert (found >= largest * (1 - 1e-12)).all(), force
        assert (found <= largest * (1 + 1e-9) + steepest * 5e-5).all(), force


def test_second_moments_are_told_in_any_way_of_densities():
    smooth = density.along(curve((0.0, 0.3, 0.7, 1.0), (1e-2, 2e-2, 1.5e-2, 1e-2)))
    one = density.thick(density.uniform(2.0), yy=smooth, zz=1e-2)
    yy, zz, yz = one.slices.whole(0.5)
    assert (float(zz), float(yz)) == (5e-3, 0.0)
    places = (np.arange(2000) + 0.5) / 2000
    assert float(yy) == pytest.approx(0.5 * np.mean(smooth.at(float, 1.0).at(places)), rel=1e-6)


@pytest.mark.parametrize(
    ("moments", "says"),
    [
        (
            {"yy": -1e-3, "zz": 1e-3},
            (
                "link 'a': impossible second moments of slices: yy, zz and yy zz - yz yz must not"
                " be negative"
            ),
        ),
        ({"yy": 1e-3, "zz": 1e-3, "yz": 2e-3}, "link 'a': impossible second moments of slices"),
        (
            {"yy": 1e-3, "zz": density.polynomial(1e-3, -3e-3)},
            "link 'a': impossible second moments of slices",
        ),
    ],
)
def test_slices_that_cannot_be_are_refused(moments, says):
    m = SpatialMechanism("m")
    m.revolute(
        "O",
        m.ground,
        m.link("a", length=0.5, density=density.thick(density.polynomial(1.0), **moments)),
    )
    with pytest.raises(ParameterError, match=says):
        evaluate(Scene(m, {"O": motion.polynomial(0.0, 1.0)}, t=(0, 1, 3)))


def test_what_has_no_slices_is_named():
    with pytest.raises(
        DeclarationError, match="link 'a': second moments of slices are for links in space"
    ):
        Mechanism("m").link(
            "a", length=0.5, density=density.thick(density.polynomial(1.0), yy=1e-3, zz=1e-3)
        )
    with pytest.raises(
        DeclarationError,
        match=r"density thick: expected a density of lagrange_casadi\.density, got 3\.0",
    ):
        density.thick(3.0, yy=1e-3, zz=1e-3)
    with pytest.raises(
        DeclarationError,
        match="density thick: second moments are numbers, or along the link by polynomial",
    ):
        density.thick(density.polynomial(1.0), yy=density.uniform(1e-3), zz=1e-3)


def test_a_thick_rod_between_two_spherical_joints_is_no_bar():
    m = SpatialMechanism("m")
    crank, slider = m.link("crank", length=0.1, mass=1.0), m.link("slider", length=0.1, mass=1.0)
    rod = m.link(
        "rod", length=0.3, density=density.thick(density.polynomial(1.0), yy=1e-4, zz=1e-4)
    )
    m.revolute("O", m.ground, crank, axis=(0, 1, 0))
    m.spherical("A", crank.tip, rod)
    m.spherical("B", rod.tip, slider)
    m.prismatic("G", m.ground.at(0, 0.05, 0), slider, axis=(1, 0, 0))
    posture = {"G": 0.35, "A:turn_1": 0.0, "A:turn_2": 0.0, "A:turn_3": 0.1}
    with pytest.raises(
        MobilityError,
        match="the spin of link 'rod' about the line from 'A' to 'B' is not determined",
    ):
        evaluate(Scene(m, {"O": motion.polynomial(0.0, 6.0)}, posture=posture))


def test_parameters_set_second_moments():
    m = SpatialMechanism("m")
    j = m.parameter("j", 1e-3, "kg m", low=0.0)
    m.set_gravity(0, 0, 0)
    m.revolute(
        "O",
        m.ground,
        m.link("a", length=0.5, density=density.thick(density.polynomial(1.0), yy=j, zz=2 * j)),
        axis=(1, 0, 0),
    )
    one = Scene(m, {"O": motion.polynomial(0.0, 0.0, ca.DM(2.0))}, t=(0, 1, 3), wanted=["effort"])
    for value in (1e-3, 0.5):
        found = evaluate(one, parameters={"j": value}, backend="vm").effort("O")
        np.testing.assert_allclose(found, 3 * value * 0.5 * 4.0, rtol=1e-14)


def test_info_names_thick_links(tmp_path, capsys):
    (tmp_path / "case.py").write_text(
        "from lagrange_casadi import Scene, SpatialMechanism, density\nfrom lagrange_casadi.motion"
        " import polynomial\n\n\ndef scene():\n    m = SpatialMechanism('m')\n    bar ="
        " m.link('bar', length=0.5, density=density.thick(density.polynomial(2.0), yy=1e-3,"
        " zz=1e-3))\n    m.revolute('O', m.ground, bar)\n    return Scene(m, {'O': polynomial(0.0,"
        " 1.0)}, t=(0, 1, 3))\n"
    )
    assert main(["info", str(tmp_path)]) == 0
    assert "  link of 0.5 m, bar: 1 kg, slices with rotary inertia\n" in capsys.readouterr().out
