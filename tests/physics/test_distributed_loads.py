"""Loads of any shape along links of any mass, and along parts of them: by the beams of the
textbooks; random ones are held against Newton and Euler elsewhere.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from every_way import plane
from exported import by_c99, compare, expected, exported, instants
from forging import edit
from internals import DesignEngine, EvaluationMethod, Status, certify

from lagrange_casadi import Mechanism, Scene, density, evaluate, load, motion, save
from lagrange_casadi.errors import StoreError

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]

LENGTH = 3.0


def supported(mass=0.0, **spread):
    """A beam at rest on a pin and on a roller, without gravity; at its base it stands on a
    carriage.
    """
    m = Mechanism("supported")
    m.set_gravity(0.0, 0.0)
    carriage, beam = m.point_mass("carriage", 1.0), m.link("beam", length=LENGTH, mass=mass)
    m.prismatic("rail", m.ground, carriage, axis=(1, 0))
    m.revolute("pin", carriage, beam)
    m.slot("roller", m.ground, beam.tip)
    m.line_load("q", beam, **spread)
    scene = Scene(
        m, {"rail": motion.polynomial(0.0)}, t=(0, 1, 3), xi=(0, 1, 61), posture={"beam": 0.0}
    )
    return evaluate(scene)


def looks_like(solution, shear, bending, size, link="beam"):
    """Its shear and bending moment over the ratio are these, to the rounding of a force of this
    size [N].
    """
    section, u = solution.section(link), solution.xi
    np.testing.assert_allclose(section.shear[0], shear(u), rtol=0, atol=1e-14 * size)
    np.testing.assert_allclose(section.bending[0], bending(u), rtol=0, atol=1e-14 * size * LENGTH)
    assert solution.certified


@pytest.mark.parametrize("mass", [0.0, 1e-9, 1e6])
def test_a_parabola_on_a_simple_beam(mass):
    """Of 4 q u (1 - u) downward: supports of q l/3, and 5 q l^2/48 at the middle; the moment
    stretches the lower side.
    """
    q, l = 12.0, LENGTH
    solution = supported(mass, y=lambda xi: -4 * q * xi / l * (1 - xi / l))
    assert solution.reaction("pin").fy[0] == pytest.approx(q * l / 3, rel=1e-14)
    assert solution.reaction("roller").fy[0] == pytest.approx(q * l / 3, rel=1e-14)
    looks_like(
        solution,
        lambda u: -q * l * (1 / 3 - 2 * u**2 + 4 * u**3 / 3),
        lambda u: q * l**2 * (u / 3 - 2 * u**3 / 3 + u**4 / 3),
        q * l,
    )
    peak = solution.peak("section:beam:bending")
    assert (peak.value, peak.xi) == (
        pytest.approx(5 * q * l**2 / 48, rel=1e-14),
        pytest.approx(0.5, abs=1e-9),
    )


def test_the_middle_third():
    """Of q on the middle third: supports of q l/6, and 5 q l^2/72 at the middle; straight before
    and after.
    """
    q, l = 7.0, LENGTH

    def shear(u):
        return -q * l * (1 / 6 - np.clip(u - 1 / 3, 0, 1 / 3))

    def bending(u):
        return (
            q
            * l**2
            * (u / 6 - np.maximum(u - 1 / 3, 0) ** 2 / 2 + np.maximum(u - 2 / 3, 0) ** 2 / 2)
        )

    solution = supported(y=-q, between=(l / 3, 2 * l / 3))
    looks_like(solution, shear, bending, q * l)
    assert solution.peak("section:beam:bending").value == pytest.approx(
        5 * q * l**2 / 72, rel=1e-14
    )
    assert abs(solution.peak("section:beam:shear").value) == pytest.approx(q * l / 6, rel=1e-14)


def test_a_load_that_changes_sign_turns_a_moment_twice():
    """From -q to q: q l^2/6 u (1 - u)(1 - 2u), whose summits of either sign are as large."""
    q, l = 9.0, LENGTH
    solution = supported(y=(-q, q))
    looks_like(
        solution,
        lambda u: -q * l * (1 / 6 - u + u**2),
        lambda u: q * l**2 * u * (1 - u) * (1 - 2 * u) / 6,
        q * l,
    )
    told = solution.statistics("section:beam:bending")
    for extreme, sign in ((told.largest, 1), (told.smallest, -1)):
        assert extreme.value == pytest.approx(sign * q * l**2 / (36 * math.sqrt(3)), rel=1e-14)
        assert extreme.xi == pytest.approx(0.5 - sign / (2 * math.sqrt(3)), abs=1e-9)
    shear = solution.statistics("section:beam:shear")
    assert (shear.largest.value, shear.smallest.value) == (
        pytest.approx(q * l / 12),
        pytest.approx(-q * l / 6),
    )


def test_loads_are_added_and_parts_of_one_are_the_whole():
    q, l, cut = 5.0, LENGTH, 1.1

    def cubic(xi):
        return q * (xi - 0.4) * (xi - 1.3) * (2.6 - xi)

    whole = supported(y=cubic, x=(1.0, -2.0))
    m = Mechanism("parts")
    m.set_gravity(0.0, 0.0)
    carriage, beam = m.point_mass("carriage", 1.0), m.link("beam", length=l, mass=0.0)
    m.prismatic("rail", m.ground, carriage, axis=(1, 0))
    m.revolute("pin", carriage, beam)
    m.slot("roller", m.ground, beam.tip)
    m.line_load("one", beam, y=cubic, between=(0.0, cut))
    m.line_load("other", beam, y=lambda xi: 2 * cubic(xi), between=(cut, l))
    m.line_load("less", beam, y=lambda xi: -cubic(xi), between=(cut, l))
    m.line_load("along", beam, x=lambda xi: 1 - xi)
    parts = evaluate(
        Scene(
            m, {"rail": motion.polynomial(0.0)}, t=(0, 1, 3), xi=(0, 1, 61), posture={"beam": 0.0}
        )
    )
    for force in ("axial", "shear", "bending"):
        one, other = (getattr(solution.section("beam"), force) for solution in (whole, parts))
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-14 * q * l**3)
        assert parts.peak(f"section:beam:{force}").value == pytest.approx(
            whole.peak(f"section:beam:{force}").value, rel=1e-12
        )


def test_a_short_load_is_a_force():
    """However short it is, it loses no digits; a millionth of the link carries as much as the force
    that it is.
    """
    force, end = 40.0, 1.0 + 1e-6 * LENGTH
    width = end - 1.0
    solution = supported(y=-force / width, between=(1.0, end))
    middle = (1.0 + width / 2) / LENGTH
    far = np.abs(solution.xi - middle) > 1e-3
    shear = -force * np.where(solution.xi < middle, 1 - middle, -middle)
    bending = (
        force
        * LENGTH
        * np.where(solution.xi < middle, (1 - middle) * solution.xi, middle * (1 - solution.xi))
    )
    np.testing.assert_allclose(
        solution.section("beam").shear[0][far], shear[far], rtol=0, atol=1e-14 * force
    )
    np.testing.assert_allclose(
        solution.section("beam").bending[0][far], bending[far], rtol=0, atol=1e-14 * force * LENGTH
    )


def gate():
    """A gate that stands in water up to a depth: rho g b (depth - xi), and nothing above it."""
    m = Mechanism("gate")
    depth = m.parameter("depth", 1.6, "m", low=0.1, high=2.4)
    leaf = m.link("leaf", length=2.5, mass=300.0)
    m.revolute("hinge", m.ground, leaf)
    m.line_load(
        "water",
        leaf,
        y=lambda xi: -1000 * 9.81 * 2.0 * (depth - xi),
        between=(0.0, depth),
        turning=True,
    )
    return Scene(m, {"hinge": motion.polynomial(math.pi / 2)}, t=(0, 1, 2), xi=(0, 1, 11))


def test_water_against_a_gate():
    """The hinge holds rho g b h^3/6, and a section at xi what is of that beyond it."""
    solution = evaluate(gate())
    w, h = 1000 * 9.81 * 2.0, 1.6
    assert solution.effort("hinge")[0] == pytest.approx(w * h**3 / 6, rel=1e-13)
    assert solution.reaction("hinge").fx[0] == pytest.approx(-w * h**2 / 2, rel=1e-13)
    left = np.maximum(h - solution.xi * 2.5, 0.0)
    np.testing.assert_allclose(
        solution.section("leaf").shear[0], -w * left**2 / 2, rtol=0, atol=1e-13 * w
    )
    np.testing.assert_allclose(
        solution.section("leaf").bending[0], -w * left**3 / 6, rtol=0, atol=1e-13 * w
    )
    assert solution.array("load:water:fx")[0] == pytest.approx(w * h**2 / 2, rel=1e-13)


def test_the_water_may_rise_from_design_to_design():
    for backend in ("vm", "lanes"):
        engine = DesignEngine.of(gate(), method=EvaluationMethod(backend))
        depths = np.array([0.1, 0.7, 1.6, 2.4])
        found = engine.evaluate(depths[:, None])
        names = [str(quantity) for quantity in engine.quantities]
        assert found.status.tolist() == [Status.OK] * 4
        bending = found.value[:, names.index("section:leaf:bending")]
        np.testing.assert_allclose(np.abs(bending), 1000 * 9.81 * 2.0 * depths**3 / 6, rtol=1e-12)


def test_a_table_over_a_cycle_has_them_and_exported_c_reads_it(tmp_path):
    m = Mechanism("turning")
    a = m.link("a", length=0.4, density=density.polynomial(1.0, 0.5))
    main = m.revolute("O", m.ground, a)
    m.line_load(
        "drag", a, y=lambda xi: -3.0 * xi**2 * m.rate(main), between=(0.1, 0.31), turning=True
    )
    scene = Scene(m, {"O": motion.polynomial(0.0, 3.0)}, t=(0.0, 2.0, 21))
    read, direct = evaluate(scene, table=64), evaluate(scene)
    for force in ("axial", "shear", "bending"):
        name, size = f"section:a:{force}", np.abs(direct.array(f"section:a:{force}")).max()
        assert np.abs(read.array(name) - direct.array(name)).max() <= min(
            read.errors[name] + 1e-12 * size, 1e-3 * size
        )
    made, told = exported(scene, tmp_path, table=64)
    compare(
        by_c99(tmp_path, told, instants(read.t, "double")),
        expected(scene, told, read),
        told,
        made,
        read,
    )


def test_a_file_without_a_part_of_a_load_is_not_whole(tmp_path):
    solution = evaluate(plane(), backend="vm")
    path = tmp_path / "part.h5"
    save(solution, path)
    for missing in ("section/rod/wind/width", "section/rocker/flow/qf1", "section/rocker/flow/qn0"):
        changed = tmp_path / "changed.h5"
        changed.write_bytes(path.read_bytes())
        edit(changed, lambda file, missing=missing: file.__delitem__(missing))
        with pytest.raises(
            StoreError, match=r"the load along the link '(wind|flow)' is incomplete"
        ):
            load(changed)


@pytest.mark.parametrize("member", ["wind:qf0", "flow:qf2", "wind:width", "flow:end"])
def test_the_certificate_sees_a_load_that_is_wrong(member):
    solution = evaluate(plane(), backend="vm")
    outputs = {
        o: values * (1.001 if str(o).endswith(member) else 1.0)
        for o, values in solution.outputs.items()
    }
    found = certify(replace(solution, outputs=outputs))
    assert found["ends"].max() > 1e-7
    assert solution.certificate["ends"].max() < 1e-14


def test_exported_c_tells_of_them(tmp_path):
    exported(plane(), tmp_path)
    header = (tmp_path / "together.h").read_text()
    said = (
        "link rocker, load flow, power 2: load along the link 90 deg counter-clockwise of the axis"
    )
    assert said in header
    assert "And then loads along the link; those beyond a section act on it" in header


@pytest.mark.sampled(2)
@pytest.mark.parametrize("mass", [0.0, 0.4])
def test_sweeps_in_single_precision_tell_peaks_where_a_force_is_the_same_all_along(mass):
    """Beyond its load a massless link has one shear: there rounding alone would say where its
    bending moment is steepest.
    """
    m = Mechanism("linkage")
    m.parameter("unused", 1.0)
    a, b, c = (
        m.link(n, length=l, mass=w)
        for n, l, w in (("a", 0.1, 0.3), ("b", 0.35, 0.5), ("c", 0.25, mass))
    )
    m.revolute("O", m.ground, a)
    m.revolute("A", a.tip, b)
    m.revolute("B", b.tip, c.tip)
    m.revolute("C", m.ground.at(0.3, 0.05), c)
    m.line_load(
        "flow",
        c,
        y=lambda xi: -30 + 50 * xi + 2000 * xi**2 - 6250 * xi**3,
        between=(0.0, 0.1),
        turning=True,
    )
    scene = Scene(
        m,
        {"O": motion.polynomial(0.2, 3.0, 4.0)},
        ["section:c"],
        posture={"c": 1.5},
        t=(0.1, 0.9, 81),
    )
    single, double = (
        DesignEngine.of(scene, method=EvaluationMethod("lanes", precision=p)).evaluate(
            np.ones((1, 1))
        )
        for p in ("single", "double")
    )
    assert single.status.tolist() == double.status.tolist() == [Status.OK]
    np.testing.assert_allclose(single.value, double.value, rtol=1e-5)


def test_a_body_that_has_no_sections_feels_it_too():
    """As a load on a link whose mass is the same: reactions and efforts are alike."""

    def scene(**matter):
        m = Mechanism("body")
        arm = m.link("arm", length=2.0, **matter)
        pin = m.revolute("wall", m.ground, arm)
        m.line_load("wind", arm, y=lambda xi: 3 * xi**2 - m.rate(pin) * xi, between=(0.3, 1.7))
        return Scene(m, {"wall": motion.polynomial(0.3, 2.0, -1.0)}, t=(0, 1, 5))

    one = evaluate(scene(mass=3.0))
    other = evaluate(scene(mass=3.0, centre=(1.0, 0.0), inertia=1.0))
    assert other.certified
    for name in (
        "effort:wall",
        "reaction:wall:fx",
        "reaction:wall:fy",
        "load:wind:fy",
        "load:wind:mz",
    ):
        np.testing.assert_allclose(other.array(name), one.array(name), rtol=0, atol=1e-12)


@pytest.mark.parametrize("side", ["tip", "base"])
@pytest.mark.parametrize("at", [0.0, 1.0])
def test_slopes_at_the_ends_of_a_link_are_those_within_it(at, side):
    """Nothing is beyond the tip or the base, where a load may begin and end."""
    m = Mechanism("blade")
    blade = m.link("blade", length=0.6, mass=1.2)
    m.revolute("pin", m.ground, blade)
    m.line_load("wind", blade, x=(-3.0, 5.0), y=lambda xi: 4.0 + 2.0 * xi**2, turning=True)
    solution = evaluate(
        Scene(m, {"pin": motion.polynomial(0.3, 2.0, 1.5)}, t=(0, 1, 4)), certificate=False
    )
    law, step = solution.section("blade").law, -1e-5 if at else 1e-5
    for force in ("axial", "shear", "bending"):
        values = [law.at(force, np.full((4, 1), at + k * step)) for k in range(5)]
        difference = (
            -25 * values[0] + 48 * values[1] - 36 * values[2] + 16 * values[3] - 3 * values[4]
        ) / (12 * step)
        slope = law.along(force, np.full((4, 1), at), side)
        # A moment at the tip is level: there a difference is the rounding of what it is made of.
        largest = np.abs(law.at(force, np.tile(np.linspace(0.0, 1.0, 9), (4, 1)))).max()
        rounding = 64 * np.finfo(float).eps * largest / abs(step)
        np.testing.assert_allclose(slope, difference, rtol=1e-7, atol=rounding)
