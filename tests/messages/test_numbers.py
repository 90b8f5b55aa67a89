"""Numbers and texts with units, wherever a declaration takes a number: a text is the number that it
tells, and what is none, or of another unit, is refused.
"""

import dataclasses
import math
from collections.abc import Mapping
from decimal import Decimal

import casadi as ca
import numpy as np
import pytest
from mechanisms import four_bar, links_of

from lagrange_casadi import (
    Mechanism,
    Scene,
    SpatialMechanism,
    actuators,
    beams,
    bearings,
    best,
    density,
    elements,
    evaluate,
    forward,
    optimise,
    prepare,
    read_designs,
    strength,
    sweep,
)
from lagrange_casadi.errors import DeclarationError, LagrangeCasadiError
from lagrange_casadi.motion import dwell, harmonic, move, moves, polynomial, samples

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]

STEEL = beams.material("C45+QT")
WORDS = {
    "m": ("mm", 3),
    "kg": ("g", 3),
    "s": ("ms", 3),
    "rad": ("rad", 0),
    "m/s": ("mm/s", 3),
    "m/s^2": ("cm/s²", 2),
    "rad/s": ("mrad/s", 3),
    "1/s": ("kHz", -3),
    "kg m^2": ("kg cm^2", 4),
    "kg/m": ("t/m", -3),
    "kg/m^2": ("g/cm2", -1),
    "kg/m^3": ("kg/l", -3),
    "N": ("kN", -3),
    "N/m": ("N/mm", -3),
    "N m": ("Nmm", 3),
    "N m/rad": ("kN m/rad", -3),
    "N s/m": ("N·s/mm", -3),
    "N m s/rad": ("N*cm*s/rad", 2),
    "Pa": ("N/mm^2", -6),
    "W": ("kW", -3),
}


def as_number(value, _unit):
    return value


def as_text(value, unit):
    """The same in another word for its unit."""
    word, places = WORDS[unit]
    return f"{Decimal(repr(value)).scaleb(places)} {word}"


def written(thing):
    """All that a part is declared by."""
    if dataclasses.is_dataclass(thing):
        return {one.name: written(getattr(thing, one.name)) for one in dataclasses.fields(thing)}
    if isinstance(thing, Mapping):
        return {name: written(one) for name, one in thing.items()}
    return [written(one) for one in thing] if isinstance(thing, list | tuple) else str(thing)


def parts_of(m):
    return [written(parts) for parts in (m.bodies, m.joints, m.loads, m.constraints)]


def wheels(u):
    m = SpatialMechanism("wheels")
    sizes = {"radius": u(0.03, "m"), "bore": u(0.01, "m"), "width": u(0.02, "m")}
    pair = [elements.wheel(m, name, **sizes, turned=u(0.1, "rad")) for name in "ab"]
    for wheel, x in zip(pair, (0.0, 0.06), strict=True):
        m.revolute(f"J{wheel.name}", m.ground.at(x, 0, 0), wheel)
    radii = (u(0.03, "m"), u(0.03, "m"))
    slant = {"helix_angle": u(0.2, "rad"), "offset": u(0.001, "m")}
    elements.gears(m, "mesh", *pair, radii=radii, **slant)
    m.screw("way", m.ground, m.link("nut", length=0.1, mass=1.0), axis=(1, 0, 0),
            lead=u(0.004, "m"), turned=[("z", u(0.2, "rad"))])  # fmt: skip
    return parts_of(m)


