"""Loads along links in space: every backend, sweeps and exported C; random ones are held against
Newton and Euler elsewhere.
"""

import math

import casadi as ca
import numpy as np
import pytest
from exported import by_c99, compare, expected, exported, instants, solve
from internals import SPACE, DesignEngine, EvaluationMethod, Status

from lagrange_casadi import Scene, SpatialMechanism, density, evaluate, load, motion, refine, save
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


def scene(**keywords):
    """Two links that swing about crossed axes, a tapered one with a load on a part of it, and one
    without mass.
    """
    m = SpatialMechanism("crane")
    gust, start = m.parameter("gust", 1.0), m.parameter("start", 0.1, "m", low=0.0, high=0.3)
    boom = m.link("boom", length=0.8, density=density.polynomial(3.0, -2.0))
    jib = m.link("jib", length=0.5, mass=0.0)
    slew = m.revolute("slew", m.ground, boom, axis=(0.2, -0.3, 0.9))
    m.revolute("luff", boom.tip, jib, axis=(0.1, 1.0, 0.3), turned=[("z", "35 deg")])
    m.weld("hook", jib.tip, m.point_mass("ball", 0.7))
    blow = gust * (1 + 0.3 * ca.sin(4 * m.time))
    m.line_load(
        "wind",
        boom,
        x=8 * blow,
        y=lambda xi: blow * (30 - 200 * xi**2),
        z=(-5.0, 12.0),
        between=(start, 0.7),
    )
    m.line_load("own", boom, z=lambda xi: m.rate(slew) * (3 - 8 * xi), turning=True)
    m.line_load(
        "flow", jib, y=lambda xi: 40 * xi * (0.5 - xi), z=-2.0, between=(0.0, 0.4), turning=True
    )
    m.force("pull", boom.at(0.45, 0.02, -0.03), x=3.0, y=-2.0, z=5.0)
    inside = m.results.section(boom, 0.3)
    m.output("moment", inside.bending_y + 2 * inside.bending_z, unit="N m")
    laws = {"slew": motion.harmonic(0.2, 0.9, 0.7), "luff": motion.harmonic(-0.4, 0.6, 1.1)}
    return Scene(m, laws, **({"t": (0.0, 1.0, 5)} | keywords))


@pytest.mark.long
def test_every_way_of_evaluating_agrees(tmp_path):
    expected_ = evaluate(scene(), backend="vm")
    assert expected_.certified
    assert max(values.max() for values in expected_.certificate.values()) < 1e-13
    for way in ({"backend": "c"}, {"backend": "lanes"}, {"precision": "single"}):
        found = evaluate(scene(), **way)
        assert found.certified
        for name in expected_.names():
            gap, size = (
                np.abs(found.array(name) - expected_.array(name)).max(),
                np.abs(expected_.array(name)).max(),
            )
            assert gap <= (1e-12 if "backend" in way else 1e-5) * max(size, 1.0), (way, name)
    law = expected_.section("boom").law
    moment = law.at("bending_y", np.full((5, 1), 0.3)) + 2 * law.at(
        "bending_z", np.full((5, 1), 0.3)
    )
    np.testing.assert_allclose(expected_.output("moment"), moment[:, 0], rtol=0, atol=1e-13)
    save(expected_, tmp_path / "crane.h5")
    for force in SPACE.forces:
        again = load(tmp_path / "crane.h5").section("boom")
        assert again.array(force).tolist() == expected_.section("boom").array(force).tolist()


@pytest.mark.sampled(2)
@pytest.mark.parametrize("precision", ["double", "single"])
def test_exported_c_has_the_numbers_of_the_api(precision, tmp_path):
    one = scene(t=(0.0, 1.0, 41))
    made, told = exported(one, tmp_path, precision=precision)
    solution = solve(one, precision)
    compare(
        by_c99(tmp_path, told, instants(solution.t, precision)),
        expected(one, told, solution),
        told,
        made,
        solution,
    )


@pytest.mark.long
def test_peaks_between_instants_and_of_sweeps():
    one, designs = scene(t=(0.0, 1.0, 81)), np.array([[1.0, 0.1], [-2.0, 0.0]])
    forces = [f"section:{link}:{force}" for link in ("boom", "jib") for force in SPACE.forces]
    engines = [
        DesignEngine.of(one, method=EvaluationMethod(backend)) for backend in ("vm", "lanes")
    ]
    swept = [engine.evaluate(designs) for engine in engines]
    assert [found.status.tolist() for found in swept] == [[Status.OK] * 2] * 2
    names = [str(quantity) for quantity in engines[0].quantities]
    for k, (gust, start) in enumerate(designs.tolist()):
        parameters = {"gust": gust, "start": start}
        fine = evaluate(one, parameters=parameters, t=(0.0, 1.0, 2001))
        for peak in refine(one, evaluate(one, parameters=parameters), forces):
            size = max(abs(peak.value), 1e-9)
            for found in swept:
                assert abs(found.value[k, names.index(peak.name)] - peak.value) <= 1e-9 * size, (
                    peak.name
                )
            assert abs(fine.peak(peak.name).value - peak.value) <= 1e-5 * size, peak.name


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
