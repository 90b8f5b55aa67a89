"""Loads of any shape along links of any mass, and along parts of them: by the beams of the
textbooks, and by Newton and Euler.
"""

import math
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from balance import columns_at, oracle_of, postures
from exported import by_c99, compare, expected, exported, instants, solve
from forging import edit
from hypothesis import given, settings
from hypothesis import strategies as st
from internals import DesignEngine, EvaluationMethod, Status, certify
from spread import Spread

from lagrange_casadi import Mechanism, Scene, density, derive, evaluate, load, motion, refine, save
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


WIND = (20.0, 60.0)


def linkage(lift=(1.0, -2.0, 3.0), flow=(-30.0, 10.0, 80.0, -50.0), **keywords):
    """A crank-rocker with a tapered coupler and a massless rocker; what acts along them sees time,
    motion and parameters.
    """
    m = Mechanism("linkage")
    gust, start = m.parameter("gust", 1.0), m.parameter("start", 0.08, "m", low=0.0, high=0.2)
    a = m.link("a", length=0.1, mass=0.3)
    b = m.link("b", length=0.35, density=density.polynomial(2.0, -1.2))
    c = m.link("c", length=0.25, mass=0.0)
    m.revolute("O", m.ground, a)
    m.revolute("A", a.tip, b)
    m.revolute("B", b.tip, c.tip)
    rocker = m.revolute("C", m.ground.at(0.3, 0.05), c)
    blow = gust * (1 + 0.2 * ca.sin(5 * m.time))
    m.line_load("wind", b, x=tuple(blow * q for q in WIND), y=-8.0, between=(start, 0.3))
    m.line_load(
        "lift",
        b,
        y=lambda xi: m.rate(rocker) * (lift[0] + lift[1] * 10 * xi + lift[2] * 100 * xi**2),
        turning=True,
    )
    m.line_load(
        "flow",
        c,
        x=ca.cos(m.coordinate(rocker)),
        y=lambda xi: (
            sum(q * (5 * xi) ** k for k, q in enumerate(flow)) + 40 * m.velocity(c.tip)[0] * xi
        ),
        between=(0.0, 0.1),
        turning=True,
    )
    m.force("pull", b.at(0.2, 0.03), x=5.0, y=-9.0)
    inside, beyond = m.results.section(b, start / 0.25), m.results.section(c, 0.45)
    m.output("shear", inside.shear, unit="N")
    m.output("moment", inside.bending + beyond.bending, unit="N m")
    return Scene(
        m,
        {"O": motion.polynomial(0.2, 3.0, 4.0)},
        posture={"c": 1.5},
        **({"t": (0.1, 0.9, 5)} | keywords),
    )


def acting(t, lift, flow):
    """The same loads by the places of points, for the oracle."""

    def wind(_):
        blow = 1 + 0.2 * math.sin(5 * t)
        slope = (WIND[1] - WIND[0]) / (0.3 - 0.08)
        yield Spread("b", 0.08, 0.3, lambda x: (blow * (WIND[0] + slope * (x - 0.08)), -8.0))

    def lifting(place):
        angle, rate = place(("b", 0.0, 0.0))[2].v, place(("c", 0.0, 0.0))[2].d

        def at(x):
            value = rate * (lift[0] + lift[1] * 10 * x + lift[2] * 100 * x**2)
            return -math.sin(angle) * value, math.cos(angle) * value

        yield Spread("b", 0.0, 0.35, at)

    def flowing(place):
        angle, speed = place(("c", 0.0, 0.0))[2].v, place(("c", 0.25, 0.0))[0].d
        s, c = math.sin(angle), math.cos(angle)

        def at(x):
            value = sum(q * (5 * x) ** k for k, q in enumerate(flow)) + 40 * speed * x
            return c * c - s * value, s * c + c * value

        yield Spread("c", 0.0, 0.1, at)

    return [wind, lifting, flowing]


@settings(max_examples=8, deadline=None)
@given(
    st.tuples(*[st.floats(-50, 50)] * 3),
    st.tuples(*[st.floats(-100, 100)] * 4),
    st.sampled_from([0.1, 0.37, 0.9]),
)
def test_newton_and_euler_agree(lift, flow, t):
    scene = linkage(lift, flow)
    m, program, values = scene.mechanism, derive(scene), scene.mechanism.values()
    found, drives = columns_at(program, t, values)
    pull = [lambda _: [(("b", 0.2, 0.03), 5.0, -9.0, 0.0)]]
    oracle = oracle_of(m, values, loads=pull, spreads=acting(t, lift, flow))
    solved = oracle.solve(drives, postures(m, found, drives, 0.02))
    solution = evaluate(scene, t=(t, t, 1), backend="vm")
    assert solution.certified
    size = max(abs(x) for forces in solved.reactions.values() for x in forces)
    for link in "abc":
        for cut in (0.0, 0.1234567, 0.2285, 0.4, 0.5, 0.8176543, 0.9, 1.0):
            pairs = zip(("axial", "shear", "bending"), solved.sections[link](cut), strict=True)
            for force, value in pairs:
                # At the station of the force the oracle has the value on the tip's side too.
                assert (
                    abs(solution.section(link).law.at(force, np.array([[cut]]))[0, 0] - value)
                    <= 1e-12 * size
                ), (link, cut)
    assert abs(found["effort:O"] - solved.efforts["O"]) <= 1e-12 * size
    for joint, (fx, fy, _) in solved.reactions.items():
        assert (
            abs(found[f"reaction:{joint}:fx"] - fx) + abs(found[f"reaction:{joint}:fy"] - fy)
            <= 1e-12 * size
        )