def shapes(u):
    m = Mechanism("shapes")
    corners = [[u(x, "m") for x in pair] for pair in ((0.0, 0.0), (0.2, 0.0), (0.2, 0.1))]
    bar = elements.bent_bar(m, "bar", corners, mass=u(0.7, "kg"))
    plate = elements.plate(m, "plate", corners, mass=u(0.6, "kg"))
    joint = m.revolute("O", m.ground, bar.pieces[0])
    m.weld("W", bar.pieces[-1].tip, plate.link, angle=u(0.3, "rad"))
    ram = elements.cylinder(m, "ram", m.ground.at(0.5, -0.5), bar.pieces[0], closed=u(0.4, "m"),
                            open=u(0.7, "m"), bore=u(0.05, "m"), rod=u(0.03, "m"),
                            barrel_mass=u(2.5, "kg"), rod_mass=u(1.5, "kg"))  # fmt: skip
    elements.gas_spring(m, "gas", m.ground, bar.pieces[0].tip, closed=u(0.2, "m"), open=u(0.3, "m"),
                        force=(u(200.0, "N"), u(300.0, "N")), damping=u(5.0, "N s/m"),
                        end_damping=u(10.0, "N s/m"), end=u(0.02, "m"))  # fmt: skip
    pin = bearings.Pin(u(0.01, "m"), u(0.02, "m"), u(0.01, "m"), STEEL, gap=u(0.001, "m"))
    plain = bearings.Plain(u(0.01, "m"), u(0.02, "m"), pressure=1e7, speed=u(1.5, "m/s"))
    bearings.fit(m, joint, pin, plain)
    return [parts_of(m), ram.cap_area, ram.rod_area]


def cams(u):
    m = Mechanism("cam")
    disc, stem = m.link("disc", length=0.03, mass=0.6), m.link("stem", length=0.1, mass=0.2)
    main = m.revolute("main", m.ground, disc)
    guide = m.prismatic("guide", m.ground, stem, axis=(0, 1), angle=u(1.5, "rad"))
    up, down = move(by=u(0.01, "m"), time=u(0.2, "s")), move(to=u(0.0, "m"), time=u(0.2, "s"))
    law = moves([up, dwell(u(0.1, "s")), down], start=u(0.0, "m"))
    sizes = {"base_radius": u(0.03, "m"), "roller": u(0.008, "m"), "width": u(0.01, "m")}
    cam = elements.disc_cam(m, "cam", main, guide, lambda a: 5e-3 * (1 - ca.cos(a)), **sizes)
    return [parts_of(m), cam.profile().x.tolist(), str(law.span), str(law.period)]


def loaded(u):
    m = SpatialMechanism("loaded")
    arm = m.link("arm", length=u(0.3, "m"), mass=1.0)
    pin = m.revolute("O", m.ground, arm)
    way = m.prismatic("S", arm, m.link("slide", length=0.1, mass=u(0.5, "kg")), axis=(1, 0, 0))
    around = {"radius": u(0.01, "m"), "length": u(0.05, "m")}
    m.friction("pin", pin, mu=0.1, **around, smooth=u(0.2, "rad/s"))
    m.friction("way", way, mu=0.1, **around, static=0.2, stribeck=u(0.03, "m/s"))
    places = m.ground.at(u(0.1, "m"), 0, 0), arm.at(u(0.15, "m"))
    m.spring("back", *places, stiffness=100.0, length=u(0.05, "m"))
    m.line_load("wind", arm, y=10.0, between=(u(0.1, "m"), u(0.2, "m")))
    return parts_of(m)


def notched(u):
    flat, walls = (u(0.05, "m"), u(0.04, "m")), (u(0.003, "m"), u(0.004, "m"))
    corners = [(u(0.01, "m"), u(-0.01, "m")), (u(0.01, "m"), u(0.01, "m")), (u(-0.01, "m"), 0.0)]
    return written([
        beams.shoulder(0.3, u(0.03, "m"), u(0.02, "m"), u(0.002, "m")),
        beams.hole(0.6, u(0.03, "m"), u(0.006, "m")),
        beams.sensitivity(u(0.001, "m"), 7e8),
        *(beams.rectangle(*flat), beams.ellipse(*flat), beams.round_bar(u(0.02, "m"))),
        *(beams.box(*flat, *walls), beams.i_section(*flat, *walls), beams.polygon(corners)),
        beams.tube(u(0.03, "m"), u(0.002, "m")),
    ])  # fmt: skip


