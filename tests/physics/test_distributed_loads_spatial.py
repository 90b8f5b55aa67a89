"""Loads along links in space: every backend, sweeps and exported C; random ones are held against
Newton and Euler elsewhere.
"""

import math

import numpy as np
import pytest

from lagrange_casadi import Scene, SpatialMechanism, evaluate, motion
from lagrange_casadi.errors import DeclarationError

pytestmark = pytest.mark.quick


def test_a_mast_in_the_wind():
    """A cantilever under q u^2 along y and an even load along z: shear and bending of the
    textbooks, and their sizes.
    """
    m, l = SpatialMechanism("mast"), 4.0
    m.set_gravity(0.0, 0.0, 0.0)
    mast = m.link("mast", length=l, mass=0.0)
    m.weld("head", mast.tip, m.point_mass("lamp", 1.0))
    m.revolute("foot", m.ground, mast, axis=(0.0, 0.0, 1.0))
    m.line_load("wind", mast, y=lambda xi: 5.0 * (xi / l) ** 2, z=-3.0)
    m.line_load("rope", mast, x=2.0, between=(1.0, 3.0), turning=True)
    solution = evaluate(Scene(m, {"foot": motion.polynomial(0.0)}, t=(0, 1, 3), xi=(0, 1, 17)))
    assert solution.certified
    section, u = solution.section("mast"), solution.xi
    y, z = 5.0 * l * (1 - u**3) / 3, -3.0 * l * (1 - u)
    about_z, about_y = 5.0 * l**2 * (1 / 4 - u / 3 + u**4 / 12), 3.0 * l**2 * (1 - u) ** 2 / 2
    for force, told in {
        "axial": 2.0 * np.clip(3.0 - u * l, 0.0, 2.0),
        "shear_y": y,
        "shear_z": z,
        "torsion": 0.0 * u,
        "bending_y": about_y,
        "bending_z": about_z,
        "shear": np.hypot(y, z),
        "bending": np.hypot(about_y, about_z),
    }.items():
        np.testing.assert_allclose(section.array(force)[0], told, rtol=0, atol=2e-14, err_msg=force)
    assert solution.reaction("foot").mz is not None


def test_a_point_mass_bears_none():
    m = SpatialMechanism("bare")
    with pytest.raises(
        DeclarationError, match="load 'wind': expected a link for a line load, got 'ball'"
    ):
        m.line_load("wind", m.point_mass("ball", 1.0), z=1.0)


def test_a_bar_between_two_spherical_joints_may_be_loaded_across():
    m = SpatialMechanism("strut")
    crank = m.link("crank", between=((0, 0, 0), (0, 0.3, 0)), mass=1.0)
    strut = m.link("strut", between=((0, 0.3, 0), (1.2, 0.2, 0.4)), mass=2.0)
    slider = m.link("slider", between=((1.2, 0.2, 0.4), (1.3, 0.2, 0.4)), mass=1.0)
    m.revolute("O", m.ground, crank, at=(0, 0, 0), axis=(0, 0, 1))
    m.spherical("A", crank, strut, at=(0, 0.3, 0))
    m.spherical("B", strut, slider, at=(1.2, 0.2, 0.4))
    m.prismatic("G", m.ground, slider, at=(1.2, 0.2, 0.4), axis=(1, 0, 0))
    m.line_load("snow", strut, z=lambda xi: -20 * xi, between=(0.2, 0.9))
    solution = evaluate(Scene(m, {"O": motion.polynomial(0.0, 2.0)}, t=(0, 1, 11)))
    assert solution.certified
    middle = math.hypot(1.2, 0.1, 0.4) / 2
    assert solution.description["bars"] == ["strut"]
    assert solution.section("strut").law.distributed_loads[0].end[0] == pytest.approx(
        0.9 / (2 * middle)
    )
    np.testing.assert_allclose(solution.section("strut").bending[:, [0, -1]], 0.0, atol=1e-12)