def test_every_way_of_evaluating_agrees(tmp_path):
    scene = linkage()
    expected_ = evaluate(scene, backend="vm")
    assert expected_.certified
    for way in ({"backend": "c"}, {"backend": "lanes"}, {"precision": "single"}):
        found = evaluate(scene, **way)
        assert found.certified
        for name in expected_.names():
            gap, size = (
                np.abs(found.array(name) - expected_.array(name)).max(),
                np.abs(expected_.array(name)).max(),
            )
            assert gap <= (1e-12 if "backend" in way else 1e-4) * max(size, 1.0), (way, name)
            if name.startswith("section"):
                assert gap <= 2 * (found.errors[name] + expected_.errors[name]), (way, name)
    at = [[0.08 / 0.25]], [[0.45]]
    inside, beyond = (expected_.section(link).law for link in "bc")
    np.testing.assert_allclose(
        expected_.output("shear"), inside.at("shear", np.array(at[0]))[:, 0], rtol=0, atol=1e-12
    )
    moments = inside.at("bending", np.array(at[0])) + beyond.at("bending", np.array(at[1]))
    np.testing.assert_allclose(expected_.output("moment"), moments[:, 0], rtol=0, atol=1e-12)
    path = tmp_path / "linkage.h5"
    save(expected_, path)
    assert load(path).series.keys() == expected_.series.keys()
    assert load(path).section("b").bending.tolist() == expected_.section("b").bending.tolist()


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
    solution = evaluate(linkage(), backend="vm")
    path = tmp_path / "part.h5"
    save(solution, path)
    for missing in ("section/b/wind/width", "section/b/lift/qf1", "section/c/flow/qn0"):
        changed = tmp_path / "changed.h5"
        changed.write_bytes(path.read_bytes())
        edit(changed, lambda file, missing=missing: file.__delitem__(missing))
        with pytest.raises(
            StoreError, match=r"the load along the link '(wind|lift|flow)' is incomplete"
        ):
            load(changed)


@pytest.mark.parametrize("member", ["wind:qf0", "flow:qf2", "lift:width", "flow:end"])
def test_the_certificate_sees_a_load_that_is_wrong(member):
    solution = evaluate(linkage(), backend="vm")
    outputs = {
        o: values * (1.001 if str(o).endswith(member) else 1.0)
        for o, values in solution.outputs.items()
    }
    found = certify(replace(solution, outputs=outputs))
    assert found["ends"].max() > 1e-7
    assert solution.certificate["ends"].max() < 1e-14


@pytest.mark.sampled(2)
@pytest.mark.parametrize("precision", ["double", "single"])
def test_exported_c_has_the_numbers_of_the_api(precision, tmp_path):
    scene = linkage(t=(0.1, 0.9, 41))
    made, told = exported(scene, tmp_path, precision=precision)
    solution = solve(scene, precision)
    compare(
        by_c99(tmp_path, told, instants(solution.t, precision)),
        expected(scene, told, solution),
        told,
        made,
        solution,
    )


def test_exported_c_tells_of_them(tmp_path):
    exported(linkage(t=(0.1, 0.9, 41)), tmp_path)
    header = (tmp_path / "linkage.h").read_text()
    assert (
        "link b, load lift, power 2: load along the link 90 deg counter-clockwise of the axis"
        in header
    )
    assert "And then loads along the link; those beyond a section act on it" in header


@pytest.mark.long
def test_peaks_between_instants_and_of_sweeps():
    scene, designs = linkage(t=(0.1, 0.9, 81)), np.array([[1.0, 0.08], [2.5, 0.0], [-1.0, 0.15]])
    forces = [f"section:{link}:{force}" for link in "bc" for force in ("axial", "shear", "bending")]
    engines = [
        DesignEngine.of(scene, method=EvaluationMethod(backend)) for backend in ("vm", "lanes")
    ]
    swept = [engine.evaluate(designs) for engine in engines]
    assert [found.status.tolist() for found in swept] == [[Status.OK] * 3] * 2
    names = [str(quantity) for quantity in engines[0].quantities]
    for k, design in enumerate(designs):
        parameters = dict(zip(("gust", "start"), design.tolist(), strict=True))
        fine = evaluate(scene, parameters=parameters, t=(0.1, 0.9, 4001))
        for peak in refine(scene, evaluate(scene, parameters=parameters), forces):
            for found in swept:
                assert abs(found.value[k, names.index(peak.name)] - peak.value) <= 1e-9 * abs(
                    peak.value
                )
            assert fine.peak(peak.name).value == pytest.approx(peak.value, rel=1e-5)
            assert abs(peak.value) >= np.abs(fine.array(peak.name)).max() * (1 - 1e-12)


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

    one, other = (
        evaluate(scene(mass=3.0)),
        evaluate(scene(mass=3.0, centre=(1.0, 0.0), inertia=1.0)),
    )
    assert other.certified
    for name in (
        "effort:wall",
        "reaction:wall:fx",
        "reaction:wall:fy",
        "load:wind:fy",
        "load:wind:mz",
    ):
        np.testing.assert_allclose(other.array(name), one.array(name), rtol=0, atol=1e-12)