def crank(u=as_number, law=None):
    m = Mechanism("crank")
    r = m.parameter("r", u(0.1, "m"), "m", low=u(0.02, "m"), high=u(0.3, "m"))
    lean = m.parameter("lean", u(0.25, "rad"), "rad", low=u(0.0, "rad"), high=u(1.0, "rad"))
    arm, hand = links_of(m, arm=(r, u(1.5, "kg")), hand=(u(0.1, "m"), 0.5))
    m.revolute("O", m.ground, arm)
    m.torque("press", arm, 0.1 * m.parameter("p", 3.0, "bar"))
    m.weld("fist", arm.tip, hand, angle=lean)
    law = law or harmonic(u(0.2, "rad"), u(0.5, "rad"), 6.0, u(0.1, "rad"))
    return Scene(m, {"O": law}, t=(u(0.0, "s"), u(1.5, "s"), 7), wanted=["effort"])


def evaluated(u):
    values = {"r": u(0.05, "m"), "lean": u(0.5, "rad")}
    return evaluate(crank(u), parameters=values).effort("O").tolist()


def pressed(u):
    m = Mechanism("pressed")
    arm = m.link("arm", length=0.3, mass=1.0, centre=(0.1, 0.0), inertia=u(0.02, "kg m^2"))
    pin = m.revolute("O", m.ground, arm)
    rod = m.link("rod", length=0.1, density=density.polynomial(u(2.0, "kg/m"), u(1.0, "kg/m")))
    way = m.prismatic("S", arm.tip, rod, axis=(1, 0))
    m.set_gravity(0.0, u(-9.81, "m/s^2"))
    m.force("press", arm.tip, x=u(-5000.0, "N"))
    m.torque("motor", arm, u(250.0, "N m"))
    m.line_load("wind", rod, y=(u(1200.0, "N/m"), u(600.0, "N/m")))
    m.spring("coil", m.ground, arm.tip, stiffness=u(2e4, "N/m"), length=0.1,
             damping=u(8.0, "N s/m"))  # fmt: skip
    m.torsion_spring("bar", pin, stiffness=u(30.0, "N m/rad"), damping=u(0.5, "N m s/rad"))
    m.friction("pin", pin, viscous=u(0.25, "N m s/rad"))
    m.friction("way", way, viscous=u(40.0, "N s/m"))
    elements.plate(m, "plate", ((0, 0), (1, 0), (0, 1)), per_area=u(80.0, "kg/m^2"))
    elements.wheel(m, "wheel", radius=0.1, width=0.02, density=u(7000.0, "kg/m^3"))
    elements.cylinder(m, "ram", m.ground.at(0.5, -0.5), arm.tip, closed=0.4, bore=0.05,
                      back_pressure=u(2e5, "Pa"))  # fmt: skip
    return [parts_of(m), str(m.gravity), [str(out.expression) for out in m.outputs.values()]]


def rated(u):
    strong = {"elasticity": u(210e9, "Pa"), "yield_strength": u(355e6, "Pa")}
    turning = ("N m", "N m", "rad/s", "N m", "rad/s", "kg m^2")
    sizes = (1.0, 0.75, 300.0, 3.0, 400.0, 0.0005)
    main = [u(size, unit) for size, unit in zip(sizes, turning, strict=True)]
    return [
        written(beams.Material("steel", u(7850.0, "kg/m^3"), **strong)),
        written(actuators.Motor("m", *main, time_constant=u(8.0, "s"))),
        written(bearings.Rolling(u(14e3, "N"), 8000.0, u(7e3, "N"))),
        bearings.rated_hours(u(14e3, "N"), u(2e3, "N"), 1500.0),
        bearings.static_rating(u(0.008, "m"), u(0.04, "m"), 9),
        str(harmonic(0.0, 1.0, u(50.0, "1/s")).graph(0.03)),
        forward.power(u(150.0, "W")).graph(0.0, 0.0, 2.0),
        forward.dc_motor(u(12.0, "N m"), u(300.0, "rad/s")).graph(0.0, 0.0, 2.0),
        str(forward.torque_curve([0.0, u(9.0, "rad/s")], [u(2.0, "N m"), 0.0]).graph(0, 0, 2.0)),
        actuators.Motor("m", *main).continuous_torque(u(90.0, "rad/s")).tolist(),
        written(density.tabulated([0.0, 1.0], [u(2.0, "kg/m"), u(1.5, "kg/m")])),
        bearings.bending_of_pin(u(100.0, "N"), u(0.02, "m"), [u(0.01, "m"), 0.02]).tolist(),
        strength.factor(u(90e6, "Pa"), [0.0, u(20e6, "Pa")], STEEL).tolist(),
    ]


DECLARED = [wheels, shapes, cams, loaded, notched, pressed, rated, evaluated]


@pytest.mark.parametrize("declared", DECLARED)
def test_what_is_declared_by_a_text_is_what_its_number_declares(declared):
    """And in another unit, a length in seconds, anything else in metres, each place in turn refuses
    it.
    """
    places = []
    declared(lambda value, unit: places.append(unit) or value)
    assert declared(as_text) == declared(as_number)
    for wrong, unit in enumerate(places):
        told = iter(range(len(places)))

        def at(value, _unit, told=told, wrong=wrong, unit=unit):
            other = f"{value} s" if unit.startswith("m") else f"{value} m"
            return other if next(told) == wrong else value

        with pytest.raises(
            LagrangeCasadiError,
            match=r"is an? .*; expected an? |got '.* s'|the law is in (m|s), but",
        ):
            declared(at)


def default(value, unit):
    m = Mechanism("m")
    m.parameter("x", value, unit)
    return m.parameters["x"].default


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        (1.2, "rad", 1.2),
        (np.float64(0.5), "rad", 0.5),
        ("1.2rad", "rad", 1.2),
        (" -90  deg ", "rad", -math.pi / 2),
        ("1e2deg", "rad", 100 / 180 * math.pi),
        ("100 mm", "m", 0.1),
        ("0.3mm", "m", 0.0003),
        ("500 g", "kg", 0.5),
        ("20 ms", "s", 0.02),
        ("90 deg/s", "rad/s", math.pi / 2),
        ("540 deg", "rad", 3 * math.pi),
        ("90°", "rad", math.pi / 2),
        ("1500 rpm", "rad/s", 50 * math.pi),
        ("1500 1/min", "rad/s", 50 * math.pi),
        ("2 t", "kg", 2000.0),
        ("1 bar", "N/mm^2", 0.1),
        ("3 kN/(m s)", "W/m^2", 3000.0),
        ("4 m s^-1", "m/s", 4.0),
        ("5 cm", "mm", 50.0),
        ("2 m*N", "J", 2.0),
        ("0.3 cm**2 · t/(ms h)", "J", 1 / 120),
        ("95 %", "1", 0.95),
        ("7 EUR", "EUR", 7.0),
    ],
)
def test_a_text_is_the_number_of_its_unit(text, unit, value):
    assert default(text, unit) == value


NO_NUMBERS = ["", "deg", "1.2", "90 grad", "90 degrees", "1_0 deg", "nan", "inf deg", "1 2 deg"]
NO_NUMBERS += ["5 kN", "5 m s", "1/m", "1e999 mm", "3 m3", "5 MM"]
NO_NUMBERS += [math.inf, math.nan, None, True, np.True_, (1,), 2j, b"3", 10**400, np.ones(1)]


@pytest.mark.parametrize("value", NO_NUMBERS, ids=repr)
def test_what_is_no_number_is_refused(value):
    m = crank().mechanism
    for refused in (
        lambda: m.link("a", length=value, mass=1.0),
        lambda: m.weld("w", m.links["hand"].tip, m.point_mass("p", 1.0), angle=value),
        lambda: m.values({"lean": value}),
    ):
        with pytest.raises(LagrangeCasadiError, match=r"\A[^\n]*\Z"):
            refused()


A_NUMBER = r"expected a finite number \[rad\], or a text such as '350 deg' or '1\.2 rad', got "
POSTURES = {
    r"85 rad is 4870\.14 deg, more than two turns; '85 deg' is 85 degrees$": 85,
    r"-12\.6 rad is -721\.927 deg, more than two turns; '-12\.6 deg' is": -12.6,
    r"13\.9626 rad is 800 deg, more than two turns$": "800 deg",
    f"{A_NUMBER}'north'": "north",
    f"{A_NUMBER}'1,5 deg'$": "1,5 deg",
    "expected a finite number": math.nan,
}


@pytest.mark.parametrize("says", POSTURES)
def test_a_posture_in_degrees_without_the_word_is_refused(says):
    plain = four_bar()
    with pytest.raises(DeclarationError, match=f"posture of 'c': {says}"):
        Scene(plain.mechanism, plain.motion, t=plain.t, posture={"c": POSTURES[says]})
    told = Scene(plain.mechanism, plain.motion, t=plain.t, posture={"c": "85 deg"})
    assert dict(told.posture) == {"c": 85 / 180 * math.pi}


def test_angles_are_questioned_where_they_are_none():
    scene = crank(law=polynomial(0.0, 400.0))
    for refused, says in (
        (lambda: evaluate(scene, over=("O", 0, 360, 7)), "two turns; '360 deg' is 360 degrees"),
        (
            lambda: evaluate(scene, parameters={"r": "30 deg"}),
            "'r': '30 deg' is an angle; expected a length",
        ),
        (
            lambda: evaluate(scene, parameters={"lean": "steep"}),
            r"'lean': expected a number \[rad\], or a",
        ),
        (lambda: evaluate(scene, parameters={"lean": "90 deg"}), r"1\.57\d* rad is out of its"),
        (lambda: scene.mechanism.values({"r": 0.30000000001}), r"= 0\.30000000001 m is out of its"),
        (lambda: crank(law=polynomial("10 mm")), "the law is in m, but the coordinate is in rad"),
        (lambda: Mechanism("m").link("a", 0.1, 1.0), "name them: length=, mass="),
        (
            lambda: sweep(scene, {"r": ["10 deg"]}, out="x.h5"),
            "grid of r: '10 deg' is an angle; expected a length",
        ),
        (
            lambda: sweep(scene, {"p": ["350 kPa", "1 mm"]}, out="x.h5"),
            "grid of p: expected values of one unit, got some in Pa and some in m",
        ),
        (
            lambda: optimise(scene, minimise="p", over={"p": (1.0, 4.0)}, subject_to=["p>=3 mm"]),
            r"limit of p: its number is in m, a length; expected a pressure or a stress \[bar\]",
        ),
        (lambda: sweep(scene, {"lean": "steep"}, out="x.h5"), "grid of lean: expected .*numbers"),
        (
            lambda: prepare(scene, wanted=np.array([1.0])),
            "expected a list of output names, got arr",
        ),
    ):
        with pytest.raises(LagrangeCasadiError, match=says):
            refused()
    over = evaluate(scene, over=("O", 0, "360 rad", 7)).over
    assert (2.0 * over)[-1] == 2.0 * np.asarray(over)[-1] == 720.0
    assert samples([0, 1, 2, 3], ["0 deg", "1 deg", "3 deg", "2 deg"]).unit == "rad"


@pytest.mark.parametrize("function", [math.sin, float, lambda t: np.array(t)])
def test_functions_of_math_name_casadis(function):
    m = Mechanism("m")
    arm = m.link("arm", length=0.3, mass=1.0)
    with pytest.raises(
        DeclarationError, match=r"must be finite, got nan; the functions of math .* use casadi\.sin"
    ):
        m.force("push", arm.tip, x=function(m.time))


X = ca.SX.sym("x")
CALLED = ca.Function("called", [X], [3.0 * ca.sin(X), X * X], {"never_inline": True})
FUNCTIONS = [
    lambda t: sum(CALLED(t)) if isinstance(t, ca.SX) else 3.0 * np.sin(t) + t * t,
    lambda t: np.hypot(t, 0.4) + np.arctan2(t, -0.3) + np.deg2rad(t) + np.sin(t),
    lambda t: np.where(t > 0.55, 3.0 * t, -1.0) + np.heaviside(t - 0.5, 0.25),
    lambda t: np.interp(t, [0.3, 0.5, 0.9], [1.0, 4.0, -2.0]) + np.clip(t, 0.35, 0.75),
    lambda t: np.maximum(t, 0.5) - np.minimum(t, 0.4) + np.power(t, 3) + np.sqrt(t),
    lambda t: np.abs(t - 0.5) + np.floor(3 * t) + np.mod(t, 0.3),
]


@pytest.mark.filterwarnings("ignore::FutureWarning")
@pytest.mark.parametrize("function", FUNCTIONS)
def test_numpys_functions_of_symbols_are_what_they_are_of_numbers(function):
    """They go into the graph as CasADi's own: the load at every instant is NumPy's value there."""
    m = Mechanism("pendulum")
    arm = m.link("arm", length=0.3, mass=1.0)
    m.revolute("O", m.ground, arm)
    m.force("push", arm.tip, x=function(m.time))
    solution = evaluate(Scene(m, {"O": polynomial(0, 1.0)}, t=(0.2, 1, 9)), wanted=["load"])
    load, expected = solution.array("load:push:fx"), function(solution.t)
    np.testing.assert_allclose(load, expected, rtol=1e-15, atol=1e-15)


def test_a_parameter_has_the_unit_of_its_text():
    m = Mechanism("press")
    for name, text in (("speed", "1500 rpm"), ("gap", "5 mm"), ("lean", "90 deg"), ("count", 3.0)):
        m.parameter(name, text)
    units = {name: one.unit for name, one in m.parameters.items()}
    assert units == {"speed": "rad/s", "gap": "m", "lean": "rad", "count": "1"}
    assert m.parameters["gap"].default == 0.005
    with pytest.raises(DeclarationError, match=r"'5 kN' is a force; expected a length \[m\]"):
        m.parameter("reach", "5 mm", high="5 kN")


@pytest.mark.parametrize(
    ("unit", "says"),
    [
        ("mm", "parameter 'p' is in mm; expected m: multiply it by 0.001"),
        ("cm", "parameter 'p' is in cm; expected m: multiply it by 0.01"),
    ],
)
def test_a_parameter_alone_is_in_the_unit_of_its_place(unit, says):
    m = Mechanism("press")
    p = m.parameter("p", 100, unit)
    for declare in (
        lambda: m.link("l", length=p, mass=1),
        lambda: m.revolute("J", m.ground.at(0.1, p), m.point_mass("end", 1)),
        lambda: m.link("k", length=1, beam=beams.Beam(beams.rectangle(p, 0.01), STEEL)),
    ):
        with pytest.raises(DeclarationError, match=says):
            declare()


@pytest.mark.parametrize("unit", ["m", "1", "", "feet"])
def test_and_may_be_in_a_unit_of_the_users_own(unit):
    m = Mechanism("press")
    p = m.parameter("p", 1, unit)
    assert m.link("l", length=p, mass=1).length is p
    m.link("k", length=m.parameter("q", 100, "mm") / 1000, mass=1)
    area, iz = m.parameter("area", 1e-4, "m^2"), m.parameter("iz", 1e-9, "m^4")
    shape = beams.given(area=area, iz=iz, iy=iz, top=0.01, side=0.01)
    m.link("j", length=1, beam=beams.Beam(shape, STEEL))


def test_designs_of_texts_are_in_the_units_of_their_parameters(tmp_path):
    scene, listed = crank(), tmp_path / "listed.csv"
    swept = sweep(scene, {"p": ["350 kPa", 4.0, "0.5 MPa"]}, out=tmp_path / "x.h5")
    assert [*swept["p"], *swept.select(p="500 kPa")["p"]] == [3.5, 4.0, 5.0, 5.0]
    assert best(swept, minimise="p", where=["p>0.4 MPa", "peak:effort:O<1e9 N mm"])[0].number == 2
    listed.write_text("p,lean [deg]\n300 kPa,0\n4,45\n")
    assert sweep(scene, read_designs(listed), out=tmp_path / "y.h5")["p"].tolist() == [3.0, 4.0]
    found = optimise(scene, minimise="p", over={"p": (1.0, 4.0)}, subject_to=["p>=250 kPa"])
    assert round(found.parameters["p"], 6) == 2.5
